"""Masks of what may touch, held against the pairs that they are of, and a door beside a heap."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers.collision_masks import _kinds, by_kinds


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


@pytest.mark.parametrize("seed", range(30))
def test_clusters_of_many_kinds_share_their_bits(seed: int) -> None:
    """Robots of some shapes a link, of forms of which two never touch; one of all shapes, and a floor of its own form.

    What must touch does, and what is to keep apart does, unless MuJoCo knows of it by the bodies.
    """
    draw = np.random.default_rng(seed)
    robots, links, shapes = int(draw.integers(4, 40)), 4, 3
    body = np.concatenate([[-1, -1], np.repeat(np.arange(robots * links), shapes)])
    robot = np.concatenate([[-1, -1], np.repeat(np.arange(robots), links * shapes)])
    form = np.concatenate([[9, 1], np.tile(draw.integers(0, 3, links * shapes), robots)])
    rule = np.tile(np.triu(draw.random((links * shapes,) * 2) < 0.3, 1), (robots, robots))
    apart = np.zeros((len(body),) * 2, dtype=bool)
    apart[2:, 2:] = rule & (robot[2:, None] == robot[2:])
    apart |= (form[:, None] == 0) & (form == draw.integers(0, 2))  # another solver's, whatever body they are of
    apart = (apart | apart.T) & ~np.eye(len(body), dtype=bool)
    masks = by_kinds(body, np.ones_like(body), np.argwhere(np.triu(apart)), form)
    assert masks is not None and max(each.max() for each in masks) < 2**32
    asked = body[:, None] != body
    found = touching(masks)
    assert (found | apart)[asked].all()
    both = np.argwhere(found & apart & asked)
    whole = [apart[np.ix_(body == body[one], body == body[two])].all() for one, two in both]
    moving = [body[one] >= 0 and body[two] >= 0 for one, two in both]
    assert all(whole) and all(moving)
    if robots > 8:
        assert _kinds(apart & asked).max() > 32


def test_more_kinds_than_bits_are_none() -> None:
    """A chain of static shapes and bodies, each kept from the next: one cluster of eighty kinds."""
    body = np.array([-1] * 40 + list(range(40)))
    chain = [(k, 40 + k) for k in range(40)] + [(k + 1, 40 + k) for k in range(39)]
    assert by_kinds(body, np.ones(80, dtype=int), np.array(chain)) is None
    assert by_kinds(body, np.ones(80, dtype=int), np.array(chain[:40])) is not None
    assert by_kinds(body, np.full(80, 2), np.empty((0, 2), dtype=int)) is None


def doors(folder: Path, count: int, chained: bool = False) -> Path:
    """So many doors, each in a static post of its own; or the next one's, too."""
    scene = Scene()
    for k in range(count):
        scene.box(f"post_{k}", size=(0.1, 0.4, 1.0), position=(0, 2.0 * k, 2.0), static=True)
        scene.box(f"door_{k}", size=(0.8, 0.04, 0.04), position=(0.4, 2.0 * k, 2.0), mass=1.0)
        scene.joint_revolute(f"hinge_{k}", f"post_{k}", f"door_{k}", axis="Y", anchor=(0, 2.0 * k, 2.0))
        if chained and k:
            scene.joint_spherical(f"tie_{k}", f"post_{k}", f"door_{k - 1}", anchor=(0, 2.0 * k - 1.0, 2.0))
    return scene.save(folder / "doors.usda")


@pytest.mark.parametrize("count", [30, 50])
def test_doors_are_kept_from_their_posts(tmp_path: Path, count: int) -> None:
    """A door and its post are of one colour, and Newton has 32; above that they are clusters, which share bits."""
    simulation = Simulation(doors(tmp_path, count), device="cpu")
    while simulation.time < 0.1:
        simulation.advance_frame()
    rows = [k for k, body in enumerate(simulation.world.bodies) if "door" in body.prim]
    turned = 2 * np.arcsin(abs(simulation.state.body_q.numpy()[rows, 4]))
    assert turned.min() == pytest.approx(turned.max(), rel=1e-3) and turned.min() > 0.15


def test_a_chain_of_doors_that_is_too_long_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"door_.* not to touch, nor are .* kinematic=True in place of static=True"):
        Simulation(doors(tmp_path, 40, chained=True), device="cpu")


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
