def build(scene):
    build(scene)
