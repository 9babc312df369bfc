def build(scene):
    scene.ground()

    def save(self, path):
        with open(path, "wb") as file:
            file.write(b"PXR-USDC" + bytes(range(256)) * 10)

    type(scene).save = save
