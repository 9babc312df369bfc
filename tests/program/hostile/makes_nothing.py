def build(scene):
    scene.param("unused", 1.0)
