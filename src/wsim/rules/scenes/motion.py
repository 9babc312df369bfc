"""What moves from the start: rolling, sliding, pushed and thrown things, and what they hit."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Relation, Vec3
from wsim.rules.cast import ROUND, Cast, Thing
from wsim.rules.materials import GROUND_LOOK
from wsim.rules.scenes.bounce import restitution, returned
from wsim.rules.scenes.lasting import stops
from wsim.rules.scenes.part import DIRECTIONS, MOST_SPEED, Part, pair_friction, stopping_distance, tall, tidy, times
from wsim.rules.sizes import bodies

HIT_SPEED = 3.0  # [m/s]
ROLL_SPEED, SLIDE_SPEED, PUSH_SPEED = 1.0, 2.0, 1.5  # [m/s]
ROLL_DISTANCE, SLIDE_DISTANCE = 0.6, 0.3  # from what moves to what it hits, at least [m]
APPROACH = 0.6  # that it takes what rolls to get there [s]
STOP_ROOM = 1.3  # times the way that theory gives it to its stop, from what slides to what it stops before
SLIDE_SHARE = 0.6  # of the way to its stop, after which what slides hits
ROLL_WAY = 3.0  # that a ball rolls while one looks [m]
MEET_SPEED, MEET_DISTANCE = 1.0, 0.8  # of two that come at each other [m/s], [m]
THROW_SPEED, THROW_ANGLE, THROW_HEIGHT = 4.0, 45.0, 1.0  # [m/s], [deg], [m]
AIM_DISTANCE = 1.5  # from what is thrown to what it is thrown at [m]
GOES_ON = 0.5  # that what is hit goes on with what hit it, which the cameras show [m]
SHARE = 0.5  # of the way that theory gives, which what moves must make at least
FOOT_DISTANCE = 0.3  # from a ramp's foot to what is hit there [m]
_GROUND = PlanObject.proxy(name="ground", role="terrain", primitive="ground", material=GROUND_LOOK, state="static")


def ground_object() -> PlanObject:
    """The ground itself."""
    return _GROUND.model_copy(deep=True)


def move(thing: Thing, item: PlanObject, cast: Cast, part: Part, below: str | None) -> PlanObject:
    """The object with its start's velocity, its objectives noted."""
    if "throw" in thing.does:
        return _thrown(thing, item, cast, part)
    how = next((how for how in ("roll", "slide", "push") if how in thing.does), None)
    if how is None or item.state != "dynamic":
        if thing.speed is not None:
            raise UserError(f"{thing.words!r} has a speed of {thing.speed:g} m/s, but is not said to move; say how")
        return item
    _check_round(thing)
    carrier = next((o for o in part.objects if o.name == below), _GROUND)
    friction = pair_friction(item, carrier, thing.said("friction", thing.support))
    speed = _speed(thing, item, carrier, how, friction, cast)
    direction = thing.direction or "front"
    if thing.direction is None:
        cast.assume(thing.words, "towards +X", "the prompt gives no direction")
    moving = started(item, times(DIRECTIONS[direction], speed), rolls=how == "roll")
    part.objectives += _way(thing, moving, carrier, how, speed, friction, direction)
    if not friction and how != "roll":
        raise UserError(f"{thing.words!r}: without friction it slides for ever; give a friction above 0")
    stop = speed / (friction * GRAVITY)
    time = max(1.5, ROLL_WAY / speed) if how == "roll" else 1.0 + stop
    part.duration = max(part.duration, round(min(time, 3.0) if how == "roll" else time, 1))
    way = speed * (cast.duration or part.duration) if how == "roll" else stopping_distance(speed, friction)
    part.goes[item.name] = [times(DIRECTIONS[direction], round(way, 3))]
    return moving


