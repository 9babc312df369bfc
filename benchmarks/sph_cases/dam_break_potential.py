"""What an ideal dam break does: a column a wide and 2 a high, let go at once, without viscosity, sound or a gate.

The water is a potential flow with a free surface, after Longuet-Higgins & Cokelet (1976, Proc. R. Soc. A 350, 1-26) in
the complex form of Vinje & Brevig (1981, Adv. Water Resour. 4, 77-82): particles of the surface carry the potential
phi; the stream function psi on the surface follows from Cauchy's theorem for phi + i psi; its slope along the surface
is the velocity. The wall x = 0 and the floor z = 0 are mirrors, so that only the surface has nodes: the side, from the
toe on the floor up to the corner, and the top, from the corner to the wall.

Units: the width a of the column, the gravity g and the density are 1. Time is in sqrt(a / g); T = t sqrt(2 g / a) is
the time of Martin & Moyce (1952).

    python -m benchmarks.dam_break_ideal    # prints the checks and the table, and holds it against the experiments
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

HEIGHT = 2.0
# Node spacing, in units of the largest: at the toe, how that grows as the toe runs, and at the corner.
TIP, FOLLOW, CORNER = 0.05, 0.2, 0.3
GROWTH, COURANT, REDISTRIBUTE = 0.15, 0.3, 4  # of the spacing along the surface; of a step; steps between
SPACINGS = (0.1, 0.05, 0.025)
STORED = np.array([*np.arange(0.0, 2.0, 0.2), *np.arange(2.0, 5.2, 0.25), *np.arange(5.5, 9.1, 0.5), 9.25])

# T = t sqrt(2 g / a) and the front x / a, at the finest of SPACINGS.
TABLE = """
0.00 1.0000   0.20 1.0381   0.40 1.1229   0.60 1.2409   0.80 1.3873   1.00 1.5593   1.20 1.7489   1.40 1.9594
1.60 2.1866   1.80 2.4258   2.00 2.6819   2.25 3.0214   2.50 3.3744   2.75 3.7439   3.00 4.1325   3.25 4.5355
3.50 4.9485   3.75 5.3705   4.00 5.8023   4.25 6.2447   4.50 6.6967   4.75 7.1569   5.00 7.6235   5.50 8.5717
6.00 9.5364   6.50 10.5165   7.00 11.5105   7.50 12.5166   8.00 13.5320   8.50 14.5548   9.00 15.5833   9.25 16.0993
"""
POTENTIAL_FRONT = np.array(TABLE.split(), float).reshape(-1, 2)


def front(times: np.ndarray) -> np.ndarray:
    """Where the toe is [a] at times [sqrt(a / g)], from the stored table.

    Raises:
        ValueError: If a time is outside the table.
    """
    t, x = POTENTIAL_FRONT.T
    scaled = math.sqrt(2.0) * np.asarray(times, float)
    if scaled.size and (scaled.min() < 0.0 or scaled.max() > t[-1]):
        raise ValueError(f"the table has T = 0 to {t[-1]:g}, and {scaled.min():g} to {scaled.max():g} is asked")
    return np.asarray(CubicSpline(t, x, bc_type=((1, 0.0), (2, 0.0)))(scaled))  # it starts from rest


@dataclass
class Surface:
    """Nodes x + i z [a] from the toe up the side to node `corner` and along the top to the wall; phi [a sqrt(a g)]."""

    place: np.ndarray
    phi: np.ndarray
    corner: int


def stream(place: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Stream function on the surface [a sqrt(a g)], zero on the wall and the floor.

    The integral of (w - w_i) / (p - p_i) round the water and its three mirror images is zero. Segments are straight and
    w = phi + i psi linear on each, so that the integral over one is exact. Its real part is solved for psi.
    """
    inner, row = np.arange(1, len(place) - 1), np.arange(len(place) - 2)
    ring = np.concatenate([place[:-1], -place.conj()[:0:-1], -place[:-1], place.conj()[:0:-1]])
    apart = ring[None, :] - place[inner, None]
    log = np.log(np.where(apart == 0.0, 1.0, apart))
    seen = np.roll(log, -1, axis=1) - log  # of each segment from each node: log of the distances' ratio, and the angle
    seen.imag -= 2.0 * np.pi * np.round(seen.imag / (2.0 * np.pi))
    seen[row, inner] = seen[row, inner - 1] = 0.0
    second = -seen * apart / (np.roll(ring, -1) - ring)  # what of it multiplies w at the segment's second end
    weight = seen - second + np.roll(second, 1, axis=1)
    weight[row, inner] -= seen.sum(axis=1)
    right, left, left_below, right_below = np.split(weight, 4, axis=1)
    of_phi, of_psi = np.zeros((2, len(row), len(place)))
    of_phi[:, :-1] = (right + left_below).real  # phi is even in either mirror, psi odd
    of_phi[:, :0:-1] += (left + right_below).real
    of_psi[:, :-1] = (right + left_below).imag
    of_psi[:, :0:-1] -= (left + right_below).imag
    psi = np.zeros(len(place))
    psi[1:-1] = np.linalg.solve(of_psi[:, 1:-1], of_phi @ phi)
    return psi


