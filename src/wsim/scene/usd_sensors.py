"""Sensors of a stage, read back, and held against what the simulator needs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.defaults import PIXEL_CHANNELS, SENSOR_RATE
from wsim.limits import MAX_PIXELS, MAX_POSITION, MAX_RATE, MAX_RAYS, MIN_RATE
from wsim.scene import schema
from wsim.scene.sensors import is_of_one_freedom
from wsim.scene.usd_cameras import field_of_view
from wsim.scene.usd_shapes import to_quat, to_vec3
from wsim.scene.usd_values import line_of, targets_of, value_of
from wsim.scene.world_sensors import (
    Sensor,
    SensorCamera,
    SensorContact,
    SensorIMU,
    SensorJoints,
    SensorRange,
)

_KINDS = (
    schema.SENSOR_IMU, schema.SENSOR_JOINTS, schema.SENSOR_RANGE, schema.SENSOR_CONTACT, schema.SENSOR_CAMERA,
)  # fmt: skip
_LARGEST = 1e6  # of noise and bias
_FARTHEST = 30.0  # [m]
_DEEPEST = 100.0  # [m]
_THRESHOLD = 1e-3  # [N]
_UNIT = 1e-6  # by which a quaternion's length may be off


def read_sensors(prims: Iterable[Usd.Prim]) -> Iterator[Sensor]:
    """The sensors among a stage's prims, which was checked."""
    for prim in prims:
        if schema.has(prim, schema.SENSOR_IMU):
            noise = {f"{part}_noise": value_of(prim, f"{part}Noise", 0.0) for part in ("accelerometer", "gyroscope")}
            bias = {f"{part}_bias": _vector(prim, f"{part}Bias") for part in ("accelerometer", "gyroscope")}
            yield SensorIMU(**_mounted(prim), **noise, **bias, seed=value_of(prim, "seed", None))
        elif schema.has(prim, schema.SENSOR_JOINTS):
            yield SensorJoints(**_any(prim), joints=[str(joint.GetPath()) for joint in targets_of(prim, "joints")])
        elif schema.has(prim, schema.SENSOR_RANGE):
            azimuths, elevations = ([math.radians(each) for each in part] for part in _rays(prim))
            yield SensorRange(
                **_mounted(prim),
                azimuths=azimuths,
                elevations=elevations,
                nearest=value_of(prim, "nearest", 0.0),
                farthest=value_of(prim, "farthest", _FARTHEST),
                noise=value_of(prim, "noise", 0.0),
                seed=value_of(prim, "seed", None),
            )
        elif schema.has(prim, schema.SENSOR_CAMERA):
            yield SensorCamera(
                **_mounted(prim),
                **dict(zip(("width", "height"), _pixels(prim), strict=True)),
                fov=field_of_view(UsdGeom.Camera(prim)),
                farthest=value_of(prim, "farthest", _DEEPEST),
                tells=_told(prim),
            )
        elif schema.has(prim, schema.SENSOR_CONTACT):
            felt = {key: value for key, value in _mounted(prim).items() if key != "position"}
            yield SensorContact(**felt, threshold=value_of(prim, "threshold", _THRESHOLD))


def sensor_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the sensors among a stage's prims: those that `read_sensors` gets."""
    for prim in prims:
        kinds = [kind for kind in _KINDS if schema.has(prim, kind)]
        if len(kinds) > 1:
            yield f"{prim.GetPath()}: it is {' and '.join(kinds)}; give each sensor a prim of its own"
        for kind in kinds[:1]:
            for problem in (*_rate_problems(prim), *_problems(prim, kind)):
                yield f"{prim.GetPath()}.wsim:{problem}"


def _any(prim: Usd.Prim) -> dict[str, object]:
    return {"prim": str(prim.GetPath()), "rate": value_of(prim, "rate", SENSOR_RATE), "line": line_of(prim)}


def _mounted(prim: Usd.Prim) -> dict[str, object]:
    bodies = targets_of(prim, "body")
    return _any(prim) | {
        "body": str(bodies[0].GetPath()) if bodies else None,
        "position": _vector(prim, "position"),
        "rotation": to_quat(Gf.Quatd(value_of(prim, "rotation", Gf.Quatd(1.0)))),
    }


def _vector(prim: Usd.Prim, name: str) -> tuple[float, float, float]:
    return to_vec3(value_of(prim, name, Gf.Vec3d(0.0)))


def _rate_problems(prim: Usd.Prim) -> Iterator[str]:
    rate = value_of(prim, "rate", SENSOR_RATE)
    if not MIN_RATE <= rate <= MAX_RATE:
        yield f"rate: {rate:g} must be at least {MIN_RATE:g} and at most {MAX_RATE:g} Hz"


