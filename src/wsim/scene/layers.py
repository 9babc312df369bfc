"""What terrain is made of, layer upon layer: noise, hills, pictures, meshes, ramps, steps, kerbs, levels and roads.

A layer is given the ground so far and returns the ground with it. A function of x and y counts as one, and is added.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wsim.limits import MAX_POSITION, MAX_SIZE
from wsim.scene.errors import one_line
from wsim.scene.mesh_file import MeshFile
from wsim.scene.validate import Call, shown

Floats = NDArray[np.float64]

_MOST_OCTAVES = 10
_MOST_SEED = 2**31 - 1


@dataclass(frozen=True)
class Grid:
    """Where a field is sampled: `x` and `y` (rows, columns) from its middle [m], `cell` (x, y) [m]."""

    x: Floats
    y: Floats
    cell: tuple[float, float]
    folder: Path | None = None  # where files of relative names are

    def bilinear(self, table: Floats) -> Floats:
        """A table (rows, columns) stretched over the whole field, its rows along +Y."""
        rows, columns = table.shape
        u = (self.x / np.ptp(self.x) + 0.5) * (columns - 1)
        v = (self.y / np.ptp(self.y) + 0.5) * (rows - 1)
        return sample(table, u, v)


def sample(table: Floats, u: Floats, v: Floats) -> Floats:
    """A table between its entries, at columns `u` and rows `v`."""
    rows, columns = table.shape
    i = np.clip(np.floor(u).astype(int), 0, max(columns - 2, 0))
    j = np.clip(np.floor(v).astype(int), 0, max(rows - 2, 0))
    a, b = u - i, v - j
    low = (1.0 - a) * table[j, i] + a * table[j, i + 1]
    return (1.0 - b) * low + b * ((1.0 - a) * table[j + 1, i] + a * table[j + 1, i + 1])


class Layer(Protocol):
    """What a layer can do."""

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """The heights (rows, columns) [m] with this layer on `ground`; `SceneError` if a number is out of range."""


@dataclass(frozen=True)
class Noise:
    """Rough ground by gradient noise (Perlin, ACM SIGGRAPH 2002), the same for the same seed, whatever the cells.

    Attributes:
        amplitude: The ground rises and falls by this at most [m]; it seldom comes near it.
        wavelength: Of the largest bumps [m].
        octaves: How many sizes of bump there are, each half as wide as the one before.
        roughness: How high bumps are beside those of twice their width; 0.5 keeps their slope.
        seed: Another gives other ground.
    """

    amplitude: float
    wavelength: float
    octaves: int = 4
    roughness: float = 0.5
    seed: int = 0

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        most = call.within("amplitude", self.amplitude, 0.0, MAX_SIZE, "m")
        wave = call.size("wavelength", self.wavelength)
        count = call.integer("octaves", self.octaves, 1, _MOST_OCTAVES)
        share = call.within("roughness", self.roughness, 0.0, 1.0)
        random = np.random.default_rng(call.integer("seed", self.seed, 0, _MOST_SEED))
        finest = wave / 2 ** (count - 1)
        if finest < 2.0 * max(grid.cell):
            call.fail(
                f"octaves = {count}: the finest bumps are {finest:.3g} m wide, cells {max(grid.cell):.3g} m; take "
                "fewer octaves, a longer wavelength, or cells of half the finest bump"
            )
        total, weights = np.zeros_like(ground), 0.0
        for k in range(count):
            total += share**k * _gradient_noise(grid.x * 2**k / wave, grid.y * 2**k / wave, random)
            weights += share**k
        return ground + most / weights * total


def _gradient_noise(u: Floats, v: Floats, random: np.random.Generator) -> Floats:
    """In -1..1, and 0 where u and v are whole numbers."""
    size = 256
    order = random.permutation(size)
    turn = random.random(size) * 2.0 * math.pi
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j

    def corner(di: int, dj: int) -> Floats:
        way = turn[order[(order[(i + di) % size] + j + dj) % size]]
        return np.asarray(np.cos(way) * (a - di) + np.sin(way) * (b - dj))

    s, t = (w**3 * (w * (6.0 * w - 15.0) + 10.0) for w in (a, b))
    low = (1.0 - s) * corner(0, 0) + s * corner(1, 0)
    high = (1.0 - s) * corner(0, 1) + s * corner(1, 1)
    return np.asarray(math.sqrt(2.0) * ((1.0 - t) * low + t * high))  # unit gradients reach 1 / sqrt(2)


@dataclass(frozen=True)
class Hill:
    """A round hill of one wave of a cosine: height (1 + cos(pi d / radius)) / 2; negative is a hollow.

    Its steepest slope is pi height / (2 radius), halfway up.
    """

    position: Sequence[float]  # (x, y) of its top [m]
    radius: float
    height: float

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        x, y = point(call, "position", self.position)
        radius = call.size("radius", self.radius)
        height = call.within("height", self.height, -MAX_SIZE, MAX_SIZE, "m")
        away = np.minimum(np.hypot(grid.x - x, grid.y - y) / radius, 1.0)
        return ground + height * 0.5 * (1.0 + np.cos(math.pi * away))


@dataclass(frozen=True)
class Image:
    """A picture stretched over the field: black is `low`, white is `high`; its top is the far side, +Y."""

    file: str | Path
    low: float
    high: float

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        low = call.within("low", self.low, -MAX_SIZE, MAX_SIZE, "m")
        high = call.within("high", self.high, -MAX_SIZE, MAX_SIZE, "m")
        if not isinstance(self.file, (str, Path)):
            call.fail(f"file = {shown(self.file)} must be the name of a PNG")
        path = Path(self.file)
        path = path if path.is_absolute() or grid.folder is None else grid.folder / path
        if path.suffix.lower() != ".png" or not path.is_file():
            call.fail(f"file = {shown(str(self.file))} is no PNG file that is there; a relative name starts at the "
                      "program's folder")  # fmt: skip
        from PIL import Image as Picture  # few programs read pictures

        try:
            with Picture.open(path) as picture:
                deep = picture.mode.startswith("I")
                grey = np.asarray(picture if deep else picture.convert("L"), dtype=np.float64)
        except Exception as error:  # noqa: BLE001 - Pillow's readers raise their own kinds
            call.fail(f"file = {shown(path.name)} cannot be read as a picture: {one_line(error)}")
        if min(grey.shape) < 2:
            call.fail(f"file = {shown(path.name)} has {grey.shape[1]} x {grey.shape[0]} pixels; at least 2 x 2")
        share = grey[::-1] / (65535.0 if deep else 255.0)
        return ground + low + (high - low) * grid.bilinear(share)


@dataclass(frozen=True)
class Surface:
    """The upper side of a mesh's triangles, in the field's own frame; nothing is added where the mesh is not."""

    file: str | Path
    scale: float | Sequence[float] = 1.0
    up_axis: str = "Z"

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        mesh = MeshFile.read(call, self.file, grid.folder, scale=self.scale, up_axis=self.up_axis).mesh
        corners = np.asarray(mesh.vertices)[np.asarray(mesh.faces)]
        top = np.full(ground.shape, -np.inf)
        x, y = grid.x[0], grid.y[:, 0]
        for a, b, c in corners:
            area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
            if abs(area) < 1e-12:
                continue  # upright: its upper edge is its neighbours'
            (left, near), (right, far) = np.min([a, b, c], axis=0)[:2], np.max([a, b, c], axis=0)[:2]
            columns = slice(*np.searchsorted(x, (left - 1e-9, right + 1e-9)))
            rows = slice(*np.searchsorted(y, (near - 1e-9, far + 1e-9)))
            px, py = grid.x[rows, columns], grid.y[rows, columns]
            s = ((px - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (py - a[1])) / area
            t = ((b[0] - a[0]) * (py - a[1]) - (px - a[0]) * (b[1] - a[1])) / area
            inside = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1.0 + 1e-9)
            there = np.where(inside, a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]), -np.inf)
            top[rows, columns] = np.maximum(top[rows, columns], there)
        if not np.isfinite(top).any():
            call.fail(f"file = {shown(str(self.file))} has no triangle over the field, which is centred on its origin")
        return np.asarray(ground + np.where(np.isfinite(top), top, 0.0))


@dataclass(frozen=True)
class Ramp:
    """A slope that gains `rise` from `start` to `end`, (x, y) [m], `width` wide, and ends there; or goes on.

    `beyond` is how far it goes on level behind its end [m]. Its sides and its end are as steep as one cell allows.
    """

    start: Sequence[float]
    end: Sequence[float]
    width: float
    rise: float
    beyond: float = 0.0

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        x, y = point(call, "start", self.start)
        far = point(call, "end", self.end)
        length = math.hypot(far[0] - x, far[1] - y)
        if length < 1e-3:
            call.fail(f"end = {shown(self.end)} is where it starts; a ramp is at least 0.001 m long")
        half = 0.5 * call.size("width", self.width)
        rise = call.within("rise", self.rise, -MAX_SIZE, MAX_SIZE, "m")
        beyond = call.within("beyond", self.beyond, 0.0, MAX_POSITION, "m")
        cosine, sine = (far[0] - x) / length, (far[1] - y) / length
        along = (grid.x - x) * cosine + (grid.y - y) * sine
        aside = np.abs((grid.y - y) * cosine - (grid.x - x) * sine)
        inside = (aside <= half + 1e-9) & (along >= 0.0) & (along <= length + beyond + 1e-9)
        return ground + np.where(inside, rise * np.minimum(along / length, 1.0), 0.0)


@dataclass(frozen=True)
class Step:
    """Ground that is higher by `height` [m] ahead of a line through `position`, (x, y) [m], that faces `heading_deg`.

    The rise takes one cell.
    """

    position: Sequence[float]
    height: float
    heading_deg: float = 0.0

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        x, y = point(call, "position", self.position)
        height = call.within("height", self.height, -MAX_SIZE, MAX_SIZE, "m")
        way = math.radians(call.within("heading_deg", self.heading_deg, -3600.0, 3600.0, "deg"))
        ahead = (grid.x - x) * math.cos(way) + (grid.y - y) * math.sin(way)
        return ground + np.where(ahead > -1e-9, height, 0.0)


@dataclass(frozen=True)
class Kerb:
    """A band along points, (x, y) [m] each, that is higher by `height`, `width` wide [m]; its sides take one cell."""

    points: Sequence[Sequence[float]] = field(default_factory=list)
    height: float = 0.12
    width: float = 0.5

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Add it."""
        line = polyline(call, self.points)
        height = call.within("height", self.height, -MAX_SIZE, MAX_SIZE, "m")
        width = call.size("width", self.width)
        if width < max(grid.cell):
            call.fail(f"width = {width:g} m is narrower than a cell, {max(grid.cell):g} m; take finer cells or a box")
        away, _ = nearest(line, grid.x, grid.y)
        return ground + np.where(away <= 0.5 * width + 1e-9, height, 0.0)


