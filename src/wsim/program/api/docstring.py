"""What a docstring says of the parameters: their meaning, and the unit in its brackets. Google's style and NumPy's."""

from __future__ import annotations

import inspect
import re

_GOOGLE = re.compile(r"^(?:Args|Arguments|Parameters|Attributes):\s*$", re.MULTILINE)
_UNIT = re.compile(r"\[([^\[\]]{1,20})\]")
_IS_UNIT = re.compile(r"^(?:[A-Za-zµ°%]{1,6}|1)(?:[ ·*/^]?(?:[A-Za-z]{1,4}|[-\d(]{1,3}\)?))*$")
_NUMPY_ITEM = re.compile(r"^(\*{0,2}\w+(?:\s*,\s*\*{0,2}\w+)*)\s*:")


def clean(doc: object) -> str:
    """A docstring without its indentation."""
    return inspect.cleandoc(doc) if isinstance(doc, str) else ""


def summary(doc: str) -> str:
    """The first paragraph, in one line."""
    return " ".join(doc.strip().split("\n\n", 1)[0].split())[:400]


def meanings(doc: str) -> dict[str, str]:
    """What is said of each parameter."""
    return {**_numpy(doc), **_google(doc)}


def unit(meaning: str, name: str = "") -> str:
    """The unit that is stated in brackets: "Depth above the floor [m]." gives "m"; "" if there is none.

    Args:
        meaning: What is said.
        name: Of the parameter: where it stands in backticks, the unit is the one after it.
    """
    _, _, after = meaning.partition(f"`{name}`")
    for found in _UNIT.findall(after or meaning):
        if _IS_UNIT.match(found):
            return str(found)
    return ""


def said_of(name: str, doc: str) -> str:
    """The sentence of a text that speaks of a name in backticks; "" if none does."""
    for sentence in re.split(r"(?<=[.;])\s+", " ".join(doc.split())):
        if f"`{name}`" in sentence:
            return sentence
    return ""


def listed(doc: str) -> dict[str, str]:
    """Items of an indented list, `a, b: what they are`, wherever it stands in a docstring."""
    found: dict[str, str] = {}
    last: list[str] = []
    for line in doc.splitlines():
        item = re.match(r"^ {4}(\w+(?:, \w+)*): (.+)$", line)
        if item:
            last = item[1].split(", ")
            found |= {name: _nth(item[2], last.index(name), len(last)) for name in last}
        elif line.startswith("     ") and last:
            found |= {name: f"{found[name]} {line.strip()}" for name in last}
        else:
            last = []
    return found


def _nth(text: str, place: int, count: int) -> str:
    """A text that states one unit for each of several names, with the unit of the one alone."""
    units = list(_UNIT.finditer(text))
    if count < 2 or len(units) != count:
        return text
    return f"[{units[place][1]}]: {text}" if place else text


def _google(doc: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for start in _GOOGLE.finditer(doc):
        name = ""
        for line in doc[start.end() :].lstrip("\n").splitlines():
            if line and not line.startswith(" "):
                break
            item = re.match(r"^ {2,4}(\*{0,2}\w+)(?: \([^)]*\))?: ?(.*)$", line)
            if item:
                name = item[1].lstrip("*")
                found[name] = item[2].strip()
            elif name and line.strip():
                found[name] = f"{found[name]} {line.strip()}".strip()
    return found


def _numpy(doc: str) -> dict[str, str]:
    found: dict[str, str] = {}
    names: list[str] = []
    inside = False
    lines = doc.splitlines()
    for line, after in zip(lines, [*lines[1:], ""]):  # noqa: B905 - the last has none after it
        if re.match(r"^-{3,}\s*$", after):
            inside, names = line.strip() in ("Parameters", "Other Parameters", "Attributes"), []
        elif inside and (item := _NUMPY_ITEM.match(line)):
            names = [name.strip().lstrip("*") for name in item[1].split(",")]
            found |= dict.fromkeys(names, "")
        elif inside and names and line.startswith(" "):
            found |= {name: f"{found[name]} {line.strip()}".strip()[:300] for name in names}
    return found
