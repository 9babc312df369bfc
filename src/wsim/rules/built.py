"""Whether a plan has what the prompt says: each thing as often, where, on what, and going where it is said to.

The rules build what they understand; here the plan is read against that, whatever rule built it. What they lost on the
way is refused, with the words that it was said in.
"""

from __future__ import annotations

from itertools import combinations

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.asked.nodes import speaks_of
from wsim.plan.layout.bodies import around
from wsim.plan.layout.boxes import Box
from wsim.plan.schema import Plan, PlanObject
from wsim.rules.cast import Cast, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.places import SIDES
from wsim.rules.scenes.part import DIRECTIONS
from wsim.rules.tokens import NotUnderstood

Names = dict[int, list[str]]
CLOSE = 0.005  # that a distance may be off by [m]
MIDDLE = 0.5  # of what is no table, over which that is which it carries
LOOKS, STEP = 3.0, 0.02  # for how long, and in which steps, it is looked whether things run into each other [s]
RUBS = 0.4  # friction of what slides, if it has none of its own
_GOES = {"roll", "slide", "push", "throw"}
_OWN = ("vehicle", "robot", "land", "dock", "pontoon", "office")  # families of scenes that have no such places


def check_built(plan: Plan, cast: Cast, names: Names) -> None:
    """Refuse a plan that lacks what the prompt says.

    Args:
        plan: Laid out.
        cast: What the prompt says.
        names: Of each thing's objects, by its identity.

    Raises:
        NotUnderstood: A thing is not as often, or not where, or does not go, as it is said.
        UserError: Two would run into each other, and are not said to.
    """
    if cast.family(*_OWN) or cast.pour is not None or cast.flows:
        return
    for thing in cast.things:
        own = [plan.object(name) for name in names.get(id(thing), [])]
        if len(own) != thing.count:
            raise NotUnderstood([thing.words], f"has built {len(own)} of these, not {thing.count}")
        for lost in (
            *_carried(thing, own, plan, names),
            *_met(thing, own, plan, names),
            *_beside(thing, own, plan, names),
        ):
            raise NotUnderstood(
                [f"{thing.words} {lost}"], "knows these words, but could not build all of them together:"
            )
        if thing.direction is not None and _GOES & {*thing.does} and not all(_heads(thing, one, plan) for one in own):
            raise NotUnderstood([f"{thing.words} to the {thing.direction}"], "cannot let this go there:")
    _check_ways(plan, cast, names)


def _carried(thing: Thing, own: list[PlanObject], plan: Plan, names: Names) -> list[str]:
    """What it is said to be on or in, and is not over."""
    if thing.rod is not None or thing.noun.family == "pendulum" or thing.bridges is not None:
        return []
    carriers = [one for one in (thing.support, thing.path, thing.inside) if one is not None]
    found = []
    for carrier in carriers:
        boxes = [around(plan.object(name)) for name in names.get(id(carrier), [])]
        share = MIDDLE if carrier.noun.family == "solid" else 1.0
        if not all(any(_is_over(around(item), box, share) for box in boxes) for item in own):
            found.append(f"on {carrier.words}")
    return found


def _is_over(box: Box, below: Box, share: float) -> bool:
    """Whether its middle is over a share of what is below, round that's middle."""
    apart = [abs(box.low[k] + box.high[k] - below.low[k] - below.high[k]) / 2 for k in (0, 1)]
    inside = all(apart[k] <= share * (below.high[k] - below.low[k]) / 2 + CLOSE for k in (0, 1))
    return inside and box.low[2] >= below.low[2] - CLOSE


def _met(thing: Thing, own: list[PlanObject], plan: Plan, names: Names) -> list[str]:
    """What it is said to hit or to come down in, and nothing asks for."""
    found = []
    for other in (thing.target, thing.meets, thing.into):
        theirs = {*names.get(id(other), [])} if other is not None else set[str]()
        falls = other is not None and other is thing.target and bool({"topple"} & {*other.does} or other.off)
        asked = any(
            named & theirs and (falls or named & {item.name for item in own})
            for named in (speaks_of(each) for each in plan.objectives)
        )
        several = other is not None and other is thing.target and other.count > 1 and not _is_one(other)
        each = not several or theirs <= {name for one in plan.objectives for name in speaks_of(one)}
        if other is not None and not (asked and each):
            found.append(f"into {other.words}")
    return found


