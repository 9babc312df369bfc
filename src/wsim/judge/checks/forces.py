"""The books: every motion has forces behind it that the world can exert."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.balance import Books, rounding, unseen
from wsim.judge.books.copies import lasting, told
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]
    Worst = tuple[float, int, int, int, Floats, float]  # by its limit; intervals; the first; body; mean; limit


# Of gravity, by the number of intervals that it is the mean of: what lasts is told from what comes and goes. Twice
# what sound runs of all mechanisms leave at most beyond the error of their arms, or more: 0.007, 0.0017, 0.0015, 0.0007
# and 0.0005.
SHARES = {1: 0.02, 4: 0.005, 8: 0.003, 16: 0.0015, 32: 0.001}
ROOM = 500_000  # bodies times intervals of which means are taken at once


@dataclass
class CheckForces(Check):
    """What changes the momentum of a body is gravity, what is known to push it, and what touches or holds it."""

    blow: float = 0.03  # of the change of velocity in an interval: where a body turns while it is hit is not known

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The force and the torque that nothing in the world gives, where they are largest by their limits."""
        motion = evidence.motion
        if not told(evidence):
            return []
        books, unknown = Books.of(evidence), unseen(evidence)
        if not books.judged.any():
            return []
        if CheckForces not in evidence.kept:
            self.prepare_similar([evidence])
        force, torque = cast("tuple[Worst, Worst]", evidence.kept[CheckForces])
        found = [self._missing(evidence, force, motion.mass, "N")]
        if not unknown.all():
            found.append(self._missing(evidence, torque, motion.mass * books.size, "N m"))
        return found + self._over_many(evidence, books)

    def prepare_similar(self, copies: Sequence[Evidence]) -> None:
        """What is missing most of forces and of torques, of as many copies at once as take little room."""
        if not told(copies[0]):
            return
        most = max(1, ROOM // max(Books.of(copies[0]).blow.size, 1))
        for first in range(0, len(copies), most):
            some = copies[first : first + most]
            for evidence, *each in zip(some, *self._most(some), strict=True):
                evidence.kept[CheckForces] = each

    def _most(self, copies: Sequence[Evidence]) -> tuple[list[Worst], list[Worst]]:
        """Of W copies."""
        every, h = [Books.of(evidence) for evidence in copies], copies[0].motion.h[:, None]
        slack = np.stack([
            np.where(books.hit, self.blow * books.blow / h, 0.0) + rounding(evidence)
            for evidence, books in zip(copies, every, strict=True)
        ])  # fmt: skip
        turned, judged = (np.stack([getattr(books, name) for books in every]) for name in ("turned", "judged"))
        unknown = np.stack([unseen(evidence) for evidence in copies])[:, None, :, None]
        force, torque = (np.stack([getattr(books, name) for books in every]) for name in ("force", "torque"))
        least, pull = np.stack([_pushed(evidence) for evidence in copies]), max(copies[0].gravity, 1.0)
        return (
            _worst(np.where(judged[..., None], force, 0.0), slack + turned[..., 0], least, pull),
            _worst(np.where(judged[..., None] & ~unknown, torque, 0.0), slack + turned[..., 1], least, pull),
        )

    def _over_many(self, evidence: Evidence, books: Books) -> list[Finding]:
        """The body that lacks most to creep, stand or go on as it does; none where none lacks more than its limit."""
        share = SHARES[8]
        least = np.maximum(share, _pushed(evidence)) * max(evidence.gravity, 1.0)
        limits = least + rounding(evidence) + books.turned[..., 0]
        found = [
            (float(np.linalg.norm(each.force)), float(limits[each.first : each.last, each.row].mean()), each)
            for each in lasting(evidence)
        ]
        size, limit, worst = max(found, key=lambda each: each[0] / each[1], default=(0.0, 0.0, None))
        if worst is None or size <= limit:
            return []
        body, mass = evidence.world.bodies[worst.row], float(evidence.motion.mass[worst.row])
        span = float(evidence.time[worst.first]), float(evidence.time[worst.last])
        far = float(np.linalg.norm(worst.drift))
        if far > 0.0:
            way = listed(tuple((worst.drift / far).round(2)))
            story = f"creeps by {far * 1e3:.3g} mm towards {way} over what it touches, against friction, by"
        else:
            story = "stands where it is, or goes on, with all that may carry it too far away, by"
        return [
            self.measured(
                f"{body.prim} {story} {size * mass:.3g} N that nothing in the world gives, from {span[0]:.3f} to "
                f"{span[1]:.3f} s",
                size * mass, limit * mass, "N", prim=body.prim, time=span[1], span=span, expected=0.0,
                limit_from=f"{share:g} of gravity, and how far bodies turn between two frames",
                target=RepairTarget(kind="program", prim=body.prim, why="it would fall, or friction would hold it"),
            )
        ]  # fmt: skip

    def _missing(self, evidence: Evidence, worst: Worst, weight: Floats, unit: str) -> Finding:
        """Where it is most by its limit."""
        least = _pushed(evidence)
        _, n, k, i, mean, limit = worst
        share = max(SHARES[n], float(least[k, 0]))
        prim, start, end = evidence.world.bodies[i].prim, float(evidence.time[k]), float(evidence.time[k + n])
        size = float(np.linalg.norm(mean))
        way = listed(tuple((mean / max(size, 1e-300)).round(2)))
        value, most = float(size * weight[i]), float(limit * weight[i])
        kind, verb = ("force", "pushed") if unit == "N" else ("torque", "turned")
        of_it = f", {size / evidence.gravity:.2g} of its weight" if unit == "N" and evidence.gravity else ""
        return self.measured(
            f"{prim} is {verb} by {value:.3g} {unit}{of_it}, towards {way}, that nothing in the world gives, "
            f"from {start:.3f} to {end:.3f} s",
            value, most, unit, prim=prim, time=end, span=(start, end), expected=0.0,
            fine=f"Every {kind} on every body has something in the world that gives it",
            limit_from=f"{share:g} of gravity as a mean of {n} intervals, {self.blow:g} of the change of velocity in a "
            "blow, and how far bodies turn between two frames",
            target=RepairTarget(kind="program", prim=prim, why=f"a {kind} acts on it that the world does not have"),
        )  # fmt: skip


def _pushed(evidence: Evidence) -> Floats:
    """Of gravity: what is not known of the many small pushes that fluid and control give, (T - 1, 1).

    They are sums in single precision, which contacts and joints pass on.
    """
    given = evidence.recording.applied_impulse
    if given is None:
        return np.zeros((len(evidence.motion.h), 1))
    return np.where(np.any(given[1:] != 0.0, axis=(1, 2)), SHARES[1], 0.0)[:, None]


def _worst(left: Floats, slack: Floats, least: Floats, pull: float) -> list[Worst]:
    """Where it is most by its limit: over one interval, or if none fails in the mean of several.

    Args:
        left: What nothing gives, (W, T - 1, B, 3) [m/s^2].
        slack: What may be missing beside a share of gravity, (W, T - 1, B).
        least: That share at least, (W, T - 1, 1).
        pull: Gravity [m/s^2].
    """
    found: list[Worst] = [(-1.0, 1, 0, 0, np.zeros(3), 0.0) for _ in left]
    for n, share in SHARES.items():
        some = np.array([w for w, worst in enumerate(found) if worst[0] <= 1.0], dtype=np.intp)
        if n > left.shape[1] or not len(some):
            break
        means = _mean(left[some], n)
        limits = pull * _mean(np.maximum(share, least[some]), n) + _mean(slack[some], n)
        ratio = lengths(means) / limits
        ratio[np.isnan(ratio)] = np.inf  # what is no number is the worst
        for of, (w, at) in enumerate(zip(some, np.argmax(ratio.reshape(len(some), -1), axis=1), strict=True)):
            k, i = divmod(int(at), ratio.shape[2])
            if ratio[of, k, i] > found[w][0]:
                found[w] = float(ratio[of, k, i]), n, k, i, means[of, k, i], float(limits[of, k, i])
    return found


def _mean(values: Floats, n: int) -> Floats:
    """Of each n intervals that follow one another, of each copy."""
    sums = np.cumsum(values, axis=1)
    sums = np.concatenate([np.zeros_like(sums[:, :1]), sums], axis=1)
    found: Floats = (sums[:, n:] - sums[:, :-n]) / n
    return found


CHECKS: Checks = (CheckForces,)
