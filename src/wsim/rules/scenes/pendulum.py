"""Pendulums, and what hangs on rods and ropes: on a hinge in the world, at rest, swinging, or into what it hits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import Cord, Joint, JointDrive, Objective, PlanObject, Pose, Vec3
from wsim.plan.schema.formula_motion import Swings
from wsim.rules.cast import Cast, Thing
from wsim.rules.materials import material_named
from wsim.rules.scenes.lasting import asked, swings_down, to_and_fro
from wsim.rules.scenes.part import Part, tall, tidy
from wsim.rules.scenes.struck import Struck, stand_before
from wsim.rules.sizes import LARGEST, SMALLEST, bodies, material_of, names, size_of

ROD_LENGTH, ROD_RADIUS, ROPE_LENGTH, ROPE_RADIUS = 1.0, 0.008, 0.6, 0.006  # [m]
ANGLE, HIT_ANGLE = 20.0, 60.0  # of a pendulum at the start, and of one that hits something [deg]
CLEARANCE = 0.3  # of a pendulum's lowest point above the ground [m]
APART = 0.3  # between several side by side [m]
LESS = 0.9  # that each half swing goes as far as the one before, of what dies down
TWO_MODES = 0.06  # of the period on a rope: a body turns at the rope's end, too, with the faster mode
PERIODS = 3.0  # that a pendulum is watched for
AFTER = 2.0  # and what it has hit [s]
QUICK = 60.0  # pictures a second of a blow: what rubs on the ground meanwhile is told from it [1/s]


@dataclass
class Hanging:
    """What hangs: `length` from the hinge to the body's centre, `half` of it within the body [m]."""

    thing: Thing
    item: PlanObject
    length: float
    half: float
    rope: bool


def build_pendulums(cast: Cast, taken: set[str]) -> list[Part]:
    """Everything that hangs; several of one kind side by side."""
    parts = []
    for thing in [one for one in cast.things if one.noun.family == "pendulum" or one.rod is not None]:
        if thing.target is not None and thing.count > 1:
            raise UserError(f"{thing.words!r}: the builtin planner lets one of them swing into a thing; give one")
        part = Part()
        for number, hanging in enumerate(_hanging(thing, cast, taken)):
            if number:
                shift = number * (2 * _half_width(hanging.item) + APART)
                part.add(_hang(hanging, cast, taken).shifted(shift))
            else:
                part.add(_hang(hanging, cast, taken))
        part.posed, part.objects = [*part.objects, *part.posed], []
        part.names[id(thing)] = [o.name for o in part.posed if o.words == thing.words and o.role == "rigid_body"]
        parts.append(part)
    return parts


def _half_width(item: PlanObject) -> float:
    return item.size[1] / 2 if item.primitive == "box" else item.size[0]


def _hang(hanging: Hanging, cast: Cast, taken: set[str]) -> Part:
    """One body on a light rod, swinging along X if it does."""
    thing, length, part = hanging.thing, hanging.length, Part()
    angle = _angle(thing, cast)
    struck = stand_before(thing, hanging.item, part, cast, taken) if thing.target is not None else None
    clear = CLEARANCE if thing.drop_height is None else thing.drop_height
    height = round(length + hanging.half + clear, 3) if struck is None else tidy(struck.height + length)
    below = "the ground" if thing.support is None else thing.support.words
    held = "point" if hanging.rope else "hinge"
    cast.assume(thing.words, f"hangs from a {held} {height:g} m above {below}", f"so that it clears {below}")
    turn = math.radians(-angle if struck is not None else angle)
    if hanging.rope and "die" not in thing.does:
        body = _on_rope(hanging, turn, height, part, taken)
        _ask(hanging, body, angle, struck, part, cast)
        up = (tidy(-length * math.sin(turn)), 0.0, tidy(length * math.cos(turn)))
        part.goes.setdefault(body.name, []).append(up)  # to where the rope ends, which is to be seen
        return part
    rod, body = _pose(hanging, turn, height, cast, taken)
    part.posed += [rod, body]
    damped = _damped(rod, body, length, cast, thing) if "die" in thing.does else None
    first = "pivot" not in taken
    taken |= {"pivot"} if first else set()
    tail = "" if first else f"_{body.name}"
    part.joints = [
        Joint(name=f"pivot{tail}", kind="hinge", child=rod.name, anchor=(0.0, 0.0, rod.size[1] / 2), axis="Y",
              drive=damped),
        Joint(name=f"hold{tail}", kind="fixed", parent=rod.name, child=body.name, anchor=(0.0, 0.0, hanging.half)),
    ]  # fmt: skip
    _ask(hanging, body, angle, struck, part, cast)
    return part


