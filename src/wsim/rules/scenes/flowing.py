"""A tank, or a vessel, that a tap fills, rain falls into or on, or that drains through a hole."""

from __future__ import annotations

import math
from dataclasses import dataclass

from wsim.defaults import FLUID_VISCOSITY, GRAVITY, WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, OpeningPlan, PlanObject, Pose, Relation
from wsim.plan.schema.formula import Always
from wsim.plan.schema.formula_fluid import LevelIn
from wsim.rules.cast import Cast, Flow
from wsim.rules.contents import note_liquid
from wsim.rules.materials import GLASS_LOOK
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.part import Part, tidy
from wsim.rules.sizes import bodies

RATE = 2e-4  # of a tap [m^3/s]
OPEN = 4.0  # for which it runs [s]
SETTLES = 1.0  # that is shown after it is shut [s]
PART = 0.37  # of the time that a tank drains for: it then is at 0.4 of its level
LATEST = 2.0  # of the same, in which all has gone out, but for what clings to the floor
SHARP = 0.6  # of its area, that the jet of a sharp hole fills
LEAST = 0.3  # of the usual tank's size, however narrow its hole
SMALL = 0.6  # of the usual tank's size, of one that is emptied
CLINGS = 1.5  # spacings of water that stay on a floor
FULL = 0.5  # of a tank's height that what comes in fills it to
TALL = 0.8  # a tank's height against the root of its area
LONG = 4 / 3  # its length against its width
PARTICLES, MOST_PARTICLES = 5000, 30_000
WALLS, LAYERS = 15_000, 2  # particles of floor and walls, about, and layers of them
MOUTH, ACROSS = 4, 6  # spacings across a mouth, and across a hole
OVER = 3.0  # spacings of a mouth above the rim, at least
MOST_SPEED = 1.5  # out of a mouth whose width the prompt leaves open [m/s]
DRAINED = (0.32, 0.24, 0.12)  # length, width and depth of a tank that drains [m]
HOLE = 0.06  # [m]
# Of its area, that a hole's jet fills: a sharp edge 0.6, a rounded one up to 1 (Idelchik, Handbook of Hydraulic
# Resistance); of particles 0.35 to 0.65 at six spacings across (docs/sph.md).
JET = (0.3, 1.0)
SAME = 0.05  # share that numbers of a prompt may differ by
LONGEST = 60.0  # [s]
AT_END = 0.2  # for which the level is looked at: it may still change [s]


@dataclass(frozen=True)
class Vat:
    """What is filled or drained.

    Attributes:
        area: Of its floor [m^2].
        height: Inside [m].
        level: At the start [m].
    """

    area: float
    height: float
    level: float


def build_flowing(cast: Cast, taken: set[str]) -> Part:
    """The vessel, what is in it and what comes in or goes out.

    Raises:
        UserError: Something else is in the scene, or more comes in than it holds.
    """
    if not cast.flows or any(flow.kind == "rain" for flow in cast.flows):
        return Part()
    if cast.pour is not None:
        raise UserError("the builtin planner pours a block of liquid or lets one run, not both; say how it comes in")
    tap = next((flow for flow in cast.flows if flow.kind == "tap"), None)
    hole = next((flow for flow in cast.flows if flow.kind == "drain"), None)
    check_alone(cast, tap.vessel if tap is not None else None)
    if tap is not None:
        _settle_tap(tap, cast)
    name = cast.liquid.words[0]
    vessel, vat = _vessel(tap, hole, cast, taken)
    spacing, widths = _spacing(tap, hole, vat, cast)
    liquid = fluid_in(vessel, tidy(vat.level), cast, taken)
    part = Part(objects=[vessel, liquid], spacing=spacing, surface=tidy(WALL + vat.level))
    if tap is not None and tap.vessel is not None:
        part.names[id(tap.vessel)] = [vessel.name]
    part.duration = _duration(tap, hole, vat, widths, cast)
    for flow in cast.flows:
        part.openings.append(_opening(flow, vessel, liquid, widths[flow.kind], spacing, cast))
    part.objectives.append(_level(tap, hole, vat, widths, part, cast))
    sentence = f"The {name} stays inside {vessel.name}" + (", but for what the hole lets out." if hole else ".")
    part.objectives.append(Objective(kind="stays_inside", object=liquid.name, ref=vessel.name, sentence=sentence))
    note_liquid(cast.liquid, cast)
    cast.assume(name, f"particles {spacing:g} m apart", "four or more across the mouth, and some thousands in all")
    return part


