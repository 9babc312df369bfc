"""Run the commands of tools.md in order, and write what each prints beneath it.

python docs/run_tools.py
"""

from __future__ import annotations

import contextlib
import re
import shlex
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from typer.testing import CliRunner

from wsim.cli import app

PAGE = Path(__file__).parent / "tools.md"
EXAMPLES = Path(__file__).parents[1] / "examples"
ANSWER = r" {4}(?!\.venv).*\n"  # a line of one; blank ones may lie between
COMMAND = re.compile(rf"^ {{4}}\.venv/bin/wsim (tool\b.*)\n((?:{ANSWER}|\n(?=\n*{ANSWER}))*)", re.MULTILINE)


@dataclass(frozen=True)
class Example:
    """A command of the page, and what the page says that it prints."""

    command: str
    said: str
    span: tuple[int, int]  # of what is said, in the page


def examples(page: str) -> list[Example]:
    """The page's commands, in order."""
    return [
        Example(found[1], re.sub(r"^ {4}", "", found[2], flags=re.MULTILINE), found.span(2))
        for found in COMMAND.finditer(page)
    ]


def printed(example: Example) -> str:
    """What a command prints, in the present folder; `$(cat FILE)` is the file's text, as in a shell."""
    words = [
        re.sub(r"\$\(cat (\S+)\)", lambda found: Path(found[1]).read_text(encoding="utf-8"), word)
        for word in shlex.split(example.command)
    ]
    done = CliRunner().invoke(app, [*words, *(["--device", "cpu"] if "--run" in words else [])])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.output


@contextlib.contextmanager
def workplace(page: str) -> Iterator[Path]:
    """An empty folder to run the page's commands in, with its files and the examples; the present one meanwhile."""
    (plan,) = re.findall(r"^```json\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "crate.json").write_text(plan, encoding="utf-8")
        (folder / "examples").symlink_to(EXAMPLES)
        with contextlib.chdir(folder):
            yield folder


def main() -> None:
    """Write the page anew."""
    page = PAGE.read_text(encoding="utf-8")
    with workplace(page):
        answers = [(example.span, printed(example)) for example in examples(page)]
    for (begin, end), text in reversed(answers):
        block = "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines())
        page = page[:begin] + block + page[end:]
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
