"""What moves from the start: rolling, sliding, pushed and thrown things, and what they hit."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY, WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Relation, Vec3
from wsim.plan.schema.formula import Eventually
from wsim.plan.schema.formula_motion import Drops
from wsim.plan.schema.formula_place import SpeedBetween
from wsim.rules.cast import ROUND, Cast, Thing
from wsim.rules.materials import GROUND_LOOK, material_named
from wsim.rules.scenes.catch import catcher, deaden, lands, reach
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.over import clearing, stand_below
from wsim.rules.scenes.part import (
    DIRECTIONS,
    MOST_SPEED,
    Part,
    fall_time,
    pair_friction,
    stopping_distance,
    tall,
    tidy,
    times,
)
from wsim.rules.scenes.timed import push

ROLL_SPEED, SLIDE_SPEED, PUSH_SPEED = 1.0, 2.0, 1.5  # [m/s]
STOP_WAY = 1.5  # after which a ball that is to stop has stopped [m]
ROLL_WAY = 3.0  # that a ball rolls while one looks [m]
THROW_SPEED, THROW_ANGLE, THROW_HEIGHT = 4.0, 45.0, 1.0  # [m/s], [deg], [m]
AIM_DISTANCE = 1.5  # from what is thrown to what it is thrown at [m]
LASTS = 0.1  # by which the time that a speed lasts for may be off that which is said
_AXES = {"front": "+X", "back": "-X", "left": "+Y", "right": "-Y"}
SHARE = 0.5  # of the way that theory gives, which what moves must make at least
_GROUND = PlanObject.proxy(name="ground", role="terrain", primitive="ground", material=GROUND_LOOK, state="static")


def ground_object(material: str | None = None) -> PlanObject:
    """The ground itself, which may be of a material."""
    made = _GROUND.model_copy(deep=True)
    return made if material is None else made.model_copy(update={"material": material_named(material)})


def move(thing: Thing, item: PlanObject, cast: Cast, part: Part, below: str | None) -> PlanObject:
    """The object with its start's velocity, its objectives noted."""
    if "throw" in thing.does:
        return _thrown(thing, item, cast, part)
    how = next((how for how in ("roll", "slide", "push") if how in thing.does), None)
    if how is None or item.state != "dynamic":
        if thing.speed is not None:
            raise UserError(f"{thing.words!r} has a speed of {thing.speed:g} m/s, but is not said to move; say how")
        return item
    check_round(thing)
    carrier = next((o for o in part.objects if o.name == below), ground_object(cast.ground))
    friction = pair_friction(item, carrier, thing.said("friction", thing.support))
    direction = free_way(thing, cast)
    if thing.force is not None:
        push(thing, item, friction, DIRECTIONS[direction], cast, part)
        return item
    if thing.into is not None:
        return _into(thing, item, carrier, how, friction, direction, cast, part)
    speed = _speed(thing, item, carrier, how, friction, cast)
    if thing.direction is None:
        cast.assume(thing.words, f"towards {_AXES[direction]}", "the prompt gives no direction")
    moving = started(item, times(DIRECTIONS[direction], speed), rolls=how == "roll")
    part.objectives += _way(thing, moving, carrier, how, speed, friction, direction)
    if not friction and how != "roll":
        raise UserError(f"{thing.words!r}: without friction it slides for ever; give a friction above 0")
    stop = speed / (friction * GRAVITY) if friction else 0.0
    if "still" in thing.does:
        part.objectives.append(Objective(kind="settles", object=item.name, sentence=f"{item.name} comes to rest."))
        if how == "roll":
            stop = _slowed(thing, speed, cast)
            part.duration = max(part.duration, round(stop + 1.0, 1))
    elif how == "roll" and thing.lasts is not None:
        cast.duration = cast.duration or thing.lasts
    time = max(1.5, ROLL_WAY / speed) if how == "roll" else 1.0 + stop
    part.duration = max(part.duration, round(min(time, 3.0) if how == "roll" else time, 1))
    way = speed * (cast.duration or part.duration) if how == "roll" else stopping_distance(speed, friction)
    part.goes[item.name] = [times(DIRECTIONS[direction], round(way, 3))]
    return moving


