"""Masks of what may touch, held against the pairs that they are of, and a door beside a heap."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers.collision_masks import by_kinds


def touching(masks) -> np.ndarray:
    contype, conaffinity = masks
    one = (contype[:, None] & conaffinity) != 0
    return one | one.T


@pytest.mark.parametrize("seed", range(20))
def test_what_is_kept_apart_is_apart_and_nothing_else(seed: int) -> None:
    """A crowd that touches all, and a few kinds that keep from others or from themselves."""
    draw = np.random.default_rng(seed)
    body = np.concatenate([np.full(5, -1), np.arange(60)])
    kind = draw.integers(0, 6, len(body))
    rule = np.triu(draw.random((6, 6)) < 0.3)
    apart = (rule | rule.T)[kind][:, kind] & ~np.eye(len(body), dtype=bool)
    group = (draw.random(len(body)) < 0.9).astype(int)
    masks = by_kinds(body, group, np.argwhere(np.triu(apart)))
    assert masks is not None and max(each.max() for each in masks) < 2**32
    both = (group[:, None] & group).astype(bool)
    one_body = body[:, None] == body
    moving = (body[:, None] >= 0) & (body >= 0)  # MuJoCo keeps those apart by their bodies
    asked = both & ~one_body & ~(moving & apart)
    np.testing.assert_array_equal(touching(masks) & asked, ~apart & asked)


def test_more_kinds_than_bits_are_none() -> None:
    body = np.array([-1] * 40 + list(range(40)))
    assert by_kinds(body, np.ones(80, dtype=int), np.array([(k, 40 + k) for k in range(40)])) is None
    assert by_kinds(body, np.full(80, 2), np.empty((0, 2), dtype=int)) is None


def doors(folder: Path, count: int) -> Path:
    """So many doors, each in a static post of its own."""
    scene = Scene()
    for k in range(count):
        scene.box(f"post_{k}", size=(0.1, 0.4, 1.0), position=(0, 2.0 * k, 2.0), static=True)
        scene.box(f"door_{k}", size=(0.8, 0.04, 0.04), position=(0.4, 2.0 * k, 2.0), mass=1.0)
        scene.joint_revolute(f"hinge_{k}", f"post_{k}", f"door_{k}", axis="Y", anchor=(0, 2.0 * k, 2.0))
    return scene.save(folder / "doors.usda")


def test_as_many_doors_as_there_are_colours_are_kept_from_their_posts_and_more_are_refused(tmp_path: Path) -> None:
    """A door and its post are of one colour, and Newton has 32."""
    simulation = Simulation(doors(tmp_path, 30), device="cpu")
    while simulation.time < 0.1:
        simulation.advance_frame()
    rows = [k for k, body in enumerate(simulation.world.bodies) if "door" in body.prim]
    turned = 2 * np.arcsin(abs(simulation.state.body_q.numpy()[rows, 4]))
    assert turned.min() == pytest.approx(turned.max(), rel=1e-3) and turned.min() > 0.15
    with pytest.raises(UserError, match=r"door_.* not to touch, nor are .* kinematic=True in place of static=True"):
        Simulation(doors(tmp_path, 40), device="cpu")


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_door_in_its_post_swings_beside_forty_balls(tmp_path: Path, worlds: int) -> None:
    """It falls by its hinge as I w' = m g d at first; with 33 balls and more it had stuck in the post."""
    scene = Scene()
    scene.ground()
    scene.box("post", size=(0.1, 0.4, 1.0), position=(0, 0, 2.0), static=True)
    scene.box("door", size=(0.8, 0.04, 0.04), position=(0.4, 0, 2.0), mass=1.0)
    scene.joint_revolute("hinge", "post", "door", axis="Y", anchor=(0, 0, 2.0))
    for k in range(40):
        scene.sphere(f"ball_{k}", radius=0.05, position=(3.0 + 0.2 * (k % 8), 0.2 * (k // 8), 0.05), mass=0.1)
    simulation = Simulation(scene.save(tmp_path / "door.usda"), device="cpu", world_count=worlds)
    door = [body.prim for body in simulation.world.bodies].index("/World/door")
    while simulation.time < 0.1:
        simulation.advance_frame()
    turned = 2 * np.arcsin(abs(simulation.state.body_q.numpy()[door, 4]))
    inertia = (0.8**2 + 0.04**2) / 12 + 0.4**2
    assert turned == pytest.approx(0.5 * 9.81 * 0.4 / inertia * simulation.time**2, rel=0.01)
