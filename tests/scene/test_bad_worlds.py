"""Worlds of which each call is good and which as a whole cannot be are refused with what to leave out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdPhysics

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.check_cords import cord_problems
from wsim.scene.check_joints import joint_problems
from wsim.scene.check_leads import parted
from wsim.sim import Simulation

HERE = (0.0, 0.0, 0.0)


def crank(scene: Scene, *, moves: str = "none", **weld: float) -> None:
    """Fixed joints from the world over a box to a kinematic one."""
    scene.box("leads", size=(0.2, 0.2, 0.2), kinematic=True, velocity=(float(moves == "by velocity"), 0.0, 0.0))
    scene.box("between", size=(0.2, 0.2, 0.2), position=(1.0, 0.0, 0.0))
    if moves == "by keys":
        scene.path("leads", times=[0.0, 1.0], positions=[HERE, (1.0, 0.0, 0.0)])
    scene.joint_fixed("first", "leads", "between")
    scene.joint_fixed("second", None, "between", **weld)


def lifts(scene: Scene, velocity: float) -> None:
    """A bridge that is fixed to two kinematic lifts, of which the other goes up at 1 m/s."""
    scene.box("one", size=(0.2, 0.2, 0.2), kinematic=True, velocity=(0.0, 0.0, 1.0))
    turned = {"rotation_deg": (0.0, 90.0, 0.0)}
    scene.box(
        "other", size=(0.2, 0.2, 0.2), position=(2.0, 0.0, 0.0), kinematic=True, velocity=(0, 0, velocity), **turned
    )
    scene.box("bridge", size=(1.5, 0.2, 0.2), position=(1.0, 0.0, 0.0))
    scene.joint_fixed("left", "one", "bridge")
    scene.joint_fixed("right", "other", "bridge")


def test_what_fixed_joints_hold_to_two_that_part_is_refused() -> None:
    for moves in ("by velocity", "by keys"):
        scene = Scene()
        crank(scene, moves=moves)
        problem = next(parted(scene.stage))
        assert "fixed joints hold" in problem and "of which neither gives way" in problem and "/World/leads" in problem
    scene = Scene()
    lifts(scene, 0.5)
    assert "</World/one> and </World/other>" in next(parted(scene.stage))


def test_what_fixed_joints_may_hold_is_taken() -> None:
    worlds: list[Callable[[Scene], None]] = [
        crank, partial(crank, moves="by velocity", break_force=1.0), partial(lifts, velocity=1.0),
    ]  # fmt: skip
    for world in worlds:
        scene = Scene()
        world(scene)
        assert list(parted(scene.stage)) == []


CUBE = {"size": (0.2, 0.2, 0.2)}


def strut(scene: Scene, kinds: tuple[str, str], *, between: int = 1, **leads: tuple[float, float, float]) -> None:
    """Two kinematic bodies 1 m apart and a strut, of some boxes fixed to each other, that joints hold to both."""
    for k, name in enumerate(("left", "right")):
        motion = {key.removeprefix(f"{name}_"): value for key, value in leads.items() if key.startswith(name)}
        scene.box(name, position=(float(k), 0.0, 0.0), kinematic=True, **CUBE, **motion)
    pieces = [f"piece_{k}" for k in range(between)]
    for k, piece in enumerate(pieces):
        scene.box(piece, size=(0.02, 0.05, 0.05), position=(0.5 + 0.1 * k, 0.0, 0.0))
    for k, (one, other) in enumerate(pairwise(pieces)):
        scene.joint_fixed(f"glue_{k}", one, other)
    for name, piece, kind, x in (("at_left", pieces[0], kinds[0], 0.0), ("at_right", pieces[-1], kinds[1], 1.0)):
        getattr(scene, kind)(name, name.removeprefix("at_"), piece, anchor=(x, 0.0, 0.0))


BALL, HINGE, WELD = "joint_spherical", "joint_revolute", "joint_fixed"  # the hinge's axis is Z
UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
PARTS: list[Callable[[Scene], None]] = [
    partial(strut, kinds=(BALL, BALL), right_velocity=ALONG),
    partial(strut, kinds=(BALL, BALL), right_velocity=UP),
    partial(strut, kinds=(HINGE, HINGE), left_velocity=ALONG),
    partial(strut, kinds=(HINGE, BALL), right_velocity=(0.0, 0.02, 0.0)),
    partial(strut, kinds=(WELD, HINGE), right_velocity=ALONG),
    partial(strut, kinds=(BALL, WELD), left_velocity=UP, between=3),
    partial(
        strut, kinds=(HINGE, HINGE), right_angular_velocity_deg=(90.0, 0.0, 0.0)
    ),  # its axis turns away from the other
    partial(strut, kinds=(WELD, WELD), right_angular_velocity_deg=(0.0, 0.0, 90.0)),
]
TOGETHER: list[Callable[[Scene], None]] = [
    partial(strut, kinds=(BALL, BALL)),
    partial(strut, kinds=(WELD, HINGE), left_velocity=ALONG, right_velocity=ALONG),
    partial(
        strut,
        kinds=(BALL, BALL),
        left_angular_velocity_deg=(0.0, 0.0, 90.0),
        right_angular_velocity_deg=(90.0, 0.0, 0.0),
    ),  # about their points
    partial(strut, kinds=(BALL, HINGE), right_angular_velocity_deg=(0.0, 0.0, 90.0)),
    partial(strut, kinds=(WELD, BALL), right_angular_velocity_deg=(90.0, 0.0, 0.0), between=3),
    partial(strut, kinds=(WELD, HINGE), right_angular_velocity_deg=(0.0, 0.0, 90.0)),
]


@pytest.mark.parametrize("world", PARTS)
def test_what_joints_hold_to_two_that_part_is_refused(world: Callable[[Scene], None], tmp_path: Path) -> None:
    scene = Scene()
    world(scene)
    (problem,) = check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path])
    assert problem.startswith("/World/at_right: ")
    assert "joints hold </World/left> and </World/right> together, of which neither gives way" in problem


@pytest.mark.parametrize("world", TOGETHER)
def test_what_two_that_stay_together_hold_is_taken(world: Callable[[Scene], None], tmp_path: Path) -> None:
    """And the joints hold as it goes: the bodies' anchors stay where their leads have theirs."""
    scene = Scene()
    world(scene)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    simulation = Simulation(path, device="cpu")
    for _ in range(20):
        simulation.advance_frame()
    assert not simulation.problems()
    place = dict(zip(simulation.model.body_label, simulation.state.body_q.numpy(), strict=True))
    first = place["/World/piece_0"][:3] - place["/World/left"][:3]
    assert abs(float((first @ first) ** 0.5) - 0.5) < 1e-3


