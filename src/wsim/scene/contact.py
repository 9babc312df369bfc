"""How the surfaces of two shapes combine, for the simulator and the judge alike.

Two surfaces in contact rub and bounce as the weaker one has it: the smaller friction, the smaller restitution. That is
Project Chrono's rule (ChContactMaterial, its default composition strategy): ice is slippery whatever stands on it, and
clay takes the bounce out of any ball. A surface that states nothing leaves it to the other. Where another engine made
the motion its rule may be another, which the world then says: MuJoCo takes the larger friction.

What resists rolling is the work that the surfaces lose as they are pressed in and let go (Johnson, Contact Mechanics,
1985, 9.2), and of two in series the softer one gives way and loses it: the larger coefficient counts, as in MuJoCo.

What a world states of a pair of objects (`World.contacts`) comes before all that.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.defaults import FRICTION
from wsim.scene.world import Contact, Shape, World

RESTITUTION = 0.0
ROLLING = 0.0


@dataclass(frozen=True)
class Pair:
    """The law of two surfaces: coefficients of friction, restitution and rolling resistance."""

    friction: float
    restitution: float
    rolling: float


def pair_law(world: World, a: Shape, b: Shape) -> Pair:
    """What holds between two shapes of a world."""
    choose = min if world.combine == "smaller" else max
    frictions, restitutions, rollings = (
        [value for value in (getattr(a, name), getattr(b, name)) if value is not None]
        for name in ("friction", "restitution", "rolling")
    )
    law = Pair(
        choose(frictions, default=FRICTION), choose(restitutions, default=RESTITUTION), max(rollings, default=0.0)
    )
    stated = stated_pair(world, a.prim, b.prim)
    if stated is None:
        return law
    return Pair(
        law.friction if stated.friction is None else stated.friction,
        law.restitution if stated.restitution is None else stated.restitution,
        law.rolling if stated.rolling is None else stated.rolling,
    )


def pair_laws(world: World, shapes: Sequence[Shape]) -> NDArray[np.float64]:
    """What holds between any two of some shapes, as `pair_law` has it: friction, restitution, rolling, (n, n, 3)."""
    choose = np.fmin if world.combine == "smaller" else np.fmax
    found = np.empty((len(shapes), len(shapes), 3))
    for k, (name, default, least) in enumerate(
        (("friction", FRICTION, choose), ("restitution", RESTITUTION, choose), ("rolling", ROLLING, np.fmax))
    ):
        own = np.array([getattr(shape, name) for shape in shapes], dtype=np.float64)  # NaN of what states none
        pairs = least.outer(own, own)
        found[..., k] = np.where(np.isnan(pairs), default, pairs)
    if world.contacts:
        for i, a in enumerate(shapes):
            for j, b in enumerate(shapes):
                if stated_pair(world, a.prim, b.prim) is not None:
                    law = pair_law(world, a, b)
                    found[i, j] = law.friction, law.restitution, law.rolling
    return found


def stated_pair(world: World, a: str, b: str) -> Contact | None:
    """What a world states of two objects, given by their prims or by those of their shapes."""
    for contact in world.contacts:
        first, second = contact.first, contact.second
        if (within(a, first) and within(b, second)) or (within(a, second) and within(b, first)):
            return contact
    return None


def passing(world: World) -> Callable[[tuple[str, str], tuple[str, str]], bool]:
    """Whether two shapes, each by its owner's prim and its own, pass through each other by `World.apart`."""
    pairs = {frozenset(pair) for pair in world.apart}

    def passes(one: tuple[str, str], two: tuple[str, str]) -> bool:
        return bool(pairs) and any(frozenset((a, b)) in pairs for a in one for b in two)

    return passes


def within(prim: str, owner: str) -> bool:
    """Whether a prim is an object's, or the object itself."""
    return prim == owner or prim.startswith(owner + "/")


def largest_friction(world: World) -> float:
    """The largest friction of any surface or pair, which bounds what friction does."""
    shapes = [shape for body in world.bodies for shape in body.shapes]
    shapes += [shape for static in world.statics for shape in static.shapes]
    stated = [contact.friction for contact in world.contacts if contact.friction is not None]
    return max([*(friction_of(shape) for shape in shapes), *stated], default=FRICTION)


def friction_of(shape: Shape) -> float:
    """A shape's friction, where nothing that it touches has less."""
    return FRICTION if shape.friction is None else shape.friction


def restitution_of(shape: Shape) -> float:
    """A shape's restitution, where nothing that it touches has less."""
    return RESTITUTION if shape.restitution is None else shape.restitution


def rolling_of(shape: Shape) -> float:
    """A shape's rolling resistance, where nothing that it touches has more."""
    return ROLLING if shape.rolling is None else shape.rolling


def curvature(shape: Shape, *, moves: bool) -> float:
    """What a shape rolls by: one over the radius of its round side [1/m], 0 where it is flat.

    A mesh that moves counts as round with half the middle one of the edges of its bounding box, which is the radius of
    a ball, a wheel and a log alike; one that never moves is ground to roll on.
    """
    if shape.kind in ("sphere", "cylinder", "capsule"):
        return 1.0 / shape.size[0]
    if shape.kind == "mesh" and moves:
        return 2.0 / max(sorted(shape.size)[1], 1e-9)
    return 0.0
