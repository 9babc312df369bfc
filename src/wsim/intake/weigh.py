"""Mass, centre of mass and inertia: of what is seen where it is closed, else of what collides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wsim.intake.lattice import hull_of
from wsim.intake.model import Array, Body, Collider, IntakeError, Mesh
from wsim.intake.repair import Solid
from wsim.limits import MAX_DENSITY, MIN_DENSITY
from wsim.scene.solids import solid as integrals
from wsim.scene.world import Shape

DENSITY = 700.0  # [kg/m^3], of dry oak and beech
LIGHTEST, HEAVIEST = 1e-6, 1e5  # [kg]


@dataclass(frozen=True)
class Weight:
    """Mass [kg], its centre [m] in the asset's frame, and its inertia (3, 3) about that [kg m^2]."""

    mass: float
    com: Array
    inertia: Array


def weigh(body: Body, solid: Solid, colliders: list[Collider], *, density: float | None, mass: float | None) -> Weight:
    """What a body weighs: as the user says, as its file says, or at a density.

    Raises:
        IntakeError: If a number is out of range.
    """
    lumps = [solid.mesh()] if solid.closed else [hull_of(collider) for collider in colliders]
    volume, com, inertia = _integral(lumps)
    if mass is None and density is None and body.mass is not None:
        mass, com = body.mass, body.com if body.com is not None else com
        if body.inertia is not None and _possible(body.inertia):
            return Weight(mass, com, body.inertia)
    if mass is None:
        mass = volume * (DENSITY if density is None else density)
    if not LIGHTEST <= mass <= HEAVIEST:
        raise IntakeError(f"mass = {mass:.3g} kg must be {LIGHTEST:g} to {HEAVIEST:g}; give --mass, --height or --unit")
    return Weight(float(f"{mass:.6g}"), com, inertia * (mass / volume))


def check_numbers(density: float | None, mass: float | None) -> None:
    """What a user says of a weight.

    Raises:
        IntakeError: If it is no number in range, or both are given.
    """
    if density is not None and mass is not None:
        raise IntakeError(f"density = {density:g} and mass = {mass:g}: either says the other; give one")
    if density is not None and not MIN_DENSITY <= density <= MAX_DENSITY:
        raise IntakeError(f"density = {density:g} must be {MIN_DENSITY:g} to {MAX_DENSITY:g} kg/m^3; water has 1000")
    if mass is not None and not LIGHTEST <= mass <= HEAVIEST:
        raise IntakeError(f"mass = {mass:g} must be {LIGHTEST:g} to {HEAVIEST:g} kg")


def _possible(inertia: Array) -> bool:
    moments = np.linalg.eigvalsh(inertia)
    return bool(moments[0] > 0.0 and moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-6))


def _integral(meshes: list[Mesh]) -> tuple[float, Array, Array]:
    """Volume, centre, and inertia about it at density 1, of closed meshes together."""
    volume, moment, about_origin = 0.0, np.zeros(3), np.zeros((3, 3))
    for mesh in meshes:
        shape = Shape(prim="", kind="mesh", size=(), vertices=mesh.points.tolist(), triangles=mesh.faces.tolist())
        part = integrals(shape)
        volume += part.volume
        moment += part.volume * part.com
        about_origin += part.inertia + part.volume * _spread(part.com)
    com = moment / volume
    return volume, com, about_origin - volume * _spread(com)


def _spread(arm: Array) -> Array:
    """Inertia of a unit mass at the end of an arm (Steiner's theorem)."""
    return float(arm @ arm) * np.eye(3) - np.outer(arm, arm)
