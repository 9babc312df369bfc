def build(scene):
    hoard = []
    while True:
        hoard.append(b"x" * 10_000_000)