@dataclass(frozen=True)
class Level:
    """A level place: a disc of `radius` about `position`, (x, y) [m], at `height`, or at what its middle has.

    Around it the ground goes over to what was there within `blend` [m].
    """

    position: Sequence[float]
    radius: float
    height: float | None = None
    blend: float = 3.0

    def laid(self, call: Call, grid: Grid, ground: Floats) -> Floats:
        """Lay it in."""
        x, y = point(call, "position", self.position)
        radius = call.size("radius", self.radius)
        blend = call.within("blend", self.blend, 0.0, MAX_SIZE, "m")
        away = np.hypot(grid.x - x, grid.y - y)
        if self.height is None:
            height = float(ground.reshape(-1)[away.argmin()])
        else:
            height = call.within("height", self.height, -MAX_SIZE, MAX_SIZE, "m")
        return blended(ground, height, away - radius, blend)


def blended(ground: Floats, inner: Floats | float, beyond: Floats, blend: float) -> Floats:
    """`inner` where `beyond` <= 0, the ground where it is more than `blend`, and a smooth step between them."""
    share = np.clip(beyond / max(blend, 1e-9), 0.0, 1.0)
    share = share * share * (3.0 - 2.0 * share)
    return np.asarray(share * ground + (1.0 - share) * inner)


