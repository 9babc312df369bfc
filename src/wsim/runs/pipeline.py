"""One pass over a program: build its stage, check it, simulate it, judge what happened."""

from __future__ import annotations

import contextlib
import json
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim import importers, recording, sim
from wsim.assets import assets_folder
from wsim.judge import judge
from wsim.judge.repair.aim import aim
from wsim.judge.verdict import Finding, Verdict
from wsim.program.control import ControlError, ControlLayout, ControlProcess, has_control
from wsim.program.sandbox import Limits, build
from wsim.program.sandbox.isolation import choose
from wsim.progress import Progress, silent
from wsim.runs.folder import RunFolder, write_json, write_whole
from wsim.runs.verify import Verification
from wsim.scene.describe import describe
from wsim.sim.control import ArrayController, driven_joints

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.program.sandbox import BuildResult
    from wsim.sim.simulation import Simulation, SimulationResult


RERUN_FACTS = ("variant", "seed", "time_step", "spacing_ratio", "status", "summary", "seconds")  # for run.json


@dataclass
class Settings:
    """How a program is run."""

    device: str = "auto"
    params: dict[str, float] = field(default_factory=dict)
    isolation: str = "auto"
    pictures: bool = True
    time_step: float | None = None  # [s]
    verify: bool = False  # an accepted world is run again, computed more finely
    build_timeout: float = 30.0  # [s]
    build_memory: int = 4 * 2**30  # [bytes]

    def limits(self) -> Limits:
        """The sandbox's limits."""
        return Limits(wall_seconds=self.build_timeout, memory_bytes=self.build_memory)

    def check(self) -> None:
        """Look whether the sandbox and the device asked for are here, before a run's folder is made.

        Raises:
            UserError: If one is not.
        """
        choose(self.isolation)
        if self.device not in ("auto", "cpu"):
            sim.pick_device(self.device)


def run_in_folder(
    run: RunFolder,
    program: Path,
    plan: Plan | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Verdict:
    """`run_program` as the first iteration of a run, whose run.json says how it ended, however it did."""
    started = time.perf_counter()
    iteration = run.iteration(1)
    try:
        verdict = run_program(program, iteration, plan, settings, progress)
    except BaseException as error:
        why = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
        run.record(status="stopped", summary=why, seconds=round(time.perf_counter() - started, 1))
        raise
    if verdict.status == "accepted":
        run.accept(iteration)
    run.record(status=verdict.status, summary=verdict.summary, seconds=round(time.perf_counter() - started, 1))
    checks = json.loads((iteration / "checks.json").read_text(encoding="utf-8"))
    if "verify" in checks:
        run.record(verify=[{key: copy[key] for key in RERUN_FACTS} for copy in checks["verify"]])
    return verdict


def run_program(
    program: Path, folder: Path, plan: Plan | None = None, settings: Settings | None = None, progress: Progress = silent
) -> Verdict:
    """Program → stage → recording → verdict, each a file in `folder`.

    Args:
        program: The Python file; it is copied to `folder/program.py`.
        folder: An iteration's folder.
        plan: What the judge holds the world to; without one, only the checks that hold for any world.
        settings: Device, parameters, limits.
        progress: Told how far it is.

    Returns:
        The verdict. A program that fails is a rejected one; a broken environment raises.
    """
    settings = settings or Settings()
    copy = folder / "program.py"
    if program.resolve() != copy.resolve():
        shutil.copyfile(program, copy)
    built = build_in(folder, settings, progress)
    if not built.ok:
        return no_world(folder, built)
    return simulate_and_judge(folder, copy, plan, settings, progress)


def build_in(folder: Path, settings: Settings, progress: Progress = silent) -> BuildResult:
    """`folder/program.py` → `folder/stage.usda`; checks.json says how it went."""
    built = build_stage(folder / "program.py", folder / "stage.usda", settings, progress)
    write_json(folder / "checks.json", {"build": asdict(built), "seconds": {"build": round(built.seconds, 3)}})
    return built


def no_world(folder: Path, built: BuildResult) -> Verdict:
    """The verdict on a program whose build failed."""
    return conclude(folder, reject(Finding(**built.finding()), f"The program made no world ({built.kind})."))


def checks_of(folder: Path) -> dict[str, Any]:
    """What an iteration's checks.json says; nothing where there is none."""
    path = folder / "checks.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def simulate_and_judge(
    folder: Path, program: Path, plan: Plan | None, settings: Settings, progress: Progress
) -> Verdict:
    """Stage → recording → verdict, in `folder`, where the stage is.

    Args:
        folder: An iteration's; what checks.json says of the build stays in it.
        program: Whose `control` steps the world, if it has one.
        plan: What the judge holds the world to.
        settings: Device, parameters, limits.
        progress: Told how far it is.
    """
    before = checks_of(folder)
    build, seconds = before.get("build"), dict(before.get("seconds", {}))
    try:
        result = _timed(seconds, "simulate", lambda: simulate(folder, program, settings, progress))
    except ControlError as error:
        write_json(folder / "checks.json", {"build": build, "simulation": {"error": str(error)}, "seconds": seconds})
        return conclude(folder, reject(Finding(**error.finding()), f"The program's control failed ({error.kind})."))
    verdict = _timed(seconds, "judge", lambda: judge_recording(folder / "recording.rrd", plan, progress))
    simulation = {**asdict(result), "stills": [path.name for path in result.stills]}
    checks: dict[str, Any] = {"build": build, "simulation": simulation, "seconds": seconds}
    write_json(folder / "checks.json", checks)
    if settings.verify and verdict.status == "accepted":
        again = verification(folder, program, plan, settings, progress)
        verdict = _timed(seconds, "verify", lambda: again.check(verdict))
        write_json(folder / "checks.json", checks | {"verify": again.figures})
    return conclude(folder, verdict)


