"""Drawn numbers on a stage: nothing else changes, and the world moves as theory has it for them."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.sim.cord_runs import period
from wsim.errors import UserError
from wsim.runs.draws import apply
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim import Simulation
from wsim.sim.alike import alike
from wsim.sim.collect import collect

G = 9.81
Build = Callable[[Scene], None]


def drawn(folder: Path, build: Build, **draws: float) -> tuple[World, World, Path]:
    """What a stage says before and after, and its file."""
    scene = Scene()
    build(scene)
    path = folder / "stage.usda"
    scene.save(str(path))
    before = describe(path)
    apply(path, {name.replace("__", ".").replace("_x_", " x"): value for name, value in draws.items()})
    return before, describe(path), path


def yard(scene: Scene) -> None:
    """Bodies that share a material, a compound whose axes are not its own, a turned one, a tank."""
    scene.ground(friction=0.8)
    wood = scene.material("wood", density=600.0, friction=0.4, restitution=0.2, rolling=0.02)
    scene.box("crate", size=(0.4, 0.3, 0.1), position=(1, 2, 0.05), material=wood, rotation_deg=(0, 0, 30))
    scene.sphere("ball", radius=0.1, position=(2, 0, 0.1), material=wood)
    scene.box("slab", size=(0.4, 0.3, 0.2), position=(3, 0, 1), mass=3.0, rotation_deg=(20, 30, 40), velocity=(1, 2, 3))
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.4), position=(0, -1, 0))
    scene.fluid("water", fills=tank, level=0.2, spacing=0.05)
    scene.box("wall", size=(0.2, 1, 1), position=(5, 0, 0.5), static=True)
    scene.box("arm", size=(0.5, 0.1, 0.1), mass=1.0, position=(0, 4, 2))
    scene.joint_revolute("hinge", None, "arm", anchor=(0, 4, 2), axis="Y")
    scene.contact("wall", "ball", friction=0.3)
    scene.box("held", size=(0.1,) * 3, mass=1.0, position=(0, 6, 2))
    scene.spring("spring", None, "held", anchor_a=(0, 6, 3), stiffness=100.0)


def test_a_mass_takes_its_inertia_along_and_nothing_else(tmp_path: Path) -> None:
    before, after, path = drawn(tmp_path, yard, crate__mass_x_=1.7, slab__mass=5.0)
    share = {"/World/crate": 1.7, "/World/slab": 5.0 / 3.0}
    for old, new in zip(before.bodies, after.bodies, strict=True):
        by = share.get(old.prim, 1.0)
        assert new.mass == pytest.approx(by * old.mass, rel=1e-6)
        np.testing.assert_allclose(new.inertia, by * np.array(old.inertia), atol=1e-6 * by * np.trace(inertia(old)))
        np.testing.assert_allclose(new.com, old.com, atol=1e-7)
        assert new.model_copy(update={"mass": old.mass, "inertia": old.inertia, "com": old.com}) == old
    assert after.model_copy(update={"bodies": before.bodies}) == before
    assert len(alike([before, after])) == 1
    assert not [each.name for each in tmp_path.iterdir() if each != path]


def inertia(body):
    return np.reshape(body.inertia, (3, 3))


def test_a_friction_is_the_objects_own_though_others_share_its_material(tmp_path: Path) -> None:
    before, after, _ = drawn(tmp_path, yard, crate__friction=0.123)
    old, new = before.body("/World/crate"), after.body("/World/crate")
    assert new.shapes[0].friction == pytest.approx(0.123)
    assert (
        new.shapes[0].model_copy(update={"friction": old.shapes[0].friction}) == old.shapes[0]
    )  # rolling, bounce, look
    assert (new.mass, new.inertia) == (old.mass, old.inertia)  # the density is the material's
    assert after.body("/World/ball") == before.body("/World/ball")
    assert after.statics == before.statics


def test_a_pose_moves_and_turns_the_object_alone(tmp_path: Path) -> None:
    draws = {"slab.pose.x": 0.05, "slab.pose.y": -0.02, "slab.pose.turn": 7.0, "wall.pose.x": 0.1}
    before, after, path = drawn(tmp_path, yard)
    apply(path, draws)
    after = describe(path)
    old, new = before.body("/World/slab"), after.body("/World/slab")
    np.testing.assert_allclose(np.subtract(new.position, old.position), (0.05, -0.02, 0.0), atol=1e-9)
    turn = math.radians(7.0)
    about = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
    np.testing.assert_allclose(new.velocity, about @ old.velocity, atol=1e-6)  # it goes where it looks
    assert new.shapes[0].size == pytest.approx(old.shapes[0].size)
    assert new.mass == pytest.approx(old.mass)
    wall = {static.prim: static for static in after.statics}["/World/wall"].shapes[0]
    np.testing.assert_allclose(wall.position, (5.1, 0.0, 0.5), atol=1e-9)
    assert wall.size == pytest.approx((0.2, 1.0, 1.0))
    for name in ("crate", "ball", "arm"):
        assert after.body(f"/World/{name}") == before.body(f"/World/{name}")


@pytest.mark.parametrize("name", ["tank.level", "water.level"])
def test_a_level_rises_above_a_bottom_that_stays(tmp_path: Path, name: str) -> None:
    before, _, path = drawn(tmp_path, yard)
    apply(path, {name: 0.3})
    (old,), (new,) = before.fluids, describe(path).fluids
    assert new.size == pytest.approx((0.3, 0.3, 0.3))
    assert new.center[2] - new.size[2] / 2 == pytest.approx(old.center[2] - old.size[2] / 2, abs=1e-7)
    assert new.center[:2] == pytest.approx(old.center[:2])


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("crat.mass", 1.0, "crat.mass: the world has no 'crat'; did you mean \"crate\"?"),
        ("wall.mass", 1.0, "wall.mass: wall never moves, and has no mass"),
        ("crate.level", 0.1, "crate.level: crate names no fluids; the world has water"),
        ("tank.level", 0.45, "tank.level = 0.45 m is above the rim, 0.4 m"),
        ("tank.level x", 0.1, "tank.level = 0.02 m is less than a particle"),
        ("ball.friction", 0.3, "states the friction of a pair, which comes first"),
        ("slab.friction x", 1.1, "/World/slab/geometry states no friction to multiply"),
        ("crate.friction x", 30.0, "crate.friction = 12 is above 10"),
        ("held.pose.x", 0.1, "held.pose: /World/spring holds held to where it is"),
        ("tank.pose.turn", 0.1, "tank.pose: /World/water holds tank to where it is"),
    ],
)
def test_what_cannot_be_set_is_said_in_a_line(tmp_path: Path, name: str, value: float, said: str) -> None:
    before, _, path = drawn(tmp_path, yard)
    with pytest.raises(UserError) as told:
        apply(path, {name: value})
    assert said in str(told.value)
    assert "\n" not in str(told.value)
    assert describe(path) == before


@pytest.mark.parametrize(
    ("one", "other"),
    [("crate.mass", "/World/crate.mass x"), ("tank.level", "water.level"), ("ball.pose.x", "/World/ball.pose.x")],
)
def test_two_names_of_one_number_are_refused(tmp_path: Path, one: str, other: str) -> None:
    before, _, path = drawn(tmp_path, yard)
    with pytest.raises(UserError, match="is the same number; give it once"):
        apply(path, {one: 0.3, other: 0.31})
    assert describe(path) == before


def batch(folder: Path, build: Build, name: str, values: list[float]) -> np.ndarray:
    """One batch of worlds, one for each value of a number: (world, frame, body, 7)."""
    stages = []
    for k, value in enumerate(values):
        (folder / f"{k}").mkdir()
        _, _, path = drawn(folder / f"{k}", build)
        apply(path, {name: value})
        stages.append(path)
    return np.asarray(collect(Simulation(stages, "cpu")).body_q)


def test_crates_slide_as_far_as_their_drawn_friction_lets_them(tmp_path: Path) -> None:
    """v^2 / (2 mu g), each in its world of one batch."""
    frictions, speed = [0.2, 0.35, 0.6], 1.5

    def build(scene: Scene) -> None:
        scene.simulation(duration=1.0, frame_rate=10.0)
        scene.ground(friction=1.0)
        scene.box("crate", size=(0.4, 0.4, 0.05), position=(0, 0, 0.025), velocity=(speed, 0, 0), friction=0.4)

    q = batch(tmp_path, build, "crate.friction", frictions)
    far = q[:, -1, 0, 0] - q[:, 0, 0, 0]
    np.testing.assert_allclose(far, [speed**2 / (2.0 * mu * G) for mu in frictions], rtol=0.01)


def test_a_weight_bobs_with_the_period_of_its_drawn_mass(tmp_path: Path) -> None:
    masses = [1.0, 2.0, 4.5]

    def build(scene: Scene) -> None:
        scene.simulation(duration=2.0, frame_rate=100.0)
        scene.box("weight", size=(0.1,) * 3, density=1500.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 2), stiffness=400.0)

    q = batch(tmp_path, build, "weight.mass", masses)
    for z, mass in zip(q[:, :, 0, 2], masses, strict=True):
        assert period(z - (1.0 - mass * G / 400.0)) == pytest.approx(2 * math.pi * math.sqrt(mass / 400.0), rel=1e-3)


def test_a_pendulum_swings_no_slower_for_its_drawn_mass(tmp_path: Path) -> None:
    """A rod about its end: 2 pi sqrt(2 L / 3 g), if the inertia goes with the mass; else by up to a third slower."""

    def build(scene: Scene) -> None:
        scene.simulation(duration=4.0, frame_rate=100.0)
        scene.box("rod", size=(0.02, 0.02, 1.0), mass=1.0, position=(0, 0, 1.5), rotation_deg=(0, 0, 0))
        scene.joint_revolute("hinge", None, "rod", anchor=(0, 0, 2), axis="Y")

    def pushed(scene: Scene) -> None:
        build(scene)
        prim = scene.stage.GetPrimAtPath("/World/rod")
        prim.GetAttribute("physics:angularVelocity").Set((0.0, 6.0, 0.0))
        prim.GetAttribute("physics:velocity").Set((-0.5 * math.radians(6.0), 0.0, 0.0))

    q = batch(tmp_path, pushed, "rod.mass", [0.2, 1.0, 7.0])
    for x in q[:, :, 0, 0]:
        slim = 1.0 / 3.0 + 0.02**2 / 12.0  # about its end, of 1 kg and 1 m
        assert period(x) == pytest.approx(2.0 * math.pi * math.sqrt(slim / (G * 0.5)), rel=2e-3)
