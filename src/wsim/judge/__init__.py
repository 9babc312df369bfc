"""The judge: a recording is held against physics and against its plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.judge.decide import judge

__all__ = ["judge"]

__getattr__ = door(__name__, {"judge": "decide"})
