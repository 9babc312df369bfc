"""Cameras that follow bodies: how a stage says it, and where they are when the body has moved and turned."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from wsim.geometry.rotations import rotate
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.following import as_at_start, camera_at
from wsim.scene.world import World

QUARTER = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))  # 90 degrees to the left


def scene(**options: object) -> Scene:
    made = Scene()
    made.box("box", size=(0.4, 0.2, 0.2), position=(2.0, 0.0, 1.0))
    made.camera("cam", eye=(0.0, 0.0, 2.0), target=(2.0, 0.0, 1.0), follows="box", **options)  # type: ignore[arg-type]
    return made


@pytest.fixture(params=[False, True])
def world(request: pytest.FixtureRequest) -> World:
    return describe(scene(turns=request.param).stage)


def test_it_keeps_its_offset_and_turns_where_that_is_asked(world: World) -> None:
    """The body goes 5 m up the Y axis and turns to it: what was 2 m behind it is so still, or is 2 m to its left."""
    (camera,) = world.cameras
    assert camera.follows == "/World/box"
    moved = camera_at(camera, world, (2.0, 5.0, 1.0, *QUARTER))
    assert moved.eye == pytest.approx((2.0, 3.0, 2.0) if camera.turns else (0.0, 5.0, 2.0))
    assert moved.target == pytest.approx((2.0, 5.0, 1.0))
    slope = 1.0 / math.sqrt(5.0)  # it looks down by 1 in 2
    assert moved.up == pytest.approx((0.0, slope, 2 * slope) if camera.turns else (slope, 0.0, 2 * slope))


def test_at_its_start_it_is_where_the_stage_has_it(world: World) -> None:
    (camera,), (body,) = world.cameras, world.bodies
    assert camera_at(camera, world, (*body.position, *body.rotation)).eye == pytest.approx(camera.eye)


def test_points_are_where_the_camera_would_see_them_at_its_start(world: World) -> None:
    """Both ways the same: the camera moved to the points, and the points moved to the camera."""
    (camera,), random = world.cameras, np.random.default_rng(3)
    turn = random.normal(size=4)
    pose = np.array((*random.normal(size=3), *(turn / np.linalg.norm(turn))))
    points = random.normal(size=(1, 7, 3))
    moved = camera_at(camera, world, pose)
    back = as_at_start(camera, world, pose[None], points)
    seen = []
    for then, now in ((camera, back), (moved, points)):
        ahead = np.subtract(then.target, then.eye)
        right = np.cross(ahead, then.up)
        seen.append([(now[0] - np.array(then.eye)) @ axis for axis in (ahead, right, np.cross(right, ahead))])
    np.testing.assert_allclose(seen[1], seen[0], atol=1e-9)


def test_a_camera_below_a_body_is_fixed_to_it_as_usd_has_it() -> None:
    made = scene()
    lens = UsdGeom.Camera.Define(made.stage, "/World/box/lens")
    lens.AddTranslateOp().Set(Gf.Vec3d(0.2, 0.0, 0.0))
    lens.AddRotateXYZOp().Set(Gf.Vec3f(90.0, 0.0, -90.0))  # looks along +X
    world = describe(made.stage)
    camera = next(each for each in world.cameras if each.prim == "/World/box/lens")
    assert (camera.follows, camera.turns, camera.eye) == ("/World/box", True, pytest.approx((2.2, 0.0, 1.0)))
    moved = camera_at(camera, world, (0.0, 0.0, 1.0, *QUARTER))
    ahead = np.subtract(moved.target, moved.eye)
    assert moved.eye == pytest.approx((0.0, 0.2, 1.0))
    np.testing.assert_allclose(ahead / np.linalg.norm(ahead), rotate(np.array(QUARTER), np.array((1.0, 0.0, 0.0))),
                               atol=1e-6)  # fmt: skip


def test_a_camera_below_a_body_with_a_frame_of_the_world_stands() -> None:
    """`!resetXformStack!`: what its body does is none of its own, and it may follow another."""
    made = scene()
    lens = UsdGeom.Camera.Define(made.stage, "/World/box/lens")
    lens.SetResetXformStack(True)
    lens.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, 5.0))
    camera = next(each for each in describe(made.stage).cameras if each.prim == "/World/box/lens")
    assert (camera.follows, camera.turns, camera.eye) == (None, False, (0.0, 0.0, 5.0))


def test_with_a_robot_whose_base_is_held_a_camera_stands() -> None:
    made = scene()
    arm = made.robot("arm", "desk_arm", position=(0.0, 0.0, 0.0))
    for k, what in enumerate((arm, arm.link("turret"))):
        made.camera(f"of_{k}", eye=(3.0, 0.0, 1.0), target=(0.0, 0.0, 1.0), follows=what, turns=True)
    found = {camera.prim: (camera.follows, camera.turns) for camera in describe(made.stage).cameras}
    assert found["/World/of_0"] == (None, False)
    assert found["/World/of_1"] == ("/World/arm/turret", True)


def _twice(stage: Usd.Stage) -> None:
    UsdGeom.Xform.Define(stage, "/World/none")
    stage.GetPrimAtPath("/World/cam").GetRelationship("wsim:follows").SetTargets(["/World/none"])


def _alone(stage: Usd.Stage) -> None:
    stage.GetPrimAtPath("/World/cam").GetRelationship("wsim:follows").ClearTargets(True)


def _gone(stage: Usd.Stage) -> None:
    stage.GetPrimAtPath("/World/cam").GetRelationship("wsim:follows").SetTargets(["/World/away"])


def _off(stage: Usd.Stage) -> None:
    stage.GetPrimAtPath("/World/box").SetActive(False)


def _flat(stage: Usd.Stage) -> None:
    UsdGeom.Camera.Define(stage, "/World/lens").CreateVerticalApertureAttr(0.0)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (_flat, "/World/lens.wsim:width: 640 by 0 pixels must be 1 to 8192 each"),
        (_off, "/World/cam.wsim:follows: </World/box> is not in the world: inactive, a class or an over; name another"),
        (_twice, "/World/cam.wsim:follows: </World/none> is a Xform; it must be a rigid body"),
        (_gone, "/World/cam.wsim:follows: </World/away> is not there"),
        (_alone, "/World/cam.wsim:turns: it needs wsim:follows, the body that the camera turns with"),
        (lambda stage: None, ""),
    ],
)
def test_a_stage_that_says_it_wrongly_is_refused(
    tmp_path: Path, change: Callable[[Usd.Stage], None], problem: str
) -> None:
    made = scene(turns=True)
    change(made.stage)
    made.stage.GetRootLayer().Export(str(tmp_path / "stage.usda"))
    assert check_stage(tmp_path / "stage.usda", [tmp_path]) == ([problem] if problem else [])
