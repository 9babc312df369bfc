"""Arguments of `scene.fluid`: what fills a tank, or stands as a block of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wsim.defaults import GRAVITY
from wsim.plan.schema import Plan, PlanObject
from wsim.plan.spacing import ACROSS, spacing_of
from wsim.plan.vessels import filled_box, vessel_of
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position
from wsim.program.source import number, tuple_of

_SOUND_OVER_FALL = 30.0


def container(item: PlanObject) -> str | None:
    """The name of what an object is placed in."""
    relation = item.relation("PLACE-IN")
    return relation.ref if relation is not None else None


def level(item: PlanObject) -> float:
    """How high a fluid fills its container [m]; infinity where a block of it stands there."""
    relation = item.relation("FREE-SURFACE-AT")
    return math.inf if relation is None or relation.value is None else relation.value


def arguments(draft: Draft, item: PlanObject) -> list[str]:
    """All arguments but the name."""
    plan = draft.plan
    held = container(item)
    amount = item.registration.volume
    if held is not None and (amount is not None or level(item) < math.inf):
        high = level(item) if amount is None else None
        volume: Sequence[float] = _in_the_end(plan, item, filled_box(plan.object(held), high, amount))
        how = f"level={number(level(item))}" if amount is None else f"volume={number(amount)}"
        found = [f"fills={draft.handles[held]}", how]
    else:
        volume = item.size
        found = [f"size={tuple_of(item.size)}", f"position={tuple_of(position(item))}"]
    found.append(f"spacing={number(_spacing(plan, item, volume))}")
    if any(item.velocity):
        found.append(f"velocity={tuple_of(item.velocity)}")
    if item.registration.viscosity is not None:
        found.append(f"viscosity={number(item.registration.viscosity)}")
    for name in ("yield_stress", "flow_index"):
        if (value := getattr(item.registration, name)) is not None:
            found.append(f"{name}={number(value)}")
    if any(objective.kind == "fills" and objective.object == item.name for objective in plan.objectives):
        found.append(f"speed_of_sound={number(_sound(item))}")
    if item.density is not None:
        found.append(f"density={number(item.density)}")
    if item.material is not None:
        found.append(f"color={tuple_of(item.material.color)}")
        if item.material.attenuation_length is not None:
            found.append(f"attenuation_length={number(item.material.attenuation_length)}")
    return found


def _in_the_end(plan: Plan, item: PlanObject, box: Sequence[float]) -> tuple[float, float, float]:
    """The box that a fluid fills when taps have poured, at most all of its tank [m]."""
    x, y, level = box
    poured = sum(each.poured(plan.simulation.duration) for each in plan.openings if each.fluid == item.name)
    vessel = vessel_of(plan, item)
    rim = vessel.size[2] if poured and vessel is not None and vessel.size else math.inf
    return x, y, min(level + poured / (x * y), rim)


def _spacing(plan: Plan, item: PlanObject, volume: Sequence[float]) -> float:
    """As `spacing_of`, but where it is left open no wider than a quarter of the narrowest mouth [m]."""
    found = spacing_of(plan, item, volume)
    mouths = [each.narrowest / ACROSS for each in plan.openings if each.fluid == item.name and not each.drop_speed]
    if item.registration.spacing or plan.simulation.spacing or not mouths:
        return found
    return float(f"{min(found, *mouths):.2g}")


def _sound(poured: PlanObject) -> float:
    """Numerical speed of sound of what is poured [m/s].

    A block that lands flat stops at once; what it is compressed by is its speed over that of sound. The solver's own
    choice, ten times the speed, lets it spring back through the rim.
    """
    top = position(poured)[2] + (poured.size[2] / 2 if poured.size else 0.0)
    return float(f"{_SOUND_OVER_FALL * math.sqrt(2 * GRAVITY * max(top, 0.01)):.2g}")
