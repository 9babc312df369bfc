"""What a program may import: wsim.scene, pxr, NumPy, and what of the standard library does no harm."""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from typing import Any

_NETWORK = (
    "socket", "socketserver", "ssl", "http", "urllib", "ftplib", "smtplib", "poplib", "imaplib", "nntplib", "telnetlib",
    "xmlrpc", "asyncio", "select", "selectors", "webbrowser", "wsgiref", "asyncore", "asynchat", "smtpd",
)  # fmt: skip
_PROCESS = ["subprocess", "multiprocessing", "pty", "signal", "_posixsubprocess", "posix"]
_MACHINE = ["ctypes", "resource", "mmap", "fcntl", "termios", "tty", "code", "codeop", "pdb", "runpy"]
_WHY = (
    dict.fromkeys(_NETWORK, "programs have no network")
    | dict.fromkeys(_PROCESS, "programs start no processes")
    | dict.fromkeys(_MACHINE, "programs stay out of the interpreter and the machine")
)
_FORBIDDEN_CALLS = {
    **dict.fromkeys(
        (
            "system", "popen", "fork", "forkpty", "posix_spawn", "posix_spawnp", "startfile", "execv", "execve",
            "execl", "execle", "execlp", "execvp", "execvpe", "spawnl", "spawnle", "spawnlp", "spawnv", "spawnve",
            "spawnvp", "spawnvpe",
        ),
        "programs start no processes",
    ),
    **dict.fromkeys(("kill", "killpg", "abort", "_exit"), "programs end no processes"),
    **dict.fromkeys(("chmod", "chown", "symlink", "link", "mkfifo", "mknod"), "programs change no files"),
}  # fmt: skip
_WSIM = ("wsim", "wsim.scene", "wsim.assets", "wsim.program.control_world")
OFFERED = "wsim.scene, pxr, numpy and the standard library"


def refused(module: str) -> str:
    """Why a program may not import a module; "" if it may."""
    top = module.partition(".")[0]
    if top == "wsim":
        inside = module in _WSIM or module.startswith(("wsim.scene.", "wsim.assets."))
        return "" if inside else f"programs import {OFFERED}"
    if top in ("pxr", "numpy", "newton_usd_schemas", "__future__"):
        return ""
    if top in _WHY:
        return _WHY[top]
    return "" if top in sys.stdlib_module_names else f"programs import {OFFERED}"


def refused_call(name: str) -> str:
    """Why a program may not call a function of the standard library; "" if it may."""
    module, _, short = name.rpartition(".")
    return _FORBIDDEN_CALLS.get(short, "") if module == "os" else ""


def is_there(module: str) -> bool:
    """Whether a module can be found; it is not imported. What holds it is, where Python must look inside."""
    path: Any = None
    spec = None
    for i, _ in enumerate(module.split(".")):
        try:
            spec = PathFinder.find_spec(".".join(module.split(".")[: i + 1]), path)
        except (KeyError, ImportError, ValueError):  # a name space whose parent has not been imported
            return True
        if spec is None:
            return False
        path = spec.submodule_search_locations
        if path is None and i + 1 < module.count(".") + 1:
            return False
    return spec is not None
