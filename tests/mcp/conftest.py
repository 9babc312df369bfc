"""A real client of the protocol, and the server that it starts."""

from __future__ import annotations

import os
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters
from mcp.client.stdio import stdio_client
from mcp.types import CallToolResult

Open = Callable[..., AbstractAsyncContextManager["Talk"]]
WITH_LOUD_TOOLS = Path(__file__).parent / "loud_server.py"


class Talk:
    """A client at work: a call is one line, and its answer is text."""

    def __init__(self, client: Client, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self.told: list[tuple[float, str]] = []  # progress of the calls

    @property
    def runs(self) -> list[Path]:
        """The runs' folders."""
        return sorted((self.folder / "runs").iterdir()) if (self.folder / "runs").is_dir() else []

    @property
    def stderr(self) -> str:
        """What the server has printed."""
        return (self.folder / "stderr").read_text()

    async def ask(self, tool: str, **arguments: Any) -> CallToolResult:
        async def told(progress: float, total: float | None, message: str | None) -> None:
            self.told.append((progress, message or ""))

        return await self.client.call_tool(tool, arguments, progress_callback=told)

    async def good(self, tool: str, **arguments: Any) -> str:
        """The text of an answer that is no error."""
        result = await self.ask(tool, **arguments)
        assert not result.is_error, result.content[0].text
        return result.content[0].text

    async def bad(self, tool: str, **arguments: Any) -> str:
        """The text of an answer that is an error: a line or a table, never a traceback."""
        result = await self.ask(tool, **arguments)
        assert result.is_error, result.content[0].text
        assert "Traceback" not in result.content[0].text
        return result.content[0].text


def server_command(folder: Path, *options: str, loud: bool = False) -> list[str]:
    module = [str(WITH_LOUD_TOOLS)] if loud else ["-m", "wsim.cli"]
    return [sys.executable, *module, "mcp", "--device", "cpu", "--runs", str(folder / "runs"), *options]


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def talk(tmp_path: Path) -> Open:
    """Start `wsim mcp` over stdio, and talk to it."""

    @asynccontextmanager
    async def start(loud: bool = False, mode: str = "auto") -> AsyncIterator[Talk]:
        command = server_command(tmp_path, loud=loud)
        server = StdioServerParameters(command=command[0], args=command[1:], env=dict(os.environ), cwd=tmp_path)
        with (tmp_path / "stderr").open("a") as errors:
            async with Client(stdio_client(server, errlog=errors), mode=mode) as client:
                yield Talk(client, tmp_path)

    return start
