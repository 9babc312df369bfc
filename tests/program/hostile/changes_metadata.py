import os
import stat


def build(scene):
    before = os.stat(__file__)
    for change in (
        lambda: os.chmod(__file__, 0o777),
        lambda: os.utime(__file__, (1, 1)),
        lambda: os.setxattr(__file__, "user.planted", b"1"),
        lambda: os.truncate(__file__, 0),
        lambda: os.close(os.open(__file__, os.O_RDONLY | os.O_TRUNC)),
        lambda: os.unlink(__file__),
        lambda: os.rename(__file__, __file__ + ".gone"),
    ):
        try:
            change()
        except OSError:
            continue
    after = os.stat(__file__)
    same = (stat.S_IMODE(before.st_mode), before.st_mtime, before.st_size) == (
        stat.S_IMODE(after.st_mode),
        after.st_mtime,
        after.st_size,
    )
    raise AssertionError("unchanged" if same else "CHANGED")
