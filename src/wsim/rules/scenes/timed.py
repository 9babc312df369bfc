"""What happens by time: what is held and let go, and what is pushed with a force while that lasts."""

from __future__ import annotations

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Joint, Objective, PlanObject, SchedulePlan, Vec3
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.part import Part, stopping_distance, tidy, times

SHARE = 0.9  # of the way that theory gives, that is asked for
PUSH_TIME = 1.0  # [s]
AFTER = 1.0  # that is shown of what has stopped [s]


def hold(cast: Cast, scene: Part) -> None:
    """Hold what is let go after a time by a joint that then opens."""
    for thing in cast.things:
        if thing.delay is None or thing.force is not None:
            continue
        for name in scene.names[id(thing)]:
            held = f"{name}_held"
            scene.joints.append(Joint(name=held, kind="fixed", child=name))
            scene.schedules.append(
                SchedulePlan(name=f"{name}_let_go", of=held, quantity="release", times=(thing.delay,))
            )
        scene.duration = round(scene.duration + thing.delay, 1)
        cast.assume(thing.words, "held by a joint until it is let go", "something has to hold it")


def push(thing: Thing, item: PlanObject, friction: float, ahead: Vec3, cast: Cast, part: Part) -> None:
    """A force for a time, against friction: from rest a = F / m - mu g; then it slides to its stop.

    Args:
        thing: What is pushed.
        item: Its object, which stands on the level.
        friction: Between it and what it stands on.
        ahead: The unit vector of the push.
        cast: What the prompt speaks of.
        part: What it is part of; gets the schedule and what is asked.

    Raises:
        UserError: It would slide for ever, or has no mass.
    """
    assert thing.force is not None
    if not friction or item.mass is None:
        raise UserError(f"{thing.words!r}: without friction it slides for ever; give a friction above 0")
    if thing.direction is None:
        cast.assume(thing.words, "towards +X", "the prompt gives no direction")
    if thing.pushed_for is None:
        cast.assume(thing.words, f"pushed for {PUSH_TIME:g} s", "the prompt does not say for how long")
    start, lasts = thing.delay or 0.0, thing.pushed_for or PUSH_TIME
    keys = ((start, times(ahead, thing.force)), (round(start + lasts, 6), (0.0, 0.0, 0.0)))
    part.schedules.append(
        SchedulePlan(
            name=f"{item.name}_push", of=item.name, quantity="force",
            times=tuple(time for time, _ in keys), values=tuple(value for _, value in keys),
        )
    )  # fmt: skip
    gains = thing.force / item.mass - friction * GRAVITY
    if gains <= 0.0:
        most = friction * item.mass * GRAVITY
        cast.assume(
            thing.words, f"warning: it stays; friction holds up to {most:.1f} N", "mu m g; the prompt says the force"
        )
    speed = max(gains, 0.0) * lasts
    way = speed * lasts / 2 + stopping_distance(speed, friction)
    ask = round(SHARE * way, 3) or 0.05
    sentence = f"{item.name} moves {ask:g} m or more: F t pushes it, mu m g brakes it over {way:.2f} m."
    along = thing.direction or "front"
    part.objectives.append(Objective(kind="moves", object=item.name, value=ask, direction=along, sentence=sentence))
    part.goes[item.name] = [times(ahead, tidy(way))]
    part.duration = max(part.duration, round(start + lasts + speed / (friction * GRAVITY) + AFTER, 1))
