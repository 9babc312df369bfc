"""Which charts a run gets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.evidence import Evidence
from wsim.report.chart import COLORS, MUTED, Chart, Mark, Series
from wsim.report.text import prim_name

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.verdict import Finding
    from wsim.recording import Recording
    from wsim.scene.world import Fluid

    Values = NDArray[np.float64]

MOST_LINES = 24  # of a chart; more are not drawn
MOST_MARKS = 4  # of a chart


def make_charts(recording: Recording, findings: list[Finding]) -> list[Chart]:
    """Depths and heights of bodies, energies, the fluid's density error, contacts: those that the recording has."""
    if not len(recording.time):
        return []
    return [
        *_body_charts(recording, findings),
        *_energy_charts(recording, findings),
        *_density(recording, findings),
        *_penetration(recording, findings),
    ]


def _body_charts(recording: Recording, findings: list[Finding]) -> list[Chart]:
    evidence = Evidence(recording)
    depths = _depths(evidence)
    heights = {
        body.prim: recording.position(body.prim)[:, 2].astype(np.float64)
        for body in recording.world.bodies
        if body.prim not in depths and not body.kinematic
    }
    charts = []
    if depths:
        series, marks, note = _body_lines(depths, evidence, findings)
        note = "; ".join(part for part in ("below the surface as it stands at the end", note) if part)
        charts.append(Chart("Depth of the lowest point", "m", series, marks, note, downwards=True, zero="surface"))
    if heights:
        charts.append(Chart("Height of the origin", "m", *_body_lines(heights, evidence, findings)))
    return charts


def _depths(evidence: Evidence) -> dict[str, Values]:
    """Depth (T,) [m] of the lowest point of every body that was in a fluid, by prim, as the judge measures it."""
    depths: dict[str, Values] = {}
    for fluid in evidence.world.fluids:
        try:
            depths = {**_depths_in(fluid, evidence), **depths}
        except (LookupError, ValueError, ArithmeticError):
            # No level without a container, or with states that are not finite: heights are drawn instead.
            continue
    return depths


def _depths_in(fluid: Fluid, evidence: Evidence) -> dict[str, Values]:
    container = evidence.container_of(fluid)
    if container is None:
        return {}
    level = evidence.level(fluid)
    depths: dict[str, Values] = {}
    for i, body in enumerate(evidence.world.bodies):
        offset = np.abs(evidence.local(container, evidence.body_q[:, i, :3]))
        inside = (offset[:, :2] <= np.asarray(container.inner_size[:2]) / 2.0).all(axis=1)
        depth = np.where(inside, level.height - evidence.ends(i)[0], np.nan)
        if np.nanmax(depth, initial=-1.0) > 0.0:
            depths[body.prim] = depth
    return depths


def _body_lines(
    values: dict[str, Values], evidence: Evidence, findings: list[Finding]
) -> tuple[list[Series], list[Mark], str]:
    """A line for each body, those of failed findings first; marks of those findings; what is left out."""
    failed = {finding.prim for finding in findings if not finding.passed}
    order = sorted(values, key=lambda prim: prim not in failed)
    series: list[Series] = []
    marks: list[Mark] = []
    for i, prim in enumerate(order[:MOST_LINES]):
        expected = None
        for k, finding in enumerate(findings, start=1):
            if finding.prim != prim:
                continue
            measured = _measured(finding, evidence, values[prim])
            if measured is not None and finding.expected is not None:
                expected = finding.expected
            if not finding.passed and finding.time is not None:
                marks.append(Mark(f"#{k}", finding.time, measured))
        color = i if i < COLORS else MUTED
        series.append(Series(prim_name(prim), evidence.time, values[prim], color, expected))
    left = len(order) - len(series)
    return series, marks[:MOST_MARKS], f"{left} more bodies are not drawn" if left else ""


def _measured(finding: Finding, evidence: Evidence, values: Values) -> tuple[float, float] | None:
    """(time, value) of a finding's length on a body's line: at the finding's time, or its mean at the run's end.

    None if the line does not pass there, to a tenth of its range: the finding measured another length.
    """
    if finding.value is None or finding.unit != "m" or not np.isfinite(values).any():
        return None
    reach = 0.1 * max(float(np.nanmax(values) - np.nanmin(values)), 2.0 * abs(finding.value))
    at_end = float(np.mean(values[evidence.window]))
    if abs(at_end - finding.value) <= reach:
        return float(evidence.time[-1]), finding.value
    if finding.time is None:
        return None
    then = float(np.interp(finding.time, evidence.time, values))
    return (finding.time, finding.value) if abs(then - finding.value) <= reach else None


def _marks(findings: list[Finding], word: str) -> list[Mark]:
    """The moments of the failed findings whose check has a word in its name."""
    failed = [(k, f) for k, f in enumerate(findings, start=1) if not f.passed and word in f.check.lower()]
    return [Mark(f"#{k}", finding.time) for k, finding in failed if finding.time is not None][:MOST_MARKS]


def _energy_charts(recording: Recording, findings: list[Finding]) -> list[Chart]:
    parts = {"": "Energy"}
    if all(f"energy/kinetic_{part}" in recording.scalars for part in ("bodies", "fluid")):
        parts |= {"_bodies": "Energy of the bodies", "_fluid": "Energy of the fluid"}
    charts = []
    for suffix, title in parts.items():
        kinetic = recording.scalars.get(f"energy/kinetic{suffix}")
        potential = recording.scalars.get(f"energy/potential{suffix}")
        if kinetic is None or potential is None or not np.isfinite(potential).any():
            continue
        change = potential - potential[np.isfinite(potential)][0]
        lines = {"kinetic": kinetic, "potential": change, "their sum": kinetic + change}
        series = [Series(label, recording.time, values, i) for i, (label, values) in enumerate(lines.items())]
        note = "potential energy counted from its start"
        charts.append(Chart(title, "J", series, _marks(findings, "energy"), note, zero=" "))
    return charts


def _density(recording: Recording, findings: list[Finding]) -> list[Chart]:
    names = {"mean": "fluid/density_error_mean", "largest": "fluid/density_error_max"}
    known = {label: recording.scalars[name] for label, name in names.items() if name in recording.scalars}
    if not known:
        return []
    series = [Series(label, recording.time, 100.0 * values, i) for i, (label, values) in enumerate(known.items())]
    marks = _marks(findings, "density")
    return [Chart("Density error of the fluid", "%", series, marks, "of the rest density", zero=" ")]


def _penetration(recording: Recording, findings: list[Finding]) -> list[Chart]:
    values = recording.scalars.get("contact/penetration")
    if values is None or not np.nanmax(values, initial=0.0) > 0.0:
        return []
    series = [Series("penetration", recording.time, 1e3 * values)]
    return [Chart("Deepest contact", "mm", series, _marks(findings, "penetration"), "of all pairs of shapes", zero=" ")]
