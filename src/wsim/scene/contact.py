"""How the surfaces of two shapes combine, for the simulator and the judge alike.

Two surfaces in contact rub and bounce as the weaker one has it: the smaller friction, the smaller restitution. That is
Project Chrono's rule (ChContactMaterial, its default composition strategy): ice is slippery whatever stands on it, and
clay takes the bounce out of any ball. A surface that states nothing leaves it to the other. Where another engine made
the motion its rule may be another, which the world then says: MuJoCo takes the larger friction.
"""

from __future__ import annotations

from dataclasses import dataclass

from wsim.defaults import FRICTION
from wsim.scene.world import Shape, World

RESTITUTION = 0.0


@dataclass(frozen=True)
class Pair:
    """The law of two surfaces: coefficients of friction and restitution."""

    friction: float
    restitution: float


def pair_law(world: World, a: Shape, b: Shape) -> Pair:
    """What holds between two shapes of a world."""
    choose = min if world.combine == "smaller" else max
    frictions = [value for value in (a.friction, b.friction) if value is not None]
    restitutions = [value for value in (a.restitution, b.restitution) if value is not None]
    return Pair(choose(frictions, default=FRICTION), choose(restitutions, default=RESTITUTION))


def friction_of(shape: Shape) -> float:
    """A shape's friction, where nothing that it touches has less."""
    return FRICTION if shape.friction is None else shape.friction


def restitution_of(shape: Shape) -> float:
    """A shape's restitution, where nothing that it touches has less."""
    return RESTITUTION if shape.restitution is None else shape.restitution
