"""Seesaws: a plank on a hinge, and what drops or stands on its ends."""

from __future__ import annotations

import math

from wsim.errors import UserError
from wsim.plan.schema import Joint, Objective, PlanObject, Pose
from wsim.plan.schema.formula import Always, Eventually
from wsim.plan.schema.formula_place import GoneBetween, TiltBetween
from wsim.rules.cast import Cast, Thing
from wsim.rules.materials import material_named
from wsim.rules.scenes.lasting import asked, leans
from wsim.rules.scenes.part import Part, fall_time, tall, tidy
from wsim.rules.sizes import bodies

SEESAW_HEIGHT = 0.3  # of the plank's underside above the ground [m]
BASE_WIDTH = 0.06  # of what carries a seesaw's plank [m]
HINGE_GAP = 0.005  # between a seesaw's plank and what carries it [m]
RIDER_SHARE = 0.8  # of the half length, from the hinge to what is on a seesaw
DROP_HEIGHT = 0.3  # [m]
LEVEL = 4.0  # that a level plank leans at most [deg]
RISES, HIGHEST = 0.04, 10.0  # of what goes up with an end, which leans by 3 degrees or more: at least, and at most [m]
OUTWEIGHS, TWICE = 1.2, 2.0  # what goes down against what goes up: at least, and where a mass is chosen
Load = tuple[Thing, PlanObject, str]  # what is on it, and at which end
_OTHER = {"left": "right", "right": "left"}
SIGN = {"left": -1.0, "right": 1.0, "middle": 0.0}  # along X, as the side camera sees it


def build_seesaws(cast: Cast, taken: set[str]) -> list[Part]:
    """Every seesaw, and its riders."""
    return [_seesaw(seesaw, cast, taken) for seesaw in cast.family("seesaw")]


def _seesaw(seesaw: Thing, cast: Cast, taken: set[str]) -> Part:
    """A plank on a hinge, and up to two things, or stacks of them, at its ends.

    Raises:
        UserError: several, or more on it than fits.
    """
    part = Part(duration=2.0)
    riders = [thing for thing in cast.things if thing.support is seesaw]
    if seesaw.count > 1:
        raise UserError(f"{seesaw.words!r}: the builtin planner builds one such seesaw; name each for itself")
    plank = _plank(seesaw, part, cast, taken)
    sides = _sides(riders, seesaw, cast)
    loads = []
    ridden = [(one, item, end) for one, ends in sides for item, end in zip(bodies(one, cast, taken), ends, strict=True)]
    for thing, item, side in _weighed(seesaw, ridden, cast):
        loads.append((thing, _ride(thing, item, side, plank, part, cast), side))
        part.names.setdefault(id(thing), []).append(item.name)
    _ask(seesaw, plank, loads, part, cast)
    return part


def _plank(seesaw: Thing, part: Part, cast: Cast, taken: set[str]) -> PlanObject:
    [plank] = bodies(seesaw, cast, taken)
    _, width, thick = plank.size
    plank = plank.model_copy(update={"pose": Pose(position=(0.0, 0.0, tidy(SEESAW_HEIGHT + thick / 2)))})
    base_name = f"{plank.name}_base"
    taken.add(base_name)
    base = PlanObject.proxy(
        name=base_name, role="background", primitive="box", size=(BASE_WIDTH, width, SEESAW_HEIGHT - HINGE_GAP),
        material=material_named("steel"), state="static",
        pose=Pose(position=(0.0, 0.0, tidy((SEESAW_HEIGHT - HINGE_GAP) / 2))), words=seesaw.words,
    )  # fmt: skip
    part.objects += [base, plank]
    first = "pivot" not in taken
    taken |= {"pivot"}
    part.joints = [Joint(name="pivot" if first else f"pivot_{plank.name}", kind="hinge", child=plank.name, axis="Y")]
    part.names[id(seesaw)] = [plank.name]
    return plank


def _sides(riders: list[Thing], seesaw: Thing, cast: Cast) -> list[tuple[Thing, list[str]]]:
    """Which end each thing is at, lowest first where one is on another."""
    free = ["right", "left"] if sum(thing.count for thing in riders) == 1 else ["left", "right"]
    free = [side for side in free if side not in [thing.side for thing in riders]]
    made = []
    for thing in riders:
        if thing.group:
            raise UserError(f"{thing.words!r}: the builtin planner puts single things on a seesaw")
        if thing.side in SIGN:
            places = [thing.side] * thing.count
        elif len(free) < thing.count:
            raise UserError(f"{seesaw.words!r}: the builtin planner puts one thing on each end, or say on which")
        else:
            places = [free.pop(0) for _ in range(thing.count)]
            end = "front end" if len(riders) == 1 and thing.count == 1 else f"{' and '.join(places)} end"
            cast.assume(thing.words, f"over the {end}", "the prompt does not say which end")
        made.append((thing, places))
    taken = [side for _, places in made for side in places]
    if len({*taken}) < len(taken):
        raise UserError(f"{seesaw.words!r}: the builtin planner puts one thing on each end of it, not two on one")
    return made


