"""Mass properties of a rigid body, by USD's own rules."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.geometry.rotations import matrices
from wsim.scene.solids import Solid, solid
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.usd_shapes import CONE_SIDES, Array, read_shape, to_quat
from wsim.scene.world import Shape

_SMALL_SPHERE = 0.1  # [m]: radius of the ball that USD takes a body without colliders for


@dataclass(frozen=True)
class Mass:
    """mass [kg], com [m] and inertia about it [kg m^2] in the body's frame, volume [m^3] of the colliding shapes."""

    mass: float
    com: Array  # (3,)
    inertia: Array  # (3, 3)
    volume: float


def mass_at(prim: Usd.Prim) -> Mass:
    """Mass properties of the body at `prim`, by what shapes it has."""
    base = rigid_frame(prim)
    parts = (part for part in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()) if part.IsA(UsdGeom.Gprim))
    return mass_of(prim, [shape for part in parts if (shape := read_shape(part, base)) is not None])


def mass_of(prim: Usd.Prim, shapes: list[Shape]) -> Mass:
    """Mass properties of the body at `prim` with these shapes in its frame.

    USD resolves what is authored: the body's mass or density, a collider's own, its material's density, 1000 kg/m^3.
    The shapes give volume, centre and inertia.
    """
    solids = {shape.prim: (shape, _solid(prim.GetStage(), shape)) for shape in shapes if shape.collides}
    volume = sum(each.volume for _, each in solids.values())
    if volume <= 0.0:
        return _without_geometry(prim)

    def information(collider: Usd.Prim) -> UsdPhysics.RigidBodyAPI.MassInformation:
        info = UsdPhysics.RigidBodyAPI.MassInformation()
        info.localRot = Gf.Quatf(1.0)
        found = solids.get(str(collider.GetPath()))
        if found is None:
            info.volume = 0.0
            return info
        shape, each = found
        x, y, z, w = shape.rotation
        info.volume = each.volume
        info.centerOfMass = Gf.Vec3f(*each.com.tolist())
        info.inertia = Gf.Matrix3f(*each.inertia.reshape(-1).tolist())
        info.localPos = Gf.Vec3f(*shape.position)
        info.localRot = Gf.Quatf(w, x, y, z)
        return info

    mass, diagonal, com, axes = UsdPhysics.RigidBodyAPI(prim).ComputeMassProperties(information)
    if not (math.isfinite(mass) and mass > 0.0):
        return _without_geometry(prim)
    inertia = _stated_inertia(prim)  # USD takes what is stated for none below 1e-5 kg m^2
    if inertia is None:
        inertia = _turned(diagonal, axes)
    return Mass(float(mass), np.array(com, dtype=np.float64), inertia, volume)


def _stated_inertia(prim: Usd.Prim) -> Array | None:
    """About the centre of mass, in the body's frame (3, 3) [kg m^2]; None where the body states none."""
    given = UsdPhysics.MassAPI(prim)
    stated, turned = given.GetDiagonalInertiaAttr().Get(), given.GetPrincipalAxesAttr().Get()
    if stated is None or not any(stated):
        return None
    return _turned(stated, turned if turned is not None and turned.GetLength() > 0.0 else Gf.Quatf(1.0))


def _turned(diagonal: Gf.Vec3f, axes: Gf.Quatf) -> Array:
    turn = matrices(np.array(to_quat(axes)))
    found: Array = turn @ np.diag(np.array(diagonal, dtype=np.float64)) @ turn.T
    return found


def _solid(stage: Usd.Stage, shape: Shape) -> Solid:
    """Volume, centre and inertia of a shape at density 1; of a cone, drawn with flat sides, those of a round one.

    Of n sides by t = 2 pi / n each the base has sin(t) / t of a circle's area, and (2 + cos t) / 3 of the mean square
    of its points' way from the axis.
    """
    found = solid(shape)
    cone = UsdGeom.Cone(stage.GetPrimAtPath(shape.prim))
    if not cone or found.volume <= 0.0:
        return found
    side = 2.0 * math.pi / CONE_SIDES
    wider = np.full(3, math.sqrt(3.0 / (2.0 + math.cos(side))))
    wider["XYZ".index(cone.GetAxisAttr().Get())] = 1.0
    spread = (0.5 * np.trace(found.inertia) * np.eye(3) - found.inertia) * np.outer(wider, wider)
    inertia = (np.trace(spread) * np.eye(3) - spread) * (side / math.sin(side))
    return Solid(found.volume * side / math.sin(side), found.com, inertia)


def _without_geometry(prim: Usd.Prim) -> Mass:
    """What the body states, of a small sphere where it states nothing; its centre at the body's origin if not given."""
    api = UsdPhysics.MassAPI(prim)
    mass = float(api.GetMassAttr().Get() or 0.0) if prim.HasAPI(UsdPhysics.MassAPI) else 0.0
    mass, inertia = mass if mass > 0.0 else 1.0, _stated_inertia(prim)
    stated = api.GetCenterOfMassAttr().Get()
    com = np.zeros(3) if stated is None or not np.isfinite(stated).all() else np.array(stated, dtype=np.float64)
    return Mass(mass, com, np.eye(3) * 0.4 * mass * _SMALL_SPHERE**2 if inertia is None else inertia, 0.0)