def _problems(prim: Usd.Prim, kind: str) -> Iterator[str]:
    if kind == schema.SENSOR_JOINTS:
        joints = targets_of(prim, "joints")
        if not joints:
            yield "joints: none is named"
        for joint in joints:
            if not is_of_one_freedom(joint):
                yield f"joints: <{joint.GetPath()}> is no revolute or prismatic joint"
            elif UsdPhysics.Joint(joint).GetJointEnabledAttr().Get() is False:
                yield f"joints: <{joint.GetPath()}> is not enabled; enable it, or leave it out"
        return
    yield from _mounting_problems(prim)
    if (seed := value_of(prim, "seed", 0)) < 0:
        yield f"seed: {seed} must be at least 0"
    if kind == schema.SENSOR_RANGE:
        yield from _range_problems(prim)
    elif kind == schema.SENSOR_CAMERA:
        yield from _camera_problems(prim)
    elif not targets_of(prim, "body"):
        yield "body: it must be one rigid body"
    if kind == schema.SENSOR_IMU:
        yield from _imu_problems(prim)
    if kind == schema.SENSOR_CONTACT and not (least := value_of(prim, "threshold", _THRESHOLD)) >= 0.0:
        yield f"threshold: {least:g} must be at least 0 N"


def _imu_problems(prim: Usd.Prim) -> Iterator[str]:
    for part in ("accelerometer", "gyroscope"):
        if not 0.0 <= (noise := value_of(prim, f"{part}Noise", 0.0)) <= _LARGEST:
            yield f"{part}Noise: {noise:g} must be at least 0 and at most {_LARGEST:g}"
        if not all(abs(each) <= _LARGEST for each in _vector(prim, f"{part}Bias")):
            yield f"{part}Bias: it must be at most {_LARGEST:g} in size"


def _range_problems(prim: Usd.Prim) -> Iterator[str]:
    azimuths, elevations = _rays(prim)
    if not 1 <= len(azimuths) * len(elevations) <= MAX_RAYS:
        yield f"azimuths: with the elevations they make {len(azimuths) * len(elevations)} rays; give 1 to {MAX_RAYS}"
    near, far = value_of(prim, "nearest", 0.0), value_of(prim, "farthest", _FARTHEST)
    if not 0.0 <= near < far <= MAX_POSITION:
        yield f"farthest: {far:g} m must be above nearest, {near:g} m, and at most {MAX_POSITION:g} m"
    if not 0.0 <= (noise := value_of(prim, "noise", 0.0)) <= _LARGEST:
        yield f"noise: {noise:g} must be at least 0 and at most {_LARGEST:g}"


def _camera_problems(prim: Usd.Prim) -> Iterator[str]:
    if not prim.IsA(UsdGeom.Camera):
        yield f"width: a {prim.GetTypeName() or 'prim'} has no lens; make it a Camera"
    width, height = _pixels(prim)
    if min(width, height) < 1 or width * height > MAX_PIXELS:
        yield f"width: {width} by {height} pixels must be 1 to {MAX_PIXELS} together"
    if not 0.0 < (far := value_of(prim, "farthest", _DEEPEST)) <= MAX_POSITION:
        yield f"farthest: {far:g} m must be above 0 and at most {MAX_POSITION:g} m"
    told = _told(prim)
    for name in told:
        if name not in PIXEL_CHANNELS or told.count(name) > 1:
            yield f"channels: {name!r} must be one of {', '.join(PIXEL_CHANNELS)}, once"
    if not told:
        yield f"channels: none is named; name some of {', '.join(PIXEL_CHANNELS)}"


def _pixels(prim: Usd.Prim) -> tuple[int, int]:
    """Width and height."""
    return int(value_of(prim, "width", 160)), int(value_of(prim, "height", 120))


def _told(prim: Usd.Prim) -> list[str]:
    return [str(name) for name in value_of(prim, "channels", PIXEL_CHANNELS)]


def _rays(prim: Usd.Prim) -> tuple[list[float], list[float]]:
    """Azimuths and elevations [deg]."""
    azimuths, elevations = (value_of(prim, name, None) for name in ("azimuths", "elevations"))
    return list([0.0] if azimuths is None else azimuths), list([0.0] if elevations is None else elevations)


def _mounting_problems(prim: Usd.Prim) -> Iterator[str]:
    bodies = targets_of(prim, "body")
    if len(bodies) > 1 or not all(body.HasAPI(UsdPhysics.RigidBodyAPI) for body in bodies):
        yield "body: it must be one rigid body"
    if not all(abs(each) <= MAX_POSITION for each in _vector(prim, "position")):
        yield f"position: it must be at most {MAX_POSITION:g} m away"
    if abs(Gf.Quatd(value_of(prim, "rotation", Gf.Quatd(1.0))).GetLength() - 1.0) > _UNIT:
        yield "rotation: its quaternion must have the length 1"
