"""Check of what steers a world: `control`, policies, and what robots do by time, against the plan."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within
from wsim.scene.world import Reach, Schedule

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Actuation, Plan

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
        if (unlike := self._by_time(evidence, plan)) is not None:
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
        left: list[Schedule | Reach] = [*evidence.world.schedules, *evidence.world.reaches]
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


def _says(evidence: Evidence, name: str, actuation: Actuation, said: Schedule | Reach) -> bool:
    """Whether the stage says by time just what the plan lets a robot's link or joint do."""
    robot, times = evidence.prim(name), list(actuation.times)
    if isinstance(said, Schedule):
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
