"""A vehicle drives from a dock over a block that floats, waits on its middle, and drives on to the other dock.

Archimedes says how far the block goes down, its metacentre how far it leans as the rear axle comes over its end, and
both how thick it has to be. Held by nothing but the aprons of the docks, it goes up and down freely.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, get_args

from wsim.defaults import FIELD_OF_VIEW, FLUID_DENSITY
from wsim.errors import UserError
from wsim.plan.layout.drives import drive_time
from wsim.plan.schema import (
    Actuation,
    CameraPlan,
    Contact,
    FromVehicle,
    Material,
    Objective,
    PlanObject,
    Pose,
    Registration,
    Relation,
)
from wsim.plan.schema.constructions import VehicleKind
from wsim.plan.schema.formula import Mean
from wsim.plan.schema.formula_place import GoneBetween, Reaches, StaysWithin, TiltBetween, Upright
from wsim.plan.schema.nodes import Eventually, Finally, Then
from wsim.rules.cast import Cast, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.materials import GLASS_LOOK, material_named
from wsim.rules.scenes.afloat import APRON, GAP, THINNEST, Block, Site, carries, site_of
from wsim.rules.scenes.part import Part, tidy
from wsim.rules.tokens import NotUnderstood

if TYPE_CHECKING:
    from wsim.scene.vehicle_spec import VehicleSpec

FAMILIES = ("dock", "pontoon")
DOCKS = 2
LOWEST = 0.05  # [m] that a block may be under the docks, for wheels to come up again
LONG, WIDE = 1.25, 1.65  # of the vehicle's length and width: the block's
SPEED, LEAST_SPEED, MOST_SPEED = 1.5, 0.5, 2.0  # [m/s]: usual, and what the prompt may give
SWINGS, ARRIVES, RECOVERS = 2.0, 0.5, 3.5  # its mean is over two swings, after a while; and to come to rest [s]
CLOSE, HOME, SINKS, BACK = 0.15, 0.1, 0.1, 0.15  # [m], [m], of the way down, of a spacing
LEANS, LEVELS, MOST_LEAN = 0.5, 3.0, 15.0  # of the lean at rest, at the end [deg], and at any time [deg]
FRAME_RATE = 20.0  # [1/s]
_FOAM = Material(name="foam", density=250.0, friction=0.9, color=(0.85, 0.62, 0.03))
_CONCRETE = Material(name="concrete", density=2400.0, friction=0.9, color=(0.45, 0.44, 0.42))
_FENDER = 0.1  # friction of the block on the aprons


def build_crossing(cast: Cast, taken: set[str]) -> Part:
    """The docks, the basin with the block between them, and the vehicle on its way.

    Raises:
        NotUnderstood: There is a dock or a floating block, and no vehicle that crosses it.
        UserError: More is to be in it, the block is to be what it cannot be, or there is too little time.
    """
    known = cast.family(*FAMILIES)
    if not known:
        return Part()
    thing, over = _asked(cast, known)
    kind = next(each for each in get_args(VehicleKind) if each == thing.noun.key)
    speed = SPEED if thing.speed is None else thing.speed
    if not LEAST_SPEED <= speed <= MOST_SPEED:
        raise UserError(f"{speed:g} m/s is outside {LEAST_SPEED:g} to {MOST_SPEED:g} m/s, at which vehicles cross")
    from wsim.scene.vehicle_spec import preset  # with USD, and few prompts speak of vehicles

    site = site_of(_block(over, preset(kind), cast), over.words, over.phrase.edges is not None)
    route, waits, arrives = _way(site, kind, speed)
    duration = float(math.ceil(_takes(site, kind, speed, route, waits) + RECOVERS))
    if cast.duration is not None and cast.duration < duration:
        raise UserError(f"{cast.duration:g} s are too short to cross, wait and come to rest; give it {duration:g} s")
    objects = [*_built(site, cast, over), _vehicle(site, kind, route, waits, speed, thing)]
    taken |= {item.name for item in objects}
    _assume(cast, thing, over, site, waits[0])
    fenders = [Contact(object="block", ref=f"apron_{end}", friction=_FENDER) for end in ("near", "far")]
    return Part(
        objects=objects, contacts=fenders, objectives=_objectives(site, kind, arrives, waits[0]), duration=duration,
        frame_rate=FRAME_RATE, spacing=site.spacing, cameras=_views(site),
        names={id(each): ["block" if each is over else "dock_near"] for each in known} | {id(thing): [kind]},
    )  # fmt: skip


def _asked(cast: Cast, known: list[Thing]) -> tuple[Thing, Thing]:
    """The vehicle, and the block that it crosses."""
    crossing = [thing for thing in cast.family("vehicle") if "cross" in thing.does]
    over = [thing for thing in known if thing.noun.family == "pontoon"]
    if not crossing or not over:
        raise NotUnderstood(
            [known[0].words], "lets a vehicle cross a floating block between two docks, and needs both:"
        )
    vehicle, block = crossing[0], over[0]
    several = [thing for thing in (*crossing[1:], *over[1:]) if thing is not vehicle] + [
        thing for thing in (vehicle, block) if thing.count > 1
    ]
    docks = [thing for thing in known if thing.noun.family == "dock"]
    if sum(thing.count for thing in docks) > DOCKS:
        several.append(docks[-1])
    others = several + [thing for thing in cast.things if thing not in (vehicle, *known)]
    if others or cast.pour is not None:
        what = others[0].words if others else "what is poured"
        raise UserError(f"{what!r}: the builtin planner lets a vehicle cross one block between two docks; leave it out")
    for thing in (vehicle, *known):
        said = thing.phrase
        own = (
            (said.material, said.color, said.scale, said.length, said.measures, said.edges)
            if thing is not block
            else ()
        )
        placed = (thing.beside, thing.support, thing.inside, thing.target, thing.way, thing.drop_height)
        if any(own) or any(placed):
            raise UserError(
                f"{thing.words!r}: one vehicle crosses as it was made, from one dock to another that fit it"
            )
    return vehicle, block


def _block(over: Thing, spec: VehicleSpec, cast: Cast) -> Block:
    """As the prompt has it; as thick as it has to be, where that is open."""
    said = over.phrase
    material = _FOAM if said.material is None else material_named(said.material)
    if "density" in said.measures:
        material = material.model_copy(update={"name": "block_material", "density": said.measures["density"]})
    if said.color is not None:
        material = material.model_copy(update={"name": f"{said.color}_block", "color": lexicon().colors[said.color]})
    if material.density >= FLUID_DENSITY:
        raise UserError(f"{over.words!r}: of {material.density:g} kg/m^3 it does not float; give a lower density")
    length, width = round(LONG * spec.length, 1), round(WIDE * spec.width, 1)
    unknown = set(said.measures) - {"density", "z"}
    if unknown or said.scale is not None or said.length is not None:
        raise UserError(f"{over.words!r}: give the block a density, a thickness, or all of its edges")
    if min((*(said.edges or ()), *said.measures.values()), default=1.0) <= 0.0:
        raise UserError(f"{over.words!r}: its edges and its density are more than 0")
    if said.edges is not None:
        given = Block(said.edges, material, spec)
    elif "z" in said.measures:
        given = Block((length, width, said.measures["z"]), material, spec)
    else:
        return carries(Block((length, width, THINNEST), material, spec), over.words, material)
    _check_carries(given, over.words)
    if given.free < 0.0:
        better = carries(given, over.words, _FOAM)
        cast.assume(
            over.words, f"warning: {given.size[2]:g} m of {material.density:g} kg/m^3 go under the axle over an end",
            f"{given.free:.2g} m would stay above the water; {better.size[2]:g} m of "
            f"{better.material.density:g} kg/m^3 would carry it, {better.free:.2g} m above the water",
        )  # fmt: skip
    return given


def _check_carries(block: Block, words: str) -> None:
    """Whether a vehicle can stand on it at all, and it stays upright under that."""
    (length, width, _), spec = block.size, block.spec
    least = (spec.wheelbase + 2 * spec.wheel_radius, spec.track + spec.wheel_width + 2 * GAP)
    if length < least[0] or width < least[1]:
        raise UserError(f"{words!r}: the vehicle needs {least[0]:.2g} x {least[1]:.2g} m to stand on; give it more")
    upright = min(block.metacentric(length), block.metacentric(width))
    if upright <= 0.0 or math.degrees(block.lean) > MOST_LEAN:
        raise UserError(
            f"{words!r}: it turns over under {spec.mass:g} kg: its metacentre is {upright:.2g} m above the centre of "
            f"mass, and it leans by {math.degrees(block.lean):.0f} deg; make it wider, longer, or less thick"
        )


def _way(site: Site, kind: str, speed: float) -> tuple[tuple[tuple[float, float], ...], tuple[float, ...], float]:
    """Points that it comes to, how long it waits there [s], and when it comes to the first [s]."""
    route = ((tidy(round(_middle(site.block.spec), 3)), 0.0), (tidy(site.stands), 0.0))
    arrives = _takes(site, kind, speed, route[:1], ())
    wait = math.ceil(2.0 * (ARRIVES + SWINGS * site.block.period)) / 2.0
    return route, (wait, 0.0), arrives


def _middle(spec: VehicleSpec) -> float:
    """Where the point between its axles is as its weight is over x = 0 [m]."""
    return (0.5 - spec.front_share) * spec.wheelbase


def _takes(
    site: Site, kind: str, speed: float, route: tuple[tuple[float, float], ...], waits: tuple[float, ...]
) -> float:  # fmt: skip
    return drive_time(kind, [(-site.stands, 0.0), *route], speed, waits=waits)


def _built(site: Site, cast: Cast, over: Thing) -> list[PlanObject]:
    """All that stands still or floats."""
    height, inner_y = site.block.size[2], site.inner[1]
    basin = PlanObject.proxy(
        name="basin", role="container", primitive="tank", size=site.inner, material=GLASS_LOOK,
        state="static", pose=Pose(position=(0.0, 0.0, 0.0)), words=cast.tank or "",
    )  # fmt: skip
    rows = [Relation(predicate="PLACE-IN", ref="basin"), Relation(predicate="FREE-SURFACE-AT", value=site.level)]
    if cast.liquid.key != "water":
        raise UserError(f"{cast.water!r}: the builtin planner lets vehicles cross water; leave the other liquid out")
    water = cast.liquid.fluid(cast.water or "", rows).model_copy(
        update={"registration": Registration(spacing=site.spacing)}
    )
    block = PlanObject.proxy(
        name="block", role="rigid_body", primitive="box", size=site.block.size, material=site.block.material,
        pose=Pose(position=(0.0, 0.0, tidy(site.bottom + height / 2))), words=over.words,
    )  # fmt: skip
    wide = tidy(inner_y - 1.0)
    found = [basin, water, block]
    for end, side in (("near", -1.0), ("far", 1.0)):
        for name, size, x, z in (
            (f"dock_{end}", (site.dock, wide, site.top), site.wall + site.dock / 2, site.top / 2),
            (f"apron_{end}", (site.wall - site.edge, wide, APRON), (site.wall + site.edge) / 2, site.top - APRON / 2),
        ):
            found.append(PlanObject.proxy(
                name=name, role="background", primitive="box", size=tuple(tidy(edge) for edge in size),
                material=_CONCRETE, state="static", pose=Pose(position=(tidy(side * x), 0.0, tidy(z))),
            ))  # fmt: skip
    return found


def _vehicle(
    site: Site, kind: VehicleKind, route: tuple[tuple[float, float], ...], waits: tuple[float, ...], speed: float,
    thing: Thing,
) -> PlanObject:  # fmt: skip
    drive = Actuation(kind="driver", route=route, speed=speed, waits=waits[:1])
    return PlanObject(
        name=kind, role="vehicle", construction=FromVehicle(vehicle=kind), words=thing.words,
        pose=Pose(position=(-site.stands, 0.0, site.top)), registration=Registration(actuation=[drive]),
    )  # fmt: skip


def _objectives(site: Site, kind: str, arrives: float, wait: float) -> list[Objective]:
    """It crosses; the block goes down by what the load says, leans to both docks and comes up again; water stays."""
    top, sinks, lean = site.top, site.sinks, round(LEANS * math.degrees(site.block.lean), 1)
    at, goal = (round(_middle(site.block.spec), 3), 0.0, top), (site.stands, 0.0, top)
    reached = Reaches(object=kind, target=at, within=CLOSE)
    home = Finally(seconds=1.0, of=StaysWithin(object=kind, center=goal, radius=HOME))
    begin = round(arrives + ARRIVES, 1)
    window = (begin, round(begin + wait - ARRIVES, 1))
    down = GoneBetween(
        object="block", axis="z", low=round(-(1 + SINKS) * sinks, 4), high=round(-(1 - SINKS) * sinks, 4)
    )
    leans = [TiltBetween(object="block", axis="x", low=low, high=high) for low, high in
             ((-MOST_LEAN, -lean), (lean, MOST_LEAN))]  # fmt: skip
    level = Mean(seconds=2.0, of=Upright(object="block", within=LEVELS))
    events = (Eventually(window=(0.0, window[0]), of=leans[0]), Eventually(of=leans[1]), level)
    near = BACK * site.spacing
    again = Mean(seconds=2.0, of=GoneBetween(object="block", axis="z", low=-near, high=near))
    said = f"m / rho (1 / A - 1 / A') = {1e3 * sinks:.1f} mm"
    formulas = [
        (kind, "It waits on the block, and reaches the other dock.", Then(events=(reached, home), windows=(None,))),
        ("block", f"Under the load it sinks by {said}, to 10 %, in the mean of two of its swings.",
         Mean(window=window, of=down)),
        ("block", "It tilts to the dock from which the vehicle comes, then to the other, and recovers.",
         Then(events=events, windows=(None, None))),
        ("block", f"Left alone it comes up again, to {1e3 * near:.0f} mm of where it was.", again),
    ]  # fmt: skip
    found = [Objective(kind="formula", object=name, sentence=text, formula=of) for name, text, of in formulas]
    found.append(Objective(kind="floats", object="block", ref="water", sentence="It floats at its draft in the end."))
    stays = "The water stays in the basin."
    return [*found, Objective(kind="stays_inside", object="water", ref="basin", sentence=stays)]


def _views(site: Site) -> list[CameraPlan]:
    """From the side, with both docks in it; of the block, from a corner."""
    half, high = site.wall + site.dock, site.top
    back = round(half / math.tan(math.radians(FIELD_OF_VIEW / 2)), 1)
    side = CameraPlan(
        name="side", eye=(0.0, -back, round(high + 0.2 * back, 2)), target=(0.0, 0.0, round(0.8 * high, 2))
    )
    near = (round(0.7 * half, 2), round(-1.1 * half, 2), round(high + 0.35 * half, 2))
    return [side, CameraPlan(name="quarter", eye=near, target=(0.0, 0.0, round(0.8 * high, 2)))]


def _assume(cast: Cast, thing: Thing, over: Thing, site: Site, wait: float) -> None:
    block, spec = site.block, site.block.spec
    size = " x ".join(f"{edge:g}" for edge in block.size)
    cast.assume(
        over.words, f"{size} m of {block.material.density:g} kg/m^3, held by nothing",
        f"{block.free:.2g} m of it stay above the water with {spec.mass:g} kg's rear axle over an end",
    )  # fmt: skip
    over_docks = site.bottom + block.size[2] - site.top
    warning = "" if over_docks > -LOWEST else "warning: "
    height = f"{warning}{abs(over_docks):.2g} m {'lower' if over_docks > 0.0 else 'higher'} than the empty block"
    cast.assume("docks", height, "the load takes its ends down, and water is not to come over the basin's walls")
    cast.assume(thing.words, f"waits on its middle for {wait:g} s", "the block swings; its mean is what the load says")
    if thing.speed is None:
        cast.assume(thing.words, f"drives at {SPEED:g} m/s at most", "the prompt gives no speed")
