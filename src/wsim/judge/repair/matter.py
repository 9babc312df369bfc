"""What a body is made of: targets of its density, its friction, and what takes its energy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import ROUND
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.repair.rule import ROOM, density, planned_density, shapes_of
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import friction_of, pair_law, rolling_of

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence

NEAR = 0.1  # of a body's smallest extent: a gap below is that of what stands on something
LEVEL = 0.01  # [rad]: a slope below has no direction
AFLOAT, SUNK = 0.5, 2.0  # of the fluid's density: as light as wood, as heavy as stone, where nothing says more


def own_density(evidence: Evidence, prim: str, to: float | None, why: str) -> RepairTarget:
    """Another density of a body [kg/m^3]."""
    now = density(evidence, prim)
    way = "change" if to is None or to == now else "raise" if to > now else "lower"
    return RepairTarget.model_validate(
        {"kind": "physical parameter", "prim": prim, "parameter": "density", "direction": way, "current": now,
         "suggested": to, "unit": "kg/m^3", "why": why}
    )  # fmt: skip


def lighter(evidence: Evidence, prim: str, than: float) -> RepairTarget:
    """As light as planned, or as wood, so that it floats in a fluid of a density [kg/m^3]."""
    planned = planned_density(evidence, prim)
    to = planned if planned is not None and planned < than else AFLOAT * than
    why = f"what floats is lighter than the fluid's {than:g} kg/m^3"
    return own_density(evidence, prim, to, why).model_copy(update={"direction": "lower"})


def heavier(evidence: Evidence, prim: str, than: float) -> RepairTarget:
    """As heavy as planned, or as stone, so that it sinks in a fluid of a density [kg/m^3]."""
    planned = planned_density(evidence, prim)
    to = planned if planned is not None and planned > than else SUNK * than
    why = f"what sinks is heavier than the fluid's {than:g} kg/m^3"
    return own_density(evidence, prim, to, why).model_copy(update={"direction": "raise"})


def friction(evidence: Evidence, prim: str, way: str, to: float | None, why: str, under: str = "") -> RepairTarget:
    """Another friction of a body, with room to the value at which it just holds, or just lets go.

    Args:
        evidence: What happened.
        prim: The body.
        way: "raise" or "lower".
        to: The value at which it just holds.
        why: What friction does there.
        under: The prim that it is on: of two surfaces the smoother counts, and is the one to raise.
    """
    to = None if to is None else to * (1.0 + ROOM if way == "raise" else 1.0 - ROOM)
    shapes = {prim: evidence.body(prim).shapes[:1]}
    if way == "raise":
        shapes[under] = [shape for shape in shapes_of(evidence, under) if shape.collides][:1]
    known = {owner: friction_of(found[0]) for owner, found in shapes.items() if found}
    smoother = min(known, key=lambda each: known[each], default=prim)
    now = known.get(smoother)
    if to is not None and now is not None and (to > now) != (way == "raise"):
        to = None  # friction is on the right side of it already: it is not what is wrong, or not alone
    return RepairTarget.model_validate(
        {"kind": "physical parameter", "prim": smoother, "parameter": "friction", "direction": way, "current": now,
         "suggested": to, "why": why}
    )  # fmt: skip


def slope(evidence: Evidence, prim: str, under: str) -> float:
    """Of the face of a static object that a body is over [rad]; 0 of what is not static."""
    static = evidence.static(under)
    if static is None or not static.shapes:
        return 0.0
    points = evidence.body_q[:, evidence.index(prim), :3]
    return math.acos(min(1.0, abs(float(normal_under(static.shapes, points, evidence.up) @ evidence.up))))


def slides_off(evidence: Evidence, prim: str) -> RepairTarget | None:
    """The target of what starts on a slope, at rest, that is too steep for the friction there; None for others."""
    body = evidence.body(prim)
    if np.linalg.norm(body.velocity) > 0.0 or not body.shapes:
        return None
    reach = NEAR * evidence.solid(evidence.index(prim)).smallest
    for static in evidence.world.statics:
        steep = slope(evidence, prim, static.prim)
        laws = [pair_law(evidence.world, one, other) for one in body.shapes for other in static.shapes]
        held = max((law.friction for law in laws), default=math.inf)
        if steep > LEVEL and math.tan(steep) > held and distance(evidence, prim, static.prim)[0] < reach:
            why = f"it slides on a slope of {math.degrees(steep):.3g} degrees, where friction is below the tangent"
            return friction(evidence, prim, "raise", math.tan(steep), why, static.prim)
    return None


def damped(evidence: Evidence, i: int, why: str) -> RepairTarget:
    """What goes on and on needs something that takes its energy: what is round resistance to rolling, else friction."""
    body = evidence.world.bodies[i]
    rolls = any(shape.kind in ROUND for shape in body.shapes)
    has = (rolling_of if rolls else friction_of)(body.shapes[0]) if body.shapes else None
    parameter = "rolling_friction" if rolls else "friction"
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter=parameter, direction="raise", current=has, why=why
    )  # fmt: skip
