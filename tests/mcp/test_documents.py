"""docs/mcp.md says what there is."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from wsim.mcp.desk import Desk
from wsim.mcp.prompt_texts import NAMES
from wsim.mcp.resources import readables
from wsim.mcp.server import Answers
from wsim.tools.text import LIMIT

PAGE = (Path(__file__).parents[2] / "docs" / "mcp.md").read_text()


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path / "runs")


def test_the_table_lists_every_tool(desk: Desk) -> None:
    tools = Answers(desk).tools.values()
    true = [f"| `{tool.name}` | {'writes' if tool.writes else ''} | {tool.description} |" for tool in tools]
    rows = re.findall(r"^\| `\w+` \| (?:writes)? \| .* \|$", PAGE, re.MULTILINE)
    assert rows == true, "the table must be:\n" + "\n".join(true)


def test_every_resource_and_prompt_is_named(desk: Desk) -> None:
    for uri in readables(desk):
        assert uri.startswith("skill://") or f"`{uri}`" in PAGE
    assert re.findall(r"^\| `(\w+)` \| `prompt` \|", PAGE, re.MULTILINE) == list(NAMES)
    assert f"at most {LIMIT:,} characters" in PAGE


def test_its_settings_are_json() -> None:
    found = re.findall(r"^    (\{.*?^    \}|\{.*\})$", PAGE, re.MULTILINE | re.DOTALL)
    assert [list(json.loads(each)) for each in found] == [["mcpServers"], ["mcpServers"]]
