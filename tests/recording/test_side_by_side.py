"""Several recordings in one: each below its own entity, at the same times."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rerun.chunk import RrdReader

from wsim.recording import RecordingWriter, read
from wsim.recording.side_by_side import Course, Part, write_side_by_side

FRAMES = 3


def _recorded(folder: Path, name: str, world, make_frame) -> Path:
    with RecordingWriter(folder / f"{name}.rrd", world) as writer:
        for i in range(FRAMES):
            writer.frame(i / 30, make_frame(i))
        writer.log(0.0, "info", f"{name} started")
    return folder / f"{name}.rrd"


def test_each_part_is_whole_below_its_own_entity(tmp_path, world, make_frame):
    paths = [_recorded(tmp_path, name, world, make_frame) for name in ("one", "two", "three")]
    course = Course("height [m]", np.arange(FRAMES) / 30, np.array([1.0, np.nan, 0.5]), limit=0.7)
    parts = [
        Part("iteration 1: rejected", paths[0], [(1 / 30, "ERROR", "✗ it falls")], [course]),
        Part("iteration 2: accepted", paths[1]),
        Part("iteration 3: not judged", paths[2]),
    ]
    made = write_side_by_side(parts, tmp_path / "all.rrd")
    found: dict[str, list] = {}
    for chunk in RrdReader(made).stream():
        found.setdefault(chunk.entity_path, []).append(chunk)
    body = next(body for body in read(paths[0]).world.bodies)
    for k in range(3):
        (moving,) = (chunk for chunk in found[f"/0{k + 1}{body.prim}"] if not chunk.is_static)
        assert moving.num_rows == FRAMES
    assert "/01/frames" not in found
    (value,), (limit,) = found["/01/judged/height_m/value"], found["/01/judged/height_m/limit"]
    scalars = [chunk.to_record_batch().column("Scalars:scalars").to_pylist() for chunk in (value, limit)]
    assert scalars == [[[1.0], [0.5]], [[0.7], [0.7]]]
    (mark,) = found["/01/findings"]
    batch = mark.to_record_batch()
    assert batch.column("TextLog:text").to_pylist() == [["iteration 1: rejected: ✗ it falls"]]
    assert batch.column("sim_time").cast("int64").to_pylist() == [round(1e9 / 30)]
    assert not any(path.startswith(("/02/judged", "/03/findings")) for path in found)
