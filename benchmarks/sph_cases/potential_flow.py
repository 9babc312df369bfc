"""Free heave decay of a half-submerged sphere in deep water, by linear potential flow.

Cummins (1962, Schiffstechnik 9): (m + A_inf) z'' + integral of K(t - s) z'(s) ds + rho g S(z) = 0, with the hydrostatic
force of the sphere kept in full, and K(t) = 2/pi integral of B(w) cos(w t) dw. Added mass and radiation damping of the
hemisphere are Hulme's (1982, J. Fluid Mech. 121, table 1): B = m w lambda(w^2 R / g), A_inf = m / 2.
"""

from __future__ import annotations

import numpy as np

# K a = w^2 R / g, and lambda = B / (m w). The Kramers-Kronig relation gives Hulme's added mass from it to 3 digits.
DAMPING = np.array(
    [
        (0.0, 0.0), (0.05, 0.1036), (0.1, 0.1816), (0.2, 0.2793), (0.3, 0.3254), (0.4, 0.3410), (0.5, 0.3391),
        (0.6, 0.3271), (0.7, 0.3098), (0.8, 0.2899), (0.9, 0.2691), (1.0, 0.2484), (1.2, 0.2096), (1.4, 0.1756),
        (1.6, 0.1469), (1.8, 0.1229), (2.0, 0.1031), (2.5, 0.0674), (3.0, 0.0452), (4.0, 0.0219), (5.0, 0.0116),
        (6.0, 0.0066), (7.0, 0.0040), (8.0, 0.0026), (9.0, 0.0017), (10.0, 0.0012),
    ]
)  # fmt: skip


def heave_decay(radius: float, density: float, gravity: float, drop: float, seconds: float) -> np.ndarray:
    """Heights over the equilibrium [m] of a sphere let go at `drop` [m], rows (t, z), 2 ms apart."""
    from scipy.interpolate import PchipInterpolator

    mass = density * 2.0 / 3.0 * np.pi * radius**3
    w = np.linspace(0.0, 30.0, 3001)
    ka = w * w * radius / gravity
    last = DAMPING[-1]
    # Beyond the table the waves vanish as (K a)^-4, the hemisphere's asymptote.
    tail = last[1] * (last[0] / np.maximum(ka, last[0])) ** 4
    damping = mass * w * np.where(ka <= last[0], PchipInterpolator(*DAMPING.T)(np.minimum(ka, last[0])), tail)
    dt = 2e-3
    t = np.arange(0.0, seconds + dt, dt)
    memory = 2.0 / np.pi * np.trapezoid(damping * np.cos(w * t[:, None]), w, axis=1)
    z, v = np.zeros_like(t), np.zeros_like(t)
    z[0] = drop

    def acceleration(i: int) -> float:
        convolution = dt * (memory[: i + 1] @ v[i::-1] - 0.5 * (memory[0] * v[i] + memory[i] * v[0]))
        restoring = density * gravity * np.pi * (radius**2 * z[i] - z[i] ** 3 / 3.0)
        return -(restoring + convolution) / (1.5 * mass)

    for i in range(len(t) - 1):
        before = acceleration(i)
        z[i + 1] = z[i] + dt * v[i] + 0.5 * dt * dt * before
        v[i + 1] = v[i] + dt * before
        v[i + 1] = v[i] + 0.5 * dt * (before + acceleration(i + 1))
    return np.stack([t, z])
