"""Terrain that is put together from layers, split by area into surfaces, and things that are scattered on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from pxr import UsdGeom

from wsim.limits import MAX_SIZE
from wsim.scene.areas import Area, closed, divided
from wsim.scene.authoring import Handle, calling_folder, note_line, set_pose
from wsim.scene.bodies import finish_collider
from wsim.scene.height_fields import HeightFields, edges, top_of
from wsim.scene.layers import Floats, Grid, Layer, sample
from wsim.scene.materials import Material
from wsim.scene.static_mesh import define_mesh, smooth_normals
from wsim.scene.validate import Call, Vec3, shown

Integers = NDArray[np.int64]
Height = Callable[[float, float], float]

_MOST = 1000  # cells along x, or y


@dataclass(frozen=True)
class Terrain(Handle):
    """Terrain, and what it is like at a place (x, y) of the world [m]: by its triangles, which curves leave by R
    cell² / 8 at most, R their curvature."""

    _heights: Floats = field(repr=False, compare=False)  # (rows, columns), along +X and along +Y
    _size: tuple[float, float] = field(repr=False, compare=False)
    _middle: Vec3 = field(repr=False, compare=False)

    def height(self, x: float, y: float) -> float:
        """Of the ground there, in the world [m]; `SceneError` where there is none."""
        return self._plane(x, y)[0]

    def heights(self, x: Floats, y: Floats) -> Floats:
        """Of the ground at each x and y (arrays of one shape), bilinear within a cell, in the world [m]."""
        rows, columns = self._heights.shape
        u = ((x - self._middle[0]) / self._size[0] + 0.5) * (columns - 1)
        v = ((y - self._middle[1]) / self._size[1] + 0.5) * (rows - 1)
        return np.asarray(self._middle[2] + sample(self._heights, u, v))

    def place(self, x: float, y: float, above: float = 0.0) -> Vec3:
        """A point of the ground, or straight above it [m]."""
        ground, rise = self._plane(x, y)[0], self._call().number("above", above, "m")
        return float(x), float(y), ground + rise

    def normal(self, x: float, y: float) -> Vec3:
        """Which way the ground faces there, of length 1."""
        _, along, aside = self._plane(x, y)
        length = math.sqrt(1.0 + along * along + aside * aside)
        return -along / length, -aside / length, 1.0 / length

    def slope_deg(self, x: float, y: float, heading_deg: float | None = None) -> float:
        """How steep the ground is there [deg]: at the steepest, or towards a heading (from +X to +Y), up positive."""
        _, along, aside = self._plane(x, y)
        if heading_deg is None:
            return math.degrees(math.atan(math.hypot(along, aside)))
        way = math.radians(self._call().number("heading_deg", heading_deg, "deg"))
        return math.degrees(math.atan(along * math.cos(way) + aside * math.sin(way)))

    def has(self, x: float, y: float, margin: float = 0.0) -> bool:
        """Whether it is there, and for `margin` [m] all around."""
        call = self._call()
        kept = call.number("margin", margin, "m")
        off = call.number("x", x, "m") - self._middle[0], call.number("y", y, "m") - self._middle[1]
        return all(abs(each) <= 0.5 * edge - kept for each, edge in zip(off, self._size, strict=True))

    @property
    def count(self) -> int:
        """How many corners its surface has."""
        return int(self._heights.size)

    @property
    def cells(self) -> tuple[int, int]:
        """How many there are along y, and along x."""
        rows, columns = self._heights.shape
        return rows - 1, columns - 1

    @property
    def reach(self) -> float:
        """From its middle to its nearest edge [m]."""
        return 0.5 * min(self._size)

    def anywhere(self, random: np.random.Generator, margin: float) -> tuple[float, float]:
        """A place on it by chance, `margin` or more from its edges [m]; its middle, where it is too small for that."""
        reach = [max(0.0, 0.5 * edge - margin) for edge in self._size]
        x, y = (float(random.uniform(-each, each)) + self._middle[k] for k, each in enumerate(reach))
        return x, y

    def _call(self) -> Call:
        return Call("terrain", self.name)

    def _plane(self, x: float, y: float) -> tuple[float, float, float]:
        """The triangle under a place: its height there [m], and how it rises along x and y."""
        call = self._call()
        u, v = call.number("x", x, "m") - self._middle[0], call.number("y", y, "m") - self._middle[1]
        if not self.has(x, y, -1e-9):
            call.fail(f"({x:g}, {y:g}) m is not on it: it is {self._size[0]:g} x {self._size[1]:g} m about "
                      f"({self._middle[0]:g}, {self._middle[1]:g})")  # fmt: skip
        rows, columns = self._heights.shape
        cell = self._size[0] / (columns - 1), self._size[1] / (rows - 1)
        u, v = (u + 0.5 * self._size[0]) / cell[0], (v + 0.5 * self._size[1]) / cell[1]
        i, j = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
        s, t = u - i, v - j
        (a, b), (d, c) = self._heights[j : j + 2, i : i + 2]
        if abs(a - c) <= abs(b - d):  # cut from a to c
            along, aside = (b - a, c - b) if s >= t else (c - d, d - a)
            here = a + s * along + t * aside
        elif s + t <= 1.0:
            along, aside = b - a, d - a
            here = a + s * along + t * aside
        else:
            along, aside = c - d, c - b
            here = c - (1.0 - s) * along - (1.0 - t) * aside
        return self._middle[2] + float(here), float(along / cell[0]), float(aside / cell[1])


class Terrains(HeightFields):
    """The call that makes terrain of layers."""

    def terrain(
        self,
        name: str,
        *,
        size: Sequence[float],
        layers: Sequence[Layer | Height | Sequence[Sequence[float]] | Floats],
        cell: float = 0.5,
        areas: Sequence[Area] = (),
        position: Sequence[float] = (0.0, 0.0, 0.0),
        thickness: float = 1.0,
        smooth_deg: float = 20.0,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        rolling_friction: float | None = None,
        color: Sequence[float] | None = None,
    ) -> Terrain:
        """Make ground from layers, one upon another, that never moves.

        Args:
            name: Name of the prim.
            size: (x, y) of the terrain [m].
            layers: From the lowest on. `Noise`, `Hill`, `Image`, `Surface` (a mesh), `Ramp`, `Step` and `Kerb` add to
                what is there, as do a function of x and y and rows x columns of heights [m], which are stretched
                over the field; `Level` and `Road` are laid into it. All count x and y from the terrain's middle [m].
            cell: Edge of a cell at most [m]: half of what is to show.
            areas: Parts with a surface of their own; a later one covers an earlier one.
            position: Of the terrain's middle at height 0 [m].
            thickness: How far the ground goes on below its lowest point [m].
            smooth_deg: Where cells meet at a smaller angle they stand for a curve; 0: all are flat [deg].
            material: What `scene.material` returned, or its name.
            friction: Overrides the material's.
            restitution: Overrides the material's.
            rolling_friction: Overrides the material's rolling.
            color: Linear RGB; overrides the material's.

        Returns:
            A handle that knows the ground's height, slope and normal at a place.

        Raises:
            SceneError: If a layer or a number is out of range, there are more than 1000 cells along x or y, or an
                area holds no cell.
        """
        call = Call("terrain", name)
        path = self._path(call)
        grid, ground = _surveyed(call, path, size, layers, cell, position)
        heights, across, place = ground._heights, ground._size, ground._middle
        depth = call.size("thickness", thickness)
        smooth = math.radians(call.within("smooth_deg", smooth_deg, 0.0, 90.0, "deg"))
        middles = (0.25 * (g[:-1, :-1] + g[:-1, 1:] + g[1:, :-1] + g[1:, 1:]) for g in (grid.x, grid.y))
        listed, number = divided(call, areas, *middles)
        for k, area in enumerate(listed):  # before anything is authored
            self._named(Call(call.method, name, f"areas[{k}]."), area.material)
        base = self._surface(call, material, friction, restitution, color, rolling=rolling_friction)
        surfaces = [base, *(self._surface_of(call, k, area, base) for k, area in enumerate(listed))]
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, place)
        points, cells = top_of(heights, across)
        normals = smooth_normals(points, cells.reshape(-1, 3), smooth).reshape(-1, 2, 3, 3) if smooth > 0.0 else None
        low = float(heights.min()) - depth
        for k, surface in enumerate(surfaces):
            part = np.flatnonzero(number.reshape(-1) == k)
            if len(part):
                called = listed[k - 1].name if k else "geometry"
                self._part(f"{path}/{called}", points, cells[part], None if normals is None else normals[part], low,
                           surface)  # fmt: skip
        return ground

    def _surface_of(self, call: Call, k: int, area: Area, base: Material) -> Material:
        one = Call(call.method, f"{call.name}_{area.name}", f"areas[{k}].")
        return self._surface(one, base if area.material is None else area.material, area.friction, area.restitution,
                             area.color, rolling=area.rolling_friction)  # fmt: skip

    def _part(
        self, path: str, points: Floats, cells: Integers, normals: Floats | None, low: float, surface: Material
    ) -> None:  # fmt: skip
        """One surface of the terrain, as a closed mesh whose upper side may stand for a curve."""
        top = cells.reshape(-1, 3)
        corners, faces, _ = closed(points, top, low)
        written = None
        if normals is not None:
            rest = corners[faces[len(top) :]]
            flat = np.cross(rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0])
            flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-300)
            written = np.concatenate([normals.reshape(-1, 3), np.repeat(flat, 3, axis=0)])
        mesh = define_mesh(self._stage, path, corners, [faces], written).GetPrim()
        note_line(mesh)
        finish_collider(mesh, surface)


def surveyed(
    name: str, *, size: Sequence[float], layers: Sequence[Layer], cell: float = 0.5
) -> Terrain:  # fmt: skip
    """What knows the ground that `scene.terrain` makes of the same, about the origin; without a stage.

    Raises:
        SceneError: As `scene.terrain`.
    """
    return _surveyed(Call("terrain", name), f"/World/{name}", size, layers, cell, (0.0, 0.0, 0.0))[1]


def _surveyed(
    call: Call, path: str, size: Sequence[float], layers: object, cell: float, position: Sequence[float]
) -> tuple[Grid, Terrain]:  # fmt: skip
    across = edges(call, size)
    grid = _grid(call, across, call.size("cell", cell))
    heights = _laid(call, layers, grid)
    place = call.position("position", position)
    return grid, Terrain(path.rpartition("/")[2], path, "static", heights, across, place)


def _grid(call: Call, across: tuple[float, float], cell: float) -> Grid:
    counts = [max(1, math.ceil(edge / cell - 1e-9)) for edge in across]
    if max(counts) > _MOST:
        call.fail(f"cell = {cell:g} m gives {max(counts)} cells along {max(across):g} m; at most {_MOST}: take "
                  f"{max(across) / _MOST:.3g} m or more")  # fmt: skip
    x, y = np.meshgrid(*(np.linspace(-0.5 * edge, 0.5 * edge, n + 1) for edge, n in zip(across, counts, strict=True)))
    return Grid(x, y, (across[0] / counts[0], across[1] / counts[1]), calling_folder())


def _laid(call: Call, layers: object, grid: Grid) -> Floats:
    listed = call.listed("layers", layers, "a list such as [Noise(0.3, 8.0), Hill((20, 0), 15, 3)]")
    if not listed:
        call.fail("layers = [] holds none; lambda x, y: 0.0 is level ground")
    ground = np.zeros_like(grid.x)
    for k, layer in enumerate(listed):
        one = Call(call.method, call.name, f"layers[{k}].")
        if hasattr(layer, "laid") and not isinstance(layer, type):
            ground = layer.laid(one, grid, ground)
        elif callable(layer) and not isinstance(layer, type):
            ground = ground + _function(call, k, layer, grid)
        else:
            ground = ground + grid.bilinear(_listed(call, k, layer))
    bad = ~(np.abs(ground) <= MAX_SIZE)
    if bad.any():
        row, column = np.argwhere(bad)[0]
        call.fail(f"layers are {ground[row, column]:g} m high at ({grid.x[row, column]:g}, {grid.y[row, column]:g}); "
                  f"they must be within {MAX_SIZE:g} m of 0")  # fmt: skip
    return ground


def _function(call: Call, k: int, height: Height, grid: Grid) -> Floats:
    """A function of x and y, asked at each place."""

    def asked(x: float, y: float) -> float:
        try:
            found = height(x, y)
        except Exception as error:  # noqa: BLE001 - whatever a program's own function raises
            call.fail(f"layers[{k}]({x:g}, {y:g}) raised {type(error).__name__}: {error}; give a function of x and y "
                      "in m, within the terrain, that returns a height in m")  # fmt: skip
        return call.number(f"layers[{k}](x, y)", found, "m")

    return np.array([[asked(float(x), float(y)) for x, y in zip(*row, strict=True)] for row in
                     zip(grid.x, grid.y, strict=True)])  # fmt: skip


def _listed(call: Call, k: int, layer: object) -> Floats:
    """Rows x columns of heights."""
    try:
        given = np.array(layer)
    except (TypeError, ValueError):  # rows of different lengths
        given = np.array(None)
    if given.dtype.kind not in "iuf" or given.ndim != 2 or min(given.shape) < 2 or max(given.shape) > _MOST + 1:
        call.fail(f"layers[{k}] = {shown(layer)} must be a layer such as Noise(0.3, 8.0), a function of x and y, or "
                  f"rows x columns of 2 x 2 to {_MOST + 1} x {_MOST + 1} heights")  # fmt: skip
    if not np.isfinite(given).all():
        row, column = np.argwhere(~np.isfinite(given))[0]
        call.fail(f"layers[{k}][{row}][{column}] = {given[row, column]} must be finite in m")
    return given.astype(np.float64)
