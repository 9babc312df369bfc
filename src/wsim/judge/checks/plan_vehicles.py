"""The check of the stage's vehicles against what the scene's own call makes of the plan's: body by body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.checks.check import Checks, listed
from wsim.judge.checks.counterparts import Comparing, between_deg, in_frame
from wsim.judge.checks.plan_closed import owner
from wsim.judge.verdict import RepairTarget
from wsim.plan.authored import vehicle_of
from wsim.plan.schema import FromVehicle
from wsim.scene.vehicle_spec import preset

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.world import Body, Joint, Motor, World

    Floats = NDArray[np.float64]

STEER = math.radians(0.1)  # [rad]
FREE = 1e9  # [m], [rad]


@dataclass
class CheckPlanVehicles(Comparing):
    """Each vehicle is what the scene's call makes of the plan's kind, stands where the plan has it, and drives so."""

    of_world = True

    place: float = 0.01  # of its wheelbase: where a part, a shape, an anchor or a centre of mass is on it
    off: float = 0.1  # of its wheelbase: where it starts
    heading: float = 4.0  # [deg]: as it starts
    still: float = 0.05  # [m/s], [rad/s]: how a part may start that is to stand

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each thing that differs, or one for none."""
        items = evidence.plan.objects if evidence.plan is not None else []
        vehicles = [item for item in items if item.primitive == "vehicle" and _whole(evidence, item)]
        found = [finding for item in vehicles for finding in self._vehicle(evidence, item)]
        return found or ([self.passed("Vehicles are of the plan's kinds, and driven as it has it")] if vehicles else [])

    def _vehicle(self, evidence: Evidence, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromVehicle)
        wanted, source = vehicle_of(item, evidence.world.gravity), f"the plan's {item.built.vehicle}"
        whole = evidence.prim(item.name)
        near = self.place * preset(item.built.vehicle).wheelbase
        yield from self._placed(evidence, item, preset(item.built.vehicle).wheelbase)
        yield from self._extra(evidence, item, source)
        frames = evidence.body(whole), wanted.body(whole)
        for one in wanted.bodies:
            yield from self._body(evidence, evidence.body(one.prim), one, frames, near, source)
        yield from self._joints(evidence, item, wanted, near, source)

    def _placed(self, evidence: Evidence, item: PlanObject, wheelbase: float) -> Iterator[Finding]:
        """Where it starts, and how it is turned."""
        body, pose = evidence.body(evidence.prim(item.name)), item.pose
        if pose is None or evidence.varied:
            return
        wanted = vehicle_of(item, evidence.world.gravity).body(body.prim)
        far = math.dist(body.position, pose.position)
        if far > self.off * wheelbase:
            yield self.measured(
                f"{body.prim} starts at {listed(body.position)} m, {far:.3g} m from the plan's "
                f"{listed(pose.position)} m",
                far, self.off * wheelbase, "m", expected=0.0, prim=body.prim, time=0.0,
                limit_from=f"{self.off:g} of its wheelbase",
                target=RepairTarget(kind="geometry", prim=body.prim, parameter="position", direction="change",
                                    vector=pose.position, unit="m"),
            )  # fmt: skip
        if (off := between_deg(body.rotation, wanted.rotation)) > self.heading:
            yield self.turned(body.prim, "starts turned", off, "the plan's pose", "rotation_deg", self.heading)

    def _extra(self, evidence: Evidence, item: PlanObject, source: str) -> Iterator[Finding]:
        """Bodies within it that it has not, and what pulls it, couples it, or lets it pass through things."""
        prims, world = {evidence.prim(name) for name in item.prims}, evidence.world
        for body in world.bodies:
            if body.prim not in prims and owner(evidence, body.prim) is item:
                yield self.differs(body.prim, f"is a body of {item.name} that {source} has not", source, "", "remove")
        parts = {joint.prim for joint in world.joints if owner(evidence, joint.child) is item}
        for gear in world.gears:
            if {gear.first, gear.second} & parts:
                yield self.differs(gear.prim, f"couples joints of {item.name}", source, "", "remove")
        for cord in world.cords:
            if any(guide.body is not None and owner(evidence, guide.body) is item for guide in cord.path):
                yield self.differs(cord.prim, f"pulls at {item.name}", source, "", "remove")
        for one, other in world.apart:
            if owner(evidence, one) is item or owner(evidence, other) is item:
                yield self.differs(one, f"and {other} are kept from touching", source, "collides", "remove")

    def _body(
        self, evidence: Evidence, has: Body, one: Body, frames: tuple[Body, Body], near: float, source: str
    ) -> Iterator[Finding]:  # fmt: skip
        """A body beside its counterpart, each in the frame of its own vehicle."""
        prim = has.prim
        if not evidence.varied:
            yield from self._weighs(has, one, near, source)
            yield from self._starts(has, one, frames, source)
        at, wanted = (
            in_frame(frame.rotation, np.subtract(each.position, frame.position))
            for each, frame in zip((has, one), frames, strict=True)
        )
        if math.dist(at, wanted) > near:
            yield self.vector(prim, "a place on it", tuple(at), tuple(wanted), near, "m", source, "position")
        turns = [
            multiply(conjugate(np.array(f.rotation)), np.array(b.rotation))
            for b, f in zip((has, one), frames, strict=True)
        ]
        if (off := between_deg(*turns)) > self.turn:
            yield self.turned(prim, "is turned on it", off, source, "rotation_deg")
        yield from self.shapes(prim, has.shapes, one.shapes, near, source)

    def _weighs(self, has: Body, one: Body, near: float, source: str) -> Iterator[Finding]:
        """Its mass, where that is, and how hard it is to turn."""
        yield from self.shared(has.prim, "a mass", has.mass, one.mass, "kg", source, "mass")
        if math.dist(has.com, one.com) > near:
            yield self.vector(has.prim, "a centre of mass", has.com, one.com, near, "m", source, "com")
        off, limit = math.dist(has.inertia, one.inertia), self.share * max(one.inertia)
        if off > limit:
            moments, wanted = (tuple(np.reshape(each.inertia, (3, 3)).diagonal().tolist()) for each in (has, one))
            yield self.vector(has.prim, "moments of inertia", moments, wanted, limit, "kg m^2", source, "inertia")

    def _starts(self, has: Body, one: Body, frames: tuple[Body, Body], source: str) -> Iterator[Finding]:
        """How fast it starts, as seen from its vehicle."""
        for what, unit in (("velocity", "m/s"), ("angular_velocity", "rad/s")):
            moves, wanted = (
                tuple(in_frame(frame.rotation, getattr(each, what)).tolist())
                for each, frame in zip((has, one), frames, strict=True)
            )
            limit = max(self.still, self.share * math.hypot(*wanted))
            if math.dist(moves, wanted) > limit:
                said = f"a starting {what.replace('_', ' ')}"
                yield self.vector(has.prim, said, moves, wanted, limit, unit, source, what, "physical parameter")

    def _joints(
        self, evidence: Evidence, item: PlanObject, wanted: World, near: float, source: str
    ) -> Iterator[Finding]:
        """Its joints: each one's counterpart is of its kind, between the same bodies."""
        free = [
            joint for joint in evidence.world.joints
            if joint.parent is not None and all(owner(evidence, end) is item for end in (joint.parent, joint.child))
        ]  # fmt: skip
        for one in wanted.joints:
            ends = (one.parent, one.child, one.kind)
            has = next((each for each in free if (each.parent, each.child, each.kind) == ends), None)
            if has is None:
                yield self.differs(one.child, f"is held by no {one.kind} joint to {one.parent}", source, "joint", "add")
                continue
            free.remove(has)
            yield from self._placed_joint(has, one, near, source)
            if not evidence.varied:
                yield from self._held(has, one, source)
        for extra in free:
            says = f"is a {extra.kind} joint between {extra.parent} and {extra.child} that {source} has not"
            yield self.differs(extra.prim, says, source, "joint", "remove")

    def _placed_joint(self, has: Joint, one: Joint, near: float, source: str) -> Iterator[Finding]:
        """Where a joint is on both its ends, and its axis there."""
        for end in ("parent", "child"):
            ways = [
                rotate(np.array(getattr(each, f"{end}_turn")), np.eye(3)["XYZ".index(each.axis)]) for each in (has, one)
            ]
            off = math.degrees(math.acos(max(-1.0, min(1.0, float(ways[0] @ ways[1])))))
            if off > self.turn:
                yield self.turned(has.prim, f"has an axis on its {end}", off, source, "axis")
            at, to = (getattr(each, f"{end}_anchor") for each in (has, one))
            if at is None or math.dist(at, to) > near:
                yield self.vector(
                    has.prim, f"a place on its {end}", at or (0.0,) * 3, to, near, "m", source, "anchor", "joint"
                )
        if has.may_break or has.closing:
            yield self.differs(has.prim, "may break, or closes a loop", source, "break_force", "remove")

    def _held(self, has: Joint, one: Joint, source: str) -> Iterator[Finding]:
        """How far a joint goes, and what brakes and drives it: numbers that a program's parameter may set."""
        unit = "rad" if one.kind == "revolute" else "m"
        stops, wanted = (_stops(each) for each in (has, one))
        limit = self.share * min(wanted[1] - wanted[0], FREE)
        if stops != wanted and math.dist(stops, wanted) > limit:
            yield self.vector(has.prim, "stops", stops, wanted, limit, unit, source, "limits", "joint")
        if has.friction > one.friction:
            says = f"is braked by {has.friction:.4g} {'N m' if unit == 'rad' else 'N'}; the plan brakes no wheel"
            yield self.differs(has.prim, says, source, "friction")
        yield from self.shared(has.prim, "an armature", has.armature, one.armature, "kg m^2", source, "armature")
        yield from self._drive(has, _motor(has), _motor(one), unit, source)

    def _drive(
        self, joint: Joint, has: Motor | None, one: Motor | None, unit: str, source: str
    ) -> Iterator[Finding]:  # fmt: skip
        """The motor, spring or steering of a joint."""
        if has is None or one is None:
            if has is not None:
                says = "has a drive of its own; the plan has none there"
                yield self.differs(joint.prim, says, source, "drive", "remove")
            elif one is not None:
                yield self.differs(joint.prim, f"is driven or held by nothing; {source} is", source, "drive", "add")
            return
        effort = "N m" if unit == "rad" else "N"
        numbers = [
            ("stiffness", f"{effort}/{unit}", self.share * one.stiffness),
            ("damping", f"{effort} s/{unit}", self.share * one.damping),
        ]
        if one.stiffness > 0.0:  # what has none holds no position, and without damping no speed
            held = STEER if unit == "rad" else self.share * abs(one.position)
            numbers.append(("position", unit, held))
        if one.damping > 0.0:
            numbers.append(("velocity", f"{unit}/s", max(self.still, self.share * abs(one.velocity))))
        for what, of, limit in numbers:
            yield from self.number(joint.prim, f"a drive's {what}", getattr(has, what), getattr(one, what), limit, of,
                                   source, f"drive.{what}", "drive")  # fmt: skip
        if (has.max_effort is None) != (one.max_effort is None):
            most = "no greatest effort" if has.max_effort is None else f"at most {has.max_effort:.4g} {effort}"
            yield self.differs(joint.prim, f"has {most}, other than {source}", source, "drive")
        elif has.max_effort is not None and one.max_effort is not None:
            yield from self.shared(joint.prim, "a greatest effort", has.max_effort, one.max_effort, effort, source,
                                   "drive.max_force", "drive")  # fmt: skip
        if has.saturates or not has.told:
            yield self.differs(joint.prim, "is said to saturate, or to act as nobody says", source, "drive")


def _whole(evidence: Evidence, item: PlanObject) -> bool:
    """Whether all of its bodies are there, which CheckPlanObjects asks."""
    return {evidence.prim(name) for name in item.prims} <= {body.prim for body in evidence.world.bodies}


def _stops(joint: Joint) -> tuple[float, float]:
    """Its stops; where there is none, so far away that no wheel comes to it."""
    return -FREE if joint.low is None else joint.low, FREE if joint.high is None else joint.high


def _motor(joint: Joint) -> Motor | None:
    """A drive that acts."""
    return joint.drive if joint.drive is not None and joint.drive.stiffness + joint.drive.damping > 0.0 else None


CHECKS: Checks = (CheckPlanVehicles,)
