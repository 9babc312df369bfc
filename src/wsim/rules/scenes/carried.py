"""Belts and turntables, and what they carry."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject, Pose, Vec3
from wsim.plan.schema.formula_motion import Drops
from wsim.plan.schema.formula_place import Reaches
from wsim.rules.cast import Cast, Thing
from wsim.rules.materials import material_named
from wsim.rules.scenes.catch import catcher, lands
from wsim.rules.scenes.lasting import asked, turns
from wsim.rules.scenes.part import Part, fall_time, pair_friction, tall, tidy
from wsim.rules.sizes import bodies

INTO_SPEED = 1.2  # the same where what leaves it is to come down in a vessel [m/s]
BELT_SPEED, TURN_SPEED = 0.5, 45.0  # [m/s], [deg/s], where the prompt gives none
MOST_BELT_SPEED = 5.0  # that the prompt may give [m/s]
RIDE, MOST_WAY = 3.0, 3.0  # how long a belt carries its load [s], and how far [m], if that comes first
DROP_WAY = 1.0  # to the belt's end, for what is to fall off there [m]
HEIGHT = 0.5  # of a belt's surface above the ground [m]
TABLE_HEIGHT = 0.3  # of a turntable's
GAP, EDGE = 0.25, 0.15  # between what rides on a belt, and from it to the belt's end and sides [m]
LEG = 0.08  # thickness of what holds a belt up [m]
START_GAP = 0.001  # between what carries and its load [m]
SHARE = 0.8  # of the way that it is carried, which what rides must make at least
SPUN_SHARE, LEAST_SHARE = 0.6, 0.2  # of its radius, at which a load stands on a turntable: usually, and at least
MOST_SPIN = 1080.0  # that the prompt may give [deg/s]
HELD = 0.5  # of the friction, which going round may take


def build_carried(cast: Cast, taken: set[str]) -> list[Part]:
    """Every belt, which runs along +X, and turntable, and what is on it."""
    return [_carrier(carrier, cast, taken) for carrier in cast.family("belt", "turntable")]


def _carrier(carrier: Thing, cast: Cast, taken: set[str]) -> Part:
    """One of them.

    Raises:
        UserError: More on it than fits.
    """
    part = Part()
    if carrier.count > 1:
        raise UserError(f"{carrier.words!r}: the builtin planner builds one such; name each for itself")
    riders = [thing for thing in cast.things if thing.support is carrier]
    for thing in riders:
        if thing.group:
            raise UserError(f"{thing.words!r}: the builtin planner lets single things ride on {carrier.words!r}")
    build = _belt if carrier.noun.family == "belt" else _turntable
    build(carrier, riders, part, cast, taken)
    return part


# ---- belts
def _belt(belt: Thing, riders: list[Thing], part: Part, cast: Cast, taken: set[str]) -> None:
    speed = _belt_speed(belt, riders, cast)
    loads = [(thing, item) for thing in riders for item in bodies(thing, cast, taken)]
    falls = any("drop" in thing.does or thing.into is not None or thing.off for thing in riders)
    runs = all("roll" in thing.does for thing in riders) and bool(riders)
    time, way = _ride(speed, falls, runs, cast)
    widths = [_across(item) for _, item in loads]
    row = sum(widths) + GAP * max(0, len(widths) - 1)
    [slab] = bodies(belt, cast, taken)
    given = belt.phrase.length is not None or "x" in belt.phrase.measures
    length = (
        slab.size[0] if given or not way else math.ceil(100 * (row + way + (EDGE if falls else 2 * EDGE)) - 1e-6) / 100
    )
    if length < row + (EDGE if falls else way + 2 * EDGE) - 1e-6:
        raise UserError(
            f"{belt.words!r}: {length:g} m is too short for its load to go {way:.3g} m; leave the length out"
        )
    width = round(max([slab.size[1], *(_across(item, 1) + 2 * EDGE for _, item in loads)]), 3)
    _resize(belt, slab.size, (length, width, slab.size[2]), cast)
    slab = slab.model_copy(
        update={
            "construction": slab.construction.model_copy(update={"size": (length, width, slab.size[2])}),
            "pose": Pose(position=(0.0, 0.0, tidy(HEIGHT - slab.size[2] / 2))),
            "surface_velocity": (-speed if runs else speed, 0.0, 0.0),
        }
    )
    part.objects += [slab, *_legs(slab, taken)]
    part.names[id(belt)] = [slab.name]
    part.duration = time
    cast.assume(belt.words, f"its surface {HEIGHT:g} m above the ground", "the prompt gives no height")
    # The first in a row leads.
    x = 0.0 if runs else -length / 2 + EDGE + row
    for (thing, item), across in zip(loads, widths, strict=True):
        _load(thing, item, (x - across / 2 * (not runs), 0.0, HEIGHT), speed, part)
        x -= across + GAP
        _belt_objectives(thing, item, slab, 0.0 if runs else way, part)
        if _falls(thing):  # tumbling takes it on by about its size
            gone = way + speed * fall_time(HEIGHT) + 1.5 * across
            part.goes[item.name] = [(round(gone, 3), 0.0, -HEIGHT)]
        part.names.setdefault(id(thing), []).append(item.name)
        if thing.into is not None:
            _catch(thing, item, length / 2, speed, part, cast, taken)


def _falls(thing: Thing) -> bool:
    return "drop" in thing.does or thing.into is not None or thing.off


def _catch(thing: Thing, item: PlanObject, end: float, speed: float, part: Part, cast: Cast, taken: set[str]) -> None:
    """A vessel where what leaves the belt's end comes down."""
    vessel = thing.into
    assert vessel is not None
    [made] = bodies(vessel, cast, taken)
    caught = catcher(thing, made, item, speed, HEIGHT, cast)
    at = Pose(position=(tidy(end + caught.way), 0.0, 0.0))
    part.objectives.append(asked(item.name, f"{item.name} leaves the belt and falls.", Drops(object=item.name)))
    part.objectives.append(lands(item.name, made.name))
    part.objects.append(caught.vessel.model_copy(update={"pose": at}))
    part.names[id(vessel)] = [caught.vessel.name]


