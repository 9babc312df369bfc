"""What a damper takes where what it holds comes to rest relative to it within one interval between two frames.

A spring k with a damper c holds the ends x + rest apart: x'' + r (x' + k / c x) = a, where r is c over the mass that it
feels and a what else acts. At r h > 1 frames say nothing of how x' goes in between, and a rule of quadrature may be off
by half. But the end speeds are known, and how far the length went; of all motions that the law allows at an even a
that is one alone: r and a follow, and the integral of x'^2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

MOST = 1e6  # of r h: what is at rest at once
DOUBLE = 1e-6  # of r beyond 4 k / c, where both ways of coming to rest are one


@dataclass(frozen=True)
class Relaxation:
    """How fast a length changes in an interval: the sum of A exp(-s t), of a fast and a slow s."""

    fast: float  # s [1/s]
    slow: float
    amplitude: tuple[float, float]  # of the fast as the interval begins, of the slow as it ends [m/s]
    h: float  # [s]

    @property
    def rate(self) -> float:
        """c over the mass that the damper feels [1/s]."""
        return self.fast + self.slow

    @property
    def way(self) -> float:
        """How far the length goes [m]."""
        fast, slow = self.amplitude
        return fast * _gone(self.fast, self.h) + slow * np.exp(self.slow * self.h) * _gone(self.slow, self.h)

    @property
    def squared(self) -> float:
        """The integral of the rate's square [m^2/s]."""
        (fast, late), h = self.amplitude, self.h
        slow = late * np.exp(self.slow * h)
        mixed = 2.0 * fast * slow * _gone(self.fast + self.slow, h)
        return float(fast**2 * _gone(2.0 * self.fast, h) + mixed + slow**2 * _gone(2.0 * self.slow, h))

    def others(self, stretch: float) -> float:
        """What else acts, by c: the speed that it would keep up against the damper alone [m/s].

        Args:
            stretch: Of the spring as the interval begins [m].
        """
        fast, slow = self.amplitude[0], self.amplitude[1] * np.exp(self.slow * self.h)
        changes = -self.fast * fast - self.slow * slow
        return float(changes / self.rate + fast + slow + self.fast * self.slow / self.rate * stretch)


def relaxation(speeds: tuple[float, float], way: float, h: float, ratio: float) -> Relaxation | None:
    """The one that begins and ends at two speeds [m/s] and goes a way [m] in h [s]; None where none has r h > 1.

    Args:
        speeds: Of the length as the interval begins and ends.
        way: By how much the length grows meanwhile.
        h: How long that takes.
        ratio: k / c [1/s].
    """

    def at(rate: float) -> Relaxation:
        root = np.sqrt(rate * (rate - 4.0 * ratio))
        fast = 0.5 * (rate + root)
        slow = rate * ratio / fast
        grown, left = float(np.exp(slow * h)), float(np.exp(-fast * h))
        late = (speeds[1] - speeds[0] * left) / (1.0 - grown * left)
        return Relaxation(fast, slow, (speeds[0] - late * grown, late), h)

    low, high = max((4.0 + DOUBLE) * ratio, 1.0 / h), MOST / h
    if ratio * h > np.log(MOST) or (at(low).way - way) * (at(high).way - way) >= 0.0:
        return None
    return at(float(np.exp(brentq(lambda log: at(float(np.exp(log))).way - way, np.log(low), np.log(high)))))


