"""All tools by name. A new one is named in its file's `TOOLS`; a new file, here."""

from __future__ import annotations

from wsim.tools import acceptance, catalogue, plan, program, query, reference, run, stills, verdict
from wsim.tools.base import Tool

TOOLS: dict[str, Tool] = {
    tool.name: tool
    for module in (catalogue, reference, plan, program, run, query, stills, verdict, acceptance)
    for tool in module.TOOLS
}