def _belt_speed(belt: Thing, riders: list[Thing], cast: Cast) -> float:
    given = [one.speed for one in (belt, *riders) if one.speed is not None]
    if len(set(given)) > 1:
        raise UserError(f"{belt.words!r}: what it carries goes as fast as it does; the prompt gives {given} m/s")
    if not given and any(thing.into is not None for thing in riders):
        cast.assume(
            belt.words, f"runs at {INTO_SPEED:g} m/s along +X", "so that what leaves it comes down in its vessel"
        )
        return INTO_SPEED
    if not given:
        cast.assume(belt.words, f"runs at {BELT_SPEED:g} m/s along +X", "the prompt gives no speed")
        return BELT_SPEED
    if not 0.0 < given[0] <= MOST_BELT_SPEED:
        raise UserError(
            f"{belt.words!r}: {given[0]:g} m/s is not above 0 and up to {MOST_BELT_SPEED:g} m/s, a belt's range"
        )
    return given[0]


def _ride(speed: float, falls: bool, runs: bool, cast: Cast) -> tuple[float, float]:
    """How long the scene is [s], and how far its load goes on the belt [m]."""
    if runs:
        return cast.duration or RIDE, 0.0
    if falls:
        return round(DROP_WAY / speed + fall_time(HEIGHT) + 2.2, 1), DROP_WAY
    time = cast.duration or max(0.6, round(min(RIDE, MOST_WAY / speed), 1))
    return time, speed * time


def _legs(slab: PlanObject, taken: set[str]) -> list[PlanObject]:
    """What holds a belt up: a stand near each end."""
    length, width, thick = slab.size
    tall_ = HEIGHT - thick
    stands = []
    for end, sign in (("tail", -1.0), ("head", 1.0)):
        name = f"{slab.name}_{end}_stand"
        taken.add(name)
        pose = Pose(position=(tidy(sign * (length / 2 - 2 * LEG)), 0.0, tidy(tall_ / 2)))
        stand = PlanObject.proxy(
            name=name, role="background", primitive="box", size=(LEG, round(0.8 * width, 3), round(tall_, 4)),
            material=material_named("steel"), state="static", pose=pose, words=slab.words,
        )  # fmt: skip
        stands.append(stand)
    return stands