def check_alone(cast: Cast, *known: object) -> None:
    """Refuse what else is in the scene.

    Raises:
        UserError: Something is.
    """
    others = [thing for thing in cast.things if not any(thing is one for one in known)]
    if others:
        raise UserError(
            f"{others[0].words!r}: the builtin planner lets a liquid run into or out of a tank with nothing else in "
            "the scene; leave it out"
        )


def fluid_in(vessel: PlanObject, level: float, cast: Cast, taken: set[str]) -> PlanObject:
    """The liquid, as high as it stands at the start [m]; 0 where it is yet to come."""
    taken.add(cast.liquid.key)
    rows = [Relation(predicate="PLACE-IN", ref=vessel.name), Relation(predicate="FREE-SURFACE-AT", value=level)]
    return cast.liquid.fluid(cast.water or "", rows)


def tank_of(size: tuple[float, ...], cast: Cast, taken: set[str]) -> PlanObject:
    """A glass tank of an inner size [m]."""
    taken.add("tank")
    return PlanObject.proxy(
        name="tank", role="container", primitive="tank", size=size, material=GLASS_LOOK, state="static",
        relations=[Relation(predicate="PLACE-ON-BASE")], words=cast.tank or "",
    )  # fmt: skip


def _settle_tap(tap: Flow, cast: Cast) -> None:
    """How fast a tap runs, and for how long, where the prompt leaves it open."""
    if tap.volume is not None and tap.lasts is not None:
        if tap.rate is not None and abs(tap.rate * tap.lasts / tap.volume - 1.0) > SAME:
            raise UserError(f"{tap.words!r}: the prompt says how much it pours, how fast and for how long; keep two")
        tap.rate = tap.volume / tap.lasts
    holds = _room(tap, cast)
    if tap.rate is None:
        usual = tap.volume / OPEN if tap.volume is not None else 0.5 * holds / (tap.lasts or OPEN)
        tap.rate = float(f"{min(RATE, usual):.2g}") if usual < RATE or tap.volume is None else usual
        cast.assume(tap.words, f"{1000 * tap.rate:.3g} litres a second", "the prompt does not say how fast it runs")
    if tap.volume is not None:
        tap.lasts = tap.volume / tap.rate
    elif tap.lasts is None and tap.level is None:
        tap.lasts = float(f"{min(OPEN, 0.5 * holds / tap.rate):.2g}")
        cast.assume(tap.words, f"runs for {tap.lasts:g} s", "the prompt does not say for how long")


def _room(tap: Flow, cast: Cast) -> float:
    """How much a vessel that is no tank holds beside what is in it [m^3]; a tank is made large enough."""
    if tap.vessel is None:
        return math.inf
    x, y, z = tap.vessel.noun.size
    return x * y * (z - _standing(x * y, z, cast))


def _vessel(tap: Flow | None, hole: Flow | None, cast: Cast, taken: set[str]) -> tuple[PlanObject, Vat]:
    """What is filled or drained, and how high the liquid stands in it; of a tank as large as that asks for."""
    if tap is not None and tap.vessel is not None:
        [item] = bodies(tap.vessel, cast, taken)
        x, y, height = item.size
        vat = Vat(x * y, height, _standing(x * y, height, cast))
        item = item.model_copy(update={"pose": Pose(position=(0.0, 0.0, 0.0)), "state": "static"})
        return item, _holds(tap, vat, item.name)
    size, level = _filled_tank(tap, cast) if tap is not None else _full_tank(hole, cast)
    cast.assume("tank", " x ".join(f"{edge:g}" for edge in size) + " m inside", "the prompt gives no size")
    vat = Vat(size[0] * size[1], size[2], level)
    tank = tank_of(size, cast, taken)
    return tank, _holds(tap, vat, "tank") if tap is not None else vat


