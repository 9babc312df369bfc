"""Check of what steers a world: `control`, policies, and what robots do by time, against the plan."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within
from wsim.scene.world import Event, JointPath, Reach, Schedule

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Actuation, EventPlan, Plan, SchedulePlan

    Floats = NDArray[np.float64]

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
        for unlike in (self._by_time(evidence, plan), self._scheduled(evidence, plan)):
            if unlike is not None:
                return [unlike]
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
                    said = f"The plan has a {each.kind} of {item.name} that the stage has not"
                    return self.failed(said, target=target)
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
        for each in plan.schedules:
            found = next(
                (said for said in left if said.quantity == each.quantity and _is_of(evidence, each, said)), None
            )
            if found is None:
                target = RepairTarget(kind="program", parameter="scene.schedule", direction="add", text=each.name)
                said = f"The plan's schedule {each.name}, the {each.quantity} of {_of(each)}, is not in the stage"
                return self.failed(said, target=target)
            left.remove(found)
            if not evidence.varied and (unlike := _unlike(evidence, each, found)) is not None:
                target = RepairTarget(kind="program", parameter="scene.schedule", direction="change", text=each.name)
                said = (
                    f"The schedule of the {each.quantity} of {_of(each)} has other {unlike} than the plan's {each.name}"
                )
                return self.failed(said, line=found.line, target=target)
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
    if isinstance(planned.of, str):
        return said.target == evidence.prim(planned.of)
    pair = next((pair for pair in evidence.world.contacts if pair.prim == said.target), None)
    return pair is not None and {pair.first, pair.second} == {evidence.prim(name) for name in planned.of}


def _unlike(evidence: Evidence, planned: SchedulePlan, said: Schedule) -> str | None:
    """In what a schedule of the stage differs from the plan's; None where it does not."""
    hinge = any(joint.prim == said.target and joint.kind == "revolute" for joint in evidence.world.joints)
    turns = planned.quantity == "angular_velocity" or (hinge and planned.quantity in ("position", "velocity"))
    unit, linear = (math.radians(1.0) if turns else 1.0), planned.linear
    if linear is None:
        linear = planned.quantity == "position"
    wanted = [np.atleast_1d(value) * unit for value in planned.values]
    values = [np.atleast_1d(value) for value in said.values]
    if planned.quantity == "surface_velocity":  # the stage's are in the world's axes, whatever the object's are
        wanted, values = ([np.sqrt(np.sum(value**2, keepdims=True)) for value in each] for each in (wanted, values))
    if not _alike(said.times, planned.times):
        return "times"
    if said.quantity != "release" and not _alike(np.ravel(values), np.ravel(wanted)):
        return "values"
    if said.linear != linear:
        return "ways from key to key (linear)"
    if (said.point is None) != (planned.point is None) or (
        said.point is not None and not _alike(said.point, planned.point or ())
    ):
        return "points"
    return None if _same_event(evidence, planned.after, said.after) else "events (after)"


def _same_event(evidence: Evidence, planned: EventPlan | None, said: Event | None) -> bool:
    if planned is None or said is None:
        return planned is said
    kinds = {"touch": "touch", "body": "place", "joint": "joint", "start": "start", "end": "end"}
    kind = planned.kind
    given = getattr(planned, kind)
    names = list(given) if isinstance(given, tuple) else [given]
    ends = [end.rsplit("/", 1)[-1] for end in (said.first, said.second) if end]
    hinge = any(joint.prim == said.first and joint.kind == "revolute" for joint in evidence.world.joints)
    value = planned.above if planned.above is not None else (planned.below or 0.0)
    value *= math.radians(1.0) if hinge else 1.0
    same = kinds[kind] == said.kind and sorted(names) == sorted(ends) and _alike([said.delay], [planned.delay or 0.0])
    above = planned.below is None or kind not in ("body", "joint")
    return same and _alike([said.value], [value]) and said.axis == planned.axis and said.above == above


def _says(evidence: Evidence, name: str, actuation: Actuation, said: JointPath | Reach) -> bool:
    """Whether the stage says by time just what the plan lets a robot's link or joint do."""
    robot, times = evidence.prim(name), list(actuation.times)
    if isinstance(said, JointPath):
        slides = any(each.prim == said.prim and each.kind == "prismatic" for each in evidence.world.joints)
        unit = 1.0 if slides else math.radians(1.0)
        own = actuation.kind == "schedule" and said.prim == f"{robot}/joints/{actuation.joint}"
        return own and _alike(said.times, times) and _alike(said.positions, [unit * each for each in actuation.target])
    own = actuation.kind in ("reach", "follow") and said.link == f"{robot}/{actuation.link}"
    own &= said.straight == (actuation.kind == "follow") and _alike(said.point, actuation.point or (0.0, 0.0, 0.0))
    return own and _alike(said.times, times) and _alike(np.ravel(said.positions), np.ravel(actuation.path))


def _alike(one: Sequence[float] | Floats, other: Sequence[float] | Floats) -> bool:
    return len(one) == len(other) and bool(np.allclose(one, other, rtol=1e-4, atol=1e-4))


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