def _into(
    thing: Thing,
    item: PlanObject,
    carrier: PlanObject,
    how: str,
    friction: float,
    direction: str,
    cast: Cast,
    part: Part,
) -> PlanObject:
    """What leaves a table so fast that it comes down in its vessel; the vessel has its place from this."""
    way = carrier.size[0 if direction in ("front", "back") else 1] / 2 if carrier.size else 0.0
    lost = 2 * friction * GRAVITY * way if how != "roll" else 0.0
    height = top(carrier.name, part) if carrier.size else 0.0
    edge = None if thing.speed is None else math.sqrt(max(thing.speed**2 - lost, 0.0))
    if edge == 0.0:
        raise UserError(f"{thing.words!r}: at {thing.speed:g} m/s it stops before the edge; give a higher speed")
    caught = catcher(thing, part.vessels[id(thing.into)], item, edge, height, cast)
    speed = thing.speed or math.ceil(100 * math.sqrt(caught.speed**2 + lost)) / 100
    if thing.speed is None:
        cast.assume(thing.words, f"starts at {speed:g} m/s", "so that it comes down in its vessel")
    if thing.direction is None:
        cast.assume(thing.words, "towards +X", "the prompt gives no direction")
    side = {"front": "FRONT-OF", "back": "BACK-OF", "left": "LEFT-OF", "right": "RIGHT-OF"}[direction]
    across = "ALIGN-CENTER-LR" if direction in ("front", "back") else "ALIGN-CENTER-FB"
    rows = [
        Relation(predicate="PLACE-ON-BASE"),
        Relation(predicate=side, ref=carrier.name, gap=caught.gap),
        Relation(predicate=across, ref=item.name),
    ]
    part.caught.append(caught.vessel.related(rows))
    part.objectives += [
        falls_off(item, carrier),
        lands(item.name, caught.vessel.name),
    ]
    time = way / caught.speed + fall_time(height)
    part.duration = max(part.duration, round(time + 2.0, 1))
    return started(item, times(DIRECTIONS[direction], speed), rolls=how == "roll")


def falls_off(item: PlanObject, carrier: PlanObject) -> Objective:
    """What leaves a table is lower in the end; a flat thing need not have turned."""
    sentence = f"{item.name} leaves {carrier.name} and falls."
    if item.primitive == "sphere":
        return Objective(kind="topples", object=item.name, sentence=sentence)
    return asked(item.name, sentence, Drops(object=item.name))


def _slowed(thing: Thing, speed: float, cast: Cast) -> float:
    """A rolling resistance that stops a ball on its way: a = g c / (1 + I / m r^2); the time that it takes [s]."""
    way = STOP_WAY if thing.lasts is None else speed * thing.lasts / 2
    resistance = round(1.4 * speed**2 / (2 * GRAVITY * way), 4)
    thing.pairs.append((thing.support, "rolling", resistance))
    cast.assume(thing.words, f"a rolling resistance of {resistance:g}", f"so that it stops after {way:g} m")
    return 2 * way / speed


def started(item: PlanObject, velocity: Vec3, *, rolls: bool) -> PlanObject:
    """The object with its start's velocity; what rolls has the spin that fits, and lies across its way."""
    if not rolls:
        return item.model_copy(update={"velocity": velocity})
    moving = item.model_copy(update={"velocity": velocity, "rolling": True})
    if item.primitive == "sphere":
        return moving
    rows = [row for row in item.relations if not row.predicate.startswith("LIES-ALONG")]
    return moving.related([*rows, Relation(predicate="LIES-ALONG-Y" if velocity[0] else "LIES-ALONG-X")])


def check_round(thing: Thing) -> None:
    """See that a thing can roll if it is to, and that its speed is in range.

    Raises:
        UserError: It cannot, or its speed is not.
    """
    if "roll" in thing.does and thing.noun.primitive not in ROUND:
        raise UserError(f"{thing.words!r}: the builtin planner rolls balls, barrels and the like")
    if thing.speed is not None and not 0.0 < thing.speed <= MOST_SPEED:
        raise UserError(
            f"{thing.words!r}: {thing.speed:g} m/s is not above 0 and up to {MOST_SPEED:g} m/s, the planner's range"
        )


def _speed(thing: Thing, item: PlanObject, carrier: PlanObject, how: str, friction: float, cast: Cast) -> float:
    if thing.lasts is not None and how != "roll":
        return _lasting_speed(thing, friction, cast)
    if thing.speed is not None:
        return thing.speed
    speed = {"roll": ROLL_SPEED, "slide": SLIDE_SPEED, "push": PUSH_SPEED}[how]
    if how in ("slide", "push") and thing.off and carrier.size:
        way = carrier.size[0] / 2 + item.size[0]  # so that its middle is over the edge with speed to spare
        speed = math.ceil(10 * 1.3 * math.sqrt(2 * friction * GRAVITY * way)) / 10
    speed *= {"slowly": 0.5, "quickly": 2.0}.get(next(iter({"slowly", "quickly"} & thing.manners), ""), 1.0)
    cast.assume(thing.words, f"starts at {speed:g} m/s", "the prompt gives no speed")
    return speed


