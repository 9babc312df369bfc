"""Deterministic tools: the same functions for agents, the command line and MCP.

    from wsim.tools import TOOLS, Workspace

    TOOLS["query_recording"](Workspace(run), signal="speed", prim="ball", reduction="max").text

Each takes checked arguments and answers in a few lines. docs/tools.md shows what each answers.
"""

from __future__ import annotations

from wsim.tools import acceptance, catalogue, plan, program, query, reference, run, stills, verdict
from wsim.tools.base import Arguments, Result, Tool, Workspace

__all__ = ["TOOLS", "Arguments", "Result", "Tool", "Workspace"]

TOOLS: dict[str, Tool] = {
    tool.name: tool
    for module in (catalogue, reference, plan, program, run, query, stills, verdict, acceptance)
    for tool in module.TOOLS
}
