"""The programs and the mistakes, read from their files."""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, model_validator

from wsim.plan.schema import Plan
from wsim.plan.store import read

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Program:
    """A correct program, and the plan that it fulfils if it has one."""

    name: str
    text: str
    plan: Plan | None

    @classmethod
    def named(cls, name: str) -> Program:
        """The program correct/NAME.py."""
        plan = FOLDER / "plans" / f"{name}.json"
        text = (FOLDER / "correct" / f"{name}.py").read_text(encoding="utf-8")
        return cls(name, text, read(plan) if plan.exists() else None)


class Mistake(BaseModel):
    """One mistake in a correct program.

    Attributes:
        name: Which it is; no two have the same.
        kind: The file it stands in.
        base: Name of the correct program.
        search: Text that the program has once.
        replace: What stands there instead.
        at: Texts that the faulty program has once: the mistake may be reported at the line of any of them. Left out, at
            the first line that differs.
        anywhere: It has no line of its own: a complaint that names `right` finds it.
        right: The word that a complaint should name; None where there is no right one to name.
        fails: Where the faulty program fails if it is run: "build", "control", or "plan" where what it builds is not
            what the plan has.
        silent: Why it is a mistake although nothing fails.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    kind: str
    base: str
    search: str
    replace: str
    at: tuple[str, ...] = ()
    anywhere: bool = False
    right: str | None = None
    fails: Literal["build", "control", "plan"] | None = None
    silent: str = ""

    @model_validator(mode="after")
    def _proven(self) -> Mistake:
        if (self.fails is None) != bool(self.silent):
            raise ValueError(f"{self.name}: give either where it fails, or why it is a mistake that does not")
        if self.anywhere and self.right is None:
            raise ValueError(f"{self.name}: what is reported anywhere must be told by the word that names it")
        return self

    @property
    def program(self) -> Program:
        """The faulty program, with the plan of its base."""
        base = Program.named(self.base)
        if base.text.count(self.search) != 1:
            raise ValueError(
                f"{self.name}: {self.base} has its search text {base.text.count(self.search)} times, not once"
            )
        return Program(self.base, base.text.replace(self.search, self.replace), base.plan)

    @property
    def lines(self) -> list[int]:
        """The lines of the faulty program that it may be reported at."""
        if self.anywhere:
            return []
        text = self.program.text
        if not self.at:
            pairs = zip(Program.named(self.base).text.splitlines(), text.splitlines(), strict=False)
            return [next(number for number, (old, new) in enumerate(pairs, 1) if old != new)]
        for place in self.at:
            if text.count(place) != 1:
                raise ValueError(f"{self.name}: the faulty program has {place!r} {text.count(place)} times, not once")
        return [text[: text.index(place)].count("\n") + 1 for place in self.at]

    def found_by(self, line: int | None, sentence: str) -> bool:
        """Whether a complaint is about this mistake: within a line of it."""
        if self.anywhere:
            return self.named_by(sentence)
        return line is not None and any(abs(line - own) <= 1 for own in self.lines)

    def named_by(self, sentence: str) -> bool:
        """Whether a complaint names what is right."""
        return self.right is not None and bool(re.search(rf"(?<!\w){re.escape(self.right)}(?!\w)", sentence))


def programs() -> list[Program]:
    """All correct programs, by name."""
    return [Program.named(path.stem) for path in sorted((FOLDER / "correct").glob("*.py"))]


def mistakes() -> list[Mistake]:
    """All mistakes, by kind."""
    found = []
    for path in sorted((FOLDER / "mistakes").glob("*.toml")):
        rows = tomllib.loads(path.read_text(encoding="utf-8"))["mistake"]
        found += [Mistake(kind=path.stem.replace("_", " "), **row) for row in rows]
    return found


def halves(names: Iterable[str]) -> dict[str, str]:
    """Which half each mistake belongs to, "tuning" or "held-out": drawn by the hash of its name."""
    drawn = sorted(names, key=lambda name: hashlib.sha256(name.encode()).hexdigest())
    return {name: "tuning" if k < len(drawn) // 2 else "held-out" for k, name in enumerate(drawn)}
