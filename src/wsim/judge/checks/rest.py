"""Checks of what is at rest: carried by its weight, not trembling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.checks.check import Check, Checks, worst
from wsim.judge.evidence.motion import FLOAT32, OURS
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]

ORDERS = (2, 4, 6)  # of the differences that show what alternates


@dataclass
class CheckRestForce(Check):
    """Contact forces on a body at rest add up to its weight, less what fluid and control carry."""

    share: float = 0.1  # of its weight
    still: float = 0.02  # of sqrt(g L), L its smallest extent: slower is at rest

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The body at rest whose contact forces are farthest from that, over the final window."""
        motion, recording = evidence.motion, evidence.recording
        wet = bool(evidence.world.fluids or recording.metadata.get("controlled")) and recording.applied_impulse is None
        told = np.any(recording.contact_force) or OURS in recording.metadata
        if wet or not told or evidence.gravity <= 0.0 or int(evidence.window.sum()) < 2:
            return []
        span = float(evidence.time[-1] - evidence.time[evidence.window][0])
        force = np.asarray(recording.contact_force[evidence.window], dtype=np.float64).mean(axis=0)
        if recording.applied_impulse is not None:
            force += np.asarray(recording.applied_impulse[evidence.window][1:], dtype=np.float64).sum(axis=0) / span
        gained = motion.mass[:, None] * (motion.v[-1] - motion.v[evidence.window][0]) / span
        lacking = force + motion.mass[:, None] * motion.gravity - gained
        # A contact that flips from step to step is seen in one phase of it at every frame: the velocity that the places
        # do not show then is the impulse that the force is off by, in each step.
        shown = (motion.com[-1] - motion.com[evidence.window][0]) / span
        flips = 2.0 * np.linalg.norm(motion.v[evidence.window].mean(axis=0) - shown, axis=1)
        hidden = motion.mass * flips / motion.dt
        rows = [int(i) for i in np.flatnonzero(~motion.jointed & ~motion.kinematic) if self._rests(evidence, int(i))]
        margin = self.share * motion.mass * evidence.gravity + hidden - lengths(lacking)
        if rows and np.all(margin[rows] > 0.0):  # one is told of, as they are many
            rows = [rows[int(np.argmin(margin[rows]))]]
        return worst([self._finding(evidence, i, lacking[i], force[i], float(hidden[i])) for i in rows])

    def _rests(self, evidence: Evidence, i: int) -> bool:
        limit = self.still * evidence.velocity_scale(evidence.solid(i).smallest)
        here = evidence.window
        touched = evidence.motion.touched[here, i]
        # What is at rest is carried by something: no force at all is none that was seen in another phase.
        carried = bool(touched.all()) or (OURS in evidence.recording.metadata and not touched.any())
        return carried and float(evidence.motion.speed[here, i].max()) < limit

    def _finding(self, evidence: Evidence, i: int, lacking: Floats, force: Floats, hidden: float) -> Finding:
        body = evidence.world.bodies[i]
        weight = body.mass * evidence.gravity
        value = float(np.linalg.norm(lacking))
        shown = float(-force @ evidence.motion.gravity / evidence.gravity**2)
        target = RepairTarget(
            kind="physical parameter", prim=body.prim, parameter="mass", direction="change", suggested=shown, unit="kg",
            why="the forces on it are those of another mass",
        )  # fmt: skip
        return self.measured(
            f"{body.prim} rests, and {value:.3g} N are missing from the {weight:.4g} N that carry it",
            value, self.share * weight + hidden, "N", fine="Contacts carry the weight of what rests", prim=body.prim,
            time=evidence.window_start, expected=0.0,
            limit_from=f"{self.share:g} of its weight, a mean over the final window, and what flips from step to step",
            target=target,
        )  # fmt: skip


