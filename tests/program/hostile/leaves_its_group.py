import os


def build(scene):
    for leave in (os.setsid, lambda: os.setpgid(0, 0)):
        try:
            leave()
        except PermissionError:
            continue
        raise AssertionError("LEFT")
    raise AssertionError("still there")
