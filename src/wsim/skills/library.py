"""The folders of skills, read and checked: Agent Skills format, a SKILL.md with front matter in each."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from wsim.errors import UserError

FILE = "SKILL.md"
LINES = 300  # that a skill may have at most
_SHIPPED = Path(__file__).parents[1] / "_skills"  # in a wheel
_SOURCE = Path(__file__).parents[3] / "skills"  # in the repository
_NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_LONGEST = {"name": 64, "description": 1024}  # characters, of the format
# What would make a plain YAML scalar something else: a mapping, a comment, or an indicator at the start.
_NOT_PLAIN = re.compile(r": |\s#|:$|^[\"'>|&*!%@`\[\]{},?#-]")


class SkillError(UserError):
    """A skill's file is wrong, or the library is not there: one line with the way out."""


@dataclass(frozen=True)
class Skill:
    """How one kind of world is written.

    Attributes:
        name: Of the skill and of its folder.
        description: What it is for, and when to use it.
        folder: Where SKILL.md is, with references/ and scripts/ beside it where there are any.
        text: The whole of SKILL.md.
        body: The text without its front matter.
    """

    name: str
    description: str
    folder: Path
    text: str
    body: str

    @property
    def headings(self) -> list[str]:
        """The headings of the body, without those of code."""
        prose = re.sub(r"^```.*?^```$", "", self.body, flags=re.MULTILINE | re.DOTALL)
        return re.findall(r"^#+ (.+)$", prose, flags=re.MULTILINE)


def skills_folder() -> Path:
    """The folder of the shipped skills.

    Raises:
        SkillError: If it is nowhere.
    """
    for folder in (_SHIPPED, _SOURCE):
        if folder.is_dir():
            return folder
    raise SkillError(f"the skills are in neither {_SHIPPED} nor {_SOURCE}; install wsim again")


def skills(folder: Path | None = None) -> tuple[Skill, ...]:
    """All skills in the order of their names, read once.

    Args:
        folder: Holds a folder for each skill; the shipped ones by default.

    Raises:
        SkillError: If a file breaks the format: names the file, the field and what it must be.
    """
    return _load((folder or skills_folder()).resolve())


@cache
def _load(folder: Path) -> tuple[Skill, ...]:
    return tuple(_read(path) for path in sorted(folder.glob(f"*/{FILE}")))


def _read(path: Path) -> Skill:
    where = f"{path.parent.name}/{path.name}"
    text = path.read_text(encoding="utf-8")
    if text.count("\n") >= LINES:
        raise SkillError(
            f"{where}: {text.count(chr(10))} lines; keep it below {LINES}, and put the rest in references/"
        )
    fields, body = _front_matter(where, text)
    if fields["name"] != path.parent.name or not _NAME.fullmatch(fields["name"]):
        raise SkillError(
            f'{where}: name = "{fields["name"]}" must be the name of its folder, "{path.parent.name}", of lower-case '
            "letters, digits and single hyphens"
        )
    return Skill(folder=path.parent, text=text, body=body, **fields)


def _front_matter(where: str, text: str) -> tuple[dict[str, str], str]:
    """The fields between the first two lines of dashes, and what follows them.

    Each is one line, `name: value`, with a plain scalar: every YAML parser reads the same from it.
    """
    first, *lines = text.split("\n")
    if first != "---" or "---" not in lines:
        raise SkillError(f"{where}: must begin with front matter, its name and description between two lines of ---")
    end = lines.index("---")
    fields: dict[str, str] = {}
    for line in lines[:end]:
        key, colon, value = line.partition(": ")
        if not colon or key not in _LONGEST or key in fields:
            raise SkillError(f'{where}: "{line[:60]}" must be one line each of name: and description:')
        if not value.strip() or len(value) > _LONGEST[key]:
            raise SkillError(f"{where}: {key} has {len(value)} characters; 1 to {_LONGEST[key]}")
        if _NOT_PLAIN.search(value):
            raise SkillError(f"{where}: {key} is no plain YAML scalar: leave out quotes, colons and number signs")
        fields[key] = value
    missing = [key for key in _LONGEST if key not in fields]
    if missing:
        raise SkillError(f"{where}: {missing[0]} is missing from the front matter")
    return fields, "\n".join(lines[end + 1 :]).lstrip("\n")
