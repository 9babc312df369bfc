def build(scene):
    scene.ground()
    raise RuntimeError("no such world")
