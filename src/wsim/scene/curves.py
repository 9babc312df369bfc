"""Curves in space with a frame that goes along them: made of pieces, or smooth through points. NumPy alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP = math.radians(2.0)  # of turning, from one station to the next
LONGEST = 0.05  # of a curve's length
UP = np.array([0.0, 0.0, 1.0])
TURNS = ("up", "down", "left", "right")


@dataclass(frozen=True)
class Frames:
    """Stations along a curve: where it is [m], which way it goes, and its own up; (N, 3) each."""

    point: Floats
    along: Floats
    up: Floats

    @property
    def left(self) -> Floats:
        """At right angles to the other two."""
        return np.cross(self.up, self.along)


@dataclass(frozen=True)
class Stretch:
    """A part of a curve that is smooth in itself: frames by arc length [m], also a little beyond its ends."""

    at: Callable[[Floats], Frames]
    length: float  # [m]
    cells: int

    def stations(self) -> Floats:
        """Where it is cut, by arc length, (cells + 1,)."""
        return np.linspace(0.0, self.length, self.cells + 1)


def _turn(axis: Floats, angle: Floats) -> Floats:
    """Rotation matrices (N, 3, 3) about a unit axis by angles (N,)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    turned: Floats = np.eye(3) + s * cross + (1.0 - c) * (cross @ cross)
    return turned


def line(start: Frames, length: float) -> Stretch:
    """Straight on."""

    def at(s: Floats) -> Frames:
        one = np.ones((len(s), 1))
        return Frames(start.point + s[:, None] * start.along, start.along * one, start.up * one)

    return Stretch(at, length, 1)


def bend(start: Frames, way: str, radius: float, angle: float) -> Stretch:
    """A bend by an angle [rad]: up or down about the curve's own left, or left or right about the vertical.

    On a slope a bend to the side is a helix: its radius is that of its plan, and the slope stays.
    """
    left, along, up = start.left[0], start.along[0], start.up[0]
    if way in ("up", "down"):
        axis, slope = (-left if way == "up" else left), 1.0
    else:
        axis, slope = (UP if way == "left" else -UP), math.hypot(along[0], along[1])
    length = radius * angle / slope
    rate = slope / radius
    flat = along - (along @ axis) * axis
    centre = start.point[0] + radius * np.cross(axis, flat / np.linalg.norm(flat))

    def at(s: Floats) -> Frames:
        turned = _turn(axis, rate * s)
        rise = (s * (along @ axis))[:, None] * axis
        return Frames(centre + turned @ (start.point[0] - centre) + rise, turned @ along, turned @ up)

    return Stretch(at, length, max(2, math.ceil(angle / STEP)))


def loop(start: Frames, radius: float, aside: float) -> Stretch:
    """Once round upwards, and to the left meanwhile by `aside` [m], from and to the way it came."""
    left, along, up, foot = start.left[0], start.along[0], start.up[0], start.point[0]
    fine = np.linspace(0.0, 2.0 * math.pi, 2001)
    speed = np.hypot(radius, aside * (1.0 - np.cos(fine)) / (2.0 * math.pi))
    reach = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])

    def at(s: Floats) -> Frames:
        phi = np.interp(s, reach, fine) + np.minimum(s, 0.0) / radius + np.maximum(s - reach[-1], 0.0) / radius
        sin, cos = np.sin(phi)[:, None], np.cos(phi)[:, None]
        over = (aside * (phi - np.sin(phi)) / (2.0 * math.pi))[:, None]
        point = foot + radius * (sin * along + (1.0 - cos) * up) + over * left
        way = radius * (cos * along + sin * up) + (aside * (1.0 - cos) / (2.0 * math.pi)) * left
        return Frames(point, way / np.linalg.norm(way, axis=1, keepdims=True), cos * up - sin * along)

    return Stretch(at, float(reach[-1]), math.ceil(2.0 * math.pi / STEP))


def spline(points: Floats) -> list[Stretch]:
    """A natural cubic spline through points (N, 3), its up as near to the vertical as can be; one stretch a gap."""
    chord = np.linalg.norm(np.diff(points, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(chord)])
    bent = _second_derivatives(knots, points)

    def at(first: int) -> Callable[[Floats], Frames]:
        h = chord[first]

        def frames(s: Floats) -> Frames:
            b = (s / h)[:, None]
            a = 1.0 - b
            point = a * points[first] + b * points[first + 1]
            point = point + ((a**3 - a) * bent[first] + (b**3 - b) * bent[first + 1]) * h * h / 6.0
            way: Floats = (points[first + 1] - points[first]) / h
            way = way + ((3 * b * b - 1.0) * bent[first + 1] - (3 * a * a - 1.0) * bent[first]) * h / 6.0
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            up: Floats = UP - way[:, 2:] * way
            length = np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)  # none where it is vertical
            return Frames(point, way, up / length)

        return frames

    turns = np.linalg.norm(bent, axis=1) * chord.max()
    cells = [max(1, math.ceil(max(turns[k], turns[k + 1]) / STEP)) for k in range(len(chord))]
    return [Stretch(at(k), float(chord[k]), cells[k]) for k in range(len(chord))]


def _second_derivatives(knots: Floats, points: Floats) -> Floats:
    """Of a natural cubic spline at its knots, (N, 3)."""
    n, h = len(knots), np.diff(knots)
    matrix, right = np.eye(n), np.zeros((n, points.shape[1]))
    for k in range(1, n - 1):
        matrix[k, k - 1 : k + 2] = h[k - 1] / 6.0, (h[k - 1] + h[k]) / 3.0, h[k] / 6.0
        right[k] = (points[k + 1] - points[k]) / h[k] - (points[k] - points[k - 1]) / h[k - 1]
    return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)


def sweep(stretch: Stretch, across: Floats) -> tuple[Floats, Floats]:
    """Points of a surface and its direction along the curve, (cells + 1, M, 3) each; section `across` (M, 2) [m]."""
    s = stretch.stations()
    little = 1e-3 * stretch.length / stretch.cells

    def placed(where: Floats) -> Floats:
        frames = stretch.at(where)
        return (
            frames.point[:, None]
            + across[None, :, :1] * frames.left[:, None]
            + across[None, :, 1:] * frames.up[:, None]
        )

    return placed(s), (placed(s + little) - placed(s - little)) / (2.0 * little)


def chain(
    start: Floats, heading: float, slope: float, pieces: Sequence[tuple[str, tuple[float, ...]]]
) -> list[Stretch]:
    """Stretches one after another, from a point, a heading and a slope [rad]; a piece is its kind and numbers."""
    along = np.array([math.cos(heading) * math.cos(slope), math.sin(heading) * math.cos(slope), math.sin(slope)])
    up = np.array([-math.cos(heading) * math.sin(slope), -math.sin(heading) * math.sin(slope), math.cos(slope)])
    here = Frames(np.array([start]), along[None], up[None])
    made = []
    for kind, numbers in pieces:
        if kind == "line":
            made.append(line(here, *numbers))
        elif kind == "loop":
            made.append(loop(here, *numbers))
        else:
            made.append(bend(here, kind, *numbers))
        here = made[-1].at(np.array([made[-1].length]))
    return made
