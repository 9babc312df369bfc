"""A kinematic paddle sweeps loose parts off a table; gravity of the Moon."""
from wsim.scene import Scene

MOON = (0.0, 0.0, -1.62)


def build(scene: Scene, ) -> None:
    scene.simulation(duration=4.0, gravity=MOON)
    scene.ground(height=-0.01, friction=0.9)
    table = scene.box("table", size=(1.2, 0.8, 0.05), position=(0, 0, 0.7), static=True, friction=0.3)
    top = 0.725
    common = dict(density=1200.0, friction=0.25)
    scene.box("part_box", size=(0.1, 0.1, 0.1), position=(0.0, 0.1, top + 0.05), **common)
    scene.cylinder("part_can", radius=0.04, height=0.12, position=(0.15, -0.1, top + 0.06), **common)
    scene.capsule("part_pill", radius=0.03, height=0.1, axis="Y", position=(0.3, 0.0, top + 0.03), **common)
    scene.sphere("part_ball", radius=0.05, position=(0.3, 0.25, top + 0.05), **{**common, "friction": 0.1})
    scene.box(
        "paddle", size=(0.04, 0.7, 0.15), position=(-0.55, 0, top + 0.08), kinematic=True, velocity=(0.3, 0, 0),
    )
    scene.camera("corner", eye=(1.8, -1.8, 1.8), target=(0, 0, 0.6))
    del table
