"""A wooden block falls on the ground."""
from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0, 0, 1), density=600)
    scene.camera("side", eye=(0, -3, 1), target=(0, 0, 0.5))


if __name__ == "__main__":
    import wsim
    wsim.run(build)
