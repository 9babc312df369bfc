"""A seesaw from the catalogue and two crates of different weight dropped on its ends."""
from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0)
    scene.ground()
    scene.asset("seesaw", "seesaw", position=(0, 0, 0))
    light, heavy = 5.0, scene.param("heavy", 12.0, low=5.0, high=40.0, unit="kg")
    for name, x, mass in (("left_load", -1.0, light), ("right_load", 1.0, heavy)):
        scene.box(name, size=(0.25, 0.25, 0.25), position=(x, 0, 1.4), mass=mass, friction=0.7)
    scene.camera("side", eye=(0, -5, 1.5), target=(0, 0, 0.5))