def started(item: PlanObject, velocity: Vec3, *, rolls: bool) -> PlanObject:
    """The object with its start's velocity; what rolls has the spin that fits, and lies across its way."""
    if not rolls:
        return item.model_copy(update={"velocity": velocity})
    moving = item.model_copy(update={"velocity": velocity, "rolling": True})
    if item.primitive == "sphere":
        return moving
    rows = [row for row in item.relations if not row.predicate.startswith("LIES-ALONG")]
    return moving.related([*rows, Relation(predicate="LIES-ALONG-Y" if velocity[0] else "LIES-ALONG-X")])


def _check_round(thing: Thing) -> None:
    if "roll" in thing.does and thing.noun.primitive not in ROUND:
        raise UserError(f"{thing.words!r}: the builtin planner rolls balls, barrels and the like")
    if thing.speed is not None and not 0.0 < thing.speed <= MOST_SPEED:
        raise UserError(
            f"{thing.words!r}: {thing.speed:g} m/s is not above 0 and up to {MOST_SPEED:g} m/s, the planner's range"
        )


def _speed(thing: Thing, item: PlanObject, carrier: PlanObject, how: str, friction: float, cast: Cast) -> float:
    if thing.speed is not None:
        return thing.speed
    speed = {"roll": ROLL_SPEED, "slide": SLIDE_SPEED, "push": PUSH_SPEED}[how]
    if how in ("slide", "push") and thing.off and carrier.size:
        way = carrier.size[0] / 2 + item.size[0]  # so that its middle is over the edge with speed to spare
        speed = math.ceil(10 * 1.3 * math.sqrt(2 * friction * GRAVITY * way)) / 10
    cast.assume(thing.words, f"starts at {speed:g} m/s", "the prompt gives no speed")
    return speed


def _way(
    thing: Thing, item: PlanObject, carrier: PlanObject, how: str, speed: float, friction: float, direction: str
) -> list[Objective]:
    name = item.name
    if thing.off:
        return [Objective(kind="topples", object=name, sentence=f"{name} leaves {carrier.name} and falls.")]
    if how == "roll":
        return []
    way = round(SHARE * stopping_distance(speed, friction), 3)
    if how == "slide" and not thing.round:
        return [Objective(kind="slides", object=name, value=way, sentence=f"{name} slides {way:g} m or more.")]
    sentence = f"{name} moves {way:g} m or more."
    return [Objective(kind="moves", object=name, value=way, direction=direction, sentence=sentence)]


