import os
from pathlib import Path


def build(scene):
    for target in (Path(__file__), Path(__file__).with_name("planted"), Path("/tmp/planted"), Path(os.__file__)):
        try:
            with target.open("ab") as file:
                file.write(b"planted")
        except OSError:
            continue
        raise AssertionError(f"wrote to {target}")
    os.symlink("/etc/passwd", "link")
    with open("link", "ab") as file:
        file.write(b"planted")