def _load(thing: Thing, item: PlanObject, at: Vec3, speed: float, part: Part) -> None:
    """Set what rides on the belt: at its speed, or, where it rolls against it, rolling in its place."""
    rolls = "roll" in thing.does
    if rolls and item.primitive != "sphere":
        raise UserError(f"{thing.words!r}: the builtin planner rolls balls only on a belt")
    turned = item.relation("LIES-ALONG-Y") is not None
    half = item.size[0] if turned else tall(item) / 2 + (item.size[0] if item.primitive == "capsule" else 0.0)
    pose = Pose(
        position=(tidy(at[0]), at[1], tidy(at[2] + half + START_GAP)),
        rotation_deg=(90.0, 0.0, 0.0) if turned else (0.0, 0.0, 0.0),
    )
    motion: dict[str, object] = {"velocity": (speed, 0.0, 0.0)}
    if rolls:
        motion = {"angular_velocity_deg": (0.0, tidy(math.degrees(speed / item.size[0])), 0.0)}
    part.posed.append(item.related([]).model_copy(update={"pose": pose, **motion}))


def _belt_objectives(thing: Thing, item: PlanObject, slab: PlanObject, way: float, part: Part) -> None:
    name = item.name
    if way:
        least = round(SHARE * way, 3)
        sentence = f"{name} is carried {least:g} m or more."
        part.objectives.append(Objective(kind="moves", object=name, value=least, direction="front", sentence=sentence))
    if thing.into is not None:
        return  # it comes down in a vessel
    if _falls(thing):
        sentence = f"{name} falls onto the ground."
        part.objectives.append(Objective(kind="collides_with", object=name, ref="ground", sentence=sentence))
    else:
        sentence = f"{name} stays on {slab.name}."
        part.objectives.append(Objective(kind="stays_on", object=name, ref=slab.name, sentence=sentence))


def _across(item: PlanObject, axis: int = 0) -> float:
    """How much of a belt's length a thing takes up, or, for the axis 1, of its width [m]."""
    if item.primitive == "box":
        return item.size[axis]
    lies = axis == 1 and item.relation("LIES-ALONG-Y") is not None
    return item.size[1] + 2 * item.size[0] if lies else 2 * item.size[0]


def _resize(belt: Thing, usual: tuple[float, ...], size: tuple[float, ...], cast: Cast) -> None:
    """Say the size that the belt has in place of the usual one."""
    if size == usual:
        return
    told = " x ".join(f"{edge:g}" for edge in usual) + " m"
    cast.assumptions = [one for one in cast.assumptions if (one.subject, one.choice) != (belt.words, told)]
    cast.assume(belt.words, " x ".join(f"{edge:g}" for edge in size) + " m", "room for what it carries, and its way")


# ---- turntables
def _turntable(table: Thing, riders: list[Thing], part: Part, cast: Cast, taken: set[str]) -> None:
    loads = [(thing, item) for thing in riders for item in bodies(thing, cast, taken)]
    [disc] = bodies(table, cast, taken)
    radius, thick = disc.size
    ring = SPUN_SHARE * radius
    friction = min((pair_friction(item, disc, one.said("friction", table)) for one, item in loads), default=1.0)
    if table.spin:  # nearer to the middle, where that is what friction holds
        held = HELD * friction * GRAVITY / math.radians(table.spin) ** 2
        ring = round(min(ring, max(held, LEAST_SHARE * radius)), 3)
    most = math.degrees(math.sqrt(HELD * friction * GRAVITY / ring))
    spin = tidy(min(TURN_SPEED, 5.0 * math.floor(most / 5.0)))
    given = next((one.speed for one in (table, *riders) if one.speed is not None), None)
    if given is not None:
        raise UserError(
            f"{table.words!r}: {given:g} m/s is no rate of turning; say it as 30 rpm or 180 degrees a second"
        )
    spin = _said_spin(table, spin, math.degrees(math.sqrt(friction * GRAVITY / ring)), bool(loads), cast)
    widest = max((max(item.size[:2]) if item.primitive == "box" else 2 * item.size[0] for _, item in loads), default=0)
    if any(item.primitive == "sphere" for _, item in loads):
        raise UserError(f"{table.words!r}: the builtin planner carries what does not roll on it; give no balls")
    if (loads and 2 * math.pi * ring < len(loads) * 1.5 * widest) or ring + widest > 1.2 * radius:
        raise UserError(f"{table.words!r}: {radius:g} m is too small for its load; give smaller things")
    disc = disc.model_copy(
        update={
            "state": "kinematic", "role": "rigid_body", "angular_velocity_deg": (0.0, 0.0, spin),
            "pose": Pose(position=(0.0, 0.0, tidy(TABLE_HEIGHT - thick / 2))),
        }
    )  # fmt: skip
    foot_name = f"{disc.name}_foot"
    taken.add(foot_name)
    foot = PlanObject.proxy(
        name=foot_name, role="background", primitive="cylinder", size=(0.3 * radius, round(TABLE_HEIGHT - thick, 4)),
        material=material_named("steel"), state="static",
        pose=Pose(position=(0.0, 0.0, tidy((TABLE_HEIGHT - thick) / 2))), words=table.words,
    )  # fmt: skip
    part.objects += [foot, disc]
    part.names[id(table)] = [disc.name]
    halves = 2 * math.floor(spin / 360.0) + 1  # half turns, an odd number: it ends on the far side
    part.duration = round(halves * 180.0 / spin, 2 if spin > 180.0 else 1)
    turned = math.radians(spin) * (cast.duration or part.duration)
    if table.spin is not None:
        part.objectives.append(turns(disc.name, spin))
    if len([item for thing, item in loads if thing.side == "middle"]) > 1:
        raise UserError(f"{table.words!r}: one thing can stand in its middle, not more")
    for number, (thing, item) in enumerate(loads):
        angle = 2 * math.pi * number / len(loads)
        if thing.side == "middle":
            _spun(thing, item, disc, 0.0, 0.0, spin, part)
            sentence = f"{item.name} stays on {disc.name}."
            part.objectives.append(Objective(kind="stays_on", object=item.name, ref=disc.name, sentence=sentence))
            continue
        _spun(thing, item, disc, ring, angle, spin, part)
        part.objectives += _round(item, part.posed[-1].pose, disc, ring, turned)


