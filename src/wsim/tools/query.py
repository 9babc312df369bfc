"""The tool that asks a recording: a signal of a prim in a window of time, reduced to a few numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from wsim import recording
from wsim.errors import UserError
from wsim.judge.evidence.evidence import Evidence
from wsim.tools.base import Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.signals import find, known
from wsim.tools.text import number, table

if TYPE_CHECKING:
    from wsim.tools.signals import Signal

Reduction = Literal["samples", "first", "last", "min", "max", "mean", "at", "first_time_above", "first_time_below"]
SAMPLES = 12  # most rows


class Query(OfIteration):
    """A question to a recording."""

    signal: str = Field(
        "",
        description="such as position, position.z, speed, rotation, contact_force, kinetic_energy, angle, level, or a "
        "recorded scalar; without one, all that there are",
        max_length=100,
    )
    prim: str = Field("", description="whose: a body, joint or fluid; none for a scalar of the world", max_length=200)
    other: str = Field("", description="of the signal gap: the object at its other end", max_length=200)
    reduction: Reduction = Field("samples", description=f"what to make of it; samples are at most {SAMPLES} rows")
    value: float | None = Field(
        None, allow_inf_nan=False, description="of at: the time [s]; of first_time_above and _below: the threshold"
    )
    start: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="beginning of the window [s]")
    end: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="end of the window [s]")


def query_recording(workspace: Workspace, asked: Query) -> Result:
    """A few numbers of a recording."""
    path = file_of(workspace, asked.iteration, "recording.rrd", "run_program with the pass physics or full makes one")
    evidence = Evidence(recording.read(path), workspace.plan)
    if not len(evidence.time):
        raise UserError("the recording has no frames; read_verdict says why")
    if not asked.signal:
        span = f"{number(evidence.time[0])} to {number(evidence.time[-1])} s, {len(evidence.time)} frames"
        return Result("\n".join([span, *table(("prim", "signals"), known(evidence))]))
    return Result("\n".join(_answer(_window(find(evidence, asked.signal, asked.prim, asked.other), asked), asked)))


def _window(signal: Signal, asked: Query) -> Signal:
    """What lies in the window asked for."""
    low = -np.inf if asked.start is None else asked.start - 1e-9
    high = np.inf if asked.end is None else asked.end + 1e-9
    inside = (signal.time >= low) & (signal.time <= high)
    if not inside.any():
        span = f"{number(signal.time[0])} to {number(signal.time[-1])} s"
        raise UserError(f"start, end: no frame lies between them; the recording has {span}")
    return replace(signal, time=signal.time[inside], value=_rounded(signal)[inside])


def _rounded(signal: Signal) -> np.ndarray:
    """Values with zero for what is below the rounding of the largest: recordings are of single precision."""
    value, largest = signal.value, 180.0 if signal.unit == "deg" else 0.0
    finite = np.abs(value[np.isfinite(value)])
    least = float(np.finfo(np.float32).eps) * float(finite.max(initial=largest))
    return np.where(np.abs(value) < least, 0.0, value)


def _answer(signal: Signal, asked: Query) -> list[str]:
    span = f"{number(signal.time[0])} to {number(signal.time[-1])} s, {len(signal.time)} frames"
    head = f"{signal.title}, {span}"
    if asked.reduction in ("at", "first_time_above", "first_time_below") and asked.value is None:
        raise UserError(
            f"value: {asked.reduction} needs one: {'the time [s]' if asked.reduction == 'at' else 'a threshold'}"
        )
    if asked.reduction.startswith("first_time"):
        return [head, _first_time(signal, asked.reduction, asked.value or 0.0)]
    if asked.reduction == "mean":
        names = [part or "mean" for part in signal.parts]
        return [head, *table(names, [[number(x) for x in np.nanmean(signal.value, axis=0)]])]
    if asked.reduction in ("min", "max"):
        return [head, *_extremes(signal, asked.reduction)]
    rows = [[number(t), *(number(x) for x in values)] for t, values in _rows(signal, asked)]
    return [head, *table(["t [s]", *(part or "value" for part in signal.parts)], rows)]


def _rows(signal: Signal, asked: Query) -> list[tuple[float, np.ndarray]]:
    count = len(signal.time)
    chosen = {
        "first": [0],
        "last": [count - 1],
        "at": [int(np.argmin(np.abs(signal.time - (asked.value or 0.0))))],
        "samples": np.unique(np.linspace(0, count - 1, min(SAMPLES, count)).round().astype(int)).tolist(),
    }[asked.reduction]
    return [(float(signal.time[k]), signal.value[k]) for k in chosen]


def _extremes(signal: Signal, reduction: Literal["min", "max"]) -> list[str]:
    """The extreme of each component, and when it is."""
    rows = []
    for k, part in enumerate(signal.parts):
        column = signal.value[:, k]
        if not np.isfinite(column).any():
            rows.append([part, "not recorded", ""])
            continue
        at = int(np.nanargmin(column) if reduction == "min" else np.nanargmax(column))
        rows.append([part, number(float(column[at])), number(float(signal.time[at]))])
    return table(("", reduction, "t [s]"), rows)


def _first_time(signal: Signal, reduction: str, threshold: float) -> str:
    if len(signal.parts) > 1:
        raise UserError(f"signal: {reduction} is of one number; ask for {signal.name}.{signal.parts[-1]}")
    column = signal.value[:, 0]
    crossed = column > threshold if reduction == "first_time_above" else column < threshold
    side = reduction.removeprefix("first_time_")
    if not crossed.any():
        least, most = number(np.nanmin(column)), number(np.nanmax(column))
        return f"never {side} {number(threshold)}; it lies between {least} and {most}"
    k = int(np.argmax(crossed))
    return f"{side} {number(threshold)} first at {number(signal.time[k])} s, where it is {number(column[k])}"


TOOLS = (
    Tool(
        "query_recording", "Numbers of what happened: a signal of a prim in a window of time, reduced. Without a "
        "signal it lists what can be asked.", Query, query_recording, narrow="ask for one signal of one prim",
    ),
)  # fmt: skip
