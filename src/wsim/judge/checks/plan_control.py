"""Check of what steers a world: `control`, policies, and what robots do by time, against the plan."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.checks.planned_schedules import Unlike, differing, unlike
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within
from wsim.scene.world import JointPath, Reach, Schedule

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Actuation, Plan, SchedulePlan

_TIMED = ("reach", "follow", "schedule")  # kinds of actuation


@dataclass
class CheckPlanControl(Check):
    """A world is steered by `control` where the plan asks for it, and only there: unseen hands could do anything."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding where the plan asks for control or the program has one, none for another world."""
        plan, facts = evidence.plan, evidence.recording.metadata
        controlled = bool(facts.get("steered", facts.get("controlled")))
        if plan is None:
            return []
        driven = {joint.prim for joint in evidence.world.joints if joint.drive is not None}
        asked = [
            item.name
            for item in plan.objects
            for each in item.registration.actuation
            if each.kind not in ("drive", *_TIMED)  # those are set on the stage
            if each.joint is None or evidence.prim(each.joint) not in driven  # else its drive does it
            if not _by_schedule(plan, item.name, each.joint)
            if controlled or not _by_policy(evidence, item.name, each.joint)
        ]
        asked += [step.title for step in plan.steps if step.asks_for_control]
        idle = [
            item.name
            for item in plan.objects
            if not controlled and any(each.policy for each in item.registration.actuation)
            and not _by_policy(evidence, item.name, None)
        ]  # fmt: skip
        if idle:
            target = RepairTarget(kind="controller", prim=evidence.prim(idle[0]), parameter="policy", direction="add")
            return [self.failed(f"The plan lets a policy walk {idle[0]}, and none does", target=target)]
        for wrong in (self._by_time(evidence, plan), self._scheduled(evidence, plan)):
            if wrong is not None:
                return [wrong]
        if bool(asked) == controlled:
            return [self.passed(f"The plan asks for control: {asked[0]}")] if asked else []
        message = (
            "The program's control acts on the world, and the plan asks for none: what happens may be its doing"
            if controlled
            else f"The plan asks for control ({asked[0]}), and the program has no control(world, t)"
        )
        return [
            self.failed(
                message,
                limit_from="a step that names control, or an object's actuation",
                target=RepairTarget(
                    kind="controller", parameter="control", direction="remove" if controlled else "add"
                ),
            )
        ]

    def _by_time(self, evidence: Evidence, plan: Plan) -> Finding | None:
        """What of the plan's reaches, ways and schedules the stage lacks, or has beside them."""
        left: list[JointPath | Reach] = [*evidence.world.joint_paths, *evidence.world.reaches]
        for item in plan.objects:
            for each in (one for one in item.registration.actuation if one.kind in _TIMED):
                found = next((said for said in left if _says(evidence, item.name, each, said)), None)
                if found is None:
                    prim = evidence.prim(item.name)
                    target = RepairTarget(kind="controller", prim=prim, parameter=each.kind, direction="add")
                    other = next(filter(None, (_otherwise(evidence, item.name, each, said) for said in left)), None)
                    said = f"The plan has a {each.kind} of {item.name} that the stage has not"
                    if other is None:
                        return self.failed(said, target=target)
                    return self.failed(f"{said}: it has {other.says}", target=target, **other.numbers)
                left.remove(found)
        if not left:
            return None
        prim = left[0].link if isinstance(left[0], Reach) else left[0].prim
        return self.failed(
            f"The stage moves {prim} by time, and the plan does not",
            target=RepairTarget(kind="controller", prim=prim, direction="remove", why="the plan does not have it"),
        )

    def _scheduled(self, evidence: Evidence, plan: Plan) -> Finding | None:
        """The first of the plan's schedules that the stage lacks, has otherwise, or has beside them."""
        left = list(evidence.world.schedules)
        own = [(each, next((said for said in left if _is_of(evidence, each, said)), None)) for each in plan.schedules]
        called = {said.prim: each.name for each, said in own if said is not None}
        for each, found in own:
            if found is None:
                target = RepairTarget(kind="program", parameter="scene.schedule", direction="add", text=each.name)
                said = f"The plan's schedule {each.name}, the {each.quantity} of {_of(each)}, is not in the stage"
                return self.failed(said, target=target)
            left.remove(found)
            if not evidence.varied and (other := unlike(evidence, each, found, called)) is not None:
                target = RepairTarget(kind="program", parameter="scene.schedule", direction="change", text=each.name)
                said = f"The schedule {each.name} of the {each.quantity} of {_of(each)} has {other.says}"
                return self.failed(said, line=found.line, target=target, **other.numbers)
        if not left:
            return None
        said = f"The stage schedules the {left[0].quantity} of {left[0].target}, and the plan does not"
        target = RepairTarget(kind="program", parameter="scene.schedule", direction="remove", why="the plan has it not")
        return self.failed(said, line=left[0].line, target=target)


