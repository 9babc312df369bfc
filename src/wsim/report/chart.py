"""Line charts as small SVGs whose colours follow the page's theme."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from wsim.report.numbers import LARGE, SMALL, SUPERSCRIPTS, nice_unit, number, quantity

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Values = NDArray[np.float64]

WIDTH, HEIGHT = 460, 250
LEFT, RIGHT, TOP, BOTTOM = 54, 12, 14, 34  # margins
COLORS = 6
MUTED = COLORS  # colour of the series that have none of their own
MOST_POINTS = 600
TICKS = 5


@dataclass(frozen=True)
class Series:
    """One line; its name, and the value that theory gives, if one does."""

    label: str
    time: Values  # (T,) [s]
    value: Values  # (T,); NaN leaves a gap
    color: int = 0  # 0 … COLORS − 1, or MUTED
    expected: float | None = None

    @property
    def last(self) -> float | None:
        """The last finite value."""
        finite = self.value[np.isfinite(self.value)]
        return float(finite[-1]) if len(finite) else None


@dataclass(frozen=True)
class Mark:
    """A moment that a failed finding names; with (time, value) of what was measured if it lies in the chart."""

    label: str
    time: float
    measured: tuple[float, float] | None = None


@dataclass(frozen=True)
class Limit:
    """A level that values must keep to, drawn with the side that is forbidden."""

    value: float
    words: str = ""  # "at most", "at least": which side is allowed; else neither is drawn

    @property
    def forbids(self) -> float:
        """Towards which values: +1, -1, or 0 where it is not known."""
        return {"at most": 1.0, "at least": -1.0}.get(self.words, 0.0)


@dataclass(frozen=True)
class Chart:
    """Series over simulated time."""

    title: str
    unit: str
    series: list[Series]
    marks: list[Mark] = field(default_factory=list)
    note: str = ""
    downwards: bool = False  # larger values lower: depths
    zero: str = ""  # names the line at zero, which is then always in view
    limits: list[Limit] = field(default_factory=list)
    over: tuple[float, float] | None = None  # [s]: a stretch that is shaded

    def legend(self) -> list[tuple[int, str, str]]:
        """(colour, label, what it says) of each series."""
        rows = []
        for line in self.series:
            text = f"{quantity(line.last, self.unit)} at the end" if line.last is not None else "no values"
            if line.expected is not None:
                text += f", {quantity(line.expected, self.unit)} expected"
            rows.append((line.color, line.label, text))
        return rows

    @property
    def heading(self) -> str:
        """Title and unit."""
        return f"{self.title} [{nice_unit(self.unit)}]"

    @property
    def svg(self) -> Markup:
        """The drawing."""
        frame = _Frame.around(self)
        parts = [*_backdrop(self, frame), *_axes(self, frame)]
        parts += [_limit(limit, frame) for limit in self.limits]
        for mark in self.marks:
            parts.append(_moment(mark, frame))
        for line in sorted(self.series, key=lambda line: -line.color):
            parts += _line(line, frame, self.unit)
        parts += [_limit_label(limit, frame, self.unit) for limit in self.limits]
        for mark in self.marks:
            if mark.measured is not None:
                t, value = mark.measured
                dot = '<circle class="measured" cx="{}" cy="{}" r="4"><title>{}</title></circle>'
                title = f"finding {mark.label}: {quantity(value, self.unit)} measured"
                parts.append(Markup(dot).format(_px(frame.x(t)), _px(frame.y(value)), title))
        label = f"{self.heading}, {', '.join(line.label for line in self.series)}"
        opening = Markup('<svg viewBox="0 0 {} {}" role="img" aria-label="{}">').format(WIDTH, HEIGHT, label)
        return opening + Markup("").join(parts) + Markup("</svg>")


@dataclass(frozen=True)
class _Frame:
    """Maps time and value to pixels."""

    t0: float
    t1: float
    bottom: float
    top: float

    @classmethod
    def around(cls, chart: Chart) -> _Frame:
        times = _finite([line.time for line in chart.series])
        values = _finite([line.value for line in chart.series])
        extra = [line.expected for line in chart.series] + [mark.measured[1] for mark in chart.marks if mark.measured]
        extra += [limit.value for limit in chart.limits]
        known = [x for x in extra if x is not None and math.isfinite(x)] + ([0.0] if chart.zero else [])
        values = np.concatenate([values, known])
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
        # Rounding noise on a constant must not fill the chart.
        pad = max(0.06 * (high - low), 1e-4 * max(abs(low), abs(high)), 1e-9)
        low, high = low - pad, high + pad
        t0, t1 = (float(times.min()), float(times.max())) if len(times) else (0.0, 1.0)
        return cls(t0, max(t1, t0 + 1e-9), *((high, low) if chart.downwards else (low, high)))

    def x(self, t: float) -> float:
        return LEFT + (t - self.t0) / (self.t1 - self.t0) * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        return HEIGHT - BOTTOM - (value - self.bottom) / (self.top - self.bottom) * (HEIGHT - TOP - BOTTOM)


def _backdrop(chart: Chart, frame: _Frame) -> list[Markup]:
    """The forbidden side of each limit, and the stretch that a value is taken from."""
    box = '<rect class="{}" x="{}" y="{}" width="{}" height="{}"/>'
    parts = []
    for limit in chart.limits:
        if limit.forbids:
            edge = max(frame.top, frame.bottom) if limit.forbids > 0 else min(frame.top, frame.bottom)
            top, bottom = sorted((frame.y(limit.value), frame.y(edge)))
            place = (LEFT, _px(top), WIDTH - LEFT - RIGHT, _px(max(bottom - top, 0.0)))
            parts.append(Markup(box).format("forbidden", *place))
    if chart.over is not None and chart.over[1] > chart.over[0]:
        start, end = (frame.x(min(max(t, frame.t0), frame.t1)) for t in chart.over)
        parts.append(Markup(box).format("over", _px(start), TOP, _px(end - start), HEIGHT - TOP - BOTTOM))
    return parts


def _limit(limit: Limit, frame: _Frame) -> Markup:
    y = _px(frame.y(limit.value))
    line = '<line class="limit" x1="{}" x2="{}" y1="{}" y2="{}"/>'
    return Markup(line).format(LEFT, WIDTH - RIGHT, y, y)


def _limit_label(limit: Limit, frame: _Frame, unit: str) -> Markup:
    y = frame.y(limit.value)
    text = f"{limit.words or 'limit'} {quantity(limit.value, unit)}"
    place = (WIDTH - RIGHT - 4, _px(y + 14 if y < TOP + 16 else y - 5))
    return Markup('<text class="limit end" x="{}" y="{}">{}</text>').format(*place, text)


def ticks(low: float, high: float, count: int = TICKS) -> list[float]:
    """Round numbers in a range, about `count` of them."""
    if not high > low:
        return [low]
    raw = (high - low) / count
    power = 10.0 ** math.floor(math.log10(raw))
    step = min((m * power for m in (1.0, 2.0, 2.5, 5.0, 10.0)), key=lambda s: abs(math.log(s / raw)))
    return [step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _axes(chart: Chart, frame: _Frame) -> list[Markup]:
    parts = []
    rows = ticks(min(frame.bottom, frame.top), max(frame.bottom, frame.top))
    scale, power = common_power(rows)
    parts.append(Markup('<text class="tick" x="{}" y="{}">{}</text>').format(2, TOP - 3, power))
    for value in rows:
        y = _px(frame.y(value))
        zero = bool(chart.zero) and abs(value) < 1e-12
        line = '<line class="{}" x1="{}" x2="{}" y1="{}" y2="{}"/><text class="tick end" x="{}" y="{}">{}</text>'
        place = (LEFT, WIDTH - RIGHT, y, y, LEFT - 7, _px(frame.y(value) + 4))
        parts.append(
            Markup(line).format("zero" if zero else "grid", *place, _tick(value / scale, [row / scale for row in rows]))
        )
        if zero:
            text = '<text class="tick end" x="{}" y="{}">{}</text>'
            parts.append(Markup(text).format(WIDTH - RIGHT, _px(frame.y(0.0) - 4), chart.zero))
    columns = ticks(frame.t0, frame.t1)
    for t in columns:
        text = '<text class="tick mid" x="{}" y="{}">{}</text>'
        parts.append(Markup(text).format(_px(frame.x(t)), HEIGHT - BOTTOM + 17, _tick(t, columns)))
    parts.append(Markup('<text class="tick mid" x="{}" y="{}">time [s]</text>').format((LEFT + WIDTH) // 2, HEIGHT - 3))
    return parts


def common_power(values: Sequence[float]) -> tuple[float, str]:
    """What all of an axis' values are divided by, and how that is written above it, where they would be too long."""
    largest = max((abs(value) for value in values), default=0.0)
    power = math.floor(math.log10(largest)) if largest > 0.0 else 0
    if SMALL < power < LARGE - 1:  # ticks that are a tenth of the largest are short as well
        return 1.0, ""
    return 10.0**power, f"× 10{str(power).translate(SUPERSCRIPTS)}"


