"""What the documents show: blocks of code, commands to type, and words set as code."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
_FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_START = re.compile(r"^(?:[A-Z_]+=\S+ )*(?:\S*/)?(?:wsim|python|make|uv|pip|pre-commit)(?= |$)")


@dataclass(frozen=True)
class Block:
    """A fenced block of code: its document, the number of its kind there, its language and its text."""

    document: str
    number: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.document}-{self.language}-{self.number}"


@dataclass(frozen=True)
class Command:
    """A command to type, as words: what is set before it in the environment, the program, what it is given."""

    document: str
    environment: tuple[str, ...]
    program: str
    words: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.document}: {' '.join((self.program, *self.words))}"[:100]


def name_of(path: Path) -> str:
    """A document's name, as others link to it."""
    return path.relative_to(ROOT).as_posix()


def blocks(path: Path, language: str = "python") -> list[Block]:
    """A document's fenced blocks in a language."""
    found = [text for each, text in _FENCED.findall(path.read_text(encoding="utf-8")) if each == language]
    return [Block(name_of(path), number, language, text) for number, text in enumerate(found)]


def inline(path: Path) -> list[str]:
    """What a document sets as code within its sentences and tables."""
    return re.findall(r"`([^`\n]+)`", _FENCED.sub("", path.read_text(encoding="utf-8")))


def commands(path: Path) -> list[Command]:
    """A document's commands, each on a line of its own that is indented; one goes on until its quotes are closed."""
    lines = iter(_FENCED.sub("", path.read_text(encoding="utf-8")).splitlines())
    return [command for line in lines if line.startswith("    ") for command in _read(name_of(path), line, lines)]


def _read(document: str, line: str, following: Iterator[str]) -> Iterator[Command]:
    text = line[4:]
    if not _START.match(text):
        return
    while True:
        try:
            words = shlex.split(text, comments=True)
            break
        except ValueError:  # a quote that is not closed yet
            text += "\n" + next(following)[4:]
    before = list(takewhile(lambda word: re.match(r"[A-Z_]+=", word), words))
    program, *rest = words[len(before) :]
    yield Command(document, tuple(before), program.rsplit("/", 1)[-1], tuple(rest))