def _lasting_speed(thing: Thing, friction: float, cast: Cast) -> float:
    """With which friction stops what slides after the time that is said: v = mu g t [m/s]."""
    speed = round(friction * GRAVITY * (thing.lasts or 0.0), 2)
    if thing.speed is not None and abs(thing.speed - speed) > LASTS * speed:
        stop = f"{thing.speed / (friction * GRAVITY):.3g} s" if friction else "never"
        raise UserError(
            f"{thing.words!r}: at {thing.speed:g} m/s friction stops it after {stop}, not {thing.lasts:g} s; leave the "
            "speed or the time out"
        )
    if not 0.0 < speed <= MOST_SPEED:
        raise UserError(f"{thing.words!r}: to slide for {thing.lasts:g} s it would start at {speed:g} m/s; give less")
    if thing.speed is None:
        cast.assume(thing.words, f"starts at {speed:g} m/s", f"friction stops it after {thing.lasts:g} s")
    return thing.speed or speed


def free_way(thing: Thing, cast: Cast) -> str:
    """Where something goes that is said to go nowhere: along +X, or past what is there.

    Raises:
        UserError: It is said to go at what is in its way, and not that it hits that.
    """
    behind = {"FRONT-OF": "back", "BACK-OF": "front", "LEFT-OF": "right", "RIGHT-OF": "left"}
    ahead = {"FRONT-OF": "front", "BACK-OF": "back", "LEFT-OF": "left", "RIGHT-OF": "right"}
    blocked = {behind[one.predicate]: one.ref.words for one in thing.beside if one.predicate in behind}
    blocked |= {
        ahead[one.predicate]: other.words
        for other in cast.things for one in other.beside if one.ref is thing and one.predicate in ahead
    }  # fmt: skip
    if thing.direction is not None and thing.direction in blocked:
        raise UserError(
            f"{thing.words!r} would run into {blocked[thing.direction]!r}; say that it does, as in 'rolls into', or "
            "another direction"
        )
    return thing.direction or next((way for way in ("front", "left", "right", "back") if way not in blocked), "front")


def _way(
    thing: Thing, item: PlanObject, carrier: PlanObject, how: str, speed: float, friction: float, direction: str
) -> list[Objective]:
    name, asks = item.name, list[Objective]()
    if thing.off:
        asks = [falls_off(item, carrier)]
        way = round(SHARE * min(carrier.size[:2]) / 2, 3) if carrier.size else SHARE
    elif how == "roll":
        way = round(SHARE * min(ROLL_WAY / 2, speed * (thing.lasts or 1.0)), 3)
    else:
        way = round(SHARE * stopping_distance(speed, friction), 3)
    if thing.lasts is not None and (how != "roll" or "still" in thing.does):
        asks.append(_goes_for(name, thing.lasts, speed))
    if how == "slide" and not thing.round and not thing.off:
        asks.append(Objective(kind="slides", object=name, value=way, sentence=f"{name} slides {way:g} m or more."))
        if thing.direction is None:
            return asks
    if thing.direction is None and (how == "roll" or thing.off):
        return asks
    where = "" if thing.direction is None else f" to the {direction}"
    sentence = f"{name} moves {way:g} m or more{where}."
    return [*asks, Objective(kind="moves", object=name, value=way, direction=direction, sentence=sentence)]


def _goes_for(name: str, time: float, speed: float) -> Objective:
    """It still goes when most of the time is over: braked evenly, at a fifth of its speed."""
    still = SpeedBetween(object=name, low=round(speed / 10, 3), high=speed)
    formula = Eventually(window=(round(0.8 * time, 3), time), of=still)
    return asked(name, f"{name} goes for {time:g} s.", formula)


def _thrown(thing: Thing, item: PlanObject, cast: Cast, part: Part) -> PlanObject:
    """A throw at an angle; its range from theory."""
    check_round(thing)
    angle = THROW_ANGLE if thing.angle is None else thing.angle
    if not -45.0 <= angle <= 85.0:
        raise UserError(f"{thing.words!r}: {angle:g} degrees is outside -45 to 85, the planner's range of throws")
    speed = THROW_SPEED if thing.speed is None else thing.speed
    height = thing.drop_height or 0.0
    if thing.support is not None:
        height += top(part.names[id(thing.support)][-1], part)
    if thing.over is not None:
        speed, angle = clearing(thing, part.vessels[id(thing.over)], height, speed, angle)
    for given, text, what in (
        (thing.speed, f"thrown at {speed:g} m/s", "speed"),
        (thing.angle, f"thrown at {angle:g} degrees above the level", "angle"),
        (thing.direction, "towards +X", "direction"),
    ):
        if given is None:
            cast.assume(thing.words, text, f"the prompt gives no {what}")
    along, up = speed * math.cos(math.radians(angle)), speed * math.sin(math.radians(angle))
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
        else stopping_distance(along, pair_friction(item, ground_object(cast.ground), thing.said("friction", None)))
    )
    if thing.over is not None:
        stand_below(thing, item, part.vessels[id(thing.over)], along * up / GRAVITY, direction, cast, part)
    if thing.into is not None:
        _thrown_into(thing, item, along, up, height, direction, cast, part)
    level = times(DIRECTIONS[direction], 1.0)
    part.goes[name] = [*_arc(level, along, up, time), times(level, round(along * time + after, 3))]
    return item.model_copy(update={"velocity": (tidy(x), tidy(y), tidy(up))})