def splines(place: np.ndarray, w: np.ndarray, corner: int) -> list[tuple[np.ndarray, CubicSpline]]:
    """Of the side, and of the top with its image in the wall: the nodes' chord length [a], and (place, w) over it."""
    curves = []
    for nodes, mirrored in ((slice(0, corner + 1), False), (slice(corner, None), True)):
        p, f = place[nodes], w[nodes]
        n = len(p)
        if mirrored:
            p, f = np.concatenate([p, -p.conj()[-2::-1]]), np.concatenate([f, f.conj()[-2::-1]])
        s = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(p)))])
        curves.append((s[:n], CubicSpline(s, np.stack([p, f], axis=1))))
    return curves


def velocity(place: np.ndarray, w: np.ndarray, corner: int) -> np.ndarray:
    """u + i v of the nodes [sqrt(a g)]; at the corner the mean of what side and top say."""
    slopes = [curve(s, 1) for s, curve in splines(place, w, corner)]
    side, top = (slope[:, 1] / slope[:, 0] for slope in slopes)
    v = np.concatenate([side[:-1], [0.5 * (side[-1] + top[0])], top[1:]]).conj()
    v[0], v[-1] = v[0].real, 1j * v[-1].imag
    return v


def rate(place: np.ndarray, phi: np.ndarray, corner: int) -> tuple[np.ndarray, np.ndarray]:
    """How the nodes move, and how phi changes on them by Bernoulli's equation with no pressure."""
    v = velocity(place, phi + 1j * stream(place, phi), corner)
    return v, 0.5 * np.abs(v) ** 2 - place.imag


