"""How a process is kept apart: which ways work on this machine, and the command line for each."""

from __future__ import annotations

import functools
import importlib.util
import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from wsim.assets.folders import VARIABLE, user_folder
from wsim.errors import UserError
from wsim.program.inside import landlock, seccomp

Isolation = Literal["auto", "bubblewrap", "landlock", "none"]
SCRATCH = "/wsim-scratch"  # in bubblewrap's name space
_DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")
_NOBODY = "65534"
_PROBE_SECONDS = 10.0
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/nix/store", "/gnu/store")
_CONFIG = ("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/localtime")


@functools.cache
def available() -> dict[str, str]:
    """The isolations that work here; where one does not, why. {"bubblewrap": "", "landlock": "no Landlock ..."}."""
    return {"bubblewrap": _bubblewrap_problem(), "landlock": _landlock_problem()}


def choose(isolation: str) -> str:
    """The isolation to use.

    Raises:
        UserError: If the one asked for does not work here, or "auto" finds none.
    """
    if isolation == "none":
        return "none"
    problems = available()
    if isolation != "auto":
        if isolation not in problems:
            raise UserError(f'isolation = "{isolation}" is not known; use auto, bubblewrap, landlock or none')
        if problems[isolation]:
            raise UserError(f'isolation = "{isolation}" does not work here: {problems[isolation]}')
        return isolation
    for name, problem in problems.items():
        if not problem:
            return name
    reasons = "; ".join(f"{name}: {problem}" for name, problem in problems.items())
    raise UserError(
        f"a generated program is not run without a sandbox, and none works here ({reasons}); "
        'install bubblewrap, or pass isolation="none" to run it with limits only'
    )


def _bubblewrap_problem() -> str:
    if not sys.platform.startswith("linux"):
        return "it needs Linux"
    if shutil.which("bwrap") is None:
        return "bwrap is not installed"
    if not seccomp.available():
        return "the kernel has no seccomp filters"
    command = [*bubblewrap([], scratch_bytes=1 << 20), "--", sys.executable, "-S", "-E", "-c", "pass"]
    try:
        done = subprocess.run(
            command, env={}, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PROBE_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"bwrap does not start: {error}"
    if done.returncode != 0:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or [f"exit status {done.returncode}"]
        return f"bwrap fails: {lines[-1][:200]}"
    return ""


def _landlock_problem() -> str:
    if not sys.platform.startswith("linux"):
        return "it needs Linux"
    if landlock.abi() < 1:
        return "the kernel has no Landlock (Linux 5.13 or later, with landlock among its security modules)"
    if not seccomp.available():
        return "the kernel has no seccomp filters, without which Landlock leaves too much open"
    return ""


def bubblewrap(readable: Sequence[Path], *, scratch_bytes: int) -> list[str]:
    """The start of a bubblewrap command line: everything unshared, the runtime read-only, one capped tmpfs."""
    command = [str(shutil.which("bwrap") or "bwrap")]
    # A user name space even for root, for whom --unshare-all leaves it out where it can.
    command += ["--unshare-user", "--unshare-all", "--die-with-parent", "--cap-drop", "ALL", "--hostname", "sandbox"]
    # Nobody there. Outside it stays the user who asked, which a map of one user cannot change: where that is root, what
    # only root may write is out of reach because nothing of it is there, not because of who the program is.
    command += ["--uid", _NOBODY, "--gid", _NOBODY]
    for path in _tops([*runtime_paths(), *readable]):
        if path.is_symlink():
            command += ["--symlink", os.readlink(path), str(path)]  # noqa: PTH115
        else:
            command += ["--ro-bind", str(path), str(path)]
    # No /proc and no /sys: the kernel's settings are files there, and open to root even without capabilities. No --dev
    # either: with it come terminals, and links into /proc.
    for name in _DEVICES:
        command += ["--dev-bind", name, name]
    command += ["--symlink", os.path.realpath(sys.executable), "/proc/self/exe"]  # USD asks where Python is
    command += ["--size", str(scratch_bytes), "--tmpfs", SCRATCH]
    # bubblewrap's own root is a tmpfs too, as large as half the machine's memory.
    command += ["--remount-ro", "/", "--chdir", SCRATCH]
    return command


@functools.cache
def runtime_paths() -> tuple[Path, ...]:
    """What Python, wsim, USD and NumPy are read from; existing paths, each as given and as it really is."""
    paths = [Path(name) for name in (*_SYSTEM, *_CONFIG)]
    for prefix in (sys.prefix, sys.exec_prefix, sys.base_prefix, sys.base_exec_prefix):
        if Path(prefix).resolve() not in (Path("/"), Path(os.path.expanduser("~")).resolve()):  # noqa: PTH111
            paths.append(Path(prefix))
        else:  # never all of a home folder: Python's own parts of it
            paths += [
                Path(sysconfig.get_path(key)) for key in ("stdlib", "platstdlib", "purelib", "platlib", "scripts")
            ]
    paths += [Path(sys.executable), Path(sys.executable).resolve()]
    paths += [Path(wsim_folder())]
    paths += [Path(folder) for folder in _package_folders()]
    return tuple(dict.fromkeys(each for path in paths if path.exists() for each in (path, path.resolve())))


def wsim_folder() -> str:
    """The folder of the `wsim` package: in site-packages, or in `src`."""
    return str(Path(__file__).resolve().parents[2])


def module_paths() -> tuple[list[str], list[str]]:
    """What goes before and after Python's own `sys.path`: a source tree of wsim; folders of the libraries."""
    parent = str(Path(wsim_folder()).parent)
    folders = list(_package_folders())
    # A folder of many packages must not come before the standard library.
    return ([], [parent, *folders]) if parent in folders else ([parent], folders)


@functools.cache
def _package_folders() -> tuple[str, ...]:
    """The folders that hold NumPy, USD and pydantic: outside sys.prefix for a user's or system site-packages."""
    folders = []
    for name in ("numpy", "pxr", "pydantic"):
        spec = importlib.util.find_spec(name)
        for location in (spec.submodule_search_locations or ()) if spec else ():
            folders.append(str(Path(location).parent))
    return tuple(dict.fromkeys(folders))


def environment(scratch: str) -> dict[str, str]:
    """The whole environment of a sandboxed process: nothing of the parent's but where libraries lie."""
    variables = {
        "PATH": "/usr/bin:/bin",
        "LANG": "C.UTF-8",
        "HOME": scratch,
        "TMPDIR": scratch,
        "PYTHONHASHSEED": "0",
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONUNBUFFERED": "1",
        # Address space is what is limited: no arena and no thread for each of a large machine's cores.
        "MALLOC_ARENA_MAX": "2",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "2",
    }
    known = [str(path) for path in runtime_paths()]
    variables[VARIABLE] = str(user_folder())  # read if the caller lets it
    libraries = [
        folder
        for folder in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
        if any(folder == path or folder.startswith(path + os.sep) for path in known)
    ]
    if libraries:
        variables["LD_LIBRARY_PATH"] = os.pathsep.join(libraries)
    return variables


def _tops(paths: Sequence[Path]) -> list[Path]:
    """The paths that do not lie in another of them, outermost first. What lies behind a link is there under its name.

    That its real place is among the paths too is up to who gives them.
    """
    kept: list[Path] = []
    for path in sorted(dict.fromkeys(paths), key=lambda path: len(path.parts)):
        if not any(path.is_relative_to(other) for other in kept):
            kept.append(path)
    return kept
