"""Run generated programs where they can do no harm.

    result = build(Path("program.py"), Path("stage.usda"), {"wood_density": 650.0}, Limits())

What the program can reach, by isolation:

- *bubblewrap*: its own user, process, network, IPC, host and mount name spaces. It sees Python, wsim and the libraries
  read-only, its program, and an empty scratch folder of limited size. Nothing else exists there: no /proc, no /sys,
  of the devices only null, zero and random numbers. Its user is nobody.
- *landlock*: the same files through a Landlock rule set. That others exist can be seen (`os.stat`), not what they hold
  or, in a folder that was not granted, what they are called.
- Both: a seccomp filter (one process; no sockets, new programs, signals to others, tracing, keys, memory and disk that
  escape the limits), no capabilities, no new privileges, rlimits, an environment without the parent's variables, a wall
  clock.
- *none*: rlimits, environment and wall clock only.

None of them hides the time or the machine's kind, or closes side channels; a fault in the kernel defeats all of them.
"""

from wsim.program.sandbox.builder import build
from wsim.program.sandbox.isolation import Isolation, available
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.many import build_many
from wsim.program.sandbox.result import BuildResult

__all__ = ["BuildResult", "Isolation", "Limits", "available", "build", "build_many"]
