"""Sound worlds whose plans are written by hand: drives, sliders, chains, and collisions that no prompt describes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from benchmarks.judge_worlds.asked import asks, stays_upright
from benchmarks.judge_worlds.world import FINE_STEP, SoundWorld, planned, thing, with_drives
from wsim.judge.language import python as say
from wsim.plan.schema import Joint, Objective, Plan, PlanObject, Vec3
from wsim.plan.schema.objects import Actuation, Registration

STIFFNESS = 400.0  # of the spring [N/m]


def variants(make: Callable[..., Plan], arguments: Sequence[tuple[Any, ...]]) -> tuple[Callable[[], Plan], ...]:
    """A plan for each tuple of arguments."""
    return tuple(partial(make, *given) for given in arguments)


def driven(kind: str, joint: str, target: float) -> Registration:
    """What a plan says of a driven object: the joint's target, in rad or m, or per second."""
    return Registration(actuation=[Actuation(kind=kind, joint=joint, target=(target,))])  # type: ignore[arg-type]


def door(width: float, material: str) -> Plan:
    """A door on an upright hinge that a motor opens by 60 degrees."""
    leaf = thing(
        "door", "box", (width, 0.04, 1.0), (width / 2, 0.0, 0.6), material,
        registration=driven("position", "hinge", math.radians(60.0)),
    )  # fmt: skip
    hinge = Joint(
        name="hinge", kind="hinge", child="door", anchor=(-width / 2, 0.0, 0.0), axis="Z", limits=(-80.0, 90.0)
    )
    objectives = [
        Objective(kind="moves", object="door", direction="left", value=0.35 * width, sentence="The door opens."),
        Objective(kind="settles", object="door", sentence="The door stands open."),
    ]
    plan = planned("A motor opens a door by 60 degrees", [leaf], objectives, 4.0, [hinge])
    turn = math.radians(60.0)
    opened = (round(width / 2 * math.cos(turn), 4), round(width / 2 * math.sin(turn), 4), 0.6)
    reached = say.eventually(say.reaches("door", opened, 0.03), (0.0, 3.0))
    return asks(plan, "door", reached, "The door stands at 60 degrees within 3 s.")


def lift(height: float, load: str) -> Plan:
    """A platform on an upright slider that lifts a box."""
    deck = thing(
        "deck", "box", (0.6, 0.6, 0.05), (0.0, 0.0, 0.125), "aluminium",
        registration=driven("position", "rail", height),
    )  # fmt: skip
    cargo = thing("cargo", "box", (0.2, 0.2, 0.2), (0.0, 0.0, 0.25), load)
    rail = Joint(name="rail", kind="slider", child="deck", axis="Z", limits=(-0.5, 1.0))
    objectives = [
        Objective(kind="stays_on", object="cargo", ref="deck", sentence="The box stays on the deck."),
        Objective(kind="settles", object="deck", sentence="The deck stops at the top."),
    ]
    plan = planned(f"A lift raises a box by {height:g} m", [deck, cargo], objectives, 4.0, [rail])
    reached = say.eventually(say.reaches("deck", (0.0, 0.0, 0.125 + height), 0.05), (0.0, 2.5))
    return asks(plan, "deck", reached, f"The deck is {height:g} m up within 2.5 s.")


def wheel(radius: float, material: str) -> Plan:
    """A flywheel that a motor turns at half a turn a second."""
    disc = thing(
        "wheel", "cylinder", (radius, 0.06), (0.0, 0.0, 0.8), material, (90.0, 0.0, 0.0),
        registration=driven("velocity", "axle", math.pi),
    )  # fmt: skip
    pin = thing("pin", "box", (0.05, 0.05, 0.05), (0.8 * radius, -0.056, 0.8), "steel")
    axle = Joint(name="axle", kind="hinge", child="wheel", axis="Y")
    hold = Joint(name="hold", kind="fixed", parent="wheel", child="pin", anchor=(0.0, 0.0, 0.0))
    objectives = [Objective(kind="moves", object="pin", value=radius, sentence="The pin is carried to the other side.")]
    plan = planned("A motor turns a wheel by half a turn a second", [disc, pin], objectives, 3.0, [axle, hold])
    lowest = (0.0, -0.056, round(0.8 - 0.8 * radius, 4))
    passed = say.eventually(say.reaches("pin", lowest, 0.05), (0.4, 0.7))
    return asks(plan, "pin", passed, "The pin is at the bottom after a quarter of a turn, half a second.")


