"""How the server is reached: nothing but the protocol on standard output, and nobody but this machine over HTTP."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from mcp import Client

from tests import children
from tests.mcp.conftest import server_command
from tests.patience import STUCK, until

HELLO = {
    "method": "initialize",
    "params": {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "0"}},
}


def call(tool: str, **arguments: Any) -> dict[str, Any]:
    return {"method": "tools/call", "params": {"name": tool, "arguments": arguments}}


def converse(folder: Path, *requests: dict[str, Any]) -> tuple[list[str], str]:
    """Send requests by hand, each after the answer to the one before; all lines of both streams."""
    pipe = subprocess.PIPE
    command = server_command(folder, loud=True)
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with children.started(command, stdin=pipe, stdout=pipe, stderr=pipe, cwd=folder, env=buffered) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        lines = []
        for number, request in enumerate(requests):
            print(json.dumps({"jsonrpc": "2.0", "id": number, **request}), file=server.stdin, flush=True)
            lines.append(server.stdout.readline())
            if number == 0:
                print('{"jsonrpc":"2.0","method":"notifications/initialized"}', file=server.stdin, flush=True)
        rest, errors = server.communicate(timeout=STUCK)
    assert server.returncode == 0, errors
    return [*lines, *rest.splitlines()], errors


def test_standard_output_is_the_protocol_alone(tmp_path: Path) -> None:
    """Python, the descriptor, buffers of libraries that are emptied at the end, a child: all print elsewhere."""
    plan = call("make_plan", prompt="A wooden box slides down a ramp.")
    build = call("run_program", passes="build")
    lines, errors = converse(tmp_path, HELLO, call("loud"), plan, call("draft_program"), build, call("loud"))
    answers = [json.loads(line) for line in lines]
    assert [answer["id"] for answer in answers] == [0, 1, 2, 3, 4, 5]
    assert not any(answer["result"].get("isError") for answer in answers), lines
    for who in ("by Python", "to the descriptor", "by a C library", "by a child process", "by a Warp kernel"):
        assert errors.count(who) == 2


def test_a_client_that_leaves_ends_the_server(tmp_path: Path) -> None:
    """Also in the middle of a slow tool, which is stopped."""
    pipe = subprocess.PIPE
    command = server_command(tmp_path, loud=True)
    with children.started(command, stdin=pipe, stdout=pipe, stderr=pipe, cwd=tmp_path) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        for number, request in enumerate((HELLO, call("new_run", title="x"))):
            print(json.dumps({"jsonrpc": "2.0", "id": number, **request}), file=server.stdin, flush=True)
            server.stdout.readline()
        slow = {"jsonrpc": "2.0", "id": 2, **call("wait", seconds=100.0, name="a.wait")}
        print(json.dumps(slow), file=server.stdin, flush=True)
        until(lambda: list(tmp_path.glob("runs/*/a.wait")))
        _, errors = server.communicate(timeout=STUCK)
    assert server.returncode == 0, errors
    (note,) = tmp_path.glob("runs/*/a.wait")
    assert note.read_text() == "stopped by CancelledError"


@contextmanager
def http_server(folder: Path) -> Iterator[str]:
    """The address of a server that is up."""
    command = server_command(folder, "--http", "--port", "0")
    with children.started(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, cwd=folder) as server:
        assert server.stderr is not None
        try:
            address = re.search(r"http://\S+", server.stderr.readline())
            assert address is not None
            yield address[0]
        finally:
            server.send_signal(signal.SIGINT)
            _, errors = server.communicate(timeout=STUCK)
    assert server.returncode == 130, errors
    assert "Traceback" not in errors


@pytest.mark.anyio
async def test_over_http(tmp_path: Path) -> None:
    with http_server(tmp_path) as address:
        async with Client(address) as one:
            made = await one.call_tool("make_plan", {"prompt": "A wooden crate falls onto the ground."})
            assert not made.is_error
            await one.call_tool("draft_program")
            told: list[str] = []

            async def tell(progress: float, total: float | None, message: str | None) -> None:
                told.append(message or "")

            await one.call_tool("run_program", {"passes": "build"}, progress_callback=tell)
            assert told[0] == "building the stage: 0%"
        async with Client(address, mode="legacy") as other:  # the run is the server's, not the connection's
            assert "crate" in (await other.call_tool("read_plan")).content[0].text
        host, port = re.fullmatch(r"http://([\d.]+):(\d+)/mcp", address).groups()
        assert host == "127.0.0.1"
        with pytest.raises(OSError), socket.create_connection(("127.0.0.2", int(port)), timeout=5):
            pass  # another address of this machine: not listened on


def test_http_refuses_other_names(tmp_path: Path) -> None:
    with http_server(tmp_path) as address:
        assert post(address) == 200
        assert post(address, {"Host": "evil.example"}) == 421
        assert post(address, {"Origin": "http://evil.example"}) == 403


def post(address: str, headers: dict[str, str] | None = None) -> int:
    """Shake hands with the server; the answer's status."""
    common = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}
    body = json.dumps({"jsonrpc": "2.0", "id": 1, **HELLO}).encode()
    try:
        with urllib.request.urlopen(urllib.request.Request(address, body, common | (headers or {}))) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_a_port_that_is_of_no_use_is_one_line(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        for options, why in (["--http"], "address already in use"), ([], "only --http has a port"):
            command = server_command(tmp_path, *options, "--port", str(port))
            ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
            assert (ended.returncode, ended.stdout) == (2, "")
            assert ended.stderr.lower().startswith(f"wsim: --port {port}: {why}")
            assert ended.stderr.count("\n") == 1
    assert not (tmp_path / "runs").exists()
