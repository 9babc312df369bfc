"""Check several stages that a program wrote; see `check_task`. What is sound is described, too, while it is open."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pxr import Usd

from wsim.program.inside.build_task import in_one_thread, write
from wsim.program.inside.builds_task import head, parts
from wsim.scene.check import check_opened
from wsim.scene.reading import read
from wsim.scene.skeleton import skeleton_of

MOST_TOLD = 1 << 20  # bytes of a description: longer ones, of large meshes, are had sooner from the stage


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Wait until the stages are in `stages_fd`, one behind the other, then say which have no problem.

    Where there is a `told_fd`, what each sound one states is appended to it (`wsim.scene.reading`), behind its size: 0
    of what is not sound, or not told.
    """
    in_one_thread()
    if os.read(0, 1) != b"g":
        os._exit(0)
    source, roots, target = job["stages_fd"], [Path(root) for root in job["roots"]], job.get("told_fd")
    sound, known = [], set[str]()
    for k, (at, size) in enumerate(parts(source, job["count"])):
        told = b""
        text = os.pread(source, size, at) if 0 < size <= job["most"] else b""
        if text and len(text) == size:
            path = Path(job["scratch"]) / f"stage_{k}.usda"
            stage, own = _sound(text, path, roots, known)
            if stage is not None:
                sound.append(k)
                told = b"" if target is None else _told(path, stage, own)
        if target is not None:
            write(target, head(len(told)) + told)
    return {"outcome": "ok", "sound": sound}


def _sound(text: bytes, path: Path, roots: list[Path], known: set[str]) -> tuple[Usd.Stage | None, str]:
    """A stage, opened from a file of its own that is gone again, if there is nothing wrong with it; its skeleton."""
    own = skeleton_of(text)
    try:
        path.write_bytes(text)
        _, stage = check_opened(path, roots, known=own in known)
    except OSError:  # no room for it: who builds it alone says so
        return None, own
    finally:
        path.unlink(missing_ok=True)
    if stage is not None and own:
        known.add(own)
    return stage, own


def _told(path: Path, stage: Usd.Stage, own: str) -> bytes:
    try:
        told = read(path, stage, own).to_json()
    except Exception:  # noqa: BLE001 - who describes it again says why
        return b""
    return told if len(told) <= MOST_TOLD else b""
