"""Landlock: this process may open the files it was granted and no others. See landlock(7)."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterable

_CREATE, _ADD, _RESTRICT = 444, 445, 446  # the same on every architecture

EXECUTE, WRITE_FILE, READ_FILE, READ_DIR = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_REMOVE_FILE, _MAKE_REG = 1 << 5, 1 << 8
_TRUNCATE = 1 << 14
READ = EXECUTE | READ_FILE | READ_DIR
# Files but no folders, links or devices: a flat scratch can be counted while it is watched, and emptied.
SCRATCH = READ_FILE | READ_DIR | WRITE_FILE | _REMOVE_FILE | _MAKE_REG | _TRUNCATE
DEVICE = READ_FILE | WRITE_FILE
_ON_A_FILE = EXECUTE | WRITE_FILE | READ_FILE | _TRUNCATE
_HANDLED = {1: 13, 2: 14, 3: 15, 4: 15, 5: 16}  # number of file rights, by ABI


class _Ruleset(ctypes.Structure):
    _fields_ = [("fs", ctypes.c_uint64), ("net", ctypes.c_uint64), ("scoped", ctypes.c_uint64)]


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = [("access", ctypes.c_uint64), ("parent", ctypes.c_int32)]


def abi() -> int:
    """The kernel's Landlock ABI; 0 where it has none or it is switched off."""
    libc = ctypes.CDLL(None, use_errno=True)
    return max(0, libc.syscall(_CREATE, None, ctypes.c_size_t(0), ctypes.c_uint32(1)))


def restrict(grants: Iterable[tuple[str, int]]) -> None:
    """Confine this process to the granted paths, for good. `no_new_privs` must be set, and no other thread running.

    TCP is refused from ABI 4 on; signals to, and abstract sockets of, processes outside from ABI 6 on.

    Args:
        grants: Paths with the rights beneath them; a path that does not exist is passed over.

    Raises:
        OSError: If the kernel refuses.
    """
    version = abi()
    handled = (1 << _HANDLED.get(version, 16)) - 1
    attributes = _Ruleset(fs=handled, net=3 if version >= 4 else 0, scoped=3 if version >= 6 else 0)
    size = 24 if version >= 6 else 16 if version >= 4 else 8
    libc = ctypes.CDLL(None, use_errno=True)
    ruleset = libc.syscall(_CREATE, ctypes.byref(attributes), ctypes.c_size_t(size), ctypes.c_uint32(0))
    if ruleset < 0:
        raise OSError(ctypes.get_errno(), "the kernel refused a Landlock rule set")
    for path, access in grants:
        try:
            parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
        except OSError:
            continue
        rights = access & handled & (~0 if os.path.isdir(path) else _ON_A_FILE)  # noqa: PTH112
        rule = _Beneath(access=rights, parent=parent)
        failed = libc.syscall(_ADD, ctypes.c_int(ruleset), ctypes.c_int(1), ctypes.byref(rule), ctypes.c_uint32(0))
        os.close(parent)
        if failed:
            raise OSError(ctypes.get_errno(), f"the kernel refused a Landlock rule for {path}")
    if libc.syscall(_RESTRICT, ctypes.c_int(ruleset), ctypes.c_uint32(0)):
        raise OSError(ctypes.get_errno(), "the kernel refused to restrict this process with Landlock")
    os.close(ruleset)
