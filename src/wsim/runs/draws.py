"""Numbers of a stage that are drawn anew for a run: masses, frictions, poses and levels.

They are set on the stage that a program has built, outside of its sandbox: the program knows nothing of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdPhysics, UsdShade

from wsim.errors import UserError
from wsim.runs.drawn_objects import changeable, fluid_of, free, solid_of
from wsim.runs.drawn_places import held_together, move, set_level
from wsim.scene import schema
from wsim.scene.authoring import LOOKS
from wsim.scene.contact import within
from wsim.scene.describe import describe
from wsim.scene.principal import principal
from wsim.scene.world import Static, World

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
        prim = _owner(world, target, kind, told)
        if (prim, kind) in drawn:
            raise UserError(f"{told}: {drawn[prim, kind]} is the same number; give it once")
        drawn[prim, kind] = told
        if kind == "mass":
            _set_mass(stage, world, target, value, times)
        elif kind == "friction":
            _set_friction(stage, world, target, value, times)
        elif kind == "level":
            set_level(stage, world, target, value, times)
        else:
            move(stage, world, target, kind, value)
    partial = path.with_name(f"drawn-{path.name}")
    stage.GetRootLayer().Export(str(partial))
    partial.replace(path)


def _owner(world: World, target: str, kind: str, told: str) -> str:
    """The prim that a number is of, whatever it is called."""
    if kind.startswith("pose"):
        return held_together(world, target)
    return (fluid_of if kind == "level" else solid_of)(world, target, told).prim


def _set_mass(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of a body whose centre stays where it is: its inertia grows as its mass does."""
    what = f"{target}.mass"
    body = solid_of(world, target, what)
    if isinstance(body, Static):
        raise UserError(f"{what}: {target} never moves, and has no mass; name a body")
    if body.kinematic:
        raise UserError(f"{what}: {target} goes its way whatever its mass; name a body that forces move")
    mass = value * body.mass if times else value
    moments, axes = principal(np.reshape(body.inertia, (3, 3)) * (mass / body.mass))
    api = UsdPhysics.MassAPI.Apply(changeable(stage, body.prim, what))
    api.CreateMassAttr(mass)
    api.CreateCenterOfMassAttr(Gf.Vec3f(*body.com))
    api.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    api.CreatePrincipalAxesAttr(axes)


def _set_friction(stage: Usd.Stage, world: World, target: str, value: float, times: bool) -> None:
    """Of all of an object's surfaces, each by a material of its own: others may share the one that it has."""
    what = f"{target}.friction"
    solid = solid_of(world, target, what)
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
        prim = changeable(stage, shape.prim, what)
        name = f"{LOOKS}/{solid.prim.rsplit('/', 1)[-1]}_drawn_{k}"
        material = _with_friction(stage, free(stage, name), prim, friction)
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
