"""`--verify`: a verdict that hangs on the time step is not accepted; one that does not is."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from tests.crashing import crashing
from tests.patience import STUCK
from wsim.judge import judge
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Plan
from wsim.progress import silent
from wsim.recording import read
from wsim.runs.alone import run_in_folder
from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings
from wsim.runs.verify import FINER, SEEDS, Verification, variants, with_spacing
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.perturb import PLACE

G, SPEED, FRICTION, STEP = 9.81, 1.0, 0.03, 1.25e-3
# A thin and slippery block, so that its brakes do not tip it over the edge.
# What a control pushes goes by steps of the first order, velocity first, then position: in steps of dt a block comes to
# rest v dt / 2 short of v^2 / (2 mu g).
STOP = SPEED**2 / (2.0 * FRICTION * G)
EDGE = STOP - 0.375 * SPEED * STEP  # between where it stops in steps of STEP, and in steps of half of it
PROGRAM = f"""\
def build(scene):
    wood = {{"friction": {FRICTION}, "color": (0.5, 0.3, 0.1)}}
    scene.simulation(duration=3.7, frame_rate=50.0)
    scene.box("table", size=(12.0, 1.0, 0.2), position=(%s - 6.0, 0.0, -0.1), static=True, **wood)
    scene.box("block", size=(0.2, 0.2, 0.006), mass=0.12, **wood, position=(0.0, 0.0, 0.003),
              velocity=({SPEED}, 0, 0))
"""
BREATH = """

def control(world, t):
    world.apply_force("block", (0.0, 0.0, -1e-5))  # of 1.2 N that it weighs
