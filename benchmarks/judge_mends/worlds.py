"""Sound worlds whose plans can leave open what is wrong: drives, bounces, and what carries or holds."""

from __future__ import annotations

import math

from benchmarks.judge_worlds import WORLDS
from benchmarks.judge_worlds.by_hand import driven, variants
from benchmarks.judge_worlds.world import SoundWorld, planned, thing, with_drives
from wsim.judge.language import python as say
from wsim.plan.schema import Joint, Objective, Plan


def _asked(name: str, formula: object, sentence: str) -> Objective:
    return Objective(kind="formula", object=name, formula=formula, sentence=sentence)  # type: ignore[arg-type]


def sledge(way: float, material: str) -> Plan:
    """A drive moves a block along a level rail."""
    block = thing("block", "box", (0.2, 0.2, 0.2), (0.0, 0.0, 0.5), material,
                  registration=driven("position", "rail", way))  # fmt: skip
    rail = Joint(name="rail", kind="slider", child="block", axis="X")
    asked = [
        _asked("block", say.gone_between("block", "x", 0.95 * way, 1.05 * way), f"The block has gone {way:g} m."),
        Objective(kind="settles", object="block", sentence="The block stops."),
    ]
    return planned(f"A motor moves a block by {way:g} m along a rail", [block], asked, 3.0, [rail])


def lever(angle: float, material: str) -> Plan:
    """A drive turns a lever up."""
    arm = thing("arm", "box", (0.5, 0.05, 0.05), (0.25, 0.0, 0.6), material,
                registration=driven("position", "hub", -math.radians(angle)))  # fmt: skip
    hub = Joint(name="hub", kind="hinge", child="arm", anchor=(-0.25, 0.0, 0.0), axis="Y")
    turned = say.turned_between("arm", "y", -1.1 * angle, -0.9 * angle)
    asked = [
        _asked("arm", turned, f"The arm is turned up by {angle:g} degrees."),
        Objective(kind="settles", object="arm", sentence="The arm stops."),
    ]
    return planned(f"A motor turns an arm up by {angle:g} degrees", [arm], asked, 4.0, [hub])


def bounce(drop: float, restitution: float) -> Plan:
    """A ball falls and bounces up to the square of its restitution."""
    ball = thing("ball", "sphere", (0.06,), (0.0, 0.0, drop + 0.06), "rubber", restitution=restitution)
    height = round(restitution**2 * drop, 4)
    up = say.bounces_to("ball", "ground", height, 0.12 * height)
    asked = [_asked("ball", up, f"The ball bounces up to {height:g} m.")]
    return planned(f"A ball is dropped from {drop:g} m and bounces", [ball], asked, 1.5, frame_rate=60.0)


def shelf(height: float, material: str) -> Plan:
    """A cube stands on a shelf, and a ball lies in a tray beside it."""
    board = thing("board", "box", (0.8, 0.4, 0.04), (0.0, 0.0, height), "oak", state="static")
    cube = thing("cube", "box", (0.15, 0.15, 0.15), (-0.2, 0.0, height + 0.095), material)
    disc = thing("disc", "cylinder", (0.08, 0.06), (0.2, 0.0, height + 0.05), "steel")
    asked = [
        Objective(kind="rests_on", object="cube", ref="board", sentence="The cube stands on the board."),
        Objective(kind="stays_on", object="disc", ref="board", sentence="The disc stays on the board."),
        _asked("cube", say.always(say.upright("cube", 10.0)), "The cube stays upright."),
    ]
    return planned("A cube and a disc stand on a board", [board, cube, disc], asked, 1.5)


OPEN = (
    SoundWorld("sledge", "drives", variants(sledge, [(0.4, "oak"), (0.7, "steel"), (0.5, "pine"), (0.3, "brick")]),
               with_drives({"rail": "Drive(position=WAY, stiffness=2000.0, damping=800.0, max_force=4000.0)"})),
    SoundWorld("lever", "drives", variants(lever, [(40.0, "oak"), (60.0, "pine"), (30.0, "aluminium"), (50.0, "wood")]),
               with_drives({"hub": "Drive(position=WAY, stiffness=300.0, damping=60.0, max_force=400.0)"})),
    SoundWorld("bounce", "collisions", variants(bounce, [(0.5, 0.7), (0.8, 0.6), (1.0, 0.8), (0.6, 0.75)])),
    SoundWorld("shelf", "stacks", variants(shelf, [(0.5, "oak"), (0.8, "steel"), (0.3, "pine"), (0.6, "brick")])),
)  # fmt: skip
ALL = (*WORLDS, *OPEN)


def written(world: SoundWorld, plan: Plan) -> str:
    """The program of a plan; its drives go where the plan's actuations have them."""
    program = world.write(plan)
    for item in plan.objects:
        for each in item.registration.actuation:
            if "WAY" in program and each.target:
                turns = any(joint.name == each.joint and joint.kind == "hinge" for joint in plan.joints)
                program = program.replace(
                    "WAY", repr(round(math.degrees(each.target[0]) if turns else each.target[0], 6))
                )
    return program
