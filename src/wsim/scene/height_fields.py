"""Height fields: ground that rises and falls, from an array or a function."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf, UsdGeom

from wsim.limits import MAX_SIZE
from wsim.scene import schema
from wsim.scene.authoring import Handle, note_line, set_pose
from wsim.scene.bodies import finish_collider
from wsim.scene.compounds import Compounds
from wsim.scene.static_mesh import define_mesh, smooth_normals
from wsim.scene.validate import Call, shown

Floats = NDArray[np.float64]

_MOST = 1000  # rows, or columns


class HeightFields(Compounds):
    """The call that makes a height field."""

    def height_field(
        self,
        name: str,
        *,
        heights: Sequence[Sequence[float]] | NDArray[np.float64] | Callable[[float, float], float],
        size: Sequence[float],
        cells: Sequence[int] | None = None,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        thickness: float = 0.2,
        smooth_deg: float = 20.0,
        material: Handle | str | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        color: Sequence[float] | None = None,
    ) -> Handle:
        """Make ground that rises and falls and never moves.

        Args:
            name: Name of the prim.
            heights: Rows x columns of heights [m], columns along +X and rows along +Y, from the corner of least x
                and y; or a function of x and y [m], counted from the field's middle, that is sampled.
            size: (x, y) of the field [m].
            cells: How many cells a function is sampled in, along x and y; (50, 50) if not given.
            position: Of the field's middle at height 0 [m].
            thickness: How far the ground goes on below its lowest point [m].
            smooth_deg: Where cells meet at a smaller angle they stand for a curve; 0: all are flat [deg].
            material: What `scene.material` returned, or its name.
            friction: Overrides the material's.
            restitution: Overrides the material's.
            color: Linear RGB; overrides the material's.

        Raises:
            SceneError: If the heights are no field of 2 x 2 to 1000 x 1000 finite numbers, or a number is out of range.
        """
        call = Call("height_field", name)
        path = self._path(call)
        across = edges(call, size)
        field = _field(call, heights, across, cells)
        place = call.position("position", position)
        depth = call.size("thickness", thickness)
        smooth = math.radians(call.within("smooth_deg", smooth_deg, 0.0, 90.0, "deg"))
        surface = self._surface(call, material, friction, restitution, color)
        points, triangles = _solid(field, across, depth)
        normals = smooth_normals(points, triangles, smooth).reshape(-1, 3) if smooth > 0.0 else None
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, place)
        mesh = define_mesh(self._stage, f"{path}/geometry", points, [triangles], normals).GetPrim()
        note_line(mesh)
        rows, columns = field.shape
        kinds = Sdf.ValueTypeNames
        schema.apply(
            mesh,
            schema.HEIGHT_FIELD,
            {
                "rows": (kinds.Int, rows),
                "columns": (kinds.Int, columns),
                "fieldSize": (kinds.Float2, Gf.Vec2f(*across)),
            },
        )
        finish_collider(mesh, surface)
        return Handle(name=prim.GetName(), path=path, kind="static")


def edges(call: Call, size: Sequence[float]) -> tuple[float, float]:
    """(x, y) of a field [m]."""
    if isinstance(size, (str, bytes)) or not isinstance(size, (Sequence, np.ndarray)) or len(size) != 2:
        call.fail(f"size = {shown(size)} must be 2 numbers (x, y) in m")
    return call.size("size[0]", size[0]), call.size("size[1]", size[1])


def _field(call: Call, heights: object, across: tuple[float, float], cells: Sequence[int] | None) -> Floats:
    if not callable(heights) and cells is not None:
        call.fail(f"cells = {shown(cells)} beside heights that are listed; leave it out")
    if callable(heights):
        cells = (50, 50) if cells is None else cells
        if isinstance(cells, (str, bytes)) or not isinstance(cells, (Sequence, np.ndarray)) or len(cells) != 2:
            call.fail(f"cells = {shown(cells)} must be 2 whole numbers, along x and y")
        nx, ny = (call.integer(f"cells[{k}]", n, 1, _MOST - 1) for k, n in enumerate(cells))
        xs, ys = (np.linspace(-edge / 2, edge / 2, n + 1) for edge, n in zip(across, (nx, ny), strict=True))
        heights = [[_height(call, heights, float(x), float(y)) for x in xs] for y in ys]
    try:
        given = np.array(heights)
    except (TypeError, ValueError):  # rows of different lengths
        given = np.array(None)
    if given.dtype.kind not in "iuf":
        call.fail(f"heights = {shown(heights)} must be rows x columns of numbers, all rows as long")
    field = given.astype(np.float64)
    if field.ndim != 2 or min(field.shape) < 2 or max(field.shape) > _MOST:
        call.fail(f"heights has the shape {field.shape}; it must be 2 x 2 to {_MOST} x {_MOST}")
    bad = ~(np.abs(field) <= MAX_SIZE)
    if bad.any():
        row, column = np.argwhere(bad)[0]
        call.fail(f"heights[{row}][{column}] = {field[row, column]:g} must be within {MAX_SIZE:g} m of 0")
    return field


def _height(call: Call, heights: Callable[[float, float], object], x: float, y: float) -> float:
    try:
        height = heights(x, y)
    except Exception as error:  # noqa: BLE001 - whatever a program's own function raises
        call.fail(
            f"heights({x:g}, {y:g}) raised {type(error).__name__}: {error}; "
            "give a function of x and y in m, within the field, that returns a height in m"
        )
    return call.number("heights(x, y)", height, "m")


def _solid(field: Floats, across: tuple[float, float], depth: float) -> tuple[Floats, NDArray[np.int64]]:
    """The ground as a closed mesh: the field, four sides and a bottom."""
    top, triangles = top_of(field, across)
    rows, columns = field.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    low = np.full(len(rim), float(field.min()) - depth)
    under = np.column_stack([top[rim, :2], low])
    below = rows * columns + np.arange(len(rim))
    after, below_after = np.roll(rim, -1), np.roll(below, -1)
    sides = np.concatenate([np.stack([rim, below, below_after], 1), np.stack([rim, below_after, after], 1)])
    middle = rows * columns + len(rim)
    floor = np.stack([np.full(len(rim), middle), below_after, below], 1)
    points = np.concatenate([top, under, [[0.0, 0.0, low[0]]]])
    return points, np.concatenate([triangles[:, 0], triangles[:, 1], sides, floor])


def top_of(field: Floats, across: tuple[float, float]) -> tuple[Floats, NDArray[np.int64]]:
    """A field's points (rows * columns, 3), row by row, and of each of its cells the two triangles (cells, 2, 3)."""
    rows, columns = field.shape
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, columns) * across[0], np.linspace(-0.5, 0.5, rows) * across[1])
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.reshape(-1) for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    # Each cell is cut along the diagonal that is the more level.
    z = field.reshape(-1)
    along = (np.abs(z[a] - z[c]) <= np.abs(z[b] - z[d]))[:, None]
    one = np.where(along, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    two = np.where(along, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    return np.stack([x, y, field], axis=2).reshape(-1, 3), np.stack([one, two], axis=1)
