import ctypes
import errno
import platform


def build(scene):
    """Memory and queues that live in the kernel, made by others: a number is enough to get at them."""
    libc = ctypes.CDLL(None, use_errno=True)
    x86 = platform.machine() == "x86_64"
    text = ctypes.create_string_buffer(b"\1" + bytes(7) + b"hello")
    heard = []
    for name, *arguments in (
        (30 if x86 else 196, 0, None, 0),  # shmat
        (31 if x86 else 195, 0, 0, None),  # shmctl: remove
        (69 if x86 else 189, 0, text, 5, 0o4000),  # msgsnd
        (70 if x86 else 188, 0, text, 5, 0, 0o4000),  # msgrcv
        (241 if x86 else 181, b"queue"),  # mq_unlink
    ):
        if libc.syscall(name, *arguments) != -1 or ctypes.get_errno() != errno.EPERM:
            heard.append(name)
    raise AssertionError(f"HEARD {heard}" if heard else "nobody heard")