def _said_spin(table: Thing, usual: float, most: float, loaded: bool, cast: Cast) -> float:
    """The rate of turning [deg/s]: the prompt's, with a warning where friction does not hold the load, or the usual."""
    if table.spin is None:
        cast.assume(table.words, f"turns by {usual:g} degrees a second", "the prompt gives no rate")
        return usual
    if not 1.0 <= table.spin <= MOST_SPIN:
        raise UserError(f"{table.words!r}: {table.spin:g} degrees a second is outside 1 to {MOST_SPIN:g}")
    if loaded and table.spin > most:
        why = f"friction holds it there up to {most:.3g} degrees a second"
        cast.assume(table.words, f"warning: at {table.spin:g} degrees a second its load slides off", why)
    return tidy(table.spin)


def _spun(thing: Thing, item: PlanObject, disc: PlanObject, ring: float, angle: float, spin: float, part: Part) -> None:
    """Set a load on a turntable, going round with it."""
    x, y, rate = ring * math.cos(angle), ring * math.sin(angle), math.radians(spin)
    pose = Pose(
        position=(tidy(x), tidy(y), tidy(TABLE_HEIGHT + tall(item) / 2 + START_GAP)),
        rotation_deg=(0.0, 0.0, tidy(math.degrees(angle))),
    )
    motion = {"velocity": (tidy(-rate * y), tidy(rate * x), 0.0), "angular_velocity_deg": (0.0, 0.0, spin)}
    part.posed.append(item.related([]).model_copy(update={"pose": pose, **motion}))
    part.names.setdefault(id(thing), []).append(item.name)


def _round(item: PlanObject, pose: Pose | None, disc: PlanObject, ring: float, turned: float) -> list[Objective]:
    """It goes round as far as the table turns [rad], and stays on it."""
    name, chord = item.name, 2 * ring * abs(math.sin(turned / 2))
    stays = Objective(kind="stays_on", object=name, ref=disc.name, sentence=f"{name} stays on {disc.name}.")
    if turned < math.pi or chord > 2 * SHARE * ring or pose is None:
        far = " to the far side" if chord > 2 * SHARE * ring else ""
        way, sentence = round(SHARE * chord, 3), f"{name} is carried round{far}."
        return [Objective(kind="moves", object=name, value=way, sentence=sentence), stays]
    # It may end where it began: it is asked to have been on the far side.
    x, y, z = pose.position
    formula = Reaches(object=name, target=(-x + 0.0, -y + 0.0, z), within=round((1 - SHARE) * 2 * ring, 3))
    sentence = f"{name} is carried round by the far side."
    return [Objective(kind="formula", object=name, sentence=sentence, formula=formula), stays]
