"""What the planner's model is told: the whole of what every plan needs, and the chapters that a prompt calls for.

A chapter is a tenth of the words, and each request brings all of them again. One that no word of the prompt speaks of
is left out; a model that needs it says so, and gets it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from wsim.assets.robots import robots
from wsim.assets.sources import sources
from wsim.judge.language.sentence import vocabulary
from wsim.plan.schema.examples import constructions, roles
from wsim.scene.vehicle_spec import preset, presets

PROMPTS = Path(__file__).parent / "prompts"
TELL = "tell"  # of an answer that asks for chapters: {"tell": ["robots"]}
CHAPTERS = ("fluids", "vehicles", "robots")
_KINDS = {"vehicles": ("vehicle", "terrain", "scatter"), "robots": ("robot",)}


def chapters_for(prompt: str) -> tuple[str, ...]:
    """The chapters that a prompt speaks of, in their order."""
    named = [part for robot in (*robots(), *sources()) for part in robot.lower().split("_") if len(part) > 2]
    besides = {"vehicles": presets(), "robots": named}
    return tuple(name for name in CHAPTERS if _calls(prompt.lower(), (*_words()[name], *besides.get(name, ()))))


def _calls(said: str, words: Iterable[str]) -> bool:
    forms = (re.escape(word[:-1]) if word.endswith("*") else rf"{re.escape(word)}s?\b" for word in words)
    return re.search(rf"\b(?:{'|'.join(forms)})", said) is not None


@cache
def _words() -> dict[str, list[str]]:
    table = tomllib.loads((PROMPTS / "planner" / "chapters.toml").read_text(encoding="utf-8"))
    return {name: table[name].split() for name in CHAPTERS}


@cache
def planner_prompt(chapters: tuple[str, ...] = CHAPTERS) -> str:
    """The instructions of the planner's model, with some chapters."""
    besides = {kind for kinds in _KINDS.values() for kind in kinds}
    left_out = [name for name in CHAPTERS if name not in chapters]
    parts = [chapter(name) for name in chapters]
    if left_out:
        ask = f'{{"{TELL}": ["{left_out[0]}"]}}'
        parts.append(f"Left out here: {', '.join(left_out)}. Where the plan needs one of them, answer {ask} alone.")
    text = (PROMPTS / "planner.md").read_text(encoding="utf-8")
    tables = {
        "CHAPTERS": "\n\n".join(parts), "PREDICATES": vocabulary(fluids=False),
        "CONSTRUCTIONS": constructions(besides, without=True), "ROLES": roles(),
    }  # fmt: skip
    return _filled(text, tables)


@cache
def chapter(name: str) -> str:
    """One of the chapters."""
    text = (PROMPTS / "planner" / f"{name}.md").read_text(encoding="utf-8").strip()
    tables = {
        "PREDICATES": vocabulary(fluids=True), "CONSTRUCTIONS": constructions(_KINDS.get(name, ())),
        "VEHICLES": _vehicles(),
    }  # fmt: skip
    return _filled(text, tables)


def _filled(text: str, tables: Mapping[str, str]) -> str:
    for place, table in tables.items():
        text = text.replace(f"{{{place}}}", table)
    return text


def asked_for(answer: dict[str, object]) -> list[str]:
    """The chapters that an answer asks for in place of a plan."""
    wanted = answer.get(TELL)
    return [name for name in CHAPTERS if isinstance(wanted, list) and name in wanted]


def told(names: Iterable[str]) -> str:
    """Chapters, as they are told to a model that asked for them."""
    return "\n\n".join(["You asked to be told of this; now answer with the plan.", *map(chapter, names)])


def _vehicles() -> str:
    """Length, width and height of each kind of vehicle, the way between its axles [m], its mass."""
    lines = []
    for kind in presets():
        spec = preset(kind)
        size = " x ".join(f"{edge:g}" for edge in (spec.length, spec.width, spec.height))
        lines.append(f"{kind} {size}, {spec.wheelbase:g}, {spec.mass:g} kg")
    return "; ".join(lines)
