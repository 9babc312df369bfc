"""The two drawings as a picture: PNG by Pillow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw, ImageFont

from wsim.geometry.colour import srgb_of
from wsim.plan.drawing.labels import Rect, Wanted, place, together
from wsim.plan.drawing.silhouettes import Point, Scene, Silhouette, View, scene_of
from wsim.plan.drawing.text import nice
from wsim.plan.schema import Plan, Vec3

FONT = Path(__file__).parent / "fonts" / "DejaVuSans.ttf"
WIDTH = 1100  # [pixels] of the picture
FINE = 2  # drawn this many times as large, then reduced: smooth edges
TALLEST: dict[View, int] = {"above": 620, "side": 420}  # [pixels] of a view
LEAST = 130  # and at least
EDGE, HEAD = 46, 34  # room round a view for its scale, and over it for its heading [pixels]
MOST_NAMES = 60  # in a view; more could not be read
INK, FAINT, PAPER = (30, 34, 40), (226, 229, 233), (255, 255, 255)
HEADS: dict[View, tuple[str, str, str]] = {
    "above": ("From above", "FRONT (+X)", "LEFT (+Y)"),  # a red wedge: where a thing looks
    "side": ("Side, from the right", "FRONT (+X)", "UP (+Z)"),
}


def draw_picture(plan: Plan, path: str | Path) -> None:
    """Write both views of a laid-out plan as PNG, to a side name first; the same plan gives the same bytes.

    Both views have one scale, so that what is above the other is at the same place along X.

    Raises:
        OSError: The file cannot be written.
    """
    path = Path(path)
    scene = scene_of(plan)
    scale, heights = _scale(scene)
    whole = 2 * HEAD + sum(heights.values()) + 2 * EDGE + 40
    image = Image.new("RGB", (WIDTH * FINE, whole * FINE), PAPER)
    draw = ImageDraw.Draw(image, "RGBA")
    _title(draw, plan.title)
    top = 40
    for view in ("above", "side"):
        _Panel(draw, scene, view, scale, top + HEAD, heights[view]).draw_all()
        top += HEAD + heights[view] + EDGE
    side = path.with_name(path.name + ".part")
    image.reduce(FINE).save(side, format="PNG", compress_level=3)
    side.replace(path)


def _scale(scene: Scene) -> tuple[float, dict[View, int]]:
    """Pixels a metre, and the height of each view [pixels]."""
    x, y, z = (high - low for low, high in zip(scene.low, scene.high, strict=True))
    room = 2 * 40
    scale = min(
        (WIDTH - 2 * EDGE - room) / max(x, 1e-9),
        (TALLEST["above"] - room) / max(y, 1e-9),
        (TALLEST["side"] - room) / max(z, 1e-9),
    )
    return scale, {"above": max(LEAST, round(y * scale) + room), "side": max(LEAST, round(z * scale) + room)}


def _title(draw: Any, title: str) -> None:
    font = _font(19)
    text = " ".join(title.split())
    while text and draw.textlength(text, font) > (WIDTH - 2 * EDGE) * FINE:
        text = text[: -max(1, len(text) // 20) - 1].rstrip() + "…"
    draw.text((EDGE * FINE, 14 * FINE), text, INK, font)


@dataclass
class _Panel:
    draw: Any
    scene: Scene
    view: View
    scale: float  # [pixels/m]
    top: int  # [pixels]
    height: int  # [pixels]

    def __post_init__(self) -> None:
        up = 1 if self.view == "above" else 2
        low, high = self.scene.low, self.scene.high
        self.left_edge, self.right_edge = EDGE, WIDTH - EDGE
        self.middle = ((low[0] + high[0]) / 2, (low[up] + high[up]) / 2)

    def draw_all(self) -> None:
        """Grid, things back to front, then names over all of them."""
        self._grid()
        if self.view == "side" and self.scene.ground is not None:
            y = self._y(self.scene.ground)
            bottom = min(y + 7, self.top + self.height)
            if y < bottom:  # what starts high in the air is drawn without the ground far below
                self.draw.rectangle(self._px(self.left_edge, y, self.right_edge, bottom), fill=(120, 116, 108, 110))
        for one in self.scene.views[self.view]:
            self._thing(one)
        self._frame()
        self._names()

    def _x(self, x: float) -> float:
        return WIDTH / 2 + (x - self.middle[0]) * self.scale

    def _y(self, y: float) -> float:
        return self.top + self.height / 2 - (y - self.middle[1]) * self.scale

    def _px(self, *values: float) -> list[float]:
        return [value * FINE for value in values]

    def _grid(self) -> None:
        """Faint lines every so many metres, with their coordinate at the edge."""
        step = nice(100.0 / self.scale * 1.2)
        font = _font(11)
        for sign, start, end, middle in (
            ("x", self.left_edge, self.right_edge, self.middle[0]),
            ("y", self.top, self.top + self.height, self.middle[1]),
        ):
            half = (end - start) / 2 / self.scale
            for k in range(int(-(-(middle - half) // step)), int((middle + half) // step) + 1):
                label = f"{k * step:.6g}"
                if sign == "x":
                    x = self._x(k * step)
                    self.draw.line(self._px(x, start_y := self.top, x, start_y + self.height), FAINT, FINE)
                    self.draw.text(self._px(x, self.top + self.height + 4), label, INK, font, anchor="mt")
                else:
                    y = self._y(k * step)
                    self.draw.line(self._px(self.left_edge, y, self.right_edge, y), FAINT, FINE)
                    self.draw.text(self._px(self.left_edge - 5, y), label, INK, font, anchor="rm")

    def _thing(self, one: Silhouette) -> None:
        corners = [(self._x(x) * FINE, self._y(y) * FINE) for x, y in one.points]
        red, green, blue = _shown(one.color)
        if len(corners) < 3:
            return
        if one.style == "glass":
            self.draw.polygon(corners, fill=(red, green, blue, 26))
            self.draw.line([*corners, corners[0]], (70, 100, 120), 2 * FINE, joint="curve")
            return
        cover = {"solid": 225, "wide": 70, "fluid": 80}[one.style]
        self.draw.polygon(corners, fill=(red, green, blue, cover))
        edge = (red, green, blue) if one.style == "fluid" else INK
        self.draw.line([*corners, corners[0]], edge, FINE, joint="curve")
        if one.front is not None:
            self._heading(one, one.front)

    def _heading(self, one: Silhouette, front: Point) -> None:
        """A wedge at a thing's front, pointing where it looks."""
        middle = ((one.low[0] + one.high[0]) / 2, (one.low[1] + one.high[1]) / 2)
        x, y = front[0] - middle[0], middle[1] - front[1]  # in the picture, where Y is down
        length = math.hypot(x, y)
        if length == 0.0:
            return
        x, y = 9 * x / length, 9 * y / length  # [pixels]
        at = (self._x(front[0]), self._y(front[1]))
        wedge = [(at[0] + x, at[1] + y), (at[0] - 0.6 * y, at[1] + 0.6 * x), (at[0] + 0.6 * y, at[1] - 0.6 * x)]
        self.draw.polygon([(u * FINE, v * FINE) for u, v in wedge], fill=(200, 40, 30))

    def _frame(self) -> None:
        """The border, the heading, the axes, and a bar as long as it says."""
        self.draw.rectangle(
            self._px(self.left_edge, self.top, self.right_edge, self.top + self.height), outline=INK, width=FINE
        )
        heading, right, up = HEADS[self.view]
        font = _font(13)
        y = self.top - 12
        self.draw.text(self._px(self.left_edge, y), heading, INK, _font(15), anchor="lm")
        x = self.left_edge + 190
        self._arrow(x, y, x + 26, y)
        self.draw.text(self._px(x + 32, y), right, INK, font, anchor="lm")
        self._arrow(x + 150, y + 9, x + 150, y - 11)
        self.draw.text(self._px(x + 160, y), up, INK, font, anchor="lm")
        length = nice(180.0 / self.scale)
        end = self.right_edge
        start = end - length * self.scale
        self.draw.line(self._px(start, y, end, y), INK, 2 * FINE)
        for tick in (start, end):
            self.draw.line(self._px(tick, y - 5, tick, y + 5), INK, 2 * FINE)
        self.draw.text(self._px(start - 8, y), f"{length:g} m", INK, font, anchor="rm")

    def _arrow(self, x0: float, y0: float, x1: float, y1: float) -> None:
        self.draw.line(self._px(x0, y0, x1, y1), INK, 2 * FINE)
        along = 1 if x1 > x0 else 0
        head = (
            [(x1, y1), (x1 - 8, y1 - 5), (x1 - 8, y1 + 5)] if along else [(x1, y1), (x1 - 5, y1 + 8), (x1 + 5, y1 + 8)]
        )
        self.draw.polygon([(x * FINE, y * FINE) for x, y in head], fill=INK)

    def _names(self) -> None:
        """Each thing's name; things at one place share a label. Lines first, so that they cross no name."""
        font = _font(13)
        places: dict[tuple[int, ...], list[Silhouette]] = {}
        for one in sorted(self.scene.views[self.view], key=_extent, reverse=True):
            places.setdefault(tuple(round(edge / 6) for edge in self._rect(one)), []).append(one)
        wanted = []
        for ones in list(places.values())[:MOST_NAMES]:
            text = together([one.name for one in ones])
            inside = "middle" if ones[0].style == "solid" else "corner"
            wanted.append(
                Wanted(text, (self.draw.textlength(text, font) / FINE + 6, 17.0), self._rect(ones[0]), inside)
            )
        frame: Rect = (self.left_edge + 2, self.top + 2, self.right_edge - 2, self.top + self.height - 2)
        rects = place(wanted, frame)
        for name, rect in zip(wanted, rects, strict=True):
            near = _nearest(name.thing, (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2)
            end = _nearest(rect, *near)
            if abs(near[0] - end[0]) + abs(near[1] - end[1]) > 6:
                self.draw.line(self._px(*near, *end), (90, 90, 90), FINE)
                self.draw.ellipse(self._px(near[0] - 2, near[1] - 2, near[0] + 2, near[1] + 2), fill=(90, 90, 90))
        for name, rect in zip(wanted, rects, strict=True):
            self.draw.rounded_rectangle(self._px(*rect), 4 * FINE, fill=(255, 255, 255, 190))
            middle = self._px((rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2)
            self.draw.text(middle, name.text, INK, font, anchor="mm")

    def _rect(self, one: Silhouette) -> Rect:
        return self._x(one.low[0]), self._y(one.high[1]), self._x(one.high[0]), self._y(one.low[1])


def _extent(one: Silhouette) -> float:
    return (one.high[0] - one.low[0]) * (one.high[1] - one.low[1])


def _nearest(rect: Rect, x: float, y: float) -> tuple[float, float]:
    """The point of a rectangle that is nearest to another."""
    return min(max(x, rect[0]), rect[2]), min(max(y, rect[1]), rect[3])


def _shown(color: Vec3) -> tuple[int, int, int]:
    """Linear RGB as bytes of sRGB."""
    red, green, blue = (round(255 * value) for value in srgb_of(color).tolist())
    return red, green, blue


@cache
def _font(size: int) -> Any:
    """DejaVu Sans, which has the letters and signs of most titles; Pillow's own font has English ones only."""
    return ImageFont.truetype(FONT, size * FINE)
