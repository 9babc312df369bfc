"""An OpenAI-compatible server on loopback that answers from a script, and a place of its own for replies that are kept.

    server.script["coder"] = [status(500), text("...")]
    Models(coder=server.model("coder"))

It stands for what no test can have: a model. The client, and all that is made of the answers, is the real one.
"""

from __future__ import annotations

import json
import os
import select
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import pytest

Body = dict[str, Any]
Entry = Callable[["_Handler", Body], None]
TOKENS = {"prompt_tokens": 1000, "completion_tokens": 100, "total_tokens": 1100}


def reply(
    content: Any, finish: str = "stop", calls: list[Body] | None = None, usage: Any = TOKENS, **more: Any
) -> Body:
    """A chat completion as it goes over the wire."""
    message = {"role": "assistant", "content": content, **more} | ({"tool_calls": calls} if calls else {})
    choice = {"index": 0, "message": message, "finish_reason": finish}
    return {"id": "1", "object": "chat.completion", "created": 1, "model": "m", "choices": [choice], "usage": usage}


def text(content: str, finish: str = "stop", **more: Any) -> Entry:
    """An answer in words."""
    return lambda handler, body: handler.send(200, reply(content, finish, **more))


def call(name: str, arguments: Any = None, times: int = 1) -> Entry:
    """A call of a tool; arguments that are a string go as they are."""
    written = arguments if isinstance(arguments, str) else json.dumps(arguments or {})

    def send(handler: _Handler, body: Body) -> None:
        first = 100 * len(handler.server.requests)  # type: ignore[attr-defined]
        function = {"name": name, "arguments": written}
        calls = [{"id": f"call_{first + k}", "type": "function", "function": function} for k in range(times)]
        handler.send(200, reply(None, "tool_calls", calls))

    return send


def status(code: int, message: str = "no") -> Entry:
    """A refusal by the server."""
    return lambda handler, body: handler.send(code, {"error": {"message": message, "type": "t", "code": None}})


def raw(data: bytes, kind: str = "application/json") -> Entry:
    """A body that is whatever it is."""
    return lambda handler, body: handler.send_bytes(200, data, kind)


def hang(handler: _Handler, body: Body) -> None:
    """No answer, until the client goes."""
    handler.wait()


def cut(handler: _Handler, body: Body) -> None:
    """A connection that is closed in the middle of the answer."""
    handler.send_response(200)
    handler.send_header("Content-Type", "application/json")
    handler.send_header("Content-Length", "1000")
    handler.end_headers()
    handler.wfile.write(b'{"id": "1", "choi')
    handler.wfile.flush()


class _Handler(BaseHTTPRequestHandler):
    def log_message(self, format: str, *args: Any) -> None:
        pass

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        server: Server = self.server.scripted  # type: ignore[attr-defined]
        server.requests.append(body)
        script = server.script.get(body["model"], [])
        forever = server.forever.get(body["model"])
        if script:
            script.pop(0)(self, body)
        elif forever is not None:
            forever(self, body)
        else:
            self.send(418, {"error": {"message": f"the script has no answer left for the {body['model']}"}})

    def send(self, code: int, body: Body) -> None:
        self.send_bytes(code, json.dumps(body).encode(), "application/json")

    def send_bytes(self, code: int, data: bytes, kind: str) -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def wait(self) -> None:
        server: Server = self.server.scripted  # type: ignore[attr-defined]
        while not server.stopping.is_set() and not select.select([self.connection], [], [], 0.02)[0]:
            pass


class Server:
    """What is answered, by the model that is asked, and what was asked.

    Attributes:
        script: Answers that are given once each, in order.
        forever: The answer that is given when there are no others.
        requests: The bodies of all requests.
    """

    def __init__(self) -> None:
        self.script: dict[str, list[Entry]] = {}
        self.forever: dict[str, Entry] = {}
        self.requests: list[Body] = []
        self.stopping = threading.Event()
        self._http = HTTPServer(("127.0.0.1", 0), _Handler)
        self._http.scripted = self  # type: ignore[attr-defined]
        self._http.requests = self.requests  # type: ignore[attr-defined]
        self._http.handle_error = lambda *_: None  # type: ignore[method-assign]  # a client that goes is none
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True)
        self._thread.start()

    def model(self, name: str) -> str:
        """The name of a model that is asked here."""
        return f"{name}@http://127.0.0.1:{self._http.server_port}/v1"

    def asked(self, name: str) -> list[str]:
        """What a model was asked, as one text for each request."""
        return [wire(body) for body in self.requests if body["model"] == name]

    def close(self) -> None:
        self.stopping.set()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()


def wire(body: Body) -> str:
    """All text of a request's messages."""
    parts = []
    for message in body["messages"]:
        content = message.get("content") or ""
        parts += [content] if isinstance(content, str) else [part.get("text", "") for part in content]
    return "\n".join(parts)


def apart(folder: Path) -> str:
    """A folder for caches whose replies are its own; what is slow to make is the machine's."""
    machine = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for name in ("warp", "wsim/api"):
        (machine / name).mkdir(parents=True, exist_ok=True)
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).symlink_to((machine / name).resolve())
    return str(folder)


@pytest.fixture
def server() -> Iterator[Server]:
    """A server of this test's own."""
    made = Server()
    yield made
    made.close()


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No reply is known, and none that is kept is known elsewhere."""
    monkeypatch.setenv("XDG_CACHE_HOME", apart(tmp_path / "cache"))