"""


def slide_plan(edge: float, pushed: bool = False) -> Plan:
    wood = {"name": "wood", "density": 500.0, "friction": FRICTION, "color": (0.5, 0.3, 0.1)}

    def box(name: str, state: str, size: tuple, position: tuple) -> dict:
        construction = {"kind": "proxy", "primitive": "box", "size": size}
        pose = {"position": position, "rotation_deg": (0.0, 0.0, 0.0)}
        about = {"role": "rigid_body", "material": wood, "construction": construction, "pose": pose}
        return {"name": name, "state": state, **about}

    table = box("table", "static", (12.0, 1.0, 0.2), (edge - 6.0, 0.0, -0.1))
    block = box("block", "dynamic", (0.2, 0.2, 0.006), (0.0, 0.0, 0.003)) | {"velocity": (SPEED, 0.0, 0.0)}

    return Plan.model_validate(
        {
            "title": "slide",
            "prompt": "A block slides on a table, and stops before its edge.",
            "objects": [table, block],
            "objectives": [{"kind": "stays_on", "object": "block", "ref": "table"}],
            "simulation": {"duration": 3.7, "frame_rate": 50.0},
            "steps": [
                {
                    "title": "A breath of air presses on the block",
                    "objects": ["block"],
                    "shows": "it slides",
                    "controls": pushed,
                }
            ],
        }
    )


def test_a_sound_world_is_accepted_and_its_variants_are_kept(tmp_path: Path) -> None:
    """By the command line, which shows each variant's progress."""
    (tmp_path / "slide.py").write_text(PROGRAM % (STOP + 0.3))
    (tmp_path / "plan.json").write_text(slide_plan(STOP + 0.3).model_dump_json())
    command = [sys.executable, "-m", "wsim.cli", "run", "slide.py", "--plan", "plan.json", "--verify"]
    command += ["--no-pictures", "--device", "cpu"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=STUCK, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for stage in ("verifying 1 of 2, half the time step", "verifying 2 of 2, another seed"):
        assert stage in done.stdout
    (folder,) = (tmp_path / "runs").iterdir()
    run = RunFolder(folder)
    verdict = Verdict.model_validate_json((run.iteration(1) / "verdict.json").read_text())
    converged = [finding for finding in verdict.findings if finding.check == "CheckConverged"]
    assert len(converged) == 2
    assert all(finding.value is not None and finding.value <= finding.limit for finding in converged)
    assert all(re.search("of the (margin|way to the limit on the other side): ", f.limit_from) for f in converged)
    facts = json.loads((run.path / "run.json").read_text())
    assert {(copy["variant"], copy["seed"], copy["status"]) for copy in facts["verify"]} == {
        ("half the time step", 0, "accepted"),
        ("another seed", 1, "accepted"),
    }
    chosen = read(run.iteration(1) / "recording.rrd").metadata["time_step"]
    assert [copy["time_step"] for copy in facts["verify"]] == pytest.approx([chosen / 2, chosen])
    assert (run.path / "accepted").is_dir()


def test_a_verdict_that_hangs_on_the_time_step_is_not_accepted(tmp_path: Path) -> None:
    program, run = tmp_path / "slide.py", RunFolder.create(tmp_path / "runs", "slide")
    program.write_text(PROGRAM % EDGE + BREATH)
    settings = Settings(device="cpu", pictures=False, time_step=STEP, verify=True)
    verdict = run_in_folder(run, program, slide_plan(EDGE, pushed=True), settings)
    assert verdict.status == "rejected"
    assert {failure.check for failure in verdict.failures} == {"CheckConverged"}
    failure = next(failure for failure in verdict.failures if failure.objective is not None)
    assert "Not converged: with half the time step" in failure.message
    assert failure.prim == "/World/block"
    assert failure.objective == "block stays_on table"
    assert failure.target is not None
    assert (failure.target.kind, failure.target.direction) == ("time step", "lower")
    assert failure.target.suggested == pytest.approx(STEP / 2)
    first = run.iteration(1)
    finer = first / "verify" / "half-the-time-step"
    end, finer_end = (read(path / "recording.rrd").position("/World/block")[-1, 0] for path in (first, finer))
    assert end < EDGE < finer_end
    assert end == pytest.approx(STOP - SPEED * STEP / 2, abs=1e-4)
    assert Verdict.model_validate_json((finer / "verdict.json").read_text()).status == "rejected"
    assert not (run.path / "accepted").exists()
    checks = json.loads((first / "checks.json").read_text())
    half = next(copy for copy in checks["verify"] if copy["variant"] == "half the time step")
    assert half["time_step"] == pytest.approx(STEP / 2)
    assert any(not finding["passed"] for finding in half["findings"])


def tank(scene: Scene) -> None:
    scene.simulation(duration=0.1, frame_rate=20.0)
    tank = scene.tank("tank", inner_size=(0.36, 0.36, 0.3))
    scene.fluid("water", fills=tank, level=0.12, spacing=0.03)
    scene.box("block", size=(0.1, 0.1, 0.06), density=500.0, position=(0.0, 0.0, 0.3))


def test_a_seed_moves_what_is_loose_by_a_hair_and_no_further(tmp_path: Path) -> None:
    scene = Scene()
    tank(scene)
    stage = scene.save(tmp_path / "stage.usda")

    def start(*seeds: int) -> tuple[np.ndarray, np.ndarray]:
        simulation = Simulation(stage, device="cpu", world_count=len(seeds), seeds=seeds)
        return simulation.state.body_q.numpy(), simulation.state.particle_q.numpy()

    (stated, lattice), (moved, shaken) = start(0), start(7)
    shift = moved[:, :3] - stated[:, :3]
    assert 0.0 < np.abs(shift).max() <= PLACE * 0.06 + 1e-7
    assert shift[0, 2] >= 0.0
    assert 0.5e-2 * 0.03 < np.abs(shaken - lattice).max() <= 1e-2 * 0.03 + 1e-7
    pair, both = start(0, 7)
    assert np.array_equal(pair, np.concatenate([stated, moved]))
    assert np.array_equal(both, np.concatenate([lattice, shaken]))
    with pytest.raises(ValueError, match="2 were given for 1 worlds"):
        Simulation(stage, device="cpu", seeds=(1, 2))


def test_a_finer_spacing_is_a_layer_over_the_stage(tmp_path: Path) -> None:
    scene = Scene()
    tank(scene)
    stage = scene.save(tmp_path / "stage.usda")
    finer = with_spacing(stage, tmp_path / "verify" / "finer.usda", FINER)
    coarse, fine = Simulation(stage, device="cpu"), Simulation(finer, device="cpu")
    assert fine.world.fluids[0].spacing == pytest.approx(FINER * 0.03)
    changed = {"fluids": [coarse.world.fluids[0].model_copy(update={"spacing": fine.world.fluids[0].spacing})]}
    assert coarse.world.model_copy(update=changed) == fine.world
    assert fine.model.particle_count == 15 * 15 * 5
    assert fine.model.particle_mass.numpy().sum() == pytest.approx(coarse.model.particle_mass.numpy().sum(), rel=1e-4)
    assert "subLayers" in finer.read_text() and "../stage.usda" in finer.read_text()


def test_shares_follow_from_the_order_of_convergence() -> None:
    from wsim.scene.world import Fluid, World

    water = Fluid(prim="/World/water", density=1e3, viscosity=1e-3, spacing=0.1, size=(1, 1, 1), center=(0, 0, 0))
    half, seed, finer = variants(World(fluids=[water]), 0.002, None, side_by_side=True)
    assert (half.time_step, half.share) == (0.001, 0.5)
    assert (seed.time_step, seed.seeds) == (0.002, tuple(range(1, 1 + SEEDS)))
    assert (finer.time_step, finer.spacing, finer.target.suggested) == (None, FINER, pytest.approx(FINER * 0.1))
    # A number that converges linearly, v(h) = v0 + c h, has a margin at h = 0 exactly if it moves by less than a share.
    for variant, ratio in ((half, 0.5), (finer, FINER)):
        for slope, sound in ((0.99, True), (1.01, False)):
            move = slope * (1.0 - ratio)  # of the margin 1 at h = 1, at which v(0) = v(1) - slope
            assert (move <= variant.share) is sound is (1.0 - slope > 0.0)
    assert len(variants(World(), 0.002, None, side_by_side=False)) == 2


def test_a_judge_that_crashes_on_a_rerun_leaves_the_verdict_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = RunFolder.create(tmp_path, "ball").iteration(1)
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=30.0)
    scene.sphere("ball", radius=0.1, density=600.0, position=(0.0, 0.0, 2.0))
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "recording.rrd")
    first = judge(read(folder / "recording.rrd"))
    assert first.status == "accepted"

    def again(stage: Path, time_step: float | None, seeds):
        return nullcontext(Simulation(stage, device="cpu", time_step=time_step, seeds=seeds))

    crashing(monkeypatch, CheckEnergy)
    verdict = Verification(folder, None, again, False, None, silent).check(first)
    assert verdict.status == "blocked"
    assert verdict.failures == []
    assert [crash.rerun for crash in verdict.crashes] == ["half the time step", "another seed"]
    said = "CheckEnergy could not be evaluated of the run with half the time step: ZeroDivisionError"
    assert verdict.summary.startswith(f"Blocked: {said}")


def test_other_seeds_run_side_by_side_where_the_device_allows(tmp_path: Path) -> None:
    """Batched on MuJoCo Warp: each world is judged as if it were alone, and all of them count."""
    folder = RunFolder.create(tmp_path, "slide").iteration(1)
    scene = Scene()
    namespace: dict = {}
    exec(PROGRAM % (STOP + 0.3), namespace)
    namespace["build"](scene)
    scene.simulation(duration=0.2)
    stage = scene.save(folder / "stage.usda")
    Simulation(stage, device="cpu").run(folder / "recording.rrd")

    opened = []

    def open_(stage: Path, time_step: float | None, seeds):
        opened.append(len(seeds))
        return nullcontext(Simulation(stage, device="cpu", world_count=len(seeds), time_step=time_step, seeds=seeds))

    first = judge(read(folder / "recording.rrd"))
    again = Verification(folder, None, open_, True, None, lambda stage, done, total: None)
    assert again.check(first).status == "accepted"
    assert opened == [1, SEEDS]
    assert sorted(copy["seed"] for copy in again.figures) == [0, *range(1, 1 + SEEDS)]