def _standing(area: float, height: float, cast: Cast) -> float:
    """How high the liquid stands at the start [m]."""
    held = cast.filled
    if cast.share is not None or not cast.stands or held is None:
        return (cast.share or 0.0) * height
    if held.share is not None:
        return held.share * height
    if held.level is not None:
        return held.level
    return held.volume / area if held.volume is not None else FULL * height / 2


def _holds(tap: Flow, vat: Vat, name: str) -> Vat:
    """The same, once it is known for how long the tap runs.

    Raises:
        UserError: It would run over, or it would take too long.
    """
    assert tap.rate is not None
    if tap.level is not None:
        more = (tap.level - vat.level) * vat.area
        if more <= 0.0:
            raise UserError(f"{tap.words!r}: what is in it stands as high as {tap.level:g} m already")
        if tap.lasts is not None and abs(tap.lasts * tap.rate - more) > 0.05 * more:
            raise UserError(f"{tap.words!r}: the prompt says for how long it runs and how high it fills; keep one")
        tap.lasts = more / tap.rate
    assert tap.lasts is not None
    if tap.lasts + (tap.start or 0.0) + SETTLES > LONGEST:
        raise UserError(
            f"{tap.words!r}: at {1000 * tap.rate:g} litres a second it runs for {tap.lasts:.3g} s; the builtin planner "
            f"shows up to {LONGEST:g} s: say less, or a faster tap"
        )
    end = vat.level + tap.rate * tap.lasts / vat.area
    if end > 0.9 * vat.height:
        raise UserError(
            f"{tap.words!r}: {1000 * tap.rate * tap.lasts:.3g} litres would run over; {name} holds "
            f"{1000 * vat.area * vat.height:.3g} litres: let less in"
        )
    return vat


def _filled_tank(tap: Flow, cast: Cast) -> tuple[tuple[float, float, float], float]:
    """A tank that what comes in, over what stands in it, fills by half [m]."""
    assert tap.rate is not None
    held = cast.filled
    stands = held if cast.stands and held is not None else None
    if tap.level is not None:
        height = tap.level / FULL
        area = (height / TALL) ** 2
    else:
        comes = tap.rate * (tap.lasts or OPEN)
        before = stands.volume if stands is not None and stands.volume is not None else 0.0
        share = cast.share or (stands.share if stands is not None else None) or 0.0
        if share == 0.0 and stands is not None and stands.volume is None and stands.level is None:
            share = FULL / 2
        top = max(FULL, share + 0.2)
        area = ((comes + before) / (TALL * (top - share))) ** (2 / 3)
        height = TALL * math.sqrt(area)
        if stands is not None and stands.level is not None:
            height = max(height, 1.5 * (stands.level + comes / area))
    size = _tank_size(area, height)
    return size, _standing(size[0] * size[1], size[2], cast)


def _tank_size(area: float, height: float) -> tuple[float, float, float]:
    width = math.sqrt(area / LONG)
    return round(LONG * width, 3), round(width, 3), round(height, 3)


def _full_tank(hole: Flow | None, cast: Cast) -> tuple[tuple[float, float, float], float]:
    """A tank that drains [m]: as much in it as is said, else so much that particles can be fine enough for the hole."""
    x, y, z = DRAINED
    held, wide = cast.filled, (hole.width if hole is not None else None) or HOLE
    if held is not None and held.volume is not None:
        grown = (held.volume / (x * y * z)) ** (1 / 3)
    elif held is not None and held.level is not None:
        grown = held.level / z
    else:
        grown = min(max(wide / HOLE, LEAST), 2.0) * (SMALL if hole is not None and hole.empties else 1.0)
    share = cast.share or (held.share if held is not None else None) or 0.7
    x, y = round(grown * x, 3), round(grown * y, 3)
    z = held.volume / (x * y) if held is not None and held.volume is not None else grown * z
    z = held.level if held is not None and held.level is not None else z
    return (x, y, round(z / share, 3)), tidy(z)


