"""What goes along +X into things, or at each other, on the ground or a table; what stands before a ramp's foot."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Relation
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.bounce import restitution, returned
from wsim.rules.scenes.knock import HIGH, deep, enough, shoving_speed, tipping_speed
from wsim.rules.scenes.lasting import stops
from wsim.rules.scenes.motion import (
    SLIDE_SPEED,
    THROW_SPEED,
    aimed_at,
    check_round,
    falls_off,
    ground_object,
    item_of,
    started,
)
from wsim.rules.scenes.part import Part, pair_friction, stopping_distance, tall
from wsim.rules.sizes import bodies

HIT_SPEED = 3.0  # [m/s]
ROLL_DISTANCE, SLIDE_DISTANCE = 0.6, 0.3  # from what moves to what it hits, at least [m]
TABLE_DISTANCE = 0.1  # the same on a table
TABLE_SPEED, QUICK = 2.0, 60.0  # on one [m/s], and pictures a second, so that a short way to a blow is seen [1/s]
APPROACH = 0.6  # that it takes what rolls to get there [s]
STOP_ROOM = 1.3  # times the way that theory gives it to its stop, from what slides to what it stops before
SLIDE_SHARE = 0.6  # of the way to its stop, after which what slides hits
MEET_SPEED, MEET_DISTANCE = 1.0, 0.8  # of two that come at each other [m/s], [m]
ROW_PACE = 0.5  # of sqrt(g h): what rolls into a row is slower than that falls, or it pushes them into one another
AIM_DISTANCE = 1.5  # from what is thrown to what it is thrown at [m]
GOES_ON = 0.5  # that what is hit goes on with what hit it, which the cameras show [m]
FOOT_DISTANCE = 0.3  # from a ramp's foot to what is hit there [m]
SPARE = 1.5  # times the speed with which what is knocked off a table just gets to its edge


def hit(thing: Thing, cast: Cast, taken: set[str], part: Part) -> None:
    """Add what goes along +X, on the ground, on a table or through the air, into its target."""
    target = thing.target
    if target is None or id(target) not in part.names or target.does == ["roll"]:
        raise UserError(f"{thing.words!r}: the builtin planner rolls a ball into things that stand still")
    if any(other.target is target and other is not thing for other in cast.things):
        raise UserError(f"{thing.words!r}: the builtin planner rolls one ball into one thing")
    flies = "throw" in thing.does
    if target.inside is not None or thing.direction or (thing.support is not target.support and not flies):
        raise UserError(
            f"{thing.words!r}: the builtin planner lets things that stand on one surface be hit, from behind"
        )
    check_round(thing)
    [item] = bodies(thing, cast, taken)
    part.duration = max(part.duration, 4.0 if target.group else 2.0)
    if flies:
        _fly(thing, target, item, cast, part)
    elif thing.support is not None:
        _on_table(thing, target, item, cast, part)
    else:
        _on_ground(thing, target, item, cast, part)


def _fly(thing: Thing, target: Thing, item: PlanObject, cast: Cast, part: Part) -> None:
    names = part.names[id(target)]
    name = names[-1] if target.arrangement == "stack" else names[0]
    share = HIGH if "topple" in target.does and target.arrangement != "stack" else 0.5
    speed = enough(thing, THROW_SPEED, _to_fall(target, item, name, share, part), cast)
    item, base = aimed_at(thing, item, name, speed, share, cast, part)
    _add(thing, target, item, [base], AIM_DISTANCE, cast, part)
    _ask(thing, target, item, name, cast, part)


def _on_ground(thing: Thing, target: Thing, item: PlanObject, cast: Cast, part: Part) -> None:
    first = part.names[id(target)][0]
    slides = _slides(thing)
    met = _met(item, part.names[id(target)], target, part)
    usual = HIT_SPEED
    if "topple" in target.does and target.arrangement == "row":
        usual = round(ROW_PACE * math.sqrt(GRAVITY * tall(item_of(first, part))), 1)
    speed = enough(thing, usual, _to_fall(target, item, met, _half_height(item) / tall(item_of(met, part)), part), cast)
    if thing.speed is None:
        cast.assume(thing.words, f"starts at {speed:g} m/s along +X", "the prompt gives no speed")
    friction = pair_friction(item, ground_object(cast.ground), thing.said("friction", None))
    if "stop" in thing.does and not friction:
        raise UserError(f"{thing.words!r}: without friction it never stops; give a friction above 0")
    distance = _run_up(slides, speed, friction)
    if "stop" in thing.does:
        distance = round(STOP_ROOM * stopping_distance(speed, friction), 2)
        part.duration = max(part.duration, round(1.0 + speed / (friction * GRAVITY), 1))
    item = started(item, (speed, 0.0, 0.0), rolls=not slides)
    _add(thing, target, item, [Relation(predicate="PLACE-ON-BASE")], distance, cast, part)
    if "stop" in thing.does:
        part.goes[item.name] = [(round(distance / STOP_ROOM, 3), 0.0, 0.0)]
        part.objectives.append(stops(item.name, first))
        return
    _go_on(thing, target, item, friction, distance, cast, part)
    _ask(thing, target, item, met, cast, part)


def _to_fall(target: Thing, item: PlanObject, name: str, share: float, part: Part) -> float:
    """The speed that something needs to knock its target over [m/s]; 0 where that is not asked.

    Args:
        target: What it hits.
        item: What hits.
        name: The one of the target's objects that it meets.
        share: Of that one's height, at which it does.
        part: The scene.
    """
    met, names = item_of(name, part), part.names[id(target)]
    if "topple" not in target.does or met.primitive not in ("box", "cylinder"):
        return 0.0
    if target.arrangement == "stack":
        return shoving_speed(item, met, len(names) - 1 - names.index(name), restitution(item, met))
    return tipping_speed(item, met, min(share, 1.0) * tall(met), restitution(item, met))


def _half_height(item: PlanObject) -> float:
    """Of what rolls or slides, from the ground to its middle [m]."""
    return item.size[2] / 2 if item.primitive == "box" else item.size[0]


def _on_table(thing: Thing, target: Thing, item: PlanObject, cast: Cast, part: Part) -> None:
    """Along what carries both; hard enough for the target to slide off it, where it is to."""
    assert thing.support is not None
    carrier = item_of(part.names[id(thing.support)][-1], part)
    met = item_of(part.names[id(target)][0], part)
    distance = round(min(SLIDE_DISTANCE, carrier.size[0] - deep(item) - deep(met) - TABLE_DISTANCE), 3)
    if distance < TABLE_DISTANCE / 2:
        raise UserError(f"{carrier.name} is {carrier.size[0]:g} m deep, too small for {thing.words!r} to go along it")
    friction = pair_friction(met, carrier)
    needed = SPARE * math.sqrt(2 * friction * GRAVITY * deep(met) / 2) if target.off else 0.0
    masses = item.mass or 1.0, met.mass or 1.0
    speed = thing.speed or max(TABLE_SPEED, math.ceil(10 * needed * sum(masses) / masses[0]) / 10)
    if _slides(thing) and thing.speed is None:
        own = pair_friction(item, carrier)
        speed = math.ceil(10 * math.sqrt(speed**2 + 2 * own * GRAVITY * distance)) / 10
    if thing.speed is None:
        cast.assume(thing.words, f"starts at {speed:g} m/s along +X", "the prompt gives no speed")
    item = started(item, (speed, 0.0, 0.0), rolls=not _slides(thing))
    _add(thing, target, item, [Relation(predicate="PLACE-ON", ref=carrier.name)], distance, cast, part)
    part.goes[met.name] = [(GOES_ON, 0.0, -tall(carrier) if target.off else 0.0)]
    part.duration, part.frame_rate = max(part.duration, 2.0), max(part.frame_rate, QUICK)
    if target.off:
        index = part.objects.index(met)
        part.objects[index] = met.related([*met.relations, Relation(predicate="ALIGN-FRONT", ref=carrier.name)])
        part.objectives.append(falls_off(met, carrier))
    _ask(thing, target, item, _met(item, part.names[id(target)], target, part), cast, part)


def _slides(thing: Thing) -> bool:
    return "slide" in thing.does or "push" in thing.does


def _add(
    thing: Thing, target: Thing, item: PlanObject, rows: list[Relation], distance: float, cast: Cast, part: Part
) -> None:
    """The mover, so far behind its target."""
    cast.assume(thing.words, f"starts {distance:g} m from {target.words}", "the prompt gives no distance")
    behind = Relation(predicate="BACK-OF", ref=part.names[id(target)][0], gap=distance)
    part.objects.append(item.related([*rows, behind, *item.relations]))
    part.names[id(thing)] = [item.name]


def _go_on(
    thing: Thing, target: Thing, item: PlanObject, friction: float, distance: float, cast: Cast, part: Part
) -> None:
    """Where both come after the blow, which the cameras are to show."""
    first, last = (item_of(part.names[id(target)][k], part) for k in (0, -1))
    if last.state == "dynamic":
        stop = stopping_distance(item.velocity[0], friction)
        part.goes[last.name] = [(round(tall(last) + min(GOES_ON, stop), 3), 0.0, 0.0)]
        return
    said = thing.said("restitution", target)
    bounce = restitution(item, first) if said is None else said
    back = _thrown_back(item, bounce, friction, distance, cast.duration or part.duration)
    part.goes[item.name] = [(-round(max(back - distance, 0.0), 3), 0.0, 0.0)]


def _ask(thing: Thing, target: Thing, item: PlanObject, met: str, cast: Cast, part: Part) -> None:
    if "bounce" in thing.does:
        returned(thing, item, item_of(met, part), target, cast)
    if "topple" not in target.does:  # which says more than that it is hit
        _collision(item.name, met, part)
    if "still" in thing.does:
        part.objectives.append(_comes_to_rest(item.name))


def _comes_to_rest(name: str) -> Objective:
    return Objective(kind="settles", object=name, sentence=f"{name} comes to rest.")


def _run_up(slides: bool, speed: float, friction: float) -> float:
    """From what rolls or slides to what it hits [m]."""
    if slides:
        return max(SLIDE_DISTANCE, round(min(APPROACH * speed, SLIDE_SHARE * stopping_distance(speed, friction)), 2))
    return max(ROLL_DISTANCE, round(APPROACH * speed, 2))


def _part_again(pair: list[PlanObject], distance: float, speed: float, rolls: bool, cast: Cast, part: Part) -> None:
    """Where two that met come to, which the cameras are to show: apart again, by their restitution."""
    back = restitution(*pair) * speed
    left = (cast.duration or part.duration) - distance / (2 * speed)
    friction = pair_friction(pair[0], ground_object(cast.ground))
    way = back * left if rolls else min(stopping_distance(back, friction), back * left)
    if way > distance / 2:
        for item, sign in zip(pair, (-1.0, 1.0), strict=True):
            part.goes[item.name] = [(sign * round(way - distance / 2, 3), 0.0, 0.0)]


def _thrown_back(item: PlanObject, bounce: float, friction: float, distance: float, duration: float) -> float:
    """How far something comes back from what stands, by which it was stopped after a way [m].

    What slides is at v^2 - 2 mu g s there, and goes back until it stops. What rolls keeps its spin in the blow: by
    friction it comes to (e - k) / (1 + k) v, k = I / (m R^2), and (dv)^2 / (2 mu g) farther on the way to that.
    """
    speed = item.velocity[0]
    left = max(duration - distance / speed, 0.0)
    if not item.rolling:
        off = bounce * math.sqrt(max(speed**2 - 2 * friction * GRAVITY * distance, 0.0))
        return min(stopping_distance(off, friction), off * left)
    k = 0.4 if item.primitive == "sphere" else 0.5
    rolls = (bounce - k) / (1 + k) * speed
    slips = stopping_distance(bounce * speed - rolls, friction)
    return min(max(rolls, 0.0) * left + slips, bounce * speed * left)


def struck(thing: Thing, part: Part, ramps: Part) -> None:
    """Stand a target before the foot of the ramp that something comes down."""
    target = thing.target
    assert target is not None and thing.path is not None
    first = part.names[id(target)][0]
    ramp = part.names[id(thing.path)][0]
    for index, item in enumerate(part.objects):
        if item.name == first:
            rows = [row for row in item.relations if row.predicate not in ("LEFT-OF", "FRONT-OF")]
            part.objects[index] = item.related([*rows, Relation(predicate="FRONT-OF", ref=ramp, gap=FOOT_DISTANCE)])
    if "stop" in thing.does:
        _stop_short(thing, part, ramps)
        return
    part.frame_rate = max(part.frame_rate, QUICK)  # what comes spinning leaves a blow for a few hundredths of a second
    item = next(item for item in ramps.posed if item.name == part.names[id(thing)][0])
    if "topple" not in target.does:
        _collision(item.name, _met(item, part.names[id(target)], target, part), part)
    if "still" in thing.does:
        part.objectives.append(_comes_to_rest(item.name))


def _stop_short(thing: Thing, part: Part, ramps: Part) -> None:
    """Stand what something stops before so far from the ramp's foot that friction stops it on its way."""
    assert thing.target is not None and thing.path is not None
    item = next(item for item in ramps.posed if item.name == part.names[id(thing)][0])
    slab = next(item for item in ramps.objects if item.name == part.names[id(thing.path)][0])
    assert slab.pose is not None
    turn, friction = (
        math.radians(slab.pose.rotation_deg[1]),
        pair_friction(item, slab, thing.said("friction", thing.path)),
    )
    level = pair_friction(item, ground_object(), thing.said("friction", None))
    pull = GRAVITY * (math.sin(turn) - friction * math.cos(turn))
    speed = math.sqrt(math.hypot(*item.velocity) ** 2 + 2 * max(pull, 0.0) * slab.size[0])
    if not level:
        raise UserError(f"{thing.words!r}: without friction it never stops; give a friction above 0")
    gap = round(STOP_ROOM * stopping_distance(speed, level) + deep(item), 2)
    first = part.names[id(thing.target)][0]
    for index, one in enumerate(part.objects):
        if one.name == first:
            rows = [row.model_copy(update={"gap": gap}) if row.ref == slab.name else row for row in one.relations]
            part.objects[index] = one.related(rows)
    part.duration = max(part.duration, ramps.duration, round(3.0 + speed / (level * GRAVITY), 1))
    part.objectives.append(stops(item.name, first))


