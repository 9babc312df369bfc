"""Draw the picture of vehicles.md: the kinds of vehicle that there are.

python docs/draw_vehicles.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image

from wsim.scene import Scene
from wsim.scene.vehicle_spec import presets
from wsim.sim import Simulation
from wsim.sim.cameras import CameraRenderer

INTO = Path(__file__).parent / "images" / "vehicles.png"
APART = 3.1  # [m]


def build(scene: Scene) -> None:
    """All kinds in a row, the smallest in front, their wheels turned."""
    scene.ground(color=(0.45, 0.42, 0.36))
    order = [kind for kind in ("cart", "polaris", "car", "hmmwv", "truck") if kind in presets()]
    for k, kind in enumerate(order):
        scene.vehicle(kind, kind, position=(0.4 * k - 0.8, APART * (k - 2), 0.0)).steer(15.0)
    scene.camera("view", eye=(10.2, -4.0, 5.0), target=(0.6, 0.0, 0.6), fov=80.0, width=960, height=480)


if __name__ == "__main__":
    scene = Scene()
    build(scene)
    scene.simulation(frame_rate=4.0)
    with tempfile.TemporaryDirectory() as folder:
        simulation = Simulation(scene.save(Path(folder) / "vehicles.usda"), device="cpu")
        simulation.advance_frame()  # its wheels take a moment to turn
        picture = CameraRenderer(simulation.model, simulation.world).render(simulation.state)
    (drawn,) = picture.values()
    Image.fromarray(drawn.rgb).save(INTO)