def taken(rate: Floats, length: Floats, rest: float, ratio: float, h: Floats) -> tuple[Floats, Floats]:
    """The integral of the rate's square over each interval, and how unsure it is, (T - 1,) each [m^2/s].

    NaN where frames resolve it, or what else acts changes by so much that no even a says anything. If it changes by d
    from one interval to the next, so it may within this: then x' is off by h d at most, as if it came at once; and the
    means being one, the integral by that times twice the deviation of x' from its mean (Cauchy, Schwarz).

    Beside such an interval slopes by differences say nothing, either: there the square of the mean is the least, and
    for a rate that stays between those at both ends v and v', m (v + v') - v v' the most, m the mean.

    Args:
        rate: Of the length, (T,) [m/s].
        length: (T,) [m].
        rest: The spring's natural length [m].
        ratio: k / c [1/s].
        h: Of each interval, (T - 1,) [s].
    """
    found, unsure = np.full((2, len(h)), np.nan)
    ways, stretch = np.diff(length), length - rest
    # The mean of the stretch between frames, by Hermite's cubic.
    mean = 0.5 * (stretch[1:] + stretch[:-1]) - h / 12.0 * np.diff(rate)
    for i in range(len(h)):
        fit = relaxation((float(rate[i]), float(rate[i + 1])), float(ways[i]), float(h[i]), ratio)
        if fit is None:
            continue
        here = fit.others(float(stretch[i]))
        around = [j for j in (i - 1, i + 1) if 0 <= j < len(h)]
        others = [(rate[j + 1] - rate[j]) / (h[j] * fit.rate) + ways[j] / h[j] + ratio * mean[j] for j in around]
        jump = fit.rate * h[i] * max((abs(each - here) for each in others), default=0.0)
        if jump > max(abs(rate[i]), abs(rate[i + 1])):
            continue
        apart = np.sqrt(h[i] * max(fit.squared - ways[i] ** 2 / h[i], 0.0))
        found[i], unsure[i] = fit.squared, 2.0 * jump * apart + jump**2 * h[i]
    known = np.concatenate([[False], ~np.isnan(found), [False]])
    beside = ~known[1:-1] & (known[2:] | known[:-2])
    least, spread = ways**2 / h, (ways / h - rate[:-1]) * (rate[1:] - ways / h) * h
    return np.where(beside, least + 0.5 * spread, found), np.where(beside, 0.5 * np.abs(spread), unsure)


def resolved(rate: Floats, length: Floats, h: Floats) -> tuple[Floats, Floats]:
    """The integral of a rate's square over intervals that frames resolve, and how unsure it is, (T - 1,) each [m^2/s].

    Of the parabola v + d s + b s (1 - s), s from 0 to 1, that begins and ends as the rate does and takes the length
    where it goes: that of a swing of 1.2 rad a frame is known to 1 % by it, and to 30 % by Euler and Maclaurin from the
    squares at both ends. What is beyond is c s (1 - s) (1 - 2 s) to the next order, c by slopes that are the means of
    those of the parabolas at both sides of a frame; beside a far greater change, of the frame that shows less of it.
    A blow that changes the rate by d at once makes c = d / 2, and the parabola's error is d^2 / 6 at most: 2 / 3 c^2.

    Args:
        rate: Of the length, (T,) [m/s].
        length: (T,) [m].
        h: Of each interval, (T - 1,) [s].
    """
    change, mean = np.diff(rate), 0.5 * (rate[1:] + rate[:-1])
    bulge = 6.0 * (np.diff(length) / h - mean)
    begins, ends = (change + bulge) / h, (change - bulge) / h
    bends = 0.5 * (begins[1:] - ends[:-1])
    before, after = (h * np.concatenate(each) for each in (([0.0], -bends), (bends, [0.0])))
    size = np.pad(np.abs(change) + np.abs(bulge), 1)
    calm = size[1:-1] < 0.5 * np.maximum(size[:-2], size[2:])  # beside a blow, whose bend is not its own
    beyond = np.where(calm, np.minimum(np.abs(before), np.abs(after)), 0.5 * (before + after))
    square = mean**2 + change**2 / 12.0 + bulge * mean / 3.0 + bulge**2 / 30.0
    return square * h, beyond**2 * h / 1.5


def _gone(rate: float, h: float) -> float:
    """The integral of exp(-rate t) over h [s]."""
    return h if rate * h < 1e-12 else float(-np.expm1(-rate * h)) / rate
