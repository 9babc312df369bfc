"""The report of a run: one HTML file that opens offline."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.report.page import write

__all__ = ["write"]

__getattr__ = door(__name__, {"write": "page"})
