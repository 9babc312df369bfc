"""Repair targets of the checks that hold for any world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import ROUND
from wsim.geometry.shapes import kind_of
from wsim.judge.repair.drive import by_drive, drive_of, stronger
from wsim.judge.repair.place import overlapping_start
from wsim.judge.repair.rule import (
    FARTHEST,
    ROOM,
    Rule,
    add_collision,
    collides,
    faster_sound,
    finer,
    longer_run,
    shorter_step,
    sound_speed,
)
from wsim.judge.verdict import Finding, RepairTarget
from wsim.scene.contact import friction_of, rolling_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Container, Fluid

    Floats = NDArray[np.float64]

SOUND_OVER_SPEED = 10.0  # Monaghan (1994): density varies by about (v / c)^2, which is then 1 %


def finite(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Numbers that are not finite, or rotations that are none, come from a step beyond the solver's stability."""
    why = "values grow without bound where the step is longer than the solver is stable for; half is the first to try"
    return shorter_step(evidence, 0.5, why)


def complete(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Too short a run was asked for, or the run broke off."""
    if finding.prim is not None:
        why = "the recording holds no particles of it: it is empty, or smaller than a particle"
        return RepairTarget(kind="fluid", prim=finding.prim, parameter="level", direction="raise", why=why)
    if finding.unit == "s" and finding.expected is not None:
        if finding.expected > evidence.world.duration:
            return longer_run(evidence, finding.expected, "the plan asks for more than the program simulates")
        return finite(finding, evidence)
    why = "the recorder did not keep up with the frame rate that was asked for"
    return RepairTarget(
        kind="program", parameter="frame_rate", direction="lower", current=evidence.world.frame_rate, why=why
    )


def log(finding: Finding, evidence: Evidence) -> RepairTarget:
    """An overflow is contacts that the solver had no room for; another error is the solver's own account."""
    if "overflow" in finding.message.lower():
        why = "more contacts than the solver has room for: fewer shapes that touch, and none that start overlapping"
        return RepairTarget(kind="geometry", prim=finding.prim, parameter="shapes", direction="change", why=why)
    if "finite" in finding.message.lower():
        return finite(finding, evidence)
    return RepairTarget(kind="program", prim=finding.prim, direction="change", why="the log's error says what to mend")


def plan_objects(finding: Finding, evidence: Evidence) -> RepairTarget:
    """An object of the plan that the world lacks, or has in another role, or one that the plan does not have."""
    prim = finding.prim
    planned = {evidence.prim(item.name) for item in evidence.plan.objects} if evidence.plan is not None else set()
    if prim not in planned:
        why = "the plan does not have it"
        return RepairTarget(kind="extra object", prim=prim, direction="remove", why=why)
    owners = (evidence.world.bodies, evidence.world.statics, evidence.world.containers, evidence.world.fluids)
    if prim in {item.prim for group in owners for item in group}:
        return RepairTarget(
            kind="program", prim=prim, parameter="role", direction="change", why="the plan has it in another role"
        )
    return RepairTarget(kind="missing object", prim=prim, direction="add", why="the plan has it, the world does not")


def explosion(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A start inside another shape is pushed apart; sound must outrun a fluid; else the step is too long."""
    fluid = next((fluid for fluid in evidence.world.fluids if fluid.prim == finding.prim), None)
    if fluid is not None:
        sound = sound_speed(evidence, fluid)
        if sound and finding.limit is not None and finding.limit >= sound * (1 - 1e-9):
            return faster_sound(
                evidence,
                fluid,
                SOUND_OVER_SPEED * (finding.value or sound),
                "sound must be ten times as fast as the fluid",
            )
        return shorter_step(
            evidence, 0.5, "particles that outrun gravity were thrown by the solver; half the step is the first to try"
        )
    start = overlapping_start(evidence, finding.prim)
    if start is not None:
        return start
    return shorter_step(
        evidence, 0.5, "no fall in this scene gives that speed: the solver made it; half the step is the first to try"
    )


def penetration(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A start inside another shape, or a contact that gives way: its depth is speed times step."""
    start = overlapping_start(evidence, finding.prim)
    if start is not None:
        return start
    value, limit = finding.value or 0.0, finding.limit or 0.0
    share = limit / value if 0.0 < limit < value else 0.5
    return shorter_step(evidence, share, "a contact gives way by speed times step, so that depth shrinks with the step")


def leak(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Over the rim: higher walls. Through a wall: one that is as thick as the particles need, or a shorter step."""
    fluid = evidence.fluid(finding.prim or "")
    container = evidence.container_of(fluid)
    if container is None:
        return RepairTarget(
            kind="missing object", prim=fluid.container, direction="add", why="the fluid has no container"
        )
    exit_heights = _exits(evidence, container, fluid)
    rim = container.inner_size[2]
    if len(exit_heights) and np.mean(exit_heights > rim - fluid.spacing) > 0.5:
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="inner_size.z", direction="raise", current=rim,
            suggested=max(float(exit_heights.max()), rim) + fluid.spacing, unit="m",
            why="it goes over the rim; this is how high it is where it does, and a spacing more",
        )  # fmt: skip
    if not collides(evidence, container.prim):
        return add_collision(container.prim)
    static = evidence.static(container.prim)
    wall = (
        min((kind_of(shape).thinnest for shape in static.shapes), default=math.inf) if static is not None else math.inf
    )
    if wall < fluid.spacing:
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="wall", direction="raise", current=wall,
            suggested=fluid.spacing, unit="m", why="it goes through a wall that is thinner than a particle",
        )  # fmt: skip
    return shorter_step(evidence, 0.5, "it goes through walls that are thick enough: half the step is the first to try")


def _exits(evidence: Evidence, container: Container, fluid: Fluid) -> Floats:
    """Height above the inner floor at which each particle that gets out did so, (n,) [m]."""
    track = evidence.track(fluid)
    out = evidence.containment(container, fluid).strayed
    gone = np.flatnonzero(out.any(axis=0))
    first = np.argmax(out[:, gone], axis=0)
    # Between two frames one may fall below the rim that it came over: it was above it at the frame before.
    when = np.stack([first, np.maximum(first - 1, 0)])
    where = evidence.local(container, np.asarray(track.position[when, gone], dtype=np.float64))
    heights: Floats = where[..., 2].max(axis=0) + container.inner_size[2] / 2
    return heights


def fluid_density(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Density errors fall with the square of the speed of sound."""
    fluid = evidence.fluid(finding.prim or "")
    sound = sound_speed(evidence, fluid)
    if not sound or not finding.value or not finding.limit or finding.value <= finding.limit:
        return shorter_step(
            evidence, 0.5, "the density drifts with the step's error; half the step is the first to try"
        )
    wanted = sound * math.sqrt(finding.value / finding.limit)
    return faster_sound(evidence, fluid, wanted, "the density error of a weakly compressible fluid goes as (v / c)^2")


def water_level(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Particles that stand higher or lower than their volume: finer ones keep the volume better."""
    fluid = evidence.fluid(finding.prim or "")
    return finer(evidence, fluid, 0.5, "particles that do not fill their volume are too coarse for this vessel")


def drives(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A drive at its full strength is to be stronger."""
    joint = next(joint for joint in evidence.world.joints if joint.prim == finding.prim)
    assert joint.drive is not None
    return stronger(joint, joint.drive)


def settled(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What dies down needs time, by its own decay; what does not is kept going by its drive, or the solver."""
    prim = finding.prim or ""
    if drive_of(evidence, prim) is not None:
        driven = by_drive(evidence, prim, None, "its drive keeps it going")
        if driven is not None and driven.suggested is not None:
            return driven
    i = evidence.index(prim)
    speed = np.linalg.norm(evidence.body_qd[:, i, :3], axis=1)
    end = float(evidence.time[-1])
    half = min(1.0, 0.25 * (end - float(evidence.time[0])))
    late = evidence.time > end - half
    early = (evidence.time > end - 2 * half) & ~late
    before, after = (float(np.sqrt(np.mean(speed[part] ** 2))) for part in (early, late))
    if after >= before or not finding.limit or not finding.value:
        return shorter_step(
            evidence, 0.5, "it does not die down: contacts or fluid keep it going; half the step is the first to try"
        )
    rate = math.log(before / after) / half
    wanted = end + max(0.0, math.log((1.0 + ROOM) * finding.value / finding.limit)) / rate + half
    if wanted > FARTHEST["duration"] * end:
        return damped(evidence, i, f"its speed falls by half in {math.log(2) / rate:.2g} s: no run is that long")
    return longer_run(evidence, wanted, f"its speed falls by half in {math.log(2) / rate:.2g} s: by then it is at rest")


def damped(evidence: Evidence, i: int, why: str) -> RepairTarget:
    """What goes on and on needs something that takes its energy: what is round resistance to rolling, else friction."""
    body = evidence.world.bodies[i]
    rolls = any(shape.kind in ROUND for shape in body.shapes)
    has = (rolling_of if rolls else friction_of)(body.shapes[0]) if body.shapes else None
    parameter = "rolling_friction" if rolls else "friction"
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter=parameter, direction="raise", current=has, why=why
    )  # fmt: skip


CHECKS: dict[str, Rule] = {
    "CheckFinite": finite,
    "CheckComplete": complete,
    "CheckLog": log,
    "CheckPlanObjects": plan_objects,
    "CheckExplosion": explosion,
    "CheckPenetration": penetration,
    "CheckFluidContained": leak,
    "CheckDensity": fluid_density,
    "CheckWaterLevel": water_level,
    "CheckSettled": settled,
    "CheckDrives": drives,
}
