import ctypes


def build(scene):
    ctypes.string_at(0)