def spring(stretch: float, edge: float) -> Plan:
    """A block on a level slider with a spring: it swings about the spring's rest for ever.

    The run ends at the far end of the third swing.
    """
    block = thing(
        "block", "box", (edge, edge, edge), (0.0, 0.0, 0.5), "aluminium",
        registration=driven("position", "rail", stretch),
    )  # fmt: skip
    rail = Joint(name="rail", kind="slider", child="block", axis="X", limits=(-1.0, 1.0))
    objectives = [Objective(kind="moves", object="block", value=0.5 * stretch, sentence="The block swings.")]
    period = 2 * math.pi * math.sqrt(2700.0 * edge**3 / STIFFNESS)
    goes = {"block": [(2 * stretch, 0.0, 0.0)]}
    plan = planned("A block swings on a spring", [block], objectives, round(2.5 * period, 2), [rail], goes=goes)
    window = (round(0.45 * period, 3), round(0.55 * period, 3))
    far = say.eventually(say.reaches("block", (2 * stretch, 0.0, 0.5), 0.02), window)
    return asks(plan, "block", far, "The block is at the far end after half of sqrt(m / k) 2 pi.")


def at_rest(item: PlanObject) -> Vec3:
    """Where an object starts [m]."""
    assert item.pose is not None
    return item.pose.position


def cradle(angle: float, count: int) -> Plan:
    """Steel balls in a row on rods; the first is let go from the side."""
    radius, length, height = 0.05, 0.6, 0.9
    balls, rods, joints = [], [], []
    for k in range(count):
        turn = math.radians(angle) if k == 0 else 0.0
        x0, degrees = 0.103 * k, (angle if k == 0 else 0.0)

        def at(distance: float, x0: float = x0, turn: float = turn) -> tuple[float, float, float]:
            return (round(x0 - distance * math.sin(turn), 6), 0.0, round(height - distance * math.cos(turn), 6))

        rod_length = length - radius
        rods.append(
            thing(f"rod_{k}", "cylinder", (0.005, rod_length), at(rod_length / 2), "aluminium", (0, degrees, 0))
        )
        balls.append(thing(f"ball_{k}", "sphere", (radius,), at(length), "steel", (0, degrees, 0), restitution=0.9))
        anchor = (0.0, 0.0, rod_length / 2)
        joints.append(Joint(name=f"pivot_{k}", kind="hinge", child=f"rod_{k}", anchor=anchor, axis="Y"))
        hold = Joint(name=f"hold_{k}", kind="fixed", parent=f"rod_{k}", child=f"ball_{k}", anchor=(0.0, 0.0, radius))
        joints.append(hold)
    objectives = [
        Objective(kind="collides_with", object="ball_0", ref="ball_1", sentence="The first ball hits the row."),
    ]
    plan = planned("Newton's cradle", [*rods, *balls], objectives, 1.2, joints, 60.0, FINE_STEP)
    last = f"ball_{count - 1}"
    events = [say.touches("ball_0", "ball_1", 0.01), ~say.stays_within(last, at_rest(balls[-1]), 0.05)]
    return asks(plan, last, say.ordered(*events), "The last ball swings out after the first has hit the row.")


def chain(angle: float, arm: float) -> Plan:
    """A double pendulum let go from the side."""
    turn = math.radians(angle)

    def at(distance: float) -> tuple[float, float, float]:
        return (round(distance * math.sin(turn), 6), 0.0, round(1.6 - distance * math.cos(turn), 6))

    upper = thing("upper", "box", (0.04, 0.04, arm), at(arm / 2), "aluminium", (0.0, -angle, 0.0))
    lower = thing("lower", "box", (0.04, 0.04, arm), at(1.5 * arm), "aluminium", (0.0, -angle, 0.0))
    joints = [
        Joint(name="shoulder", kind="hinge", child="upper", anchor=(0.0, 0.0, arm / 2), axis="Y"),
        Joint(name="elbow", kind="hinge", parent="upper", child="lower", anchor=(0.0, 0.0, arm / 2), axis="Y"),
    ]
    objectives = [Objective(kind="moves", object="lower", value=0.02, sentence="The lower arm swings.")]
    return planned("A double pendulum", [upper, lower], objectives, 3.0, joints, frame_rate=60.0)


def ball_joint(angle: float, length: float) -> Plan:
    """A bob on a rod that hangs from a ball joint, let go half a swing before the end."""
    turn = math.radians(angle)

    def at(distance: float) -> tuple[float, float, float]:
        return (0.0, round(distance * math.sin(turn), 6), round(1.4 - distance * math.cos(turn), 6))

    rod = thing("rod", "cylinder", (0.008, length), at(length / 2), "aluminium", (angle, 0.0, 0.0))
    bob = thing("bob", "sphere", (0.07,), at(length + 0.07), "steel", (angle, 0.0, 0.0))
    joints = [
        Joint(name="pivot", kind="ball", child="rod", anchor=(0.0, 0.0, length / 2)),
        Joint(name="hold", kind="fixed", parent="rod", child="bob", anchor=(0.0, 0.0, 0.07)),
    ]
    objectives = [Objective(kind="moves", object="bob", direction="right", value=0.2, sentence="The bob swings.")]
    period = 2 * math.pi * math.sqrt((length + 0.07) / 9.81)
    return planned("A ball swings on a rod in any direction", [rod, bob], objectives, round(1.5 * period, 2), joints)


