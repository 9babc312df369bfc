"""The check of a world's joints against the plan's: between whom, how far they go, and what drives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import PRIMITIVES
from wsim.geometry.rotations import multiply, rotate
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.checks.plan_closed import named, within
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Joint as PlanJoint
    from wsim.plan.schema import Plan
    from wsim.scene.world import Joint

JOINTS = {"fixed": "fixed", "hinge": "revolute", "slider": "prismatic", "ball": "spherical"}


@dataclass
class CheckPlanJoints(Check):
    """The world has the plan's joints and no others, between its bodies, with its axes, limits and drives."""

    share: float = 0.05  # of the range, of what a drive is set to, or of its strength
    least: float = 0.01  # [rad], [m], or that a second: what a drive may be off of nothing
    turn: float = 5.0  # [deg]: of the axis
    place: float = 0.1  # of the child's largest extent: where the joint is on it

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each joint too few or too many, or that is another than the plan's; or one for none."""
        plan = evidence.plan
        if plan is None or not (plan.joints or evidence.world.joints):
            return []
        found: list[Finding] = []
        pairs = _paired(evidence, plan)
        for planned, made in pairs:
            if made is None:
                child = evidence.prim(planned.child)
                message = f"The plan's {planned.kind} {planned.name} is not in the world: nothing holds {child} so"
                target = RepairTarget(kind="joint", prim=child, parameter=planned.name, direction="add")
                found.append(self.failed(message, prim=child, time=0.0, target=target))
                continue
            if made.kind != JOINTS[planned.kind]:
                message = f"{made.prim} is a {made.kind} joint; the plan's {planned.name} is a {planned.kind}"
                target = RepairTarget(
                    kind="joint", prim=made.prim, parameter="kind", direction="change", text=planned.kind
                )
                found.append(self.failed(message, prim=made.prim, time=0.0, target=target))
                continue
            found += [*self._axis(evidence, made, planned), *self._anchor(evidence, made, planned)]
            found += self._holds(plan, made)
            if not evidence.varied:
                found += [*self._limits(made, planned), *self._drive(evidence, made, planned)]
        found += self._extra(evidence, [made for _, made in pairs if made is not None])
        return found or [self.passed("The world has the plan's joints and no others")]

    def _extra(self, evidence: Evidence, made: list[Joint]) -> Iterator[Finding]:
        """Joints that are none of the plan's; what is assembled has its own inside."""
        for joint in evidence.world.joints:
            if joint in made or (joint.parent is not None and within(evidence, joint.child, joint.parent)):
                continue
            if joint.fixture is not None and within(evidence, joint.prim, joint.child, joint.fixture):
                continue  # to its own base, which never moves
            if evidence.plan and any(cord.owns(joint.prim.rpartition("/")[2]) for cord in evidence.plan.cords):
                continue  # between a cable's links
            target = RepairTarget(kind="joint", prim=joint.prim, direction="remove", why="the plan has no such joint")
            held = joint.parent or joint.fixture or "the world"
            message = f"{joint.prim} is a {joint.kind} joint between {held} and {joint.child}; the plan has none there"
            yield self.failed(message, prim=joint.prim, time=0.0, limit_from="the plan's joints", target=target)

    def _axis(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        """A hinge or a slider's axis, as it starts in the world; either way along it is the same."""
        if planned.kind not in ("hinge", "slider"):
            return
        q = np.array(evidence.body(made.child).rotation)
        axis = rotate(multiply(q, np.array(made.child_turn)), np.eye(3)["XYZ".index(made.axis)])
        off = math.degrees(math.acos(min(1.0, abs(float(axis["XYZ".index(planned.axis)])))))
        if off > self.turn:
            yield self.measured(
                f"{made.prim} is about {listed(tuple(float(x) for x in axis))}; the plan's {planned.name} is about "
                f"{planned.axis}",
                off, self.turn, "deg", expected=0.0, prim=made.prim, time=0.0, limit_from="the plan's axis",
                target=RepairTarget(
                    kind="joint", prim=made.prim, parameter="axis", direction="change", text=planned.axis
                ),
            )  # fmt: skip

    def _anchor(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        """Where a hinge or a ball is on its child; a hinge's may be anywhere along its axis."""
        item = next((o for o in evidence.plan.objects if o.name == planned.child), None) if evidence.plan else None
        anchor = made.child_anchor if evidence.prim(planned.child) == made.child else made.parent_anchor
        turn = made.child_turn if evidence.prim(planned.child) == made.child else made.parent_turn
        if planned.kind not in ("hinge", "ball") or anchor is None or item is None or item.primitive not in PRIMITIVES:
            return
        apart = np.array(anchor) - np.array(planned.anchor or (0.0, 0.0, 0.0))
        if planned.kind == "hinge":
            axis = rotate(np.array(turn), np.eye(3)["XYZ".index(made.axis)])
            apart = apart - (apart @ axis) * axis
        off, limit = float(np.linalg.norm(apart)), self.place * max(PRIMITIVES[item.primitive](*item.size).edges)
        if off > limit:
            yield self.measured(
                f"{made.prim} is at {listed(anchor)} m on {made.child}, {off:.3g} m from the plan's "
                f"{listed(planned.anchor or (0.0, 0.0, 0.0))} m",
                off, limit, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.place:g} of its largest extent",
                target=RepairTarget(
                    kind="joint", prim=made.prim, parameter="anchor", direction="change", unit="m",
                    vector=_in_the_world(evidence, planned),
                ),
            )  # fmt: skip

    def _holds(self, plan: Plan, made: Joint) -> Iterator[Finding]:
        """Dry friction and a strength, which a plan's joints have no field for: its words must name them."""
        for what, parameter, given in (
            ("friction", "friction", made.friction > 0.0),
            ("breaks", "break_force", made.may_break),
        ):
            if given and not named(plan, what):
                target = RepairTarget(kind="joint", prim=made.prim, parameter=parameter, direction="remove")
                said = "rubs" if what == "friction" else "may break"
                message = f"{made.prim} {said}; nothing in the plan speaks of that"
                yield self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's joints", target=target)

    def _limits(self, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        if planned.limits is None:
            if made.low is not None or made.high is not None:
                target = RepairTarget(kind="joint", prim=made.prim, parameter="limits", direction="remove")
                message = f"{made.prim} has limits; the plan's {planned.name} has none"
                yield self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's joints", target=target)
            return
        scale, unit = (math.radians(1.0), "rad") if planned.kind == "hinge" else (1.0, "m")
        low, high = (scale * end for end in planned.limits)
        has = (-math.inf if made.low is None else made.low, math.inf if made.high is None else made.high)
        # Seen from the other end, or about the opposite axis, a joint turns the other way.
        off = min(max(abs(has[0] - a), abs(has[1] - b)) for a, b in ((low, high), (-high, -low)))
        limit = self.share * (high - low)
        if off > limit:
            yield self.measured(
                f"{made.prim} moves within {listed(has)} {unit}; the plan's {planned.name} within "
                f"{listed((low, high))} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.share:g} of the plan's range",
                target=RepairTarget(
                    kind="joint", prim=made.prim, parameter="limits_deg" if planned.kind == "hinge" else "limits",
                    direction="change", vector=planned.limits, unit="deg" if planned.kind == "hinge" else "m",
                ),
            )  # fmt: skip

    def _drive(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        """What the joint's drive is set to, and how strongly it acts, against the plan's."""
        wanted = planned.drive
        # What a program's control, or a policy, sets or does itself is not to be read off the stage.
        facts = evidence.recording.metadata
        if facts.get("steered", facts.get("controlled")) or any(
            made.prim in policy.joints for policy in evidence.world.policies
        ):
            return
        if wanted is None:
            yield from self._actuated(evidence, made, planned)
            return
        if made.drive is None:
            message = f"Nothing drives {made.prim}; the plan's {planned.name} has a drive"
            target = RepairTarget(kind="drive", prim=made.prim, parameter="drive", direction="add")
            yield self.failed(message, prim=made.prim, time=0.0, target=target)
            return
        turns = planned.kind == "hinge"
        scale, unit = (math.radians(1.0), "rad") if turns else (1.0, "m")
        effort = "N m" if turns else "N"
        # What has no stiffness holds no position, and what has no damping no speed.
        position = (made.drive.position, scale * wanted.position) if wanted.stiffness else (0.0, 0.0)
        velocity = (made.drive.velocity, scale * wanted.velocity) if wanted.damping else (0.0, 0.0)
        # Seen from the other end, or about the opposite axis, both are of the other sign.
        way = min((1.0, -1.0), key=lambda sign: sum(abs(sign * has - to) for has, to in (position, velocity)))
        for what, (has, to), of in (("position", position, unit), ("velocity", velocity, unit + "/s")):
            yield from self._target(made, what, has, to, abs(way * has - to), of)
        if made.drive.saturates and not wanted.saturates:  # the other way round the judge is only stricter
            yield self.failed(
                f"{made.prim} is said to saturate; the plan's {planned.name} is to get where it is set to",
                prim=made.prim, time=0.0, limit_from="the plan's joints",
                target=RepairTarget(kind="drive", prim=made.prim, parameter="drive.saturates", direction="remove"),
            )  # fmt: skip
        most, bound = (math.inf if end is None else end for end in (made.drive.max_effort, wanted.max_force))
        for what, has, to, of in (
            ("stiffness", made.drive.stiffness, wanted.stiffness, f"{effort}/{unit}"),
            ("damping", made.drive.damping, wanted.damping, f"{effort} s/{unit}"),
            ("max_force", most, bound, effort),
        ):
            yield from self._strength(made, what, has, to, of)

    def _actuated(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        """A drive that the plan's joint has not: its target is that of the object's actuation, if it has one."""
        items = evidence.plan.objects if evidence.plan is not None else []
        asked = [each for item in items for each in item.registration.actuation if each.joint == planned.name]
        if made.drive is None or any(each.kind not in ("position", "velocity") or not each.target for each in asked):
            return
        if not asked:
            message = f"A drive acts on {made.prim}; the plan's {planned.name} has none"
            target = RepairTarget(kind="drive", prim=made.prim, parameter="drive", direction="remove")
            yield self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's joints", target=target)
        unit = "rad" if planned.kind == "hinge" else "m"
        for each in asked:
            has, to = getattr(made.drive, each.kind), each.target[0]
            off = min(abs(has - to), abs(has + to))
            yield from self._target(made, each.kind, has, to, off, unit if each.kind == "position" else f"{unit}/s")

    def _target(self, made: Joint, what: str, has: float, to: float, off: float, unit: str) -> Iterator[Finding]:
        limit = max(self.share * abs(to), self.least)
        if off > limit:
            target = RepairTarget(
                kind="drive", prim=made.prim, parameter=f"drive.{what}", direction="change", current=has, suggested=to,
                unit=unit,
            )  # fmt: skip
            yield self.measured(
                f"{made.prim} is driven to {has:.3g} {unit}; the plan has {to:.3g} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.share:g} of the plan's, or {self.least:g} {unit}", target=target,
            )  # fmt: skip

    def _strength(self, made: Joint, what: str, has: float, to: float, unit: str) -> Iterator[Finding]:
        if has == to or abs(has - to) <= self.share * to < math.inf:
            return
        known, wanted = ((x if math.isfinite(x) else None) for x in (has, to))
        said = [f"{x:.4g} {unit}" if math.isfinite(x) else "none" for x in (has, to)]
        direction = "lower" if has > to else "raise"
        yield self.failed(
            f"The drive of {made.prim} has a {what.replace('_', ' ')} of {said[0]}; the plan has {said[1]}",
            prim=made.prim, time=0.0, value=known, expected=wanted, unit=unit,
            limit_from=f"the plan's, to {self.share:.0%}",
            target=RepairTarget(
                kind="drive", prim=made.prim, parameter=f"drive.{what}", direction=direction, current=known,
                suggested=wanted, unit=unit,
            ),
        )  # fmt: skip


def _in_the_world(evidence: Evidence, planned: PlanJoint) -> tuple[float, ...]:
    """Where the plan has a joint, in the world's axes at the start [m], as a program gives it."""
    child = evidence.body(evidence.prim(planned.child))
    at = np.array(child.position) + rotate(np.array(child.rotation), np.array(planned.anchor or (0.0, 0.0, 0.0)))
    return tuple(round(float(x), 6) for x in at)


def _paired(evidence: Evidence, plan: Plan) -> list[tuple[PlanJoint, Joint | None]]:
    """Each of the plan's joints, and the world's between the same two, either way round: of several the namesake."""
    still = {static.prim for static in evidence.world.statics}
    free = list(evidence.world.joints)
    found: list[tuple[PlanJoint, Joint | None]] = []
    for planned in plan.joints:
        parent = evidence.prim(planned.parent) if planned.parent is not None else None
        ends = {None if parent in still else parent, evidence.prim(planned.child)}
        between = [joint for joint in free if {joint.parent, joint.child} == ends]
        alike = [joint for joint in between if joint.kind == JOINTS[planned.kind]] or between
        made = next((joint for joint in alike if joint.prim == evidence.prim(planned.name)), next(iter(alike), None))
        if made is not None:
            free.remove(made)
        found.append((planned, made))
    return found


CHECKS: Checks = (CheckPlanJoints,)
