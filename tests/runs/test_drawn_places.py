"""Drawn places: a linkage is moved as one, and moves on as it did; what floats goes with its level."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.runs.draws import apply
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim import Simulation
from wsim.sim.collect import collect

Build = Callable[[Scene], None]
POSE = {"upper.pose.x": 0.3, "upper.pose.y": -0.2, "upper.pose.turn": 35.0}


def drawn(folder: Path, build: Build, draws: dict[str, float]) -> tuple[World, World, Path]:
    """What a stage says before and after, and its file."""
    scene = Scene()
    build(scene)
    path = folder / f"{len(draws)}.usda"
    scene.save(str(path))
    before = describe(path)
    apply(path, draws)
    return before, describe(path), path


def linkage(scene: Scene) -> None:
    """A pendulum of two rods on a post that stands, and another one that has nothing to do with it."""
    scene.simulation(duration=0.6, frame_rate=20.0)
    scene.ground()
    scene.box("post", size=(0.1, 0.1, 1.5), position=(-0.1, 1, 0.75), static=True)
    scene.box("upper", size=(0.5, 0.05, 0.05), mass=1.0, position=(0.25, 1, 1.5), rotation_deg=(0, 0, 0))
    scene.box("lower", size=(0.05, 0.05, 0.4), mass=0.7, position=(0.5, 1, 1.3), rotation_deg=(0, 0, 20))
    scene.joint_revolute("hinge", "post", "upper", anchor=(0, 1, 1.5), axis="Y")
    scene.joint_spherical("elbow", "upper", "lower", anchor=(0.5, 1, 1.5))
    scene.box("alone", size=(0.4, 0.05, 0.05), mass=1.0, position=(0.2, 5, 1), rotation_deg=(0, 0, 0))
    scene.joint_revolute("other", None, "alone", anchor=(0, 5, 1), axis="Y")


def turned(world: World, position: np.ndarray) -> np.ndarray:
    """Where the pose has places (..., 3) of the linkage, turned about the upper rod's origin."""
    about, angle = np.array(world.body("/World/upper").position), math.radians(POSE["upper.pose.turn"])
    q = np.array([0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)])
    return about + rotate(q, position - about) + (POSE["upper.pose.x"], POSE["upper.pose.y"], 0.0)


def test_a_linkage_is_moved_as_one_with_what_it_stands_on(tmp_path: Path) -> None:
    before, after, _ = drawn(tmp_path, linkage, POSE)
    for name in ("upper", "lower"):
        old, new = before.body(f"/World/{name}"), after.body(f"/World/{name}")
        np.testing.assert_allclose(new.position, turned(before, np.array(old.position)), atol=1e-6)
        assert new.mass == pytest.approx(old.mass)
    assert after.body("/World/alone") == before.body("/World/alone")
    old_joints, new_joints = ({joint.prim: joint for joint in world.joints} for world in (before, after))
    for prim in ("/World/other", "/World/elbow"):
        for side in ("parent_anchor", "parent_turn", "child_anchor", "child_turn"):
            old, new = getattr(old_joints[prim], side), getattr(new_joints[prim], side)
            np.testing.assert_allclose(new, old, atol=1e-7)
    hinge = new_joints["/World/hinge"]
    np.testing.assert_allclose(hinge.parent_anchor, turned(before, np.array([0.0, 1.0, 1.5])), atol=1e-6)
    np.testing.assert_allclose(hinge.child_anchor, old_joints["/World/hinge"].child_anchor, atol=1e-6)
    post = {static.prim: static for static in after.statics}["/World/post"].shapes[0]
    np.testing.assert_allclose(post.position, turned(before, np.array([-0.1, 1.0, 0.75])), atol=1e-6)


