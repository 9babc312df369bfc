"""Checks of the stage against the plan: sizes, places, colours and surfaces, where the plan gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import PRIMITIVES
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.checks.check import Check, Checks, listed, share_about
from wsim.judge.checks.plan_closed import assembled, named
from wsim.judge.verdict import RepairTarget
from wsim.plan.schema import FromTerrain
from wsim.scene.contact import friction_of, restitution_of, rolling_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Material, PlanObject
    from wsim.scene.world import Body, Shape, Static

    Floats = NDArray[np.float64]

PLATES = 5  # of a tank
FINE = 0.05  # of the time between frames: about a step, where nobody says how long one is


@dataclass
class CheckPlanSizes(Check):
    """Each object is of the plan's shape and size, and of that one shape."""

    of_world = True

    share: float = 0.05
    height: float = 0.01  # [m]: of the ground

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that differs, or one for none."""
        found = [f for item, made in pairs(evidence) if not assembled(item) for f in self._made(evidence, made, item)]
        return found or ([self.passed("Objects have the plan's shapes and sizes")] if evidence.plan is not None else [])

    def _made(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> list[Finding]:
        if item.primitive == "tank":
            return self._hollow(evidence, made, item)
        if item.primitive == "ground":
            return self._ground(evidence, made, item)
        if item.primitive not in PRIMITIVES:
            return []
        if len(made.shapes) != 1:
            return [self._pieces(made, f"it is one {item.primitive}", 1)]
        return self._solid(made, item)

    def _pieces(self, made: Body | Static, planned: str, pieces: int) -> Finding:
        extra = [shape.prim for shape in made.shapes[pieces:]]
        message = f"{made.prim} has {len(made.shapes)} shapes; in the plan {planned}"
        target = RepairTarget(
            kind="geometry", prim=extra[0] if extra else made.prim, direction="remove" if extra else "add"
        )
        return self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's primitive", target=target)

    def _solid(self, made: Body | Static, item: PlanObject) -> list[Finding]:
        shape, solid = made.shapes[0], item.registration.collision != "none"
        if shape.collides != solid:
            says = ("takes part in no collision", "solid") if solid else ("collides", "passed through")
            target = RepairTarget(
                kind="geometry", prim=made.prim, parameter="collides", direction="add" if solid else "remove"
            )
            message = f"{made.prim} {says[0]}; the plan has it as {says[1]}"
            return [self.failed(message, prim=made.prim, time=0.0, target=target)]
        sizes = (item.size, shape.size)
        if shape.kind == "mesh" and self._fills(shape, item):
            return self._compare(made.prim, _edges(item.primitive, item.size), shape.size)
        if shape.kind != item.primitive:
            message = f"{made.prim} is a {shape.kind}; the plan has it as a {item.primitive}"
            target = RepairTarget(
                kind="geometry", prim=made.prim, parameter="shape", direction="change", text=item.primitive
            )
            return [self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's primitive", target=target)]
        if shape.kind == "box":
            sizes = (tuple(sorted(item.size)), tuple(sorted(shape.size)))
        return self._compare(made.prim, *sizes, item.size)

    def _fills(self, shape: Shape, item: PlanObject) -> bool:
        """Whether a mesh stands for the plan's primitive: its hull has the primitive's volume."""
        kind = PRIMITIVES[item.primitive](*item.size)
        volume = abs(kind_of(shape).surface().volume)
        return abs(volume / (item.volume or volume) - 1.0) <= self.share and len(kind.edges) == len(shape.size)

    def _hollow(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> list[Finding]:
        """A tank: a floor, four walls, and the plan's room between them."""
        solid = [shape for shape in made.shapes if shape.collides and shape.kind == "box"]
        if len(made.shapes) != PLATES or len(solid) != PLATES:
            return [self._pieces(made, f"it is a floor and four walls, {PLATES} solid boxes", PLATES)]
        container = evidence.container(made.prim)
        return [] if container is None else self._compare(container.prim, item.size, container.inner_size)

    def _ground(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> list[Finding]:
        """The ground: one plane across gravity, at the plan's height; other where the plan speaks of terrain."""
        if evidence.plan is None or named(evidence.plan, "terrain"):
            return []
        shape = made.shapes[0]
        if len(made.shapes) != 1:
            return [self._pieces(made, "it is one plane", 1)]
        target = RepairTarget(kind="geometry", prim=made.prim, parameter="shape", direction="change")
        upright = rotate(np.array(shape.rotation), np.array([0.0, 0.0, 1.0]))[2]
        if shape.kind != "plane" or not shape.collides or upright < math.cos(math.radians(0.5)):
            message = f"{made.prim} is no level, solid plane, which the plan's ground is"
            return [self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's primitive", target=target)]
        planned = item.pose.position[2] if item.pose is not None else 0.0
        off = abs(shape.position[2] - planned)
        if off <= self.height:
            return []
        return [
            self.measured(
                f"{made.prim} is {shape.position[2]:.3g} m high; the plan has it at {planned:.3g} m",
                off, self.height, "m", expected=0.0, prim=made.prim, time=0.0, limit_from="the plan's pose",
                target=target,
            )
        ]  # fmt: skip

    def _compare(
        self, prim: str, planned: tuple[float, ...], made: tuple[float, ...], whole: tuple[float, ...] | None = None
    ) -> list[Finding]:
        """The finding of sizes that differ; `whole` is the plan's size in the order of the program."""
        ratios = [b / a for a, b in zip(planned, made, strict=True)]
        if not ratios:
            return []
        off = max(ratios, key=lambda ratio: abs(math.log(max(ratio, 1e-9))))
        if abs(off - 1.0) <= self.share:
            return []
        suggested = planned[ratios.index(off)]
        target = RepairTarget(
            kind="geometry", prim=prim, parameter="size", suggested=suggested, vector=whole or planned, unit="m"
        )
        return [
            self.between(
                f"{prim} measures {listed(made)} m; the plan has {listed(planned)} m",
                off, share_about(1.0, self.share), "1", expected=1.0, prim=prim, time=0.0,
                limit_from=f"the plan's size, to {self.share:.0%}", target=target,
            )
        ]  # fmt: skip


@dataclass
class CheckPlanPlaces(Check):
    """Each object starts where, turned as, and as fast as the plan has it."""

    share: float = 0.25  # of its largest extent: a program may nudge what it places, not exchange it
    turn: float = 4.0  # [deg]
    speed: float = 0.05  # of the plan's speed, or what gravity gives in a step, up to this of sqrt(g L)

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that starts otherwise, or one for none."""
        found = [finding for item, made in pairs(evidence) for finding in self._start(evidence, made, item)]
        return found or ([self.passed("Objects start where the plan has them")] if evidence.plan is not None else [])

    def _start(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> Iterator[Finding]:
        if hasattr(made, "mass"):
            yield from self._velocity(evidence, evidence.index(made.prim), item)
        if item.pose is None or item.primitive not in PRIMITIVES or len(made.shapes) != 1:
            return
        shape = made.shapes[0]
        place, turn = np.array(shape.position), np.array(shape.rotation)
        if hasattr(made, "mass"):
            i = evidence.index(made.prim)
            q = evidence.body_q[0, i]
            place, turn = q[:3], multiply(q[3:], turn)
        far = float(np.linalg.norm(place - np.array(item.pose.position)))
        limit = self.share * max(_edges(item.primitive, item.size))
        if far > limit:
            where = listed(tuple(float(x) for x in place))
            target = RepairTarget(
                kind="geometry", prim=made.prim, parameter="position", direction="change", vector=item.pose.position,
                unit="m",
            )  # fmt: skip
            yield self.measured(
                f"{made.prim} starts at {where} m, {far:.3g} m from the plan's {listed(item.pose.position)} m",
                far, limit, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.share:g} of its largest extent", target=target,
            )  # fmt: skip
        off = _turned(item, turn, shape)
        if off > self.turn:
            target = RepairTarget(
                kind="geometry", prim=made.prim, parameter="rotation_deg", direction="change",
                vector=item.pose.rotation_deg, unit="deg",
            )  # fmt: skip
            yield self.measured(
                f"{made.prim} starts turned by {off:.3g} degrees against the plan",
                off, self.turn, "deg", expected=0.0, prim=made.prim, time=0.0,
                limit_from="the plan's pose", target=target,
            )  # fmt: skip

    def _velocity(self, evidence: Evidence, i: int, item: PlanObject) -> Iterator[Finding]:
        body = evidence.world.bodies[i]
        planned = np.array(item.velocity)
        off = float(np.linalg.norm(np.array(body.velocity) - planned))
        limit = max(self.speed * float(np.linalg.norm(planned)), self._slow(evidence, i))
        if off > limit and not evidence.varied:
            target = RepairTarget(
                kind="physical parameter", prim=body.prim, parameter="velocity", direction="change",
                suggested=float(np.linalg.norm(planned)), vector=item.velocity, unit="m/s",
            )  # fmt: skip
            yield self.measured(
                f"{body.prim} starts at {listed(body.velocity)} m/s; the plan has {listed(item.velocity)} m/s",
                off, limit, "m/s", expected=0.0, prim=body.prim, time=0.0, line=body.line,
                limit_from=f"{self.speed:g} of the plan's speed, or what gravity gives in a step if that is more",
                target=target,
            )  # fmt: skip

    def _slow(self, evidence: Evidence, i: int) -> float:
        """The speed of what may as well stand [m/s]: an engine's first frame may be a step after the start.

        Of poses alone a step is a frame: their first velocity is known no better.
        """
        recording = evidence.recording
        known = recording.metadata.get("time_step") or recording.world.time_step
        step = float(known or FINE * evidence.motion.dt_frames)
        return min(evidence.gravity * step, self.speed * evidence.velocity_scale(evidence.solid(i).smallest))


@dataclass
class CheckPlanLooks(Check):
    """Each object has the plan's colour, and its surface the plan's friction, restitution and rolling resistance."""

    of_world = True

    color: float = 0.1  # of linear RGB, in its largest part: what is seen as another shade
    surface: float = 0.08  # of friction or restitution, of what the plan has, and at least
    least: float = 0.01
    rolling: float = 0.002  # of rolling resistance, which is some thousandths of what is hard

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that differs, or one for none."""
        found = [finding for made, shape, material in _seen(evidence) for finding in self._look(made, shape, material)]
        return found or ([self.passed("Objects have the plan's looks")] if evidence.plan is not None else [])

    def _look(self, made: Body | Static, shape: Shape, material: Material) -> Iterator[Finding]:
        wanted = (
            ("friction", friction_of, material.friction, max(self.surface * material.friction, self.least)),
            ("restitution", restitution_of, material.restitution, max(self.surface * material.restitution, self.least)),
            ("rolling_friction", rolling_of, material.rolling or 0.0, self.rolling),
        )
        for what, of, planned, limit in wanted:
            value = of(shape)
            if abs(value - planned) > limit:
                target = RepairTarget(kind="physical parameter", prim=made.prim, parameter=what, suggested=planned)
                said = what.replace("_", " ")
                yield self.between(
                    f"{made.prim} has a {said} of {value:g}; the plan's {material.name} has {planned:g}",
                    value, (planned - limit, planned + limit), "1", expected=planned, prim=made.prim,
                    time=0.0, limit_from="the plan's material", target=target,
                )  # fmt: skip
        off = float(np.abs(np.subtract(shape.color, material.color)).max())
        if off > self.color:
            target = RepairTarget(
                kind="visual mismatch", prim=made.prim, parameter="color", direction="change", vector=material.color
            )
            yield self.measured(
                f"{made.prim} has the colour {listed(shape.color)}; the plan's {material.name} has "
                f"{listed(material.color)}",
                off, self.color, "1", expected=0.0, prim=made.prim, time=0.0,
                limit_from="linear red, green and blue in 0..1", target=target,
            )  # fmt: skip


def pairs(evidence: Evidence) -> Iterator[tuple[PlanObject, Body | Static]]:
    """The plan's objects, and the bodies and statics made of them."""
    if evidence.plan is None:
        return
    made: dict[str, Body | Static] = {static.prim: static for static in evidence.world.statics}
    made |= {body.prim: body for body in evidence.world.bodies}
    for item in evidence.plan.objects:
        prim = evidence.prim(item.name)
        if prim in made:
            yield item, made[prim]


def _seen(evidence: Evidence) -> Iterator[tuple[Body | Static, Shape, Material]]:
    """The shapes that the plan has a material for, of terrain each of its areas' too, and of rocks each one's."""
    for item, made in pairs(evidence):
        if item.material is not None and item.primitive in (*PRIMITIVES, "ground", "tank"):
            yield from ((made, shape, item.material) for shape in _surfaces(made))
        if item.material is not None and isinstance(item.built, FromTerrain):
            areas = {area.name: area.material for area in item.built.areas}
            for shape in made.shapes:
                yield made, shape, areas.get(shape.prim.rsplit("/", 1)[-1], item.material)
    for static in evidence.world.statics:
        item_of = evidence.planned(static.prim)
        if item_of is not None and item_of.rocks and item_of.material is not None and static.shapes:
            yield static, static.shapes[0], item_of.material


def _surfaces(made: Body | Static) -> Iterable[Shape]:
    """One shape for each surface that it has: a tank's walls are of one."""
    return {(friction_of(it), restitution_of(it), rolling_of(it), it.color): it for it in made.shapes}.values()


def _turned(item: PlanObject, turn: Floats, shape: Shape) -> float:
    """The angle between a rotation and the plan's [deg]; 0 for what looks the same from all sides."""
    if item.pose is None or item.primitive == "sphere":
        return 0.0
    planned = quaternion(item.pose.rotation_deg)
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


def quaternion(rotation_deg: tuple[float, float, float]) -> Floats:
    """Roll, then pitch, then yaw [deg] as a quaternion."""
    q = np.array([0.0, 0.0, 0.0, 1.0])
    for axis, angle in enumerate(rotation_deg):
        half = math.radians(angle) / 2.0
        turn = np.zeros(4)
        turn[axis], turn[3] = math.sin(half), math.cos(half)
        q = multiply(turn, q)
    return q


def _edges(kind: str, size: tuple[float, ...]) -> tuple[float, ...]:
    """Edges of a shape's bounding box in its own frame [m]; of a mesh, its size."""
    return PRIMITIVES[kind](*size).edges if kind in PRIMITIVES else size


CHECKS: Checks = (CheckPlanSizes, CheckPlanPlaces, CheckPlanLooks)
