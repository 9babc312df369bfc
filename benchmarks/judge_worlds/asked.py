"""What a plan asks for beyond what the builtin planner writes: when, how far, in which order, and upright."""

from __future__ import annotations

import math

from wsim.judge.language import python as say
from wsim.plan.schema import Objective, Plan
from wsim.plan.schema.formula import Formula

G = 9.81


def asks(plan: Plan, name: str, formula: Formula, sentence: str) -> Plan:
    """The plan with one more objective."""
    more = Objective(kind="formula", object=name, formula=formula, sentence=sentence)
    return plan.model_copy(update={"objectives": [*plan.objectives, more]})


def lands_in_time(plan: Plan) -> Plan:
    """What is dropped lands when a free fall ends, to a fifth of a second."""
    name = plan.objectives[0].object
    item = plan.object(name)
    assert item.pose is not None
    fall = math.sqrt(2 * (item.pose.position[2] - item.size[2] / 2) / G)
    formula = say.eventually(say.touches(name, "ground"), (0.0, round(fall + 0.2, 2)))
    return asks(plan, name, formula, f"{name} has landed after a free fall.")


def slides_so_far(plan: Plan) -> Plan:
    """What slides on the ground stops where friction has taken its speed, v^2 / 2 mu g, to a tenth of the way."""
    name = plan.objectives[0].object
    item = plan.object(name)
    assert item.pose is not None and item.material is not None
    ground = plan.object("ground").material
    friction = min(item.material.friction, ground.friction if ground is not None else 0.5)  # the weaker one counts
    speed = math.hypot(*item.velocity[:2])
    way = speed**2 / (2 * friction * G)
    x, y, z = item.pose.position
    end = (round(x + way * item.velocity[0] / speed, 4), round(y + way * item.velocity[1] / speed, 4), z)
    formula = say.finally_(say.stays_within(name, end, round(0.1 * way + 0.02, 3)))
    return asks(plan, name, formula, f"{name} stops after {way:.2f} m.")


def stays_upright(plan: Plan) -> Plan:
    """Nothing that stands tips over."""
    for objective in plan.objectives:
        name = objective.object
        if plan.object(name).primitive != "sphere":
            plan = asks(plan, name, say.always(say.upright(name, 10.0)), f"{name} stays upright.")
    return plan


def fall_in_order(plan: Plan) -> Plan:
    """The last domino falls after the first: in between two of them lean on each other, in the same frame."""
    names = [item.name for item in plan.objects if item.name.startswith("domino_")]
    formula = say.ordered(*(~say.upright(name, 20.0) for name in (names[0], names[-1])))
    return asks(plan, names[0], formula, "The first domino falls before the last.")
