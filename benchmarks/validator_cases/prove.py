"""Run a program in the sandbox: a correct one must build and control, and a mistake must show."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.validator_cases.cases import FOLDER, Mistake, Program
from wsim.assets import assets_folder
from wsim.plan.schema import Plan
from wsim.program.control import ControlError, ControlLayout, ControlProcess, has_control
from wsim.program.sandbox import build
from wsim.scene.describe import describe
from wsim.scene.world import World

FILES = FOLDER / "correct" / "wedge.obj"  # what the programs read from their own folder


@dataclass(frozen=True)
class Trial:
    """What came of running a program: where it failed, if it did, the line and the message."""

    failed: str | None = None
    line: int | None = None
    message: str = ""


def run(program: Program) -> Trial:
    """Build the program, call its `control` twice, and hold what it built against its plan."""
    with tempfile.TemporaryDirectory(prefix="wsim-case-") as folder:
        path, stage = Path(folder) / "program.py", Path(folder) / "stage.usda"
        path.write_text(program.text, encoding="utf-8")
        (Path(folder) / FILES.name).write_bytes(FILES.read_bytes())
        readable = [Path(folder) / FILES.name, assets_folder()]
        built = build(path, stage, readable=readable)
        if not built.ok:
            return Trial("build", _number(built.line), built.message)
        world = describe(stage)
        if has_control(program.text):
            try:
                _control(path, world, readable)
            except ControlError as error:
                return Trial("control", _number(error.line), error.message)
        amiss = _unlike(world, program.plan) if program.plan else ""
        return Trial("plan", None, amiss) if amiss else Trial()


def objection(program: Program) -> str:
    """What is wrong with a program that should be correct; empty if it is."""
    trial = run(program)
    return f"{program.name}:{trial.line} fails in {trial.failed}: {trial.message}" if trial.failed else ""


def excuse(mistake: Mistake) -> str:
    """Why a mistake is none, or another one than it says; empty if it is what it says."""
    trial = run(mistake.program)
    if trial.failed != mistake.fails:
        return f"{mistake.name}: fails in {trial.failed}, not in {mistake.fails}: {trial.message}"
    # What takes effect later than it is written, such as a constant, says so by more than one place.
    if trial.line and mistake.lines and not mistake.found_by(trial.line, ""):
        return f"{mistake.name}: fails at line {trial.line}, not at {mistake.lines}: {trial.message}"
    return ""


def _control(path: Path, world: World, readable: list[Path]) -> None:
    joints = [joint.prim for joint in world.joints if joint.kind in ("revolute", "prismatic")]
    layout = ControlLayout([body.prim for body in world.bodies], joints, world_count=2)
    state = {name: np.zeros(shape) for name, shape in layout.shapes().items() if name.endswith(("_q", "_qd"))}
    with ControlProcess(path, layout, readable=readable) as control:
        for t in (0.0, 0.6):
            control.step(t, state)


def _unlike(world: World, plan: Plan) -> str:
    """How the world's objects differ from the plan's, as the judge sees it."""
    prims = [item.prim for items in (world.fluids, world.containers, world.bodies, world.statics) for item in items]
    built = {prim.split("/")[2] for prim in prims}
    planned = {item.name for item in plan.objects}
    parts = [f"not built: {sorted(planned - built)}"] if planned - built else []
    parts += [f"not planned: {sorted(built - planned)}"] if built - planned else []
    return "; ".join(parts)


def _number(line: str | None) -> int | None:
    return int(line.rsplit(":", 1)[1]) if line else None
