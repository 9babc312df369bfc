"""A seccomp filter: the system calls that a program which authors a stage never needs, refused by the kernel.

It is what keeps the program to one process and off the network, and what covers the calls that Landlock does not
(signals on old kernels, sockets by path, chmod and its kin, memory and disk that no rlimit counts). Numbers are of
x86-64 and of the generic table that arm64 uses; see seccomp(2) and linux/audit.h. Another table, such as that of
32-bit programs behind `int 0x80`, ends the process; a call that is newer than the tables here does not exist.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
from collections.abc import Callable

_AUDIT_ARCH = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_NEWER = 470  # the first number past the tables below; x32's calls, from 0x40000000 on, are past it too

# name: (x86-64, arm64); None where the table has no such call
_CALLS: dict[str, tuple[int | None, int | None]] = {
    "fork": (57, None), "vfork": (58, None), "execve": (59, 221), "execveat": (322, 281),
    "clone": (56, 220), "clone3": (435, 435), "unshare": (272, 97), "setns": (308, 268),
    "socket": (41, 198), "socketpair": (53, 199), "connect": (42, 203), "bind": (49, 200), "listen": (50, 201),
    "accept": (43, 202), "accept4": (288, 242), "sendto": (44, 206), "sendmsg": (46, 211), "sendmmsg": (307, 269),
    "recvfrom": (45, 207), "recvmsg": (47, 212), "recvmmsg": (299, 243), "shutdown": (48, 210),
    "setsockopt": (54, 208), "getsockopt": (55, 209), "getsockname": (51, 204), "getpeername": (52, 205),
    "ptrace": (101, 117), "process_vm_readv": (310, 270), "process_vm_writev": (311, 271), "kcmp": (312, 272),
    "pidfd_open": (434, 434), "pidfd_getfd": (438, 438), "pidfd_send_signal": (424, 424),
    "process_madvise": (440, 440), "process_mrelease": (448, 448), "move_pages": (279, 239),
    "migrate_pages": (256, 238), "tkill": (200, 130), "rt_sigqueueinfo": (129, 138), "rt_tgsigqueueinfo": (297, 240),
    "kill": (62, 129), "tgkill": (234, 131), "prlimit64": (302, 261), "prctl": (157, 167), "fcntl": (72, 25),
    "ioctl": (16, 29), "open": (2, None), "openat": (257, 56), "openat2": (437, 437), "close_range": (436, 436),
    "fallocate": (285, 47), "splice": (275, 76), "tee": (276, 77), "vmsplice": (278, 75),
    "io_setup": (206, 0), "io_submit": (209, 2),
    "setpgid": (109, 154), "setsid": (112, 157),  # it is ended with its group
    "setpriority": (141, 140), "ioprio_set": (251, 30), "sched_setaffinity": (203, 122),
    "sched_setscheduler": (144, 119), "sched_setparam": (142, 118), "sched_setattr": (314, 274),
    "shmget": (29, 194), "shmat": (30, 196), "shmctl": (31, 195), "msgget": (68, 186), "msgsnd": (69, 189),
    "msgrcv": (70, 188), "msgctl": (71, 187), "semget": (64, 190), "semop": (65, 193), "semtimedop": (220, 192),
    "semctl": (66, 191), "mq_open": (240, 180), "mq_unlink": (241, 181),
    "memfd_create": (319, 279), "memfd_secret": (447, 447), "userfaultfd": (323, 282),
    "io_uring_setup": (425, 425), "io_uring_enter": (426, 426), "io_uring_register": (427, 427),
    "bpf": (321, 280), "perf_event_open": (298, 241), "keyctl": (250, 219), "add_key": (248, 217),
    "request_key": (249, 218), "mount": (165, 40), "umount2": (166, 39), "pivot_root": (155, 41), "chroot": (161, 51),
    "open_tree": (428, 428), "open_tree_attr": (467, 467), "move_mount": (429, 429), "fsopen": (430, 430),
    "fsconfig": (431, 431), "fsmount": (432, 432), "fspick": (433, 433), "mount_setattr": (442, 442),
    "statmount": (457, 457), "listmount": (458, 458),
    "name_to_handle_at": (303, 264), "open_by_handle_at": (304, 265),
    "fanotify_init": (300, 262), "inotify_init1": (294, 26), "inotify_init": (253, None),
    "quotactl": (179, 60), "quotactl_fd": (443, 443), "personality": (135, 92), "modify_ldt": (154, None),
    "iopl": (172, None), "ioperm": (173, None), "sync": (162, 81),
    "syslog": (103, 116), "acct": (163, 89), "swapon": (167, 224), "swapoff": (168, 225),
    "reboot": (169, 142), "init_module": (175, 105), "finit_module": (313, 273), "delete_module": (176, 106),
    "kexec_load": (246, 104), "kexec_file_load": (320, 294),
    "settimeofday": (164, 170), "clock_settime": (227, 112), "adjtimex": (159, 171),
    "truncate": (76, 45),
    "chmod": (90, None), "fchmod": (91, 52), "fchmodat": (268, 53), "fchmodat2": (452, 452),
    "chown": (92, None), "lchown": (94, None), "fchown": (93, 55), "fchownat": (260, 54),
    "utime": (132, None), "utimes": (235, None), "futimesat": (261, None), "utimensat": (280, 88),
    "setxattr": (188, 5), "lsetxattr": (189, 6), "fsetxattr": (190, 7), "setxattrat": (463, 463),
    "removexattr": (197, 14), "lremovexattr": (198, 15), "fremovexattr": (199, 16), "removexattrat": (466, 466),
    "file_setattr": (469, 469),
}  # fmt: skip

_ARGUED = (
    "clone", "clone3", "kill", "tgkill", "prlimit64", "prctl", "fcntl", "ioctl", "open", "openat", "openat2",
    "close_range", "fallocate",
)  # fmt: skip
# Landlock does not govern a file's metadata. There these calls do nothing and say that they did it: libraries that
# tidy the mode of a file they have just written carry on.
_METADATA = (
    "chmod", "fchmod", "fchmodat", "fchmodat2", "chown", "lchown", "fchown", "fchownat", "utime", "utimes",
    "futimesat", "utimensat", "setxattr", "lsetxattr", "fsetxattr", "setxattrat", "removexattr", "lremovexattr",
    "fremovexattr", "removexattrat", "file_setattr",
)  # fmt: skip
_LANDLOCK_ONLY = ("truncate", *_METADATA)

# A thread, with the table of descriptors that the others have: in a table of its own files are out of `watch`'s sight.
_THREAD = 0x00010000 | 0x00000400  # CLONE_THREAD, CLONE_FILES
_CLOSE_RANGE_UNSHARE = 1 << 1  # the other way to such a table
# F_SETOWN, F_SETOWN_EX: who gets a descriptor's signals, another way to signal a process. F_SETLEASE, F_NOTIFY: a say
# in what others do with a file. F_SETPIPE_SZ: memory of the kernel.
_FCNTLS = (8, 15, 1024, 1026, 1031)
# The few that Python asks for: TCGETS, TCGETS2, TIOCGWINSZ, FIONREAD, FIONBIO, FIOCLEX, FIONCLEX. Among the others are
# fallocate by another name (FS_IOC_RESVSP), clones of files, and what a terminal's owner would type (TIOCSTI).
_IOCTLS = (0x5401, 0x802C542A, 0x5413, 0x541B, 0x5421, 0x5451, 0x5450)
_PR_SET_PDEATHSIG = 1
_O_TRUNC = 0o1000

_LOAD, _EQUAL, _AT_LEAST, _AND, _RETURN = 0x20, 0x15, 0x35, 0x54, 0x06
_ALLOW, _ERRNO, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_NUMBER, _ARCH = 0, 4


def available() -> bool:
    """Whether this machine and kernel take the filter."""
    if platform.machine() not in _AUDIT_ARCH or struct.calcsize("P") != 8:
        return False
    libc = ctypes.CDLL(None, use_errno=True)
    return libc.prctl(21, 0, 0, 0, 0) in (0, 2)  # PR_GET_SECCOMP


def install(*, landlock: bool) -> None:
    """Put the filter on this process for good. `no_new_privs` must be set.

    Args:
        landlock: The file system is guarded by Landlock and not by a mount namespace: refuse what it does not govern.

    Raises:
        OSError: If the kernel does not take it.
    """
    code = _program(platform.machine(), os.getpid(), landlock=landlock)
    buffer = ctypes.create_string_buffer(code, len(code))

    class Program(ctypes.Structure):
        _fields_ = [("len", ctypes.c_ushort), ("filter", ctypes.c_void_p)]

    program = Program(len(code) // 8, ctypes.addressof(buffer))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(22, 2, ctypes.byref(program), 0, 0) != 0:  # PR_SET_SECCOMP, SECCOMP_MODE_FILTER
        raise OSError(ctypes.get_errno(), "the kernel refused the seccomp filter")


def _op(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
    return struct.pack("HBBI", code, yes, no, value)


def _refuse(error: int) -> bytes:
    return _op(_RETURN, _ERRNO | error)


def _argument(index: int) -> bytes:
    return _op(_LOAD, 16 + 8 * index)  # the low half: both tables are little endian


def _program(machine: str, pid: int, *, landlock: bool) -> bytes:
    column = 0 if machine == "x86_64" else 1

    def number(name: str) -> int | None:
        return _CALLS[name][column]

    parts = [_op(_LOAD, _ARCH), _op(_EQUAL, _AUDIT_ARCH[machine], 1, 0), _op(_RETURN, _KILL), _op(_LOAD, _NUMBER)]
    parts += [_op(_AT_LEAST, _NEWER, 0, 1), _refuse(errno.ENOSYS)]
    for name in _CALLS:
        call = number(name)
        if call is None or name in _ARGUED or (name in _LANDLOCK_ONLY and not landlock):
            continue
        parts += [_op(_EQUAL, call, 0, 1), _refuse(0 if name in _METADATA else errno.EPERM)]
    for name, rule in _rules(pid, landlock=landlock).items():
        call = number(name)
        if call is None:
            continue
        body = rule()
        # Back to the call's number for the rules that follow.
        parts += [_op(_EQUAL, call, 0, len(body) // 8 + 1), body, _op(_LOAD, _NUMBER)]
    parts.append(_op(_RETURN, _ALLOW))
    return b"".join(parts)


def _rules(pid: int, *, landlock: bool) -> dict[str, Callable[[], bytes]]:
    """Calls that are refused for some of their arguments only."""
    deny = _refuse(errno.EPERM)

    def only_own_pid() -> bytes:
        return _argument(0) + _op(_EQUAL, pid, 1, 0) + deny

    def own_limits() -> bytes:
        return _argument(0) + _op(_EQUAL, 0, 2, 0) + _op(_EQUAL, pid, 1, 0) + deny

    def one_of(index: int, *values: int) -> bytes:
        return _argument(index) + b"".join(_op(_EQUAL, value, 0, 1) + deny for value in values)

    def threads_only() -> bytes:
        return _argument(0) + _op(_AND, _THREAD) + _op(_EQUAL, _THREAD, 1, 0) + deny

    def known_ioctls() -> bytes:
        last = len(_IOCTLS)
        known = b"".join(_op(_EQUAL, value, last - i, 0) for i, value in enumerate(_IOCTLS))
        return _argument(1) + known + _refuse(errno.ENOTTY)

    def shared_descriptors() -> bytes:
        return _argument(2) + _op(_AND, _CLOSE_RANGE_UNSHARE) + _op(_EQUAL, 0, 1, 0) + deny

    def odd_opens(index: int) -> bytes:
        # Landlock before ABI 3 lets a file that may be read be emptied by opening it O_RDONLY | O_TRUNC. None looks at
        # an open for neither reading nor writing (3), which is enough to start a device.
        truncating_read = _op(_AND, _O_TRUNC | 3) + _op(_EQUAL, _O_TRUNC, 0, 1) + deny
        return _argument(index) + truncating_read + _op(_AND, 3) + _op(_EQUAL, 3, 0, 1) + deny

    rules: dict[str, Callable[[], bytes]] = {
        "kill": only_own_pid,
        "tgkill": only_own_pid,
        "prlimit64": own_limits,
        "prctl": lambda: one_of(0, _PR_SET_PDEATHSIG),
        "fcntl": lambda: one_of(1, *_FCNTLS),
        "ioctl": known_ioctls,
        "close_range": shared_descriptors,
        # It takes disk past the end of a file, which RLIMIT_FSIZE does not count. libc then writes instead.
        "fallocate": lambda: _refuse(errno.EOPNOTSUPP),
        "clone": threads_only,
        # Its flags lie in memory, where a filter cannot look; libc then falls back to clone.
        "clone3": lambda: _refuse(errno.ENOSYS),
        "openat2": lambda: _refuse(errno.ENOSYS),
    }
    if landlock:
        rules["open"] = lambda: odd_opens(1)
        rules["openat"] = lambda: odd_opens(2)
    return rules
