"""What holds things still holds them: measured in what collides, and tried with a ball and a mug."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.intake import models
from wsim.assets import Asset, get
from wsim.assets.folders import VARIABLE
from wsim.intake import Wanted, add
from wsim.intake.collide import OPEN
from wsim.scene import Scene
from wsim.sim import Simulation

BALL = 0.02  # [m]


@pytest.fixture(scope="module")
def holders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Asset, Asset]:
    """A bowl, a surface of revolution, and a cabinet of boards."""
    folder = tmp_path_factory.mktemp("holders")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, str(folder / "own"))
        bowl = Wanted("own bowl", density=2300.0, picture=False)
        cupboard = Wanted("own cupboard", density=600.0, picture=False)
        add(models.write(models.bowl(), folder / "bowl.stl"), bowl)
        add(models.write(models.cabinet(), folder / "cupboard.glb"), cupboard)
        return get("own_bowl"), get("own_cupboard")


def test_the_bowl_stays_open(holders: tuple[Asset, Asset]) -> None:
    bowl, _ = holders
    made = bowl.collision
    assert made.method == "coacd" and made.parts > 4
    assert made.hollow_open[0].open >= OPEN
    assert 1.0 <= made.volume_ratio < 1.4
    assert made.hausdorff < models.BOWL_WALL
    assert bowl.mass == pytest.approx(2300.0 * models.bowl().volume, rel=1e-4)


def test_the_cabinet_is_its_boards(holders: tuple[Asset, Asset]) -> None:
    _, cabinet = holders
    made = cabinet.collision
    assert (made.method, made.parts) == ("shapes", 6)
    assert [room.open for room in made.hollow_open] == pytest.approx([1.0, 1.0], abs=0.01)
    assert made.volume_ratio == pytest.approx(1.0, abs=0.02)
    d, w, h = models.CABINET
    t = models.BOARD
    volume = t * (2 * d * h + 2 * d * (w - 2 * t) + (d - t) * (w - 2 * t) + (w - 2 * t) * (h - 2 * t))
    assert cabinet.mass == pytest.approx(600.0 * volume, rel=1e-3)
    free = (d - t, w - 2 * t, h / 2 - 1.5 * t)
    cell = h / 112
    assert np.array(cabinet.hollow.size) == pytest.approx(free, abs=2.5 * cell)


def test_a_ball_stays_in_the_bowl_and_a_mug_on_the_shelf(
    holders: tuple[Asset, Asset], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bowl, _ = holders
    monkeypatch.setenv(VARIABLE, str(bowl.path.parents[1]))
    shelf = models.CABINET[2] / 2 + models.BOARD / 2
    scene = Scene()
    scene.simulation(duration=1.5, frame_rate=50.0)
    scene.ground()
    scene.asset("bowl", "own_bowl", position=(0.0, 0.0, 0.001))
    scene.sphere("ball", radius=BALL, density=1000.0, position=(0.01, 0.0, bowl.size[2] + BALL))
    scene.asset("cupboard", "own_cupboard", position=(1.0, 0.0, 0.001))
    scene.asset("mug", "mug", position=(1.02, 0.05, shelf + 0.003))
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), device="cpu", time_step=1.0 / 800.0)
    for _ in range(75):
        simulation.advance_frame()
    poses = simulation.state.body_q.numpy()[simulation.built.bodies]
    at = {body.prim: pose[:3] for body, pose in zip(simulation.world.bodies, poses, strict=True)}
    assert simulation.problems() == []
    floor = bowl.anchors["inside"][2]
    assert np.linalg.norm((at["/World/ball"] - at["/World/bowl"])[:2]) < 0.03
    assert at["/World/ball"][2] < bowl.size[2] / 2 + BALL
    assert at["/World/ball"][2] == pytest.approx(models.BOWL_WALL + BALL, abs=max(0.006, floor))
    assert at["/World/bowl"][2] == pytest.approx(0.0, abs=0.002)
    assert at["/World/mug"][2] == pytest.approx(shelf, abs=0.002)
    assert np.linalg.norm(at["/World/mug"][:2] - [1.02, 0.05]) < 0.005
    assert at["/World/cupboard"][2] == pytest.approx(0.0, abs=0.002)
