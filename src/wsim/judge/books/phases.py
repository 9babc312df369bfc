"""What a frame's phase hides of energy: where in its step it is seen, and what contacts do from step to step.

Steps of the first order, v' = v + a h and x' = x + v' h, do not keep E but E - t dV/dt with t = h / 2, V what gravity
and springs hold (Hairer, Lubich and Wanner, Geometric Numerical Integration, 2006, IX.3: the modified energy of the
symplectic Euler method); those of the second order keep E, t = 0. A frame says nothing of which it was; but whatever t
is, what is led to and fro comes back to the same dV/dt, so that a gain that lasts is one for every t.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.evidence.cords import spring_power
from wsim.judge.evidence.motion import FLOAT32, OURS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

COARSEST = 0.005  # [s] that a step of the first order takes at most
ROUNDS = 16  # of the search for t, each of which leaves 0.618 of where it may be
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Account:
    """What n mechanisms have, less what they were given, (T, n) each."""

    energy: Floats  # [J]
    sinks: Floats  # how fast it gives away what gravity and springs hold [W]
    phase: Floats  # what a frame's phase hides [J]
    held: Floats  # what contacts may hold [J]
    meets: NDArray[np.bool_] | None = None  # where it meets others, and what it gains is left out, (T - 1, n)
    gave: Floats | None = None  # what contacts may give back after it met others, (T - 2, n) [J]

    @staticmethod
    def join(parts: Sequence[Account]) -> Account:
        """The mechanisms of several, over the same times."""
        names = [each.name for each in fields(Account) if getattr(parts[0], each.name) is not None]
        return Account(**{name: np.concatenate([getattr(part, name) for part in parts], axis=1) for name in names})

    def balance(self, late: Floats) -> Floats:
        """What each has by the phase of its steps (n,) [s], (T, n) [J]."""
        whole: Floats = self.energy + late * self.sinks
        if self.meets is None or self.gave is None:
            return whole
        gained = np.where(self.meets, 0.0, np.diff(whole, axis=0))
        gained[1:] -= self.gave
        return np.concatenate([np.zeros((1, gained.shape[1])), np.cumsum(gained, axis=0)])

    def gains(self, late: Floats) -> Floats:
        """The most that it rises over its least, (n,) [J]."""
        return np.asarray(np.max(risen(self.balance(late), self.phase, self.held), axis=0))


def risen(balance: Floats, phase: Floats, held: Floats) -> Floats:
    """How far a balance has risen over its least, less what a phase hides at both ends and contacts held before."""
    found: Floats = balance - phase - np.minimum.accumulate(balance + phase + held, axis=0)
    return found


def least_of(accounts: Sequence[Account], latest: Sequence[float]) -> list[Floats]:
    """The t of each mechanism of some accounts, over the same times, at which it gains least, at most its latest."""
    found = [np.zeros(account.energy.shape[1]) for account in accounts]
    for kind in (True, False):
        some = [n for n, account in enumerate(accounts) if (account.meets is None) == kind]
        if some:
            whole = Account.join([accounts[n] for n in some])
            counts = [len(found[n]) for n in some]
            most = np.repeat([latest[n] for n in some], counts)
            late, _ = least(whole.gains, len(most), most)
            for n, each in zip(some, np.split(late, np.cumsum(counts)[:-1]), strict=True):
                found[n] = each
    return found


def latest(evidence: Evidence) -> float:
    """The greatest t: half a time step [s]."""
    return 0.5 * min(evidence.motion.dt, COARSEST)


def sinking(evidence: Evidence) -> Floats:
    """How fast each body gives away what gravity and springs hold, -dV/dt, (T, B) [W]."""
    found: Floats = falling(evidence) + spring_power(evidence)
    return found


def falling(evidence: Evidence) -> Floats:
    """How fast each body gives away what gravity holds, (T, B) [W]."""
    motion = evidence.motion
    found: Floats = motion.mass * (motion.v @ motion.gravity)
    return found


def turned_over(evidence: Evidence, falls: Floats) -> Floats:
    """What mechanisms gain where steps change from one order to the other once, (n,) [J], of their falling (T, n).

    As those of the simulator do at a start; what it does again and again adds up, and is a gain. None where a
    recording does not say that steps are of both orders.
    """
    orders = evidence.recording.metadata.get(OURS) == 2
    return np.asarray(np.abs(falls).max(axis=0) * latest(evidence) * orders)


def least(gain: Callable[[Floats], Floats], count: int, most: float | Floats) -> tuple[Floats, Floats]:
    """The t from 0 to `most` at which some mechanisms gain least, and that gain, (count,) each [s], [J].

    A gain between any two frames is linear in t, so that the greatest of them is convex: the search is by the golden
    section, for all mechanisms at once.

    Args:
        gain: The greatest gain of each mechanism [J], by its t.
        count: How many mechanisms there are.
        most: [s], of all or of each.
    """
    low, high = np.zeros(count), np.full(count, most)
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    tried = [np.zeros(count), np.full(count, most), left, right]
    found = [gain(t) for t in tried]
    at_left, at_right = found[2:]
    for _ in range(ROUNDS):
        lower = at_left <= at_right
        high, low = np.where(lower, right, high), np.where(lower, low, left)
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        new = np.where(lower, left, right)
        at_new = gain(new)
        at_left, at_right = np.where(lower, at_new, at_right), np.where(lower, at_left, at_new)
        tried.append(new)
        found.append(at_new)
    best = np.argmin(found, axis=0)
    every = np.arange(count)
    return np.array(tried)[best, every], np.array(found)[best, every]


def hidden(evidence: Evidence) -> Floats:
    """Of contacts that flip from step to step, how unsure the kinetic energy of what they push is, (T, B) [J].

    Frames see one phase of them. Where places do not follow velocities in an interval at both ends of which a body is
    in contact, its speed is known no better than by the difference, u: m u (v + u / 2). Even motion hides nothing: the
    way is then the mean of both velocities, less h^2 / 12 of the change of accelerations (Euler and Maclaurin), and t
    times the change of velocity farther. What is hidden is that of one frame, and does not add up.
    """
    motion, steps = evidence.motion, latest(evidence)
    found = np.zeros(motion.speed.shape)
    if not motion.touched.any() or len(motion.h) < 2:
        return found
    h = motion.h[:, None, None]
    bend = h**2 / 12.0 * np.diff(np.gradient(motion.v, evidence.time, axis=0), axis=0)
    off = lengths(np.diff(motion.com, axis=0) - 0.5 * (motion.v[1:] + motion.v[:-1]) * h + bend)
    rounding = FLOAT32 * np.abs(motion.com).max(axis=2)
    off -= steps * lengths(np.diff(motion.v, axis=0)) + 2.0 * np.maximum(rounding[1:], rounding[:-1])
    unsure = np.where(motion.touched[1:] & motion.touched[:-1], np.maximum(off, 0.0), 0.0) / motion.h[:, None]
    found[1:], found[:-1] = unsure, np.maximum(found[:-1], unsure)
    return np.asarray(motion.mass * found * (motion.speed + 0.5 * found))
