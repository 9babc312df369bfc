"""A box slides down a wedge that is read from a file beside the program."""
import math
from pathlib import Path

from wsim.scene import Scene

WEDGE = Path("wedge.obj")


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0, frame_rate=60.0)
    scene.ground()
    scene.mesh("wedge", file=WEDGE, scale=0.001, up_axis="Y", static=True, collision="none", friction=0.2)
    scene.mesh("loose_wedge", file=str(WEDGE), scale=(2e-4, 2e-4, 2e-4), up_axis="y", position=(0.0, 1.0, 0.3),
               collision="convexHull", density=700.0)
    slope = math.degrees(math.atan2(0.5, 1.0))
    scene.box("slider", size=(0.1, 0.1, 0.05), position=(0.1, -0.25, 0.52), rotation_deg=(0, slope, 0), mass=0.5, friction=0.1)
    scene.camera("side", eye=(0.5, -2.8, 0.9), target=(0.5, 0, 0.2))
