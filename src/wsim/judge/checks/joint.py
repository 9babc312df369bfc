"""Checks of joints: they hold, keep to their limits and ratios, are strong enough, and break when they are to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.bearing import load_of
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.joints import HELD, LEANS, broken, said_broken, unbroken_track_of
from wsim.judge.evidence.scheduled import released
from wsim.judge.repair.drive import stronger
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.joints import JointTrack
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]

UNTOLD = ", and what it bore before, at which it may have broken, cannot be told"


@dataclass
class CheckJoints(Check):
    """A joint holds: its anchors stay together, and its ends turn only as it lets them.

    That one may break excuses it from when it is recorded as broken. Where nobody recorded that, it does so only if its
    load just before can be told, which `CheckBreakage` then compares with its strength.
    """

    share: float = HELD  # of the child's smallest extent
    lean: float = LEANS  # [rad]

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The joint whose anchors are farthest apart, and the one that is turned most, by their limits."""
        found = []
        for joint in evidence.world.joints:
            excused = not joint.may_break or said_broken(evidence, joint) is not None or _load_is_told(evidence, joint)
            track = evidence.joint(joint) if excused else unbroken_track_of(evidence, joint)
            if track is not None:
                found.append(self._held(evidence, joint, track, "" if excused else UNTOLD))
        return sorted(found, key=lambda finding: finding.passed)[: max(1, sum(not f.passed for f in found))]

    def _held(self, evidence: Evidence, joint: Joint, track: JointTrack, besides: str) -> Finding:
        size = evidence.solid(evidence.index(joint.child)).smallest
        leans = track.turned.max() / self.lean > track.apart.max() / (self.share * size)
        error, limit = (track.turned, self.lean) if leans else (track.apart, self.share * size)
        at = int(np.argmax(error))
        wrong = error > limit
        since = float(evidence.time[np.argmax(wrong)]) if wrong.any() else float(evidence.time[at])
        value = float(error[at])
        what = f"turns by {value:.3g} rad against what it allows" if leans else f"is {value * 1e3:.3g} mm apart"
        return self.measured(
            f"{joint.prim} {what}{besides}",
            value, limit, "rad" if leans else "m", fine=f"{joint.prim} holds", prim=joint.prim, time=since,
            span=(since, float(evidence.time[len(wrong) - 1 - np.argmax(wrong[::-1])])) if wrong.any() else None,
            expected=0.0,
            limit_from=f"{self.lean:g} rad"
            if leans
            else f"{self.share:g} of {joint.child}'s smallest extent, {size:.3g} m",
            target=RepairTarget(kind="joint", prim=joint.prim, why="its ends come apart"),
        )  # fmt: skip


def _load_is_told(evidence: Evidence, joint: Joint) -> bool:
    """Whether a joint never came apart, or what it bore as it did can be told."""
    gone = broken(evidence, joint)
    load = load_of(evidence, joint) if gone.any() else None
    return not gone.any() or (load is not None and load.before(gone) is not None)


@dataclass
class CheckJointLimits(Check):
    """A hinge or slider keeps to its limits."""

    share: float = 0.05  # of the range: a stop is not quite rigid
    least: float = 0.01  # [rad] of a hinge, or this times the child's smallest extent of a slider

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each joint with limits."""
        found = []
        for joint in evidence.world.joints:
            track = evidence.joint(joint)
            if track is None or (joint.low is None and joint.high is None):
                continue
            over = beyond(joint, track)
            size = 1.0 if joint.kind == "revolute" else evidence.solid(evidence.index(joint.child)).smallest
            range_ = (joint.high - joint.low) if joint.low is not None and joint.high is not None else 0.0
            limit = max(self.share * range_, self.least * size) + yields(joint, track, evidence.motion.h)
            wrong = over > limit
            at = int(np.argmax(wrong)) if wrong.any() else int(np.argmax(over))
            unit = "rad" if joint.kind == "revolute" else "m"
            found.append(
                self.measured(
                    f"{joint.prim} goes {float(over.max()):.3g} {unit} beyond its limits",
                    float(max(over.max(), 0.0)), limit, unit, fine=f"{joint.prim} keeps to its limits", prim=joint.prim,
                    time=float(evidence.time[at]), limit_from=f"{self.share:g} of its range, for the give of its stops",
                    target=RepairTarget(kind="joint", prim=joint.prim, parameter="limits", direction="change"),
                )
            )  # fmt: skip
        return found


def yields(joint: Joint, track: JointTrack, h: Floats) -> float:
    """How far a joint's soft stops let it go at the speed that it has [rad or m]."""
    fastest = float((np.abs(np.diff(track.position)) / h).max(initial=0.0))
    return joint.give.depth + joint.give.time * fastest


