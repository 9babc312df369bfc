"""Tracks: a cross-section swept along a curve, for balls to roll on and things to slide on."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import UsdGeom

from wsim.limits import MAX_SIZE
from wsim.scene.authoring import Handle, note_line, set_pose
from wsim.scene.bodies import finish_collider
from wsim.scene.curves import TURNS, UP, Frames, Stretch, chain, spline, sweep
from wsim.scene.sections import Section, flat, rails, round_
from wsim.scene.shapes import Shapes
from wsim.scene.static_mesh import define_mesh
from wsim.scene.validate import Call, Vec3, shown

Floats = NDArray[np.float64]

PROFILES = ("flat", "round", "rails")
_MOST_CELLS = 20_000
_STEEPEST = math.sin(math.radians(85.0))
_MOST_TURN = 3600.0  # [deg]


@dataclass(frozen=True)
class Track(Handle):
    """A track: `length` of its line [m], and places along it."""

    length: float
    _stretches: tuple[Stretch, ...] = field(repr=False, compare=False)

    def place(self, distance: float, above: float = 0.0) -> Vec3:
        """Where the track's line is after `distance` [m], or `above` it [m] at right angles to it."""
        frames = self._frames(distance)
        x, y, z = (frames.point + above * frames.up)[0]
        return float(x), float(y), float(z)

    def direction(self, distance: float) -> Vec3:
        """Which way the track goes after `distance` [m], of length 1."""
        x, y, z = self._frames(distance).along[0]
        return float(x), float(y), float(z)

    @property
    def end(self) -> Vec3:
        """Where the track's line ends [m]."""
        return self.place(self.length)

    def _frames(self, distance: float) -> Frames:
        call = Call("track", self.name)
        left = call.within("distance", distance, -1e-9, self.length + 1e-9, "m")
        for stretch in self._stretches[:-1]:
            if left <= stretch.length:
                return stretch.at(np.array([left]))
            left -= stretch.length
        return self._stretches[-1].at(np.array([left]))


class Tracks(Shapes):
    """The call that makes a track."""

    def track(
        self,
        name: str,
        *,
        pieces: Sequence[Sequence[object]] | None = None,
        points: Sequence[Sequence[float]] | None = None,
        start: Sequence[float] = (0.0, 0.0, 0.0),
        heading_deg: float = 0.0,
        slope_deg: float = 0.0,
        profile: str = "flat",
        width: float = 0.1,
        wall: float | None = None,
        thickness: float = 0.01,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
    ) -> Track:
        """Make a static track along a curve. What rolls or slides on it keeps its energy in the bends.

        Args:
            name: Name of the prim.
            pieces: What the line is made of, one after another, each on from where and how the last one ends:
                ("line", length), ("up" or "down", radius, angle_deg), ("left" or "right", radius, angle_deg),
                ("loop", radius, aside): once round upwards, ending `aside` to the left. On a slope a bend to the
                side is a helix, and may be more than 360.
            points: Instead of pieces: points (x, y, z) that a smooth line goes through [m].
            start: Where the first piece begins [m].
            heading_deg: Which way it goes there, from +X towards +Y [deg].
            slope_deg: How steeply it rises there; negative goes down [deg].
            profile: "flat" (the line is the middle of a flat ribbon), "round" (the lowest line of a gutter that is
                part of a tube) or "rails" (two rods; the line is midway between their axes).
            width: Of the ribbon; of the gutter, twice its radius; between the rods' axes [m].
            wall: Height of the walls beside a ribbon, none by default; of a gutter's rims over its lowest line,
                half its width by default [m].
            thickness: Of floor and walls, or the rods' diameter [m].
            material: What `scene.material` returned, or its name.
            friction: Overrides the material's.
            restitution: Overrides the material's.
            color: Linear RGB; overrides the material's.

        Raises:
            SceneError: If a piece or a number is not possible, or a bend is tighter than the track is wide.
        """
        call = Call("track", name)
        path = self._path(call)
        stretches = _line(call, pieces, points, start, heading_deg, slope_deg)
        sections = _sections(call, profile, width, wall, thickness)
        if pieces is not None:
            _not_through_itself(call, pieces, stretches, sections)
        surface = self._surface(call, material, friction, restitution, color)

        def said(k: int) -> str:
            if pieces is not None:
                return f"pieces[{k}] = {shown(pieces[k])}"
            return f"points[{k}] to points[{k + 1}]"

        vertices, faces, normals = _swept(call, stretches, sections, said)
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, (0.0, 0.0, 0.0))
        mesh = define_mesh(self._stage, f"{path}/geometry", vertices, faces, normals).GetPrim()
        note_line(mesh)
        finish_collider(mesh, surface)
        length = sum(stretch.length for stretch in stretches)
        return Track(prim.GetName(), path, "static", length, tuple(stretches))