def _of(planned: SchedulePlan) -> str:
    return planned.of if isinstance(planned.of, str) else " and ".join(planned.of)


def _by_schedule(plan: Plan, name: str, joint: str | None) -> bool:
    """Whether a schedule is of what an object's actuation drives."""
    return any(each.of == (joint or name) for each in plan.schedules)


def _is_of(evidence: Evidence, planned: SchedulePlan, said: Schedule) -> bool:
    """Whether a schedule of the stage is of the same quantity of the same thing, whatever it is called."""
    if said.quantity != planned.quantity:
        return False
    if isinstance(planned.of, str):
        return said.target == evidence.prim(planned.of)
    pair = next((pair for pair in evidence.world.contacts if pair.prim == said.target), None)
    return pair is not None and {pair.first, pair.second} == {evidence.prim(name) for name in planned.of}


def _says(evidence: Evidence, name: str, actuation: Actuation, said: JointPath | Reach) -> bool:
    """Whether the stage says by time just what the plan lets a robot's link or joint do."""
    return _is_same(evidence, name, actuation, said) and _otherwise(evidence, name, actuation, said) is None


def _is_same(evidence: Evidence, name: str, actuation: Actuation, said: JointPath | Reach) -> bool:
    """Whether the stage says anything of that link or joint, in that way."""
    robot = evidence.prim(name)
    if isinstance(said, JointPath):
        return actuation.kind == "schedule" and said.prim == f"{robot}/joints/{actuation.joint}"
    own = actuation.kind in ("reach", "follow") and said.link == f"{robot}/{actuation.link}"
    return own and said.straight == (actuation.kind == "follow")


def _otherwise(evidence: Evidence, name: str, actuation: Actuation, said: JointPath | Reach) -> Unlike | None:
    """In what the stage says otherwise what the plan lets the same link or joint do; None where it does not."""
    if not _is_same(evidence, name, actuation, said):
        return None
    times = differing("times", said.times, actuation.times, "s")
    if isinstance(said, JointPath):
        slides = any(each.prim == said.prim and each.kind == "prismatic" for each in evidence.world.joints)
        unit, size = ("m", 1.0) if slides else ("deg", math.radians(1.0))
        return times or differing("positions", [each / size for each in said.positions], actuation.target, unit)
    point = differing("point", said.point, actuation.point or (0.0, 0.0, 0.0), "m")
    return times or point or differing("way", np.ravel(said.positions), np.ravel(actuation.path), "m")


def _by_policy(evidence: Evidence, name: str, joint: str | None) -> bool:
    """Whether a policy sets a joint of the plan; without a joint, whether it has the object, or a part of it."""
    world = evidence.world
    if joint is not None:
        return any(evidence.prim(joint) in policy.joints for policy in world.policies)
    parts = {policy.base for policy in world.policies}
    for each in world.joints:
        if any(each.prim in policy.joints for policy in world.policies):
            parts |= {each.child} if each.parent is None else {each.parent, each.child}
    return any(within(part, evidence.prim(name)) for part in parts)