def beyond(joint: Joint, track: JointTrack) -> NDArray[np.float64]:
    """How far a joint is beyond its limits, (T,) [rad or m]; negative within them."""
    over = np.full(len(track.position), -np.inf)
    if joint.low is not None:
        over = np.maximum(over, joint.low - track.position)
    if joint.high is not None:
        over = np.maximum(over, track.position - joint.high)
    return over


@dataclass
class CheckDrives(Check):
    """A drive does not end at the end of its strength: it reaches what it is set to, or would with time.

    One that is meant to saturate may; that its effort is what its law says, the books still ask.
    """

    share: float = 0.98  # of its greatest effort counts as all of it

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each drive whose effort is bounded and recorded: its share of frames at full effort."""
        found = []
        for joint in evidence.world.joints:
            effort = evidence.recording.scalars.get("drive" + joint.prim.removeprefix("/World"))
            if joint.drive is None or joint.drive.max_effort is None or joint.drive.saturates or effort is None:
                continue
            full = np.abs(effort[evidence.window]) >= self.share * joint.drive.max_effort
            value = float(full.mean())
            found.append(
                self.measured(
                    f"{joint.prim}: its drive is at its full {joint.drive.max_effort:g} at {value:.0%} of the end",
                    value, 0.5, "share of frames", prim=joint.prim, time=evidence.window_start,
                    limit_from="half of the final window: a drive that gets where it is to go no longer strains",
                )
            )  # fmt: skip
        return found

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """A drive at its full strength is to be stronger."""
        joint = next(joint for joint in evidence.world.joints if joint.prim == finding.prim)
        assert joint.drive is not None
        return stronger(joint, joint.drive)


@dataclass
class CheckBreakage(Check):
    """A joint that may break does so under the load that it is to break at, and under no less.

    Where its load is not recorded, it is what the motion of all that it holds tells, as the mean of each interval. It
    then broke in one of the few intervals (`Load.before`) before its anchors are seen apart, in which the load went on
    to rise as it did from the mean of one interval to that of the next, for one and a half of them: by so much it may
    miss.
    """

    share: float = 0.01  # of its strength

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each joint that may break and whose loads are recorded or told by motion."""
        found = []
        for joint in evidence.world.joints:
            name = joint.prim.removeprefix("/World")
            scalars = evidence.recording.scalars
            if not joint.may_break:
                continue
            if "broken" + name not in scalars:
                found += self._told(evidence, joint)
                continue
            borne = [scalars[kind + name] for kind in ("force", "torque")]
            limits = [np.inf if limit is None else limit for limit in (joint.break_force, joint.break_torque)]
            share = np.max([np.nan_to_num(load) / limit for load, limit in zip(borne, limits, strict=True)], axis=0)
            gone = broken(evidence, joint)
            found.append(self._borne(evidence, joint, share, gone))
        return found

    def _told(self, evidence: Evidence, joint: Joint) -> list[Finding]:
        load, gone = load_of(evidence, joint), broken(evidence, joint)
        if load is None or len(gone) < 2:
            return []
        end = int(np.argmax(gone)) if gone.any() else len(gone) - 1
        share, known = load.share(joint), load.known[:end]
        held = np.where(known, share[:end], 0.0)
        at = int(np.argmax(held)) if end else 0
        found = held.max(initial=0.0) - 1.0, f"bears {held.max(initial=0.0):.4g}"
        before = load.before(gone)
        if before is not None and not released(evidence, joint):
            last = before.start + int(np.argmax(share[before]))
            rises = 1.5 * np.abs(np.diff(share[max(last - 2, 0) : last + 1])).max(initial=0.0)
            early = 1.0 - share[last] - rises
            if early > found[0]:
                at, found = last, (early, f"breaks at {share[last]:.4g}, and no more than {share[last] + rises:.4g},")
        return [
            self.measured(
                f"{joint.prim} {found[1]} of its strength", max(found[0], 0.0), self.share, "of its strength",
                fine=f"{joint.prim} bears at most {held.max(initial=0.0):.4g} of its strength", prim=joint.prim,
                time=float(evidence.time[at]), expected=0.0,
                limit_from=f"{self.share:g} of its strength; its load is what all that it holds was accelerated by",
                target=RepairTarget(kind="joint", prim=joint.prim, parameter="break_force", direction="change"),
            )
        ]  # fmt: skip

    def _borne(self, evidence: Evidence, joint: Joint, share: Floats, gone: NDArray[np.bool_]) -> Finding:
        at = int(np.argmax(gone)) if gone.any() else int(np.argmax(share))
        held = share[:at].max(initial=0.0) if gone.any() else float(share[at])
        early = bool(gone.any()) and 1.0 - share[at] > held - 1.0 and not released(evidence, joint)
        what = f"breaks at {share[at]:.4g}" if early else f"bears {held:.4g}"
        fine = f"breaks at {share[at]:.4g}" if gone.any() else f"bears at most {held:.4g}"
        return self.measured(
            f"{joint.prim} {what} of its strength",
            max(float(1.0 - share[at]) if early else float(held) - 1.0, 0.0), self.share, "of its strength",
            fine=f"{joint.prim} {fine} of its strength", prim=joint.prim, time=float(evidence.time[at]), expected=0.0,
            limit_from=f"{self.share:g} of its strength, for single precision and the iterations of a solver",
            target=RepairTarget(kind="joint", prim=joint.prim, parameter="break_force", direction="change"),
        )  # fmt: skip


