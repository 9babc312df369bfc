def make(scene):
    pass
