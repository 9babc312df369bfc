"""A sound world: plans in a few variants, and how each becomes a program."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from wsim.plan.schema import Joint, Objective, Plan, PlanObject, Pose, SimulationPlan, Vec3
from wsim.plan.views import cameras
from wsim.program.compose import compose
from wsim.rules.materials import material_named
from wsim.rules.planner import plan as plan_prompt
from wsim.rules.scenes.motion import ground_object

FRAME_RATE = 30.0  # of the worlds that no prompt makes [1/s]

FINE_STEP = 4e-4  # of worlds with hits so hard that bodies sink into each other at the simulator's own choice [s]

Change = Callable[[Plan], Plan]


@dataclass(frozen=True)
class SoundWorld:
    """A world that does what its plan asks, in a few variants.

    Attributes:
        name: As faults and tables call it.
        family: Row of the table of sound worlds.
        plans: One for each variant.
        write: The program of a plan.
    """

    name: str
    family: str
    plans: tuple[Callable[[], Plan], ...]
    write: Callable[[Plan], str] = compose


def prompted(family: str, name: str, *prompts: str, change: Change = lambda plan: plan) -> SoundWorld:
    """A world that the builtin planner plans, a variant for each prompt."""
    return SoundWorld(name, family, tuple(partial(_of_prompt, prompt, change) for prompt in prompts))


def _of_prompt(prompt: str, change: Change) -> Plan:
    return change(filmed(plan_prompt(prompt)))


def filmed(plan: Plan) -> Plan:
    """The plan with cameras that see where its loose bodies go, and not only where they start."""
    if plan.joints or any(item.primitive in ("fluid", "tank") for item in plan.objects):
        return plan
    marks = []
    for item in plan.objects:
        if item.state != "dynamic" or item.pose is None:
            continue
        (x, y, z), (vx, vy, vz) = item.pose.position, item.velocity
        ways = [(x + vx * t, y + vy * t, max(0.05, z + vz * t - 4.905 * t**2)) for t in (0.3, 0.6, 0.9, 1.2)]
        marks += [thing(f"{item.name}_{k}", "box", (0.1, 0.1, 0.1), at, state="static") for k, at in enumerate(ways)]
    whole = plan.model_copy(update={"objects": [*plan.objects, *marks]})
    return plan.model_copy(update={"cameras": cameras(whole)})


def planned(
    title: str,
    objects: Sequence[PlanObject],
    objectives: Sequence[Objective],
    duration: float,
    joints: Sequence[Joint] = (),
    frame_rate: float = FRAME_RATE,
    time_step: float = 0.0,
    goes: Mapping[str, Sequence[Vec3]] | None = None,
) -> Plan:
    """A plan written by hand: the objects with their poses stand on the ground, seen from the side and from above.

    `goes` says where else objects come from their starts [m], by name, for the cameras to show.
    """
    whole = Plan(
        title=title,
        prompt=title,
        objects=[ground_object(), *objects],
        joints=list(joints),
        objectives=list(objectives),
        simulation=SimulationPlan(duration=duration, frame_rate=frame_rate, time_step=time_step),
    )
    return filmed(Plan.model_validate({**whole.model_dump(), "cameras": cameras(whole, above=0.0, goes=goes)}))


def thing(
    name: str,
    primitive: str,
    size: tuple[float, ...],
    position: Vec3,
    material: str = "wood",
    turned: Vec3 = (0.0, 0.0, 0.0),
    **fields: Any,
) -> PlanObject:
    """An object of a plan, of a material of the lexicon; those that move are rigid bodies."""
    surface = {key: fields.pop(key) for key in ("friction", "restitution", "color") if key in fields}
    role = "background" if fields.get("state") == "static" else "rigid_body"
    return PlanObject.proxy(
        name=name,
        role=role,
        primitive=primitive,  # type: ignore[arg-type]
        size=size,
        material=material_named(material).model_copy(update=surface),
        pose=Pose(position=position, rotation_deg=turned),
        **fields,
    )


def with_arguments(program: str, call: str, **arguments: str) -> str:
    """A program in which the call that makes the prim `call` has further keyword arguments, given as source.

    Raises:
        ValueError: If no call makes a prim of that name.
    """
    tree = ast.parse(program)
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant)):
            continue
        if node.args[0].value == call:
            node.keywords = [keyword for keyword in node.keywords if keyword.arg not in arguments]
            node.keywords += [
                ast.keyword(name, ast.parse(value, mode="eval").body) for name, value in arguments.items()
            ]
            return ast.unparse(tree) + "\n"
    raise ValueError(f"no call of the program makes {call!r}")


def with_drives(drives: dict[str, str]) -> Callable[[Plan], str]:
    """How to write the program of a plan whose joints have motors: `Drive(...)`, as source, by joint."""

    def write(plan: Plan) -> str:
        program = compose(plan).replace("import Scene\n", "import Drive, Scene\n", 1)
        for joint in plan.joints:
            if joint.name in drives:
                program = with_arguments(program, joint.name, drive=drives[joint.name])
        return program

    return write