def _thrown_into(
    thing: Thing, item: PlanObject, along: float, up: float, height: float, direction: str, cast: Cast, part: Part
) -> None:
    """A vessel where a throw comes down through its mouth."""
    vessel = part.vessels[id(thing.into)]
    fall = height + reach(item) - vessel.size[2] - WALL
    if up**2 + 2 * GRAVITY * fall < 0.0 or thing.into is None:
        raise UserError(f"{thing.words!r}: the throw stays below the rim; give more speed, or a steeper angle")
    time = (up + math.sqrt(up**2 + 2 * GRAVITY * fall)) / GRAVITY
    gap = round(along * time - vessel.size[0] / 2 - WALL - reach(item), 3)
    if gap < 0.0:
        raise UserError(f"{thing.words!r}: it comes down {along * time:.2g} m away, too near for {vessel.name}")
    side = {"front": "FRONT-OF", "back": "BACK-OF", "left": "LEFT-OF", "right": "RIGHT-OF"}[direction]
    across = "ALIGN-CENTER-LR" if direction in ("front", "back") else "ALIGN-CENTER-FB"
    rows = [
        Relation(predicate="PLACE-ON-BASE"),
        Relation(predicate=side, ref=item.name, gap=gap),
        Relation(predicate=across, ref=item.name),
    ]
    part.caught.append(vessel.related(rows))
    part.objectives = [o for o in part.objectives if (o.object, o.kind) != (item.name, "moves")]
    part.objectives.append(lands(item.name, vessel.name))
    deaden(thing, thing.into, cast)
    part.duration = max(part.duration, round(time + 2.5, 1))
    cast.assume(
        thing.into.words, f"{gap:g} m from where the throw begins", "there the parabola comes through its mouth"
    )


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


def aimed_at(
    thing: Thing, item: PlanObject, aimed: str, speed: float, share: float, cast: Cast, part: Part
) -> tuple[PlanObject, Relation]:
    """A throw that hits an object at a share of its height: the level way gives the time, and that the upward speed."""
    if thing.angle is not None:
        raise UserError(f"{thing.words!r}: thrown at something, it takes the angle that hits; leave the angle out")
    height = 0.5 if thing.drop_height is None else thing.drop_height
    if thing.drop_height is None:
        cast.assume_height(thing.words, "thrown from {} up", height)
    centre = middle(aimed, part) + (share - 0.5) * tall(item_of(aimed, part))
    radius = item.size[0] if item.primitive != "box" else item.size[2] / 2
    time = AIM_DISTANCE / speed
    up = (centre - height - radius) / time + GRAVITY * time / 2
    velocity: Vec3 = (speed, 0.0, tidy(up))
    cast.assume(
        thing.words,
        f"at {speed:g} m/s level and {up:.2f} m/s up",
        f"so that it hits its target at {share:.0%} of its height",
    )
    moving = item.model_copy(update={"velocity": velocity})
    part.goes[item.name] = _arc((1.0, 0.0, 0.0), speed, up, time)
    return moving, Relation(predicate="SPAWNED-ABOVE", value=height)


def middle(name: str, part: Part) -> float:
    """Height of the centre of something that stands on the ground, or on others that do [m]."""
    return top(name, part) - tall(item_of(name, part)) / 2


def top(name: str, part: Part) -> float:
    """Height of the top of something that stands on the ground, or on others that do [m]."""
    items = {item.name: item for item in part.objects}
    height, at = 0.0, items.get(name)
    while at is not None:
        above = at.relation("SPAWNED-ABOVE") if at.state == "static" else None
        height += tall(at) + (above.value or 0.0 if above is not None else 0.0)
        row = at.relation("PLACE-ON")
        at = items.get(row.ref or "") if row is not None else None
    return height


def item_of(name: str, part: Part) -> PlanObject:
    """An object of a part, by its name.

    Raises:
        UserError: It has a pose of its own, as what hangs or is on a ramp has, which is where no rule looks for it.
    """
    found = next((item for item in part.objects if item.name == name), None)
    if found is None:
        raise UserError(f"{name!r}: the builtin planner lets things hit or carry what stands on the level, not this")
    return found
