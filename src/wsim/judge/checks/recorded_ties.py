"""What a recording says that joints, springs and ropes gave: each passes on what it can, and its law gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.driven import resting
from wsim.judge.books.recorded_ties import OWN, RecordedTies
from wsim.judge.books.ties import NEAR_STOP
from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]

SAYS = {
    "passes": "Joints pass on nothing along their own motion but what drives, friction, stops and gears give",
    "places": "The recorded impulses of joints act at their anchors",
    "drive": "Drives give what their laws do",
    "cap": "Drives give no more than they can",
    "friction": "Joints rub as their dry friction has it",
    "stop": "Stops push, and only where a joint is near them",
    "way": "Springs and ropes pull along their ways",
    "spring": "Springs pull as their laws have it",
    "rope": "Ropes pull where they are taut, and never push",
}


@dataclass(frozen=True)
class Asked:
    """One question of one joint or cord: how far it is off in each interval, and may be, (T - 1,) each."""

    kind: str  # of `SAYS`
    prim: str
    body: str
    what: str  # it does, as a message says it
    off: Floats
    limit: Floats
    unit: str


@dataclass
class CheckRecordedTies(Check):
    """Where it is recorded what joints, springs and ropes give, each gives what it can, and what its law says."""

    exact: float = 1e-3  # of what is passed on: the solver's tolerance, and single precision
    place: float = 0.01  # of an impulse's moment, beside how far its arm turns
    law: float = 0.01  # of what a law gives

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each kind of question, of the joint or the cord that is farthest off by its limit."""
        track = evidence.recording.ties
        if track is None or len(evidence.time) < 2:
            return []
        worst: dict[str, tuple[float, Asked, int]] = {}
        for asked in self._asked(evidence, RecordedTies(evidence, track)):
            ratio = asked.off / np.maximum(asked.limit, 1e-30)
            k = int(np.argmax(ratio))
            if ratio[k] > worst.get(asked.kind, (-1.0,))[0]:
                worst[asked.kind] = float(ratio[k]), asked, k
        return [self._finding(evidence, asked, k) for _, asked, k in worst.values()]

    def _finding(self, evidence: Evidence, asked: Asked, k: int) -> Finding:
        h = float(evidence.motion.h[k])
        start, end = float(evidence.time[k]), float(evidence.time[k + 1])
        value, limit = float(asked.off[k]) / h, float(asked.limit[k]) / h
        return self.measured(
            f"{asked.prim} {asked.what}, by {value:.3g} {asked.unit}, from {start:.3f} to {end:.3f} s",
            value, limit, asked.unit, prim=asked.body, line=evidence.line(asked.prim), time=end, span=(start, end),
            expected=0.0, fine=SAYS[asked.kind],
            limit_from=f"{self.exact:g} of what it passes on, {self.law:g} of what a law gives, and what frames do not "
            "tell of an arm that turns and a force that changes",
            target=RepairTarget(kind="joint", prim=asked.prim, why="it gives what the stated one does not"),
        )  # fmt: skip

    def _asked(self, evidence: Evidence, ties: RecordedTies) -> Iterator[Asked]:
        controlled = bool(evidence.recording.metadata.get("controlled"))
        for k, joint in enumerate(ties.joints):
            if ties.effective(joint):
                yield from self._of_joint(evidence, ties, k, joint, controlled)
        for k, (cord, row) in enumerate(ties.ends):
            yield from self._of_cord(evidence, ties, k, cord, evidence.world.bodies[row].prim)

    # ---- joints
    def _of_joint(
        self, evidence: Evidence, ties: RecordedTies, k: int, joint: Joint, controlled: bool
    ) -> Iterator[Asked]:
        motion, row = evidence.motion, ties.pairs[k][1]
        h, weight = motion.h, float(motion.mass[row]) * max(evidence.gravity, 1.0)
        turns = joint.kind != "prismatic"
        unit, least = ("N m", weight * float(motion.radius[row]) * h) if turns else ("N", weight * h)
        off, reach = ties.misplaced(k)
        size = np.linalg.norm(ties.track.impulse[1:, k].astype(np.float64), axis=1) * float(motion.radius[row])
        slack = self.place * (weight * float(motion.radius[row]) * h + size + reach) + reach
        yield Asked("places", joint.prim, joint.child, "acts beside its anchor", off, slack, "N m")
        moves = joint.kind in OWN
        loose = joint.kind == "spherical" and joint.friction == 0.0 and joint.drive is None and joint.high is None
        if not moves and not loose:
            return
        off, efforts = ties.along(k)
        passed = self.exact * (least + efforts + (size if turns else 0.0))
        yield Asked(
            "passes", joint.prim, joint.child, "passes on what nothing along its motion gives", off, passed, unit
        )
        if not moves:
            return
        yield from self._driven(ties, k, joint, least, unit, controlled)
        yield from self._rubbed(ties, k, joint, least, unit, h)
        stop, away = ties.track.stop[1:, k].astype(np.float64), ties.pushed_off(k, NEAR_STOP)
        wrong = np.where(away == 3.0, np.abs(stop), np.where(away == 1.0, stop, np.where(away == 2.0, -stop, 0.0)))
        yield Asked(
            "stop", joint.prim, joint.child, "is pushed by a stop that is not there", wrong, self.exact * least, unit
        )

    def _driven(
        self, ties: RecordedTies, k: int, joint: Joint, least: Floats, unit: str, controlled: bool
    ) -> Iterator[Asked]:
        drive, h = joint.drive, ties.intervals
        given = ties.track.drive[1:, k].astype(np.float64) - ties.laws.aims(joint).effort * h
        if drive is None:
            what = "is driven, and has no drive"
            if ties.laws.aims(joint).effort.any():
                what = "is pushed otherwise than by its schedule"
            if not controlled:
                yield Asked("drive", joint.prim, joint.child, what, np.abs(given),
                            self.exact * least, unit)  # fmt: skip
            return
        if drive.max_effort is not None and not controlled:
            over = np.abs(given) - drive.max_effort * h
            yield Asked("cap", joint.prim, joint.child, "is driven by more than its drive can give", over,
                        self.exact * (least + drive.max_effort * h), unit)  # fmt: skip
        stated = ties.drive(k)
        if stated is not None:
            off = np.where(stated.known, np.abs(given - stated.mean * h), 0.0)
            most = float(np.abs(stated.mean).max(initial=0.0))
            limit = self.exact * (least + most * h) + (self.law * np.abs(stated.mean) + stated.unsure) * h
            yield Asked(
                "drive", joint.prim, joint.child, "is driven otherwise than by its drive's law", off, limit, unit
            )
            held, unsure = resting(ties, k)
            rests = ~stated.known & np.isfinite(unsure)
            off = np.where(rests, np.abs(given - held * h), 0.0)
            limit = self.exact * least + (self.law * np.abs(held) + np.where(rests, unsure, 0.0)) * h
            yield Asked("drive", joint.prim, joint.child, "is held otherwise than by its drive's law", off, limit, unit)

    def _rubbed(self, ties: RecordedTies, k: int, joint: Joint, least: Floats, unit: str, h: Floats) -> Iterator[Asked]:
        given, limit = ties.track.friction[1:, k].astype(np.float64), self.exact * (least + joint.friction * h)
        off, what = np.abs(given) - joint.friction * h, "rubs more than its dry friction is"
        if joint.friction > 0.0:
            way, lasts, back = ties.rubs(k)
            lacks = np.abs(given + way * joint.friction * h) - 2.0 * back * joint.friction * h
            off = np.maximum(off, np.where(lasts, lacks, 0.0))
            limit, what = limit + self.law * joint.friction * h, "rubs otherwise than its dry friction does"
        yield Asked("friction", joint.prim, joint.child, what, off, limit, unit)

    # ---- cords
    def _of_cord(self, evidence: Evidence, ties: RecordedTies, k: int, cord: int, body: str) -> Iterator[Asked]:
        each, springs = evidence.world.cords[cord], evidence.world.springs
        weight = float(evidence.motion.mass[ties.ends[k][1]]) * max(evidence.gravity, 1.0) * ties.intervals
        tension = ties.track.tension[1:, k].astype(np.float64)
        if not evidence.motion.kinematic[ties.ends[k][1]]:
            off, may, size = ties.cord(k)
            yield Asked(
                "way",
                each.prim,
                body,
                "pulls beside its way",
                off,
                may + self.place * (size + self.exact * weight),
                "N",
            )
        if cord < len(springs):
            stated = ties.spring(cord)
            off = np.where(stated.known, np.abs(tension - stated.mean * ties.intervals), 0.0)
            limit = (self.law * np.abs(stated.mean) + stated.unsure) * ties.intervals + self.exact * weight
            yield Asked("spring", each.prim, body, "pulls otherwise than by its law", off, limit, "N")
            return
        wrong = np.where(ties.slack(cord), np.abs(tension), -tension)
        yield Asked("rope", each.prim, body, "pushes, or pulls where it is slack", wrong, self.exact * weight, "N")


CHECKS: Checks = (CheckRecordedTies,)