def _on_rope(hanging: Hanging, turn: float, height: float, part: Part, taken: set[str]) -> PlanObject:
    """The body at the end of a rope, which pulls where it is taut and weighs nothing; from the top of the body."""
    length, half = hanging.length, hanging.half
    name = next(one for one in ("rope", f"{hanging.item.name}_rope") if one not in taken)
    taken.add(name)

    def at(distance: float) -> Vec3:
        return tidy(distance * math.sin(turn)), 0.0, tidy(height - distance * math.cos(turn))

    pose = Pose(position=at(length), rotation_deg=(0.0, tidy(-math.degrees(turn)), 0.0))
    body = hanging.item.related([]).model_copy(update={"pose": pose})
    part.posed.append(body)
    part.cords.append(
        Cord(
            name=name, kind="rope", b=body.name, anchor_a=(0.0, 0.0, tidy(height)), anchor_b=at(length - half),
            length=tidy(length - half), radius=ROPE_RADIUS,
        )
    )  # fmt: skip
    return body


def _angle(thing: Thing, cast: Cast) -> float:
    swings = "swing" in thing.does or (not thing.does and thing.noun.family == "pendulum")
    usual = HIT_ANGLE if thing.target is not None else ANGLE
    angle = thing.angle if thing.angle is not None else (thing.phrase.angle or (usual if swings else 0.0))
    if not 0.0 <= angle <= 90.0:
        raise UserError(f"{thing.words!r}: {angle:g} degrees is outside 0 to 90, where a rod swings freely")
    if thing.target is not None and angle < 1.0:
        raise UserError(f"{thing.words!r}: from {angle:g} degrees it does not swing into anything; give an angle")
    if thing.angle is None and thing.phrase.angle is None and angle:
        cast.assume(thing.words, f"let go at {angle:g} degrees from the vertical", "the prompt gives no angle")
    return angle


def _pose(hanging: Hanging, turn: float, height: float, cast: Cast, taken: set[str]) -> tuple[PlanObject, PlanObject]:
    """The rod, and the body at its end."""
    thing, length = hanging.thing, hanging.length
    rod_length = tidy(length - hanging.half)
    stem = "rope" if hanging.rope else "rod"
    name = next(one for one in (stem, f"pendulum_{stem}", f"{hanging.item.name}_{stem}") if one not in taken)
    taken.add(name)

    def at(distance: float) -> Pose:
        position = (tidy(distance * math.sin(turn)), 0.0, tidy(height - distance * math.cos(turn)))
        return Pose(position=position, rotation_deg=(0.0, tidy(-math.degrees(turn)), 0.0))

    radius, material = (ROPE_RADIUS, "plastic") if hanging.rope else (ROD_RADIUS, "aluminium")
    made = PlanObject.proxy(
        name=name, role="mechanism", primitive="cylinder", size=(radius, rod_length), pose=at(rod_length / 2),
        material=material_named(material), words=thing.rod.words if thing.rod else "",
    )  # fmt: skip
    if hanging.rope:
        cast.assume(
            thing.rod.words if thing.rod else thing.words, "a thin straight link", "a rope under load is straight"
        )
    return made, hanging.item.related([]).model_copy(update={"pose": at(length)})


def _ask(hanging: Hanging, body: PlanObject, angle: float, struck: Struck | None, part: Part, cast: Cast) -> None:
    thing, length, name = hanging.thing, hanging.length, body.name
    period = 2 * math.pi * math.sqrt(length / GRAVITY)
    if struck is not None:
        speed = math.sqrt(2 * GRAVITY * length * (1 - math.cos(math.radians(angle))))
        struck.ask(thing, body, speed, part, cast)
        part.objectives.append(swings_down(name, angle))
        part.duration, part.frame_rate = round(period / 3 + AFTER, 1), QUICK
        x, drop = tidy(length * math.sin(math.radians(angle))), tidy(length * (1.0 - math.cos(math.radians(angle))))
        part.goes[name] = [(x, 0.0, -drop), (2 * x, 0.0, 0.0)]
        return
    if angle and hanging.rope and "die" not in thing.does:
        wide = math.radians(angle)
        period = round(_rope_period(hanging) * (1 + wide**2 / 16 + 11 * wide**4 / 3072), 3)
        sentence = f"{name} swings with the period of what hangs on a rope, {period:g} s."
        part.objectives.append(asked(name, sentence, Swings(object=name, period=period, share=TWO_MODES)))
        part.objectives += to_and_fro(thing, name, "x", 1.0, cast)
    elif angle:
        sentence = f"{name} swings as a pendulum of its length does."
        part.objectives.append(Objective(kind="swings", object=name, sentence=sentence))
        part.objectives += to_and_fro(thing, name, "x", LESS**2 if "die" in thing.does else 1.0, cast)
    else:
        part.objectives.append(Objective(kind="settles", object=name, sentence=f"{name} hangs still."))
    part.duration = round(PERIODS * period, 1)
    x, drop = tidy(length * math.sin(math.radians(angle))), tidy(length * (1.0 - math.cos(math.radians(angle))))
    part.goes[name] = [(-x, 0.0, -drop), (-2 * x, 0.0, 0.0)]  # through its lowest point to the other side


