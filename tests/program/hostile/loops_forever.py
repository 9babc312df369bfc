def build(scene):
    while True:
        pass
