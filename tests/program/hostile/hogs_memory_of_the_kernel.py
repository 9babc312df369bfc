import ctypes
import os


def build(scene):
    try:
        file = os.memfd_create("hoard")
    except OSError:
        file = -1
    if file >= 0:
        raise AssertionError("memfd")
    if ctypes.CDLL(None).shmget(0, 1 << 20, 0o1600) != -1:
        raise AssertionError("shmget")
    raise PermissionError("refused, as it should be")
