def build(scene):
    scene.box("block", size=(1.0, 1.0, 1.0), position=(0.0, 0.0, float("nan")))
