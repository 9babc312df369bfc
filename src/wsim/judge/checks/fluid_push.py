"""What a fluid is said to have given a body is what its particles give it, by the method's own sum over pairs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import stdtrit

from wsim.judge.books.fluid_push import FluidPush
from wsim.judge.books.fluids import fluid_impulse
from wsim.judge.books.sph import Method
from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Span:
    """What is off over some intervals on end, along one axis."""

    rows: Rows
    axis: int
    off: float  # mean force that is said to act less the one that the particles give [N]
    limit: float  # [N]


@dataclass
class CheckFluidPush(Check):
    """The mean force that a fluid gives a body, over any stretch of time, is the one that its particles give.

    Frames tell the force at moments, the recording its mean between them. Sound and splashes come in between, so that
    a single interval may be anything off; the mean of many is not, and how far it may be follows from how they scatter.

    Vessels and bodies that are led are left out: their faces stop water, too, which is no sum over pairs.
    `CheckFluidMomentum` holds what they get against what the water loses.
    """

    # That the mean of one stretch is farther off by chance, on one side: 4.5 standard errors of 22 pairs of intervals.
    chance: float = 1e-4  # (found in 45 worlds: up to 0.55 of the limit)
    share: float = 0.01  # of the force: single precision, and densities that are of one step before (found: 0.003)
    halvings: int = 3  # stretches: all intervals, and halves, quarters and eighths of them
    least: int = 12  # intervals of a stretch
    most: int = 240  # intervals that are looked at, of one body; fewer of many
    block: int = 30  # intervals on end, where not all are looked at

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body that a fluid touches."""
        impulse, fluids = fluid_impulse(evidence.recording), evidence.world.fluids
        # What is in the pipes of taps and drains pushes too, and is not recorded.
        if (
            evidence.world.taps
            or evidence.world.drains
            or impulse is None
            or not fluids
            or not evidence.world.bodies
            or not all(fluid.newtonian for fluid in fluids)  # how viscous it is where it yields is not recorded
            or (method := Method.of(evidence)) is None
        ):
            return []
        tracks = [evidence.track(fluid) for fluid in fluids]
        time = tracks[0].time
        frames = np.flatnonzero(np.isin(evidence.time, time))
        alike = all(np.array_equal(track.time, time) and track.density.size for track in tracks)
        if len(frames) < len(time) or len(time) <= self.least or not alike:
            return []
        gained = np.diff(np.cumsum(impulse.astype(np.float64), axis=0)[frames], axis=0)
        given = gained / np.diff(time)[:, None, None]
        push = FluidPush(evidence, method)
        pushed = [i for i, each in enumerate(push.filled) if each is not None and given[:, i].any()]
        bodies = [i for i in pushed if i not in push.vessels and not evidence.world.bodies[i].kinematic]
        if not bodies:
            return []
        rows = self._rows(len(given), len(bodies))
        wanted = np.unique(np.concatenate([rows, rows + 1]))
        forces = np.full((len(time), len(bodies), 3), math.nan)
        for k in wanted.tolist():
            forces[k] = push.at(k, int(frames[k]), bodies)
        felt = (forces[rows] + forces[rows + 1]) / 2.0
        return [
            finding
            for n, i in enumerate(bodies)
            if (finding := self._body(evidence, i, rows, given[rows, i], felt[:, n])) is not None
        ]

    def _rows(self, count: int, bodies: int) -> Rows:
        """The intervals that are looked at: all, or blocks of them that are spread over the time."""
        most = max(2 * self.block, self.most // bodies)
        if count <= most:
            return np.arange(count)
        starts = np.linspace(0, count - self.block, most // self.block).astype(int)
        return np.unique(starts[:, None] + np.arange(self.block))

    def _body(self, evidence: Evidence, i: int, rows: Rows, given: Floats, felt: Floats) -> Finding | None:
        wet = np.flatnonzero(given.any(axis=1) | felt.any(axis=1))
        if len(wet) < self.least:
            return None
        spans = self._spans(given[wet], felt[wet])
        span = max(spans, key=lambda each: abs(each.off) / max(each.limit, 1e-300))
        body, time = evidence.world.bodies[i], evidence.track(evidence.world.fluids[0]).time
        said, told = given[wet][span.rows].mean(axis=0), felt[wet][span.rows].mean(axis=0)
        start, end = float(time[rows[wet[span.rows[0]]]]), float(time[rows[wet[span.rows[-1]]] + 1])
        way = "xyz"[span.axis]
        return self.measured(
            f"The fluid is said to push {body.prim} with {said[span.axis]:.4g} N along {way}; its particles do with "
            f"{told[span.axis]:.4g} N, from {start:.3f} to {end:.3f} s",
            abs(span.off), span.limit, "N", prim=body.prim, time=end, span=(start, end), expected=0.0,
            fine=f"The fluid pushes {body.prim} as its particles do, to {abs(span.off):.3g} N along {way}",
            limit_from=f"what the mean of {len(span.rows)} intervals that scatter so may be off by chance, once in "
            f"{1.0 / self.chance:,.0f} times, and {self.share:g} of the force",
            target=RepairTarget(
                kind="program", prim=body.prim, direction="change",
                why="something pushes it in the fluid's name that no particle feels",
            ),
        )  # fmt: skip

    def _spans(self, given: Floats, felt: Floats) -> list[Span]:
        """Stretches of all lengths, each along each axis.

        What sound in the fluid leaves in one interval it takes back in the next, so that pairs of them scatter less.
        Pairs that follow each other share a frame: where its force is off by chance, by s, their means are by
        sqrt(3 / 8) s, and the mean of n of them by sqrt(1 / 2 n) s. How far that may go is Student's t, as the scatter
        is known from the pairs themselves.
        """
        off, found = given - felt, []
        for halving in range(self.halvings + 1):
            for part in np.array_split(np.arange(len(off)), 2**halving):
                count = len(part) // 2
                if len(part) < self.least:
                    continue
                rows = part[len(part) - 2 * count :]
                pairs = off[rows].reshape(count, 2, 3).mean(axis=1)
                error = pairs.std(axis=0, ddof=1) * math.sqrt(4.0 / 3.0 / count)
                errors = float(stdtrit(count - 1, 1.0 - self.chance))
                force = float(np.linalg.norm(felt[rows], axis=1).mean())
                for axis in range(3):
                    limit = errors * float(error[axis]) + self.share * force
                    found.append(Span(rows, axis, float(pairs[:, axis].mean()), limit))
        return found


CHECKS: Checks = (CheckFluidPush,)
