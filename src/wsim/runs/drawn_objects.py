"""What a drawn number belongs to: objects of a stage by their names, and the prims that state them."""

from __future__ import annotations

import math

from pxr import Gf, Usd, UsdGeom

from wsim.errors import UserError
from wsim.scene.authoring import set_pose
from wsim.scene.validate import suggestion
from wsim.scene.world import Body, Fluid, Static, World


def solid_of(world: World, target: str, what: str) -> Body | Static:
    """The object of a name, or of a prim's path."""
    solids: list[Body | Static] = [*world.bodies, *world.statics]
    found = [solid for solid in solids if target in (solid.prim, name_of(solid.prim))]
    if len(found) == 1:
        return found[0]
    if found:
        raise UserError(f"{what}: {target} names {len(found)} objects; give one of {', '.join(s.prim for s in found)}")
    raise UserError(f"{what}: the world has no {target!r}; {suggestion(target, [name_of(s.prim) for s in solids])}")


def fluid_of(world: World, target: str, what: str) -> Fluid:
    """The fluid of a name, or the one in a tank of that name."""
    found = [fluid for fluid in world.fluids if target in (name_of(fluid.prim), name_of(fluid.container or ""))]
    if len(found) == 1:
        return found[0]
    known = ", ".join(name_of(fluid.prim) for fluid in world.fluids) or "no fluid"
    raise UserError(f"{what}: {target} names {len(found) or 'no'} fluids; the world has {known}")


def name_of(prim: str) -> str:
    """The last part of a prim's path."""
    return prim.rsplit("/", 1)[-1]


def changeable(stage: Usd.Stage, path: str, what: str) -> Usd.Prim:
    """A prim that is its own; those that instances share cannot be changed for one of them."""
    prim = stage.GetPrimAtPath(path)
    if prim.IsInstanceProxy():
        raise UserError(f"{what}: {path} is shared with other instances of its asset; vary it by a scene.param")
    return prim


def free(stage: Usd.Stage, path: str) -> str:
    """A path at which there is no prim."""
    while stage.GetPrimAtPath(path):
        path += "_"
    return path


def shift(prim: Usd.Prim, by: Gf.Matrix4d) -> None:
    """Give a prim another transform: the one that it has in the world, then `by`."""
    own, now = UsdGeom.Xformable(prim), Usd.TimeCode.Default()
    above = own.ComputeParentToWorldTransform(now)
    moved = Gf.Transform(own.ComputeLocalToWorldTransform(now) * by * above.GetInverse())
    place, scale = moved.GetTranslation(), moved.GetScale()
    plain = all(math.isclose(each, 1.0, abs_tol=1e-9) for each in scale)
    turn = Gf.Quatd(moved.GetRotation().GetQuat())
    set_pose(prim, tuple(place), turn, None if plain else tuple(scale))
