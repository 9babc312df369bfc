"""The tools for any coding agent: a Model Context Protocol server over stdio and loopback HTTP.

The protocol's SDK is loaded by the modules that speak it, when `wsim mcp` starts one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.mcp.desk import Desk
    from wsim.mcp.server import make_server
    from wsim.mcp.transport import serve_http, serve_stdio, take_stdout

__all__ = ["Desk", "make_server", "serve_http", "serve_stdio", "take_stdout"]

__getattr__ = door(
    __name__,
    {
        "Desk": "desk",
        "make_server": "server",
        "serve_http": "transport",
        "serve_stdio": "transport",
        "take_stdout": "transport",
    },
)
