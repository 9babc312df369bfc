"""Worlds of which each call is good and which as a whole cannot be are refused with what to leave out."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest
from pxr import Sdf

from wsim.scene import Scene, SceneError
from wsim.scene.check_cords import cord_problems
from wsim.scene.check_joints import joint_problems

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
        problem = next(joint_problems(scene.stage))
        assert "fixed joints hold" in problem and "of which neither gives way" in problem and "/World/leads" in problem
    scene = Scene()
    lifts(scene, 0.5)
    assert "</World/one> and </World/other>" in next(joint_problems(scene.stage))


def test_what_fixed_joints_may_hold_is_taken() -> None:
    worlds: list[Callable[[Scene], None]] = [
        crank, partial(crank, moves="by velocity", break_force=1.0), partial(lifts, velocity=1.0),
    ]  # fmt: skip
    for world in worlds:
        scene = Scene()
        world(scene)
        assert list(joint_problems(scene.stage)) == []


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
    scene.stage.GetPrimAtPath("/World/new").GetRelationship("wsim:b").SetTargets(["/World/wheel"])
    (problem,) = cord_problems(scene.stage.GetPrimAtPath("/World/new"))
    assert "neither wsim:a nor wsim:b is a body that it could move" in problem
