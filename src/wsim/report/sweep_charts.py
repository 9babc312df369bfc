"""A sweep's drawings as small SVGs whose colours follow the page's theme: one mark or line for each candidate."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from wsim.report.chart import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, ticks
from wsim.report.numbers import number
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.sensitivity import ROOM, Sensitivity

MOST = 2000  # candidates of a drawing, the best and the worst of all: more nobody tells apart
MOST_MAPS = 6
PAD = 0.04  # of a range, left free at either end
MARK = 3.4  # half a mark's size [px]
BAR, GAP = 11, 9  # [px]
NAMES = 130  # [px] for names beside bars


@dataclass(frozen=True)
class Drawing:
    """An SVG and what it shows."""

    title: str
    svg: Markup
    note: str = ""


@dataclass(frozen=True)
class Scale:
    """Where values are along an axis, as a share of it."""

    name: str
    low: float
    high: float
    log: bool = False

    @classmethod
    def of(cls, name: str, values: Sequence[float], axis: Axis | None = None) -> Scale:
        """Around values; logarithmic where the sweep drew them so."""
        low, high = (min(values), max(values)) if values else (0.0, 1.0)
        if axis is not None and axis.scale == "log" and low > 0.0:
            pad = (high / low) ** PAD if high > low else 1.1
            return cls(name, low / pad, high * pad, True)
        pad = PAD * (high - low) or 0.1 * abs(low) or 0.1
        return cls(name, low - pad, high + pad)

    def at(self, value: float) -> float:
        """0 at `low`, 1 at `high`."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def ticks(self) -> list[float]:
        """Round values in it."""
        if not self.log:
            return ticks(self.low, self.high)
        powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        steps = (1.0,) if self.high / self.low > 1e3 else (1.0, 2.0, 5.0)
        return [x for p, m in itertools.product(powers, steps) if self.low <= (x := m * 10.0**p) <= self.high]


ROOM_SCALE = Scale(ROOM, -1.0 - PAD, 1.0 + PAD)


