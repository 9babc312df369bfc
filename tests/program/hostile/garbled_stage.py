def build(scene):
    scene.ground()

    def save(self, path):
        with open(path, "w") as file:
            file.write("#usda 1.0\n" + "{" * 100_000)

    type(scene).save = save
