"""Checks of the stage's vehicles and terrain against the plan's: what they are made of, and where they stand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.judge.checks.check import Check, Checks, listed, share_about
from wsim.judge.checks.plan import quaternion
from wsim.judge.verdict import RepairTarget
from wsim.plan.layout.land import survey
from wsim.plan.schema import FromScatter, FromTerrain, FromVehicle
from wsim.plan.schema.constructions import CORNERS
from wsim.scene.contact import friction_of, rolling_of
from wsim.scene.vehicle_spec import preset

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Actuation, PlanObject
    from wsim.scene.vehicle_spec import VehicleSpec
    from wsim.scene.world import Body, Joint, Shape, Static

    Floats = NDArray[np.float64]

SPEC = "the plan's kind of vehicle"
STEER = 0.1  # [deg]


@dataclass
class CheckPlanVehicles(Check):
    """Each vehicle is of the plan's kind, stands where the plan has it, and its engine does what the plan asks."""

    of_world = True

    share: float = 0.05  # of a number of its kind
    grip: float = 0.08  # of its tyres' friction
    rolling: float = 0.002  # of their rolling resistance
    place: float = 0.05  # of its wheelbase: where its wheels are on it
    off: float = 0.1  # of its wheelbase: where it starts
    turn: float = 4.0  # [deg]

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each number that differs, or one for none."""
        items = evidence.plan.objects if evidence.plan is not None else []
        vehicles = [item for item in items if item.primitive == "vehicle" and _whole(evidence, item)]
        found = [finding for item in vehicles for finding in self._vehicle(evidence, item)]
        return found or ([self.passed("Vehicles are of the plan's kinds, and driven as it has it")] if vehicles else [])

    def _vehicle(self, evidence: Evidence, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromVehicle)
        spec, body = preset(item.built.vehicle), evidence.body(evidence.prim(item.name))
        mass = sum(evidence.body(evidence.prim(name)).mass for name in item.prims)
        if not evidence.varied:
            yield from self._number(body.prim, "a mass", mass, spec.mass, "kg", "mass")
        for corner in CORNERS:
            yield from self._wheel(evidence, item, spec, corner)
        yield from self._placed(evidence, item, body, spec)

    def _wheel(self, evidence: Evidence, item: PlanObject, spec: VehicleSpec, corner: str) -> Iterator[Finding]:
        """A wheel: its tyre, where it is, its spring, and what drives it."""
        body, wheel = (evidence.body(evidence.prim(f"{item.name}{end}")) for end in ("", f"_wheel_{corner}"))
        tyre = next((shape for shape in wheel.shapes if shape.collides and shape.kind == "cylinder"), None)
        if tyre is None:
            yield self._wrong(wheel.prim, "has no tyre that touches the ground", "shape")
            return
        yield from self._number(wheel.prim, "a radius", tyre.size[0], spec.wheel_radius, "m", "wheel_radius")
        grip = self.grip * spec.friction
        yield from self._near(wheel.prim, "friction", friction_of(tyre), spec.friction, grip)
        yield from self._near(wheel.prim, "rolling_friction", rolling_of(tyre), spec.rolling, self.rolling)
        at = rotate(conjugate(np.array(body.rotation)), np.array(wheel.position) - np.array(body.position))
        far = float(np.linalg.norm(at - np.array([*spec.place(corner), spec.wheel_radius])))
        if far > self.place * spec.wheelbase:
            yield self._wrong(wheel.prim, f"is {far:.3g} m from where a {item.built.vehicle} has it", "position")  # type: ignore[union-attr]
        yield from self._held(evidence, item, spec, corner)

    def _held(self, evidence: Evidence, item: PlanObject, spec: VehicleSpec, corner: str) -> Iterator[Finding]:
        """Its spring, its steering and its axle."""
        part = {each: evidence.prim(f"{item.name}_{each}_{corner}") for each in ("hub", "knuckle", "wheel")}
        front, whole = corner.startswith("front"), evidence.prim(item.name)
        carrier = part["knuckle"] if front else part["hub"]
        spring = _joint(evidence, whole, part["hub"], "prismatic")
        steer = _joint(evidence, part["hub"], part["knuckle"], "revolute") if front else None
        axle = _joint(evidence, carrier, part["wheel"], "revolute")
        if spring is None or axle is None or (front and steer is None):
            lacks = "spring" if spring is None else "axle" if axle is None else "steering"
            yield self._wrong(part["wheel"], f"has no {lacks}", lacks)
            return
        stiff, damp = (
            (spec.spring_front, spec.damper_front) if front else (spec.spring_rear, spec.damper_rear)
        )  # fmt: skip
        drive = spring.drive
        yield from self._number(spring.prim, "a stiffness", drive.stiffness if drive else 0.0, stiff, "N/m", "spring")
        yield from self._number(spring.prim, "a damping", drive.damping if drive else 0.0, damp, "N s/m", "damper")
        if axle.friction > 0.0:
            yield self._wrong(axle.prim, f"is braked by {axle.friction:.4g} N m; the plan brakes no wheel", "friction")
        asked = next((each for each in item.registration.actuation if each.kind == "drive"), None)
        if steer is not None:
            yield from self._steered(steer, spec.wheel_angle_deg(corner, asked.steer_deg or 0.0 if asked else 0.0))
        yield from self._engine(axle, spec, corner, asked)

    def _steered(self, steer: Joint, wanted: float) -> Iterator[Finding]:
        """The drive of a steered wheel: it holds the plan's angle [deg]."""
        if steer.drive is None or steer.drive.stiffness <= 0.0:
            yield self._wrong(steer.prim, "is held by nothing", "drive", "add")
            return
        angle = math.degrees(steer.drive.position)
        if abs(angle - wanted) > STEER:
            yield self.between(
                f"{steer.prim} is steered to {angle:.3g} degrees; the plan has {wanted:.3g}",
                angle, (wanted - STEER, wanted + STEER), "deg", expected=wanted, prim=steer.prim, time=0.0,
                limit_from=SPEC, target=RepairTarget(kind="drive", prim=steer.prim, parameter="drive.position",
                                                     suggested=wanted, unit="deg"),
            )  # fmt: skip

    def _engine(self, axle: Joint, spec: VehicleSpec, corner: str, asked: Actuation | None) -> Iterator[Finding]:
        """The drive of an axle: that of an engine which holds the plan's speed, or none."""
        wanted = asked.speed if asked is not None and corner in spec.driven_corners else None
        if wanted is None or asked is None:
            if axle.drive is not None and axle.drive.damping + axle.drive.stiffness > 0.0:
                yield self._wrong(axle.prim, "has a drive of its own; the plan has none there", "drive", "remove")
            return
        if axle.drive is None:
            yield self._wrong(axle.prim, f"is driven by nothing; the plan has it go at {wanted:g} m/s", "drive", "add")
            return
        steer = asked.steer_deg or 0.0
        turns, torque = spec.wheel_speed(corner, wanted, steer) / spec.wheel_radius, spec.wheel_torque(wanted)
        yield from self._number(axle.prim, "a speed", axle.drive.velocity, turns, "rad/s", "drive.velocity")
        most = axle.drive.max_effort
        if most is None:
            yield self._wrong(axle.prim, f"has no greatest torque; the plan's kind has {torque:.4g} N m", "drive")
        else:
            yield from self._number(axle.prim, "a torque of at most", most, torque, "N m", "drive.max_force")

    def _placed(self, evidence: Evidence, item: PlanObject, body: Body, spec: VehicleSpec) -> Iterator[Finding]:
        if item.pose is None or evidence.varied:
            return
        far = float(np.linalg.norm(np.array(body.position) - np.array(item.pose.position)))
        if far > self.off * spec.wheelbase:
            yield self.measured(
                f"{body.prim} starts at {listed(body.position)} m, {far:.3g} m from the plan's "
                f"{listed(item.pose.position)} m",
                far, self.off * spec.wheelbase, "m", expected=0.0, prim=body.prim, time=0.0,
                limit_from=f"{self.off:g} of its wheelbase",
                target=RepairTarget(kind="geometry", prim=body.prim, parameter="position", direction="change",
                                    vector=item.pose.position, unit="m"),
            )  # fmt: skip
        ahead, wanted = (rotate(q, np.array([1.0, 0.0, 0.0])) for q in
                         (np.array(body.rotation), quaternion(item.pose.rotation_deg)))  # fmt: skip
        level = [each[:2] / max(float(np.linalg.norm(each[:2])), 1e-9) for each in (ahead, wanted)]
        off = math.degrees(math.acos(max(-1.0, min(1.0, float(level[0] @ level[1])))))
        if off > self.turn:
            yield self.measured(
                f"{body.prim} heads {off:.3g} degrees off the plan's", off, self.turn, "deg", expected=0.0,
                prim=body.prim, time=0.0, limit_from="the plan's pose",
                target=RepairTarget(kind="geometry", prim=body.prim, parameter="yaw_deg", direction="change",
                                    suggested=item.pose.rotation_deg[2], unit="deg"),
            )  # fmt: skip

    def _number(
        self, prim: str, what: str, value: float, wanted: float, unit: str, parameter: str
    ) -> Iterator[Finding]:
        if abs(value - wanted) > self.share * wanted:
            target = RepairTarget(
                kind="physical parameter", prim=prim, parameter=parameter, suggested=wanted, unit=unit
            )
            yield self.between(
                f"{prim} has {what} of {value:.4g} {unit}; the plan's kind has {wanted:.4g} {unit}",
                value, share_about(wanted, self.share), unit, expected=wanted, prim=prim, time=0.0,
                limit_from=f"{SPEC}, to {self.share:.0%}", target=target,
            )  # fmt: skip

    def _near(self, prim: str, what: str, value: float, wanted: float, limit: float) -> Iterator[Finding]:
        if abs(value - wanted) > limit:
            said = what.replace("_", " ")
            yield self.between(
                f"{prim} has a {said} of {value:g}; the plan has {wanted:g}", value,
                (wanted - limit, wanted + limit), "1", expected=wanted, prim=prim, time=0.0, limit_from=SPEC,
                target=RepairTarget(kind="physical parameter", prim=prim, parameter=what, suggested=wanted),
            )  # fmt: skip

    def _wrong(self, prim: str, what: str, parameter: str, direction: str = "change") -> Finding:
        target = RepairTarget.model_validate(
            {"kind": "drive" if parameter == "drive" else "geometry", "prim": prim, "parameter": parameter,
             "direction": direction}
        )  # fmt: skip
        return self.failed(f"{prim} {what}", prim=prim, time=0.0, limit_from=SPEC, target=target)


