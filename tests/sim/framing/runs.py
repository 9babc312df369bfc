"""Runs of small worlds for cameras: with small pictures, or without."""

import json
import tempfile
from pathlib import Path

from wsim.recording import read
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.framing.motion import Motion

WIDTH, HEIGHT = 160, 90
ENOUGH = 7  # pixels of these pictures: of a ball that is 3 px across, 12 of a picture of 640


def a_world(duration=0.6, frame_rate=25.0):
    """With ground."""
    scene = Scene()
    scene.simulation(duration=duration, frame_rate=frame_rate)
    scene.ground()
    return scene


def a_camera(scene, eye=(0.0, -3.0, 1.0), target=(0.0, 0.0, 0.5), **more):
    """A small picture, of what a plan thinks will happen."""
    return scene.camera("main", eye=eye, target=target, width=WIDTH, height=HEIGHT, **more)


def drawn(scene, named=()):
    """Pixels of each object in each still, by camera and in order of time, and the recording."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulation = Simulation(scene.save(folder / "stage.usda"), device="cpu", draws=True)
        simulation.run(folder / "r.rrd", folder / "v.mp4", folder / "frames", folder / "review.json", named=named)
        rows = json.loads((folder / "review.json").read_text(encoding="utf-8"))["share_of_picture"]
        found, stills = read(folder / "r.rrd"), {}
        sizes = {camera.prim: camera.width * camera.height for camera in found.views}
        for row in rows:
            size = sizes[row["camera"]]
            stills.setdefault(row["camera"], []).append(
                {prim: round(share * size) for prim, share in row["objects"].items()}
            )
        return stills, found


def recorded(scene, folder):
    """What happened in a world, and the world, without pictures."""
    stage = scene.save(folder / "stage.usda")
    Simulation(stage, device="cpu").run(folder / "r.rrd")
    return describe(stage), Motion.of(read(folder / "r.rrd"))
