"""The two drawings as text: a letter for each object, in a frame of box-drawing characters, with a legend."""

from __future__ import annotations

import math
import string
from dataclasses import dataclass, field

from wsim.plan.drawing.silhouettes import Point, Scene, Silhouette, View, scene_of
from wsim.plan.schema import Plan

LETTERS = string.ascii_uppercase + string.ascii_lowercase + string.digits
CROWD = "#"  # for each object beyond the letters
ASPECT = 2.0  # a character's height over its width
NARROWEST, WIDEST = 30, 100  # columns of a drawing
ROWS: dict[View, int] = {"above": 22, "side": 14}
HEADS: dict[View, str] = {
    "above": "from above   ↑ LEFT (+Y)   → FRONT (+X)",
    "side": "side, from the right   ↑ UP (+Z)   → FRONT (+X)",
}
FLUID = "~"


def draw_text(plan: Plan, width: int = WIDEST) -> str:
    """Both views and their legend.

    The same plan and width give the same text.

    Args:
        plan: A laid-out plan.
        width: Columns that there are; no line is longer, down to 30.
    """
    scene = scene_of(plan)
    letters = _letters(plan, scene)
    room = max(min(width, WIDEST), NARROWEST) - 2
    cell = _cell(scene, room)
    columns = min(room, max(math.ceil((scene.high[0] - scene.low[0]) / cell) + 4, NARROWEST - 2))
    parts = []
    for view in ("above", "side"):
        grid = _Grid(scene, view, cell, columns)
        for one in scene.views[view]:
            grid.paint(one, letters[one.name])
        parts.append(f"{HEADS[view]}\n{grid.text()}")
    return "\n".join([*parts, _scale(cell, columns), *_legend(letters, room + 2)])


def _letters(plan: Plan, scene: Scene) -> dict[str, str]:
    """What stands for each object, in the plan's order."""
    styles = {one.name: one.style for one in scene.views["above"]}
    letters: dict[str, str] = {}
    free = iter(LETTERS)
    for item in plan.objects:
        if item.name in styles:
            letters[item.name] = FLUID if styles[item.name] == "fluid" else next(free, CROWD)
    return letters


def _cell(scene: Scene, columns: int) -> float:
    """Width of a character [m]: the scene, and a character of margin round it, fits the columns and rows."""
    x, y, z = (high - low for low, high in zip(scene.low, scene.high, strict=True))
    return max(x / (columns - 2), y / (ROWS["above"] - 2) / ASPECT, z / (ROWS["side"] - 2) / ASPECT, 1e-9)


@dataclass
class _Grid:
    scene: Scene
    view: View
    cell: float  # [m]
    columns: int
    rows: list[list[str]] = field(init=False)
    left: float = field(init=False)
    top: float = field(init=False)

    def __post_init__(self) -> None:
        up = 1 if self.view == "above" else 2
        low, high = self.scene.low, self.scene.high
        tall = max(1, math.ceil((high[up] - low[up]) / self.cell / ASPECT - 1e-6))
        self.rows = [[" "] * self.columns for _ in range(tall + 1)]
        self.left = (low[0] + high[0]) / 2 - self.cell * self.columns / 2
        self.top = low[up] + tall * self.cell * ASPECT
        if self.view == "side" and self.scene.ground is not None:
            row = round((self.top - self.scene.ground) / self.cell / ASPECT)
            if 0 <= row < len(self.rows):
                self.rows[row] = ["▔"] * self.columns

    def paint(self, one: Silhouette, letter: str) -> None:
        """Fill what it covers; an upright rectangle that is large enough is an outline with its letter inside."""
        cells = self._covered(one)
        rows, columns = {row for row, _ in cells}, {column for _, column in cells}
        outlined = one.style in ("glass", "wide") or (one.upright and len(rows) > 2 and len(columns) > 4)
        if one.style == "fluid":
            for row, column in cells:
                self.rows[row][column] = letter
        elif outlined and one.upright and len(rows) > 1 and len(columns) > 1:
            self._outline(one, letter, min(rows), max(rows), min(columns), max(columns))
        else:
            for row, column in cells:
                self.rows[row][column] = letter

    def _covered(self, one: Silhouette) -> list[tuple[int, int]]:
        (left, bottom), (right, top) = one.low, one.high
        first, last = self._column(left), self._column(right)
        upper, lower = self._row(top), self._row(bottom)
        inside = [
            (row, column)
            for row in range(max(upper, 0), min(lower, len(self.rows) - 1) + 1)
            for column in range(max(first, 0), min(last, self.columns - 1) + 1)
            if _contains(one.points, self._centre(row, column))
        ]
        if inside:
            return inside
        row, column = self._row((top + bottom) / 2), self._column((left + right) / 2)  # smaller than a character
        return [(min(max(row, 0), len(self.rows) - 1), min(max(column, 0), self.columns - 1))]

    def _outline(self, one: Silhouette, letter: str, top: int, bottom: int, left: int, right: int) -> None:
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                edges = (row in (top, bottom), column in (left, right))
                if edges == (True, True):
                    corner = {(top, left): "┌", (top, right): "┐", (bottom, left): "└", (bottom, right): "┘"}
                    self.rows[row][column] = corner[row, column]
                elif any(edges):
                    self.rows[row][column] = "─" if edges[0] else "│"
                elif one.style == "solid":
                    self.rows[row][column] = " "
        if one.style == "solid":
            self.rows[(top + bottom) // 2][(left + right) // 2] = letter
        else:  # in its frame: what is inside would cover it
            self.rows[top][min(left + 2, right)] = letter

    def _column(self, x: float) -> int:
        return math.floor((x - self.left) / self.cell)

    def _row(self, v: float) -> int:
        return math.floor((self.top - v) / self.cell / ASPECT)

    def _centre(self, row: int, column: int) -> Point:
        return self.left + (column + 0.5) * self.cell, self.top - (row + 0.5) * self.cell * ASPECT

    def text(self) -> str:
        """The rows in a frame."""
        while len(self.rows) > 1 and not "".join(self.rows[-1]).strip():
            self.rows.pop()
        lines = [f"│{''.join(row)}│" for row in self.rows]
        return "\n".join([f"┌{'─' * self.columns}┐", *lines, f"└{'─' * self.columns}┘"])


def _contains(points: tuple[Point, ...], at: Point) -> bool:
    """Whether a point is in a convex outline, anticlockwise."""
    if len(points) < 3:
        return False
    for (ax, ay), (bx, by) in zip(points, (*points[1:], points[0]), strict=True):
        if (bx - ax) * (at[1] - ay) - (by - ay) * (at[0] - ax) < -1e-12:
            return False
    return True


def nice(length: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is no longer than a length [m]."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= length * (1 + 1e-9))


def _scale(cell: float, columns: int) -> str:
    length = nice(cell * columns / 4)
    return f"├{'─' * max(0, round(length / cell) - 2)}┤ {length:g} m"


def _legend(letters: dict[str, str], width: int) -> list[str]:
    entries = [f"{letter} {name}" for name, letter in letters.items() if letter != CROWD]
    crowd = len(letters) - len(entries)
    if crowd:
        entries.append(f"{CROWD} {crowd} more")
    lines: list[str] = []
    for entry in entries:
        cut = entry if len(entry) <= width else entry[: width - 1] + "…"
        if lines and len(lines[-1]) + 3 + len(cut) <= width:
            lines[-1] += f"   {cut}"
        else:
            lines.append(cut)
    return lines