def bridge(gap: float, material: str) -> Plan:
    """A plank on two blocks carries a cube."""
    half = gap / 2 + 0.1
    blocks = [
        thing(f"block_{side}", "box", (0.2, 0.3, 0.3), (x, 0.0, 0.15), "brick", state="static")
        for side, x in (("a", -half), ("b", half))
    ]
    plank = thing("plank", "box", (gap + 0.36, 0.25, 0.04), (0.0, 0.0, 0.32), "oak")
    cube = thing("cube", "box", (0.12, 0.12, 0.12), (0.0, 0.0, 0.4), material)
    objectives = [
        Objective(kind="stays_on", object="cube", ref="plank", sentence="The cube stays on the plank."),
    ]
    plan = planned("A plank on two blocks carries a cube", [*blocks, plank, cube], objectives, 2.0)
    return stays_upright(plan)


def thin_wall(speed: float, thickness: float) -> Plan:
    """A small ball flies at a thin steel sheet, and bounces off."""
    sheet = thing("sheet", "box", (thickness, 1.0, 1.0), (1.0, 0.0, 0.5), "steel", state="static", restitution=0.5)
    ball = thing("ball", "sphere", (0.04,), (0.0, 0.0, 0.8), "rubber", velocity=(speed, 0.0, 0.0), restitution=0.5)
    objectives = [Objective(kind="collides_with", object="ball", ref="sheet", sentence="The ball hits the sheet.")]
    return planned("A ball bounces off a thin sheet", [sheet, ball], objectives, 0.6, frame_rate=60.0, time_step=1.5e-4)


def heavy_and_light(ratio: float, speed: float) -> Plan:
    """A block slides into another one and both go on."""
    first = thing(
        "striker", "box", (0.2, 0.2, 0.2), (-0.3, 0.0, 0.1), "wood", velocity=(speed, 0.0, 0.0), friction=0.1,
        registration=Registration(mass=round(4.0 * ratio, 3)),
    )  # fmt: skip
    second = thing(
        "target", "box", (0.2, 0.2, 0.2), (0.0, 0.0, 0.1), "pine", friction=0.1, registration=Registration(mass=4.0)
    )
    objectives = [
        Objective(kind="collides_with", object="striker", ref="target", sentence="The striker hits the target."),
        Objective(kind="moves", object="target", direction="front", value=0.1, sentence="The target is knocked on."),
    ]
    return planned("A block strikes another", [first, second], objectives, 2.0, frame_rate=60.0)


BY_HAND: tuple[SoundWorld, ...] = (
    SoundWorld(
        "door",
        "joints and drives",
        variants(door, [(0.6, "oak"), (0.8, "oak"), (0.5, "pine"), (0.7, "plastic")]),
        with_drives({"hinge": "Drive(position=60.0, stiffness=60.0, damping=30.0, max_force=200.0)"}),
    ),
    SoundWorld(
        "lift",
        "joints and drives",
        variants(lift, [(0.4, "oak"), (0.4, "pine"), (0.4, "plastic"), (0.4, "wood")]),
        with_drives({"rail": "Drive(position=0.4, stiffness=20000.0, damping=5000.0, max_force=1000.0)"}),
    ),
    SoundWorld(
        "wheel",
        "joints and drives",
        variants(wheel, [(0.3, "oak"), (0.4, "pine"), (0.25, "aluminium"), (0.35, "plastic")]),
        with_drives({"axle": "Drive(velocity=180.0, damping=20.0, max_force=200.0)"}),
    ),
    SoundWorld(
        "spring",
        "joints and drives",
        variants(spring, [(0.3, 0.2), (0.3, 0.25), (0.3, 0.15), (0.3, 0.22)]),
        with_drives({"rail": f"Drive(position=0.3, stiffness={STIFFNESS})"}),
    ),
    SoundWorld("cradle", "collisions", variants(cradle, [(30.0, 3), (20.0, 3), (30.0, 2), (20.0, 4)])),
    SoundWorld("chain", "pendulums", variants(chain, [(40.0, 0.5), (90.0, 0.5), (60.0, 0.4), (120.0, 0.5)])),
    SoundWorld("ball joint", "pendulums", variants(ball_joint, [(25.0, 0.7), (35.0, 0.7), (20.0, 0.9), (40.0, 0.5)])),
    SoundWorld("bridge", "stacks", variants(bridge, [(0.4, "oak"), (0.5, "steel"), (0.3, "brick"), (0.6, "pine")])),
    SoundWorld("thin sheet", "collisions", variants(thin_wall, [(4.0, 0.02), (6.0, 0.02), (3.0, 0.01), (5.0, 0.03)])),
    SoundWorld("strike", "collisions", variants(heavy_and_light, [(1.0, 3.0), (3.0, 3.0), (2.0, 2.5), (0.5, 4.0)])),
)
