"""Confine this process: limits, privileges, files, system calls. Called once, before any code that is not ours."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import sys
from typing import Any

from wsim.program.inside import landlock, seccomp

_PR_SET_PDEATHSIG, _PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS, _PR_CAP_AMBIENT = 1, 24, 38, 47
_CAPABILITY_VERSION = 0x20080522


def confine(job: dict[str, Any]) -> None:
    """Give up all that the job does not need, for good.

    Args:
        job: What the parent wrote: `isolation`, `limits`, `scratch`, `read` (paths), `parent` (process id).

    Raises:
        OSError: If the kernel refuses a part of it; nothing of the program may then run.
    """
    isolation = job["isolation"]
    libc = ctypes.CDLL(None, use_errno=True)
    if isolation != "bubblewrap":  # bubblewrap's own --die-with-parent does it there
        libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != job["parent"]:
            sys.exit("the process that started this one is gone")
    _limit(job["limits"])
    if isolation == "none":
        return
    if libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "the kernel refused no_new_privs")
    _drop_capabilities(libc)
    if isolation == "landlock":
        grants = [(path, landlock.READ) for path in job["read"]]
        grants += [(path, landlock.READ_FILE) for path in ("/dev/zero", "/dev/urandom", "/dev/random")]
        # The directory of this process alone, not /proc: other processes' command lines stay unseen.
        grants += [("/dev/null", landlock.DEVICE), (f"/proc/{os.getpid()}", landlock.READ_FILE | landlock.READ_DIR)]
        grants.append((job["scratch"], landlock.SCRATCH))
        landlock.restrict(grants)
    seccomp.install(landlock=isolation == "landlock")


def _limit(limits: dict[str, Any]) -> None:
    wanted = {
        resource.RLIMIT_AS: limits["memory_bytes"],
        resource.RLIMIT_FSIZE: limits["file_bytes"],
        resource.RLIMIT_NOFILE: limits["open_files"],
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_MSGQUEUE: 0,
        resource.RLIMIT_MEMLOCK: 1 << 20,
    }
    for which, value in wanted.items():
        hard = resource.getrlimit(which)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(which, (value, value))
    if limits["cpu_seconds"] is not None:
        seconds = int(limits["cpu_seconds"])
        # A second between the signal that says why and the one that cannot be ignored.
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


def _drop_capabilities(libc: ctypes.CDLL) -> None:
    """Root without its powers: of use where the sandbox itself runs as root."""
    libc.prctl(_PR_CAP_AMBIENT, 4, 0, 0, 0)
    for capability in range(64):
        if libc.prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0) != 0:
            break
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION, 0)
    none = (ctypes.c_uint32 * 6)()
    if libc.capset(header, none) != 0:
        raise OSError(ctypes.get_errno(), "the kernel refused to drop capabilities")