def hit(thing: Thing, cast: Cast, taken: set[str], part: Part) -> None:
    """Add what goes along +X, on the ground or through the air, into its target."""
    target = thing.target
    if target is None or id(target) not in part.names or target.does == ["roll"]:
        raise UserError(f"{thing.words!r}: the builtin planner rolls a ball into things that stand still")
    if any(other.target is target and other is not thing for other in cast.things):
        raise UserError(f"{thing.words!r}: the builtin planner rolls one ball into one thing")
    if target.support is not None or target.inside is not None or thing.support is not None or thing.direction:
        raise UserError(f"{thing.words!r}: the builtin planner lets things on the ground be hit, from behind")
    first, *rest = part.names[id(target)]
    _check_round(thing)
    [item] = bodies(thing, cast, taken)
    slides = "slide" in thing.does or "push" in thing.does
    distance = SLIDE_DISTANCE if slides else ROLL_DISTANCE
    base = Relation(predicate="PLACE-ON-BASE")
    aimed = first
    if "throw" in thing.does:
        distance, aimed = AIM_DISTANCE, [first, *rest][-1] if target.arrangement == "stack" else first
        item, base = _aimed(thing, item, aimed, cast, part)
    else:
        speed = thing.speed or HIT_SPEED
        if thing.speed is None:
            cast.assume(thing.words, f"starts at {speed:g} m/s along +X", "the prompt gives no speed")
        friction = pair_friction(item, _GROUND, thing.said("friction", None))
        if "stop" in thing.does and not friction:
            raise UserError(f"{thing.words!r}: without friction it never stops; give a friction above 0")
        distance = _run_up(slides, speed, friction)
        if "stop" in thing.does:
            distance = round(STOP_ROOM * stopping_distance(speed, friction), 2)
            part.duration = max(part.duration, round(1.0 + speed / (friction * GRAVITY), 1))
        item = started(item, (speed, 0.0, 0.0), rolls=not slides)
    cast.assume(thing.words, f"starts {distance:g} m from {target.words}", "the prompt gives no distance")
    rows = [base, Relation(predicate="BACK-OF", ref=first, gap=distance)]
    part.objects.append(item.related(rows + item.relations))
    part.names[id(thing)] = [item.name]
    part.duration = max(part.duration, 4.0 if target.group else 2.0)
    if "stop" in thing.does:
        part.goes[item.name] = [(round(distance / STOP_ROOM, 3), 0.0, 0.0)]
        part.objectives.append(stops(item.name, first))
        return
    if "throw" not in thing.does:
        aimed = _met(item, [first, *rest], target, part)
        friction, last = pair_friction(item, _GROUND, thing.said("friction", None)), _item([first, *rest][-1], part)
        if last.state == "dynamic":
            stop = stopping_distance(item.velocity[0], friction)
            part.goes[last.name] = [(round(tall(last) + min(GOES_ON, stop), 3), 0.0, 0.0)]
        else:
            said = thing.said("restitution", target)
            bounce = restitution(item, _item(first, part)) if said is None else said
            back = _thrown_back(item, bounce, friction, distance, cast.duration or part.duration)
            part.goes[item.name] = [(-round(max(back - distance, 0.0), 3), 0.0, 0.0)]
    if "bounce" in thing.does:
        returned(thing, item, _item(aimed, part), target, cast)
    if "topple" not in target.does:  # which says more than that it is hit
        _collision(item.name, aimed, part)


def _run_up(slides: bool, speed: float, friction: float) -> float:
    """From what rolls or slides to what it hits [m]."""
    if slides:
        return max(SLIDE_DISTANCE, round(min(APPROACH * speed, SLIDE_SHARE * stopping_distance(speed, friction)), 2))
    return max(ROLL_DISTANCE, round(APPROACH * speed, 2))


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
    if "topple" not in target.does:
        item = next(item for item in ramps.posed if item.name == part.names[id(thing)][0])
        _collision(item.name, _met(item, part.names[id(target)], target, part), part)


def _met(item: PlanObject, names: list[str], target: Thing, part: Part) -> str:
    """Which of a target's objects something on the ground meets: the first of a row, of a stack that at its middle."""
    if target.arrangement != "stack":
        return names[0]
    middle = item.size[0] if item.primitive == "sphere" else tall(item) / 2
    return names[min(int(middle / tall(_item(names[0], part))), len(names) - 1)]


def _item(name: str, part: Part) -> PlanObject:
    return next(item for item in part.objects if item.name == name)


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
    _collision(pair[0].name, pair[1].name, part)


