"""Ramps, and what rolls, slides or rests on them."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Pose, Proxy, Relation
from wsim.plan.schema.formula_place import StaysWithin
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.part import MOST_SPEED, Part, pair_friction, tall, tidy
from wsim.rules.sizes import bodies

BARE_DURATION = 1.0  # of a scene with a ramp and nothing on it: that long it is seen to stand [s]
ROLLING_ANGLE = 20.0  # [deg], where the prompt gives none
ABOVE, BELOW = 8.0, 6.0  # from the angle of friction to that of what slides, or of what rests [deg]
FLATTEST, STEEPEST = 1.0, 60.0  # [deg]
EDGE = 0.08  # from the ramp's upper end to what starts on it [m]
PLAY = 0.25  # of its smallest extent, which what rests may be off its place
START_GAP = 0.001  # between the ramp and what starts on it [m]
LEAST_WAY, WAY = 0.3, 0.6  # of a ramp's length, which what is on it has before it: at least, and usually
SAFE = 0.9  # of the way that it has before it, which is asked of it at most
SMOOTHER, ROUGHER = 0.6, 1.3  # times the friction at which a thing just slides, or just stays
ASIDE = 0.05  # between what is on a ramp, and to its sides [m]
CYLINDER = 1 / 3  # the same of a cylinder as the next
SPHERE = 2 / 7  # of tan(angle): the least friction with which a ball rolls without slipping, and a ball's share of g


def build_inclines(cast: Cast, taken: set[str]) -> list[Part]:
    """Every ramp, and what is on it; its foot points along +X."""
    return [_incline(ramp, cast, taken) for ramp in cast.family("ramp")]


def _incline(ramp: Thing, cast: Cast, taken: set[str]) -> Part:
    """A ramp and what is on it, side by side.

    Raises:
        UserError: more on it than fits.
    """
    if ramp.count > 1:
        raise UserError(f"{ramp.words!r}: the builtin planner builds one such ramp; name each for itself")
    part = Part()
    things = [thing for thing in cast.things if thing.path is ramp]
    for thing in things:
        if thing.group:
            raise UserError(f"{thing.words!r}: the builtin planner puts no stack or row on a ramp")
    riders = [(thing, item) for thing in things for item in bodies(thing, cast, taken)]
    [slab] = bodies(ramp, cast, taken)
    slab = _large_enough(ramp, slab, [item for _, item in riders], cast)
    angle = _angle(ramp, slab, riders, cast)
    turn, (length, _, thick) = math.radians(angle), slab.size
    pose = Pose(
        position=(0.0, 0.0, tidy(length / 2 * math.sin(turn) + thick / 2 * math.cos(turn))),
        rotation_deg=(0.0, angle, 0.0),
    )
    slab = slab.model_copy(update={"pose": pose})
    part.objects.append(slab)
    part.names[id(ramp)] = [slab.name]
    if not riders:
        part.duration = BARE_DURATION
    across = _places_across(slab, [item for _, item in riders])
    for (thing, item), y in zip(riders, across, strict=True):
        _rider(thing, item, slab, angle, y, part, cast)
    return part


def _large_enough(ramp: Thing, slab: PlanObject, items: list[PlanObject], cast: Cast) -> PlanObject:
    """The ramp, longer and wider than usual where what is on it would reach its foot, or its sides.

    Raises:
        UserError: The prompt gives a size on which it has no room.
    """
    length, width, thick = slab.size
    said = ramp.phrase.measures
    longest = max((_along(item) for item in items), default=0.0)
    wanted = sum(_across(item) for item in items) + ASIDE * (len(items) + 1)
    if EDGE + longest + LEAST_WAY * length > length:
        if ramp.phrase.length is not None or "x" in said or ramp.phrase.edges:
            raise UserError(
                f"{ramp.words!r}: {length:g} m is too short for what is on it, {longest:g} m long; make it "
                f"{(EDGE + longest) / (1 - LEAST_WAY):.2g} m or more, or leave its length out"
            )
        length = math.ceil(10 * (EDGE + longest + WAY * length)) / 10
    if items and wanted > width:
        if "y" in said or ramp.phrase.edges:
            raise UserError(f"{ramp.words!r} is {width:g} m wide, too narrow for what is on it; give smaller things")
        width = math.ceil(10 * wanted) / 10
    if (length, width) == slab.size[:2]:
        return slab
    size = (length, width, thick)
    told = " x ".join(f"{edge:g}" for edge in slab.size) + " m"
    cast.assumptions = [one for one in cast.assumptions if (one.subject, one.choice) != (ramp.words, told)]
    cast.assume(ramp.words, " x ".join(f"{edge:g}" for edge in size) + " m", "room for what is on it, and its way")
    return slab.model_copy(update={"construction": Proxy(primitive="box", size=size)})


def _along(item: PlanObject) -> float:
    """How much of a ramp's length a thing takes up [m]."""
    return item.size[0] if item.primitive == "box" else 2 * item.size[0]