def _rope_period(hanging: Hanging) -> float:
    """Of small swings of a body that turns freely at the end of a rope, the slower of its two modes [s].

    With a rope of l, the centre of mass h below its end and a radius of gyration k, w^2 is the smaller root of
    l^2 k^2 w^4 - g l (h^2 + k^2 + l h) w^2 + g^2 l h = 0 (the double pendulum of Goldstein, Classical Mechanics, ch. 6,
    with a rope that weighs nothing).
    """
    item, h = hanging.item, hanging.half
    rope = hanging.length - h
    if item.primitive == "box":
        gyration = (item.size[0] ** 2 + item.size[2] ** 2) / 12
    elif item.primitive == "sphere":
        gyration = 0.4 * item.size[0] ** 2
    else:
        lies = h == item.size[0]
        gyration = item.size[0] ** 2 / 2 if lies else item.size[0] ** 2 / 4 + tall(item) ** 2 / 12
    a, b, c = rope**2 * gyration, GRAVITY * rope * (h**2 + gyration + rope * h), GRAVITY**2 * rope * h
    return 2 * math.pi / math.sqrt((b - math.sqrt(b**2 - 4 * a * c)) / (2 * a))


def _damped(rod: PlanObject, bob: PlanObject, length: float, cast: Cast, thing: Thing) -> JointDrive:
    """A hinge that takes energy: of a swing the next half is so much smaller, exp(-c T / 4 I)."""
    masses = [item.mass or 0.0 for item in (rod, bob)]
    about = 0.4 * bob.size[0] ** 2 if bob.primitive == "sphere" else sum(edge**2 for edge in bob.size) / 12.0
    inertia = masses[0] * rod.size[1] ** 2 / 3.0 + masses[1] * (length**2 + about)
    moment = masses[0] * rod.size[1] / 2.0 + masses[1] * length
    period = 2.0 * math.pi * math.sqrt(inertia / (GRAVITY * moment))
    damping = round(-4.0 * inertia * math.log(LESS) / period, 5)
    cast.assume(
        thing.words, f"its hinge damps it with {damping:g} N m s/rad", f"each half swing {1 - LESS:.0%} smaller"
    )
    return JointDrive(velocity=0.0, damping=damping)


def _hanging(thing: Thing, cast: Cast, taken: set[str]) -> list[Hanging]:
    """The bodies that a thing hangs, each on its own rod or rope."""
    own, rope = thing.noun.family == "pendulum", thing.rod is not None and thing.rod.kind != "rod"
    asked = thing.phrase if own or thing.rod is None else thing.rod
    length = asked.length or asked.measures.get("x") or asked.measures.get("z")
    usual = ROPE_LENGTH if rope else ROD_LENGTH
    if length is None:
        length = usual
        choice = f"on a rope of {length:g} m" if rope else f"{length:g} m from the hinge to the bob's centre"
        cast.assume(thing.words, choice, "the prompt gives no length")
    if not 4 * SMALLEST <= length <= LARGEST:
        raise UserError(
            f"{thing.words!r}: {length:g} m is outside {4 * SMALLEST:g} to {LARGEST:g} m, a pendulum's range"
        )
    if rope:
        items = bodies(thing, cast, taken)
        lying = items[0].relation("LIES-ALONG-Y") is not None
        half = items[0].size[0] if lying or items[0].primitive == "sphere" else tall(items[0]) / 2
        return [Hanging(thing, item, length + half, half, rope) for item in items]
    return [Hanging(thing, item, length, radius, rope) for item, radius in _bobs(thing, length, own, cast, taken)]


def _bobs(thing: Thing, length: float, own: bool, cast: Cast, taken: set[str]) -> list[tuple[PlanObject, float]]:
    """The balls at the ends of rods, and their radius [m]."""
    material = material_of(thing, cast)
    if own:
        said = thing.phrase.measures.get("radius", thing.phrase.measures.get("diameter", 0.0) / 2)
        radius = said or round(min(thing.noun.size[0] * (thing.phrase.scale or 1.0), length / 3), 4)
        if not said:
            cast.assume(thing.words, f"a bob of radius {radius:g} m", "the prompt gives no size of it")
    else:
        radius = size_of(thing, material, 1000.0, cast)[0]
    if radius > 0.5 * length:
        raise UserError(f"{thing.words!r}: a ball of radius {radius:g} m is too large for a rod of {length:g} m")
    if thing.rod is not None and not own:
        cast.assume(thing.rod.words, "measured to the ball's centre", "that is the length of a pendulum")
    mass = thing.phrase.measures.get("mass")
    made = []
    for name in names(thing, taken):
        bob = PlanObject.proxy(
            name=name, role="rigid_body", primitive="sphere", size=(radius,), material=material, words=thing.words
        )
        if mass is not None:
            bob = bob.model_copy(update={"registration": bob.registration.model_copy(update={"mass": mass})})
        made.append((bob, radius))
    return made