def _whole(evidence: Evidence, item: PlanObject) -> bool:
    """Whether all of its bodies are there, which CheckPlanObjects asks."""
    return {evidence.prim(name) for name in item.prims} <= {body.prim for body in evidence.world.bodies}


def _joint(evidence: Evidence, parent: str, child: str, kind: str) -> Joint | None:
    joints = evidence.world.joints
    return next((each for each in joints if (each.parent, each.child, each.kind) == (parent, child, kind)), None)


@dataclass
class CheckPlanTerrain(Check):
    """Terrain is as wide and as high as the plan's layers make it, and what is scattered on it as large as it says."""

    of_world = True

    height: float = 0.05  # [m]: of the ground anywhere
    share: float = 0.02  # of its area
    size: float = 0.05  # of a rock's greatest length

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each that differs, or one for none."""
        items = evidence.plan.objects if evidence.plan is not None else []
        made = {static.prim: static for static in evidence.world.statics}
        lands = [item for item in items if item.primitive == "terrain" and evidence.prim(item.name) in made]
        found = [f for item in lands for f in self._land(evidence, made[evidence.prim(item.name)], item)]
        for item in items:
            if isinstance(item.built, FromScatter) and item.rocks:
                stones = [made[prim] for name in item.prims if (prim := evidence.prim(name)) in made]
                found += [f for stone in stones for f in self._stone(stone, item.built.size[1])]
        return found or ([self.passed("Terrain is as the plan's layers make it")] if lands else [])

    def _land(self, evidence: Evidence, made: Static, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromTerrain)
        solid = [shape for shape in made.shapes if shape.kind == "mesh" and shape.collides]
        if len(solid) < len(made.shapes) or not solid:
            yield self._differs(made, f"{made.prim} is not solid ground of triangles, which the plan's terrain is")
            return
        corners = [_in_world(shape) for shape in solid]
        covered = sum(_from_above(at, shape) for at, shape in zip(corners, solid, strict=True))
        area = math.prod(item.built.extent)
        if abs(covered / area - 1.0) > self.share:
            yield self._differs(made, f"{made.prim} covers {covered:.4g} m^2; the plan's terrain {area:.4g} m^2")
            return
        named = {each.prim.rsplit("/", 1)[-1] for each in solid}
        for lacking in (each.name for each in item.built.areas if each.name not in named):
            yield self._differs(made, f"{made.prim} has no area {lacking}, which the plan's terrain has")
        if evidence.varied:
            return
        ground = survey(item)
        top = np.concatenate([_upper(at, shape) for at, shape in zip(corners, solid, strict=True)])
        if len(np.unique(top[:, :2].round(6), axis=0)) < ground.count:
            yield self._differs(
                made, f"{made.prim} has fewer corners than the plan's terrain, which has {ground.count}"
            )
            return
        x, y = (np.clip(top[:, k], -0.5 * edge, 0.5 * edge) for k, edge in enumerate(item.built.extent))
        off = np.abs(top[:, 2] - ground.heights(x, y))
        worst = int(off.argmax()) if len(off) else 0
        if not len(off) or off[worst] > self.height:
            where = listed(tuple(float(v) for v in top[worst])) if len(off) else "nowhere"
            yield self.measured(
                f"{made.prim} is not as high as the plan's layers make it: at {where} m it is "
                f"{float(off[worst]) if len(off) else math.inf:.3g} m off",
                float(off[worst]) if len(off) else math.inf, self.height, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from="the plan's layers",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="layers", direction="change"),
            )  # fmt: skip

    def _stone(self, made: Static, most: float) -> Iterator[Finding]:
        long = max((max(shape.size) for shape in made.shapes if shape.size), default=0.0)
        limit = most * (1.0 + self.size)
        if long > limit:
            yield self.measured(
                f"{made.prim} is {long:.3g} m long; the plan's rocks at most {most:g} m", long, limit, "m",
                prim=made.prim, time=0.0, limit_from="the plan's size",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="size", direction="lower"),
            )  # fmt: skip

    def _differs(self, made: Static, message: str) -> Finding:
        target = RepairTarget(kind="geometry", prim=made.prim, parameter="shape", direction="change")
        return self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's terrain", target=target)


def _in_world(shape: Shape) -> Floats:
    """A mesh's corners in the world [m]."""
    turned = rotate(np.array(shape.rotation), np.asarray(shape.vertices, dtype=np.float64))
    return np.asarray(turned + np.array(shape.position))


def _from_above(corners: Floats, shape: Shape) -> float:
    """Area of a mesh's upward triangles as seen from above [m^2]."""
    return float(0.5 * np.maximum(_twice(corners, shape), 0.0).sum())


def _upper(corners: Floats, shape: Shape) -> Floats:
    """Those of a mesh's corners that an upward triangle has."""
    return corners[np.unique(np.asarray(shape.triangles)[_twice(corners, shape) > 0.0])]


def _twice(corners: Floats, shape: Shape) -> Floats:
    """Twice the area of each triangle as seen from above, below 0 of those that face down [m^2]."""
    a, b, c = (corners[np.asarray(shape.triangles)[:, k]] for k in range(3))
    return np.asarray((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


CHECKS: Checks = (CheckPlanVehicles, CheckPlanTerrain)
