"""Pressure sensors in walls: what the water pushes with on a small face, step by step."""

from __future__ import annotations

import math

import numpy as np
import warp as wp

from wsim.solvers.solver_sph import SolverSPH


@wp.kernel
def _sense(
    # Data in:
    point: wp.array(dtype=wp.vec3),
    normal: wp.array(dtype=wp.vec3),
    width: float,
    reach: float,
    position: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    # Data out:
    sums: wp.array(dtype=float),
):
    """Add to each sensor what a particle near its face pushes with, along its normal [N], as a tent over the face."""
    i = wp.tid()
    for s in range(point.shape[0]):
        n = normal[s]
        apart = position[i] - point[s]
        if wp.abs(wp.dot(apart, n)) < reach:
            across = apart - wp.dot(apart, n) * n
            weight = wp.max(1.0 - wp.abs(across[0]) / width, 0.0)
            weight *= wp.max(1.0 - wp.abs(across[1]) / width, 0.0)
            weight *= wp.max(1.0 - wp.abs(across[2]) / width, 0.0)
            if weight > 0.0:
                wp.atomic_add(sums, s, -weight * wp.dot(force[i], n))


def _felt(distance: np.ndarray, smoothing_length: float, dimensions: int) -> np.ndarray:
    """Share of a wall's push that is felt so far from its edge with another wall [m].

    What stands behind the other wall pushes along this one's normal, too, and the two walls' pushes along each other
    cancel: beside an edge a particle's whole push along the normal is that of the wall's own side alone. Over a column
    of water with one pressure it is the integral of the kernel's projection on the wall, from the edge on.
    """
    at, along = np.linspace(-2.0, 2.0, 401), np.linspace(0.0, 2.0, 401)
    q = np.minimum(np.hypot(at[:, None], along), 2.0)
    weight = (1.0 - 0.5 * q) ** 4 * (1.0 + 2.0 * q) * (along if dimensions == 3 else 1.0)
    projected = weight.sum(axis=1)
    return np.interp(distance / smoothing_length, at, np.cumsum(projected) / projected.sum())


class WallSensors:
    """Pressures on faces of fixed walls.

    A sensor adds up what each fluid particle pushes the walls with, the blow by which a wall stops what is on its face
    included, so that a wall full of sensors has the momentum that the water lost. Its face is a tent one spacing wide
    to each side: the mean over one spacing, continuous as particles pass. It is calibrated to read one pressure p as p
    beside the edges of its wall, too.

    Args:
        solver: The fluid; its walls are the ones that are felt.
        points: Middles of the faces, on the walls [m], shape (n, 3).
        normals: From the wall to the water, along an axis each, shape (n, 3).
        low: Lower corner of the hollow that the walls enclose [m]: a face reaches no further.
        high: Upper corner [m].
    """

    def __init__(
        self, solver: SolverSPH, points: np.ndarray, normals: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> None:
        config, device = solver.config, solver.model.device
        self._solver, self._width, self._reach = solver, config.spacing, config.support
        self._point = wp.array(np.asarray(points, np.float32), dtype=wp.vec3, device=device)
        self._normal = wp.array(np.asarray(normals, np.float32), dtype=wp.vec3, device=device)
        self._sums = wp.zeros(len(points), dtype=float, device=device)
        self._steps = 0
        across = [k for k in range(3) if config.dimensions == 3 or k != 1]
        pairs = zip(np.asarray(points), np.asarray(normals), strict=True)
        self._area = np.array(
            [math.prod(self._length(p[k], low[k], high[k]) for k in across if n[k] == 0.0) for p, n in pairs]
        )

    def _length(self, middle: float, low: float, high: float) -> float:
        """Of a face along one axis, as it is felt [m]."""
        config = self._solver.config
        x = middle + self._width * (np.arange(400) + 0.5 - 200) / 200
        tent = 1.0 - np.abs(x - middle) / self._width
        felt = tent * (x > low) * (x < high)
        for distance in (x - low, high - x):
            felt *= _felt(distance, config.smoothing_length, config.dimensions)
        return float(felt.mean()) * 2.0 * self._width

    def feel(self, position: wp.array) -> None:
        """Add the last step's push; on the device alone, so that a graph can capture it."""
        wp.launch(
            _sense,
            dim=self._solver.fluid_count,
            # The solver's own sum of its walls' impulse has no place on the wall; this is what it sums.
            inputs=[self._point, self._normal, self._width, self._reach, position, self._solver._on_walls],
            outputs=[self._sums],
            device=self._solver.model.device,
        )

    def read(self, steps: int) -> np.ndarray:
        """Mean pressures over the last steps [Pa], shape (n,)."""
        mean: np.ndarray = self._sums.numpy().astype(float) / (self._area * steps)
        self._sums.zero_()
        return mean