def _tick(value: float, values: Sequence[float]) -> str:
    """A tick's label, with the decimals that the distance between ticks needs."""
    step = abs(values[1] - values[0]) if len(values) > 1 else abs(value)
    if not step or abs(value) < 1e-9 * step:
        return "0"
    return number(value, max(3, math.floor(math.log10(abs(value))) - math.floor(math.log10(step)) + 2))


def _line(line: Series, frame: _Frame, unit: str) -> list[Markup]:
    parts = []
    if line.expected is not None and math.isfinite(line.expected):
        y = _px(frame.y(line.expected))
        dashes = '<line class="expected c{}" x1="{}" x2="{}" y1="{}" y2="{}"><title>{}</title></line>'
        title = f"{line.label}: {quantity(line.expected, unit)} expected"
        parts.append(Markup(dashes).format(line.color, LEFT, WIDTH - RIGHT, y, y, title))
    for points in _runs(line, frame):
        path = '<polyline class="line c{}" points="{}"><title>{}</title></polyline>'
        parts.append(Markup(path).format(line.color, points, line.label))
    return parts


def _moment(mark: Mark, frame: _Frame) -> Markup:
    x = _px(frame.x(mark.time))
    body = '<line class="moment" x1="{}" x2="{}" y1="{}" y2="{}"><title>finding {} at {}</title></line>'
    text = '<text class="moment {}" x="{}" y="{}">{}</text>'
    late = frame.x(mark.time) > WIDTH - RIGHT - 24
    label = Markup(text).format(
        "end" if late else "", _px(frame.x(mark.time) + (-3 if late else 3)), TOP - 2, mark.label
    )
    return Markup(body).format(x, x, TOP, HEIGHT - BOTTOM, mark.label, quantity(mark.time, "s")) + label


