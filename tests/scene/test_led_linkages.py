"""Linkages between things that go their own way: which are refused, and that feasible ones are not."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from pxr import UsdPhysics

from wsim.scene import Scene
from wsim.scene.check import check_stage

BALL, HINGE = "joint_spherical", "joint_revolute"
CUBE = {"size": (0.02, 0.02, 0.02)}
BENT = np.array([(0.0, 0.0, 0.0), (0.5, 0.0, 0.6), (1.0, 0.0, 0.0)])  # two rods of 0.78 m


def linked(scene: Scene, kinds: str, places: np.ndarray, *, axis: str = "Y", welded: float = 0.0) -> None:
    """Rods from the world to the kinematic body `lead`, by joints H or B; at its end a body welded to it, if asked."""
    rods = [f"rod_{k}" for k in range(len(places) - 1)]
    for rod, (start, end) in zip(rods, pairwise(places), strict=True):
        scene.box(rod, position=(0.5 * (start + end)).tolist(), **CUBE)
    last = "lead"
    if welded:
        scene.box("welded", position=places[-1].tolist(), **CUBE)
        scene.joint_fixed("weld", "lead", "welded", anchor=(places[-1] + (welded, 0.0, 0.0)).tolist())
        last = "welded"
    for k, ((one, other), place, kind) in enumerate(
        zip(pairwise([None, *rods, last]), places, kinds, strict=True)
    ):  # fmt: skip
        if kind == "H":
            scene.joint_revolute(f"joint_{k}", one, other, anchor=place.tolist(), axis=axis)
        else:
            scene.joint_spherical(f"joint_{k}", one, other, anchor=place.tolist())


def problems(scene: Scene, folder: Path) -> list[str]:
    return check_stage(scene.save(folder / "stage.usda"), [folder])


@pytest.mark.parametrize(
    ("kinds", "velocity", "words"),
    [
        ("HHH", (0.0, 0.1, 0.0), "goes not along its hinges' axes, and after 0.016 s these part by 0.001563 m"),
        ("HHB", (0.0, 0.1, 0.0), "goes not along its hinges' axes"),
        ("BHH", (0.0, 0.1, 0.0), "goes not along its hinges' axes"),
        ("HHH", (0.3, 0.0, 0.1), ""),
        ("BHB", (0.0, 0.1, 0.0), ""),  # the plane of both rods turns
        ("HBH", (0.0, 0.1, 0.0), ""),
    ],
)
def test_a_lead_along_the_axes_of_parallel_hinges_is_refused(
    kinds: str, velocity: tuple[float, float, float], words: str, tmp_path: Path
) -> None:
    scene = Scene()
    scene.simulation(duration=1.0)
    scene.box("lead", position=(1.0, 0.0, 0.0), kinematic=True, velocity=velocity, **CUBE)
    linked(scene, kinds, BENT)
    found = problems(scene, tmp_path)
    assert len(found) == bool(words)
    assert all(words in problem and "</World/lead> and the world" in problem for problem in found)


@pytest.mark.parametrize(("kinds", "refused"), [("HHH", True), ("HHB", False)])
def test_a_lead_that_turns_the_axes_of_parallel_hinges_is_refused(kinds: str, refused: bool, tmp_path: Path) -> None:
    scene = Scene()
    scene.simulation(duration=1.0)
    scene.box("lead", position=(1.0, 0.0, 0.0), kinematic=True, angular_velocity_deg=(30.0, 0.0, 0.0), **CUBE)
    linked(scene, kinds, BENT)
    found = problems(scene, tmp_path)
    assert len(found) == refused
    assert all("these turn them" in problem for problem in found)


def test_a_lead_that_comes_nearer_than_a_linkage_folds_is_refused(tmp_path: Path) -> None:
    """Rods of 1 m and 0.4 m: their ends come to 0.6 m."""
    for nearest, refused in ((0.601, False), (0.599, True)):
        scene = Scene()
        scene.box("lead", position=(1.4, 0.0, 0.0), kinematic=True, **CUBE)
        scene.path("lead", times=[0.0, 1.0], positions=[(1.4, 0.0, 0.0), (nearest, 0.0, 0.0)])
        linked(scene, "BBB", np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.4, 0.0, 0.0)]))
        found = problems(scene, tmp_path)
        assert len(found) == refused
        assert all("comes to 0.6 m at best" in problem for problem in found)


@pytest.mark.parametrize("kinds", ["HH", "BB", "HB", "HHH"])
def test_what_hangs_on_a_body_that_is_welded_to_a_lead_is_led(kinds: str, tmp_path: Path) -> None:
    """A rod of 1 m whose end leaves sideways at 1 m/s would be 414 mm apart after 1 s, however far the weld is."""
    places = np.linspace((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), len(kinds))
    for velocity in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)):
        scene = Scene()
        scene.simulation(duration=1.0)
        scene.box("lead", position=(0.5, 0.0, 0.3), kinematic=True, velocity=velocity, **CUBE)
        linked(scene, kinds, places, welded=-0.5)
        found = problems(scene, tmp_path)
        assert len(found) == any(velocity)
        assert all("</World/lead>" in problem and "neither" in problem for problem in found)


@pytest.mark.parametrize("seed", range(40))
def test_a_linkage_that_follows_is_taken(seed: int, tmp_path: Path) -> None:
    """Linkages at random, led from one of their poses to another by way of poses between: by theory, none parts."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 6))
    lengths = rng.uniform(0.2, 1.0, count)
    planar = bool(seed % 2)
    angles, ends = rng.uniform(0.0, 2.0 * np.pi, count), rng.uniform(0.0, 2.0 * np.pi, count)
    lifts = np.zeros(count) if planar else rng.uniform(-1.0, 1.0, count)

    def pose(share: float) -> np.ndarray:
        turn = angles + share * (ends - angles)
        way = np.stack([np.cos(turn) * np.cos(lifts), np.sin(lifts), np.sin(turn) * np.cos(lifts)], axis=-1)
        return np.concatenate([np.zeros((1, 3)), np.cumsum(lengths[:, None] * way, axis=0)])

    scene = Scene()
    scene.simulation(duration=2.0)
    places = pose(0.0)
    scene.box("lead", position=places[-1].tolist(), kinematic=True, **CUBE)
    times = np.linspace(0.0, 2.0, 801)  # between keys the path strays by h² a / 8, 1e-5 m
    scene.path("lead", times=times.tolist(), positions=[pose(time / 2.0)[-1].tolist() for time in times])
    kinds = ("H" if planar else "B") * (count + 1)
    linked(scene, kinds, places, welded=0.3 * float(seed % 4 < 2))
    if seed % 4 < 2:  # only a constraint passes on the accelerations of a path
        UsdPhysics.Joint(scene.stage.GetPrimAtPath("/World/weld")).CreateExcludeFromArticulationAttr(True)
    assert problems(scene, tmp_path) == []
