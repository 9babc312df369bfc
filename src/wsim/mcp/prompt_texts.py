"""What is told to a client's model: how the whole is used, and the prompts that a client can offer a person."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

NAMES = ("plan", "generate")
PLACE = "{prompt}"


@cache
def _text(name: str) -> str:
    return (files("wsim.mcp") / "prompts" / f"{name}.md").read_text(encoding="utf-8")


def instructions() -> str:
    """What a client's model is told of the whole server."""
    return _text("instructions").strip()


def description(name: str) -> str:
    """What a prompt is for: its text's first line."""
    return _text(name).partition("\n")[0]


def fill(name: str, prompt: str) -> str:
    """A prompt's text, about a world."""
    return _text(name).partition("\n")[2].strip().replace(PLACE, " ".join(prompt.split()))
