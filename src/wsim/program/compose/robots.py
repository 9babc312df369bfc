"""Arguments of `scene.robot`, the policies that walk robots, and what their links and joints do by time."""

from __future__ import annotations

import json

from wsim.errors import UserError
from wsim.plan.schema import Actuation, ArcPlan, FromRobot, PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position
from wsim.program.source import call, number, tuple_of

UPRIGHT = 1e-6  # [deg]: as far as a robot may lean


def arguments(item: PlanObject) -> list[str]:
    """All arguments but the name.

    Raises:
        UserError: If the plan gives it what is its own, or leans it.
    """
    weighed = item.registration.mass is not None or item.registration.density is not None
    turn = item.pose.rotation_deg if item.pose is not None else (0.0, 0.0, 0.0)
    for what, given in (
        ("velocity", any(item.velocity)),
        ("angular_velocity_deg", any(item.angular_velocity_deg or ())),
        ("material", item.material is not None),
        ("registration.mass or .density", weighed),
        ('state "kinematic"', item.state == "kinematic"),
        ("roll or pitch", max(abs(turn[0]), abs(turn[1])) > UPRIGHT),
    ):
        if given:
            raise UserError(f"{item.name}: a robot stands at rest with its own {what}; remove it")
    found = [json.dumps(item.built.robot) if isinstance(item.built, FromRobot) else ""]
    found.append(f"position={tuple_of(position(item))}")
    return [*found, *([f"yaw_deg={number(turn[2])}"] if turn[2] else [])]


def moved(item: PlanObject) -> bool:
    """Whether a policy walks it, or it goes by time."""
    kinds = {each.kind for each in item.registration.actuation}
    return item.primitive == "robot" and not kinds.isdisjoint(("policy", "reach", "follow", "schedule"))


def motions(draft: Draft) -> list[str]:
    """A call for each reach, way and schedule of a robot."""
    lines: list[str] = []
    for item in draft.plan.objects:
        for each in item.registration.actuation if item.primitive == "robot" else ():
            if each.kind in _CALLS:
                method, given = _CALLS[each.kind], _CALLED[each.kind](each)
                lines += call(f"{draft.handles[item.name]}.{method}", given)
    return lines


def _goal(each: Actuation) -> list[str]:
    """What `reach` and `follow` share."""
    found = [f"point={tuple_of(each.point)}"] if each.point else []
    found += [f"rotation_deg={tuple_of(each.rotation_deg)}"] if each.rotation_deg else []
    return [*found, *([f"start={number(each.start)}"] if each.start else [])]


def _reach(each: Actuation) -> list[str]:
    return [json.dumps(each.link), f"position={tuple_of(each.path[0])}", *_goal(each), f"by={number(each.times[0])}"]


def _follow(each: Actuation) -> list[str]:
    path = f"[{', '.join(map(tuple_of, each.path))}]"
    return [json.dumps(each.link), f"path={path}", f"times={_list(each.times)}", *_goal(each)]


def _schedule(each: Actuation) -> list[str]:
    return [json.dumps(each.joint), f"times={_list(each.times)}", f"positions={_list(each.target)}"]


def _list(values: tuple[float, ...]) -> str:
    return f"[{', '.join(map(number, values))}]"


_CALLS = {"reach": "reach", "follow": "follow", "schedule": "drive"}
_CALLED = {"reach": _reach, "follow": _follow, "schedule": _schedule}


def policies(draft: Draft) -> list[str]:
    """A call for each policy that walks a robot along a route."""
    lines: list[str] = []
    for item in draft.plan.objects:
        for each in item.registration.actuation if item.primitive == "robot" else ():
            if not each.policy:
                continue
            given = [f'"{item.name}_walk"', draft.handles[item.name], json.dumps(each.policy)]
            if each.route:
                route = draft.variable(f"{item.name}_route")
                lines += [
                    f"    {route} = (",
                    *(f"        {tuple_of(leg)}," for leg in each.route if not isinstance(leg, ArcPlan)),
                    "    )",
                ]
                given.append(f"route={route}")
            if each.speed:
                given.append(f"speed={number(each.speed)}")
            lines += call("scene.policy", given)
    return lines
