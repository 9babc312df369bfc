"""The builtin planner's data, in `language/`."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def read(name: str) -> dict[str, Any]:
    """A file of it."""
    return tomllib.loads((files("wsim.rules") / "language" / f"{name}.toml").read_text(encoding="utf-8"))
