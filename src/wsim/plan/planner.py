"""The builtin planner: a prompt becomes a plan by rules, offline, without a language model.

It never invents and never skips: every word of the prompt is consumed by a rule (the only words without a meaning of
their own are articles and joiners), and every choice that the prompt left open is an `Assumption` of the plan.

A prompt that physics contradicts ("a steel block floats") is planned as it was said: what must happen is the user's to
say, and whether it does is the judge's to find, with evidence. An assumption that starts with "warning:" says
beforehand that it will not. A prompt that contradicts itself ("a ball floats and sinks") is refused.
"""

from __future__ import annotations

from wsim.plan.cast import Cast
from wsim.plan.grammar import NotUnderstood, parse
from wsim.plan.ground_scene import build_ground, ground_object
from wsim.plan.layout import layout
from wsim.plan.meaning import understand
from wsim.plan.schema import Objective, Plan, PlanObject, SimulationPlan
from wsim.plan.tank_scene import build_tank
from wsim.plan.views import cameras
from wsim.plan.words import GROUND

__all__ = ["NotUnderstood", "plan"]

FRAME_RATE = 24.0  # [1/s]: the cinema's; a fifth fewer pictures than 30


def plan(prompt: str) -> Plan:
    """The plan for a prompt about things in a tank of water or on the ground, laid out and validated.

    Raises:
        NotUnderstood: names the words that no rule took.
        UserError: the prompt contradicts itself or asks for more than the planner builds.
    """
    cast = understand(parse(prompt))
    taken = {"ground", "side", "top"}
    objects: list[PlanObject] = [ground_object()]
    objectives: list[Objective] = []
    duration = 0.0
    spacing = 0.0
    surface = None
    if cast.wet:
        tank = build_tank(cast, taken)
        objects += tank.objects
        objectives += tank.objectives
        duration, spacing, surface = tank.duration, tank.spacing, tank.surface
    if any(thing.place == "ground" for thing in cast.things):
        ground = build_ground(cast, taken, behind="tank" if cast.wet else None)
        objects += ground.objects
        objectives += ground.objectives
        duration = max(duration, ground.duration)
    _note_what_is_common(cast, prompt, duration)
    draft = Plan(
        title=" ".join(prompt.split()).rstrip("."),
        prompt=prompt,
        objects=objects,
        objectives=objectives,
        simulation=SimulationPlan(duration=duration, spacing=spacing, frame_rate=FRAME_RATE),
        assumptions=cast.assumptions,
    )
    placed = layout(draft)
    return Plan.model_validate({**placed.model_dump(), "cameras": cameras(placed, above=surface)})


def _note_what_is_common(cast: Cast, prompt: str, duration: float) -> None:
    words = prompt.lower().replace(",", " ").replace(".", " ").split()
    if not set(words) & GROUND:
        cast.assume("scene", "on level ground", "something has to carry it")
    cast.assume("scene", f"{duration:g} s long", "time to come to rest; the prompt gives no duration")
    if "then" in words:
        cast.assume(
            "scene", "everything starts at once", "'then' gives no time, and the builtin planner schedules nothing"
        )
    cast.assume("cameras", "side and top", "the prompt names no view")
