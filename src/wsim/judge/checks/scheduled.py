"""Check of what happens by time: clocks begin at their events, and what is set is what schedules say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.laws import Laws
from wsim.judge.checks.check import Check, Checks, worst
from wsim.judge.evidence.joints import said_broken
from wsim.judge.evidence.motion import FLOAT32, OURS
from wsim.judge.evidence.scheduled import Aims, begin_of, pushed
from wsim.judge.evidence.triggers import came
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Joint, Schedule

    Floats = NDArray[np.float64]

AROUND = 2  # frames after a key, in which a drive follows it


@dataclass
class CheckSchedules(Check):
    """What schedules set is set, as they say and when they say; of other engines' worlds nothing is asked."""

    share: float = 0.01  # of what is set
    steps: float = 2.0  # that a clock may be late by

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each kind of question, of what is farthest off."""
        world = evidence.world
        if not world.schedules or OURS not in evidence.recording.metadata or len(evidence.time) < 2:
            return []
        joints = {joint.prim: joint for joint in world.joints}
        begun = [self._begins(evidence, each) for each in world.schedules if each.after is not None]
        driven = {each.target for each in world.schedules if each.quantity in ("position", "velocity")} & joints.keys()
        efforts = [found for prim in sorted(driven) if (found := self._aimed(evidence, joints[prim])) is not None]
        goes = [self._released(evidence, each) for each in world.schedules if each.quantity == "release"]
        return [*worst_of(begun), *worst_of(self._pushed(evidence)), *worst_of(efforts), *worst_of(goes)]

    # ---- events
    def _begins(self, evidence: Evidence, schedule: Schedule) -> Finding:
        """Its clock begins as its event has come, and its delay is over."""
        event, begin = schedule.after, begin_of(evidence, schedule)
        assert event is not None
        first = came(evidence, event)
        name, end = schedule.prim.rsplit("/", 1)[-1], float(evidence.time[-1])
        fields: dict[str, Any] = {
            "prim": _of(evidence, schedule.target),
            "line": schedule.line,
            "limit_from": "its event, by motion",
        }
        if begin is None or begin > end:
            if first is None or first[1] + event.delay > end - self.steps * evidence.motion.dt:
                what = f"{name} never begins: {_said(evidence, schedule)} does not come in {end:g} s"
                target = RepairTarget(
                    kind="program", why="let the event come, or give the schedule times from the start"
                )
                return self.failed(what, target=target, **fields)
            return self.failed(
                f"{name} does not begin, though its event comes at {first[1]:.3f} s", time=first[1], **fields
            )
        slack = self.steps * evidence.motion.dt
        if first is None:
            return self.failed(f"{name} begins at {begin:.3f} s, though its event never comes", time=begin, **fields)
        early, late = first[0] + event.delay - begin, begin - first[1] - event.delay
        return self.measured(
            f"{name} begins at {begin:.4f} s, and its event comes at {first[1]:.4f} s, {event.delay:g} s before",
            max(early, late, 0.0), slack, "s", expected=0.0, time=begin, fine="Schedules begin at their events",
            **fields,
        )  # fmt: skip

    # ---- bodies
    def _pushed(self, evidence: Evidence) -> list[Finding]:
        """Impulses that were given to bodies against those of the schedules."""
        world, motion = evidence.world, evidence.motion
        bodies = sorted({evidence.index(each.target) for each in world.schedules
                         if each.quantity in ("force", "torque")})  # fmt: skip
        if not bodies:
            return []
        given, applied = evidence.recording.scheduled, evidence.recording.applied_impulse
        if given is None or applied is None:
            return [self.failed("Schedules push bodies, and no push of theirs is recorded", time=0.0)]
        stated, unsure = pushed(evidence)
        off = given[1:].astype(np.float64) - stated[1:]
        found = []
        for i in bodies:
            for part, of, unit in ((slice(3), 1.0, "N"), (slice(3, 6), float(motion.radius[i]), "N m")):
                gap = lengths(off[:, i, part]) / motion.h
                most = lengths(stated[:, i, part]).max() / motion.h.min()
                turns = unsure[1:, i] / motion.h * (unit == "N m")
                weight = float(motion.mass[i]) * max(evidence.gravity, 1.0) * of
                size = lengths(stated[1:, i, part]) / motion.h
                # Single precision knows a time, and a clock a step.
                limit = self.share * size + turns + 1e-4 * most + 1e-6 * weight
                k = int(np.argmax(gap / np.maximum(limit, 1e-30)))
                prim = world.bodies[i].prim
                found.append(self.measured(
                    f"{prim} is pushed by {gap[k]:.3g} {unit} otherwise than its schedules say, from "
                    f"{evidence.time[k]:.3f} to {evidence.time[k + 1]:.3f} s",
                    float(gap[k]), float(limit[k]), unit, prim=prim, time=float(evidence.time[k + 1]), expected=0.0,
                    fine="Bodies are pushed as schedules say", limit_from=f"{self.share:g} of what they say",
                ))  # fmt: skip
        return found

    # ---- drives
    def _aimed(self, evidence: Evidence, joint: Joint) -> Finding | None:
        """A drive gives at frames what its law does with the aim of its schedule; a while after a key nothing is asked.

        Its effort is that of a step's end. How the joint goes between frames beside tells how far that may be off.
        """
        effort = evidence.recording.scalars.get("drive" + joint.prim.removeprefix("/World"))
        drive, track = joint.drive, evidence.joint(joint)
        if effort is None or drive is None or track is None or len(evidence.time) < 2 * AROUND + 2:
            return None
        aims, motion = Aims.of(evidence, joint), evidence.motion
        rate = _rate(evidence, joint, track.position)
        law = drive.stiffness * (aims.position - track.position) + drive.damping * (aims.velocity - rate)
        most = np.inf if drive.max_effort is None else drive.max_effort
        law = np.clip(law, -most, most)
        wobble = np.abs(np.gradient(np.gradient(rate))) + np.abs(np.diff(rate, prepend=rate[:1]))
        moves = np.maximum(np.abs(rate), np.abs(aims.velocity))
        limit = self.share * (np.abs(law) + np.abs(effort) + drive.damping * moves) + drive.damping * wobble
        limit = limit + drive.stiffness * (2.0 * motion.dt * np.abs(rate) + self.share * np.ptp(track.position))
        extent = float(np.abs(motion.com).max(initial=np.pi))
        limit = limit + 16.0 * FLOAT32 * (drive.stiffness + drive.damping) * extent
        asked = np.ones(len(law), dtype=bool)
        asked[0] = False
        for key in np.flatnonzero(aims.jumps):
            asked[key : key + AROUND + 2] = False
        gone = said_broken(evidence, joint)
        asked &= True if gone is None else ~(np.nan_to_num(gone) > 0.0)
        if not asked.any():
            return None
        off = np.where(asked, np.abs(law - effort), 0.0)
        k = int(np.argmax(off / limit))
        unit = "N m" if joint.kind == "revolute" else "N"
        return self.measured(
            f"The drive of {joint.prim} gives {effort[k]:.3g} {unit} at {evidence.time[k]:.3f} s; with the aim that "
            f"its schedule has then it would give {law[k]:.3g} {unit}",
            float(off[k]), float(limit[k]), unit, prim=joint.child, line=evidence.line(joint.prim),
            time=float(evidence.time[k]), expected=0.0, fine="Drives aim at what schedules say",
            limit_from=f"{self.share:g} of it and of what its damping gives at its speed, and how that changes",
        )  # fmt: skip

    # ---- joints that let go
    def _released(self, evidence: Evidence, schedule: Schedule) -> Finding:
        joint = next(each for each in evidence.world.joints if each.prim == schedule.target)
        begin, gone = begin_of(evidence, schedule), said_broken(evidence, joint)
        due = np.inf if begin is None else begin + schedule.times[0]
        at = np.flatnonzero(np.nan_to_num(gone) > 0.0) if gone is not None else np.zeros(0, dtype=int)
        fields: dict[str, Any] = {
            "prim": joint.child,
            "line": schedule.line,
            "limit_from": "the schedule, and a time step",
        }
        end, slack = float(evidence.time[-1]), self.steps * evidence.motion.dt
        if not len(at):
            late = max(end - slack - due, 0.0)
            return self.measured(
                f"{joint.prim} does not let go, which is due at {due:.3f} s", late, 0.0, "s", expected=0.0, time=end,
                fine="Joints let go when they are due", **fields,
            )  # fmt: skip
        start, seen = float(evidence.time[max(at[0] - 1, 0)]), float(evidence.time[at[0]])
        off = max(start - slack - due, due - seen - slack, 0.0)
        off = 1e9 if not np.isfinite(off) else off
        return self.measured(
            f"{joint.prim} lets go between {start:.3f} and {seen:.3f} s, and is due at {due:.3f} s", off, slack, "s",
            expected=0.0, time=seen, fine="Joints let go when they are due", **fields,
        )  # fmt: skip


def worst_of(found: list[Finding]) -> list[Finding]:
    """All that failed, or the nearest to it; nothing of nothing."""
    return worst(found) if found else []


def _rate(evidence: Evidence, joint: Joint, position: Floats) -> Floats:
    """The speed of a hinge or a slider at frames, (T,) [rad/s or m/s]."""
    if Laws not in evidence.kept:
        evidence.kept[Laws] = Laws(evidence)
    laws = evidence.kept[Laws]
    assert isinstance(laws, Laws)
    return laws.rate(joint)


def _of(evidence: Evidence, target: str) -> str | None:
    """The body that a schedule is of, or what it is about."""
    return next((joint.child for joint in evidence.world.joints if joint.prim == target), target)


def _said(evidence: Evidence, schedule: Schedule) -> str:
    """An event in words."""
    event = schedule.after
    assert event is not None
    first, second = (prim.rsplit("/", 1)[-1] if prim else "" for prim in (event.first, event.second))
    beyond = f"{'above' if event.above else 'below'} {event.value:.4g}"
    return {
        "touch": f"that {first} and {second} touch", "place": f"that {first} is {beyond} m along {event.axis}",
        "joint": f"that {first} is {beyond}", "start": f"the start of {first}", "end": f"the end of {first}",
    }[event.kind]  # fmt: skip


CHECKS: Checks = (CheckSchedules,)