def build_stage(program: Path, stage: Path, settings: Settings, progress: Progress = silent) -> BuildResult:
    """Run the program's `build` in the sandbox."""
    progress("building the stage", 0, 1)
    built = build(
        program,
        stage,
        settings.params,
        settings.limits(),
        isolation=settings.isolation,
        readable=[assets_folder()],
    )
    progress("building the stage", 1, 1)
    return built


def simulate(folder: Path, program: Path, settings: Settings, progress: Progress = silent) -> SimulationResult:
    """Simulate `folder/stage.usda` into `folder/recording.rrd`, with video and stills.

    Raises:
        ControlError: If the program's own `control` fails.
    """
    pictures = settings.pictures
    with open_simulation(folder / "stage.usda", program, settings, progress) as simulation:
        return simulation.run(
            folder / "recording.rrd",
            video=folder / "video.mp4" if pictures else None,
            frames_dir=folder / "frames" if pictures else None,
            review=folder / "review.json" if pictures else None,
            metadata={"program": program.name, "params": settings.params},
            progress=progress,
        )


@contextlib.contextmanager
def open_simulation(
    stage: Path, program: Path, settings: Settings, progress: Progress = silent, seeds: Sequence[int] = (0,)
) -> Iterator[Simulation]:
    """A simulation of a stage, a copy of the world for each seed, with the program's own `control` if it has one."""
    with _controller(program, stage, settings) as controller:
        yield sim.Simulation(
            stage,
            device=settings.device,
            world_count=len(seeds),
            time_step=settings.time_step,
            controller=controller,
            progress=progress,
            seeds=seeds,
        )


def verification(
    folder: Path, program: Path, plan: Plan | None, settings: Settings, progress: Progress = silent
) -> Verification:
    """What runs an accepted world again. Copies go side by side on CUDA, where no `control` steps them one by one."""

    def open_(stage: Path, time_step: float | None, seeds: Sequence[int]) -> AbstractContextManager[Simulation]:
        return open_simulation(stage, program, replace(settings, time_step=time_step), progress, seeds)

    controlled = has_control(program.read_text(encoding="utf-8", errors="replace"))
    side_by_side = sim.pick_device(settings.device).startswith("cuda") and not controlled
    return Verification(folder, plan, open_, side_by_side, settings.time_step, progress)


@contextlib.contextmanager
def _controller(program: Path, stage: Path, settings: Settings) -> Iterator[ArrayController | None]:
    """The program's `control`, if it has one, running in the sandbox."""
    if not has_control(program.read_text(encoding="utf-8", errors="replace")):
        yield None
        return
    world = describe(stage)
    layout = ControlLayout([body.prim for body in world.bodies], driven_joints(world))
    with ControlProcess(program, layout, settings.limits(), settings.isolation) as process:
        yield ArrayController(process.step)


def judge_recording(path: Path, plan: Plan | None, progress: Progress = silent, model: Path | None = None) -> Verdict:
    """Read a recording back and judge it; a trajectory.npz is one of someone else's, of what `model` describes."""
    progress("judging", 0, 2)
    evidence = importers.read_npz(path, model) if path.suffix == ".npz" else recording.read(path)
    progress("judging", 1, 2)
    verdict = judge(evidence, plan)
    progress("judging", 2, 2)
    return verdict


def reject(finding: Finding, summary: str) -> Verdict:
    """The verdict on a program that made no world, or broke it."""
    aim([finding])
    return Verdict(status="rejected", summary=summary, findings=[finding])


def conclude(folder: Path, verdict: Verdict) -> Verdict:
    """Write the verdict beside its evidence."""
    write_whole(folder / "verdict.json", verdict.model_dump_json(indent=2) + "\n")
    return verdict


def _timed(seconds: dict[str, float], name: str, work: Callable[[], Any]) -> Any:
    started = time.perf_counter()
    try:
        return work()
    finally:
        seconds[name] = round(time.perf_counter() - started, 3)
