"""Every asset stands where it is put, and what falls into a hollow one comes to rest on its inner floor.

A stage holds several, far enough apart: one simulation answers for each. All in one would take longer: a step costs
more than in proportion to its bodies.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, UsdGeom

from wsim.assets import load_catalogue
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.sim import Simulation

CATALOGUE = load_catalogue()
HOLLOW = {id for id, asset in CATALOGUE.items() if asset.hollow}
TOGETHER = 8  # assets of a stage
SPACING = 6.0  # [m]
DROP = 0.001  # [m]
DURATION = 2.0  # [s]
THROWN = 0.5  # [m/s] along Y, where every hollow asset has walls


def place(scene: Scene, name: str, id: str, slot: int) -> tuple[float, float]:
    x, y = SPACING * (slot % 5), SPACING * (slot // 5)
    prim = UsdGeom.Xform.Define(scene.stage, f"/World/{name}")
    prim.GetPrim().GetReferences().AddReference(str(CATALOGUE[id].path))
    prim.AddTranslateOp().Set(Gf.Vec3d(x, y, DROP))
    return x, y


def radius_of(id: str) -> float:
    return min(0.03, 0.25 * min(CATALOGUE[id].hollow.size))


class World:
    """Assets, and in the hollow ones a ball of a speed [m/s]: poses by prim path, at the start and at the end."""

    def __init__(self, folder: Path, ids: list[str], speed: float = 0.0, duration: float = DURATION) -> None:
        scene = Scene()
        scene.simulation(duration=duration, frame_rate=50.0)
        scene.ground()
        self.places = {id: place(scene, id, id, slot) for slot, id in enumerate(ids)}
        for id in HOLLOW & self.places.keys():
            x, y = self.places[id]
            cx, cy, cz = CATALOGUE[id].hollow.center
            start, velocity = (x + cx, y + cy, cz + DROP), (0.0, speed, 0.0)
            scene.sphere(f"ball_{id}", radius=radius_of(id), density=1000.0, position=start, velocity=velocity)
        self.stage = scene.save(folder / "stage.usda")
        # The step that wsim takes for bodies that fall this little, were not one of them a seesaw's plank in the air.
        simulation = Simulation(self.stage, device="cpu", time_step=1.0 / 800.0)
        self.start = self._poses(simulation)
        for _ in range(round(duration * 50.0)):
            simulation.advance_frame()
        self.problems = simulation.problems()
        self.end = self._poses(simulation)

    def bodies(self, id: str) -> list[str]:
        """Prim paths of an asset's bodies."""
        return [prim for prim in self.start if prim == f"/World/{id}" or prim.startswith(f"/World/{id}/")]

    @staticmethod
    def _poses(simulation: Simulation) -> dict[str, np.ndarray]:
        poses = simulation.state.body_q.numpy()[simulation.built.bodies]
        return {body.prim: pose for body, pose in zip(simulation.world.bodies, poses, strict=True)}


STAGES = [list(CATALOGUE)[k : k + TOGETHER] for k in range(0, len(CATALOGUE), TOGETHER)]


@pytest.fixture(scope="module", params=STAGES, ids=lambda ids: ids[0])
def world(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> World:
    return World(tmp_path_factory.mktemp("standing"), request.param)


def tilt(pose: np.ndarray) -> float:
    """Angle between a body's Z axis and the vertical [deg]."""
    x, y = pose[3:5]
    return math.degrees(math.acos(min(1.0, 1.0 - 2.0 * (x * x + y * y))))


def turned(start: np.ndarray, end: np.ndarray) -> float:
    """Angle between two orientations [deg]."""
    return math.degrees(2.0 * math.acos(min(1.0, abs(float(start[3:] @ end[3:])))))


def test_stage_is_sound(world: World) -> None:
    folder = next(iter(CATALOGUE.values())).path.parents[1]
    assert check_stage(world.stage, [world.stage.parent, folder]) == []


def test_nothing_goes_wrong(world: World) -> None:
    assert world.problems == []


def test_each_stands(world: World) -> None:
    """With all its parts: no door opens, no drawer slides out."""
    for id in world.places.keys() & CATALOGUE.keys():
        assert world.bodies(id)
        for prim in world.bodies(id):
            start, end = world.start[prim], world.end[prim]
            assert turned(start, end) < 1.0, prim
            assert np.linalg.norm((end - start)[:2]) < 0.005, prim
            assert end[2] == pytest.approx(start[2] - DROP, abs=0.002), prim


def test_a_ball_stays_on_an_inner_floor(world: World) -> None:
    for id in HOLLOW & world.places.keys():
        hollow = CATALOGUE[id].hollow
        ball = world.end[f"/World/ball_{id}"]
        floor = hollow.center[2] - hollow.size[2] / 2
        assert ball[2] == pytest.approx(floor + radius_of(id), abs=0.002), id
        away = np.abs(ball[:2] - world.places[id] - hollow.center[:2])
        assert (away <= np.array(hollow.size[:2]) / 2).all(), id


@pytest.mark.parametrize("ids", [sorted(HOLLOW)[k::4] for k in range(4)], ids=lambda ids: ids[0])
def test_a_ball_thrown_against_a_wall_stays_inside(tmp_path: Path, ids: list[str]) -> None:
    world = World(tmp_path, ids, THROWN, duration=1.0)
    assert world.problems == []
    for id in ids:
        asset = CATALOGUE[id]
        ball = world.end[f"/World/ball_{id}"]
        floor = asset.hollow.center[2] - asset.hollow.size[2] / 2
        assert abs(ball[1] - world.places[id][1]) < asset.size[1] / 2 - radius_of(id), id
        assert floor + radius_of(id) - 0.002 < ball[2] < asset.size[2], id


def test_seesaw_tilts_about_its_hinge_to_its_limit(tmp_path: Path) -> None:
    """A load on one seat brings that end down; the stand stays."""
    scene = Scene()
    scene.simulation(duration=1.5, frame_rate=50.0)
    scene.ground()
    place(scene, "seesaw", "seesaw", 0)
    x, y, z = CATALOGUE["seesaw"].anchors["front_seat"]
    scene.box("load", size=(0.2, 0.2, 0.2), density=1250.0, position=(x, y, z + 0.101 + DROP), friction=1.0)
    limit = scene.stage.GetPrimAtPath("/World/seesaw/hinge").GetAttribute("physics:upperLimit").Get()
    stage = scene.save(tmp_path / "stage.usda")

    simulation = Simulation(stage, device="cpu", time_step=1.0 / 800.0)
    most = 0.0
    for _ in range(75):
        simulation.advance_frame()
        poses = World._poses(simulation)
        # A blow on the stop rocks the stand: the hinge has turned by what the plank leans more than it.
        most = max(most, tilt(poses["/World/seesaw/plank"]) - tilt(poses["/World/seesaw/stand"]))
    assert simulation.problems() == []
    assert limit - 1.0 < most < limit + 2.0
    assert tilt(poses["/World/seesaw/stand"]) < 1.0