@dataclass
class CheckJitter(Check):
    """A body that stays where it is does not tremble: its velocity does not flip from frame to frame, on and on."""

    parts: int = 4  # of the window, in the calmest of which it still trembles: a bounce dies away
    contact: float = 0.9  # of the frames, in which what does not bounce is in contact
    steps: float = 2.0  # of gravity in a time step, which is what a contact may be late by

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The body that trembles most over the final window."""
        motion = evidence.motion
        here = np.flatnonzero(evidence.window)
        loose = np.flatnonzero(~motion.jointed & ~motion.kinematic)
        if len(here) < 4 * self.parts or not len(loose):
            return []
        h = motion.h[here[:-1]]
        if CheckJitter not in evidence.kept:
            evidence.kept[CheckJitter] = self._tremble(evidence)
        tremble = cast("Floats", evidence.kept[CheckJitter])[loose]
        size = np.array([evidence.solid(int(i)).smallest for i in loose])
        stays = np.linalg.norm(motion.com[here[-1]][loose] - motion.com[here[0]][loose], axis=1) < size
        touched = motion.touched[here][:, loose].mean(axis=0)
        told = OURS in evidence.recording.metadata  # of a table that tells of no contact what touches none may touch
        bounces = (touched < self.contact) & (told | (touched > 0.0))  # it is in the air between
        tremble = np.where(stays & ~bounces, tremble, 0.0)
        rounding = 4.0 * FLOAT32 * np.abs(motion.com[here][:, loose]).max(axis=(0, 2)) / float(h.min())
        limit = self.steps * max(evidence.gravity, 1.0) * motion.dt + rounding
        n = int(np.argmax(tremble / limit))
        body = evidence.world.bodies[loose[n]]
        target = RepairTarget(
            kind="time step", prim=body.prim, parameter="time_step", direction="lower", why="its contacts chatter"
        )
        return [
            self.measured(
                f"{body.prim} trembles by {tremble[n]:.3g} m/s from frame to frame at the end",
                float(tremble[n]), float(limit[n]), "m/s", fine="Nothing trembles at the end", prim=body.prim,
                time=evidence.window_start, span=(evidence.window_start, float(evidence.time[-1])), expected=0.0,
                limit_from=f"{self.steps:g} g dt, dt = {motion.dt * 1e3:.3g} ms: a contact is late by a step at most",
                target=target,
            )
        ]  # fmt: skip

    def prepare(self, joined: Evidence, copies: Sequence[Evidence]) -> None:
        """How all copies' bodies tremble."""
        if int(joined.window.sum()) >= 4 * self.parts:
            for evidence, tremble in zip(copies, self._tremble(joined), strict=True):
                evidence.kept[CheckJitter] = tremble

    def _tremble(self, evidence: Evidence) -> Floats:
        """By how much bodies alternate in the calmest part of the window, (B,) [m/s]."""
        motion, here = evidence.motion, np.flatnonzero(evidence.window)
        moved = np.diff(motion.com[..., here, :, :], axis=-3) / motion.h[here[:-1]][:, None, None]
        parts = (np.array_split(rates, self.parts, axis=-3) for rates in (moved, motion.v[..., here, :, :]))
        flips = [np.maximum(_flips(places), _flips(rates)) for places, rates in zip(*parts, strict=True)]
        return np.asarray(np.min(flips, axis=0))


def _flips(rate: Floats) -> Floats:
    """How far rates (..., n, B, 3) alternate from frame to frame, (..., B).

    A difference of order p, over 2^p, leaves what alternates as it is, and of what swings once in N frames the share
    sin(pi / N)^p: of a marble that swings once in six frames a quarter by the second order, and 1.6 % by the sixth. The
    median of a low order is blind to single hits, which a high one spreads out: what trembles does so by all of them.
    """
    found = [
        np.median(lengths(np.diff(rate, order, axis=-3)) / 2.0**order, axis=-2)
        for order in ORDERS
        if order < rate.shape[-3]
    ]
    amplitude: Floats = np.min(found, axis=0)
    return amplitude


CHECKS: Checks = (CheckRestForce, CheckJitter)