def _weighed(seesaw: Thing, loads: list[Load], cast: Cast) -> list[Load]:
    """What is on it, so heavy that the end goes down that is said to, where the prompt leaves a mass of two open."""
    falls = [side for thing, _, side in loads if "drop" in thing.does]
    down = seesaw.side if seesaw.side in ("left", "right") else falls[0] if len(falls) == 1 else None
    level = "level" in seesaw.does or any("level" in one.manners for one in (seesaw, *(load[0] for load in loads)))
    low, high = ([load for load in loads if load[2] == end] for end in (down, _OTHER.get(down or "")))
    if level or len(low) != 1 or len(high) != 1:
        return loads
    heavy, light = low[0][1].mass or 0.0, high[0][1].mass or 0.0
    if heavy >= OUTWEIGHS * light:
        return loads
    for load, mass in ((low[0], TWICE * light), (high[0], heavy / TWICE)):
        thing, item, side = load
        if not _is_open(thing):
            continue
        mass = round(mass, 2)
        cast.assume(thing.words, f"weighs {mass:g} kg", f"so that the {down} end of the seesaw goes down")
        weighed = item.model_copy(update={"registration": item.registration.model_copy(update={"mass": mass})})
        return [(thing, weighed, side) if one is load else one for one in loads]
    if heavy < light:
        why = f"{low[0][1].name} weighs {heavy:.3g} kg, and {high[0][1].name} {light:.3g} kg"
        cast.assume(seesaw.words, f"warning: its {_OTHER[down or '']} end goes down, or comes down again", why)
    return loads


def _is_open(thing: Thing) -> bool:
    """Whether the prompt leaves it open how heavy a thing is; what the catalogue has weighs what it does."""
    phrase = thing.phrase
    said = phrase.material or phrase.weight or {"mass", "density"} & set(phrase.measures)
    return not said and thing.noun.asset is None and thing.noun.material is None


def _ride(thing: Thing, item: PlanObject, side: str, plank: PlanObject, part: Part, cast: Cast) -> PlanObject:
    """The thing at its end, or over it."""
    lying = item.relation("LIES-ALONG-Y") is not None
    half = item.size[0] if lying else tall(item) / 2
    height = 0.001
    if "drop" in thing.does:
        height = cast.drop_height(thing, DROP_HEIGHT, "the seesaw")
    assert plank.pose is not None
    top = plank.pose.position[2] + plank.size[2] / 2
    at = SIGN[side] * RIDER_SHARE * plank.size[0] / 2
    turned = (90.0, 0.0, 0.0) if lying else (0.0, 0.0, 0.0)
    pose = Pose(position=(tidy(at), 0.0, tidy(top + height + half)), rotation_deg=turned)
    part.posed.append(item.related([]).model_copy(update={"pose": pose}))
    part.duration = max(part.duration, round(2.0 + fall_time(height), 1))
    return part.posed[-1]


def _ask(seesaw: Thing, plank: PlanObject, loads: list[Load], part: Part, cast: Cast) -> None:
    """Which end goes down: that on which something falls, else the heavier."""
    if not loads and (seesaw.angle is not None or seesaw.side is not None or "tilt" in seesaw.does):
        raise UserError(f"{seesaw.words!r}: nothing is on it that could tilt it; name what stands or falls on it")
    falls = [load for load in loads if "drop" in load[0].does]
    moment = sum(
        SIGN[side] * (item.mass or 0.0)
        for thing, item, side in loads
        if not falls or any(thing is load[0] for load in falls)
    )
    level = abs(moment) < 1e-9 if falls == [] else len(falls) == 2 and abs(moment) < 1e-9
    asked_level = "level" in seesaw.does or any(
        "level" in one.manners for one in (seesaw, *(load[0] for load in loads))
    )
    if asked_level or level:
        if not level:
            choice = "warning: it tilts to its heavier end"
            cast.assume(seesaw.words, choice, "the plan asks for what the prompt says")
        sentence = f"{plank.name} stays level and at rest."
        part.objectives.append(Objective(kind="settles", object=plank.name, sentence=sentence))
        if loads:
            always = Always(of=TiltBetween(object=plank.name, axis="x", low=-LEVEL, high=LEVEL))
            part.objectives.append(asked(plank.name, f"{plank.name} stays level, to {LEVEL:g} degrees.", always))
        return
    heavier = "right" if moment > 0 else "left"
    side = seesaw.side if seesaw.side in ("left", "right") else heavier
    if side != heavier:
        cast.assume(seesaw.words, f"warning: its {heavier} end goes down", "the plan asks for what the prompt says")
    low = next((item for _, item, at in loads if at == side), None)
    if low is None:
        formula = TiltBetween(object=plank.name, axis="x", **_lean(side))
        part.objectives.append(asked(plank.name, f"The {side} end of {plank.name} goes down.", formula))
    else:
        sentence = f"{plank.name} goes down where {low.name} is."
        part.objectives.append(Objective(kind="tilts", object=plank.name, ref=low.name, sentence=sentence))
    for thing, item, at in loads:
        if "rise" in thing.does and at != side:
            up = Eventually(of=GoneBetween(object=item.name, axis="z", low=RISES, high=HIGHEST))
            part.objectives.append(asked(item.name, f"{item.name} goes up by {RISES:g} m or more.", up))
    if seesaw.angle is not None:
        part.objectives.append(leans(plank.name, seesaw.angle, _room_to_tilt(plank), seesaw.words, SIGN[side]))


def _lean(side: str) -> dict[str, float]:
    return {"low": 3.0, "high": 90.0} if side == "right" else {"low": -90.0, "high": -3.0}


def _room_to_tilt(plank: PlanObject) -> float:
    """How far a seesaw tilts until its plank meets the edge of what carries it, or its end the ground [deg]."""
    half = plank.size[2] / 2
    a, b = HINGE_GAP + half, BASE_WIDTH / 2  # the edge, seen from the hinge: below it, and beside it
    edge = math.acos(half / math.hypot(a, b)) - math.atan2(b, a)
    return math.degrees(min(edge, math.asin(min(1.0, 2.0 * SEESAW_HEIGHT / plank.size[0]))))
