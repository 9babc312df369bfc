"""Roads that are laid into terrain, and the line in their middle that a driver follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.limits import MAX_SIZE
from wsim.scene.curves import spline
from wsim.scene.layers import Floats, Grid, blended, nearest, polyline, sample
from wsim.scene.validate import Call

_FINE = 0.5  # [m] between two points of its line


@dataclass(frozen=True)
class Road:
    """A road along a smooth line through points, (x, y) [m] each: level across, as high as the ground along its line.

    Attributes:
        points: What its middle goes through, by a natural cubic spline.
        width: Of what is level across [m].
        shoulder: Within which it goes over to the ground beside it [m].
        smooth: Length over which the ground's height along its line is averaged [m].
    """

    points: Sequence[Sequence[float]]
    width: float = 5.0
    shoulder: float = 3.0
    smooth: float = 10.0

    def line(self, gap: float = _FINE) -> Floats:
        """Points of its middle, (N, 2) [m], `gap` from one to the next or a little less."""
        call = Call("Road")
        return self.checked_line(call, call.size("gap", gap))

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Lay it in."""
        half = 0.5 * call.size("width", self.width)
        shoulder = call.within("shoulder", self.shoulder, 0.0, MAX_SIZE, "m")
        smooth = call.within("smooth", self.smooth, 0.0, MAX_SIZE, "m")
        line = self.checked_line(call)
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        u = (line[:, 0] - grid.x[0, 0]) / grid.cell[0]
        v = (line[:, 1] - grid.y[0, 0]) / grid.cell[1]
        rows, columns = ground.shape
        under = sample(ground, np.clip(u, 0, columns - 1), np.clip(v, 0, rows - 1))
        window = 2 * round(0.5 * smooth / float(steps.mean())) + 1
        if window > 1:
            under = _averaged(under, window)
        away, along = nearest(line, grid.x, grid.y)
        high = np.interp(along, np.concatenate([[0.0], np.cumsum(steps)]), under)
        return blended(ground, high, away - half, shoulder)

    def covers(self, call: Call, x: Floats, y: Floats) -> NDArray[np.bool_]:
        """Which places (x, y) are on it."""
        away, _ = nearest(self.checked_line(call), x, y)
        return np.asarray(away <= 0.5 * call.size("width", self.width), dtype=np.bool_)

    def checked_line(self, call: Call, gap: float = _FINE) -> Floats:
        """As `line`; a `SceneError` of this call where its points are none."""
        points = polyline(call, self.points)
        stretches = spline(np.column_stack([points, np.zeros(len(points))]))
        found = [stretches[0].at(np.zeros(1)).point]
        for stretch in stretches:
            count = max(1, int(np.ceil(stretch.length / gap)))
            found.append(stretch.at(np.linspace(0.0, stretch.length, count + 1)[1:]).point)
        return np.concatenate(found)[:, :2]


def _averaged(values: Floats, window: int) -> Floats:
    """A moving average; beyond the ends the line goes on at the slope that it has there."""
    half = window // 2
    before = values[0] + (values[0] - values[min(1, len(values) - 1)]) * np.arange(half, 0, -1)
    after = values[-1] + (values[-1] - values[max(-2, -len(values))]) * np.arange(1, half + 1)
    return np.convolve(np.concatenate([before, values, after]), np.full(window, 1.0 / window), mode="valid")
