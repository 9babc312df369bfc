"""Device, versions, sizes and seconds of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsim.report.numbers import number, quantity
from wsim.report.text import duration, plain

if TYPE_CHECKING:
    from wsim.report.contents import RunContents

# Of run.json: what is shown elsewhere on the page; of a run with a loop also what tells of it, and how it was started.
HIDDEN = {"prompt", "title", "status", "summary", "seconds", "phases"}
OF_LOOP = {"iterations", "best", "usage", "skills", "notes", "cause", "budget", "settings", "confirm"}
SLOWEST = 5  # modules that are named


def make_facts(contents: RunContents) -> list[tuple[str, list[tuple[str, str]]]]:
    """(heading, rows of name and text), leaving out what is not known."""
    groups = [("Simulation", _simulation(contents)), ("Wall time", _seconds(contents)), ("Run", _run(contents))]
    metadata = contents.recording.metadata if contents.recording else {}
    versions = metadata.get("versions")
    if isinstance(versions, dict):
        groups.append(("Versions", [(str(name), plain(value)) for name, value in versions.items()]))
    return [(heading, [row for row in rows if row[1]]) for heading, rows in groups if any(row[1] for row in rows)]


def make_parameters(contents: RunContents) -> list[dict[str, str]]:
    """The numbers of the program that a sweep may change."""
    if contents.recording is None:
        return []
    return [
        {
            "name": item.name,
            "value": quantity(item.value, item.unit, 5),
            "default": "" if item.value == item.default else quantity(item.default, item.unit, 5),
            "range": f"{number(item.low, 5) or '−∞'} … {number(item.high, 5) or '∞'}"
            if item.low is not None or item.high is not None
            else "",
        }
        for item in contents.recording.world.parameters
    ]


def _simulation(contents: RunContents) -> list[tuple[str, str]]:
    checked = contents.shown.simulation() if contents.shown else {}
    recording = contents.recording
    metadata: dict[str, Any] = recording.metadata if recording else {}
    known = {**metadata, **checked}
    step = _float(known.get("time_step") or known.get("dt"))
    reason = known.get("time_step_reason")
    rows = [
        ("device", plain(known.get("device"))),
        ("time step", quantity(step * 1e3, "ms", 4) + (f" ({reason})" if reason else "") if step else ""),
        ("steps", _count(known.get("steps"))),
        ("fluid particles", _count(known.get("particles"))),
        ("boundary particles", _count(known.get("boundary_particles"))),
        ("speed of sound", quantity(_float(known.get("speed_of_sound")), "m/s")),
    ]
    if recording is not None:
        world = recording.world
        rows += [
            ("simulated", quantity(float(recording.time[-1]), "s") if len(recording.time) else "nothing"),
            ("frames", f"{len(recording.time)} at {quantity(world.frame_rate, '/s')}"),
            ("bodies", _count(len(world.bodies))),
            ("seed", plain(world.seed)),
        ]
    return rows


def _seconds(contents: RunContents) -> list[tuple[str, str]]:
    stages = contents.shown.seconds() if contents.shown else {}
    phases = contents.facts.get("phases")
    of_run = {name: value for name, value in phases.items() if name != "try"} if isinstance(phases, dict) else {}
    before = {name: of_run.pop(name) for name in ("start-up", "plan") if name in of_run}
    rows = [(str(name), duration(_float(value))) for name, value in {**before, **stages, **of_run}.items()]
    return [*rows, *_compiled(contents), ("whole run", duration(_float(contents.facts.get("seconds"))))]


def _compiled(contents: RunContents) -> list[tuple[str, str]]:
    """The modules that took longest to compile, several at once, in what was to prepare."""
    found = contents.shown.simulation().get("compiled") if contents.shown else None
    seconds = {str(name): _float(value) or 0.0 for name, value in found.items()} if isinstance(found, dict) else {}
    slowest = sorted(seconds, key=seconds.__getitem__, reverse=True)[:SLOWEST]
    return [(f"compiling {name.rsplit('.', 1)[-1]}", duration(seconds[name])) for name in slowest]


def _run(contents: RunContents) -> list[tuple[str, str]]:
    hidden = HIDDEN | (OF_LOOP if contents.loop.looped else set()) | ({"models"} if contents.loop.usage else set())
    rows = [(str(name).replace("_", " "), plain(value)) for name, value in contents.facts.items() if name not in hidden]
    build = contents.shown.build() if contents.shown else {}
    return [*rows, ("isolation", plain(build.get("isolation")))]


def _count(value: Any) -> str:
    return number(float(value), 9) if isinstance(value, int) and value else ""


def _float(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None
