"""Is an accepted world an artefact of how it was computed? It is run again, computed more finely, and judged again."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Sdf, Usd

from wsim import recording, sim
from wsim.judge import judge
from wsim.judge.convergence import CheckConverged, Rerun
from wsim.judge.decide import conclude, held
from wsim.judge.verdict import Crash, Finding, RepairTarget, Verdict
from wsim.plan.asked.covered import told
from wsim.program.control import ControlError
from wsim.progress import Progress
from wsim.runs.folder import write_whole
from wsim.scene import schema
from wsim.scene.describe import describe

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.scene.world import World
    from wsim.sim.simulation import Simulation

    OpenSimulation = Callable[[Path, float | None, Sequence[int]], AbstractContextManager[Simulation]]

FINER = 0.8  # of the spacing: 2 to 2.5 times the work; half the spacing would be 16 times
ORDER = 1.0  # of convergence: contacts, the coupling to a fluid and the wall particles are first-order
SEED, SEEDS = 1, 8  # one more run alone, or this many where a device runs them side by side
SIGMAS = 3.0


@dataclass(frozen=True)
class Variant:
    """One way to compute the same world again. `seeds` has one entry for each copy that is run side by side."""

    name: str  # as it follows "with"
    time_step: float | None  # [s]; None: chosen anew
    share: float  # of an objective's margin that its number may move by
    share_from: str
    target: RepairTarget
    spacing: float = 1.0  # times the fluids' own
    seeds: tuple[int, ...] = (0,)

    @property
    def slug(self) -> str:
        """Its folder's name."""
        return self.name.replace(" ", "-")


def variants(world: World, time_step: float, given: float | None, side_by_side: bool) -> list[Variant]:
    """What a world is run again with.

    By Richardson's extrapolation the error of a run is its difference from a run that is finer by a ratio r, over
    1 - r^p at order p (Roache 1994, "Perspective: a method for uniform reporting of grid refinement studies"). The sign
    of a margin m holds in the limit while that error is below m: while the number moves by less than (1 - r^p) m.
    Two draws that differ by d have a standard deviation of about d / sqrt(2): 3 of them fit into m while d is below
    sqrt(2) / 3 m.

    Args:
        world: What the stage states.
        time_step: What it was run at [s].
        given: The step that the caller had asked for [s], if any; the finer spacing's is chosen anew otherwise.
        side_by_side: Whether many copies with other seeds cost hardly more than one.
    """
    seeds = tuple(range(SEED, SEED + SEEDS)) if side_by_side else (SEED,)
    found = [
        Variant(
            "half the time step",
            time_step / 2,
            1.0 - 0.5**ORDER,
            "1 - r^p for a step finer by r = 1/2 at order p = 1: the margin's sign then holds at a vanishing step",
            RepairTarget(
                kind="time step",
                parameter="time_step",
                direction="lower",
                suggested=time_step / 2,
                unit="s",
                why="what was found depends on the time step",
            ),
        ),
        Variant(
            "another seed",
            time_step,
            math.sqrt(2.0) / SIGMAS,
            f"sqrt(2) / {SIGMAS:g}: two draws that differ by d have a standard deviation of d / sqrt(2), and "
            f"{SIGMAS:g} of them fit into the margin",
            RepairTarget(kind="settlement", direction="change", why="a hair's breadth in how it is set up decides"),
            seeds=seeds,
        ),
    ]
    if world.fluids:
        finest = min(world.fluids, key=lambda fluid: fluid.spacing)
        found.append(
            Variant(
                "a finer spacing",
                given * FINER if given else None,
                1.0 - FINER**ORDER,
                f"1 - r^p for a spacing finer by r = {FINER:g} at order p = 1: the margin's sign then holds at a "
                "vanishing spacing",
                RepairTarget(
                    kind="resolution",
                    prim=finest.prim,
                    parameter="spacing",
                    direction="lower",
                    suggested=FINER * finest.spacing,
                    unit="m",
                    why="what was found depends on the particles' spacing",
                ),
                spacing=FINER,
            )
        )
    return found


