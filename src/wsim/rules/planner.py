"""The builtin planner: a prompt becomes a plan by rules, offline, without a language model.

It never invents and never skips: every word of the prompt is consumed by a rule (the only words without a meaning of
their own are articles and joiners), and every choice that the prompt left open is an `Assumption` of the plan.

A prompt that physics contradicts ("a steel block floats") is planned as it was said: what must happen is the user's to
say, and whether it does is the judge's to find, with evidence. An assumption that starts with "warning:" says
beforehand that it will not. A prompt that contradicts itself ("a ball floats and sinks") is refused.
"""

from __future__ import annotations

import re

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.asked.tied import tied
from wsim.plan.feasible.plan import refuse_impossible
from wsim.plan.layout import layout
from wsim.plan.layout.bodies import around
from wsim.plan.layout.land import set_down
from wsim.plan.schema import Plan, SimulationPlan
from wsim.plan.views import cameras
from wsim.rules.built import check_built
from wsim.rules.cast import Cast
from wsim.rules.grammar import parse
from wsim.rules.holds import holding
from wsim.rules.lexicon import lexicon
from wsim.rules.meaning import understand
from wsim.rules.scenes.bounce import contacts
from wsim.rules.scenes.carried import build_carried
from wsim.rules.scenes.catalogue import as_they_are, themselves
from wsim.rules.scenes.crossing import build_crossing
from wsim.rules.scenes.drive import build_drive
from wsim.rules.scenes.flowing import build_flowing
from wsim.rules.scenes.ground import build_ground
from wsim.rules.scenes.incline import build_inclines
from wsim.rules.scenes.motion import ground_object
from wsim.rules.scenes.part import Part, tidy
from wsim.rules.scenes.patrol import build_patrol
from wsim.rules.scenes.pendulum import build_pendulums
from wsim.rules.scenes.pour import build_pour
from wsim.rules.scenes.rain import build_rain
from wsim.rules.scenes.seesaw import build_seesaws
from wsim.rules.scenes.tank import build_tank
from wsim.rules.scenes.timed import hold
from wsim.rules.scenes.vessel import LASTS, add_liquid, look_in
from wsim.rules.steps import steps
from wsim.rules.ties import tied_to
from wsim.rules.tokens import NotUnderstood
from wsim.rules.wet import check_wet

__all__ = ["NotUnderstood", "plan"]

FRAME_RATE = 24.0  # [1/s]: the cinema's; a fifth fewer pictures than 30
LANE = 0.4  # between parts of a scene that have places of their own [m]
LONGEST = 60.0  # that a prompt may ask for [s]


def plan(prompt: str) -> Plan:
    """The plan for a prompt about things in a tank of water, on the ground, on tables, ramps, belts, hinges or wheels.

    Raises:
        NotUnderstood: names the words that no rule took.
        UserError: the prompt contradicts itself or asks for more than the planner builds.
    """
    cast = understand(parse(prompt))
    scene = _scene(cast)
    hold(cast, scene)
    scene.duration = max([scene.duration, *(hung.duration for hung in scene.hung)])
    scene.frame_rate = max([scene.frame_rate, *(hung.frame_rate for hung in scene.hung)])
    vessel = holding(cast)
    scene.duration = max(scene.duration, LASTS if vessel is not None else 0.0)
    duration = _duration(cast, scene)
    _note_what_is_common(cast, prompt, duration, scene)
    joined = {name for joint in scene.joints for name in (joint.child, joint.parent) if name is not None}
    objects = add_liquid(vessel, scene, themselves(scene.objects, scene.names, cast, joined), cast)
    common = {
        "title": " ".join(prompt.split()).rstrip("."),
        "prompt": prompt,
        "openings": scene.openings,
        "simulation": SimulationPlan(
            duration=duration, spacing=scene.spacing, frame_rate=scene.frame_rate or FRAME_RATE
        ),
    }
    placed = layout(Plan(objects=objects, **common))
    _hang(scene, placed, cast)
    ties = {"joints": scene.joints, "cords": scene.cords, "schedules": scene.schedules}
    whole = set_down(Plan(objects=[*placed.objects, *scene.posed], **ties, **common))
    inside = [look_in(whole.object(scene.names[id(vessel)][-1]))] if vessel is not None else []
    made = tied(
        Plan.model_validate(
            {
                **whole.model_dump(),
                "contacts": [*scene.contacts, *contacts(cast, scene.names, whole)],
                "objectives": as_they_are(scene.objectives, whole.objects),
                "cameras": scene.cameras or [*cameras(whole, above=scene.surface, goes=scene.goes), *inside],
                "steps": steps(whole),
                "assumptions": cast.assumptions,
            }
        )
    )
    check_built(made, cast, scene.names)
    check_wet(made, cast)
    refuse_impossible(made, "the builtin planner's plan of this")
    return tied_to(made, cast, scene.names)


