"""Rain into a tank, or on a thing that stands in a tray."""

from __future__ import annotations

import math

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, OpeningPlan, PlanObject, Pose, Relation
from wsim.rules.cast import Cast, Flow
from wsim.rules.contents import note_liquid
from wsim.rules.scenes.flowing import check_alone, fluid_in, tank_of
from wsim.rules.scenes.part import Part, tidy
from wsim.rules.sizes import bodies

RAIN = 5e-4  # [m/s]: 31 mm in the heaviest minute on record (Unionville, Maryland, 1956)
LASTS = 1.2  # [s]
SETTLES = 0.3  # that is shown after it [s]
TANK = (0.3, 0.24, 0.2)  # that it falls into [m]
MARGIN = 0.1  # of a tray around what stands in it [m]
RIM = 0.1  # of a tray, at least, and over what it is to hold [m]
INSIDE = 0.03  # of the walls, where no rain falls [m]
OVER = 0.15  # of the cloud above rim or thing [m]
SLOPE = 20.0  # of a roof [deg]
DROPS, MOST_DROPS, FEWEST = 500, 12_000, 20
SPACINGS = (0.0025, 0.004)  # of drops 3.1 to 5 mm wide; there are no larger ones [m]


def build_rain(cast: Cast, taken: set[str]) -> Part:
    """The tank, what stands in it, and the rain over it.

    Raises:
        UserError: Something else is in the scene, or too little or too much falls.
    """
    rain = next((flow for flow in cast.flows if flow.kind == "rain"), None)
    others = [flow for flow in cast.flows if flow is not rain]
    if rain is None:
        return Part()
    if cast.pour is not None:
        raise UserError(f"{rain.words!r}: the builtin planner lets it rain or pours a liquid, not both")
    if others:
        raise UserError(f"{others[0].words!r}: the builtin planner lets it rain, and nothing else run in or out")
    check_alone(cast, rain.on, rain.vessel)
    if rain.vessel is not None or cast.stands:
        words = rain.vessel.words if rain.vessel is not None else cast.water
        raise UserError(f"{words!r}: the builtin planner lets rain fall into an empty tank, or on a thing, not there")
    item, footprint = _on(rain, cast, taken)
    tray = item is not None or rain.ground
    size = _tray(footprint) if tray else TANK
    edges = [tidy(edge) for edge in footprint[:2]] if tray else [tidy(edge - 2 * INSIDE) for edge in size[:2]]
    spacing, rate = _drops(rain, edges[0] * edges[1], cast)
    tank = tank_of(size, cast, taken)
    what, why = "tank", "the prompt gives no size"
    if tray:
        what, why = "tray", "what falls and runs off stays in the scene"
    cast.assume(what, " x ".join(f"{edge:g}" for edge in size) + " m inside", why)
    liquid = fluid_in(tank, 0.0, cast, taken)
    part = Part(objects=[tank, liquid], spacing=spacing, surface=tidy(WALL + size[2] / 2))
    top = size[2] if item is None else max(size[2], footprint[2])
    if item is not None and rain.on is not None:
        part.objects.append(item)
        part.names[id(rain.on)] = [item.name]
    lasts = rain.lasts or LASTS
    part.openings.append(
        OpeningPlan(
            name="rain", kind="tap", fluid=liquid.name, at="tank", offset=(0.0, 0.0, tidy(top - size[2] + OVER)),
            size=(edges[0], edges[1]), rate=float(f"{rate:.6g}"), start=rain.start,
            stop=tidy((rain.start or 0.0) + lasts), drop_speed=_speed(spacing),
        )
    )  # fmt: skip
    name = cast.liquid.words[0]
    sentence = f"The {name} stays inside the {what}."
    part.objectives.append(Objective(kind="stays_inside", object=liquid.name, ref="tank", sentence=sentence))
    part.duration = round((rain.start or 0.0) + lasts + SETTLES, 1)
    cast.assume(rain.words, f"drops that fall at {_speed(spacing):g} m/s", "as fast as drops of their size fall in air")
    note_liquid(cast.liquid, cast)
    return part


def _on(rain: Flow, cast: Cast, taken: set[str]) -> tuple[PlanObject | None, tuple[float, float, float]]:
    """What it falls on, and the box round it [m]."""
    if rain.on is None:
        return None, TANK
    if rain.on.count > 1:
        raise UserError(f"{rain.on.words!r}: the builtin planner lets rain fall on one thing; give one")
    if rain.on.noun.family == "solid":
        cast.assume(rain.on.words, "held in its place", "what rain does to it is not said")
    [item] = bodies(rain.on, cast, taken)
    static = {"state": "static", "role": "background"}
    item = item.model_copy(update=static)
    if rain.on.noun.family != "roof":
        x, y = (2 * item.size[0],) * 2 if len(item.size) < 3 else item.size[:2]
        return item.related([Relation(predicate="PLACE-IN", ref="tank")]), (x, y, item.size[-1])
    x, y, z = item.size
    tilt = math.radians(SLOPE)
    wide, high = x * math.cos(tilt) + z * math.sin(tilt), x * math.sin(tilt) + z * math.cos(tilt)
    cast.assume(rain.on.words, f"a slab at {SLOPE:g} degrees over a tray", "the prompt does not say how steep")
    pose = Pose(position=(0.0, 0.0, tidy(WALL + RIM + high / 2)), rotation_deg=(0.0, SLOPE, 0.0))
    return item.model_copy(update={"pose": pose}), (tidy(wide), y, tidy(RIM + high))


def _tray(footprint: tuple[float, float, float]) -> tuple[float, float, float]:
    """Round a thing, with room for what runs off it [m]."""
    x, y, _ = footprint
    return round(x + 2 * MARGIN, 2), round(y + 2 * MARGIN, 2), RIM


def _drops(rain: Flow, area: float, cast: Cast) -> tuple[float, float]:
    """The spacing of particles, each of which is a drop [m], and how much falls [m^3/s].

    Raises:
        UserError: That is hardly a drop, or too many.
    """
    fall = rain.rate
    if fall is None:
        fall = RAIN
        cast.assume(
            rain.words, f"{3.6e6 * RAIN:g} mm an hour", "the prompt does not say how heavy; a cloudburst is seen"
        )
    lasts = rain.lasts or LASTS
    if rain.lasts is None:
        cast.assume(rain.words, f"for {LASTS:g} s", "the prompt does not say for how long")
    volume = fall * area * lasts
    spacing = min(max((volume / DROPS) ** (1 / 3), SPACINGS[0]), SPACINGS[1])
    count = volume / spacing**3
    if not FEWEST <= count <= MOST_DROPS:
        less = "little: it would be" if count < FEWEST else "much: it would be"
        raise UserError(
            f"{rain.words!r}: {3.6e6 * fall:.3g} mm an hour on {area:.3g} m^2 for {lasts:g} s is too {less} "
            f"{count:,.0f} drops; the builtin planner lets {FEWEST} to {MOST_DROPS:,} fall"
        )
    return float(f"{spacing:.2g}"), fall * area


def _speed(spacing: float) -> float:
    """How fast a drop of a particle's volume falls in air [m/s] (Atlas, Srivastava & Sekhon 1973)."""
    diameter = 1000.0 * spacing * (6.0 / math.pi) ** (1 / 3)
    return round(9.65 - 10.3 * math.exp(-0.6 * diameter), 1)
