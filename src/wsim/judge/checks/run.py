"""Checks of the run as such: is it whole, finite, and of the world that was asked for?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.plan_control import CheckPlanControl
from wsim.judge.repair.rule import longer_run, unstable
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckFinite(Check):
    """Every pose, velocity, force and particle is a finite number, and every rotation a unit quaternion."""

    rotation_error: float = 1e-3  # of a quaternion's length

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The first time and prim at which a value is not finite."""
        recording = evidence.recording
        first: tuple[float, str, str] | None = None
        for what, array in (
            ("pose", recording.body_q),
            ("velocity", recording.body_qd),
            ("contact force", recording.contact_force),
        ):
            for frame, i in np.argwhere(~np.isfinite(array).all(axis=2))[:1]:
                first = _earlier(first, (float(evidence.time[frame]), evidence.world.bodies[i].prim, what))
        for prim, track in recording.fluids.items():
            for what, array in (
                ("particle positions", track.position),
                ("particle velocities", track.velocity),
                ("particle densities", track.density),
            ):
                wrong = ~np.isfinite(array)
                if track.present is not None:
                    wrong &= track.present.reshape(*track.present.shape, *(1,) * (array.ndim - 2))
                bad = wrong.any(axis=tuple(range(1, array.ndim)))
                if bad.any():
                    first = _earlier(first, (float(track.time[np.argmax(bad)]), prim, what))
        if first is not None:
            time, prim, what = first
            message = f"{prim}: the {what} is not a finite number from {time:.3f} s on"
            return [self.failed(message, prim=prim, time=time, limit_from="NaN or infinity")]
        return [self._rotations(evidence)]

    def _rotations(self, evidence: Evidence) -> Finding:
        error = np.abs(np.linalg.norm(evidence.body_q[:, :, 3:], axis=2) - 1.0)
        if error.size == 0:
            return self.passed("Every value is finite")
        frame, i = np.unravel_index(int(np.argmax(error)), error.shape)
        prim = evidence.world.bodies[i].prim
        value = float(error[frame, i])
        message = "Every value is finite, every rotation a unit quaternion"
        if value > self.rotation_error:
            message = f"{prim}: its rotation is no unit quaternion at {evidence.time[frame]:.3f} s"
        return self.measured(
            message, value, self.rotation_error, "1", prim=prim, time=float(evidence.time[frame]),
            limit_from="a quaternion's length is 1, to single precision and the integrator's drift",
        )  # fmt: skip

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """Numbers that are not finite, or rotations that are none, come from a step beyond the solver's stability."""
        return unstable(evidence)


def _earlier(a: tuple[float, str, str] | None, b: tuple[float, str, str]) -> tuple[float, str, str]:
    return b if a is None or b[0] < a[0] else a


@dataclass
class CheckComplete(Check):
    """The recording covers the planned time, in order, and holds the particles of every fluid."""

    frames_missing: float = 1.5  # at the end

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for the time covered, and one for each thing that is missing."""
        found = []
        planned = evidence.plan.simulation.duration if evidence.plan is not None else evidence.world.duration
        error = evidence.recording.metadata.get("error")
        reached = float(evidence.time[-1])
        limit = planned - self.frames_missing / evidence.world.frame_rate
        message = f"The recording covers {reached:.3f} s of {planned:g} s"
        found.append(
            self.measured(
                f"{message}: {error}" if error and reached < limit else message,
                reached, limit, "s", at_most=False, time=reached, expected=planned,
                limit_from=f"the planned duration less {self.frames_missing:g} frames",
            )
        )  # fmt: skip
        back = np.flatnonzero(np.diff(evidence.time) <= 0)
        if len(back):
            found.append(self.failed("Recorded times do not increase", time=float(evidence.time[back[0]])))
        # Half the frames is far below any thinning a recorder does, and far above what a stalled one leaves.
        wanted = 0.5 * min(reached, planned) * evidence.world.frame_rate
        if len(evidence.time) < wanted:
            message = f"The recording has {len(evidence.time)} frames, where {2 * wanted:.0f} were asked for"
            found.append(
                self.measured(message, len(evidence.time), wanted, "frames", at_most=False, limit_from="half of them")
            )
        for fluid in evidence.world.fluids:
            track = evidence.recording.fluids.get(fluid.prim)
            if track is None or len(track.time) == 0 or not track.count.any():
                message = f"{fluid.prim}: the recording holds no particles of it"
                found.append(self.failed(message, prim=fluid.prim))
        return found

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """Too short a run was asked for, or the run broke off."""
        if finding.prim is not None:
            why = "the recording holds no particles of it: it is empty, or smaller than a particle"
            return RepairTarget(kind="fluid", prim=finding.prim, parameter="level", direction="raise", why=why)
        if finding.unit == "s" and finding.expected is not None:
            if finding.expected > evidence.world.duration:
                return longer_run(evidence, finding.expected, "the plan asks for more than the program simulates")
            return unstable(evidence)
        why = "the recorder did not keep up with the frame rate that was asked for"
        return RepairTarget(
            kind="program", parameter="frame_rate", direction="lower", current=evidence.world.frame_rate, why=why
        )


@dataclass
class CheckLog(Check):
    """The run's log has no error and no overflow warning."""

    levels: tuple[str, ...] = ("ERROR", "CRITICAL", "FATAL")
    words: tuple[str, ...] = ("overflow",)

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each bad line, or one for none."""
        found = []
        for entry in evidence.recording.log:
            bad = entry.level.upper() in self.levels or any(word in entry.text.lower() for word in self.words)
            if bad:
                message = f"{entry.level.upper()} in the log: {entry.text}"
                found.append(self.failed(message, prim=entry.prim, time=entry.time))
        return found or [self.passed("The log has no error and no overflow")]

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """An overflow is contacts that the solver had no room for; another error is the solver's own account."""
        if "overflow" in finding.message.lower():
            why = "more contacts than the solver has room for: fewer shapes that touch, and none that start overlapping"
            return RepairTarget(kind="geometry", prim=finding.prim, parameter="shapes", direction="change", why=why)
        if "finite" in finding.message.lower():
            return unstable(evidence)
        return RepairTarget(
            kind="program", prim=finding.prim, direction="change", why="the log's error says what to mend"
        )


