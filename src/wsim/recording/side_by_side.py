"""Several recordings in one, for one viewer: each below an entity of its own, laid out in columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from wsim.recording.blueprint import BACKGROUND, eye_controls
from wsim.recording.columns import APPLICATION, HEIGHT_ROOT, LOG_ENTITY, TIMELINE, entity_path, log_level
from wsim.recording.reader import read_world

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import World

MOST = 8  # columns that a screen has room for
KEPT = ("/World", "/plots", "/heights", "/log")  # what is drawn


@dataclass(frozen=True)
class Course:
    """A quantity that was judged, over time: (T,) [s], (T,), and what it is held to."""

    title: str
    time: NDArray[np.float64]
    value: NDArray[np.float64]
    limit: float | None = None


@dataclass(frozen=True)
class Part:
    """A recording, what it is called, and what its verdict says: `marks` are time [s], level and text."""

    name: str
    path: Path
    marks: Sequence[tuple[float, str, str]] = ()
    courses: Sequence[Course] = field(default_factory=tuple)


def write_side_by_side(parts: Sequence[Part], target: Path) -> Path:
    """Write one recording with all parts, at the same time of their worlds.

    Args:
        parts: At most `MOST`; more make columns that nobody can see.
        target: Where it goes.

    Raises:
        UserError: If a recording cannot be read.
    """
    worlds = [read_world(part.path) for part in parts]
    stream = rr.RecordingStream(APPLICATION)
    stream.save(target)
    for k, part in enumerate(parts):
        root = _root(k)
        chunks = (chunk for chunk in RrdReader(part.path).stream() if chunk.entity_path.startswith(KEPT))
        stream.send_chunks(chunk.with_entity_path(f"{root}{chunk.entity_path}") for chunk in chunks)
        for time, level, text in part.marks:
            stream.set_time(TIMELINE, duration=time)
            stream.log(f"{root}/findings", rr.TextLog(f"{part.name}: {text}", level=log_level(level)))
        for course in part.courses:
            _log_course(stream, f"{root}/judged/{_word(course.title)}", course)
    stream.send_blueprint(_layout(parts, worlds))
    stream.flush()
    stream.disconnect()
    return target


def _root(k: int) -> str:
    return f"/{k + 1:02d}"


def _word(title: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", title).strip("_") or "value"


def _log_course(stream: Any, entity: str, course: Course) -> None:
    seen = np.isfinite(course.value)
    if not seen.any():
        return
    times = rr.TimeColumn(TIMELINE, duration=course.time[seen])
    stream.send_columns(f"{entity}/value", [times], rr.Scalars.columns(scalars=course.value[seen]))
    if course.limit is not None:
        ends = rr.TimeColumn(TIMELINE, duration=course.time[seen][[0, -1]])
        stream.send_columns(f"{entity}/limit", [ends], rr.Scalars.columns(scalars=[course.limit] * 2))


def _layout(parts: Sequence[Part], worlds: Sequence[World]) -> Any:
    """A column for each part: its world, its first camera, what was judged; below them the findings and the log."""
    columns = [
        rrb.Vertical(*_views(k, part, world), name=part.name)
        for k, (part, world) in enumerate(zip(parts, worlds, strict=True))
    ]
    findings = rrb.TextLogView(
        name="Findings", origin="/", contents=[f"{_root(k)}/findings" for k in range(len(parts))]
    )
    log = rrb.TextLogView(name="Log", origin="/", contents=[f"{_root(k)}{LOG_ENTITY}/**" for k in range(len(parts))])
    return rrb.Blueprint(
        rrb.Vertical(rrb.Horizontal(*columns), rrb.Horizontal(findings, log), row_shares=[4, 1]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, loop_mode="all", play_state="playing"),
    )


def _views(k: int, part: Part, world: World) -> list[Any]:
    root = _root(k)
    views: list[Any] = [
        rrb.Spatial3DView(
            name=part.name,
            origin=root,
            contents=[f"{root}/World/**"],
            background=BACKGROUND,
            line_grid=False,
            eye_controls=eye_controls(world, None),
        )
    ]
    if world.cameras:
        camera = world.cameras[0].prim
        views.append(rrb.Spatial2DView(name=camera.rsplit("/", 1)[-1], origin=f"{root}{entity_path(camera)}"))
    if part.courses:
        views.append(rrb.TimeSeriesView(name="What was judged", origin=root, contents=[f"{root}/judged/**"]))
    elif world.bodies:
        heights = f"{root}{HEIGHT_ROOT}**"
        views.append(rrb.TimeSeriesView(name="Height of bodies [m]", origin=root, contents=[heights]))
    return views
