"""Read a stage back as plain data: what simulator, recording and judge know of a world.

Any UsdPhysics stage in metres, kilograms and Z up can be read, not only what the calls of a `Scene` wrote.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pxr import Gf, Tf, Usd, UsdGeom, UsdLux, UsdPhysics

from wsim.defaults import DURATION, FLUID_DENSITY, FLUID_VISCOSITY, FRAME_RATE, GRAVITY
from wsim.errors import UserError
from wsim.scene import schema
from wsim.scene.describe_cords import ropes, springs
from wsim.scene.describe_joints import read_gears, read_joints
from wsim.scene.describe_schedules import read_schedules
from wsim.scene.errors import one_line
from wsim.scene.usd_cameras import is_view, read_camera
from wsim.scene.usd_contacts import read_contacts
from wsim.scene.usd_mass import mass_of
from wsim.scene.usd_motion import curve_of, path_of, with_surface_velocity
from wsim.scene.usd_openings import read_drains, read_taps
from wsim.scene.usd_policies import read_policies
from wsim.scene.usd_prims import object_path, owner_of, rigid_frame, turn_of
from wsim.scene.usd_reaches import read_joint_paths, read_reaches
from wsim.scene.usd_sensors import read_sensors
from wsim.scene.usd_shapes import collides_as_hull, collides_exactly, read_shape, to_quat, to_vec3
from wsim.scene.usd_values import line_of, value_of
from wsim.scene.world import (
    Body,
    Container,
    Fluid,
    Gear,
    Joint,
    Light,
    Parameter,
    Shape,
    Static,
    World,
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
    ours, default = schema.ours(prims), stage.GetDefaultPrim()
    bodies, statics = _solids(prims, ours, stage)
    joints, gears = list(read_joints(prims)), list(read_gears(prims))
    return World(
        name=default.GetName() if default else "world",
        **_run(prims),
        bodies=bodies,
        statics=statics,
        containers=[_container(prim) for prim in ours if schema.has(prim, schema.CONTAINER)],
        fluids=[_fluid(prim) for prim in ours if schema.has(prim, schema.FLUID)],
        taps=list(read_taps(ours)),
        drains=list(read_drains(ours)),
        joints=joints,
        gears=gears,
        policies=list(read_policies(ours)),
        schedules=read_schedules(ours),
        joint_paths=list(read_joint_paths(ours)),
        reaches=list(read_reaches(ours)),
        sensors=list(read_sensors(ours)),
        apart=[*_meshed(joints, gears), *_filtered(prims)],
        springs=springs(ours),
        ropes=ropes(ours),
        contacts=read_contacts(ours),
        cameras=[read_camera(prim) for prim in prims if is_view(prim)],
        lights=list(_lights(prims)),
        parameters=[_parameter(prim) for prim in ours if schema.has(prim, schema.PARAMETER)],
    )


def _meshed(joints: list[Joint], gears: list[Gear]) -> Iterator[tuple[str, str]]:
    """The bodies that gears mesh, which do not touch: those that the joints move."""
    child = {joint.prim: joint.child for joint in joints}
    for gear in gears:
        if gear.first in child and gear.second in child:
            yield child[gear.first], child[gear.second]


def _filtered(prims: list[Usd.Prim]) -> Iterator[tuple[str, str]]:
    """What `PhysicsFilteredPairsAPI` keeps from touching: bodies, or shapes."""
    for prim in prims:
        if prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            for path in UsdPhysics.FilteredPairsAPI(prim).GetFilteredPairsRel().GetTargets():
                yield str(prim.GetPath()), str(path)


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
        "duration": float(value_of(prim, "duration", DURATION)),
        "frame_rate": float(value_of(prim, "frameRate", FRAME_RATE)),
        "time_step": float(value_of(prim, "timeStep", 0.0)),
        "seed": int(value_of(prim, "seed", 0)),
    }


def _solids(prims: list[Usd.Prim], ours: list[Usd.Prim], stage: Usd.Stage) -> tuple[list[Body], list[Static]]:
    # Asked of each shape and all above it; of most stages once will do.
    belts, wet = (any(schema.has(prim, name) for prim in ours) for name in (schema.SURFACE_VELOCITY, schema.FLUID))
    bodies = {str(prim.GetPath()): prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)}
    frames = {path: rigid_frame(prim) for path, prim in bodies.items()}
    of_body: dict[str, list[Shape]] = {path: [] for path in bodies}
    of_static: dict[str, list[Shape]] = {}
    for prim in prims:
        if not prim.IsA(UsdGeom.Gprim) or not _shown(prim) or (wet and _in_fluid(prim)):
            continue
        owner = owner_of(prim)
        base = frames[owner] if owner else Gf.Matrix4d(1.0)
        shape = read_shape(prim, base)
        if shape is None:
            continue
        if belts:
            shape = with_surface_velocity(shape, prim, base)
        if collides_as_hull(prim, moves=bool(owner)):
            shape = shape.model_copy(update={"convex": True})
        if owner:
            of_body[owner].append(shape)
        else:
            if collides_exactly(prim):
                shape = shape.model_copy(update={"exact": True})
            of_static.setdefault(object_path(prim, stage), []).append(shape)
    moving = [_body(prim, frames[path], of_body[path]) for path, prim in bodies.items()]
    still = [
        Static(prim=path, shapes=shapes, line=line_of(stage.GetPrimAtPath(path))) for path, shapes in of_static.items()
    ]
    return moving, still


def _body(prim: Usd.Prim, frame: Gf.Matrix4d, shapes: list[Shape]) -> Body:
    api = UsdPhysics.RigidBodyAPI(prim)
    mass = mass_of(prim, shapes)
    velocity = frame.TransformDir(Gf.Vec3d(api.GetVelocityAttr().Get()))
    spin = frame.TransformDir(Gf.Vec3d(api.GetAngularVelocityAttr().Get())) * (math.pi / 180.0)
    path = path_of(prim)
    place, turn = to_vec3(frame.ExtractTranslation()), to_quat(frame.ExtractRotationQuat())
    if path is not None:
        place, turn = (tuple(part.tolist()) for part in curve_of(path).pose(0.0))
    return Body(
        prim=str(prim.GetPath()),
        mass=mass.mass,
        volume=mass.volume,
        com=to_vec3(mass.com),
        inertia=tuple(mass.inertia.reshape(-1).tolist()),
        position=place,
        rotation=turn,
        velocity=to_vec3(velocity),
        angular_velocity=to_vec3(spin),
        kinematic=bool(api.GetKinematicEnabledAttr().Get()),
        path=path,
        shapes=shapes,
        line=line_of(prim),
    )


def _container(prim: Usd.Prim) -> Container:
    frame = rigid_frame(prim)
    center = Gf.Vec3d(value_of(prim, "innerCenter", Gf.Vec3f(0.0)))
    return Container(
        prim=str(prim.GetPath()),
        inner_size=to_vec3(value_of(prim, "innerSize", Gf.Vec3f(0.0))),
        inner_center=to_vec3(frame.Transform(center)),
        rotation=turn_of(frame),
    )


def _fluid(prim: Usd.Prim) -> Fluid:
    container = prim.GetRelationship("wsim:container")
    targets = container.GetTargets() if container else []
    looks = [shape for child in prim.GetChildren() if child.IsA(UsdGeom.Gprim) and (shape := _look(child))]
    fluid = Fluid(
        prim=str(prim.GetPath()),
        density=value_of(prim, "density", FLUID_DENSITY),
        viscosity=value_of(prim, "viscosity", FLUID_VISCOSITY),
        yield_stress=value_of(prim, "yieldStress", 0.0),
        flow_index=value_of(prim, "flowIndex", 1.0),
        spacing=value_of(prim, "spacing", 0.0),
        size=to_vec3(value_of(prim, "size", Gf.Vec3f(0.0))),
        center=to_vec3(rigid_frame(prim).ExtractTranslation()),
        velocity=to_vec3(value_of(prim, "velocity", Gf.Vec3f(0.0))),
        speed_of_sound=value_of(prim, "speedOfSound", 0.0),
        container=str(targets[0]) if targets else None,
        volume=value_of(prim, "volume", None),
        attenuation_length=value_of(prim, "attenuationLength", None),
        line=line_of(prim),
    )
    return fluid.model_copy(update={"color": looks[0].color}) if looks else fluid


def _look(prim: Usd.Prim) -> Shape | None:
    return read_shape(prim, Gf.Matrix4d(1.0))


def _lights(prims: list[Usd.Prim]) -> Iterator[Light]:
    for prim in prims:
        for usd, kind in _LIGHTS:
            if not prim.IsA(usd):
                continue
            light, frame = UsdLux.LightAPI(prim), rigid_frame(prim)
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
        value=value_of(prim, "value", 0.0),
        default=value_of(prim, "default", 0.0),
        low=value_of(prim, "low", None),
        high=value_of(prim, "high", None),
        unit=value_of(prim, "unit", ""),
    )


def _shown(prim: Usd.Prim) -> bool:
    """Whether a Gprim takes part: it collides, or a viewer would draw it."""
    if prim.HasAPI(UsdPhysics.CollisionAPI):
        return True
    image = UsdGeom.Imageable(prim)
    hidden = image.ComputeVisibility() == UsdGeom.Tokens.invisible
    return not hidden and image.ComputePurpose() in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


def _in_fluid(prim: Usd.Prim) -> bool:
    parent = prim.GetParent()
    return schema.has(prim, schema.FLUID) or (bool(parent) and schema.has(parent, schema.FLUID))