def _across(item: PlanObject) -> float:
    """How much of its width [m]."""
    if item.primitive == "box":
        return item.size[1]
    lies = item.relation("LIES-ALONG-Y") is not None
    ends = 2 * item.size[0] if item.primitive == "capsule" else 0.0
    return item.size[1] + ends if lies else 2 * item.size[0]


def _angle(ramp: Thing, slab: PlanObject, riders: list[tuple[Thing, PlanObject]], cast: Cast) -> float:
    """The prompt's angle; else one at which the riders do what they are to do."""
    given = ramp.phrase.angle
    if given is not None:
        if not FLATTEST <= given <= STEEPEST:
            raise UserError(
                f"{ramp.words!r}: {given:g} degrees is outside {FLATTEST:g} to {STEEPEST:g}, the planner's range"
            )
        for thing, item in riders:
            _suit(thing, item, ramp, slab, given, cast)
            _warn(thing, item, slab, given, cast)
        return given
    angle, why = ROLLING_ANGLE, "the prompt gives no angle"
    for thing, item in riders:
        friction = pair_friction(item, slab, thing.said("friction", ramp))
        limit = math.degrees(math.atan(friction))
        if "slide" in thing.does:
            angle = 5.0 * math.ceil((limit + ABOVE) / 5)
            why = f"steeper than the angle of friction, {limit:.1f} degrees at a friction of {friction:g}"
        elif "roll" in thing.does:
            rolls = math.degrees(math.atan(friction / _inertia(item)))
            angle = ROLLING_ANGLE if rolls > ROLLING_ANGLE else max(FLATTEST, math.floor(rolls - 1.0))
            if rolls >= angle:
                why = (
                    f"a friction of {friction:g} is above 2/7 tan({angle:g} degrees) = "
                    f"{SPHERE * math.tan(math.radians(angle)):.3f}, so that a ball rolls and does not slip"
                )
        else:
            angle = max(2.0, 5.0 * math.floor((limit - BELOW) / 5))
            why = f"flatter than the angle of friction, {limit:.1f} degrees at a friction of {friction:g}"
    if angle > STEEPEST:
        raise UserError(f"{ramp.words!r}: to slide there would take {angle:g} degrees; give smoother materials")
    cast.assume(ramp.words, f"inclined by {angle:g} degrees", why)
    for thing, item in riders:
        _warn(thing, item, slab, angle, cast)
    return angle


def _suit(thing: Thing, item: PlanObject, ramp: Thing, slab: PlanObject, angle: float, cast: Cast) -> None:
    """A friction with which a thing does on the ramp what it is to, where the prompt leaves the ramp's surface open."""
    friction, slope = pair_friction(item, slab, thing.said("friction", ramp)), math.tan(math.radians(angle))
    if thing.said("friction", ramp) is not None or ramp.phrase.material is not None:
        return
    wanted = None
    if "slide" in thing.does and slope < friction / SMOOTHER:
        wanted = round(SMOOTHER * slope, 3)
    elif "roll" in thing.does and _inertia(item) * slope > friction / ROUGHER:
        wanted = math.ceil(100 * ROUGHER * _inertia(item) * slope) / 100
    elif "rest" in thing.does and slope > friction / ROUGHER and not {"slide", "roll"} & {*thing.does}:
        wanted = math.ceil(100 * ROUGHER * slope) / 100
    if wanted is not None:
        thing.pairs.append((ramp, "friction", wanted))
        cast.assume(
            thing.words,
            f"a friction of {wanted:g} on the ramp",
            f"so that it does as it is said to at {angle:g} degrees",
        )


def _warn(thing: Thing, item: PlanObject, slab: PlanObject, angle: float, cast: Cast) -> None:
    friction = pair_friction(item, slab, thing.said("friction", thing.path))
    slope = math.tan(math.radians(angle))
    slips = slope > friction
    text = f"at {angle:g} degrees and a friction of {friction:g}"
    if "slide" in thing.does and not slips:
        cast.assume(thing.words, f"warning: {text} it stays", "the plan asks for what the prompt says")
    elif "rest" in thing.does and slips and not thing.round:
        cast.assume(thing.words, f"warning: {text} it slides", "the plan asks for what the prompt says")
    elif "roll" in thing.does and SPHERE * slope > friction:
        least = f"a ball rolls without slipping where friction is above 2/7 tan(slope), here {SPHERE * slope:.2g}"
        cast.assume(thing.words, f"warning: {text} it slips as it rolls", least)


def _places_across(slab: PlanObject, items: list[PlanObject]) -> list[float]:
    """Where each starts across the ramp [m]."""
    widths = [_across(item) for item in items]
    gap, at, places = (slab.size[1] - sum(widths)) / (len(items) + 1), -slab.size[1] / 2, []
    for width in widths:
        places.append(at + gap + width / 2)
        at += gap + width
    return places


