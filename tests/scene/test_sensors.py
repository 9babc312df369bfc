"""Sensors in a scene: what is written is read back, and what a stage says of them is checked."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.geometry.rotations import rotate
from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.following import view_of
from wsim.scene.world_sensors import SensorCamera, SensorContact, SensorIMU, SensorJoints, SensorRange


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.box("door", size=(1.0, 0.1, 1.0), position=(0.5, 0.0, 2.0))
    scene.joint_revolute("hinge", None, "door", axis="Z", anchor=(0.0, 0.0, 2.0))
    return scene


def test_what_is_written_is_read_back(scene: Scene, tmp_path: Path) -> None:
    imu = scene.sensor_imu(
        "imu", "door", position=(0.4, 0.0, 0.1), rotation_deg=(0.0, 0.0, 90.0), rate=250.0, accelerometer_noise=0.01,
        gyroscope_noise=0.002, accelerometer_bias=(0.1, 0.2, 0.3), gyroscope_bias=(0.0, 0.0, -0.1), seed=4,
    )  # fmt: skip
    assert (imu.path, imu.kind) == ("/World/imu", "sensor")
    scene.sensor_joints("encoder", "hinge", rate=50.0)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    half = math.sqrt(0.5)
    first, second = describe(path).sensors
    assert isinstance(first, SensorIMU) and isinstance(second, SensorJoints)
    assert first.rotation == pytest.approx((0.0, 0.0, half, half))
    assert first.model_dump(exclude={"line", "rotation"}) == {
        "prim": "/World/imu", "rate": 250.0, "body": "/World/door", "position": (0.4, 0.0, 0.1), "kind": "imu",
        "accelerometer_noise": 0.01, "gyroscope_noise": 0.002, "accelerometer_bias": (0.1, 0.2, 0.3),
        "gyroscope_bias": (0.0, 0.0, -0.1), "seed": 4,
    }  # fmt: skip
    assert (second.joints, second.rate) == (["/World/hinge"], 50.0)
    assert str(first.line).startswith("test_sensors.py:")


def test_the_rays_of_a_scan_are_read_back(scene: Scene, tmp_path: Path) -> None:
    scene.sensor_range("scan", "door", rays=5, fan_deg=(-60.0, 60.0), layers=3, tilt_deg=(-5.0, 15.0), nearest=0.2,
                       farthest=12.0, noise=0.02, seed=9)  # fmt: skip
    scene.sensor_range("round", None, position=(1.0, 2.0, 3.0), rays=4, fan_deg=(0.0, 360.0), tilt_deg=(0.0, 20.0))
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    scan, around = describe(path).sensors
    assert isinstance(scan, SensorRange) and isinstance(around, SensorRange)
    assert [round(math.degrees(a), 9) for a in scan.azimuths] == [-60.0, -30.0, 0.0, 30.0, 60.0]
    assert [round(math.degrees(a), 9) for a in scan.elevations] == [-5.0, 5.0, 15.0]
    assert (scan.body, scan.nearest, scan.farthest, scan.noise, scan.seed, scan.rate) == (
        "/World/door", 0.2, 12.0, 0.02, 9, 10.0
    )  # fmt: skip
    assert scan.channels == {"distance": (3, 5)}
    assert [round(math.degrees(a), 9) for a in around.azimuths] == [0.0, 90.0, 180.0, 270.0]  # the last is the first
    assert [round(math.degrees(a), 9) for a in around.elevations] == [10.0]
    assert (around.body, around.position, around.seed) == (None, (1.0, 2.0, 3.0), None)


def test_a_contact_sensor_is_read_back(scene: Scene, tmp_path: Path) -> None:
    scene.sensor_contact("skin", "door", rotation_deg=(0.0, 0.0, 180.0), threshold=2.5, rate=20.0)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    (skin,) = describe(path).sensors
    assert isinstance(skin, SensorContact) and skin.channels == {"force": (3,), "touching": ()}
    assert (skin.body, skin.threshold, skin.rate) == ("/World/door", 2.5, 20.0)
    assert skin.rotation == pytest.approx((0.0, 0.0, 1.0, 0.0))


def test_a_camera_is_read_back_and_is_none_that_films(scene: Scene, tmp_path: Path) -> None:
    scene.sensor_camera("eye", "door", position=(0.4, 0.0, 0.1), rotation_deg=(0.0, 0.0, 90.0), width=64, height=48,
                        fov=90.0, farthest=12.0, rate=5.0, channels=["depth", "color"])  # fmt: skip
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    world = describe(path)
    (eye,) = world.sensors
    assert isinstance(eye, SensorCamera) and eye.channels == {"color": (48, 64, 3), "depth": (48, 64)}
    assert (eye.body, eye.fov, eye.farthest, eye.rate) == ("/World/door", pytest.approx(90.0), 12.0, 5.0)
    assert not any(camera.prim == eye.prim for camera in world.cameras)
    # Who looks through the prim in a USD viewer sees what it sees at the start: USD's cameras look along -Z, +Y up.
    frame = UsdGeom.Xformable(scene.stage.GetPrimAtPath("/World/eye")).ComputeLocalToWorldTransform(0)
    view, door = view_of(eye, world), world.body("/World/door")
    assert tuple(frame.ExtractTranslation()) == pytest.approx(view.eye)
    assert tuple(frame.TransformDir(Gf.Vec3d(0, 0, -1))) == pytest.approx(np.subtract(view.target, view.eye), abs=1e-6)
    assert tuple(frame.TransformDir(Gf.Vec3d(0, 1, 0))) == pytest.approx(view.up, abs=1e-6)
    sideways = rotate(np.array(door.rotation), np.array((0.0, 1.0, 0.0)))
    np.testing.assert_allclose(np.subtract(view.target, view.eye), sideways, atol=1e-6)


def test_a_robot_stands_for_its_hinges_and_sliders(tmp_path: Path) -> None:
    scene = Scene()
    arm = scene.robot("arm", "desk_arm", fixed=True)
    scene.sensor_joints("encoders", arm)
    scene.sensor_imu("imu", arm.link(arm.links[-1]))
    joints, imu = describe(scene.save(tmp_path / "stage.usda")).sensors
    assert [joint.rsplit("/", 1)[-1] for joint in joints.joints] == arm.joints
    assert imu.body == f"/World/arm/{arm.links[-1]}"


REFUSED: dict[str, tuple[Callable[[Scene], object], str]] = {
    "no joint": (lambda s: s.sensor_joints("new", []), r"joints = \[\] has none"),
    "a body": (lambda s: s.sensor_joints("new", "door"), r'joints\[0\] = "door" is no hinge and no slider'),
    "a joint twice": (lambda s: s.sensor_joints("new", ["hinge", "hinge"]), 'has "hinge" twice'),
    "what stands": (lambda s: s.sensor_imu("new", s.ground("floor")), 'body = "floor" is nothing that moves'),
    "a wall that scans": (
        lambda s: s.sensor_range("new", s.ground("floor")),
        'body = "floor" is nothing that moves; .*, or give None and a position in the world',
    ),
    "ground that feels": (lambda s: s.sensor_contact("new", s.ground("floor")), 'body = "floor" is nothing that moves'),
    "many rays": (
        lambda s: s.sensor_range("new", None, rays=1000, layers=101),
        "rays = 1000 in layers = 101 are 101000",
    ),
    "many pixels": (
        lambda s: s.sensor_camera("new", None, width=1000, height=1000),
        "width = 1000 by height = 1000 are 1000000 pixels; at most 307200",
    ),
    "a lens": (lambda s: s.sensor_camera("new", None, fov=180.0), "fov = 180 must be <= 170 deg"),
    "no channel": (
        lambda s: s.sensor_camera("new", None, channels=[]),
        r"channels = \[\] has none; name some of color",
    ),
    "a channel": (
        lambda s: s.sensor_camera("new", None, channels=["normals"]),
        'channels = "normals" must be one of color, depth, segmentation',
    ),
    "a wall that looks": (
        lambda s: s.sensor_camera("new", s.ground("floor")),
        'body = "floor" is nothing that moves; .*, or give None and a place in the world',
    ),
    "nothing between": (lambda s: s.sensor_range("new", None, nearest=3.0, farthest=2.0), "nearest = 3 m is not below"),
    "more than a turn": (lambda s: s.sensor_range("new", None, fan_deg=(-200.0, 200.0)), "more than a turn"),
    "a rate": (lambda s: s.sensor_imu("new", "door", rate=1e5), "rate = 100000 must be <= 10000 Hz"),
    "a rate of none": (lambda s: s.sensor_imu("new", "door", rate=1e-310), "rate = 1e-310 must be >= 0.001 Hz"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_sensed_is_refused(scene: Scene, case: str) -> None:
    call, said = REFUSED[case]
    with pytest.raises(SceneError, match=said):
        call(scene)
    assert not scene.stage.GetPrimAtPath("/World/new")


WRONG: dict[str, tuple[Callable[[Usd.Prim, Usd.Prim], object], str]] = {
    "no body": (lambda imu, _: imu.GetRelationship("wsim:body").ClearTargets(True), "imu.wsim:body: it must be one"),
    "a joint as body": (
        lambda imu, _: imu.GetRelationship("wsim:body").SetTargets(["/World/hinge"]),
        "imu.wsim:body: </World/hinge> is a PhysicsRevoluteJoint; it must be a rigid body",
    ),
    "a body that is off": (
        lambda imu, _: UsdGeom.Xform.Define(imu.GetStage(), "/World/off").GetPrim().ApplyAPI(UsdPhysics.RigidBodyAPI)
        and imu.GetStage().GetPrimAtPath("/World/off").SetActive(False)
        and imu.GetStage().GetPrimAtPath("/World/eye").GetRelationship("wsim:body").SetTargets(["/World/off"]),
        "eye.wsim:body: </World/off> is not in the world: inactive",
    ),
    "a number as body": (
        lambda imu, _: imu.GetStage().GetPrimAtPath("/World/scan").GetRelationship("wsim:body").SetTargets(
            ["/World/door.physics:mass"]
        ),
        "scan.wsim:body: </World/door.physics:mass>",
    ),
    "rate": (lambda imu, _: imu.GetAttribute("wsim:rate").Set(1e-310), "imu.wsim:rate: 1e-310 must be at least 0.001"),
    "a joint that is off": (
        lambda imu, _: UsdPhysics.Joint.Get(imu.GetStage(), "/World/hinge").CreateJointEnabledAttr(False),
        "encoder.wsim:joints: </World/hinge> is not enabled",
    ),
    "the world's seed": (
        lambda imu, _: next(
            prim for prim in imu.GetStage().Traverse() if prim.IsA(UsdPhysics.Scene)
        ).GetAttribute("wsim:seed").Set(-5),
        "wsim:seed: -5 must be at least 0",
    ),
    "turn": (
        lambda imu, _: imu.GetAttribute("wsim:rotation").Set(Gf.Quatd(2.0)),
        "imu.wsim:rotation: its quaternion must have the length 1",
    ),
    "far": (
        lambda imu, _: imu.GetAttribute("wsim:position").Set(Gf.Vec3d(1e9, 0.0, 0.0)),
        "imu.wsim:position: it must be at most",
    ),
    "noise": (lambda imu, _: imu.GetAttribute("wsim:gyroscopeNoise").Set(-1.0), "gyroscopeNoise: -1 must be at least"),
    "bias": (
        lambda imu, _: imu.GetAttribute("wsim:accelerometerBias").Set(Gf.Vec3d(0.0, 1e7, 0.0)),
        "accelerometerBias: it must be at most",
    ),
    "seed": (lambda imu, _: imu.CreateAttribute("wsim:seed", imu.GetAttribute("wsim:seed").GetTypeName()).Set(-3),
             "imu.wsim:seed: -3"),
    "no joints": (lambda _, enc: enc.GetRelationship("wsim:joints").ClearTargets(True), "encoder.wsim:joints: none"),
    "a ball joint": (
        lambda _, enc: UsdPhysics.SphericalJoint.Define(enc.GetStage(), "/World/ball").CreateBody1Rel().SetTargets(
            ["/World/door"]
        )
        and enc.GetRelationship("wsim:joints").SetTargets(["/World/ball"]),
        "encoder.wsim:joints: </World/ball> is no revolute or prismatic joint",
    ),
    "no rays": (lambda *_: _[0].GetStage().GetPrimAtPath("/World/scan").GetAttribute("wsim:azimuths").Set([]),
                "scan.wsim:azimuths: with the elevations they make 0 rays"),
    "nothing between": (
        lambda *_: _[0].GetStage().GetPrimAtPath("/World/scan").GetAttribute("wsim:nearest").Set(40.0),
        "scan.wsim:farthest: 30 m must be above nearest, 40 m",
    ),
    "too many pixels": (
        lambda imu, _: imu.GetStage().GetPrimAtPath("/World/eye").GetAttribute("wsim:width").Set(10**6),
        "eye.wsim:width: 1000000 by 120 pixels must be 1 to 307200 together",
    ),
    "a channel": (
        lambda imu, _: imu.GetStage().GetPrimAtPath("/World/eye").GetAttribute("wsim:channels").Set(["depth", "x"]),
        "eye.wsim:channels: 'x' must be one of color, depth, segmentation, once",
    ),
    "no depth": (
        lambda imu, _: imu.GetStage().GetPrimAtPath("/World/eye").GetAttribute("wsim:farthest").Set(0.0),
        "eye.wsim:farthest: 0 m must be above 0",
    ),
    "no lens": (
        lambda imu, _: imu.GetStage().GetPrimAtPath("/World/eye").GetAttribute("focalLength").Set(0.0),
        "eye.focalLength: 0 of an aperture of 20.955 must see at most 175 deg",
    ),
    "two kinds": (lambda imu, _: imu.AddAppliedSchema("WsimSensorJointsAPI"), "imu: it is WsimSensorIMUAPI and Wsim"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_a_stage_says_wrong_is_told(scene: Scene, tmp_path: Path, case: str) -> None:
    scene.sensor_imu("imu", "door", seed=1)
    scene.sensor_joints("encoder", "hinge")
    scene.sensor_range("scan", "door")
    scene.sensor_camera("eye", "door")
    path = scene.save(tmp_path / "stage.usda")
    stage = Usd.Stage.Open(str(path))
    change, said = WRONG[case]
    change(stage.GetPrimAtPath("/World/imu"), stage.GetPrimAtPath("/World/encoder"))
    stage.Save()
    assert any(said in problem for problem in check_stage(path, [tmp_path])), check_stage(path, [tmp_path])
