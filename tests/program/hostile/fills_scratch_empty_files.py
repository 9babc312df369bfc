def build(scene):
    i = 0
    while True:
        i += 1
        open(f"empty_{i}", "wb").close()
