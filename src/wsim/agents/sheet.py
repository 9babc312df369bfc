"""What a reviewer is shown of a run: a few small pictures on one sheet, taken when something happens."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from wsim.judge.verdict import Verdict
from wsim.recording.video import read_video

TILES, COLUMNS, OTHERS = 6, 3, 2
TILE, THUMB = (256, 144), (64, 36)  # px, as shown and as compared
QUALITY = 60  # of the JPEG: 15 to 20 kB for six tiles
MOST_FRAMES = 120  # of a video that are looked at


def shares(folder: Path) -> list[dict[str, Any]]:
    """What the stills show, from review.json: rows of camera, time and objects; the filmed camera comes first."""
    path = folder / "review.json"
    return json.loads(path.read_text(encoding="utf-8")).get("share_of_picture", []) if path.is_file() else []


def moments(folder: Path) -> list[tuple[float, str]]:
    """Times [s] at which something happens, and what, the weightiest first: what objectives are judged by, then others.

    Args:
        folder: An iteration's, with a verdict.json and a review.json, or without.
    """
    found, verdict, review = [], folder / "verdict.json", folder / "review.json"
    if verdict.is_file():
        for finding in Verdict.model_validate_json(verdict.read_text(encoding="utf-8")).findings:
            if finding.objective is not None and finding.time is not None:
                found.append((finding.time, finding.check))
    if review.is_file():
        told = json.loads(review.read_text(encoding="utf-8")).get("moments", [])
        found += [(row["time"], row["what"]) for row in sorted(told, key=lambda row: (-row["weight"], row["time"]))]
    return found


def contact_sheet(folder: Path, order: Sequence[str] = ()) -> tuple[bytes, list[str]]:
    """One small JPEG, and what each picture on it is.

    Of the camera that was filmed, the start, the end, what happens between (`moments`), and, where that is less than
    there is room for, the frames that differ most from all that are there already; of up to two others, how it ends.

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
    chosen = _chosen(folder / "video.mp4", TILES - len(others), moments(folder))
    tiles = [(f"{filmed} {time:06.3f}s{what}", frame) for time, what, frame in chosen]
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


def _chosen(video: Path, count: int, told: Sequence[tuple[float, str]]) -> list[tuple[float, str, Image.Image]]:
    """Time, what happens and frame: the first, the last, some that are told, and those that differ most from those."""
    frames = [
        (time, Image.fromarray(frame).resize(TILE, Image.Resampling.BOX))
        for time, frame in read_video(video, MOST_FRAMES)
    ]
    times = np.array([time for time, _ in frames])
    words = {0: "", len(frames) - 1: ""}
    apart = max(1, len(frames) // (4 * count))
    for time, what in told:
        k = int(np.abs(times - time).argmin())
        if len(words) < min(count, len(frames)) and min(abs(k - other) for other in words) >= apart:
            words[k] = f" ({what})"
    small = np.stack([np.asarray(frame.resize(THUMB, Image.Resampling.BOX), np.int16) for _, frame in frames])
    while len(words) < min(count, len(frames)):
        change = np.min([np.abs(small - small[k]).mean(axis=(1, 2, 3)) for k in words], axis=0)
        change[list(words)] = -1.0
        words[int(np.argmax(change))] = ""
    return [(frames[k][0], words[k], frames[k][1]) for k in sorted(words)]
