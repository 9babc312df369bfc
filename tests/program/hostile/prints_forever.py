def build(scene):
    while True:
        print("x" * 10_000)
