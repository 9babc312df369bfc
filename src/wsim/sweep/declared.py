"""What a program itself says that may vary: its `scene.param`s that have a range."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from wsim.assets import assets_folder
from wsim.errors import UserError
from wsim.program import sandbox
from wsim.runs.draws import apply
from wsim.scene.describe import describe
from wsim.scene.world import Parameter, World
from wsim.sweep.axis import Axis
from wsim.sweep.draw import Draw


def parameters_of(program: Path, isolation: str = "auto") -> list[Parameter]:
    """The parameters of a program.

    Raises:
        UserError: If it cannot be built as it stands.
    """
    return as_it_stands(program, isolation).parameters


def as_it_stands(program: Path, isolation: str = "auto") -> World:
    """What a program's stage states with its parameters as they are; it is built in the sandbox.

    Raises:
        UserError: If it cannot be built as it stands.
    """
    with _built(program, isolation) as stage:
        return describe(stage)


@contextmanager
def _built(program: Path, isolation: str) -> Iterator[Path]:
    """The stage of a program as it stands."""
    with tempfile.TemporaryDirectory(prefix="wsim-parameters-") as scratch:
        stage = Path(scratch) / "stage.usda"
        built = sandbox.build(program, stage, isolation=isolation, readable=[assets_folder()])
        if not built.ok:
            raise UserError(f"{program} makes no world as it stands: {built.message}")
        yield stage


def axes_of(program: Path, given: Sequence[Axis], isolation: str = "auto") -> list[Axis]:
    """The axes that were given, held against what the program has; where none are, every parameter with a range.

    Raises:
        UserError: If an axis is no parameter of the program or leaves its range, or there is nothing to vary.
    """
    known = {parameter.name: parameter for parameter in parameters_of(program, isolation)}
    for axis in given:
        check(axis.name, (axis.low, axis.high), known, f"--vary {axis.name}")
    axes = list(given) or [
        Axis(name=parameter.name, low=parameter.low, high=parameter.high)
        for parameter in known.values()
        if parameter.low is not None and parameter.high is not None and parameter.low < parameter.high
    ]
    if not axes:
        named = f"it has {', '.join(known)}" if known else "it has no scene.param"
        raise UserError(f"{program}: no parameter states a range ({named}); give one with --vary NAME=LOW:HIGH")
    # A search begins at the program as it stands.
    return [axis.model_copy(update={"start": known[axis.name].value}) for axis in axes]


def check_draws(program: Path, draws: Sequence[Draw], isolation: str = "auto") -> None:
    """Refuse what cannot be drawn of the program as it stands, at either end of its range, before anything is run.

    Raises:
        UserError: Naming what the world lacks, or what cannot be changed in it.
    """
    ends = [{draw.name: value} for draw in draws for value in (draw.low, draw.high)]
    together = {draw.name: draw.low for draw in draws}  # two names may be of one number
    with _built(program, isolation) as stage:
        for values in (*ends, together):
            tried = stage.with_name("tried.usda")
            shutil.copyfile(stage, tried)
            try:
                apply(tried, values)
            except UserError as error:
                raise UserError(f"--randomise {error}") from error


def check(name: str, values: Sequence[float], known: dict[str, Parameter], where: str) -> None:
    """Refuse what the program would refuse, before anything is run.

    Raises:
        UserError: Naming the parameter, the value and the range.
    """
    if name not in known:
        raise UserError(f"{where}: the program has no parameter {name!r}; it has {', '.join(known) or 'none'}")
    low, high = known[name].low, known[name].high
    for value in values:
        if (low is not None and value < low) or (high is not None and value > high):
            span = f"{'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
            raise UserError(f"{where}: {value:g} is outside {name}'s range, {span} {known[name].unit}".rstrip())
