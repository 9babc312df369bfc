"""Deterministic tools: the same functions for agents, the command line and MCP.

    from wsim.tools import TOOLS, Workspace

    TOOLS["query_recording"](Workspace(run), signal="speed", prim="ball", reduction="max").text

Each takes checked arguments and answers in a few lines. docs/tools.md shows what each answers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.tools.base import Arguments, Result, Tool, Workspace
    from wsim.tools.registry import TOOLS

__all__ = ["TOOLS", "Arguments", "Result", "Tool", "Workspace"]

__getattr__ = door(
    __name__, {"TOOLS": "registry", "Arguments": "base", "Result": "base", "Tool": "base", "Workspace": "base"}
)