@dataclass
class CheckGears(Check):
    """A gear has no play: its second joint goes as far as its ratio says."""

    share: float = 0.02  # of the smallest extent of what a slider moves
    lean: float = 0.02  # [rad]
    ratio: float = 0.02  # of how far the second joint should go, and a twentieth of the above: less of what goes less

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each gear whose joints can be followed from frame to frame."""
        joints = {joint.prim: joint for joint in evidence.world.joints}
        found = []
        for gear in evidence.world.gears:
            ends = [joints.get(prim) for prim in (gear.first, gear.second)]
            tracks = [None if joint is None else evidence.joint(joint) for joint in ends]
            if any(track is None or not _followed(joint, track) for joint, track in zip(ends, tracks, strict=True)):
                continue
            first, second = (track.position for track in tracks if track is not None)
            error = np.abs(second - gear.offset - gear.ratio * first)
            turns = ends[1] is not None and ends[1].kind == "revolute"
            child = "" if ends[1] is None else ends[1].child
            most = self.lean if turns else self.share * evidence.solid(evidence.index(child)).smallest
            limit = min(most, self.ratio * float(np.ptp(gear.ratio * first)) + most / 20.0)
            at = int(np.argmax(error))
            unit = "rad" if turns else "m"
            found.append(
                self.measured(
                    f"{gear.prim}: its joints are {float(error[at]):.3g} {unit} out of mesh",
                    float(error[at]), limit, unit, fine=f"{gear.prim} meshes", prim=gear.prim, expected=0.0,
                    time=float(evidence.time[at]),
                    limit_from=(f"{self.lean:g} rad" if turns else f"{self.share:g} of {child}'s smallest extent")
                    + f", or {self.ratio:g} of how far it goes",
                    target=RepairTarget(kind="joint", prim=gear.prim, parameter="ratio", direction="change"),
                )
            )  # fmt: skip
        return found


def _followed(joint: Joint | None, track: JointTrack) -> bool:
    """Whether a joint turns by so little between frames that its whole turns can be counted."""
    return joint is not None and (joint.kind != "revolute" or np.abs(np.diff(track.position)).max(initial=0.0) < 2.5)


CHECKS: Checks = (CheckJoints, CheckJointLimits, CheckDrives, CheckBreakage, CheckGears)