def spread(length: float, spacing: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Positions from 0 to a length, apart as a function of the position says."""
    half = np.geomspace(1e-6 * length, 0.5 * length, 1500)
    fine = np.concatenate([[0.0], half, length - half[-2::-1], [length]])
    count = np.concatenate([[0.0], np.cumsum(np.diff(fine) / spacing(0.5 * (fine[1:] + fine[:-1])))])
    return np.interp(np.linspace(0.0, count[-1], max(round(count[-1]), 8) + 1), count, fine)


def redistribute(old: Surface, largest: float, *, smooth: bool = True) -> Surface:
    """Spread the nodes anew, dense at the toe and the corner; damp the zigzag of nodes on the side."""
    side, top = splines(old.place, old.phi.astype(complex), old.corner)
    length = side[0][-1]
    tip = largest * min(1.0, TIP + FOLLOW * (old.place[0].real - 1.0))

    def along_side(s: np.ndarray) -> np.ndarray:
        return np.minimum(np.minimum(largest, tip + GROWTH * s), CORNER * largest + GROWTH * (length - s))

    at_side = spread(length, along_side)
    at_top = spread(top[0][-1], lambda s: np.minimum(largest, CORNER * largest + GROWTH * s))
    corner = len(at_side) - 1
    new = np.concatenate([side[1](at_side), top[1](at_top)[1:]])
    if smooth:
        new[2 : corner - 1] -= np.diff(new[: corner + 1], 4, axis=0) / 16.0
    new[0, 0], new[-1, 0] = new[0, 0].real, 1j * new[-1, 0].imag
    return Surface(new[:, 0], new[:, 1].real, corner)


def column(largest: float) -> Surface:
    """The column at rest."""
    u = np.linspace(0.0, 1.0, 101)
    place = np.concatenate([1.0 + 1j * HEIGHT * u, 1.0 - u[1:] + 1j * HEIGHT])
    return redistribute(Surface(place, np.zeros(len(place)), 100), largest, smooth=False)


def budget(place: np.ndarray, w: np.ndarray, corner: int) -> tuple[float, float]:
    """Volume [a^2], and potential and kinetic energy together: integrals of the splines along the surface."""
    at, gauss = np.polynomial.legendre.leggauss(5)
    volume = energy = 0.0
    for s, curve in splines(place, w, corner):
        h = np.diff(s)[:, None]
        p, f = np.moveaxis(curve(s[:-1, None] + 0.5 * h * (1.0 + at)), -1, 0)
        dp, df = np.moveaxis(curve(s[:-1, None] + 0.5 * h * (1.0 + at), 1), -1, 0)
        volume -= float((0.5 * h * gauss * p.imag * dp.real).sum())
        energy += float((0.5 * h * gauss * 0.5 * (f.real * df.imag - p.imag**2 * dp.real)).sum())
    return volume, energy


def solve(largest: float, end: float) -> np.ndarray:
    """Let the column go until a time [sqrt(a / g)], or until its surface crosses the floor.

    Returns:
        Rows of time [sqrt(a / g)], toe [a], its speed [sqrt(a g)], volume and energy (both 2 at release).
    """
    surface, rows, t = column(largest), [], 0.0
    for n in itertools.count():
        if n and n % REDISTRIBUTE == 0:
            surface = redistribute(surface, largest)
        p, phi, corner = surface.place, surface.phi, surface.corner
        w = phi + 1j * stream(p, phi)
        v = velocity(p, w, corner)
        rows.append((t, p[0].real, v[0].real, *budget(p, w, corner)))
        if t >= end:
            break
        gap = np.abs(np.diff(p))
        strain = float((gap / np.maximum(np.abs(np.diff(v)), 1e-9)).min())
        dt = min(COURANT * math.sqrt(gap.min()), COURANT * strain, end - t)
        k1 = v, 0.5 * np.abs(v) ** 2 - p.imag
        k2 = rate(p + 0.5 * dt * k1[0], phi + 0.5 * dt * k1[1], corner)
        k3 = rate(p + 0.5 * dt * k2[0], phi + 0.5 * dt * k2[1], corner)
        k4 = rate(p + dt * k3[0], phi + dt * k3[1], corner)
        p = p + dt / 6.0 * (k1[0] + 2.0 * (k2[0] + k3[0]) + k4[0])
        phi = phi + dt / 6.0 * (k1[1] + 2.0 * (k2[1] + k3[1]) + k4[1])
        t += dt
        if not np.isfinite(p).all() or p.imag.min() < -1e-9:
            break
        surface = Surface(p, phi, corner)
    return np.array(rows)


def release_errors(largest: float) -> tuple[float, float]:
    """Of the acceleration [g] at release, against the series that `dam_break.pressure_at_release` sums.

    The first is the largest on the side above z = 0.2 a (on the floor it is infinite), the second on top at the wall.
    """
    still, n = column(largest), np.arange(1, 400, 2)[:, None]
    p = still.place
    got = velocity(p, -p.imag + 1j * stream(p, -p.imag), still.corner)
    k, z = 0.5 * math.pi * n / HEIGHT, p.imag[1 : still.corner]
    # An endlessly wide column's series has a closed form; the rest converges fast.
    less = (4.0 / (math.pi * n) * (1.0 - np.tanh(k)) * np.cos(k * z)).sum(axis=0)
    side = -2.0 / math.pi * np.log(np.tan(0.25 * math.pi * z / HEIGHT)) - less
    top = -(4.0 / (math.pi * n) * (2 - n % 4) / np.cosh(k)).sum()
    return float(np.abs(got.real[1 : still.corner] - side)[z > 0.2].max()), float(abs(got[-1].imag - top))