def _runs(line: Series, frame: _Frame) -> list[str]:
    """Points of each stretch without gaps."""
    keep = _thinned(line.value)
    runs: list[list[str]] = [[]]
    for t, value in zip(line.time[keep], line.value[keep], strict=True):
        if math.isfinite(value) and math.isfinite(t):
            runs[-1].append(f"{_px(frame.x(float(t)))},{_px(frame.y(float(value)))}")
        elif runs[-1]:
            runs.append([])
    return [" ".join(points) for points in runs if points]


def _thinned(values: Values) -> NDArray[np.int64]:
    """Indices of the points to draw: all of a few; of many, the least and the greatest of each stretch."""
    if len(values) <= MOST_POINTS:
        return np.arange(len(values))
    filled = np.nan_to_num(values)
    kept = [0, len(values) - 1]
    for stretch in np.array_split(np.arange(len(values)), MOST_POINTS // 2):
        kept += [int(stretch[np.argmin(filled[stretch])]), int(stretch[np.argmax(filled[stretch])])]
        kept += [int(i) for i in stretch[~np.isfinite(values[stretch])][:1]]
    return np.unique(kept)


def _finite(arrays: list[Values]) -> Values:
    joined = np.concatenate([np.asarray(array, np.float64) for array in arrays]) if arrays else np.zeros(0)
    return joined[np.isfinite(joined)]


def _px(x: float) -> str:
    return f"{x:.1f}".removesuffix(".0")
