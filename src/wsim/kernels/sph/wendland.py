"""Wendland's C2 kernel (Wendland 1995; for SPH: Dehnen & Aly 2012), with support 2h.

Beyond the support both functions are zero without a branch: a sum over a list that reaches a little further needs no
test, which on a CPU would be mispredicted a quarter of the time.

`norm` is 21 / (16 pi h^3) in three dimensions and 7 / (4 pi h^2) in two.
"""

import warp as wp


@wp.func
def wendland(r: float, h: float, norm: float) -> float:
    """Kernel W(r) [1/m^3], zero beyond 2h."""
    q = r / h
    t = wp.max(1.0 - 0.5 * q, 0.0)
    t2 = t * t
    return norm * t2 * t2 * (1.0 + 2.0 * q)


@wp.func
def wendland_slope(r: float, h: float, norm: float) -> float:
    """(1/r) dW/dr [1/m^5], so that grad W = slope * (x_i - x_j); never divides by r."""
    t = wp.max(1.0 - 0.5 * r / h, 0.0)
    return -5.0 * norm / (h * h) * t * t * t