def test_a_linkage_that_was_moved_moves_as_before_seen_from_its_own_place(tmp_path: Path) -> None:
    """No law of motion knows where a world is, nor which way it looks."""
    before, _, here = drawn(tmp_path, linkage, {})
    _, _, there = drawn(tmp_path, linkage, POSE)
    q = np.asarray(collect(Simulation([here, there], "cpu")).body_q)
    names = [body.prim for body in before.bodies]
    for name in ("upper", "lower"):
        ways = q[:, :, names.index(f"/World/{name}"), :3]
        assert np.ptp(ways[0], axis=0).max() > 0.2  # it swings
        np.testing.assert_allclose(ways[1], turned(before, ways[0]), atol=2e-4)


def test_two_members_of_one_linkage_are_one_number(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"lower\.pose: upper\.pose is the same number"):
        drawn(tmp_path, linkage, {"upper.pose.x": 0.1, "lower.pose.x": 0.1})


def roped(scene: Scene) -> None:
    linkage(scene)
    scene.spring("spring", None, "lower", anchor_a=(0.5, 1, 2), stiffness=10.0)


def test_a_linkage_that_a_spring_holds_is_refused_and_left(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"upper\.pose: /World/spring holds lower to where it is"):
        drawn(tmp_path, roped, POSE)


def harbour(scene: Scene) -> None:
    """A raft with a crate on it, a stone under water, a pillar that stands, a ball in the air, a buoy on a rope."""
    scene.ground()
    tank = scene.tank("tank", inner_size=(2, 1, 0.8), position=(0, 0, 0))
    scene.fluid("water", fills=tank, level=0.4, spacing=0.05)
    inside = describe(scene.stage).fluids[0]
    surface, bottom = inside.center[2] + inside.size[2] / 2, inside.center[2] - inside.size[2] / 2
    scene.box("raft", size=(0.4, 0.4, 0.1), density=500.0, position=(0.5, 0, surface))
    scene.box("crate", size=(0.1, 0.1, 0.1), density=300.0, position=(0.5, 0, surface + 0.1))
    scene.box("lid", size=(0.1, 0.1, 0.02), density=300.0, position=(0.5, 0, surface + 0.16))
    scene.box("stone", size=(0.1, 0.1, 0.1), density=2000.0, position=(0, 0, bottom + 0.1))
    scene.box("pillar", size=(0.1, 0.1, 0.6), density=2000.0, position=(-0.4, 0, bottom + 0.3))
    scene.sphere("ball", radius=0.05, density=500.0, position=(-0.7, 0, surface + 0.3))
    scene.sphere("buoy", radius=0.05, density=500.0, position=(-0.7, 0.3, surface))
    scene.rope("rope", None, "buoy", anchor_a=(-0.7, 0.3, bottom), length=0.5)
    scene.box("quay", size=(0.2, 0.2, 0.2), density=500.0, position=(3, 0, surface))


@pytest.mark.parametrize("level", [0.3, 0.6])
def test_what_floats_goes_with_its_level_and_what_stands_on_it(tmp_path: Path, level: float) -> None:
    before, after, _ = drawn(tmp_path, harbour, {"tank.level": level})
    for old, new in zip(before.bodies, after.bodies, strict=True):
        rise = level - 0.4 if old.prim in ("/World/raft", "/World/crate", "/World/lid") else 0.0
        np.testing.assert_allclose(new.position, np.add(old.position, (0.0, 0.0, rise)), atol=1e-6)
        assert new.model_copy(update={"position": old.position}) == old


def test_a_level_at_which_what_floats_would_reach_through_the_bottom_is_refused(tmp_path: Path) -> None:
    def shallow(scene: Scene) -> None:
        scene.ground()
        tank = scene.tank("tank", inner_size=(1, 1, 0.8), position=(0, 0, 0))
        scene.fluid("water", fills=tank, level=0.4, spacing=0.05)
        top = describe(scene.stage).fluids[0]
        scene.box("block", size=(0.3, 0.3, 0.4), density=500.0, position=(0, 0, top.center[2] + top.size[2] / 2))

    with pytest.raises(UserError, match=r"tank\.level = 0\.15 m: /World/block floats 0\.2 m deep in it") as told:
        drawn(tmp_path, shallow, {"tank.level": 0.15})
    assert "\n" not in str(told.value)