def _line(
    call: Call,
    pieces: Sequence[Sequence[object]] | None,
    points: Sequence[Sequence[float]] | None,
    start: Sequence[float],
    heading_deg: float,
    slope_deg: float,
) -> list[Stretch]:
    if (pieces is None) == (points is None):
        call.fail("give pieces or points, one of them")
    if points is not None:
        for name, given, none in (
            ("start", tuple(start) if isinstance(start, Sequence) else start, (0.0, 0.0, 0.0)),
            ("heading_deg", heading_deg, 0.0),
            ("slope_deg", slope_deg, 0.0),
        ):
            if given != none:
                call.fail(
                    f"{name} = {shown(given)} beside points, which say it themselves; leave it out, or give pieces"
                )
        return _through(call, points)
    if isinstance(pieces, (str, bytes)) or not isinstance(pieces, (Sequence, np.ndarray)) or len(pieces) == 0:
        call.fail(f'pieces = {shown(pieces)} must be a list such as [("line", 1.0), ("up", 0.5, 30.0)]')
    heading = math.radians(call.within("heading_deg", heading_deg, -_MOST_TURN, _MOST_TURN, "deg"))
    slope = math.radians(call.within("slope_deg", slope_deg, -85.0, 85.0, "deg"))
    made = chain(
        np.array(call.position("start", start)), heading, slope, [_piece(call, k, p) for k, p in enumerate(pieces)]
    )
    _not_steep(call, pieces, made)
    return made


def _piece(call: Call, k: int, piece: Sequence[object]) -> tuple[str, tuple[float, ...]]:
    """A piece's kind, and its numbers in metres and radians."""
    where = f"pieces[{k}]"
    if isinstance(piece, (str, bytes)) or not isinstance(piece, Sequence) or len(piece) == 0:
        call.fail(f'{where} = {shown(piece)} must be such as ("line", 1.0)')
    kind, numbers = piece[0], list(piece[1:])
    if kind == "line" and len(numbers) == 1:
        return "line", (call.size(f"{where} length", numbers[0]),)
    if kind == "loop" and len(numbers) == 2:
        return "loop", (
            call.size(f"{where} radius", numbers[0]),
            call.within(f"{where} aside", numbers[1], -MAX_SIZE, MAX_SIZE, "m"),
        )
    if kind in TURNS and len(numbers) == 2:
        radius = call.size(f"{where} radius", numbers[0])
        return str(kind), (radius, math.radians(call.positive(f"{where} angle", numbers[1], _MOST_TURN, "deg")))
    return call.fail(
        f'{where} = {shown(piece)} must be ("line", length), ("loop", radius, aside), or ("up", "down", "left" or '
        '"right", radius, angle_deg)'
    )


def _not_steep(call: Call, pieces: Sequence[Sequence[object]], made: list[Stretch]) -> None:
    """A bend to the side turns about the vertical, and needs a way that is not vertical."""
    for k, (piece, stretch) in enumerate(zip(pieces, made, strict=True)):
        begins = stretch.at(np.zeros(1))
        if piece[0] in ("left", "right") and (abs(begins.along[0, 2]) > _STEEPEST or begins.up[0, 2] <= 0.0):
            call.fail(
                f"pieces[{k}] = {shown(piece)} begins where the track is vertical or upside down; bend it up first"
            )


def _not_through_itself(
    call: Call, pieces: Sequence[Sequence[Any]], made: list[Stretch], sections: list[Section]
) -> None:
    """A piece that goes more than once round passes beside, above or below itself; once round it may be a ring."""
    corners = np.concatenate([section.corner for section in sections])
    wide, high = np.ptp(corners, axis=0)
    for k, (piece, stretch) in enumerate(zip(pieces, made, strict=True)):
        if piece[0] == "loop" and abs(piece[2]) < wide * (1.0 - 1e-9):
            call.fail(
                f"pieces[{k}] aside = {piece[2]:g} m: the loop runs through itself, for the track is {wide:.4g} m wide "
                "with its walls; take as much or more, or a smaller width"
            )
        if piece[0] in ("up", "down") and piece[2] > 360.0:
            call.fail(
                f"pieces[{k}] angle = {piece[2]:g} deg must be <= 360: the bend runs into itself; for once round take "
                '("loop", radius, aside)'
            )
        if piece[0] in ("left", "right") and piece[2] > 360.0:
            ends = stretch.at(np.array([0.0, stretch.length])).point
            rise = abs(float(ends[1, 2] - ends[0, 2])) * 360.0 / piece[2]
            if rise < high:
                call.fail(
                    f"pieces[{k}] angle = {piece[2]:g} deg: the bend runs into itself, for it rises by {rise:.4g} m a "
                    f"turn and the track is {high:.4g} m high; take 360 at most, a steeper slope or a larger radius"
                )