def linkage(scene: Scene, kind: str, places: np.ndarray, goal: Sequence[float], seconds: float = 2.0) -> None:
    """Rods from place to place between a wall and a kinematic box, which goes to `goal` in 2 s and comes back."""
    scene.simulation(duration=seconds)
    first = places[-1].tolist()
    scene.box("end", position=first, kinematic=True, **CUBE)
    scene.path("end", times=[0.0, 2.0, 4.0], positions=[first, goal, first])
    names = [None, *(f"rod_{k}" for k in range(len(places) - 1)), "end"]
    for name, (start, end) in zip(names[1:-1], pairwise(places), strict=True):
        scene.box(name, size=(0.02, 0.02, 0.02), position=(0.5 * (start + end)).tolist())
    for k, ((one, other), place) in enumerate(zip(pairwise(names), places, strict=True)):
        axis = {"axis": "Y"} if kind == HINGE else {}
        getattr(scene, kind)(f"joint_{k}", one, other, anchor=place.tolist(), **axis)


@pytest.mark.parametrize("kind", [BALL, HINGE])
@pytest.mark.parametrize("count", [2, 3, 12])
@pytest.mark.parametrize("seconds", [1.0, 4.0])
def test_a_linkage_is_not_drawn_beyond_its_reach(kind: str, count: int, seconds: float, tmp_path: Path) -> None:
    """A row of rods, bent, and drawn 1 % less far than it is long, or more: in a run that lasts until then."""
    x = np.linspace(0.0, 1.0, count + 1)
    places = np.column_stack([x, 0.0 * x, np.minimum(x, 1.0 - x)])
    reach = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    for far in (0.99, 1.01):
        scene = Scene()
        linkage(scene, kind, places, (far * reach, 0.0, 0.0), seconds)
        problems = check_stage(scene.save(tmp_path / f"{far}.usda"), [tmp_path])
        if far < 1.0 or seconds < 2.0:
            assert problems == []
            continue
        (problem,) = problems
        assert f"what joints hold between </World/end> and the world reaches {reach:.4g} m" in problem
        assert "leave this joint out" in problem


