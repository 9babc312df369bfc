"""The report of a run: one HTML file that opens offline."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.report.page import make_ready, write

__all__ = ["make_ready", "write"]

__getattr__ = door(__name__, {"make_ready": "page", "write": "page"})
