import ctypes
import errno
import platform


def build(scene):
    libc = ctypes.CDLL(None, use_errno=True)
    flags = 0x100 | 0x200 | 0x800 | 0x10000  # memory, folder, handlers, thread; not the descriptors
    stack = ctypes.create_string_buffer(1 << 16)
    top = ctypes.c_void_p(ctypes.addressof(stack) + (1 << 15))
    refused = []
    for call in (
        lambda: libc.syscall(56 if platform.machine() == "x86_64" else 220, flags, top, None, None, None),
        lambda: libc.syscall(436, 1 << 20, 1 << 21, 2),
    ):
        refused.append(call() == -1 and ctypes.get_errno() == errno.EPERM)
    raise AssertionError("refused" if all(refused) else f"HIDDEN {refused}")
