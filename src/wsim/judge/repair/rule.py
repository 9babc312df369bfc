"""What the rules of repair share: the targets that several of them suggest, and the numbers that these come from."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Fluid, Shape

ROOM = 0.1  # of a limit that a suggested value keeps from it: what just meets it fails by rounding
# What a number may be: rubber on rubber has a friction of 1.2, osmium 22 600 kg/m^3.
BOUNDS = {"friction": (0.0, 1.5), "restitution": (0.0, 1.0), "rolling_friction": (0.0, 1.0), "density": (1.0, 22_600.0)}
SAME = 1e-3  # of a number: what is nearer is the same
FARTHEST = {"duration": 5.0, "time_step": 50.0, "spacing": 10.0}  # times what it is: beyond, something else is wrong


def shorter_step(evidence: Evidence, share: float, why: str) -> RepairTarget:
    """A time step of a share of the one that was taken [s]."""
    step = time_step(evidence)
    suggested = step * share if step else None
    return RepairTarget(
        kind="time step", parameter="time_step", direction="lower", current=step, suggested=suggested, unit="s", why=why
    )


def unstable(evidence: Evidence) -> RepairTarget:
    """What grows without bound."""
    why = "values grow without bound where the step is longer than the solver is stable for; half is the first to try"
    return shorter_step(evidence, 0.5, why)


def longer_run(evidence: Evidence, seconds: float | None, why: str) -> RepairTarget:
    """A run that lasts so long [s]; twice as long where nothing says how long."""
    now = evidence.world.duration
    if seconds is None:
        seconds, why = 2.0 * now, f"{why}; twice as long is the first to try"
    # A run ends at its last whole frame.
    rate = evidence.world.frame_rate
    seconds = math.ceil(seconds * rate - 1e-6) / rate
    return RepairTarget(
        kind="settlement", parameter="duration", direction="raise", current=now, suggested=seconds, unit="s", why=why
    )


def tried(target: RepairTarget) -> RepairTarget:
    """A target whose number can be one: on the side that it is to be on, and such as there is.

    What a rule's formula gives beyond that it does not know; the number is left out, and the direction stays.
    """
    now, to = target.current, target.suggested
    if target.parameter == "time_step" and to is None and now:
        return target.model_copy(update={"suggested": now / 2})
    if to is None:
        return target
    low, high = BOUNDS.get(target.parameter, (-math.inf, math.inf))
    wrong = not low <= to <= high
    if now is not None:
        same = SAME * abs(now)
        wrong |= target.direction == "lower" and to > now - same
        wrong |= target.direction == "raise" and to < now + same
        wrong |= (
            target.parameter in FARTHEST
            and not now / FARTHEST[target.parameter] <= to <= now * FARTHEST[target.parameter]
        )
    return target.model_copy(update={"suggested": None}) if wrong else target


def time_step(evidence: Evidence) -> float | None:
    """The step that was taken, where the recording or the stage tells it [s]."""
    step = evidence.recording.metadata.get("time_step") or evidence.world.time_step
    return float(step) if step else None


def density(evidence: Evidence, prim: str) -> float:
    """A body's mean density [kg/m^3]; MissingError."""
    i = evidence.index(prim)
    return evidence.world.bodies[i].mass / evidence.solid(i).volume


def planned_density(evidence: Evidence, prim: str) -> float | None:
    """The density that the plan has for a prim [kg/m^3]."""
    item = evidence.planned(prim)
    return item.density if item is not None else None


def collides(evidence: Evidence, prim: str) -> bool:
    """Whether a prim is there and has a shape that others can touch."""
    return any(shape.collides for shape in shapes_of(evidence, prim))


def shapes_of(evidence: Evidence, prim: str) -> list[Shape]:
    """The shapes of a body or a static object; none of what is not there."""
    found = [shape for body in evidence.world.bodies if body.prim == prim for shape in body.shapes]
    return found + [shape for static in evidence.world.statics if static.prim == prim for shape in static.shapes]


def add_collision(prim: str) -> RepairTarget:
    """A collision shape for what has none."""
    why = "none of its shapes collides, so that nothing can stand on it or stop at it"
    return RepairTarget(kind="geometry", prim=prim, parameter="collision", direction="add", why=why)


def faster_sound(evidence: Evidence, fluid: Fluid, wanted: float, why: str) -> RepairTarget:
    """A stiffer fluid [m/s]."""
    return RepairTarget(
        kind="fluid", prim=fluid.prim, parameter="speed_of_sound", direction="raise",
        current=sound_speed(evidence, fluid), suggested=wanted, unit="m/s", why=why,
    )  # fmt: skip


def sound_speed(evidence: Evidence, fluid: Fluid) -> float | None:
    """A fluid's speed of sound as it was simulated [m/s]."""
    sound = evidence.sound(fluid)
    return float(sound) if sound else None


def finer(evidence: Evidence, fluid: Fluid, share: float, why: str) -> RepairTarget:
    """A share of the particle spacing [m]."""
    return RepairTarget(
        kind="resolution", prim=fluid.prim, parameter="spacing", direction="lower", current=fluid.spacing,
        suggested=fluid.spacing * share, unit="m", why=why,
    )  # fmt: skip