def _through(call: Call, points: Sequence[Sequence[float]]) -> list[Stretch]:
    listed = call.listed("points", points, "a list of (x, y, z) in m")
    if not 2 <= len(listed) <= 2000:
        call.fail(f"points has {len(listed)} points; it must be 2 to 2000")
    places = np.array([call.position(f"points[{k}]", point) for k, point in enumerate(listed)])
    gaps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if gaps.min() < 1e-3:
        k = int(gaps.argmin())
        call.fail(f"points[{k}] and points[{k + 1}] are {gaps[k]:g} m apart; they must be 0.001 m apart or more")
    stretches = spline(places)
    for k, stretch in enumerate(stretches):
        ways = stretch.at(stretch.stations()).along
        if np.abs(ways @ UP).max() > _STEEPEST:
            call.fail(f'points[{k}] to points[{k + 1}] is steeper than 85 deg; build a loop of pieces=[("loop", ...)]')
    return stretches


def _sections(call: Call, profile: str, width: float, wall: float | None, thickness: float) -> list[Section]:
    call.one_of("profile", profile, PROFILES)
    w, t = call.size("width", width), call.size("thickness", thickness)
    if profile == "rails":
        if wall is not None:
            call.fail(f"wall = {shown(wall)} beside rails; leave it out")
        if t >= w:
            call.fail(f"thickness = {t:g} m must be < width = {w:g} m: the rods would touch")
        return rails(w, t)
    if profile == "round":
        return round_(w, w / 2.0 if wall is None else call.positive("wall", wall, 0.95 * w, "m", low=1e-4), t)
    high = 0.0 if wall is None else call.within("wall", wall, 0.0, MAX_SIZE, "m")
    return flat(w, call.size("wall", high) if high else 0.0, t)


def _swept(
    call: Call, stretches: list[Stretch], sections: list[Section], said: Callable[[int], str]
) -> tuple[Floats, list[NDArray[np.int64]], Floats]:
    """Points, faces of four and of three corners, and the normals of their corners."""
    cells = sum(stretch.cells for stretch in stretches) * sum(len(section.corner) for section in sections)
    if cells > 20 * _MOST_CELLS:
        call.fail(f"the track has {cells} faces; at most {20 * _MOST_CELLS}: take fewer points, or make it shorter")
    points: list[Floats] = []
    quads, quad_normals, caps, cap_normals = [], [], [], []
    first = 0
    for section in sections:
        size = len(section.corner)
        rings: list[Floats] = []
        station = 0
        for k, stretch in enumerate(stretches):
            at, onward = sweep(stretch, section.corner)
            frames = stretch.at(stretch.stations())
            if (np.einsum("nmi,ni->nm", onward, frames.along) <= 0.05).any():
                call.fail(
                    f"{said(k)}: a bend is tighter than the track is wide there, {np.ptp(section.corner[:, 0]):.4g} m; "
                    "give it a larger radius, or a smaller width"
                )
            rings.append(at if not rings else at[1:])
            corners, normals = _quads(section, frames, onward, first + station * size)
            quads.append(corners)
            quad_normals.append(normals)
            station += stretch.cells
        points.append(np.concatenate(rings).reshape(-1, 3))
        cap = np.array(section.cap)
        begin, end = stretches[0].at(np.zeros(1)).along[0], stretches[-1].at(np.array([stretches[-1].length])).along[0]
        caps += [first + cap[:, ::-1], first + station * size + cap]
        cap_normals += [np.tile(-begin, (cap.size, 1)), np.tile(end, (cap.size, 1))]
        first += (station + 1) * size
    faces = [np.concatenate(quads), np.concatenate(caps)]
    return np.concatenate(points), faces, np.concatenate([*quad_normals, *cap_normals])


def _quads(section: Section, frames: Frames, onward: Floats, first: int) -> tuple[NDArray[np.int64], Floats]:
    """The faces of one stretch, (F, 4), and their corners' normals, (4 F, 3), outward."""
    size, rings = len(section.corner), len(frames.point)
    k, s = np.meshgrid(np.arange(size), np.arange(rings - 1), indexing="xy")
    after = (k + 1) % size
    # From corner to corner of the outline, then on along the track, and back.
    corners = np.stack([s * size + k, s * size + after, (s + 1) * size + after, (s + 1) * size + k], axis=-1)
    way = (
        section.way[None, ..., :1] * frames.left[:, None, None] + section.way[None, ..., 1:] * frames.up[:, None, None]
    )  # (stations, edges, ends, 3)
    there = np.stack([onward, np.roll(onward, -1, axis=1)], axis=2)
    normals = np.cross(way, there)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    begin, end = normals[:-1], normals[1:]
    found = np.stack([begin[:, :, 0], begin[:, :, 1], end[:, :, 1], end[:, :, 0]], axis=2)
    return first + corners.reshape(-1, 4), found.reshape(-1, 3)