def _rider(thing: Thing, item: PlanObject, slab: PlanObject, angle: float, y: float, part: Part, cast: Cast) -> None:
    turn, (length, _, thick) = math.radians(angle), slab.size
    item = _turned(thing, item)
    lies = item.relation("LIES-ALONG-Y") is not None
    half = item.size[0] if lies else tall(item) / 2 + (item.size[0] if item.primitive == "capsule" else 0.0)
    along = _along(item) / 2
    s, h = -length / 2 + EDGE + along, thick / 2 + half + START_GAP
    assert slab.pose is not None
    x0, _, z0 = slab.pose.position
    position = (
        tidy(x0 + s * math.cos(turn) + h * math.sin(turn)),
        tidy(y),
        tidy(z0 - s * math.sin(turn) + h * math.cos(turn)),
    )
    rotation = (90.0, 0.0, 0.0) if lies else (0.0, angle if item.primitive != "sphere" else 0.0, 0.0)
    speed = thing.speed or 0.0
    velocity = (tidy(speed * math.cos(turn)), 0.0, tidy(-speed * math.sin(turn)))
    pose = Pose(position=position, rotation_deg=rotation)
    if thing.speed is not None and not 0.0 < speed <= MOST_SPEED:
        raise UserError(
            f"{thing.words!r}: {speed:g} m/s is not above 0 and up to {MOST_SPEED:g} m/s, the planner's range"
        )
    rolls = {"rolling": True} if speed and "roll" in thing.does else {}
    part.posed.append(item.related([]).model_copy(update={"pose": pose, "velocity": velocity, **rolls}))
    part.names.setdefault(id(thing), []).append(item.name)
    _objective(thing, part.posed[-1], slab, angle, part, cast)


def _turned(thing: Thing, item: PlanObject) -> PlanObject:
    """On its side if it rolls.

    Raises:
        UserError: It cannot roll.
    """
    if "roll" not in thing.does or item.primitive == "sphere":
        return item
    if item.primitive == "box":
        raise UserError(f"{thing.words!r}: the builtin planner rolls balls, barrels and the like, and slides the rest")
    return item.related([Relation(predicate="LIES-ALONG-Y")])


def _objective(thing: Thing, item: PlanObject, slab: PlanObject, angle: float, part: Part, cast: Cast) -> None:
    turn, name = math.radians(angle), item.name
    friction = pair_friction(item, slab, thing.said("friction", thing.path))
    # The rest is where it starts, and the foot.
    room = slab.size[0] - EDGE - _along(item)
    way = round(min(WAY * slab.size[0], SAFE * room), 3)
    if "roll" in thing.does:
        pull = GRAVITY * math.sin(turn) * (1 - _inertia(item))
        sentence = f"{name} rolls down {slab.name}."
        part.objectives.append(Objective(kind="rolls_down", object=name, ref=slab.name, value=way, sentence=sentence))
    elif {"slide", "push"} & {*thing.does}:
        pull = GRAVITY * (math.sin(turn) - friction * math.cos(turn))
        sentence = f"{name} slides down {slab.name}."
        part.objectives.append(Objective(kind="slides", object=name, ref=slab.name, value=way, sentence=sentence))
    elif thing.round:
        cast.assume(thing.words, "nothing is asked of it", "what is round does not rest on a ramp")
        pull = GRAVITY * math.sin(turn) * (1 - SPHERE)
    else:
        part.objectives += _rest(item, slab)
        pull = 0.0
    speed = thing.speed or 0.0
    # What is as long as half of the ramp is watched until its front is at the foot: there it would lie across the bend.
    long = room < slab.size[0] / 2 and thing.target is None
    time = (math.sqrt(speed**2 + 2 * (room if long else slab.size[0]) * pull) - speed) / pull if pull > 0.1 else 1.0
    after = 2.0 if thing.target is not None else 0.0 if long and pull > 0.1 else 0.5
    part.duration = max(part.duration, round(time + after, 1))
    if pull > 0.1 and not long and thing.target is None:  # past the foot it goes on at the speed that it has there
        beyond = (speed + pull * time) * math.cos(turn) * (part.duration - time)
        way = slab.size[0] * math.cos(turn) + beyond
        part.goes[name] = [(round(way, 3), 0.0, round(-slab.size[0] * math.sin(turn), 3))]


def _inertia(item: PlanObject) -> float:
    """I / (I + m r^2): the share of its pull that turns it."""
    return SPHERE if item.primitive == "sphere" else CYLINDER


def _rest(item: PlanObject, slab: PlanObject) -> list[Objective]:
    """It is where it was all the time, and at rest in the end: what has slid off lies still, too."""
    assert item.pose is not None
    size = [2 * item.size[0]] if item.primitive == "sphere" else item.size
    radius = round(PLAY * min(size), 3)
    stays = StaysWithin(object=item.name, center=item.pose.position, radius=radius)
    sentence = f"{item.name} stays in its place on {slab.name}, to {radius:g} m."
    return [
        Objective(kind="formula", object=item.name, sentence=sentence, formula=stays),
        Objective(kind="settles", object=item.name, sentence=f"{item.name} is at rest on {slab.name}."),
    ]
