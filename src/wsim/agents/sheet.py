"""What a reviewer is shown of a run: a few small pictures on one sheet, taken where something changes."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from wsim.recording.video import read_video

TILES, COLUMNS, OTHERS = 6, 3, 2
TILE, THUMB = (256, 144), (64, 36)  # px, as shown and as compared
QUALITY = 60  # of the JPEG: 15 to 20 kB for six tiles
MOST_FRAMES = 120  # of a video that are looked at


def shares(folder: Path) -> list[dict[str, Any]]:
    """What the stills show, from review.json: rows of camera, time and objects; the filmed camera comes first."""
    path = folder / "review.json"
    return json.loads(path.read_text(encoding="utf-8")).get("share_of_picture", []) if path.is_file() else []


def contact_sheet(folder: Path, order: Sequence[str] = ()) -> tuple[bytes, list[str]]:
    """One small JPEG, and what each picture on it is.

    Of the camera that was filmed, the start, the end, and those moments of the video that differ most from all that
    are there already; of up to two others, how it ends.

    Args:
        folder: An iteration's, with video.mp4, frames and review.json.
        order: Names of cameras, those of the others that come first.
    """
    rows = shares(folder)
    if not rows or not (folder / "video.mp4").is_file():
        return b"", []
    filmed = rows[0]["camera"].rsplit("/", 1)[-1]
    ends = {path.stem.rpartition("_")[0]: path for path in sorted((folder / "frames").glob("*s.png"))}
    others = [name for name in dict.fromkeys([*order, *ends]) if name in ends and name != filmed][:OTHERS]
    tiles = [(f"{filmed} {time:06.3f}s", frame) for time, frame in _moments(folder / "video.mp4", TILES - len(others))]
    for name in others:
        with Image.open(ends[name]) as picture:
            shown = picture.convert("RGB").resize(TILE, Image.Resampling.LANCZOS)
        tiles.append((f"{name} {ends[name].stem.rpartition('_')[2]}", shown))
    sheet = Image.new("RGB", (TILE[0] * min(COLUMNS, len(tiles)), TILE[1] * -(-len(tiles) // COLUMNS)))
    for k, (_, tile) in enumerate(tiles):
        sheet.paste(tile, (TILE[0] * (k % COLUMNS), TILE[1] * (k // COLUMNS)))
    out = io.BytesIO()
    sheet.save(out, "JPEG", quality=QUALITY, optimize=True)
    return out.getvalue(), [label for label, _ in tiles]


def _moments(video: Path, count: int) -> list[tuple[float, Image.Image]]:
    """The first and the last frame, and in between those that differ most from all that are chosen already."""
    frames = [
        (time, Image.fromarray(frame).resize(TILE, Image.Resampling.BOX))
        for time, frame in read_video(video, MOST_FRAMES)
    ]
    small = np.stack([np.asarray(frame.resize(THUMB, Image.Resampling.BOX), np.int16) for _, frame in frames])
    chosen = [0, len(frames) - 1] if len(frames) > 1 else [0]
    while len(chosen) < min(count, len(frames)):
        change = np.min([np.abs(small - small[k]).mean(axis=(1, 2, 3)) for k in chosen], axis=0)
        change[chosen] = -1.0
        chosen.append(int(np.argmax(change)))
    return [frames[k] for k in sorted(chosen)]
