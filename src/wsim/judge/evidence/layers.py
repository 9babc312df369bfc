"""Liquids on top of each other in a container, and what bodies displace of each: Archimedes in layers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.evidence.containment import alike

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Fluid


def layers(evidence: Evidence, fluid: Fluid) -> list[Fluid]:
    """The liquids in a fluid's container, from below, as they lie over the final window; one fluid of each."""
    container, found = evidence.container_of(fluid), [fluid]
    for each in evidence.world.fluids:
        if evidence.container_of(each) is container and not any(alike(each, other) for other in found):
            found.append(each)
    return sorted(found, key=lambda each: evidence.level(each).height)


def mass_displaced(
    evidence: Evidence, fluid: Fluid, volume_below: Callable[[float], float], higher: float = 0.0
) -> float:
    """The mass of all fluids in a fluid's container that something displaces [kg].

    Args:
        evidence: What happened.
        fluid: One of them.
        volume_below: How much of it is below a height [m^3].
        higher: How far up all surfaces are shifted [m].
    """
    total = 0.0
    for each in layers(evidence, fluid):
        level = evidence.level(each)
        under = volume_below(level.bottom + higher) if level.bottom > level.floor else 0.0
        total += each.density * (volume_below(level.height + higher) - under)
    return total


def needed_of(evidence: Evidence, fluid: Fluid, mass: float, volume: float) -> float:
    """How much of a fluid something must displace to float at its surface, covered by what lies on that [m^3].

    Args:
        evidence: What happened.
        fluid: The one that it floats in.
        mass: Of the body [kg].
        volume: Of the body [m^3]; what needs more than that sinks.
    """
    stack = layers(evidence, fluid)
    over = stack[stack.index(fluid) + 1 :]
    if not over or mass >= fluid.density * volume or over[0].density >= fluid.density:
        return mass / fluid.density
    return max(mass - over[0].density * volume, 0.0) / (fluid.density - over[0].density)