def _is_one(thing: Thing) -> bool:
    """Whether several are spoken of as one, such as a row."""
    groups = {word for words, entry in lexicon().entries.items() if entry.terminal == "GROUP" for word in words}
    return bool(groups & {*thing.words.split()})


def _beside(thing: Thing, own: list[PlanObject], plan: Plan, names: Names) -> list[str]:
    """Beside what it is said to be, and is not, or not so far away."""
    found = []
    for one in thing.beside:
        if one.predicate not in SIDES or not own or not names.get(id(one.ref)):
            continue
        axis, sign = (1, 1.0) if one.predicate == "LEFT-OF" else (1, -1.0) if one.predicate == "RIGHT-OF" else (0, 1.0)
        sign = -1.0 if one.predicate == "BACK-OF" else sign
        others = [around(plan.object(name)) for name in names[id(one.ref)]]
        for item in own if thing.arrangement != "row" else own[:1]:
            gaps = [_gap(around(item), other, axis, sign) for other in others]
            if min(gaps) < -CLOSE or (one.gap is not None and not any(abs(gap - one.gap) <= CLOSE for gap in gaps)):
                found.append(f"beside {one.ref.words}")
    return found


def _gap(box: Box, other: Box, axis: int, sign: float) -> float:
    """How far a box is from another, along an axis, on the side that the sign says [m]; below 0 on the other side."""
    return box.low[axis] - other.high[axis] if sign > 0.0 else other.low[axis] - box.high[axis]


def _heads(thing: Thing, item: PlanObject, plan: Plan) -> bool:
    """Whether it is set going where it is said to, and that is asked of it."""
    assert thing.direction is not None
    ahead = DIRECTIONS[thing.direction]
    starts = sum(a * b for a, b in zip(item.velocity, ahead, strict=True)) > 0.0 or thing.force is not None
    asked = any(each.object == item.name and each.direction == thing.direction for each in plan.objectives)
    return starts and (asked or thing.into is not None)


def _check_ways(plan: Plan, cast: Cast, names: Names) -> None:
    """Refuse what runs into what it is not said to: as it starts, with the time that friction leaves it."""
    of = {name: thing for thing in cast.things for name in names.get(id(thing), [])}
    aims = {name for name, thing in of.items() if thing.target is not None or thing.meets is not None}
    level = [plan.object(name) for name in of if name not in aims]
    level = [item for item in level if item.pose is not None and not item.velocity[2]]
    asked = [speaks_of(each) for each in plan.objectives]
    for a, b in combinations(level, 2):
        still = not any(a.velocity) and not any(b.velocity)
        if still or of[a.name] is of[b.name] or any({a.name, b.name} <= named for named in asked):
            continue
        if _run_into(a, b, plan.simulation.duration):
            raise UserError(
                f"{of[a.name].words!r} and {of[b.name].words!r} would run into each other, which the prompt does not "
                "say; say that they do, or where each goes"
            )


def _run_into(a: PlanObject, b: PlanObject, duration: float) -> bool:
    boxes = around(a), around(b)
    if min(boxes[0].high[2], boxes[1].high[2]) - max(boxes[0].low[2], boxes[1].low[2]) < CLOSE:
        return False  # one over the other
    for number in range(int(min(duration, LOOKS) / STEP) + 1):
        ways = [_gone(item, number * STEP) for item in (a, b)]
        apart = [
            max(boxes[0].low[k] + ways[0][k], boxes[1].low[k] + ways[1][k])
            - min(boxes[0].high[k] + ways[0][k], boxes[1].high[k] + ways[1][k])
            for k in (0, 1)
        ]
        if max(apart) < -CLOSE:
            return True
    return False


def _gone(item: PlanObject, time: float) -> tuple[float, float]:
    """How far it has gone on the level [m], as it rolls on or friction brakes it."""
    speed = (item.velocity[0] ** 2 + item.velocity[1] ** 2) ** 0.5
    if not speed:
        return 0.0, 0.0
    friction = RUBS if item.material is None else item.material.friction
    lasts = time if item.rolling or not friction else min(time, speed / (friction * GRAVITY))
    way = speed * lasts if item.rolling else speed * lasts - friction * GRAVITY * lasts**2 / 2
    return way * item.velocity[0] / speed, way * item.velocity[1] / speed
