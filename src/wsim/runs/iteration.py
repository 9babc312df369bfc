"""One program of a run, and the passes over it: program → stage → recording → verdict, each a file in its folder."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim import importers, recording, sim
from wsim.assets import asset_folders
from wsim.judge import judge
from wsim.judge.repair.aim import aim
from wsim.judge.verdict import Finding, Verdict
from wsim.plan.subjects import asked_about
from wsim.program import sandbox
from wsim.program.control import ControlError
from wsim.progress import Progress, silent
from wsim.runs import draws
from wsim.runs.folder import write_json, write_whole
from wsim.runs.left_stills import leave_stills
from wsim.runs.pulled import pull_missing
from wsim.runs.settings import Settings
from wsim.runs.simulation import is_controlled, open_simulation
from wsim.runs.verify import Verification
from wsim.scene.describe import describe

if TYPE_CHECKING:
    from wsim.plan.schema import Objective, Plan
    from wsim.program.sandbox import BuildResult
    from wsim.sim import Simulation, SimulationResult


@dataclass
class Iteration:
    """A program, what it is held to, and how it is run. Only its methods write the artefacts in its folder.

    Attributes:
        folder: Where program.py lies, and where stage.usda, recording.rrd, verdict.json and the rest go.
        plan: What the judge holds the world to; without one, only the checks that hold for any world.
        settings: Device, parameters, limits.
        progress: Told how far it is.
        source: The program; where none is named, program.py of the folder.
    """

    folder: Path
    plan: Plan | None = None
    settings: Settings = field(default_factory=Settings)
    progress: Progress = silent
    source: Path | None = None

    @classmethod
    def of(
        cls,
        program: Path,
        folder: Path,
        plan: Plan | None = None,
        settings: Settings | None = None,
        progress: Progress = silent,
    ) -> Iteration:
        """One whose program is a copy of a file."""
        made = cls(folder, plan, settings or Settings(), progress)
        if program.resolve() != made.program.resolve():
            shutil.copyfile(program, made.program)
        return made

    @property
    def program(self) -> Path:
        """What is run."""
        return self.source or self.folder / "program.py"

    @property
    def text(self) -> str:
        """The program's."""
        return self.program.read_text(encoding="utf-8")

    @property
    def stage(self) -> Path:
        """What the program builds."""
        return self.folder / "stage.usda"

    @property
    def recording(self) -> Path:
        """What happened."""
        return self.folder / "recording.rrd"

    @property
    def checks(self) -> dict[str, Any]:
        """What checks.json says of the build and the simulation; nothing where there is none."""
        path = self.folder / "checks.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    @property
    def verdict(self) -> Verdict:
        """What verdict.json says."""
        return Verdict.model_validate_json((self.folder / "verdict.json").read_text(encoding="utf-8"))

    def run(self) -> Verdict:
        """Build, simulate, judge.

        Returns:
            The verdict. A program that fails is a rejected one; a broken environment raises.
        """
        built = self.build()
        return self.conclude(self.happen() if built.ok else no_world(built))

    def build(self) -> BuildResult:
        """Program → stage, in the sandbox, with what is drawn set on it; checks.json says how it went.

        Raises:
            UserError: If what is drawn cannot be set on the stage, or a robot that it names cannot be pulled.
        """
        pull_missing(self.text, self.progress)
        self.progress("building the stage", 0, 1)
        built = sandbox.build(
            self.program,
            self.stage,
            self.settings.params,
            self.settings.limits(),
            isolation=self.settings.isolation,
            readable=asset_folders(),
        )
        self.progress("building the stage", 1, 1)
        self._note({"build": built.facts(), "seconds": {"build": round(built.seconds, 3)}})
        if built.ok:
            draws.apply(self.stage, self.settings.draws)
        return built

    def happen(self) -> Verdict:
        """Stage → recording → verdict, which is not written yet; checks.json says how it went."""
        before = self.checks
        checks: dict[str, Any] = {"build": before.get("build")}
        seconds = dict(before.get("seconds", {}))
        try:
            result = self.simulate(seconds)
        except ControlError as error:
            self._note(checks | {"simulation": {"error": str(error)}, "seconds": seconds})
            self.leave_stills()
            return reject(Finding(**error.finding()), f"The program's control failed ({error.kind}).")
        with _timed(seconds, "judge"):
            verdict = judge_recording(self.recording, self.plan, self.progress)
        stills = [path.name for path in result.stills]
        checks |= {"simulation": {**asdict(result), "stills": stills}, "seconds": seconds}
        self._note(checks)
        if self.settings.verify and verdict.status == "accepted":
            again = self._verification()
            with _timed(seconds, "verify"):
                verdict = again.check(verdict)
            self._note(checks | {"verify": again.figures})
        return verdict

    def simulate(self, seconds: dict[str, float]) -> SimulationResult:
        """Stage → recording, with video and stills where they are wanted.

        Args:
            seconds: Gets the wall time of each phase [s].

        Raises:
            ControlError: If the program's own `control` fails.
        """
        pictures = self.settings.pictures
        began = time.perf_counter()
        with open_simulation(
            self.stage, self.program, self.settings, self.progress, (self.settings.seed,)
        ) as simulation:
            seconds["prepare"] = round(time.perf_counter() - began, 3)
            result = simulation.run(
                self.recording,
                video=self.folder / "video.mp4" if pictures else None,
                frames_dir=self.folder / "frames" if pictures else None,
                review=self.folder / "review.json" if pictures else None,
                metadata={"program": self.program.name, "params": self.settings.params | self.settings.draws},
                progress=self.progress,
                named=self._asked,
                words=self._judged if self.settings.caption else None,
            )
        seconds |= result.seconds
        return result

    def leave_stills(self) -> None:
        """Draw stills of what was recorded, where no pictures were taken and some are wanted."""
        if self.settings.pictures:
            leave_stills(self.folder, self._asked, self.settings.device, self.progress)

    @property
    def _judged(self) -> str:
        """What the world is held to, in a line."""
        told = [objective.sentence or f"{objective.object} {objective.kind}" for objective in self._objectives]
        return "; ".join(told)

    @property
    def _objectives(self) -> list[Objective]:
        return self.plan.objectives if self.plan else []

    @property
    def _asked(self) -> list[str]:
        return asked_about(self.plan) if self.plan else []

    def conclude(self, verdict: Verdict) -> Verdict:
        """Write the verdict beside its evidence."""
        write_whole(self.folder / "verdict.json", verdict.model_dump_json(indent=2) + "\n")
        return verdict

    def _note(self, checks: dict[str, Any]) -> None:
        write_json(self.folder / "checks.json", checks)

    def _verification(self) -> Verification:
        """What runs an accepted world again; on CUDA side by side, unless a `control` steps them one by one."""
        settings, program, progress = self.settings, self.program, self.progress

        def again(stage: Path, time_step: float | None, seeds: Sequence[int]) -> AbstractContextManager[Simulation]:
            return open_simulation(stage, program, replace(settings, time_step=time_step), progress, seeds)

        on_cuda = sim.pick_device(settings.device, describe(self.stage)).startswith("cuda")
        side_by_side = on_cuda and not is_controlled(program)
        return Verification(self.folder, self.plan, again, side_by_side, settings.time_step, progress)


def judge_recording(path: Path, plan: Plan | None, progress: Progress = silent, model: Path | None = None) -> Verdict:
    """Read a recording back and judge it; a trajectory.npz is one of someone else's, of what `model` describes."""
    progress("judging", 0, 2)
    evidence = importers.read_npz(path, model) if path.suffix == ".npz" else recording.read_and_keep(path)
    progress("judging", 1, 2)
    verdict = judge(evidence, plan)
    progress("judging", 2, 2)
    return verdict


def no_world(built: BuildResult) -> Verdict:
    """The verdict on a program whose build failed."""
    return reject(Finding(**built.finding()), f"The program made no world ({built.kind}).")


def reject(finding: Finding, summary: str) -> Verdict:
    """The verdict on a program that made no world, or broke it."""
    aim([finding])
    return Verdict(status="rejected", summary=summary, findings=[finding])


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    started = time.perf_counter()
    try:
        yield
    finally:
        seconds[name] = round(time.perf_counter() - started, 3)
