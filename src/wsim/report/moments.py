"""The plot around a failed finding's moment: what was judged, its limit, and where the value was taken."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.report.asked import ref_of
from wsim.report.chart import Chart, Limit, Mark, Series
from wsim.report.signals import Signal, find_signal
from wsim.report.text import limit_word, percent, prim_name

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

BESIDE = 0.5  # [s] shown before and after the moment, at least
BESIDE_SHARE = 0.25  # of the stretch that is shown


def moment_chart(evidence: Evidence, finding: Finding, index: int) -> Chart | None:
    """The judged signal in a window around the finding's moment; None where the recording shows nothing of it.

    Args:
        evidence: Of the recording that was judged, with its plan.
        finding: A finding that failed.
        index: Its number in the verdict, from 1.
    """
    signal = find_signal(evidence, finding, ref_of(finding, evidence) or None)
    if signal is None:
        return None
    here = _window(signal, finding)
    if not np.isfinite(signal.value[here]).any():
        return None
    factor, unit = percent(signal.unit)
    judged = bool(signal.how)
    series = Series(
        prim_name(finding.prim or ""),
        signal.time[here],
        factor * signal.value[here],
        0,
        _expected(finding, factor) if judged else None,
    )
    return Chart(
        title=signal.title,
        unit=unit,
        series=[series],
        marks=_marks(signal, finding, index, factor),
        note=_note(signal, finding),
        downwards=signal.downwards,
        limits=_limits(finding, factor) if judged else [],
        over=signal.over if signal.over is not None and signal.over[1] > signal.over[0] else finding.span,
    )


def _window(signal: Signal, finding: Finding) -> slice:
    """The frames around the finding's span and the stretch that its value is taken from; all where it has no time."""
    times = [*(finding.span or ()), *(signal.over or ()), *([finding.time] if finding.time is not None else [])]
    known = [t for t in times if math.isfinite(t)]
    if not known:
        return slice(None)
    beside = max(BESIDE, BESIDE_SHARE * (max(known) - min(known)))
    first = int(np.searchsorted(signal.time, min(known) - beside))
    last = int(np.searchsorted(signal.time, max(known) + beside, side="right"))
    return slice(max(0, min(first, len(signal.time) - 2)), max(last, first + 2))


def _limits(finding: Finding, factor: float) -> list[Limit]:
    """The level or levels that the value must keep to."""
    limit, expected = finding.limit, finding.expected
    if limit is None or not math.isfinite(limit):
        return []
    word = limit_word(finding)
    if word == "off by at most" and expected is not None:
        return [Limit(factor * (expected + limit), "at most"), Limit(factor * (expected - limit), "at least")]
    return [Limit(factor * limit, word if word != "limit" else "")]


def _expected(finding: Finding, factor: float) -> float | None:
    """What theory gives, unless the limit's line says as much."""
    return factor * finding.expected if finding.expected not in (None, finding.limit) else None


def _marks(signal: Signal, finding: Finding, index: int, factor: float) -> list[Mark]:
    """The moment, and the value where it was taken: at a frame, or at the end of the stretch that it is the mean of."""
    taken = (
        (signal.over[1], factor * finding.value) if signal.how and signal.over and finding.value is not None else None
    )
    time = finding.time if finding.time is not None and math.isfinite(finding.time) else taken[0] if taken else None
    return [Mark(f"#{index}", time, taken)] if time is not None else []


def _note(signal: Signal, finding: Finding) -> str:
    """Where the value comes from."""
    if signal.how:
        return f"measured {signal.how}"
    return "what went on meanwhile: the finding's number is not one of this line" if finding.value is not None else ""