class Verification:
    """Runs the variants of an accepted run under `<folder>/verify`, and holds the verdict against theirs.

    Args:
        folder: The iteration's, with its stage and recording.
        plan: What it was judged by.
        open_simulation: (stage, time step, seeds) → the simulation, with the program's control if it has one.
        side_by_side: Whether the device runs copies of a world side by side.
        given: The time step that the caller had asked for [s].
        progress: Told how far each variant is.
    """

    def __init__(
        self,
        folder: Path,
        plan: Plan | None,
        open_simulation: OpenSimulation,
        side_by_side: bool,
        given: float | None,
        progress: Progress,
    ) -> None:
        self.folder, self.plan = folder, plan
        self._open, self._side_by_side = open_simulation, side_by_side
        self._given, self._progress = given, progress
        self.figures: list[dict[str, Any]] = []  # one a variant's copy: how it was computed, and what was found

    def check(self, first: Verdict) -> Verdict:
        """The verdict with what the reruns add to it: a `CheckConverged` finding or more for each variant."""
        world = describe(self.folder / "stage.usda")
        found: list[Finding] = []
        crashes: list[Crash] = []
        chosen = variants(world, self._time_step(), self._given or world.time_step or None, self._batches(world))
        for number, variant in enumerate(chosen, start=1):
            label = f"verifying {number} of {len(chosen)}, {variant.name}"
            reruns = self._run(variant, lambda stage, done, total, label=label: self._tell(label, stage, done, total))
            found += CheckConverged().compare(first, reruns)
            crashes += [
                crash.model_copy(update={"rerun": rerun.name}) for rerun in reruns for crash in rerun.verdict.crashes
            ]
        return held(conclude([*first.findings, *found], crashes=crashes), told(self.plan))

    def _time_step(self) -> float:
        return float(recording.read(self.folder / "recording.rrd").metadata["time_step"])

    def _batches(self, world: World) -> bool:
        return self._side_by_side and not world.fluids

    def _tell(self, label: str, stage: str, done: float, total: float) -> None:
        if stage == "simulating":
            self._progress(label, done, total)

    def _run(self, variant: Variant, progress: Progress) -> list[Rerun]:
        """Simulate and judge a variant; its recording and verdict stay in its folder."""
        began, folder = time.perf_counter(), self.folder / "verify" / variant.slug
        folder.mkdir(parents=True, exist_ok=True)
        stage, facts = self._stage(variant, folder), {}
        try:
            with self._open(stage, variant.time_step, variant.seeds) as simulation:
                facts = {"time_step": simulation.dt, "particles": simulation.model.particle_count}
                verdicts = self._judge(simulation, variant, folder, progress)
        except ControlError as error:
            summary = f"The program's control failed ({error.kind})."
            verdicts = [Verdict(status="rejected", summary=summary, findings=[Finding(**error.finding())])]
        seconds = round(time.perf_counter() - began, 3)
        for seed, verdict in zip(variant.seeds, verdicts, strict=False):
            self.figures.append(_figures(variant, seed, verdict) | facts | {"seconds": seconds})
        return [
            Rerun(self._name(variant, seed), verdict, variant.share, variant.share_from, variant.target)
            for seed, verdict in zip(variant.seeds, verdicts, strict=False)
        ]

    def _judge(self, simulation: Simulation, variant: Variant, folder: Path, progress: Progress) -> list[Verdict]:
        if len(variant.seeds) > 1:
            worlds = sim.collected(simulation, progress)
            return [judge(worlds.recording(k), self.plan) for k in range(worlds.world_count)]
        simulation.run(folder / "recording.rrd", metadata={"variant": variant.name}, progress=progress)
        verdict = judge(recording.read(folder / "recording.rrd"), self.plan)
        write_whole(folder / "verdict.json", verdict.model_dump_json(indent=2) + "\n")
        return [verdict]

    def _stage(self, variant: Variant, folder: Path) -> Path:
        """The stage as it is, or a layer over it with the fluids' spacing changed."""
        stage = self.folder / "stage.usda"
        return stage if variant.spacing == 1.0 else with_spacing(stage, folder / "stage.usda", variant.spacing)

    @staticmethod
    def _name(variant: Variant, seed: int) -> str:
        return f"{variant.name} ({seed})" if len(variant.seeds) > 1 else variant.name


def with_spacing(stage: Path, target: Path, ratio: float) -> Path:
    """A layer over a stage in which the particles of every fluid are `ratio` times as far apart.

    Args:
        stage: What it is laid over, by a relative path.
        target: The file to write.
        ratio: Of the new spacing to the old.
    """
    target.unlink(missing_ok=True)
    below = Sdf.Layer.FindOrOpen(str(stage))
    layer = Sdf.Layer.CreateNew(str(target))
    layer.subLayerPaths.append(Path(os.path.relpath(stage, target.parent)).as_posix())
    for key in below.pseudoRoot.ListInfoKeys():  # units, up axis, default prim: a stage has its root layer's
        if key != "subLayers":
            layer.pseudoRoot.SetInfo(key, below.pseudoRoot.GetInfo(key))
    over = Usd.Stage.Open(layer)
    for prim in over.Traverse():
        if schema.has(prim, schema.FLUID):
            spacing = prim.GetAttribute("wsim:spacing")
            spacing.Set(ratio * float(spacing.Get()))
    layer.Save()
    return target


def _figures(variant: Variant, seed: int, verdict: Verdict) -> dict[str, Any]:
    fields = {"check", "objective", "prim", "passed", "value", "limit", "margin", "unit"}
    return {
        "variant": variant.name,
        "spacing_ratio": variant.spacing,
        "seed": seed,
        "share": variant.share,
        "status": verdict.status,
        "summary": verdict.summary,
        "findings": [finding.model_dump(mode="json", include=fields) for finding in verdict.findings],
    }