def point(call: Call, name: str, value: object) -> tuple[float, float]:
    """A place (x, y) [m]."""
    listed = call.listed(name, value, "(x, y) in m")
    if len(listed) != 2:
        call.fail(f"{name} = {shown(value)} has {len(listed)} numbers; it must be 2: (x, y) in m")
    return (
        call.within(f"{name}[0]", listed[0], -MAX_POSITION, MAX_POSITION, "m"),
        call.within(f"{name}[1]", listed[1], -MAX_POSITION, MAX_POSITION, "m"),
    )


def polyline(call: Call, points: object, name: str = "points", least: int = 2, most: int = 2000) -> Floats:
    """Points (x, y) [m], (N, 2), no two after another in one place."""
    listed = call.listed(name, points, "a list of (x, y) in m")
    if not least <= len(listed) <= most:
        call.fail(f"{name} has {len(listed)} points; it must be {least} to {most}")
    line = np.array([point(call, f"{name}[{k}]", each) for k, each in enumerate(listed)])
    gaps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    if gaps.min() < 1e-3:
        k = int(gaps.argmin())
        call.fail(f"{name}[{k}] and {name}[{k + 1}] are {gaps[k]:g} m apart; they must be 0.001 m apart or more")
    return line


def nearest(line: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Distance to a line of points (N, 2), and how far along it the nearest place is, both as `x` [m]."""
    away, along = np.full(x.shape, np.inf), np.zeros(x.shape)
    done = 0.0
    for a, b in itertools.pairwise(line):
        length = math.hypot(*(b - a))
        way = (b - a) / length
        s = np.clip((x - a[0]) * way[0] + (y - a[1]) * way[1], 0.0, length)
        there = np.hypot(x - a[0] - s * way[0], y - a[1] - s * way[1])
        nearer = there < away
        away[nearer], along[nearer] = there[nearer], (done + s)[nearer]
        done += length
    return away, along
