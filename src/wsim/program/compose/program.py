"""The whole program: its parts in their order, and how long it is simulated."""

from __future__ import annotations

from wsim.defaults import FRAME_RATE
from wsim.plan.schema import Plan, SimulationPlan
from wsim.program.compose import (
    cameras,
    contacts,
    cords,
    joints,
    materials,
    objects,
    openings,
    robots,
    schedules,
    vehicles,
    words,
)  # fmt: skip
from wsim.program.compose.draft import Draft
from wsim.program.source import call, number


def compose(plan: Plan) -> str:
    """Write the program that builds a plan.

    The same plan gives the same text. Free text of the plan (title, words, assumptions) appears in the docstring and
    in comments only, where it cannot end them.

    Args:
        plan: A laid-out plan: every solid object has a pose.

    Raises:
        UserError: If an object that takes up space has no pose.
    """
    draft = Draft(plan)
    # In this order: the names of materials are taken first, and joints speak of objects by their variables.
    drivers = vehicles.drivers(draft)
    body = [
        *words.assumptions(plan),
        *materials.statements(draft),
        *objects.statements(draft),
        *joints.statements(draft),
        *cords.statements(draft),
        *robots.policies(draft),
        *robots.motions(draft),
        *vehicles.set_off(draft),
        *contacts.statements(plan),
        *schedules.statements(draft),
        *openings.statements(plan),
        *cameras.statements(plan),
        *_simulation(plan.simulation),
    ]
    named = {"Scene", *draft.imports, *(["Drive"] if any(joint.drive for joint in plan.joints) else [])}
    constants = [*draft.constants(), *drivers]
    lines = [
        *words.docstring(plan),
        "",
        f"from wsim.scene import {', '.join(sorted(named))}",
        *(["", *constants] if constants else []),
        "",
        "",
        "def build(scene: Scene) -> None:",
        '    """Author the world."""',
        *body,
        *vehicles.control(draft),
        "",
        "",
        'if __name__ == "__main__":',
        "    from wsim import run",
        "",
        "    run(build)",
    ]
    return "\n".join(lines) + "\n"


def _simulation(simulation: SimulationPlan) -> list[str]:
    arguments = [f"duration={number(simulation.duration)}"]
    if simulation.frame_rate != FRAME_RATE:
        arguments.append(f"frame_rate={number(simulation.frame_rate)}")
    if simulation.time_step:
        arguments.append(f"time_step={number(simulation.time_step)}")
    if simulation.seed:
        arguments.append(f"seed={simulation.seed}")
    return call("scene.simulation", arguments)
