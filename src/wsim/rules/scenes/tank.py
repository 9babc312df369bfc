"""A tank of water and what is in it: resolution, sizes, start heights, objectives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.layout import extents
from wsim.plan.schema import Material, Objective, PlanObject, Relation
from wsim.rules.cast import Cast, Thing
from wsim.rules.contents import note_liquid
from wsim.rules.liquids import Liquid
from wsim.rules.materials import GLASS_LOOK
from wsim.rules.scenes.part import Part, tidy
from wsim.rules.sizes import bodies, thickness

LAYERS_FLOATING = 4.5  # particle spacings in the height of what floats, at least
LAYERS_SINKING = 4.0  # and in what sinks
LAYERS_DRAFT = 1.2  # and in the expected draft
LAYERS_DEPTH = 4.6  # and in the tallest thing, so that the water is ten or so deep
GAP_SPACINGS = 3.2  # between neighbours and to the walls: the kernels of two bodies then do not overlap
LEVEL_HEIGHTS = 2.1  # water depth against the tallest thing
DEPTH_WIDTHS = 2.5  # tank's extent along Y against the widest thing
FREEBOARD_SPACINGS = 4.0
START_GAP = 0.005  # a floating thing starts this far above the water, so that it settles gently [m]
SINK_GAP = 0.01  # and one that sinks without being dropped [m]
DROP_HEIGHT = 0.15  # [m]
MOST_PARTICLES = 40_000
DURATION = 3.5  # [s], for things 0.14 m tall


@dataclass
class Swimmer:
    """A thing in the water, and one plan object of it."""

    thing: Thing
    item: PlanObject
    end: Literal["floats", "sinks", "submerged"]  # what is to become of it
    relation: Relation  # how it starts


def build_tank(cast: Cast, taken: set[str]) -> Part:
    """The tank, its water and the things in it, in one row along X.

    Raises:
        UserError: more things than one tank holds.
    """
    taken |= {"tank", cast.liquid.key}
    swimmers = [one for thing in cast.things if thing.place == "water" for one in _swimmers(thing, cast, taken)]
    spacing, inner, level = _dimensions(swimmers, cast)
    tank = PlanObject.proxy(
        name="tank",
        role="container",
        primitive="tank",
        size=inner,
        material=GLASS_LOOK,
        state="static",
        relations=[Relation(predicate="PLACE-ON-BASE")],
        words=cast.tank or "",
    )
    rows = [Relation(predicate="PLACE-IN", ref="tank"), Relation(predicate="FREE-SURFACE-AT", value=level)]
    water = cast.liquid.fluid(cast.water or "", rows)
    objects, what = [tank, water], cast.liquid.words[0]
    gap = round(GAP_SPACINGS * spacing, 6)
    for left, swimmer in zip([None, *_row(swimmers)], _row(swimmers), strict=False):
        relations = [swimmer.relation]
        if left is not None:
            relations.append(Relation(predicate="FRONT-OF", ref=left.item.name, gap=gap))
        objects.append(swimmer.item.related(relations + swimmer.item.relations))
    objectives = [_objective(swimmer, cast.liquid) for swimmer in swimmers]
    objectives.append(
        Objective(kind="stays_inside", object=water.name, ref="tank", sentence=f"The {what} stays inside the tank.")
    )
    tallest = max((extents(s.item, _lying(s.item))[2] for s in swimmers), default=0.14)
    duration = math.ceil(2 * DURATION * max(1.0, math.sqrt(tallest / 0.14))) / 2
    found = {id(one.thing): [other.item.name for other in swimmers if other.thing is one.thing] for one in swimmers}
    return Part(
        names=found,
        objects=objects,
        objectives=objectives,
        duration=duration,
        spacing=spacing,
        surface=round(WALL + level, 6),
    )


def _lying(item: PlanObject) -> tuple[float, float, float]:
    return (90.0, 0.0, 0.0) if item.relation("LIES-ALONG-Y") is not None else (0.0, 0.0, 0.0)


def _swimmers(thing: Thing, cast: Cast, taken: set[str]) -> list[Swimmer]:
    items = bodies(thing, cast, taken)
    assert items[0].material is not None
    end = _end(thing, items[0].material, items[0].density or cast.liquid.material.density, cast)
    start = _start(thing, end, cast)
    return [Swimmer(thing, item, end, start) for item in items]


def _end(thing: Thing, material: Material, density: float, cast: Cast) -> Literal["floats", "sinks", "submerged"]:
    """What was asked for, even if it cannot happen; the material decides where nothing was."""
    liquid = cast.liquid.material.density
    ratio = f"{material.name}, {density:g} kg/m^3, in {cast.liquid.words[0]} of {liquid:g} kg/m^3"
    light = density < liquid
    if "float" in thing.does:
        if not light:
            cast.assume(
                thing.words, f"warning: {ratio} sinks", "the plan asks for what the prompt says; the judge will not"
            )
        return "floats"
    if "sink" in thing.does or "submerge" in thing.does:
        if light:
            cast.assume(
                thing.words, f"warning: {ratio} floats", "the plan asks for what the prompt says; the judge will not"
            )
        return "sinks" if "sink" in thing.does else "submerged"
    end = "float" if light else "sink"
    cast.assume(thing.words, f"expected to {end}", f"{ratio}; the prompt does not say", "end", end)
    return "floats" if light else "sinks"


def _start(thing: Thing, end: str, cast: Cast) -> Relation:
    if "drop" in thing.does:
        height = cast.drop_height(thing, DROP_HEIGHT, f"the {cast.liquid.words[0]}")
        return Relation(predicate="SPAWNED-ABOVE", ref=cast.liquid.key, value=height)
    if end == "floats":
        return Relation(predicate="FLOATS-AT-SURFACE", ref=cast.liquid.key, gap=START_GAP)
    cast.assume(thing.words, f"let go {SINK_GAP:g} m above the surface", "the prompt does not say where it comes from")
    return Relation(predicate="SPAWNED-ABOVE", ref=cast.liquid.key, value=SINK_GAP)


def _row(swimmers: list[Swimmer]) -> list[Swimmer]:
    """From back to front: what drops in comes down in the middle of what floats."""
    resting = [s for s in swimmers if s.relation.predicate == "FLOATS-AT-SURFACE"]
    dropped = [s for s in swimmers if s.relation.predicate != "FLOATS-AT-SURFACE"]
    middle = (len(resting) + 1) // 2
    return resting[:middle] + dropped + resting[middle:]


def _dimensions(swimmers: list[Swimmer], cast: Cast) -> tuple[float, tuple[float, float, float], float]:
    """Particle spacing, the tank's inner size and the liquid's level [m]: whole numbers of spacings."""
    boxes = [extents(s.item, _lying(s.item)) for s in swimmers] or [_empty(cast)]
    wanted = _spacing(swimmers, max(box[2] for box in boxes), cast.liquid)
    spacing, name = wanted, cast.liquid.words[0]
    while True:
        length, depth, level = _basin(boxes, spacing, cast)
        count = length * depth * level / spacing**3
        if count <= MOST_PARTICLES:
            break
        spacing = round(spacing * 1.1, 4)
    if spacing > 1.5 * wanted:
        named = ", ".join(dict.fromkeys(repr(swimmer.thing.words) for swimmer in swimmers)) or repr(cast.water)
        raise UserError(
            f"the tank for {named} would need {round(length * depth * level / wanted**3):,} particles of {name}; "
            f"the builtin planner uses up to {MOST_PARTICLES:,}: ask for fewer things, or sizes closer to each other"
        )
    if spacing > wanted:
        cast.assume(name, f"particles {spacing:g} m apart", f"{wanted:g} m would take more than {MOST_PARTICLES:,}")
    # Everything that is heavier than its draft allows counts as fully under water: the rise is then an upper bound.
    rise = sum((s.item.volume or 0.0) * min(1.0, _ratio(s.item, cast.liquid)) for s in swimmers) / (length * depth)
    free = rise + FREEBOARD_SPACINGS * spacing
    if cast.share:
        level = max(level, _up(free * cast.share / (1.0 - cast.share), spacing))
        height = tidy(level / cast.share)
    else:
        height = round(math.ceil((level + free) / 0.05 - 1e-9) * 0.05, 6)
    inner = (length, depth, height)
    _check_afloat(swimmers, level, cast)
    _note(inner, level, cast)
    count = length * depth * level / spacing**3
    cast.assume(name, f"about {round(count):,} particles, {spacing:g} m apart", "enough layers in the thinnest thing")
    return spacing, inner, level


def _empty(cast: Cast) -> tuple[float, float, float]:
    """The box of nothing, round which a tank is as large as what it is said to hold asks for [m]."""
    held = cast.filled
    x, y, z = (0.2, 0.2, 0.14)
    if held is not None and held.volume is not None:
        length, depth, level = _basin([(x, y, z)], 1e-4, Cast())
        grown = (held.volume / (length * depth * level)) ** (1 / 3)
    else:
        grown = held.level / (LEVEL_HEIGHTS * z) if held is not None and held.level is not None else 1.0
    return x * grown, y * grown, z * grown


def _basin(boxes: list[tuple[float, float, float]], spacing: float, cast: Cast) -> tuple[float, float, float]:
    """A tank's length and width, and the level in it [m], for what is in it and as much as is said to be.

    Raises:
        UserError: That is too little.
    """
    gap = GAP_SPACINGS * spacing
    depth = _up(DEPTH_WIDTHS * max(box[1] for box in boxes), spacing)
    length = _up(max(sum(box[0] for box in boxes) + gap * (len(boxes) + 1), 1.2 * depth), spacing)
    level = _up(LEVEL_HEIGHTS * max(box[2] for box in boxes), spacing)
    held = cast.filled
    if held is not None and held.level is not None:
        level = tidy(held.level)
    if held is None or held.volume is None:
        return length, depth, level
    least = length * depth * max(box[2] for box in boxes)
    if held.volume < 0.9 * least:
        raise UserError(
            f"{cast.water!r}: {1000 * held.volume:g} litres are too little in a tank for what is in it; it takes "
            f"{1000 * least:.3g} or more"
        )
    grown = math.sqrt(max(1.0, held.volume / (length * depth * level)))
    depth, level = _up(depth * grown, spacing), min(level, _up(held.volume / (length * depth), spacing))
    return round(held.volume / (depth * level) / spacing) * spacing, depth, level


def _check_afloat(swimmers: list[Swimmer], level: float, cast: Cast) -> None:
    """Refuse what would stand on the floor in so little of the liquid.

    Raises:
        UserError: Something would.
    """
    for one in swimmers:
        draft = extents(one.item, _lying(one.item))[2] * min(1.0, _ratio(one.item, cast.liquid))
        if one.end == "floats" and draft > 0.9 * level:
            raise UserError(
                f"{one.thing.words!r}: it draws {draft:.3g} m, and would stand on the floor of {level:g} m of "
                f"{cast.liquid.words[0]}; give more"
            )


def _note(inner: tuple[float, float, float], level: float, cast: Cast) -> None:
    """What was left open of a tank and what is in it."""
    liquid, name, held = cast.liquid, cast.liquid.words[0], cast.filled
    said = held is not None and (held.level is not None or held.volume is not None)
    fits = "the prompt gives no size; it fits the things"
    cast.assume("tank", f"{inner[0]:g} x {inner[1]:g} x {inner[2]:g} m inside", fits)
    if not said:
        cast.assume(name, f"{level:g} m deep", f"{LEVEL_HEIGHTS:g} times the tallest thing")
    if cast.water is None:
        cast.assume("tank", "holds water", "the prompt names a tank, or what floats or sinks, but no water")
    if cast.tank is None:
        cast.assume(name, "in a glass tank", "the prompt names no vessel")
    note_liquid(liquid, cast)


def _spacing(swimmers: list[Swimmer], tallest: float, liquid: Liquid) -> float:
    limits = [tallest / LAYERS_DEPTH]
    for swimmer in swimmers:
        across = thickness(swimmer.item)
        if swimmer.end == "floats":
            limits += [across / LAYERS_FLOATING, _ratio(swimmer.item, liquid) * across / LAYERS_DRAFT]
        else:
            limits.append(across / LAYERS_SINKING)
    return math.floor(min(limits) * 1000 + 1e-6) / 1000 or 0.001


def _ratio(item: PlanObject, liquid: Liquid) -> float:
    return (item.density or liquid.material.density) / liquid.material.density


def _up(length: float, spacing: float) -> float:
    """A length, up to the next whole number of spacings."""
    return round(math.ceil(length / spacing - 1e-6) * spacing, 6)


def _objective(swimmer: Swimmer, liquid: Liquid) -> Objective:
    name, what = swimmer.item.name, liquid.words[0]
    if swimmer.end == "floats":
        return Objective(kind="floats", object=name, ref=liquid.key, sentence=f"{name} floats on the {what}.")
    if swimmer.end == "submerged":
        return Objective(kind="submerged", object=name, ref=liquid.key, sentence=f"{name} is under {what}.")
    return Objective(kind="rests_on", object=name, ref="tank", sentence=f"{name} sinks and rests on the tank's floor.")