def _met(item: PlanObject, names: list[str], target: Thing, part: Part) -> str:
    """Which of a target's objects something on the ground meets: the first of a row, of a stack that at its middle."""
    if target.arrangement != "stack":
        return names[0]
    return names[min(int(_half_height(item) / tall(item_of(names[0], part))), len(names) - 1)]


def _collision(name: str, ref: str, part: Part) -> None:
    part.objectives.append(
        Objective(kind="collides_with", object=name, ref=ref, sentence=f"{name} collides with {ref}.")
    )


def meet(thing: Thing, cast: Cast, taken: set[str], part: Part) -> None:
    """Add two things that come at each other along X; the second of a pair comes with the first."""
    if id(thing) in part.names:
        return
    if thing.support is not None or thing.beside or (thing.meets is not None and thing.meets.support is not None):
        raise UserError(f"{thing.words!r}: the builtin planner lets things collide on the ground")
    pair = bodies(thing, cast, taken)
    part.names[id(thing)] = [item.name for item in pair]
    if thing.meets is not None:
        pair += bodies(thing.meets, cast, taken)
        part.names[id(thing.meets)] = [pair[1].name]
    rolls = thing.round, (thing.meets or thing).round
    speed = thing.speed or (MEET_SPEED if all(rolls) else SLIDE_SPEED)
    distance = MEET_DISTANCE if all(rolls) else SLIDE_DISTANCE
    if thing.speed is None:
        cast.assume(thing.words, f"{speed:g} m/s towards each other", "the prompt gives no speed")
    cast.assume(thing.words, f"start {distance:g} m apart, along X", "the prompt gives no distance")
    ground = Relation(predicate="PLACE-ON-BASE")
    apart = Relation(predicate="FRONT-OF", ref=pair[0].name, gap=distance)
    for item, sign, rows, round_ in zip(pair, (1.0, -1.0), ([ground], [ground, apart]), rolls, strict=True):
        moving = started(item, (sign * speed, 0.0, 0.0), rolls=round_)
        part.objects.append(moving.related(rows + item.relations))
    part.duration = max(2.0, round(distance / speed + 1.0, 1)) if part.duration <= 3.0 else part.duration
    _part_again(pair, distance, speed, all(rolls), cast, part)
    _collision(pair[0].name, pair[1].name, part)