@pytest.mark.parametrize("seed", range(10))
def test_what_a_linkage_reaches_is_taken(seed: int, tmp_path: Path) -> None:
    """Rods at random, of which the end goes anywhere within the length of all, and just beyond."""
    rng = np.random.default_rng(seed)
    places = np.cumsum(rng.normal(size=(int(rng.integers(3, 7)), 3)), axis=0)
    reach = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    way = rng.normal(size=3)
    for far, taken in ((0.999, True), (1.001, False)):
        goal = places[0] + far * reach * way / np.linalg.norm(way)
        scene = Scene()
        linkage(scene, BALL, places, goal.tolist())
        assert (check_stage(scene.save(tmp_path / f"{far}.usda"), [tmp_path]) == []) == taken


def test_a_cable_is_not_drawn_beyond_its_length(tmp_path: Path) -> None:
    for far in (1.29, 1.31):
        scene = Scene()
        scene.box("end", position=(1.0, 0.0, 0.0), kinematic=True, **CUBE)
        scene.path("end", times=[0.0, 2.0], positions=[(1.0, 0.0, 0.0), (far, 0.0, 0.0)])
        scene.cable("c", None, "end", anchor_a=(0, 0, 0), anchor_b=(1.0, 0, 0), length=1.3)
        problems = check_stage(scene.save(tmp_path / f"{far}.usda"), [tmp_path])
        assert len(problems) == (far > 1.3)


def test_what_a_path_takes_away_is_refused(tmp_path: Path) -> None:
    """A path that comes back to where it began parts in between."""
    start = (1.0, 0.0, 0.0)
    for middle in (start, (1.0, 0.3, 0.0)):
        scene = Scene()
        strut(scene, (BALL, BALL))
        scene.path("right", times=[0.0, 1.0, 2.0], positions=[start, middle, start])
        for joint in ("at_left", "at_right"):
            UsdPhysics.Joint(scene.stage.GetPrimAtPath(f"/World/{joint}")).CreateExcludeFromArticulationAttr(True)
        assert bool(list(parted(scene.stage))) == (middle != start)


def test_stops_without_a_way_between_are_refused() -> None:
    scene = Scene()
    scene.box("cart", size=(0.1, 0.1, 0.1))
    scene.joint_prismatic("slide", None, "cart")
    scene.stage.GetPrimAtPath("/World/slide").CreateAttribute("physics:lowerLimit", Sdf.ValueTypeNames.Float).Set(0.5)
    scene.stage.GetPrimAtPath("/World/slide").CreateAttribute("physics:upperLimit", Sdf.ValueTypeNames.Float).Set(0.5)
    (problem,) = joint_problems(scene.stage)
    assert "/World/slide.physics:upperLimit: 0.5 must be above lowerLimit = 0.5" in problem


@pytest.mark.parametrize("cord", ["spring", "rope"])
def test_a_cord_between_what_it_cannot_move_is_refused(cord: str) -> None:
    scene = Scene()
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 5.0))
    scene.box("lift", size=(1.0, 1.0, 0.1), kinematic=True)
    scene.cylinder("wheel", radius=0.1, height=0.1, position=(0.5, 0.0, 6.0), static=True)
    stiff = {"stiffness": 10.0} if cord == "spring" else {}
    with pytest.raises(SceneError, match="neither a nor b is a body that it could move"):
        getattr(scene, cord)("new", "lift", "wheel", **stiff)
    getattr(scene, cord)("new", "lift", "ball", **stiff)
    assert list(cord_problems(scene.stage.GetPrimAtPath("/World/new"))) == []
    scene.joint_fixed("glue", "wheel", "ball")
    (problem,) = cord_problems(scene.stage.GetPrimAtPath("/World/new"))
    assert "neither wsim:a nor wsim:b is a body that it could move: fixed joints hold </World/ball> to what" in problem
    scene.stage.GetPrimAtPath("/World/new").GetRelationship("wsim:b").SetTargets(["/World/wheel"])
    (problem,) = cord_problems(scene.stage.GetPrimAtPath("/World/new"))
    assert "neither wsim:a nor wsim:b is a body that it could move" in problem