def _spacing(tap: Flow | None, hole: Flow | None, vat: Vat, cast: Cast) -> tuple[float, dict[str, float]]:
    """How far apart particles are, and how wide the mouths are, by kind [m].

    Raises:
        UserError: A mouth is so narrow that there would be too many.
    """
    comes = tap.rate * tap.lasts if tap is not None and tap.rate and tap.lasts else 0.0
    volume = vat.level * vat.area + comes
    walls = vat.area + 4.0 * math.sqrt(vat.area) * vat.height
    spacing = max((volume / PARTICLES) ** (1 / 3), math.sqrt(LAYERS * walls / WALLS))
    widths: dict[str, float] = {}
    if hole is not None:
        widths["drain"] = hole.width or min(HOLE, 0.35 * math.sqrt(vat.area))
        spacing = min(spacing, widths["drain"] / ACROSS)
    if tap is not None and tap.width is not None:
        spacing = min(spacing, tap.width / MOUTH)
    spacing = float(f"{spacing:.2g}")
    narrow = min((flow.width or math.inf for flow in (tap, hole) if flow is not None), default=math.inf)
    if volume / spacing**3 > MOST_PARTICLES:
        raise UserError(
            f"a mouth {narrow:g} m wide would need {volume / spacing**3:,.0f} particles of {cast.liquid.words[0]}; the "
            f"builtin planner uses up to {MOST_PARTICLES:,}: make it wider, or say less liquid"
        )
    if tap is not None and tap.rate is not None:
        usual = max(MOUTH * spacing, math.sqrt(4.0 * tap.rate / (math.pi * MOST_SPEED)))
        widths["tap"] = tap.width or round(usual, 4)
        if tap.width is None:
            cast.assume(tap.words, f"its mouth {widths['tap']:g} m wide", "four particles, and slower than 1.5 m/s")
    if hole is not None and hole.width is None:
        cast.assume(hole.words, f"a hole {widths['drain']:g} m wide", "the prompt does not say how wide")
    return spacing, widths


def _opening(
    flow: Flow, vessel: PlanObject, liquid: PlanObject, width: float, spacing: float, cast: Cast
) -> OpeningPlan:
    if flow.kind == "drain":
        x = vessel.size[0]
        place = (tidy(x / 2), 0.0, tidy(width / 2 + 2 * spacing)) if flow.wall else (0.0, 0.0, 0.0)
        if not flow.wall:
            cast.assume(flow.words, "in the middle of the floor", "the prompt does not say where")
        return OpeningPlan(
            name="hole", kind="drain", fluid=liquid.name, at=vessel.name, offset=place, radius=tidy(width / 2),
            direction=(1.0, 0.0, 0.0) if flow.wall else None,
        )  # fmt: skip
    height = flow.height
    if height is None:
        height = round(OVER * spacing, 3)
        cast.assume(flow.words, f"{height:g} m above the rim", "the prompt gives no height")
    elif not 0.0 < height <= 2.0:
        raise UserError(f"{flow.words!r}: {height:g} m above the rim is not above 0 and up to 2 m")
    start = flow.start or 0.0
    return OpeningPlan(
        name="tap", kind="tap", fluid=liquid.name, at=vessel.name, offset=(0.0, 0.0, height), radius=tidy(width / 2),
        rate=float(f"{flow.rate:.6g}"), start=flow.start, stop=tidy(start + (flow.lasts or OPEN)),
    )  # fmt: skip