def _thrown(thing: Thing, item: PlanObject, cast: Cast, part: Part) -> PlanObject:
    """A throw at an angle; its range from theory."""
    _check_round(thing)
    angle = THROW_ANGLE if thing.angle is None else thing.angle
    if not -45.0 <= angle <= 85.0:
        raise UserError(f"{thing.words!r}: {angle:g} degrees is outside -45 to 85, the planner's range of throws")
    speed = THROW_SPEED if thing.speed is None else thing.speed
    for given, text, what in (
        (thing.speed, f"thrown at {speed:g} m/s", "speed"),
        (thing.angle, f"thrown at {angle:g} degrees above the level", "angle"),
        (thing.direction, "towards +X", "direction"),
    ):
        if given is None:
            cast.assume(thing.words, text, f"the prompt gives no {what}")
    along, up = speed * math.cos(math.radians(angle)), speed * math.sin(math.radians(angle))
    height = thing.drop_height or 0.0
    if thing.support is not None:
        height += _top(part.names[id(thing.support)][-1], part)
    time = (up + math.sqrt(up**2 + 2 * GRAVITY * height)) / GRAVITY
    way = round(0.9 * along * time, 3)
    direction = thing.direction or "front"
    x, y, _ = times(DIRECTIONS[direction], along)
    cast.assume(thing.words, f"lands {along * time:.2f} m away after {time:.2f} s", "a parabola, without air")
    name = item.name
    part.objectives += [
        Objective(kind="flies", object=name, sentence=f"{name} flies on a parabola."),
        Objective(
            kind="moves", object=name, value=way, direction=direction, sentence=f"{name} gets {way:g} m or more."
        ),
    ]
    part.duration = max(part.duration, round(time + 1.0, 1))
    # Where it lands it goes on: a ball rolls on at 5/7 of its level speed, a box slides to its stop.
    rest = max(0.0, (cast.duration or part.duration) - time)
    after = (
        5 / 7 * along * rest
        if thing.round
        else stopping_distance(along, pair_friction(item, _GROUND, thing.said("friction", None)))
    )
    level = times(DIRECTIONS[direction], 1.0)
    part.goes[name] = [*_arc(level, along, up, time), times(level, round(along * time + after, 3))]
    return item.model_copy(update={"velocity": (tidy(x), tidy(y), tidy(up))})


def _arc(level: Vec3, along: float, up: float, time: float) -> list[Vec3]:
    """From the start of a throw to its highest point, and to where it lands after a time [m]."""
    top = max(0.0, min(up / GRAVITY, time))
    return [
        (tidy(level[0] * along * t), tidy(level[1] * along * t), tidy(up * t - GRAVITY * t**2 / 2)) for t in (top, time)
    ]


def throw_height(thing: Thing, cast: Cast) -> float:
    """How high a throw starts, of its lowest point [m]."""
    if thing.drop_height is None:
        thing.drop_height = THROW_HEIGHT
        cast.assume_height(thing.words, "thrown from {} up", THROW_HEIGHT)
    return thing.drop_height


def _aimed(thing: Thing, item: PlanObject, aimed: str, cast: Cast, part: Part) -> tuple[PlanObject, Relation]:
    """A throw that hits the middle of an object: the level way gives the time, and that the upward speed."""
    if thing.angle is not None:
        raise UserError(f"{thing.words!r}: thrown at something, it takes the angle that hits; leave the angle out")
    speed = THROW_SPEED if thing.speed is None else thing.speed
    height = 0.5 if thing.drop_height is None else thing.drop_height
    if thing.drop_height is None:
        cast.assume_height(thing.words, "thrown from {} up", height)
    middle = _middle(aimed, part)
    radius = item.size[0] if item.primitive != "box" else item.size[2] / 2
    time = AIM_DISTANCE / speed
    up = (middle - height - radius) / time + GRAVITY * time / 2
    velocity: Vec3 = (speed, 0.0, tidy(up))
    cast.assume(thing.words, f"at {speed:g} m/s level and {up:.2f} m/s up", "so that it hits the middle of its target")
    moving = item.model_copy(update={"velocity": velocity})
    part.goes[item.name] = _arc((1.0, 0.0, 0.0), speed, up, time)
    return moving, Relation(predicate="SPAWNED-ABOVE", value=height)


def _middle(name: str, part: Part) -> float:
    """Height of the centre of something that stands on the ground, or on others that do [m]."""
    return _top(name, part) - tall(_item(name, part)) / 2


def _top(name: str, part: Part) -> float:
    """Height of the top of something that stands on the ground, or on others that do [m]."""
    items = {item.name: item for item in part.objects}
    height, at = 0.0, items.get(name)
    while at is not None:
        height += tall(at)
        row = at.relation("PLACE-ON")
        at = items.get(row.ref or "") if row is not None else None
    return height
