"""What `wsim sweep` is asked for, held against the programs before anything is run."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wsim import sim
from wsim.cli.run import find_program
from wsim.cli.show import console
from wsim.errors import UserError
from wsim.plan.store import load
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sweep.axis import Axis, walked_together
from wsim.sweep.declared import Known, axes_of, built, check, check_draws, known_of, lacking
from wsim.sweep.device import pick_device
from wsim.sweep.folder import SweepFolder
from wsim.sweep.sampling import read_points
from wsim.sweep.spec import MOST, Spec
from wsim.sweep.variant import called, variants


@dataclass(frozen=True)
class Asked:
    """Which candidates, as the command line says it."""

    targets: Sequence[Path]
    patches: Sequence[Path]
    vary: Sequence[str]
    zipped: Sequence[str]
    points: Path | None
    plan: Path | None

    def check(self) -> None:
        """Refuse what does not go together.

        Raises:
            UserError: Naming the options.
        """
        if not self.targets:
            raise UserError("name a program.py or the folder of a run, or a sweep with --resume")
        if self.points and (self.vary or self.zipped):
            raise UserError("--points gives the values; leave --vary and --zip out")
        if twice := {name for name in self._names if self._names.count(name) > 1}:
            raise UserError(f"--vary {twice.pop()} is given twice; give it once, as NAME=LOW:HIGH or NAME=A,B,C")

    @property
    def _names(self) -> list[str]:
        return [text.partition("=")[0] for text in self.vary]


def make(asked: Asked, spec: Spec, runs: Path) -> SweepFolder:
    """The folder of a new sweep, of which all that can be known before it is run is right.

    Args:
        asked: Which candidates.
        spec: How they are drawn and run; its `batch` is how many workers there are.
        runs: Folder of runs.

    Raises:
        UserError: Naming what is wrong.
    """
    asked.check()
    found = [(target, *find_program(target, asked.plan)) for target in asked.targets]
    plans = {own for _, _, own in found if own is not None}
    if len(plans) > 1:
        raise UserError("the runs have different plans; give the one to judge by with --plan")
    plan = load(plans.pop()) if plans else None
    named = called([(target, program) for target, program, _ in found])
    with variants(named, asked.patches) as programs, built(list(programs), spec.isolation) as stages:
        spec = spec.model_copy(
            update={
                "programs": list(stages),
                "patched": {program.name: of for program, of in programs.items() if of},
                "batch": max(1, spec.batch // (len(stages) * spec.repeats)),
                **_differing(asked, spec, known_of(stages)),
            }
        )
        if spec.draws:
            check_draws(stages, spec.draws)
        if spec.count > MOST:  # too few for the method is said here, too
            raise UserError(f"{spec.count:,} candidates are more than {MOST:,}; ask for fewer --samples or --repeats")
        if spec.device == "auto":
            first = describe(next(iter(stages.values())))
            spec = spec.model_copy(update={"device": _device(spec, first)})
        for program, names in spec.lacks.items():
            console.print(f"{program} has no parameter {', '.join(names)}, and is run without", soft_wrap=True)
        text = plan.model_dump_json(indent=2) + "\n" if plan else None
        return SweepFolder.create(runs, plan.title if plan else Path(spec.programs[0]).stem, spec, list(programs), text)


def _differing(asked: Asked, spec: Spec, known: Known) -> dict[str, Any]:
    """Axes or points, and which programs lack parameters of theirs."""
    if asked.points:
        points = read_points(asked.points)
        for name in points[0]:
            check(name, [point[name] for point in points], known, f"--points {asked.points}")
        return {"points": points, "lacks": lacking(known, list(points[0]))}
    if not spec.samples and (asked.vary or spec.draws):
        raise UserError("--samples 0 runs the programs as they stand alone; leave --vary and --randomise out")
    given = [Axis.parse(text) for text in asked.vary]
    varied = bool(given or not spec.draws) and spec.samples > 0
    axes = walked_together(axes_of(known, given) if varied else [], asked.zipped)
    return {"axes": axes, "lacks": lacking(known, [each.name for axis in axes for each in axis.parameters])}


def _device(spec: Spec, first: World) -> str:
    device, why = pick_device(spec, first, len(os.sched_getaffinity(0)))
    if why:
        console.print(why, soft_wrap=True)
    return device


def known_device(device: str) -> None:
    """Refuse a device that this machine has not; several are GPUs.

    Raises:
        UserError: Naming it.
    """
    names = device.split(",")
    if len(names) > 1 and not all(name.startswith("cuda:") for name in names):
        raise UserError(f"--device {device}: several devices are GPUs, as in cuda:0,cuda:1")
    for name in names:
        if name not in ("auto", "cpu"):
            sim.known_device(name)
