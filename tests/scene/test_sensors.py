"""Sensors in a scene: what is written is read back, and what a stage says of them is checked."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from pxr import Gf, Usd, UsdPhysics

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world_sensors import SensorContact, SensorIMU, SensorJoints, SensorRange


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
    "two kinds": (lambda imu, _: imu.AddAppliedSchema("WsimSensorJointsAPI"), "imu: it is WsimSensorIMUAPI and Wsim"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_a_stage_says_wrong_is_told(scene: Scene, tmp_path: Path, case: str) -> None:
    scene.sensor_imu("imu", "door", seed=1)
    scene.sensor_joints("encoder", "hinge")
    scene.sensor_range("scan", "door")
    path = scene.save(tmp_path / "stage.usda")
    stage = Usd.Stage.Open(str(path))
    change, said = WRONG[case]
    change(stage.GetPrimAtPath("/World/imu"), stage.GetPrimAtPath("/World/encoder"))
    stage.Save()
    assert any(said in problem for problem in check_stage(path, [tmp_path])), check_stage(path, [tmp_path])
