"""Numbers of a stage that are drawn anew for a run: masses, frictions, poses and levels.

They are set on the stage that a program has built, outside of its sandbox: the program knows nothing of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade

from wsim.errors import UserError
from wsim.scene import schema
from wsim.scene.authoring import LOOKS, set_extent, set_pose
from wsim.scene.contact import within
from wsim.scene.describe import describe
from wsim.scene.validate import suggestion
from wsim.scene.world import Body, Fluid, Static, World

MOST_FRICTION = 10.0  # as `scene.material` has it
TIMES = " x"  # ends the name of a number that multiplies what the stage states


def apply(path: Path, draws: Mapping[str, float]) -> None:
    """Set drawn numbers on a stage, in its file.

    Args:
        path: Of the stage.
        draws: By name: "crate.mass" [kg], "floor.friction", "tank.level" [m], each with " x" behind it where the
            number multiplies what is stated; "crate.pose.x" and "crate.pose.y" [m], by which the crate is moved in the
            world, and "crate.pose.turn" [deg], by which it is turned about the vertical through its origin.

    Raises:
        UserError: Naming what the stage lacks, or what cannot be changed in it.
    """
    if not draws:
        return
    stage = Usd.Stage.Open(str(path))
    world = describe(stage)
    drawn: dict[tuple[str, str], str] = {}
    for name, value in draws.items():
        target, _, what = name.partition(".")
        kind, times = what.removesuffix(TIMES), what.endswith(TIMES)
        told = f"{target}.{kind.partition('.')[0]}"
        prim = (_fluid if kind == "level" else _solid)(world, target, told).prim
        if (prim, kind) in drawn:
            raise UserError(f"{told}: {drawn[prim, kind]} is the same number; give it once")
        drawn[prim, kind] = told
        if kind == "mass":
            _set_mass(stage, world, target, value, times)
        elif kind == "friction":
            _set_friction(stage, world, target, value, times)
        elif kind == "level":
            _set_level(stage, world, target, value, times)
        else:
            _move(stage, world, target, kind, value)
    partial = path.with_name(f"drawn-{path.name}")
    stage.GetRootLayer().Export(str(partial))
    partial.replace(path)


def _set_mass(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of a body whose centre stays where it is: its inertia grows as its mass does."""
    what = f"{target}.mass"
    body = _solid(world, target, what)
    if isinstance(body, Static):
        raise UserError(f"{what}: {target} never moves, and has no mass; name a body")
    if body.kinematic:
        raise UserError(f"{what}: {target} goes its way whatever its mass; name a body that forces move")
    mass = value * body.mass if times else value
    moments, axes = np.linalg.eigh(np.reshape(body.inertia, (3, 3)) * (mass / body.mass))
    axes[:, 0] *= np.linalg.det(axes)  # a rotation, no mirror
    turn = Gf.Matrix3d(*axes.T.reshape(-1).tolist()).ExtractRotation().GetQuat()  # USD multiplies rows from the left
    api = UsdPhysics.MassAPI.Apply(_changeable(stage, body.prim, what))
    api.CreateMassAttr(mass)
    api.CreateCenterOfMassAttr(Gf.Vec3f(*body.com))
    api.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    api.CreatePrincipalAxesAttr(Gf.Quatf(turn))


