"""One program tried: checked, built, looked at, simulated, recorded; cheap passes first, no further than it fails."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass, field, replace
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wsim import sim
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.framing import framed
from wsim.judge.verdict import Finding, RepairTarget, Verdict
from wsim.program.validator import validate
from wsim.runs.iteration import Iteration, no_world, reject
from wsim.runs.pulled import pull_missing
from wsim.runs.trajectory import Trajectory
from wsim.scene.describe import describe
from wsim.scene.world import Camera

if TYPE_CHECKING:
    from wsim.sim.stills import Still


class Reached(IntEnum):
    """How far an attempt came: the pass that it failed, or all."""

    VALIDATION = 0
    BUILD = 1
    FRAMES = 2
    PHYSICS = 3
    RECORDING = 4
    REVIEW = 5
    ALL = 6


Rank = tuple[int, int, float]
NUMERICS = ("time_step", "spacing", "speed_of_sound")


@dataclass
class Attempt:
    """A program, how far it came, and what was found.

    Attributes:
        folder: The iteration's, with the artefacts of the passes that ran.
        program: Its text.
        reached: The pass that it failed.
        verdict: Of that pass.
        earlier: The trajectory of the pass without pictures, where there was one.
        review: What the reviewer saw, as text.
        seen: The differences from the plan that a reviewer's model saw; None: none looked.
        repair: What the judge wants mended first, as text.
        plan_fault: What of the plan no program can make true, as the judge has it.
    """

    folder: Path
    program: str
    reached: Reached = Reached.VALIDATION
    verdict: Verdict = field(default_factory=lambda: Verdict(status="blocked", summary="not tried"))
    earlier: Trajectory | None = None
    review: str = ""
    seen: list[str] | None = None
    repair: str = ""
    plan_fault: str = ""

    @property
    def number(self) -> int:
        """Of the iteration, from 1."""
        return int(self.folder.name)

    @property
    def rank(self) -> Rank:
        """Greater is better: further, then fewer failures, then less far from the limits.

        What could not be evaluated may have failed, and counts as if it had.
        """
        failures, crashes = self.verdict.failures, self.verdict.crashes
        different = {(finding.check, finding.prim, finding.objective) for finding in failures}
        unknown = {(crash.check, crash.objective) for crash in crashes}
        return (int(self.reached), -len(different) - len(unknown), -sum(map(_short, failures)) - len(unknown))


def _short(finding: Finding) -> float:
    """By how much a finding misses its limit, as a share of it, between 0 and 1; its weight where it has no numbers."""
    if finding.margin is None or finding.margin >= 0.0:
        return finding.weight
    scale = max(abs(finding.limit or 0.0), abs(finding.expected or 0.0))
    return round(-finding.margin / (scale - finding.margin), 6)


def attempt(iteration: Iteration, cheap_first: bool = True) -> Attempt:
    """Run the passes over a program, up to the first that fails.

    Validation, build, one frame a camera, physics without pictures, the full recording. Each pass leaves its files in
    the iteration's folder, and verdict.json is that of the last.

    Args:
        iteration: With a program.py; if its settings want no pictures there are no frames, and the physics are all.
        cheap_first: False goes from the build to the full recording: where nothing would be repaired, the cheap passes
            only take time.
    """
    pull_missing(iteration.text, iteration.progress)  # the validator makes the program's calls, too
    made = Attempt(iteration.folder, iteration.text)
    looks = [_framed, _moved] if iteration.settings.pictures else []
    passes = [_validated, _built, *looks, _recorded] if cheap_first else [_built, _recorded]
    for run in passes:
        try:
            verdict = run(made, iteration)
        except (ValueError, RuntimeError, LookupError, ArithmeticError) as error:
            if not cheap_first:
                raise
            verdict = _broken(error)  # a stage that passed its check and breaks the simulator is the coder's to mend
        if verdict is not None:
            made.verdict = iteration.conclude(verdict)
            if verdict.status != "accepted":
                iteration.leave_stills()
                return made
    made.reached = Reached.ALL
    return made


def _broken(error: Exception) -> Verdict:
    text = " ".join(str(error).split())[:400]
    message = f"the simulator cannot run this stage: {type(error).__name__}: {text}"
    return reject(Finding(check="simulation", passed=False, message=message), "The simulator cannot run this stage.")


def _validated(made: Attempt, iteration: Iteration) -> Verdict | None:
    made.reached = Reached.VALIDATION
    problems = validate(made.program, iteration.plan)
    if not problems:
        return None
    findings = [
        Finding(
            check="program",
            passed=False,
            message=problem.sentence,
            line=f"program.py:{problem.line}",
            target=RepairTarget(kind="program"),
        )
        for problem in problems
    ]
    return Verdict(status="rejected", summary=f"Mistakes in the program: {len(problems)}.", findings=findings)


def _built(made: Attempt, iteration: Iteration) -> Verdict | None:
    made.reached = Reached.BUILD
    built = iteration.build()
    return None if built.ok else no_world(built)


def _framed(made: Attempt, iteration: Iteration) -> Verdict | None:
    """One frame a camera: a view in which nothing of the plan is to be seen fails before anything is simulated."""
    made.reached = Reached.FRAMES
    plan = iteration.plan
    # What is clear is not in a picture of what is opaque, by which pixels are counted.
    things = [item for item in plan.objects if item.primitive not in ("ground", "tank")] if plan else []
    named = {f"/World/{item.name}" for item in things if item.material is None or item.material.opacity == 1.0}
    findings = []
    for still in _stills_of_asked(iteration):
        pixels = {prim: count for prim, count in still.pixels.items() if prim in named and count}
        if named & set(still.pixels) and not pixels:
            findings.append(
                Finding(
                    check="CheckView",
                    passed=False,
                    message=f"{still.camera.prim} shows nothing of the plan at the start",
                    prim=still.camera.prim,
                    time=0.0,
                    limit_from="a camera is there to show something",
                    target=_look_at(still.camera, iteration.stage),
                )
            )
    if not findings:
        return None
    return Verdict(status="rejected", summary=f"Cameras that show nothing: {len(findings)}.", findings=findings)


def _stills_of_asked(iteration: Iteration) -> list[Still]:
    """The start, seen by the cameras that stay as they are; the others will be framed on what happens."""
    world = describe(iteration.stage)
    fixed = [camera for camera in world.cameras if camera.fixed]
    if not fixed:
        return []
    stills = sim.Stills(iteration.stage, iteration.settings.device, fixed, iteration.progress)
    return stills.draw_start()


def _look_at(camera: Camera, stage: Path) -> RepairTarget:
    """Where a camera is to stand and look, so that it sees where everything starts that moves."""
    target = RepairTarget(
        kind="camera", prim=camera.prim, parameter="eye, target", direction="change", unit="m",
        why="look at the objects",
    )  # fmt: skip
    world = describe(stage)
    starts = [body.position for body in world.bodies] + [fluid.center for fluid in world.fluids]
    sizes = [kind_of(shape).radius_about for body in world.bodies for shape in body.shapes]
    radius = max((size for size in sizes + [max(fluid.size) for fluid in world.fluids] if size < math.inf), default=0.1)
    found = framed(camera, np.array(starts), radius) if starts else None
    if found is None:
        return target
    return target.model_copy(update={"vector": tuple(float(x) for place in found for x in place)})


def _moved(made: Attempt, iteration: Iteration) -> Verdict | None:
    made.reached = Reached.PHYSICS
    quick = replace(iteration.settings, pictures=False, verify=False)
    verdict = replace(iteration, settings=quick).happen()
    if verdict.status == "accepted":
        made.earlier = Trajectory.of(iteration.recording)
    return verdict


def _recorded(made: Attempt, iteration: Iteration) -> Verdict | None:
    made.reached = Reached.RECORDING
    return iteration.happen()


def numerics(program: str) -> list[str]:
    """How a program has its world computed: the values that it gives for time steps and particle spacings."""
    calls = (node for node in ast.walk(ast.parse(program)) if isinstance(node, ast.Call))
    given = (keyword for call in calls for keyword in call.keywords if keyword.arg in NUMERICS)
    return sorted(f"{keyword.arg}={ast.unparse(keyword.value)}" for keyword in given)