def _duration(tap: Flow | None, hole: Flow | None, vat: Vat, widths: dict[str, float], cast: Cast) -> float:
    if tap is not None:
        return round((tap.start or 0.0) + (tap.lasts or OPEN) + SETTLES, 1)
    assert hole is not None
    head = vat.level - (widths["drain"] if hole.wall else 0.0)
    whole = vat.area / (SHARP * math.pi / 4 * widths["drain"] ** 2) * math.sqrt(2 * max(head, 0.0) / GRAVITY)
    if hole.empties:
        if hole.wall or cast.duration is not None:
            raise UserError(f"{hole.words!r}: the builtin planner empties a tank through its floor, in its own time")
        return round(LATEST * whole, 1)
    shown = round(min(max(PART * whole, 1.0), LONGEST), 1)
    if cast.duration is None:
        cast.assume(hole.words, f"its first {shown:g} s", f"by Torricelli it runs for about {whole:.3g} s")
    return shown


def _level(
    tap: Flow | None, hole: Flow | None, vat: Vat, widths: dict[str, float], part: Part, cast: Cast
) -> Objective:
    """How high it stands in the end, by the mass that came and Torricelli's outflow."""
    end = cast.duration if cast.duration is not None else part.duration
    vessel, name = part.objects[0].name, cast.liquid.words[0]
    if hole is not None and hole.empties:
        stays = tidy(CLINGS * part.spacing / 2)
        sentence = f"The {name} is gone in the end, but for {2 * stays:.2g} m on the floor of {vessel}."
        gone = LevelIn(fluid=part.objects[1].name, ref=vessel, level=stays, within=stays)
        return asked(part.objects[1].name, sentence, Always(window=(tidy(end - AT_END), end), of=gone))
    shares = _jet(widths["drain"], vat, cast) if hole is not None else JET[:1]
    ends = [_stands(tap, hole, vat, widths, share, end) for share in shares]
    level = max(sum(ends) / len(ends), 1e-4)
    within = tidy(abs(ends[0] - ends[-1]) / 2 + part.spacing / 2)
    sentence = f"The {name} stands {level:.3g} m high in {vessel} in the end, to {within:.2g} m."
    stands = LevelIn(fluid=part.objects[1].name, ref=vessel, level=tidy(level), within=within)
    formula = Always(window=(tidy(end - min(AT_END, 0.2 * end)), end), of=stands)
    return asked(part.objects[1].name, sentence, formula)


def _jet(width: float, vat: Vat, cast: Cast) -> tuple[float, float]:
    """The share of a hole's area that its jet fills, at least and at most.

    Of what is thick it goes with the root of Reynolds' number, by 0.2 (Merritt, Hydraulic Control Systems, 1967).
    """
    liquid = cast.liquid
    speed = math.sqrt(2.0 * GRAVITY * max(vat.level, 0.01))
    reynolds = speed * width * liquid.material.density / (liquid.viscosity or FLUID_VISCOSITY)
    return min(JET[0], 0.1 * math.sqrt(reynolds)), JET[1]


def _stands(tap: Flow | None, hole: Flow | None, vat: Vat, widths: dict[str, float], share: float, end: float) -> float:
    """The level after a time [m]: dh/dt = (rate - share * area * sqrt(2 g h)) / A."""
    level, steps = vat.level, 400
    area = share * math.pi / 4 * widths["drain"] ** 2 if hole is not None else 0.0
    over = widths["drain"] if hole is not None and hole.wall else 0.0
    for k in range(steps):
        time = end * (k + 0.5) / steps
        start = (tap.start or 0.0) if tap is not None else 0.0
        runs = tap is not None and start <= time < start + (tap.lasts or OPEN)
        comes = tap.rate if runs and tap is not None and tap.rate is not None else 0.0
        goes = area * math.sqrt(2.0 * GRAVITY * max(level - over, 0.0))
        level = max(level + (comes - goes) / vat.area * end / steps, 0.0)
    return level