def _set_friction(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of all of an object's surfaces, each by a material of its own: others may share the one that it has."""
    what = f"{target}.friction"
    solid = _solid(world, target, what)
    for pair in world.contacts:
        if pair.friction is not None and (within(pair.first, solid.prim) or within(pair.second, solid.prim)):
            raise UserError(f"{what}: {pair.prim} states the friction of a pair, which comes first; leave it out there")
    shapes = [shape for shape in solid.shapes if shape.collides]
    if not shapes:
        raise UserError(f"{what}: {target} has no surface that collides")
    for k, shape in enumerate(shapes):
        if times and shape.friction is None:
            raise UserError(f"{what}: {shape.prim} states no friction to multiply; give values, as {what}=0.3:0.6")
        friction = value * shape.friction if times and shape.friction is not None else value
        if friction > MOST_FRICTION:
            raise UserError(f"{what} = {friction:g} is above {MOST_FRICTION:g}; give a smaller one")
        prim = _changeable(stage, shape.prim, what)
        name = f"{LOOKS}/{solid.prim.rsplit('/', 1)[-1]}_drawn_{k}"
        material = _with_friction(stage, _free(stage, name), prim, friction)
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(material, UsdShade.Tokens.strongerThanDescendants, "physics")


def _with_friction(stage: Usd.Stage, path: str, prim: Usd.Prim, friction: float) -> UsdShade.Material:
    """A material as the one of a piece of geometry, but for its friction."""
    before, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    made = UsdShade.Material.Define(stage, path)
    api = UsdPhysics.MaterialAPI.Apply(made.GetPrim())
    api.CreateStaticFrictionAttr(friction)
    api.CreateDynamicFrictionAttr(friction)
    for name in ("physics:restitution", "physics:density", "wsim:rolling") if before else ():
        stated = before.GetPrim().GetAttribute(name)
        if not stated or not stated.HasAuthoredValue():
            continue
        if name == "wsim:rolling":
            schema.apply(made.GetPrim(), schema.MATERIAL, {"rolling": (Sdf.ValueTypeNames.Double, stated.Get())})
        else:
            made.GetPrim().GetAttribute(name).Set(stated.Get())
    return made


def _set_level(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of a fluid, or of the one in a tank: its depth, above a bottom that stays where it is."""
    what = f"{target}.level"
    fluid = _fluid(world, target, what)
    level = value * fluid.size[2] if times else value
    if level < fluid.spacing:
        raise UserError(f"{what} = {level:g} m is less than a particle ({fluid.spacing:g} m); give a larger one")
    prim, bottom = _changeable(stage, fluid.prim, what), fluid.center[2] - fluid.size[2] / 2
    for tank in world.containers:
        rim = tank.inner_center[2] + tank.inner_size[2] / 2
        if tank.prim == fluid.container and bottom + level > rim + 1e-6:
            raise UserError(f"{what} = {level:g} m is above the rim, {rim - bottom:g} m; give a smaller one")
    size = (fluid.size[0], fluid.size[1], level)
    prim.GetAttribute("wsim:size").Set(Gf.Vec3f(*size))
    for child in prim.GetChildren():  # what is drawn of it
        if child.IsA(UsdGeom.Cube):
            set_pose(child, (0.0, 0.0, 0.0), scale=size)
            set_extent(child)
    _shift(prim, Gf.Matrix4d().SetTranslate(Gf.Vec3d(0.0, 0.0, (level - fluid.size[2]) / 2)))


def _move(stage: Usd.Stage, world: World, target: str, kind: str, value: float) -> None:
    """A loose body, or an object that never moves; what hangs together would be torn apart."""
    what = f"{target}.pose"
    solid = _solid(world, target, what)
    holder = next((prim for ends, prim in _ties(world) if any(within(end, solid.prim) for end in ends)), None)
    if holder is not None:
        raise UserError(f"{what}: {holder} holds {target} to where it is; move what hangs together by a scene.param")
    if isinstance(solid, Body) and solid.path is not None:
        raise UserError(f"{what}: {target} follows a path, which says where it is; move that by a scene.param")
    if any(body.prim.startswith(solid.prim + "/") for body in world.bodies):
        raise UserError(f"{what}: {target} has bodies of its own within it; move each, or all by a scene.param")
    prim = _changeable(stage, solid.prim, what)
    if not prim.IsA(UsdGeom.Xformable):
        raise UserError(f"{what}: {solid.prim} has no place of its own; move it by a scene.param")
    place = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()).ExtractTranslation()
    if kind == "pose.turn":
        turn = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(0.0, 0.0, 1.0), value))
        _shift(prim, Gf.Matrix4d().SetTranslate(-place) * turn * Gf.Matrix4d().SetTranslate(place))
    else:
        along = Gf.Vec3d(value, 0.0, 0.0) if kind == "pose.x" else Gf.Vec3d(0.0, value, 0.0)
        _shift(prim, Gf.Matrix4d().SetTranslate(along))


def _shift(prim: Usd.Prim, by: Gf.Matrix4d) -> None:
    """Give a prim another transform: the one that it has in the world, then `by`."""
    own, now = UsdGeom.Xformable(prim), Usd.TimeCode.Default()
    above = own.ComputeParentToWorldTransform(now)
    moved = Gf.Transform(own.ComputeLocalToWorldTransform(now) * by * above.GetInverse())
    place, scale = moved.GetTranslation(), moved.GetScale()
    plain = all(math.isclose(each, 1.0, abs_tol=1e-9) for each in scale)
    turn = Gf.Quatd(moved.GetRotation().GetQuat())
    set_pose(prim, tuple(place), turn, None if plain else tuple(scale))


def _ties(world: World) -> Iterator[tuple[list[str], str]]:
    """What each joint, spring, rope and tank holds in its place, and its prim."""
    for joint in world.joints:
        yield [end for end in (joint.parent, joint.child, joint.fixture) if end], joint.prim
    for cord in world.cords:
        yield [end for guide in cord.path for end in (guide.body, guide.owner) if end], cord.prim
    for fluid in world.fluids:
        yield [fluid.container] if fluid.container else [], fluid.prim


def _solid(world: World, target: str, what: str) -> Body | Static:
    """The object of a name, or of a prim's path."""
    solids: list[Body | Static] = [*world.bodies, *world.statics]
    found = [solid for solid in solids if target in (solid.prim, _name(solid.prim))]
    if len(found) == 1:
        return found[0]
    if found:
        raise UserError(f"{what}: {target} names {len(found)} objects; give one of {', '.join(s.prim for s in found)}")
    raise UserError(f"{what}: the world has no {target!r}; {suggestion(target, [_name(s.prim) for s in solids])}")


def _fluid(world: World, target: str, what: str) -> Fluid:
    """The fluid of a name, or the one in a tank of that name."""
    found = [fluid for fluid in world.fluids if target in (_name(fluid.prim), _name(fluid.container or ""))]
    if len(found) == 1:
        return found[0]
    known = ", ".join(_name(fluid.prim) for fluid in world.fluids) or "no fluid"
    raise UserError(f"{what}: {target} names {len(found) or 'no'} fluids; the world has {known}")


def _name(prim: str) -> str:
    return prim.rsplit("/", 1)[-1]


def _changeable(stage: Usd.Stage, path: str, what: str) -> Usd.Prim:
    prim = stage.GetPrimAtPath(path)
    if prim.IsInstanceProxy():
        raise UserError(f"{what}: {path} is shared with other instances of its asset; vary it by a scene.param")
    return prim


def _free(stage: Usd.Stage, path: str) -> str:
    while stage.GetPrimAtPath(path):
        path += "_"
    return path