def _scene(cast: Cast) -> Part:
    """Parts side by side: the tank, what has places of its own, and the row of what stands on the ground."""
    taken = {"ground", "side", "top", "hold"}
    scene = Part(objects=[ground_object(cast.ground)])
    crossing = build_crossing(cast, taken)
    if crossing.objects:
        scene.add(crossing)
        return scene
    if cast.wet:
        scene.add(build_tank(cast, taken))
    scene.hung = build_pendulums(cast, taken)
    for hung in scene.hung:
        scene.names |= hung.names
    for build in (build_inclines, build_carried, build_seesaws):
        for made in build(cast, taken):
            scene.add(made.shifted(_free(scene, made)))
    for alone in (build_pour, build_flowing, build_rain, build_patrol, build_drive):
        scene.add(alone(cast, taken))
    if any(thing.place == "ground" and id(thing) not in scene.names for thing in cast.things) and not (
        cast.pour or cast.flows
    ):
        scene.add(build_ground(cast, taken, scene))
    if any(item.primitive == "terrain" for item in scene.posed):
        scene.objects = scene.objects[1:]  # the level ground
    return scene


def _hang(scene: Part, placed: Plan, cast: Cast) -> None:
    """Set what hangs beside all the rest, or above what it is said to, once that has its place."""
    beside = Part(objects=[item for item in placed.objects if item.primitive != "ground"])
    beside.posed = [*scene.posed]
    for hung in scene.hung:
        mine = [one for one in cast.things if id(one) in hung.names and one.support is not None]
        over = next((one for one in mine if id(one.support) not in hung.names), None)  # what stands in it is not hung
        if over is not None and over.support is not None:
            crowd = [one.words for one in cast.things if one.support is over.support and one is not over]
            if crowd:
                raise UserError(
                    f"{over.words!r}: the builtin planner hangs it above a bare table; leave {crowd[0]!r} out"
                )
            scene.add(hung.above(around(placed.object(scene.names[id(over.support)][-1]))))
            continue
        moved = hung.shifted(_free(beside, hung))
        scene.add(moved)
        beside.add(moved)


def _free(scene: Part, made: Part) -> float:
    """How far along Y a part has to go to be beside what is there [m]."""
    _, high = scene.span
    if not any(item.pose is not None for item in (*scene.objects, *scene.posed)):
        tank = next((item for item in scene.objects if item.primitive == "tank"), None)
        if tank is None:
            return 0.0
        high = tank.size[1] / 2 + WALL
    return tidy(high + LANE - made.span[0])


def _duration(cast: Cast, scene: Part) -> float:
    if cast.duration is None:
        return scene.duration
    if not 0.1 <= cast.duration <= LONGEST:
        raise UserError(f"{cast.duration:g} s is outside 0.1 to {LONGEST:g} s, the builtin planner's range")
    return cast.duration


def _note_what_is_common(cast: Cast, prompt: str, duration: float, scene: Part) -> None:
    words = re.findall(r"[a-z]+", prompt.lower())
    level = not any(item.primitive == "terrain" for item in scene.posed)
    if level and not set(words) & set(lexicon().words_of("GROUND")):
        cast.assume("scene", "on level ground", "something has to carry it")
    if cast.duration is None:
        what = "the way, and time" if scene.cameras else "time"
        cast.assume("scene", f"{duration:g} s long", f"{what} to come to rest; the prompt gives no duration")
    if "then" in words and all(thing.delay is None for thing in cast.things):
        cast.assume("scene", "everything starts at once", "'then' gives no time, as 'after two seconds' does")
    views = ", ".join(camera.name for camera in scene.cameras) or "side and top"
    cast.assume("cameras", views, "the prompt names no view")