def draw(outcomes: Sequence[Outcome], axes: Sequence[Axis], told: Sequence[Sensitivity]) -> list[Drawing]:
    """The room against each parameter, parameters by twos, all side by side, and what the room hangs on.

    Args:
        outcomes: The best first.
        axes: What was varied; values that were given in a file have none.
        told: Sobol' indices, if the design gave any.
    """
    varied = [outcome for outcome in outcomes if outcome.candidate.values]
    note = "" if len(varied) <= MOST else f"the best and the worst {MOST // 2} of {len(varied)}"
    shown = varied if not note else [*varied[: MOST // 2], *varied[-(MOST // 2) :]]
    names = list(dict.fromkeys(name for outcome in shown for name in outcome.candidate.values))
    scales = {name: _scale(name, shown, axes) for name in names}
    roomy = any(outcome.slack is not None for outcome in shown)
    drawings = [
        Drawing(f"{ROOM[0].upper()}{ROOM[1:]} against {name}", _scatter(shown, scale, ROOM_SCALE), note)
        for name, scale in scales.items()
        if roomy  # nothing was asked: see what the page says
    ]
    pairs = list(itertools.combinations(names, 2))[:MOST_MAPS]
    drawings += [Drawing(f"{b} against {a}", _scatter(shown, scales[a], scales[b]), note) for a, b in pairs]
    if len(names) > 1:
        drawings.append(Drawing("All parameters side by side", _parallel(shown, [*scales.values()]), note))
    return drawings + [_bars(each) for each in told]


def _scale(name: str, outcomes: Sequence[Outcome], axes: Sequence[Axis]) -> Scale:
    values = [outcome.candidate.values[name] for outcome in outcomes if name in outcome.candidate.values]
    return Scale.of(name, values, next((axis for axis in axes if axis.name == name), None))


def _value(outcome: Outcome, name: str) -> float | None:
    return outcome.slack if name == ROOM else outcome.candidate.values.get(name)


def _x(scale: Scale, value: float) -> float:
    return LEFT + scale.at(value) * (WIDTH - LEFT - RIGHT)


def _y(scale: Scale, value: float) -> float:
    return HEIGHT - BOTTOM - scale.at(value) * (HEIGHT - TOP - BOTTOM)


def _scatter(outcomes: Sequence[Outcome], across: Scale, up: Scale) -> Markup:
    """Candidates by two of their numbers; what has none of one is left out."""
    parts = _grid(across, up)
    for outcome in reversed(outcomes):  # the best on top
        x, y = _value(outcome, across.name), _value(outcome, up.name)
        if x is not None and y is not None:
            parts.append(_mark(outcome, _x(across, x), _y(up, y)))
    return _svg(HEIGHT, f"{up.name} against {across.name}", parts)


def _grid(across: Scale, up: Scale) -> list[Markup]:
    line = Markup('<line class="{}" x1="{}" x2="{}" y1="{}" y2="{}"/>')
    parts = []
    for value in up.ticks():
        y = _y(up, value)
        kind = "zero" if up is ROOM_SCALE and abs(value) < 1e-9 else "grid"
        parts += [line.format(kind, LEFT, WIDTH - RIGHT, _px(y), _px(y)), _text("tick end", LEFT - 7, y + 4, value)]
    for value in across.ticks():
        x = _x(across, value)
        parts += [line.format("grid", _px(x), _px(x), TOP, HEIGHT - BOTTOM)]
        parts += [_text("tick mid", x, HEIGHT - BOTTOM + 16, value)]
    parts.append(_text("tick mid", (LEFT + WIDTH) / 2, HEIGHT - 3, across.name))
    return parts


def _mark(outcome: Outcome, x: float, y: float) -> Markup:
    """A disc for what is accepted, a cross for what is rejected, a ring for what has no verdict."""
    shape = {
        "accepted": '<circle cx="{x}" cy="{y}" r="{r}"/>',
        "rejected": '<path d="M{left},{top} L{right},{low} M{left},{low} L{right},{top}"/>',
    }.get(outcome.status, '<circle class="hollow" cx="{x}" cy="{y}" r="{r}"/>')
    place = {"x": x, "y": y, "r": MARK, "left": x - MARK, "right": x + MARK, "top": y - MARK, "low": y + MARK}
    drawn = Markup(shape).format(**{key: _px(value) for key, value in place.items()})
    return Markup('<g class="mark {}"><title>{}</title>{}</g>').format(outcome.status, title_of(outcome), drawn)


def _parallel(outcomes: Sequence[Outcome], scales: list[Scale]) -> Markup:
    """An upright axis for each parameter, and the room last; a candidate is the line through its numbers."""
    scales = [*scales, ROOM_SCALE]
    step = (WIDTH - LEFT - 2 * RIGHT - 22) / (len(scales) - 1)
    places = [LEFT + k * step for k in range(len(scales))]
    parts = []
    for outcome in reversed(outcomes):
        values = [_value(outcome, scale.name) for scale in scales]
        known = [(x, _y(s, v)) for x, s, v in zip(places, scales, values, strict=True) if v is not None]
        points = " ".join(f"{_px(x)},{_px(y)}" for x, y in known)
        line = '<polyline class="way {}" points="{}"><title>{}</title></polyline>'
        parts.append(Markup(line).format(outcome.status, points, title_of(outcome)))
    for k, (x, scale) in enumerate(zip(places, scales, strict=True)):
        upright = '<line class="zero" x1="{0}" x2="{0}" y1="{1}" y2="{2}"/>'
        parts.append(Markup(upright).format(_px(x), TOP, HEIGHT - BOTTOM))
        parts += [_text("tick end halo", x - 4, _y(scale, value) + 4, value) for value in scale.ticks()]
        anchor = "end" if scale is ROOM_SCALE else "mid"
        parts.append(_text(f"tick {anchor}", x, HEIGHT - BOTTOM + (14 if k % 2 == 0 else 28), scale.name))
    return _svg(HEIGHT, "all parameters side by side", parts)


def _bars(told: Sensitivity) -> Drawing:
    """Two bars for each parameter, with their intervals: what it makes by itself, and with others."""
    high = max(1.0, *(index.total_between[1] for index in told.indices))
    low = min(0.0, *(index.first_between[0] for index in told.indices))
    scale = Scale("share of the variance", low, high)

    def at(value: float) -> float:
        return NAMES + scale.at(value) * (WIDTH - NAMES - RIGHT)

    height = TOP + len(told.indices) * (2 * BAR + GAP) + BOTTOM
    parts = [
        Markup('<line class="{}" x1="{}" x2="{}" y1="{}" y2="{}"/>').format(
            "zero" if abs(value) < 1e-9 else "grid", _px(at(value)), _px(at(value)), TOP, height - BOTTOM
        )
        for value in scale.ticks()
    ]
    parts += [_text("tick mid", at(value), height - BOTTOM + 16, value) for value in scale.ticks()]
    parts.append(_text("tick mid", (NAMES + WIDTH) / 2, height - 3, scale.name))
    for k, index in enumerate(told.indices):
        top = TOP + k * (2 * BAR + GAP)
        parts.append(_text("name end", NAMES - 8, top + BAR + 4, index.name))
        rows = (("alone", index.first, index.first_between), ("all", index.total, index.total_between))
        for row, (kind, value, between) in enumerate(rows):
            y, left, right = top + row * BAR, *sorted((at(0.0), at(value)))
            words = f"{index.name} {'by itself' if kind == 'alone' else 'with others'}: {number(value)}, between "
            bar = '<rect class="bar {}" x="{}" y="{}" width="{}" height="{}"><title>{}</title></rect>'
            said = words + " and ".join(number(x) for x in between)
            parts.append(Markup(bar).format(kind, _px(left), y, _px(right - left), BAR - 1, said))
            span = '<line class="between" x1="{}" x2="{}" y1="{}" y2="{}"/>'
            middle = y + BAR / 2 - 0.5
            parts.append(Markup(span).format(*(_px(at(x)) for x in between), middle, middle))
    lost = f", {told.lost} rows lost" if told.lost else ""
    note = f"Sobol' indices of {told.rows} rows{lost}; thin lines: 95 %. Full bar: by itself; pale bar: with others"
    return Drawing(
        f"What the {told.result} hangs on" if told.result == ROOM else f"What it hangs on: {told.result}",
        _svg(height, f"Sobol' indices: {told.result}", parts),
        note,
    )


def title_of(outcome: Outcome) -> str:
    """What a mark says when it is pointed at."""
    values = ", ".join(f"{name} {number(value)}" for name, value in outcome.candidate.values.items())
    room = "" if outcome.slack is None else f", room {number(outcome.slack, sign=True)}"
    own = outcome.candidate
    return f"{own.number}: {own.program}, {values or 'as it stands'}: {outcome.status}{room}"


def _text(kind: str, x: float, y: float, said: float | str) -> Markup:
    words = said if isinstance(said, str) else number(0.0 if abs(said) < 1e-12 else said, 4)
    return Markup('<text class="{}" x="{}" y="{}">{}</text>').format(kind, _px(x), _px(y), words)


def _svg(height: float, label: str, parts: Sequence[Markup]) -> Markup:
    opening = Markup('<svg viewBox="0 0 {} {}" role="img" aria-label="{}">').format(WIDTH, height, label)
    return opening + Markup("").join(parts) + Markup("</svg>")


def _px(x: float) -> str:
    return f"{x:.1f}".removesuffix(".0")
