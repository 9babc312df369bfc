"""What programs themselves say that may vary: their `scene.param`s that have a range."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from wsim.assets import asset_folders
from wsim.errors import UserError
from wsim.program import sandbox
from wsim.runs.draws import apply
from wsim.runs.pulled import pull_missing
from wsim.scene.describe import describe
from wsim.scene.world import Parameter
from wsim.sweep.axis import Axis
from wsim.sweep.draw import Draw

Known = Mapping[str, Mapping[str, Parameter]]  # by program and name


def declared_by(programs: Sequence[Path], isolation: str = "auto") -> Known:
    """The parameters of programs.

    Raises:
        UserError: If one cannot be built as it stands.
    """
    with built(programs, isolation) as stages:
        return known_of(stages)


@contextmanager
def built(programs: Sequence[Path], isolation: str) -> Iterator[dict[str, Path]]:
    """The stages of programs with their parameters as they are, by the names of their files; built in the sandbox.

    Raises:
        UserError: If one cannot be built as it stands.
    """
    with ExitStack() as kept:
        yield {program.name: kept.enter_context(_built(program, isolation)) for program in programs}


@contextmanager
def _built(program: Path, isolation: str) -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="wsim-parameters-") as scratch:
        stage = Path(scratch) / "stage.usda"
        pull_missing(program.read_text(encoding="utf-8", errors="replace"))
        made = sandbox.build(program, stage, isolation=isolation, readable=asset_folders())
        if not made.ok:
            raise UserError(f"{program.name} makes no world as it stands: {made.message}")
        yield stage


def known_of(stages: Mapping[str, Path]) -> Known:
    """The parameters that programs' stages state."""
    return {name: {each.name: each for each in describe(stage).parameters} for name, stage in stages.items()}


def axes_of(known: Known, given: Sequence[Axis]) -> list[Axis]:
    """The axes that were given, held against what the programs have; where none are, every parameter with a range.

    Raises:
        UserError: If an axis is a parameter of no program or leaves the range of one that has it, or there is nothing
            to vary.
    """
    for axis in given:
        check(axis.name, (axis.low, axis.high), known, f"--vary {axis.name}")
    every: dict[str, Parameter] = {}
    for own in known.values():
        every = {**own, **every}  # where ranges differ, the first one's
    axes = list(given) or [
        Axis(name=parameter.name, low=parameter.low, high=parameter.high)
        for parameter in every.values()
        if parameter.low is not None and parameter.high is not None and parameter.low < parameter.high
    ]
    for axis in [] if given else axes:
        check(
            axis.name, (axis.low, axis.high), known, f"--vary {axis.name}={axis.low:g}:{axis.high:g}, as is its range"
        )
    if not axes and len(known) == 1:
        named = f"it has {', '.join(every)}" if every else "it has no scene.param"
        raise UserError(
            f"{next(iter(known))}: no parameter states a range ({named}); give one with --vary NAME=LOW:HIGH"
        )
    # A search begins at the program as it stands.
    return [axis.model_copy(update={"start": every[axis.name].value}) for axis in axes]


def lacking(known: Known, names: Sequence[str]) -> dict[str, list[str]]:
    """Which programs do not have which of some parameters; those that have all are left out."""
    found = {program: [name for name in names if name not in own] for program, own in known.items()}
    return {program: missing for program, missing in found.items() if missing}


def check_draws(stages: Mapping[str, Path], draws: Sequence[Draw]) -> None:
    """Refuse what cannot be drawn of a program as it stands, at either end of its range, before anything is run.

    Args:
        stages: Of the programs, by their names.
        draws: They.

    Raises:
        UserError: Naming what the world lacks, or what cannot be changed in it; of several programs, which one's.
    """
    ends = [{draw.name: value} for draw in draws for value in (draw.low, draw.high)]
    together = {draw.name: draw.low for draw in draws}  # two names may be of one number
    for name, stage in stages.items():
        for values in (*ends, together):
            tried = stage.with_name("tried.usda")
            shutil.copyfile(stage, tried)
            try:
                apply(tried, values)
            except UserError as error:
                raise UserError(f"--randomise {f'for {name}: ' if len(stages) > 1 else ''}{error}") from error


def check(name: str, values: Sequence[float], known: Known, where: str) -> None:
    """Refuse what a program would refuse, before anything is run.

    Raises:
        UserError: Naming the parameter, the value and the range; of several programs, which one's.
    """
    having = {program: own[name] for program, own in known.items() if name in own}
    several = len(known) > 1
    if not having:
        there = ", ".join(dict.fromkeys(each for own in known.values() for each in own)) or "none"
        if several:
            raise UserError(f"{where}: none of {', '.join(known)} has a parameter {name!r}; they have {there}")
        raise UserError(f"{where}: the program has no parameter {name!r}; it has {there}")
    for program, parameter in having.items():
        low, high = parameter.low, parameter.high
        for value in values:
            if (low is not None and value < low) or (high is not None and value > high):
                span = f"{'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
                whose = f" in {program}" if several else ""
                raise UserError(
                    f"{where}: {value:g} is outside {name}'s range{whose}, {span} {parameter.unit}".rstrip()
                )