@dataclass
class CheckPlanObjects(Check):
    """The world has the plan's objects, in their roles, and no others."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that is missing, misplaced or extra, or one for none."""
        if evidence.plan is None:
            return []
        world = evidence.world
        has = {
            "container": {c.prim for c in world.containers},
            "fluid": {f.prim for f in world.fluids},
            "dynamic": {b.prim for b in world.bodies if not b.kinematic},
            "kinematic": {b.prim for b in world.bodies if b.kinematic},
            "static": {s.prim for s in world.statics},
        }
        everything = {"/".join(prim.split("/")[:3]) for prims in has.values() for prim in prims}
        found = []
        for item in evidence.plan.objects:
            # A bucket of the catalogue is a container, too: what can be in it is its objectives' affair.
            kind = "container" if item.primitive == "tank" else "fluid" if item.role == "fluid" else item.state
            missing = [evidence.prim(name) for name in item.prims if evidence.prim(name) not in everything]
            prim = missing[0] if missing else evidence.prim(item.prims[0])
            if missing:
                found.append(self.failed(f"The plan's {item.name} is not in the world: no {prim}", prim=prim))
            elif not (any(within(each, prim) for each in has[kind]) if item.assembled else prim in has[kind]):
                actual = next((name for name, prims in has.items() if prim in prims), "something else")
                message = f"{prim} is {actual}; the plan has it as {kind}"
                found.append(self.failed(message, prim=prim))
            elif item.primitive == "vehicle" and (
                lacks := [p for p in map(evidence.prim, item.prims) if p not in has[kind]]
            ):
                found.append(self.failed(f"{lacks[0]} is no {kind} body, as of a vehicle it is", prim=lacks[0]))
            elif item.primitive == "robot" and not _linked(evidence, prim):
                found.append(self.failed(f"{prim} has no links that joints hold together, as a robot has", prim=prim))
        planned = {evidence.prim(name) for item in evidence.plan.objects for name in item.prims}
        links = {prim for prim in everything for cord in evidence.plan.cords if cord.owns(prim.rpartition("/")[2])}
        for prim in sorted(everything - planned - links):
            message = f"{prim} is in the world, but not in the plan"
            found.append(self.failed(message, prim=prim))
        return found or [self.passed(f"The world has the plan's {len(evidence.plan.objects)} objects and no others")]

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """An object of the plan that the world lacks, or has in another role, or one that the plan does not have."""
        prim = finding.prim
        items = evidence.plan.objects if evidence.plan is not None else []
        planned = {evidence.prim(name) for item in items for name in item.prims}
        if prim not in planned:
            why = "the plan does not have it"
            return RepairTarget(kind="extra object", prim=prim, direction="remove", why=why)
        owners = (evidence.world.bodies, evidence.world.statics, evidence.world.containers, evidence.world.fluids)
        if prim in {item.prim for group in owners for item in group}:
            return RepairTarget(
                kind="program", prim=prim, parameter="role", direction="change", why="the plan has it in another role"
            )
        return RepairTarget(
            kind="missing object", prim=prim, direction="add", why="the plan has it, the world does not"
        )


def _linked(evidence: Evidence, whole: str) -> bool:
    """Whether what lies under a prim is several bodies, each of them held by a joint to another."""
    links = {body.prim for body in evidence.world.bodies if within(body.prim, whole)}
    held = [joint for joint in evidence.world.joints if within(joint.prim, whole)]
    return len(links) > 1 and links <= {end for joint in held for end in (joint.parent, joint.child)}


CHECKS: Checks = (CheckFinite, CheckComplete, CheckLog, CheckPlanObjects, CheckPlanControl)
