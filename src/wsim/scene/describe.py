"""Read a stage back as plain data: what simulator, recording and judge know of a world.

Any UsdPhysics stage in metres, kilograms and Z up can be read, not only what the calls of a `Scene` wrote.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdLux, UsdPhysics

from wsim.defaults import DURATION, FLUID_DENSITY, FRAME_RATE, GRAVITY
from wsim.errors import UserError
from wsim.scene import schema
from wsim.scene.articulation import WORLD_END, joint_ends
from wsim.scene.errors import one_line
from wsim.scene.usd_mass import mass_of
from wsim.scene.usd_shapes import collides_exactly, read_shape, to_quat, to_vec3
from wsim.scene.world import (
    Body,
    Camera,
    Container,
    Fluid,
    Joint,
    Light,
    Motor,
    Parameter,
    Quat,
    Shape,
    Static,
    World,
)

_NOW = Usd.TimeCode.Default()
_JOINTS = (
    (UsdPhysics.FixedJoint, "fixed"),
    (UsdPhysics.RevoluteJoint, "revolute"),
    (UsdPhysics.PrismaticJoint, "prismatic"),
    (UsdPhysics.SphericalJoint, "spherical"),
)
_LIGHTS = ((UsdLux.DistantLight, "distant"), (UsdLux.DomeLight, "dome"), (UsdLux.SphereLight, "sphere"))


def describe(stage: Usd.Stage | str | Path) -> World:
    """What a stage says.

    Args:
        stage: A stage, or the path of one.

    Raises:
        UserError: If the file is no stage, or is not in metres, kilograms and Z up.
    """
    if isinstance(stage, (str, Path)):
        stage = _open(Path(stage))
    _check_units(stage)
    prims = list(stage.Traverse(Usd.TraverseInstanceProxies()))
    default = stage.GetDefaultPrim()
    bodies, statics = _solids(prims, stage)
    return World(
        name=default.GetName() if default else "world",
        **_run(prims),
        bodies=bodies,
        statics=statics,
        containers=[_container(prim) for prim in prims if schema.has(prim, schema.CONTAINER)],
        fluids=[_fluid(prim) for prim in prims if schema.has(prim, schema.FLUID)],
        joints=list(_joints(prims)),
        cameras=[_camera(prim) for prim in prims if prim.IsA(UsdGeom.Camera)],
        lights=list(_lights(prims)),
        parameters=[_parameter(prim) for prim in prims if schema.has(prim, schema.PARAMETER)],
    )


def _open(path: Path) -> Usd.Stage:
    if not path.is_file():
        raise UserError(f"{path}: no such stage")
    try:
        return Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        raise UserError(f"{path}: not a USD stage: {one_line(error)}") from error


def _check_units(stage: Usd.Stage) -> None:
    metres, up = UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)
    kilograms = UsdPhysics.GetStageKilogramsPerUnit(stage)
    if not (math.isclose(metres, 1.0) and math.isclose(kilograms, 1.0) and up == UsdGeom.Tokens.z):
        raise UserError(
            f"{stage.GetRootLayer().GetDisplayName()}: metersPerUnit = {metres:g}, kilogramsPerUnit = {kilograms:g}, "
            f"upAxis = {up}; a world is in metres (1), kilograms (1) and Z up"
        )


def _run(prims: list[Usd.Prim]) -> dict[str, Any]:
    """Gravity, duration and the rest of the physics scene."""
    scene = next((UsdPhysics.Scene(prim) for prim in prims if prim.IsA(UsdPhysics.Scene)), None)
    if scene is None:
        return {}
    prim = scene.GetPrim()
    direction = Gf.Vec3d(scene.GetGravityDirectionAttr().Get())
    strength = float(scene.GetGravityMagnitudeAttr().Get())
    # USD's fallbacks: no direction is down, and a magnitude of -inf is that of the Earth.
    direction = direction.GetNormalized() if direction.GetLength() > 0.0 else Gf.Vec3d(0.0, 0.0, -1.0)
    strength = strength if strength >= 0.0 else GRAVITY
    return {
        "gravity": to_vec3(direction * strength),
        "duration": float(_value(prim, "duration", DURATION)),
        "frame_rate": float(_value(prim, "frameRate", FRAME_RATE)),
        "time_step": float(_value(prim, "timeStep", 0.0)),
        "seed": int(_value(prim, "seed", 0)),
    }


def _solids(prims: list[Usd.Prim], stage: Usd.Stage) -> tuple[list[Body], list[Static]]:
    bodies = {str(prim.GetPath()): prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)}
    frames = {path: _rigid(prim) for path, prim in bodies.items()}
    of_body: dict[str, list[Shape]] = {path: [] for path in bodies}
    of_static: dict[str, list[Shape]] = {}
    for prim in prims:
        if not prim.IsA(UsdGeom.Gprim) or not _shown(prim) or _in_fluid(prim):
            continue
        owner = _owner(prim)
        shape = read_shape(prim, frames[owner] if owner else Gf.Matrix4d(1.0))
        if shape is None:
            continue
        if owner:
            of_body[owner].append(shape)
        else:
            still_shape = shape.model_copy(update={"exact": collides_exactly(prim)})
            of_static.setdefault(_object_path(prim, stage), []).append(still_shape)
    moving = [_body(prim, frames[path], of_body[path]) for path, prim in bodies.items()]
    still = [
        Static(prim=path, shapes=shapes, line=_line(stage.GetPrimAtPath(path))) for path, shapes in of_static.items()
    ]
    return moving, still


def _body(prim: Usd.Prim, frame: Gf.Matrix4d, shapes: list[Shape]) -> Body:
    api = UsdPhysics.RigidBodyAPI(prim)
    mass = mass_of(prim, shapes)
    velocity = frame.TransformDir(Gf.Vec3d(api.GetVelocityAttr().Get()))
    spin = frame.TransformDir(Gf.Vec3d(api.GetAngularVelocityAttr().Get())) * (math.pi / 180.0)
    return Body(
        prim=str(prim.GetPath()),
        mass=mass.mass,
        volume=mass.volume,
        com=to_vec3(mass.com),
        inertia=tuple(mass.inertia.reshape(-1).tolist()),
        position=to_vec3(frame.ExtractTranslation()),
        rotation=to_quat(frame.ExtractRotationQuat()),
        velocity=to_vec3(velocity),
        angular_velocity=to_vec3(spin),
        kinematic=bool(api.GetKinematicEnabledAttr().Get()),
        shapes=shapes,
        line=_line(prim),
    )


def _container(prim: Usd.Prim) -> Container:
    frame = _rigid(prim)
    center = Gf.Vec3d(_value(prim, "innerCenter", Gf.Vec3f(0.0)))
    return Container(
        prim=str(prim.GetPath()),
        inner_size=to_vec3(_value(prim, "innerSize", Gf.Vec3f(0.0))),
        inner_center=to_vec3(frame.Transform(center)),
        rotation=_turn(frame),
    )


def _fluid(prim: Usd.Prim) -> Fluid:
    container = prim.GetRelationship("wsim:container")
    targets = container.GetTargets() if container else []
    looks = [shape for child in prim.GetChildren() if child.IsA(UsdGeom.Gprim) and (shape := _look(child))]
    fluid = Fluid(
        prim=str(prim.GetPath()),
        density=_value(prim, "density", FLUID_DENSITY),
        viscosity=_value(prim, "viscosity", 0.001),
        spacing=_value(prim, "spacing", 0.0),
        size=to_vec3(_value(prim, "size", Gf.Vec3f(0.0))),
        center=to_vec3(_rigid(prim).ExtractTranslation()),
        speed_of_sound=_value(prim, "speedOfSound", 0.0),
        container=str(targets[0]) if targets else None,
        line=_line(prim),
    )
    return fluid.model_copy(update={"color": looks[0].color}) if looks else fluid


def _look(prim: Usd.Prim) -> Shape | None:
    return read_shape(prim, Gf.Matrix4d(1.0))


def _joints(prims: list[Usd.Prim]) -> Iterator[Joint]:
    for prim in prims:
        for usd, kind in _JOINTS:
            if not prim.IsA(usd):
                continue
            stage = prim.GetStage()
            paths = joint_ends(UsdPhysics.Joint(prim))
            parent, child = (_body_at(stage, path) for path in paths)
            if child is None:
                parent, child, paths = child, parent, paths[::-1]
            if child is None:
                continue  # holds nothing that moves
            axis = prim.GetAttribute("physics:axis").Get() if kind != "fixed" else "X"
            yield Joint.model_validate(
                {
                    "prim": str(prim.GetPath()),
                    "kind": kind,
                    "parent": parent,
                    "child": child,
                    "fixture": _fixture(prim, paths[0]) if parent is None else None,
                    "axis": axis,
                    **_anchors(UsdPhysics.Joint(prim), parent, child),
                    **_motion(prim, kind),
                    "line": _line(prim),
                }
            )


def _fixture(joint: Usd.Prim, end: Sdf.Path) -> str | None:
    """The static object that stands for the world at a joint's end: the joint's target, or noted beside it."""
    noted = joint.GetRelationship("wsim:fixture")
    path = next(iter(noted.GetTargets() if noted else []), end)
    return None if path == WORLD_END else _object_path(joint.GetStage().GetPrimAtPath(path), joint.GetStage())


def _anchors(joint: UsdPhysics.Joint, parent: str | None, child: str) -> dict[str, Any]:
    """Where a joint's frame is in its parent and in its child."""
    stage = joint.GetPrim().GetStage()
    found: dict[str, Any] = {}
    sides = (
        (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    )
    for relation, position, rotation in sides:
        targets = relation.GetTargets()
        prim = stage.GetPrimAtPath(targets[0]) if targets else None
        owner = _owner(prim) if prim else None
        frame = Gf.Matrix4d().SetRotate(Gf.Quatd(rotation.Get())).SetTranslateOnly(Gf.Vec3d(position.Get()))
        if prim:
            frame *= _rigid(prim)
        if owner is not None:
            frame *= _rigid(stage.GetPrimAtPath(owner)).GetInverse()
        side = "child" if owner == child else "parent"
        found[f"{side}_anchor"] = to_vec3(frame.ExtractTranslation())
        found[f"{side}_turn"] = _turn(frame)
    return found


def _motion(prim: Usd.Prim, kind: str) -> dict[str, Any]:
    """A hinge's or a slider's limits and motor, in radians."""
    if kind not in ("revolute", "prismatic"):
        return {}
    unit = math.pi / 180.0 if kind == "revolute" else 1.0
    found: dict[str, Any] = {}
    for name, attribute in (("low", "physics:lowerLimit"), ("high", "physics:upperLimit")):
        value = prim.GetAttribute(attribute).Get()
        if value is not None and math.isfinite(value):
            found[name] = float(value) * unit
    drive = UsdPhysics.DriveAPI.Get(prim, "angular" if kind == "revolute" else "linear")
    if drive:
        most = float(drive.GetMaxForceAttr().Get())
        found["drive"] = Motor(
            stiffness=float(drive.GetStiffnessAttr().Get()) / unit,
            damping=float(drive.GetDampingAttr().Get()) / unit,
            position=float(drive.GetTargetPositionAttr().Get()) * unit,
            velocity=float(drive.GetTargetVelocityAttr().Get()) * unit,
            max_effort=most if math.isfinite(most) else None,
        )
    return found


def _camera(prim: Usd.Prim) -> Camera:
    lens = UsdGeom.Camera(prim)
    frame = _rigid(prim)
    eye = frame.ExtractTranslation()
    forward = frame.TransformDir(Gf.Vec3d(0.0, 0.0, -1.0))
    target = Gf.Vec3d(_value(prim, "target", eye))
    if Gf.Dot((target - eye).GetNormalized(), forward) < 1.0 - 1e-6:
        # No target was written, or the camera was moved since.
        target = eye + forward * (float(lens.GetFocusDistanceAttr().Get()) or 1.0)
    across, down = lens.GetHorizontalApertureAttr().Get(), lens.GetVerticalApertureAttr().Get()
    width = int(_value(prim, "width", 640))
    return Camera(
        prim=str(prim.GetPath()),
        eye=to_vec3(eye),
        target=to_vec3(target),
        up=to_vec3(frame.TransformDir(Gf.Vec3d(0.0, 1.0, 0.0))),
        fov=math.degrees(2.0 * math.atan(across / 2.0 / lens.GetFocalLengthAttr().Get())),
        width=width,
        height=int(_value(prim, "height", round(width * down / across))),
    )


def _lights(prims: list[Usd.Prim]) -> Iterator[Light]:
    for prim in prims:
        for usd, kind in _LIGHTS:
            if not prim.IsA(usd):
                continue
            light, frame = UsdLux.LightAPI(prim), _rigid(prim)
            yield Light.model_validate(
                {
                    "prim": str(prim.GetPath()),
                    "kind": kind,
                    "intensity": float(light.GetIntensityAttr().Get()),
                    "color": to_vec3(light.GetColorAttr().Get()),
                    "direction": to_vec3(frame.TransformDir(Gf.Vec3d(0.0, 0.0, -1.0))),
                    "position": to_vec3(frame.ExtractTranslation()),
                }
            )


def _parameter(prim: Usd.Prim) -> Parameter:
    return Parameter(
        name=prim.GetName(),
        value=_value(prim, "value", 0.0),
        default=_value(prim, "default", 0.0),
        low=_value(prim, "low", None),
        high=_value(prim, "high", None),
        unit=_value(prim, "unit", ""),
    )


def _value(prim: Usd.Prim, name: str, default: object) -> Any:
    attribute = prim.GetAttribute(f"wsim:{name}")
    value = attribute.Get() if attribute else None
    return default if value is None else value


def _line(prim: Usd.Prim) -> str | None:
    line = prim.GetCustomDataByKey("wsim:line")
    return line if isinstance(line, str) else None


def _rigid(prim: Usd.Prim) -> Gf.Matrix4d:
    """A prim's transform to the world, without its scale."""
    if not prim.IsA(UsdGeom.Xformable):
        return Gf.Matrix4d(1.0)
    return UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(_NOW).RemoveScaleShear()


def _turn(frame: Gf.Matrix4d) -> Quat:
    return to_quat(frame.ExtractRotationQuat())


def _shown(prim: Usd.Prim) -> bool:
    """Whether a Gprim takes part: it collides, or a viewer would draw it."""
    if prim.HasAPI(UsdPhysics.CollisionAPI):
        return True
    image = UsdGeom.Imageable(prim)
    hidden = image.ComputeVisibility() == UsdGeom.Tokens.invisible
    return not hidden and image.ComputePurpose() in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


def _owner(prim: Usd.Prim) -> str | None:
    """Path of the nearest rigid body at or above a prim."""
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return str(prim.GetPath())
        prim = prim.GetParent()
    return None


def _body_at(stage: Usd.Stage, path: object) -> str | None:
    return None if path == WORLD_END else _owner(stage.GetPrimAtPath(path))


def _in_fluid(prim: Usd.Prim) -> bool:
    parent = prim.GetParent()
    return schema.has(prim, schema.FLUID) or (bool(parent) and schema.has(parent, schema.FLUID))


def _object_path(prim: Usd.Prim, stage: Usd.Stage) -> str:
    """The object that a static piece of geometry belongs to: the child of the default prim above it."""
    default = stage.GetDefaultPrim()
    parts = prim.GetPath().GetPrefixes()
    under = bool(default) and len(parts) > 1 and parts[0] == default.GetPath()
    return str(parts[1] if under else parts[0])
