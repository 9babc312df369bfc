"""Pendulums and seesaws: bodies on a hinge."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Joint, JointDrive, Objective, PlanObject, Pose, Vec3
from wsim.rules.cast import Cast, Thing
from wsim.rules.materials import material_named
from wsim.rules.scenes.lasting import leans, to_and_fro
from wsim.rules.scenes.part import Part, fall_time, tall, tidy
from wsim.rules.sizes import LARGEST, SMALLEST, bodies, material_of, names, size_of

ROD_LENGTH, ROD_RADIUS = 1.0, 0.008  # [m]
ANGLE = 20.0  # of a pendulum at the start [deg]
CLEARANCE = 0.3  # of a pendulum's lowest point above the ground [m]
LESS = 0.9  # that each half swing goes as far as the one before, of what dies down
PERIODS = 3.0  # that a pendulum is watched for
SEESAW_HEIGHT = 0.3  # of the plank's underside above the ground [m]
BASE_WIDTH = 0.06  # of what carries a seesaw's plank [m]
HINGE_GAP = 0.005  # between a seesaw's plank and what carries it [m]
RIDER_SHARE = 0.8  # of the half length, from the hinge to what is on a seesaw
DROP_HEIGHT = 0.3  # [m]


def build_pendulum(cast: Cast, taken: set[str]) -> Part:
    """A bob on a light rod that hangs from a hinge in the world, swinging along X.

    Raises:
        UserError: several, or something else beside it.
    """
    part = Part()
    swingers = [thing for thing in cast.things if thing.noun.family == "pendulum" or thing.rod is not None]
    if not swingers:
        return part
    if len(cast.things) > 1 or swingers[0].count > 1 or cast.wet:
        raise UserError(f"{swingers[0].words!r}: the builtin planner hangs one pendulum, in a scene of its own")
    thing = swingers[0]
    length, radius, bob = _bob(thing, cast, taken)
    angle = thing.angle if thing.angle is not None else (ANGLE if "swing" in thing.does or not thing.does else 0.0)
    if not 0.0 <= angle <= 90.0:
        raise UserError(f"{thing.words!r}: {angle:g} degrees is outside 0 to 90, where a rod swings freely")
    if thing.angle is None and angle:
        cast.assume(thing.words, f"let go at {angle:g} degrees from the vertical", "the prompt gives no angle")
    height = round(length + radius + CLEARANCE, 3)
    cast.assume(thing.words, f"hangs from a hinge {height:g} m above the ground", "so that it clears the ground")
    turn = math.radians(angle)
    rod_length = tidy(length - radius)
    rod_name = "rod" if "rod" not in taken else "pendulum_rod"
    taken.add(rod_name)

    def at(distance: float) -> Pose:
        position = (tidy(distance * math.sin(turn)), 0.0, tidy(height - distance * math.cos(turn)))
        return Pose(position=position, rotation_deg=(0.0, -angle + 0.0, 0.0))

    rod = PlanObject.proxy(
        name=rod_name, role="mechanism", primitive="cylinder", size=(ROD_RADIUS, rod_length),
        material=material_named("aluminium"), pose=at(rod_length / 2), words=thing.rod.words if thing.rod else "",
    )  # fmt: skip
    part.posed += [rod, bob.model_copy(update={"pose": at(length)})]
    damped = _damped(rod, bob, length, cast, thing) if "die" in thing.does else None
    part.joints = [
        Joint(name="pivot", kind="hinge", child=rod_name, anchor=(0.0, 0.0, rod_length / 2), axis="Y", drive=damped),
        Joint(name="hold", kind="fixed", parent=rod_name, child=bob.name, anchor=(0.0, 0.0, radius)),
    ]
    if angle:
        sentence = f"{bob.name} swings as a pendulum of its length does."
        part.objectives.append(Objective(kind="swings", object=bob.name, sentence=sentence))
        part.objectives += to_and_fro(thing, bob.name, "x", LESS**2 if "die" in thing.does else 1.0, cast)
    else:
        part.objectives.append(Objective(kind="settles", object=bob.name, sentence=f"{bob.name} hangs still."))
    part.duration = round(PERIODS * 2 * math.pi * math.sqrt(length / GRAVITY), 1)
    part.names[id(thing)] = [bob.name]
    x, drop = tidy(length * math.sin(turn)), tidy(length * (1.0 - math.cos(turn)))
    part.goes[bob.name] = [(-x, 0.0, -drop), (-2 * x, 0.0, 0.0)]  # through its lowest point to the other side
    return part


def _damped(rod: PlanObject, bob: PlanObject, length: float, cast: Cast, thing: Thing) -> JointDrive:
    """A hinge that takes energy: of a swing the next half is so much smaller, exp(-c T / 4 I)."""
    masses = []
    for item in (rod, bob):
        radius, *rest = item.size
        volume = math.pi * radius**2 * rest[0] if rest else 4.0 / 3.0 * math.pi * radius**3
        masses.append(item.registration.mass or volume * (item.density or 0.0))
    inertia = masses[0] * rod.size[1] ** 2 / 3.0 + masses[1] * (length**2 + 0.4 * bob.size[0] ** 2)
    moment = masses[0] * rod.size[1] / 2.0 + masses[1] * length
    period = 2.0 * math.pi * math.sqrt(inertia / (GRAVITY * moment))
    damping = round(-4.0 * inertia * math.log(LESS) / period, 5)
    cast.assume(
        thing.words, f"its hinge damps it with {damping:g} N m s/rad", f"each half swing {1 - LESS:.0%} smaller"
    )
    return JointDrive(velocity=0.0, damping=damping)


def _bob(thing: Thing, cast: Cast, taken: set[str]) -> tuple[float, float, PlanObject]:
    """From the hinge to the bob's centre [m], the bob's radius [m], and the bob."""
    own = thing.noun.family == "pendulum"
    asked = thing.phrase if own or thing.rod is None else thing.rod
    length = asked.length or asked.measures.get("x") or asked.measures.get("z")
    if length is None:
        length = ROD_LENGTH
        cast.assume(thing.words, f"{length:g} m from the hinge to the bob's centre", "the prompt gives no length")
    if not 4 * SMALLEST <= length <= LARGEST:
        raise UserError(
            f"{thing.words!r}: {length:g} m is outside {4 * SMALLEST:g} to {LARGEST:g} m, a pendulum's range"
        )
    material = material_of(thing, cast)
    if own:
        radius = round(min(thing.noun.size[0] * (thing.phrase.scale or 1.0), length / 3), 4)
        cast.assume(thing.words, f"a bob of radius {radius:g} m", "the prompt gives no size of it")
    else:
        radius = size_of(thing, material, 1000.0, cast)[0]
    if radius > 0.5 * length:
        raise UserError(f"{thing.words!r}: a ball of radius {radius:g} m is too large for a rod of {length:g} m")
    if thing.rod is not None and not own:
        cast.assume(thing.rod.words, "measured to the ball's centre", "that is the length of a pendulum")
    [name] = names(thing, taken)
    bob = PlanObject.proxy(
        name=name, role="rigid_body", primitive="sphere", size=(radius,), material=material, words=thing.words
    )
    mass = thing.phrase.measures.get("mass")
    if mass is not None:
        bob = bob.model_copy(update={"registration": bob.registration.model_copy(update={"mass": mass})})
    return length, radius, bob


def build_seesaw(cast: Cast, taken: set[str]) -> Part:
    """A plank on a hinge, and what drops or stands on its ends.

    Raises:
        UserError: several, or more than two riders.
    """
    part = Part()
    seesaws = cast.family("seesaw")
    if not seesaws:
        return part
    seesaw = seesaws[0]
    riders = [thing for thing in cast.things if thing.support is seesaw]
    if len(seesaws) > 1 or seesaw.count > 1 or len(riders) > 1 or any(r.count > 1 for r in riders):
        raise UserError(f"{seesaw.words!r}: the builtin planner builds one seesaw, with one thing on one end")
    [plank] = bodies(seesaw, cast, taken)
    length, width, thick = plank.size
    centre = SEESAW_HEIGHT + thick / 2
    plank = plank.model_copy(update={"pose": Pose(position=(0.0, 0.0, tidy(centre)))})
    base_name = f"{plank.name}_base"
    taken.add(base_name)
    base = PlanObject.proxy(
        name=base_name, role="background", primitive="box", size=(BASE_WIDTH, width, SEESAW_HEIGHT - HINGE_GAP),
        material=material_named("steel"), state="static",
        pose=Pose(position=(0.0, 0.0, tidy((SEESAW_HEIGHT - HINGE_GAP) / 2))), words=seesaw.words,
    )  # fmt: skip
    part.objects += [base, plank]
    part.joints = [Joint(name="pivot", kind="hinge", child=plank.name, axis="Y")]
    part.names[id(seesaw)] = [plank.name]
    part.duration = 2.0
    top = centre + thick / 2
    for thing in riders:
        _ride(thing, seesaw, plank, (RIDER_SHARE * length / 2, 0.0, top), part, cast, taken)
    if not riders and seesaw.angle is not None:
        raise UserError(f"{seesaw.words!r}: nothing is on it that could tilt it; name what stands or falls on it")
    if not riders:
        part.objectives.append(
            Objective(kind="settles", object=plank.name, sentence=f"{plank.name} stays level and at rest.")
        )
    return part


def _ride(thing: Thing, seesaw: Thing, plank: PlanObject, at: Vec3, part: Part, cast: Cast, taken: set[str]) -> None:
    [item] = bodies(thing, cast, taken)
    half = tall(item) / 2
    height = 0.001
    if "drop" in thing.does:
        height = cast.drop_height(thing, DROP_HEIGHT, "the seesaw")
    cast.assume(thing.words, "over the front end", "the prompt does not say which end")
    position = (tidy(at[0]), 0.0, tidy(at[2] + height + half))
    part.posed.append(item.related([]).model_copy(update={"pose": Pose(position=position)}))
    part.names[id(thing)] = [item.name]
    sentence = f"{plank.name} goes down where {item.name} is."
    part.objectives.append(Objective(kind="tilts", object=plank.name, ref=item.name, sentence=sentence))
    if seesaw.angle is not None:
        part.objectives.append(leans(plank.name, seesaw.angle, _room_to_tilt(plank), seesaw.words))
    part.duration = max(part.duration, round(2.0 + fall_time(height), 1))


def _room_to_tilt(plank: PlanObject) -> float:
    """How far a seesaw tilts until its plank meets the edge of what carries it, or its end the ground [deg]."""
    half = plank.size[2] / 2
    a, b = HINGE_GAP + half, BASE_WIDTH / 2  # the edge, seen from the hinge: below it, and beside it
    edge = math.acos(half / math.hypot(a, b)) - math.atan2(b, a)
    return math.degrees(min(edge, math.asin(min(1.0, 2.0 * SEESAW_HEIGHT / plank.size[0]))))
