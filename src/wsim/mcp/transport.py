"""How the server is reached: over the process's own streams, or over HTTP from this machine alone."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable
from io import TextIOWrapper

import anyio
import uvicorn
from mcp.server import Server
from mcp.server.stdio import stdio_server

from wsim.errors import UserError

LOOPBACK = "127.0.0.1"
PATH = "/mcp"
GRACE = 2  # seconds that open connections have to end in when the server does


def take_stdout() -> TextIOWrapper:
    """What was standard output, for the protocol alone: from here on all that prints, prints to standard error.

    The descriptor itself is turned, and not turned back: Warp's and MuJoCo's libraries, child processes, and buffers
    that are emptied at the end do not go through `sys.stdout`.
    """
    sys.stdout.flush()
    wire = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    return wire


def serve_stdio(server: Server, wire: TextIOWrapper) -> None:
    """Serve one client over standard input and `wire`, until it closes them."""

    async def serve() -> None:
        async with stdio_server(stdout=anyio.wrap_file(wire)) as (receive, send):
            await server.run(receive, send, server.create_initialization_options())

    anyio.run(serve)


def serve_http(server: Server, port: int, ready: Callable[[str], None]) -> None:
    """Serve clients of this machine over streamable HTTP, until the process is interrupted.

    It listens on 127.0.0.1 alone. The SDK refuses a request whose Host or Origin is another name than this machine's,
    so that no web page in a browser here can reach the tools through a name of its own (DNS rebinding).

    Args:
        server: What answers.
        port: Port; 0 for any that is free.
        ready: Told the address once it can be reached.

    Raises:
        UserError: If the port is taken.
    """
    listener = socket.socket()
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((LOOPBACK, port))
        listener.listen()
    except OSError as error:
        raise UserError(f"--port {port}: {error.strerror}; choose another, or 0 for any that is free") from error
    app = server.streamable_http_app(streamable_http_path=PATH, host=LOOPBACK)
    config = uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=GRACE)
    with listener:
        ready(f"http://{LOOPBACK}:{listener.getsockname()[1]}{PATH}")
        anyio.run(lambda: uvicorn.Server(config).serve(sockets=[listener]))
