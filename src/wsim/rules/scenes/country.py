"""Country that a vehicle drives through: ground of layers along a way, rocks and trees beside it, and views of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from wsim.defaults import FIELD_OF_VIEW
from wsim.plan.schema import (
    AreaPlan,
    CameraPlan,
    Clearance,
    FromScatter,
    FromTerrain,
    HillLayer,
    LevelLayer,
    Material,
    NoiseLayer,
    PlanObject,
    RoadLayer,
    Vec3,
)
from wsim.rules.cast import Cast, Thing

Way = list[tuple[float, float]]

BESIDE, BEYOND = 20.0, 20.0  # of its way to each side, and beyond its ends, that there is ground [m]
ROUGH = NoiseLayer(amplitude=0.6, wavelength=16.0, octaves=4, seed=4)
GENTLE = NoiseLayer(amplitude=0.8, wavelength=40.0, octaves=2, seed=4)  # beside a road
HILL_AT, HILL, STEEPEST = 0.6, 2.5, 15.0  # where along a way, how high [m], and how steep at most [deg]
TRACK, ROAD = 1.5, 2.5  # of its wheels' outer width: how wide a track and a road are
EVEN = 1.0  # beyond what stands on it, that ground is level at both ends [m]
CLEAR_ROCKS, CLEAR_TREES, CLEAR_ENDS = 1.2, 2.0, 3.0  # beside what drives, and beyond it at both ends [m]
A_ROCK_PER, A_TREE_PER = 1.6, 4.0  # metres of way, where the prompt gives no number
MOST = 60
BEHIND, SHORT = 2.2, 3.6  # of its length, and of no less [m]: how far behind a vehicle the camera is that follows it
LONG, ASIDE = 40.0, 8.0  # a way that is seen by halves, and what is seen beyond its ends [m]
_SOIL = Material(name="soil", density=1600.0, friction=0.85, color=(0.15, 0.22, 0.08))
_MUD = Material(name="track", density=1600.0, friction=0.85, rolling=0.03, color=(0.27, 0.19, 0.11))
_ASPHALT = Material(name="asphalt", density=2300.0, friction=0.9, color=(0.09, 0.09, 0.1))
_STONE = Material(name="rock", density=2600.0, friction=0.7, color=(0.33, 0.31, 0.28))


@dataclass
class Country:
    """Ground, and what is scattered on it."""

    land: PlanObject
    scattered: list[PlanObject] = field(default_factory=list)


def hill_on(way: Way) -> tuple[float, float]:
    """Where a hill's top is: on the way's point that is nearest to `HILL_AT` of it."""
    if len(way) > 2:
        return way[round(HILL_AT * (len(way) - 1))]
    (ax, ay), (bx, by) = way
    return round(ax + HILL_AT * (bx - ax), 3), round(ay + HILL_AT * (by - ay), 3)


def land(way: Way, *, rough: bool, hill: bool, road: bool, width: float, length: float, words: str) -> PlanObject:
    """Ground along a way, level at both ends, where a vehicle of a width and length [m] starts and stops."""
    layers: list[NoiseLayer | HillLayer | LevelLayer | RoadLayer] = []
    layers += [ROUGH] if rough else [GENTLE] if road else []
    if hill:
        radius = 0.5 * math.pi * HILL / math.tan(math.radians(STEEPEST))
        layers.append(HillLayer(position=hill_on(way), radius=math.ceil(radius), height=HILL))
    layers += [LevelLayer(position=at, radius=round(0.5 * length + EVEN, 1)) for at in (way[0], way[-1])]
    line = _prolonged(way, length)
    wide = round((ROAD if road else TRACK) * width, 1)
    if road:
        layers.append(RoadLayer(points=line, width=wide))
    area = AreaPlan(name="road" if road else "track", points=line, width=wide, material=_ASPHALT if road else _MUD)
    extent = (2.0 * (max(abs(x) for x, _ in way) + BEYOND), 2.0 * BESIDE)
    return PlanObject(
        name="ground", role="terrain", state="static", material=_SOIL, words=words,
        construction=FromTerrain(extent=(math.ceil(extent[0]), extent[1]), layers=layers, areas=[area]),
    )  # fmt: skip


def _prolonged(way: Way, by: float) -> tuple[tuple[float, float], ...]:
    """A way that goes on straight at both ends, so that all of what stands there is on it."""

    def beyond(end: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
        share = by / math.dist(end, other)
        return round(end[0] + share * (end[0] - other[0]), 3), round(end[1] + share * (end[1] - other[1]), 3)

    return (beyond(way[0], way[1]), *way, beyond(way[-1], way[-2]))


def scattered(
    way: Way, rocks: list[Thing], trees: list[Thing], width: float, distance: float, cast: Cast
) -> list[PlanObject]:  # fmt: skip
    """Rocks and trees beside a way, in the order of these."""
    made = []
    for what, things, per, by in (
        ("rock", rocks, A_ROCK_PER, CLEAR_ROCKS), ("tree", trees, A_TREE_PER, CLEAR_TREES)
    ):  # fmt: skip
        for k, thing in enumerate(things):
            count = thing.phrase.count or (min(MOST, max(3, round(distance / per))) if thing.phrase.plural else 1)
            if thing.phrase.count is None and thing.phrase.plural:
                cast.assume(thing.words, f"{count} of them beside its way", "the prompt gives no number")
            kept = [Clearance(points=tuple(way), by=round(0.5 * width + by, 2))]
            kept += [Clearance(points=(at,), by=CLEAR_ENDS + width) for at in (way[0], way[-1])]
            size = (0.8, 1.6) if thing.noun.asset == "boulder" else (0.3, 1.2)
            seed = (2 if what == "rock" else 5) + 10 * k
            construction = FromScatter(
                what=_of(thing, what), on="ground", count=count, clear=kept, size=size, seed=seed
            )  # fmt: skip
            made.append(PlanObject(
                name=what if k == 0 else f"{what}s_{k + 1}", role="background", state="static", words=thing.words,
                construction=construction, material=_STONE if what == "rock" else None,
            ))  # fmt: skip
    return made


def _of(thing: Thing, what: str) -> tuple[str, ...]:
    if what == "rock":
        return ("rocks",)
    asset = thing.noun.asset or ""
    return ("conifer", "deciduous_tree") if asset == "deciduous_tree" else (asset,)


def views(way: Way, vehicle: str, start: Vec3, length: float) -> list[CameraPlan]:
    """From behind a vehicle of a length [m] that it follows; from the side, of a long way each half besides; its start.

    The first one films the vehicle, as large at the end as where it starts [m].
    """
    (x, y, z), size = start, max(length, SHORT)
    behind = (round(x - BEHIND * size, 2), round(y - 0.5 * size, 2), round(z + 1.1 * size, 2))
    follow = CameraPlan(name="follow", eye=behind, target=(round(x, 2), y, round(z + 0.8, 2)), follows=vehicle)
    (ax, ay), (bx, _) = way[0], way[-1]
    between = 0.5 * (ax + bx)
    spans = [("side", ax, bx)]
    if bx - ax > LONG:
        spans += [("first_half", ax, between), ("second_half", between, bx)]
    sides = []
    for name, begin, end in spans:
        middle = round(0.5 * (begin + end), 2)
        back = (0.5 * (end - begin) + ASIDE) / math.tan(math.radians(FIELD_OF_VIEW / 2))
        eye = (middle, round(-0.88 * back, 2), round(0.47 * back, 2))
        sides.append(CameraPlan(name=name, eye=eye, target=(middle, 0.0, 0.0)))
    at_start = CameraPlan(name="start", eye=(ax - 9.0, ay - 5.0, 4.0), target=(ax + 12.0, ay, 1.0))
    return [follow, *sides, at_start]
