"""Checks of the stage against the plan: sizes, places, colours, surfaces and joints, where the plan gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.evidence.geometry import conjugate, multiply, rotate
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Joint as PlanJoint
    from wsim.plan.schema import PlanObject
    from wsim.scene.world import Body, Joint, Shape, Static

    Floats = NDArray[np.float64]

SOLIDS = ("box", "sphere", "cylinder", "capsule")
JOINTS = {"fixed": "fixed", "hinge": "revolute", "slider": "prismatic", "ball": "spherical"}


@dataclass
class CheckPlanSizes(Check):
    """Each object is of the plan's shape and size."""

    share: float = 0.05

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that differs, or one for none."""
        found = [finding for item, made in _pairs(evidence) for finding in self._solid(made, item)]
        found += self._hollows(evidence)
        return found or ([self.passed("Objects have the plan's sizes")] if evidence.plan is not None else [])

    def _solid(self, made: Body | Static, item: PlanObject) -> list[Finding]:
        if item.primitive not in SOLIDS or len(made.shapes) != 1:
            return []  # an assembly stands for it
        shape = made.shapes[0]
        if not shape.collides and item.registration.collision != "none":
            message = f"{made.prim} takes part in no collision; the plan has it as solid"
            target = RepairTarget(kind="geometry", prim=made.prim, parameter="collides", direction="add")
            return [self.failed(message, prim=made.prim, time=0.0, line=made.line, target=target)]
        # Of another shape only the bounding box can be compared.
        sizes = (item.size, shape.size)
        if shape.kind != item.primitive or shape.kind == "box":
            sizes = (tuple(sorted(_extent_of(item))), tuple(sorted(_extent(shape))))
        return self._compare(made.prim, made.line, *sizes)

    def _hollows(self, evidence: Evidence) -> list[Finding]:
        found = []
        for item in evidence.plan.objects if evidence.plan is not None else []:
            container = evidence.container(evidence.prim(item.name))
            if item.primitive == "tank" and container is not None:
                line = evidence.line(container.prim)
                found += self._compare(container.prim, line, item.size, container.inner_size)
        return found

    def _compare(
        self, prim: str, line: str | None, planned: tuple[float, ...], made: tuple[float, ...]
    ) -> list[Finding]:
        ratios = [b / a for a, b in zip(planned, made, strict=True)]
        if not ratios:
            return []
        worst = max(ratios, key=lambda ratio: abs(math.log(max(ratio, 1e-9))))
        above = worst > 1.0
        limit = 1.0 + self.share if above else 1.0 - self.share
        if abs(worst - 1.0) <= self.share:
            return []
        at = ratios.index(worst)
        return [
            self.measured(
                f"{prim} measures {_listed(made)} m; the plan has {_listed(planned)} m",
                worst,
                limit,
                "1",
                at_most=above,
                expected=1.0,
                prim=prim,
                time=0.0,
                line=line,
                limit_from=f"the plan's size, to {self.share:.0%}",
                target=RepairTarget(
                    kind="geometry",
                    prim=prim,
                    parameter="size",
                    direction="lower" if above else "raise",
                    suggested=planned[at],
                    unit="m",
                ),
            )
        ]


@dataclass
class CheckPlanPlaces(Check):
    """Each object starts where, turned as, and as fast as the plan has it."""

    share: float = 0.25  # of its largest extent: a program may nudge what it places, not exchange it
    turn: float = 10.0  # [deg]
    speed: float = 0.05  # of the plan's speed, or of what gravity gives over its size

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that starts otherwise, or one for none."""
        found = [finding for item, made in _pairs(evidence) for finding in self._start(evidence, made, item)]
        return found or ([self.passed("Objects start where the plan has them")] if evidence.plan is not None else [])

    def _start(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> Iterator[Finding]:
        if item.pose is None or item.primitive not in SOLIDS or len(made.shapes) != 1:
            return
        shape = made.shapes[0]
        place, turn = np.array(shape.position), np.array(shape.rotation)
        if hasattr(made, "mass"):
            i = evidence.index(made.prim)
            q = evidence.body_q[0, i]
            place, turn = q[:3], multiply(q[3:], turn)
            yield from self._velocity(evidence, i, item)
        far = float(np.linalg.norm(place - np.array(item.pose.position)))
        limit = self.share * max(_extent_of(item))
        if far > limit:
            where = _listed(tuple(float(x) for x in place))
            target = RepairTarget(kind="geometry", prim=made.prim, parameter="position", direction="change", unit="m")
            yield self.measured(
                f"{made.prim} starts at {where} m, {far:.3g} m from the plan's {_listed(item.pose.position)} m",
                far, limit, "m", expected=0.0, prim=made.prim, time=0.0, line=made.line,
                limit_from=f"{self.share:g} of its largest extent", target=target,
            )  # fmt: skip
        off = _turned(item, turn, shape)
        if off > self.turn:
            target = RepairTarget(kind="geometry", prim=made.prim, parameter="rotation_deg", direction="change")
            yield self.measured(
                f"{made.prim} starts turned by {off:.3g} degrees against the plan",
                off, self.turn, "deg", expected=0.0, prim=made.prim, time=0.0, line=made.line,
                limit_from="the plan's pose", target=target,
            )  # fmt: skip

    def _velocity(self, evidence: Evidence, i: int, item: PlanObject) -> Iterator[Finding]:
        body = evidence.world.bodies[i]
        planned = np.array(item.velocity)
        off = float(np.linalg.norm(np.array(body.velocity) - planned))
        limit = self.speed * max(float(np.linalg.norm(planned)), evidence.velocity_scale(evidence.solid(i).smallest))
        if off > limit and not any(p.value != p.default for p in evidence.world.parameters):
            target = RepairTarget(
                kind="physical parameter", prim=body.prim, parameter="velocity", direction="change",
                suggested=float(np.linalg.norm(planned)), unit="m/s",
            )  # fmt: skip
            yield self.measured(
                f"{body.prim} starts at {_listed(body.velocity)} m/s; the plan has {_listed(item.velocity)} m/s",
                off, limit, "m/s", expected=0.0, prim=body.prim, time=0.0, line=body.line,
                limit_from=f"{self.speed:g} of the plan's speed, or of sqrt(g L) if that is more", target=target,
            )  # fmt: skip


@dataclass
class CheckPlanLooks(Check):
    """Each object has the plan's colour, and its surface the plan's friction and restitution."""

    color: float = 0.1  # of linear RGB, in its largest part: what is seen as another shade
    surface: float = 0.1  # of friction or restitution

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that differs, or one for none."""
        found = [finding for item, made in _pairs(evidence) for finding in self._look(made, item)]
        return found or ([self.passed("Objects have the plan's looks")] if evidence.plan is not None else [])

    def _look(self, made: Body | Static, item: PlanObject) -> Iterator[Finding]:
        material = item.material
        if material is None or item.primitive not in SOLIDS or not made.shapes:
            return
        shape = made.shapes[0]
        for what, value, planned, limit in (
            ("friction", shape.friction, material.friction, self.surface),
            ("restitution", shape.restitution, material.restitution, self.surface),
        ):
            if abs(value - planned) > limit:
                target = RepairTarget.model_validate(
                    {
                        "kind": "physical parameter",
                        "prim": made.prim,
                        "parameter": what,
                        "direction": "lower" if value > planned else "raise",
                        "suggested": planned,
                    }
                )
                yield self.measured(
                    f"{made.prim} has a {what} of {value:g}; the plan's {material.name} has {planned:g}",
                    value, planned + (limit if value > planned else -limit), "1", at_most=value > planned,
                    expected=planned, prim=made.prim, time=0.0, line=made.line, limit_from="the plan's material",
                    target=target,
                )  # fmt: skip
        off = float(np.abs(np.subtract(shape.color, material.color)).max())
        if off > self.color:
            target = RepairTarget(kind="visual mismatch", prim=made.prim, parameter="color", direction="change")
            yield self.measured(
                f"{made.prim} has the colour {_listed(shape.color)}; the plan's {material.name} has "
                f"{_listed(material.color)}",
                off, self.color, "1", expected=0.0, prim=made.prim, time=0.0, line=made.line,
                limit_from="linear red, green and blue in 0..1", target=target,
            )  # fmt: skip


@dataclass
class CheckPlanJoints(Check):
    """The world has the plan's joints, between the plan's bodies, with the plan's limits and drives."""

    share: float = 0.05  # of the range, or of what a drive is set to
    least: float = 0.01  # [rad], [m], or that a second: what a drive may be off of nothing

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each joint that is missing, or holds, ends or is driven otherwise; or one for none."""
        if evidence.plan is None or not evidence.plan.joints:
            return []
        varied = any(p.value != p.default for p in evidence.world.parameters)
        found = []
        for planned in evidence.plan.joints:
            made = self._made(evidence, planned)
            if made is None:
                child = evidence.prim(planned.child)
                message = f"The plan's {planned.kind} {planned.name} is not in the world: nothing holds {child} so"
                target = RepairTarget(kind="joint", prim=child, parameter=planned.name, direction="add")
                found.append(self.failed(message, prim=child, time=0.0, line=evidence.line(child), target=target))
            elif not varied:
                found += [*self._limits(made, planned), *self._drive(evidence, made, planned)]
        return found or [self.passed("The world has the plan's joints")]

    @staticmethod
    def _made(evidence: Evidence, planned: PlanJoint) -> Joint | None:
        """The world's joint between the same two, either way round."""
        still = {static.prim for static in evidence.world.statics}
        parent = evidence.prim(planned.parent) if planned.parent is not None else None
        ends = {None if parent in still else parent, evidence.prim(planned.child)}
        fitting = (j for j in evidence.world.joints if j.kind == JOINTS[planned.kind] and {j.parent, j.child} == ends)
        return next(fitting, None)

    def _limits(self, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        if planned.limits is None:
            return
        scale, unit = (math.radians(1.0), "rad") if planned.kind == "hinge" else (1.0, "m")
        low, high = (scale * end for end in planned.limits)
        has = (-math.inf if made.low is None else made.low, math.inf if made.high is None else made.high)
        # Seen from the other end, or about the opposite axis, a joint turns the other way.
        off = min(max(abs(has[0] - a), abs(has[1] - b)) for a, b in ((low, high), (-high, -low)))
        limit = self.share * (high - low)
        if off > limit:
            yield self.measured(
                f"{made.prim} moves within {_listed(has)} {unit}; the plan's {planned.name} within "
                f"{_listed((low, high))} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0, line=made.line,
                limit_from=f"{self.share:g} of the plan's range",
                target=RepairTarget(kind="joint", prim=made.prim, parameter="limits", direction="change"),
            )  # fmt: skip

    def _drive(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        wanted = [
            actuation
            for item in (evidence.plan.objects if evidence.plan is not None else [])
            for actuation in item.registration.actuation
            if actuation.joint == planned.name
        ]
        # What a controller sets, or several drives in turn, is not to be read off the stage.
        if made.drive is None or len(wanted) != 1 or evidence.recording.metadata.get("controlled"):
            return
        kind, targets = wanted[0].kind, wanted[0].target
        if kind not in ("position", "velocity") or len(targets) != 1:
            return
        value = made.drive.position if kind == "position" else made.drive.velocity
        unit = ("rad" if planned.kind == "hinge" else "m") + ("" if kind == "position" else "/s")
        off = min(abs(value - targets[0]), abs(value + targets[0]))  # about the opposite axis it is the other way
        limit = max(self.share * abs(targets[0]), self.least)
        if off > limit:
            target = RepairTarget(
                kind="drive", prim=made.prim, parameter=f"drive.{kind}", direction="change", current=value,
                suggested=targets[0], unit=unit,
            )  # fmt: skip
            yield self.measured(
                f"{made.prim} is driven to {value:.3g} {unit}; the plan has {targets[0]:.3g} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0, line=made.line,
                limit_from=f"{self.share:g} of the plan's, or {self.least:g} {unit}", target=target,
            )  # fmt: skip


def _pairs(evidence: Evidence) -> Iterator[tuple[PlanObject, Body | Static]]:
    """The plan's objects, and the bodies and statics made of them."""
    if evidence.plan is None:
        return
    made: dict[str, Body | Static] = {static.prim: static for static in evidence.world.statics}
    made |= {body.prim: body for body in evidence.world.bodies}
    for item in evidence.plan.objects:
        prim = evidence.prim(item.name)
        if prim in made:
            yield item, made[prim]


def _turned(item: PlanObject, turn: Floats, shape: Shape) -> float:
    """The angle between a rotation and the plan's [deg]; 0 for what looks the same from all sides."""
    if item.pose is None or item.primitive == "sphere":
        return 0.0
    planned = _quaternion(item.pose.rotation_deg)
    if item.primitive in ("cylinder", "capsule"):  # only its axis is to be seen, and not which way it points
        between = multiply(conjugate(planned), turn)
        cosine = abs(1.0 - 2.0 * float(between[0] ** 2 + between[1] ** 2))
        return math.degrees(math.acos(min(1.0, cosine)))
    # A box looks the same turned by quarters, if its edges are then where they were.
    cosine = max(
        (abs(float(multiply(turn, quarter) @ planned)) for quarter in _quarters() if _fits(item, shape, quarter)),
        default=0.0,
    )
    return math.degrees(2.0 * math.acos(min(1.0, cosine)))


def _fits(item: PlanObject, shape: Shape, quarter: Floats) -> bool:
    """Whether a shape's edges, seen from axes turned by quarters, are the plan's."""
    if shape.kind != "box":
        return bool(quarter[3] == 1.0)
    edges = np.abs(rotate(conjugate(quarter), np.diag(shape.size))).sum(axis=0)
    return bool(np.allclose(edges, item.size, rtol=0.1))


@cache
def _quarters() -> tuple[Floats, ...]:
    """The 24 rotations that take a cube to itself."""
    turns = [np.array([0.0, 0.0, 0.0, 1.0])]
    steps = [np.array([*(math.sqrt(0.5) * np.eye(3)[axis]), math.sqrt(0.5)]) for axis in range(3)]
    for turn in turns:  # grows as new ones are found
        for step in steps:
            other = multiply(step, turn)
            if not any(abs(float(other @ known)) > 0.999 for known in turns):
                turns.append(other)
    return tuple(turns)


def _quaternion(rotation_deg: tuple[float, float, float]) -> Floats:
    """Roll, then pitch, then yaw [deg] as a quaternion."""
    q = np.array([0.0, 0.0, 0.0, 1.0])
    for axis, angle in enumerate(rotation_deg):
        half = math.radians(angle) / 2.0
        turn = np.zeros(4)
        turn[axis], turn[3] = math.sin(half), math.cos(half)
        q = multiply(turn, q)
    return q


def _extent_of(item: PlanObject) -> tuple[float, ...]:
    return _extents(item.primitive, item.size)


def _extent(shape: Shape) -> tuple[float, ...]:
    return _extents(shape.kind, shape.size)


def _extents(kind: str, size: tuple[float, ...]) -> tuple[float, ...]:
    """Edges of a shape's bounding box in its own frame [m]."""
    if kind == "sphere":
        return (2 * size[0],) * 3
    if kind == "cylinder":
        return (2 * size[0], 2 * size[0], size[1])
    if kind == "capsule":
        return (2 * size[0], 2 * size[0], size[1] + 2 * size[0])
    return size


def _listed(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:.3g}" for value in values) + ")"
