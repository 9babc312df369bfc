"""The run of a bare program that confirms another: when it is asked for, or ahead, in a process of its own."""

from __future__ import annotations

import os
import pickle
import shutil
import sys
import threading
from dataclasses import replace
from pathlib import Path
from types import TracebackType

from wsim.door import keep_what_loads, load_beside
from wsim.judge.verdict import Verdict
from wsim.program.bare import bare
from wsim.progress import silent
from wsim.runs.folder import write_whole
from wsim.runs.iteration import Iteration
from wsim.runs.standby import Standby


class BareRun:
    """A program without what only served its review, in a folder that is there as long as this is open.

    Args:
        folder: For its files.
        iteration: Whose program it is.

    Attributes:
        iteration: The bare one, without pictures.
        as_it_was: Whether nothing was stripped.
    """

    def __init__(self, folder: Path, iteration: Iteration) -> None:
        stripped = bare(iteration.text)
        self.as_it_was = stripped == iteration.text
        self._text = stripped
        quiet = replace(iteration.settings, pictures=False, verify=False)
        self.iteration = replace(iteration, folder=folder, source=None, settings=quiet)
        self._process: Standby | None = None

    def __enter__(self) -> BareRun:
        """Write the program."""
        self._clear()
        self.iteration.folder.mkdir(parents=True)
        write_whole(self.iteration.program, self._text)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the process, whatever it is at, and take the folder away."""
        if self._process is not None:
            self._process.close()
        self._clear()

    def start(self, standby: Standby | None = None) -> None:
        """Run it ahead, beside what this process does: in a process that has loaded already, or in a new one."""
        self._process = standby or Standby()
        self._process.give(pickle.dumps(replace(self.iteration, progress=silent)))

    def verdict(self) -> Verdict:
        """The bare program's: waited for if it was started, else run here and now.

        A process that breaks has said nothing that counts: the program is run again, here, where an error is seen.
        """
        if self._process is not None:
            self.iteration.progress("confirming", 0, 1)
            done = self._process.done()
            self.iteration.progress("confirming", 1, 1)
            if done:
                return self.iteration.verdict
        return self.iteration.run()

    def _clear(self) -> None:
        shutil.rmtree(self.iteration.folder, ignore_errors=True)


def _main() -> None:
    """In the process: load what will be needed, run what comes, and end when nobody is there any more who wants it."""
    keep_what_loads()
    load_beside("wsim.sim.simulation")  # until there is work, and while its stage is built
    try:
        iteration = pickle.load(sys.stdin.buffer)
    except EOFError:  # nothing came
        os._exit(1)

    def end_with_parent() -> None:
        sys.stdin.buffer.read()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
    iteration.run()
    sys.stdout.flush()
    os._exit(0)  # the thread still reads


if __name__ == "__main__":
    _main()
