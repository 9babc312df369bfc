"""Replies kept by request, so that what was asked before costs nothing."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import Any


def folder() -> Path:
    """Where replies are kept: $XDG_CACHE_HOME/wsim/replies, or ~/.cache/wsim/replies."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "wsim" / "replies"


def get(key: str) -> dict[str, Any] | None:
    """The reply of a request, if it is kept."""
    try:
        found = json.loads((folder() / f"{key}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and "text" in found else None


def drop(key: str) -> None:
    """Forget a reply."""
    with contextlib.suppress(OSError):
        (folder() / f"{key}.json").unlink(missing_ok=True)


def put(key: str, reply: dict[str, Any]) -> None:
    """Keep a reply; where nothing can be written, nothing is kept."""
    path = folder() / f"{key}.json"
    side = path.with_suffix(f".{os.getpid()}.part")
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        side.write_text(json.dumps(reply, ensure_ascii=False), encoding="utf-8")
        side.replace(path)
