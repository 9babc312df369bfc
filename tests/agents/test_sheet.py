"""The sheet of pictures that a reviewer is shown: few, and where something changes."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from wsim.agents.sheet import COLUMNS, TILE, TILES, contact_sheet
from wsim.judge.verdict import Finding, Verdict
from wsim.recording.video import write_video
from wsim.sim.seen import still_name, write_png

SIZE = (36, 64, 3)


def filmed(folder: Path, grey: list[int], others: tuple[str, ...] = ()) -> Path:
    """An iteration's pictures: a video of plain frames at 10 a second, and other cameras' first and last stills."""
    write_video(folder / "video.mp4", (np.full(SIZE, level, np.uint8) for level in grey), 10)
    end, rows = (len(grey) - 1) / 10, []
    for time in (0.0, end):
        for name in ("side", *others):
            rows.append({"camera": f"/World/{name}", "time": time, "objects": {}})
            write_png(folder / "frames" / still_name(f"/World/{name}", time), np.full(SIZE, 50, np.uint8))
    (folder / "review.json").write_text(json.dumps({"share_of_picture": rows}))
    return folder


def test_the_moments_are_where_something_changes(tmp_path: Path) -> None:
    """A dark world with a flash, a glimmer, and an end that is as the start: evenly spaced pictures show neither."""
    grey = [0] * 100
    grey[37], grey[61:64] = 255, [120] * 3
    data, labels = contact_sheet(filmed(tmp_path, grey))
    assert len(labels) == TILES
    assert {"side 00.000s", "side 03.700s", "side 09.900s"} <= set(labels)
    assert {"side 06.100s", "side 06.200s", "side 06.300s"} & set(labels)
    assert labels == sorted(labels)
    with Image.open(io.BytesIO(data)) as sheet:
        assert (sheet.format, sheet.size) == ("JPEG", (TILE[0] * COLUMNS, TILE[1] * 2))
        flash = labels.index("side 03.700s")
        x, y = (flash % COLUMNS + 0.5) * TILE[0], (flash // COLUMNS + 0.5) * TILE[1]
        assert min(sheet.getpixel((int(x), int(y)))) > 240
    assert contact_sheet(tmp_path) == (data, labels)


def test_what_is_told_to_happen_comes_first(tmp_path: Path) -> None:
    """The objective's moment, then others by their weight; what changes most fills the rest."""
    grey = [0] * 100
    grey[37] = 255
    folder = filmed(tmp_path, grey)
    told = [{"time": 5.0, "what": "ball touches", "weight": 0.9}, {"time": 8.0, "what": "ball rests", "weight": 0.4}]
    review = json.loads((folder / "review.json").read_text())
    (folder / "review.json").write_text(json.dumps(review | {"moments": told}))
    finding = Finding(check="ObjectiveReaches", passed=True, message="there", objective="reaches", time=2.5)
    (folder / "verdict.json").write_text(Verdict(status="accepted", summary="", findings=[finding]).model_dump_json())
    _, labels = contact_sheet(folder)
    assert labels == [
        "side 00.000s", "side 02.500s (ObjectiveReaches)", "side 03.700s", "side 05.000s (ball touches)",
        "side 08.000s (ball rests)", "side 09.900s",
    ]  # fmt: skip


def test_other_cameras_show_how_it_ends(tmp_path: Path) -> None:
    filmed(tmp_path, list(range(0, 250, 10)), ("above", "front", "back"))
    _, labels = contact_sheet(tmp_path, ["side", "back"])  # as the plan has them
    assert labels[-2:] == ["back 02.400s", "above 02.400s"]
    assert [label.split()[0] for label in labels[:4]] == ["side"] * 4
    assert (labels[0], labels[3]) == ("side 00.000s", "side 02.400s")


@pytest.mark.parametrize(("frames", "tiles"), [(1, 1), (2, 2), (4, 4)])
def test_short_videos_are_shown_whole(tmp_path: Path, frames: int, tiles: int) -> None:
    data, labels = contact_sheet(filmed(tmp_path, [10 * k for k in range(frames)]))
    assert len(labels) == tiles
    with Image.open(io.BytesIO(data)) as sheet:
        assert sheet.width == TILE[0] * min(COLUMNS, tiles)


def test_without_pictures_there_is_no_sheet(tmp_path: Path) -> None:
    assert contact_sheet(tmp_path) == (b"", [])
