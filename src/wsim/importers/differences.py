"""Velocities from poses alone: differences of second order or more, from the side on which the motion is smooth.

A blow between two frames bends a path at once. A difference across it is neither the velocity before nor that after:
kinetic energy would dip and come back from nowhere. So each frame takes the one of three parabolas (through the frames
before it, about it, or after it) that is bent least, gravity aside, as essentially non-oscillatory schemes do (Harten,
Engquist, Osher and Chakravarthy 1987).

What a parabola misses is in proportion to the jerk j, with the other sign about a frame, h^2 j / 6, than to one side of
it, -h^2 j / 3: at its ends a pendulum of 0.1 rad a frame would gain 1.5 % of its energy. It is made good where four
jerks in a row are alike, to a quarter of their mean: none where a force comes or goes, which bends two frames.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import World

    Array = NDArray[Any]

NEARBY = 4  # bends: a blow between two frames bends two
SMOOTH = 7  # frames that have four jerks
TINY = 1e-300
ODD = 3.0  # times as much as one to its side is bent: a parabola that a blow has bent


def velocities(time: Array, body_q: Array, world: World) -> Array:
    """Velocities (T, B, 6) of the centres of mass [m/s] and of rotation [rad/s], of poses (T, B, 7) at times (T,)."""
    com = np.array([body.com for body in world.bodies], dtype=np.float64).reshape(-1, 3)
    q = body_q[:, :, 3:]
    center = body_q[:, :, :3] + rotate(q, np.broadcast_to(com, (*q.shape[:2], 3)))
    h = np.diff(time)[:, None, None]
    turn = multiply(q[1:], conjugate(q[:-1]))
    turn *= np.where(turn[..., 3:] < 0.0, -1.0, 1.0)  # the shorter way round
    sine = np.linalg.norm(turn[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, turn[..., 3:])
    spin = turn[..., :3] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)
    moved = smooth_rates(time, np.diff(center, axis=0) / h, np.array(world.gravity))
    return np.concatenate([moved, smooth_rates(time, spin / h, np.zeros(3))], axis=-1)


def smooth_rates(time: Array, rates: Array, pull: Array) -> Array:
    """Rates at frames (T, B, 3) from the mean rates between them (T - 1, B, 3); `pull` (3,) is their usual change."""
    if len(rates) < 2:
        return np.concatenate([rates, rates])
    h = np.diff(time)[:, None, None]
    bend = 2.0 * np.diff(rates, axis=0) / (h[1:] + h[:-1])  # (T - 2, B, 3), about the frames between
    odd = np.linalg.norm(bend - pull, axis=2, keepdims=True)
    # Beyond the ends it goes on as it falls, as evenly as at its best nearby.
    twice = np.maximum(odd[1:], odd[:-1]) if len(odd) > 1 else odd  # a swing has passing moments of no force
    least = [part.min(axis=0, keepdims=True) for part in (twice[: NEARBY - 1], twice[1 - NEARBY :])]
    least[1] = np.nextafter(least[1], np.inf)  # of two that are alike the one that there is
    odd[[0, -1]] = _swung(bend, odd)
    bend = np.concatenate([np.broadcast_to(pull, bend[:1].shape), bend, np.broadcast_to(pull, bend[:1].shape)])
    odd = np.concatenate([least[0], odd, least[1]])  # (T, B, 1)
    rates = np.concatenate([rates[:1] - h[:1] * pull, rates, rates[-1:] + h[-1:] * pull])
    h = np.concatenate([h[:1], h, h[-1:]])
    about = rates[:-1] + 0.5 * h[:-1] * bend  # at each frame, by the parabola through its neighbours
    after = np.concatenate([rates[1:-1] - 0.5 * h[1:-1] * bend[1:], about[-1:]])  # by the one that starts there
    before = np.concatenate([about[:1], rates[1:-1] + 0.5 * h[1:-1] * bend[:-1]])  # by the one that ends there
    none = np.full_like(odd[:1], np.inf)
    oddness = np.stack([odd, np.concatenate([odd[1:], none]), np.concatenate([none, odd[:-1]])])
    oddness[0] /= ODD  # the one about a frame is the best where none is bent
    for end, inner in ((0, 1), (-1, 2)):  # but has no frames beyond the ends
        oddness[0, end] *= ODD
        oddness[inner, end] /= ODD
    chosen = np.argmin(oddness, axis=0)[None]
    found: Array = np.take_along_axis(np.stack([about, after, before]) + _missed(bend, h), chosen, axis=0)[0]
    return found


def _swung(bend: Array, odd: Array) -> Array:
    """How odd the first and the last bend are, (2, B, 1): no more than they stray from the line of those inside.

    A force that turns, of a swing, changes evenly; a blow between two frames bends two of them, which with those
    inside are on no line: of shares s and 1 - s of it the farther of two second differences is a quarter at least.
    """
    if len(bend) < NEARBY:
        return np.stack([odd[0], odd[-1]])
    strays = np.linalg.norm(np.diff(bend, n=2, axis=0), axis=2, keepdims=True)
    return np.stack([np.minimum(odd[0], strays[:2].max(axis=0)), np.minimum(odd[-1], strays[-2:].max(axis=0))])


def _missed(bend: Array, h: Array) -> Array:
    """What parabolas about, after and before each frame miss of its rate, (3, T, B, 3), of bends (T, B, 3).

    The outermost bends are no path's: what parabolas of them miss is not known, and no jerk (T - 1, B, 3) is theirs.

    Args:
        bend: About each frame.
        h: Of the intervals before and after each frame (T + 1, 1, 1).
    """
    count = len(bend)
    if count < SMOOTH:
        return np.zeros((3, *bend.shape))
    jerk = np.diff(bend, axis=0) / h[1:-1]

    near = np.arange(4)[:, None] + np.arange(1, count - 5)  # four in a row, of each run of them (4, T - 6)
    mean = jerk[near].mean(axis=0)
    strays = np.linalg.norm(jerk[near] - mean, axis=3, keepdims=True).max(axis=0)
    trust = np.clip(2.0 - 4.0 * strays / np.maximum(np.linalg.norm(mean, axis=2, keepdims=True), TINY), 0.0, 1.0)

    def beside(frame: int) -> Array:
        """The jerk at a bend, of that `frame` frames from each, as far as four there are alike."""
        at = np.arange(count) + frame - 1
        two = np.clip(at, 1, count - 4)
        return np.asarray(trust[np.clip(at - 2, 0, count - 7)] * 0.5 * (jerk[two] + jerk[two + 1]))

    early, late = h[:-1], h[1:]
    found = np.stack([-beside(0) * early * late / 6.0, beside(1) * late**2 / 3.0, beside(-1) * early**2 / 3.0])
    found[0, [0, -1]] = found[1, -2:] = found[2, :2] = 0.0
    return found
