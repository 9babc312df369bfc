"""What to change, in words, and the command that tries it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.report.numbers import nice_unit, number
from wsim.report.text import prim_name

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsim.judge.verdict import Finding, RepairTarget
    from wsim.scene.world import World

SAME = 1e-3  # share by which a parameter's value may differ from the number that it set
MOST_NAMES = 4
DIGITS = 3


@dataclass(frozen=True)
class Fix:
    """One change, and the failed findings that ask for it."""

    kind: str
    what: str  # "Lower the density of block_1 and block_2 from 2500 to 600 kg/m³"
    why: str
    findings: list[int]  # their numbers in the verdict
    command: str  # that tries it; empty where the command line cannot


def make_fixes(failed: Iterable[tuple[int, Finding]], world: World | None, run: Path) -> list[Fix]:
    """The changes that failed findings ask for, each once, in the findings' order.

    Args:
        failed: Findings with their numbers in the verdict.
        world: What was recorded, if anything was.
        run: The run's folder.
    """
    groups: dict[tuple[str, ...], list[tuple[int, RepairTarget]]] = {}
    for index, finding in failed:
        target = finding.target
        if target is not None:
            same = (target.kind, target.parameter, target.direction, _value(target), target.unit)
            groups.setdefault(same, []).append((index, target))
    return [
        Fix(
            kind=group[0][1].kind,
            what=describe([target for _, target in group]),
            why=group[0][1].why,
            findings=[index for index, _ in group],
            command=command(group[0][1], world, run),
        )
        for group in groups.values()
    ]


def describe(targets: list[RepairTarget]) -> str:
    """One change of one or several prims, in words."""
    first = targets[0]
    names = list(dict.fromkeys(prim_name(target.prim) for target in targets if target.prim))
    shown = names if len(names) <= MOST_NAMES else [*names[: MOST_NAMES - 1], f"{len(names) - MOST_NAMES + 1} more"]
    whose = " and ".join(part for part in (", ".join(shown[:-1]), *shown[-1:]) if part)
    parameter = f"the {first.parameter.replace('_', ' ')}" if first.parameter else ""
    thing = f"{parameter} of {whose}" if parameter and whose else parameter or whose or f"the {first.kind}"
    same = first.current is not None and len({_rounded(target.current) for target in targets}) == 1
    now, unit = number(first.current, DIGITS) if same else "", nice_unit(first.unit)
    if _value(first):
        numbers = f"{f' from {now}' if now else ''} to {_value(first)} {unit}"
    else:
        numbers = f", now {now} {unit}" if now else ""
    return f"{(first.direction or 'look at').capitalize()} {thing}{numbers}".rstrip()


def command(target: RepairTarget, world: World | None, run: Path) -> str:
    """`wsim run` with the change, where an option or a parameter of the program makes it; else nothing."""
    if target.suggested is None or world is None:
        return ""
    start = f"wsim run {shlex.quote(str(run))}"
    if target.parameter == "time_step":
        return f"{start} --time-step {target.suggested:.3g}"
    now = target.current
    if now is None:
        return ""
    names = [
        item.name
        for item in world.parameters
        if item.unit == target.unit and abs(item.value - now) <= SAME * max(abs(now), 1e-12)
    ]
    # Where two parameters have the number, nothing says which of them it came from.
    return f"{start} --set {names[0]}={target.suggested:.6g}" if len(names) == 1 else ""


def _value(target: RepairTarget) -> str:
    """What is suggested: a number, (x, y, z), or a name; nothing where no value is."""
    if target.vector is not None:
        return "(" + ", ".join(number(x, DIGITS) for x in target.vector) + ")"
    return target.text if target.suggested is None else number(target.suggested, DIGITS)


def _rounded(x: float | None) -> str:
    return "" if x is None else f"{x:.3g}"
