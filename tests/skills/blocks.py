"""The blocks of code in the skills, and what makes a program of each."""

import re
import textwrap
from dataclasses import dataclass

from wsim.skills import Skill, skills

_BLOCK = re.compile(r"^```(\S+)( fragment)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_AROUND = '''"""A fragment."""

import math

import numpy as np

from wsim.scene import Drive, Scene


def build(scene: Scene) -> None:
'''


@dataclass(frozen=True)
class Block:
    """A block of code: where it is, its language, and the program that it is or is part of."""

    name: str
    language: str
    fragment: bool
    source: str

    @property
    def program(self) -> str:
        """The text of program.py: a fragment uses `scene`, and stands in a `build`."""
        return _AROUND + textwrap.indent(self.source, "    ") if self.fragment else self.source

    @property
    def params(self) -> dict[str, float]:
        """Overrides that make a run short, by the skills' own rule: where the length of a run is a parameter."""
        return {"duration": 0.3} if 'param("duration"' in self.source else {}


def blocks(skill: Skill) -> list[Block]:
    """All blocks of a skill and of its references, in order."""
    found = []
    for path in (skill.folder / "SKILL.md", *sorted(skill.folder.glob("references/*.md"))):
        name = skill.name if path.name == "SKILL.md" else f"{skill.name}-{path.stem}"
        for k, match in enumerate(_BLOCK.finditer(path.read_text(encoding="utf-8"))):
            language, fragment, source = match.groups()
            found.append(Block(f"{name}-{k}", language, bool(fragment), source))
    return found


PYTHON = [block for skill in skills() for block in blocks(skill) if block.language == "python"]
WHOLE = [block for block in PYTHON if not block.fragment]
