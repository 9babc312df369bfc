"""From the folder of a sweep to one HTML file: what was asked, how it came out, which candidates, and why not."""

from __future__ import annotations

import base64
import hashlib
import shlex
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from wsim.plan.store import load
from wsim.program.patch import diff
from wsim.report.asked import sentence_of
from wsim.report.diff import Diff, make_diff
from wsim.report.media import Picture, find_stills
from wsim.report.numbers import number
from wsim.report.page import write as write_run
from wsim.report.sweep_charts import draw
from wsim.report.templates import source, template
from wsim.runs.folder import write_whole
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import ORDER, Outcome
from wsim.sweep.draw import Draw
from wsim.sweep.folder import SweepFolder
from wsim.sweep.sensitivity import sensitivities
from wsim.sweep.spec import Spec
from wsim.sweep.table import parameters, ranked

MOST_ROWS = 400  # of the table; table.csv has all
MOST_REASONS = 12


@dataclass(frozen=True)
class Full:
    """A candidate that was run in full: where its report is, and how it looked at the end."""

    outcome: Outcome
    report: str  # a link from the sweep's folder; empty where there is none
    picture: Picture | None


@dataclass(frozen=True)
class Reason:
    """What candidates failed of, how many, and one of them."""

    status: str
    failures: list[str]
    count: int
    example: Outcome


def write(folder: SweepFolder) -> Path:
    """Write `report.html` in a sweep's folder, from what is done so far, and that of each candidate run in full."""
    for run in (folder.path / "candidates").glob("[0-9]*"):
        write_run(run)
    path = folder.path / "report.html"
    write_whole(path, render(context(folder)))
    return path


def render(values: dict[str, Any]) -> str:
    """The template with its values. The one script, which sorts the table, is allowed by its hash: no other runs."""
    script = source("sort.js")
    digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
    return template("sweep.html").render(
        style=Markup(source("style.css") + source("sweep.css")),
        script=Markup(script),
        digest=digest,
        number=number,
        **values,
    )


def context(folder: SweepFolder) -> dict[str, Any]:
    """What the template is given."""
    spec, outcomes = folder.spec, ranked(list(folder.outcomes().values()))
    plan_file = folder.path / "plan.json"
    plan = load(plan_file) if plan_file.is_file() else None
    counts = Counter(outcome.status for outcome in outcomes)
    return {
        "title": plan.title if plan else ", ".join(spec.programs),
        "prompt": plan.prompt if plan else "",
        "objectives": [sentence_of(item) for item in plan.objectives] if plan else [],
        "folder": folder.path.resolve().name,
        "spec": spec,
        "facts": facts(spec),
        "axes": [(each.name, walk(each, axis)) for axis in spec.axes for each in axis.parameters]
        + [(draw.name, span(draw)) for draw in spec.draws],
        "counts": [(status, counts[status]) for status in ORDER if counts[status]],
        "asked": spec.count,
        "done": len(outcomes),
        "finished": folder.finished,
        "resume": f"wsim sweep --resume {shlex.quote(str(folder.path))}",
        "view": f"wsim view {shlex.quote(str(folder.path))}",
        "best": outcomes[0] if outcomes else None,
        "names": parameters(outcomes),
        "several": len(spec.programs) > 1,
        "patches": patches(folder, spec),
        "rows": list(enumerate(outcomes[:MOST_ROWS], start=1)),
        "fulls": fulls(folder, outcomes),
        "drawings": draw(outcomes, spec.parameters, sensitivities(spec, outcomes)),
        "unasked": bool(outcomes) and all(outcome.slack is None for outcome in outcomes),
        "reasons": reasons(outcomes),
        "notes": Counter(outcome.note for outcome in outcomes if outcome.note).most_common(),
    }


def facts(spec: Spec) -> list[tuple[str, str]]:
    """How the candidates were drawn and run."""
    drawn = "given in a file" if spec.points else {"cma": "searched by CMA-ES"}.get(spec.method, spec.method)
    return [
        ("programs", ", ".join(spec.programs)),
        ("points", f"{drawn}, seed {spec.seed}"),
        ("worlds for each", str(spec.repeats)),
        ("device", spec.device),
        ("time step", "chosen" if spec.time_step is None else f"at most {number(spec.time_step)} s"),
        ("simulated at once", str(spec.together)),
    ]


def patches(folder: SweepFolder, spec: Spec) -> list[tuple[str, str, Diff]]:
    """Of each patched program its name, that of the one that it is a patch of, and what it changes."""
    texts = {name: (folder.path / name).read_text(encoding="utf-8") for pair in spec.patched.items() for name in pair}
    return [(name, of, make_diff(diff(texts[of], texts[name]))) for name, of in spec.patched.items()]


def walk(parameter: Axis, axis: Axis) -> str:
    """What a parameter ranged over, and which others it went with."""
    others = ", ".join(each.name for each in axis.parameters if each != parameter)
    return span(parameter) + (f", together with {others}" if others else "")


def span(axis: Axis | Draw) -> str:
    """What a parameter ranged over, or was drawn from."""
    if isinstance(axis, Draw):
        how = {"even": "", "log": ", by its logarithm", "normal": ", normally"}[axis.spread]
        return f"{number(axis.low, 4)} … {number(axis.high, 4)}, drawn for each{how}"
    if axis.values:
        return ", ".join(number(value, 4) for value in axis.values)
    return f"{number(axis.low, 4)} … {number(axis.high, 4)}" + (", by its logarithm" if axis.scale == "log" else "")


def fulls(folder: SweepFolder, outcomes: Sequence[Outcome]) -> list[Full]:
    """The candidates that were run in full, the best first."""
    found = []
    for outcome in outcomes:
        run = folder.path / "candidates" / f"{outcome.candidate.number:04d}"
        if not run.is_dir():
            continue
        report = run / "report.html"
        stills = [still for each in sorted((run / "iterations").glob("[0-9]*")) for still in find_stills(each)]
        link = report.relative_to(folder.path).as_posix() if report.is_file() else ""
        found.append(Full(outcome, link, stills[-1] if stills else None))
    return found


def reasons(outcomes: Sequence[Outcome]) -> list[Reason]:
    """What failed in what was not accepted, the most frequent first."""
    groups: dict[tuple[str, tuple[str, ...]], list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.status != "accepted":
            groups.setdefault((outcome.status, tuple(outcome.failures)), []).append(outcome)
    found = [Reason(status, list(failures), len(of), of[0]) for (status, failures), of in groups.items()]
    return sorted(found, key=lambda reason: -reason.count)[:MOST_REASONS]
