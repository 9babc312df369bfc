"""transcript.jsonl: every exchange with a model, in order, and a recorded one read back.

A line holds what a request adds to the one before it of the same role (`shared` messages are the same), so that a long
conversation is written once. What the builtin roles made stands in the same file, with the model "builtin".
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wsim.agents.exchange import Asked, Message, digest
from wsim.errors import UserError

NAME = "transcript.jsonl"
BUILTIN = "builtin"


@dataclass(frozen=True)
class Exchange:
    """One request and its reply, or the error that came in its place.

    Attributes:
        number: Counted from 1, over all roles.
        role: Who asked.
        model: Who was asked.
        messages: The whole conversation up to the reply.
        tools: Digest of the tools that were offered.
        reply: As `exchange.said` has it; None if it failed.
        error: {"kind", "message"}, where it failed.
        usage: {"input_tokens", "output_tokens"}.
        seconds: Wall time of the request [s].
        cached: It was answered from the cache.
    """

    number: int
    role: str
    model: str
    messages: list[Message]
    tools: str
    reply: dict[str, Any] | None
    error: dict[str, str] | None
    usage: dict[str, int]
    seconds: float
    cached: bool = False


@dataclass
class Transcript:
    """The file of a run, appended to.

    Args:
        folder: The run's folder.
    """

    folder: Path
    count: int = 0
    _last: dict[str, list[Message]] = field(default_factory=dict)
    _tools: set[str] = field(default_factory=set)

    def builtin(self, role: str, request: Any, reply: Any) -> None:
        """Note what a builtin role made."""
        self._append({"role": role, "model": BUILTIN, "request": request, "reply": reply})

    def add(
        self,
        role: str,
        model: str,
        asked: Asked,
        *,
        reply: dict[str, Any] | None = None,
        error: dict[str, str] | None = None,
        usage: dict[str, int] | None = None,
        seconds: float = 0.0,
        cached: bool = False,
    ) -> None:
        """Note an exchange; its pictures go to pictures/."""
        for name, data in asked.pictures.items():
            path = self.folder / "pictures" / f"{name}.jpg"
            if not path.is_file():
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(data)
        before = self._last.get(role, [])
        shared = next(
            (k for k, (old, new) in enumerate(zip(before, asked.messages, strict=False)) if old != new),
            min(len(before), len(asked.messages)),
        )
        self._last[role] = asked.messages
        self.count += 1
        tools = digest(json.dumps(asked.tools, sort_keys=True).encode()) if asked.tools else ""
        line: dict[str, Any] = {"n": self.count, "role": role, "model": model, "shared": shared}
        line["messages"] = asked.messages[shared:]
        if tools:
            line["tools"] = tools
            if tools not in self._tools:
                line["tool_definitions"] = asked.tools
                self._tools.add(tools)
        line |= {"reply": reply} if error is None else {"error": error}
        line |= {"usage": usage or {}, "seconds": round(seconds, 2)} | ({"cached": True} if cached else {})
        self._append(line)

    def _append(self, line: dict[str, Any]) -> None:
        with (self.folder / NAME).open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False) + "\n")


def read(folder: Path) -> list[Exchange]:
    """The exchanges with models of a recorded run.

    Raises:
        UserError: If there is no transcript, or a line of it is not one.
    """
    path = folder / NAME
    if not path.is_file():
        raise UserError(f"{folder} has no {NAME}; give the folder of a run that wsim generate made")
    last: dict[str, list[Message]] = {}
    return [_exchange(line, last, f"{path}:{number}") for number, line in _lines(path) if line.get("model") != BUILTIN]


def _lines(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    written = path.read_bytes()
    whole = written[: written.rfind(b"\n") + 1]  # a run that was killed may have left half a line
    for number, line in enumerate(whole.split(b"\n")[:-1], start=1):
        try:
            data = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise UserError(f"{path}:{number}: not JSON: {error}") from error
        if not isinstance(data, dict):
            raise UserError(f"{path}:{number}: a line holds one exchange as a JSON object")
        yield number, data


def _exchange(line: dict[str, Any], last: dict[str, list[Message]], where: str) -> Exchange:
    try:
        role = line["role"]
        messages = [*last.get(role, [])[: line["shared"]], *line["messages"]]
        last[role] = messages
        return Exchange(
            line["n"], role, line["model"], messages, line.get("tools", ""), line.get("reply"), line.get("error"),
            line["usage"], line["seconds"], line.get("cached", False),
        )  # fmt: skip
    except (KeyError, TypeError) as error:
        raise UserError(f"{where}: not an exchange: {error} is missing or of another kind") from error
