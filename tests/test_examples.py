"""The examples: the short ones judged, the others simulated coarsely; what scenes must do; two run as programs."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd

from tests.patience import STUCK
from wsim.judge.verdict import Verdict
from wsim.plan.layout.boxes import Box
from wsim.plan.store import load
from wsim.plan.views import _sees as sees
from wsim.recording import Recording, read
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

EXAMPLES = Path(__file__).parent.parent / "examples"


LONG = {
    "dam_break",
    "floating_blocks",
    "floating_crossing",
    "marble_run",
    "offroad_drive",
    "terrain_crates",
    "wood_afloat",
}  # minutes on two cores
BY_COMMAND = {"stack_and_ball"}  # `wsim run` judges it below
SHORT = sorted({path.stem for path in EXAMPLES.glob("*.py")} - LONG - BY_COMMAND)


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Verdict, Recording]]:
    """Run an example as it is, but for its pictures, and judge it: once for all who ask."""
    done: dict[str, tuple[Verdict, Recording]] = {}

    def one(name: str) -> tuple[Verdict, Recording]:
        if name not in done:
            folder = tmp_path_factory.mktemp(name)
            settings = Settings(device="cpu", pictures=False)
            verdict = Iteration.of(EXAMPLES / f"{name}.py", folder, None, settings).run()
            done[name] = verdict, read(folder / "recording.rrd")
        return done[name]

    return one


@pytest.fixture
def simulate(tmp_path: Path) -> Callable[..., Recording]:
    """Simulate an example's stage with other numbers: duration [s], frames a second, and spacing [m] of the water."""

    def one(name: str, duration: float, frame_rate: float, spacing: float | None = None) -> Recording:
        spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        scene = Scene()
        module.build(scene)
        scene.simulation(duration=duration, frame_rate=frame_rate)
        if spacing:
            scene.stage.GetPrimAtPath("/World/water").GetAttribute("wsim:spacing").Set(spacing)
        stage = scene.save(tmp_path / "stage.usda")
        assert Usd.Stage.Open(str(stage))
        result = Simulation(stage, device="cpu").run(tmp_path / "recording.rrd")
        assert result.problems == []
        return read(tmp_path / "recording.rrd")

    return one


# A program that runs by itself takes the first device that there is: here the CPU, whose kernels need no compiler.
ON_CPU = {**os.environ, "CUDA_VISIBLE_DEVICES": ""}


def run(command: list[str], folder: Path) -> tuple[str, Path]:
    """Run a command in an empty folder, on the CPU; its output, and the folder of the one run that it made."""
    ended = subprocess.run(command, cwd=folder, env=ON_CPU, capture_output=True, text=True, timeout=STUCK)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert ended.stderr == ""
    (made,) = (folder / "runs").iterdir()
    assert json.loads((made / "run.json").read_text())["status"] == "accepted"
    assert {path.name for path in (made / "accepted").iterdir()} == {"program.py", "stage.usda", "SHA256SUMS"}
    assert (made / "report.html").is_file()
    return ended.stdout, made


def out_of_picture(recording: Recording) -> set[str]:
    """Bodies whose middle the first camera does not have in its picture at some frame."""
    camera = recording.world.cameras[0]
    places = {body.prim: recording.position(body.prim) for body in recording.world.bodies}
    points = {prim: {tuple(map(float, point)) for point in np.unique(way, axis=0)} for prim, way in places.items()}
    return {prim for prim, way in points.items() if not all(sees(camera.eye, camera.target, Box(p, p)) for p in way)}


@pytest.mark.parametrize("name", SHORT)
def test_what_it_shows_stays_in_the_picture(judged, name) -> None:
    _, recording = judged(name)
    assert out_of_picture(recording) == set()


@pytest.mark.parametrize("name", SHORT)
def test_its_motion_has_forces_behind_it(judged, name) -> None:
    """All that no plan needs to be known for, of a program that a person is shown first."""
    verdict, _ = judged(name)
    assert verdict.status == "accepted", verdict.summary
    checks = {finding.check for finding in verdict.findings}
    assert checks >= {"CheckForces", "CheckRecordedForces", "CheckEnergy"}


def test_the_worn_link_breaks_under_the_ball_and_no_other_before(judged) -> None:
    """What hangs and the ball weigh 0.4 kN of the 3 kN that it bears: it is the blow that breaks it."""
    verdict, recording = judged("breaking_chain")
    broken = {name: scalar for name, scalar in recording.scalars.items() if name.startswith("broken/")}
    first = {name: recording.time[np.argmax(gone)] for name, gone in broken.items() if gone.max() > 0.0}
    assert min(first, key=first.get) == "broken/pin_3"
    fall = np.sqrt(2.0 * (0.6 - 0.08) / 9.81)  # from the ball's lowest point to the pan
    assert 0.0 <= first["broken/pin_3"] - fall < 1.0 / 60.0
    assert verdict.status == "accepted"


def test_a_crate_is_carried_onto_the_lift_and_up(judged) -> None:
    _, recording = judged("conveyor")
    names = [body.prim.rsplit("/", 1)[1] for body in recording.world.bodies]
    crate, ball = recording.body_q[:, names.index("crate"), :3], recording.body_qd[:, names.index("ball")]
    assert crate[-1] == pytest.approx((1.04, 0.0, 0.5 - 0.002 + 0.7 + 0.2), abs=2e-3)  # at the stop, on the lifted deck
    assert ball[-1, 0] == pytest.approx(0.7, rel=1e-3)  # it still rolls as it started


def test_double_pendulum_keeps_its_energy(judged) -> None:
    _, recording = judged("double_pendulum")
    potential = recording.scalars["energy/potential"]
    energy = recording.scalars["energy/kinetic"] + potential
    assert np.ptp(potential) > 5.0  # it swings: 5.4 kg m/s^2 a metre, twice
    assert np.ptp(energy) < 1e-3 * np.ptp(potential)
    upper, lower = recording.position("/World/upper"), recording.position("/World/lower")
    assert np.hypot(upper[:, 0], upper[:, 2] - 1.6) == pytest.approx(0.25, abs=1e-3)  # the shoulder holds
    assert np.linalg.norm(upper - lower, axis=1).max() < 0.5 + 1e-3  # so does the elbow
    assert np.abs(lower[:, 1]).max() < 1e-3


def test_dam_break_runs_forward_and_stays_in_its_tank(simulate) -> None:
    recording = simulate("dam_break", 0.6, 20.0, spacing=0.05)
    water = recording.fluids["/World/water"].position
    front = np.quantile(water[:, :, 0], 0.99, axis=1)
    assert front[0] == pytest.approx(-0.8 + 0.45, abs=0.05)
    assert front[-1] > 0.2  # it has reached the obstacle
    assert (np.diff(front[: np.argmax(front > 0.2)]) > 0.0).all()
    assert water[-1, :, 2].mean() < 0.75 * water[0, :, 2].mean()
    slack = 0.025  # half a spacing
    for axis, (low, high) in enumerate([(-0.8, 0.8), (-0.2, 0.2), (0.02, np.inf)]):
        assert water[:, :, axis].min() > low - slack
        assert water[:, :, axis].max() < high + slack


def test_blocks_float_and_the_ball_sinks(simulate) -> None:
    recording = simulate("floating_blocks", 1.2, 10.0, spacing=0.05)
    surface = 0.02 + 0.3
    for i in range(3):
        assert recording.position(f"/World/block_{i}")[:, 2].min() > surface - 0.15  # it never goes under
        assert abs(recording.position(f"/World/block_{i}")[-1, 2] - surface) < 0.08
    ball = recording.position("/World/ball")[:, 2]
    assert ball[-1] < 0.02 + 0.06 + 0.02  # on the floor
    assert ball[-1] > 0.02 + 0.06 - 0.01


@pytest.mark.parametrize(("density", "share"), [(400.0, 1.0), (900.0, 0.0)])
def test_wood_floats_or_stands_where_archimedes_has_it(tmp_path: Path, density: float, share: float) -> None:
    """The lighter one has 0.08 m - 0.4 x 0.16 m x 3/4 of water under it, the heavier one has none."""
    spec = importlib.util.spec_from_file_location("wood_afloat", EXAMPLES / "wood_afloat.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    scene = Scene(params={"density": density})
    module.build(scene)
    scene.simulation(duration=1.5, frame_rate=20.0)
    result = Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "recording.rrd")
    assert result.problems == []
    under = read(tmp_path / "recording.rrd").position("/World/block")[:, 2] - 0.02 - 0.16 / 2
    assert under[0] > 0.03  # it starts apart from the bottom
    gap = share * (0.08 - 0.4 * 0.16 * (1.0 - 0.25))
    assert under[-10:].mean() == pytest.approx(gap, abs=0.25 * 0.02)  # of a spacing


def test_the_crossings_plan_asks_what_archimedes_says_of_its_world(tmp_path: Path) -> None:
    """The block goes down by m / rho (1 / A - 1 / A'), and no end of it goes under; of Chrono's block one would."""
    plan = load(EXAMPLES / "plans" / "polaris_crossing.json")
    iteration = Iteration.of(EXAMPLES / "floating_crossing.py", tmp_path, plan)
    assert iteration.build().ok
    world = describe(iteration.stage)
    assert {each.prim.split("/")[2] for each in (*world.bodies, *world.statics, *world.fluids)} == {
        name for item in plan.objects for name in item.prims
    }
    (block,) = (body for body in world.bodies if body.prim == "/World/block")
    load_mass, (length, width, height) = sum(body.mass for body in world.bodies) - block.mass, block.shapes[0].size
    assert load_mass == pytest.approx(1360.0)
    (basin,), (water,) = world.containers, world.fluids
    down = load_mass / 1000.0 * (1.0 / (length * width) - 1.0 / (basin.inner_size[0] * basin.inner_size[1]))
    (sinks,) = (
        each.formula.of
        for each in plan.objectives
        if each.formula and each.formula.op == "mean" and each.formula.window
    )
    assert (sinks.low, sinks.high) == (pytest.approx(-1.1 * down, rel=1e-3), pytest.approx(-0.9 * down, rel=1e-3))
    draft = block.mass / 1000.0 / (length * width)
    assert water.center[2] + 0.5 * water.size[2] - draft + 0.5 * height == pytest.approx(block.position[2], abs=1e-6)

    def left(density: float, thick: float) -> float:
        """Of an end over the water, with the rear axle over it: the weight is 0.43 of the wheelbase farther in [m]."""
        own = density * length * width * thick
        total = own + load_mass
        under = total / 1000.0 / (length * width)
        high = (own * 0.5 * thick + load_mass * (thick + 0.6)) / total
        metacentric = 0.5 * under + width * length**3 / 12.0 / (total / 1000.0) - high
        lean = load_mass * (0.5 * length - 0.43 * 2.715) / (total * metacentric)
        return thick - under - 0.5 * length * lean

    assert left(250.0, 0.8) == pytest.approx(0.26, abs=0.01)
    assert left(400.0, 0.4) < -0.05
    assert left(900.0, 0.8) < 0.0


def test_a_crossing_on_a_block_too_dense_is_rejected_for_its_mass(tmp_path: Path) -> None:
    """Before it has gone under: docs/vehicles.md has the whole run."""
    plan = load(EXAMPLES / "plans" / "polaris_crossing.json")
    params = {"duration": 0.1, "spacing": 0.2, "block_density": 900.0}
    settings = Settings(device="cpu", pictures=False, params=params)
    verdict = Iteration.of(EXAMPLES / "floating_crossing.py", tmp_path, plan, settings).run()
    assert verdict.status == "rejected"
    (mass,) = (finding for finding in verdict.findings if finding.check == "CheckMass")
    assert mass.prim == "/World/block" and mass.value == pytest.approx(900.0 * 4.4 * 2.4 * 0.8) and not mass.passed
    assert mass.target.parameter == "density" and mass.target.suggested == pytest.approx(250.0)


def test_the_crossing_sets_out_over_water_that_stays(tmp_path: Path) -> None:
    """Coarse, its first moments: at 1 m/s² it is on by 0.125 m after 0.5 s; the block, at its own draft, stays."""
    settings = Settings(device="cpu", pictures=False, params={"duration": 0.5, "spacing": 0.2})
    verdict = Iteration.of(EXAMPLES / "floating_crossing.py", tmp_path, None, settings).run()
    assert verdict.status == "accepted", verdict.summary
    recording = read(tmp_path / "recording.rrd")
    buggy, block = recording.position("/World/buggy"), recording.position("/World/block")
    assert buggy[-1, 0] + 5.0 == pytest.approx(0.5 * 0.5**2, rel=0.1)
    assert np.abs(block - block[0]).max() < 0.02
    assert recording.fluids["/World/water"].position[:, :, 2].min() > 0.1


def test_stack_is_knocked_over_by_wsim_run(tmp_path: Path) -> None:
    program = EXAMPLES / "stack_and_ball.py"
    command = [sys.executable, "-m", "wsim.cli", "run", str(program), "--no-pictures", "--device", "cpu"]
    _, made = run(command, tmp_path)
    recording = read(made / "iterations" / "01" / "recording.rrd")
    boxes = [recording.position(f"/World/box_{i}") for i in range(5)]
    moved = [float(np.linalg.norm(box[-1] - box[0])) for box in boxes]
    assert sum(distance > 0.3 for distance in moved) >= 2, moved
    assert all(box[:, 2].min() > 0.09 for box in boxes)  # none sinks into the ground
    assert out_of_picture(recording) == set()
    assert (made / "accepted" / "program.py").read_text() == program.read_text()


def test_a_program_runs_by_itself(tmp_path: Path) -> None:
    text = (EXAMPLES / "double_pendulum.py").read_text()
    assert "duration=5.0" in text
    (tmp_path / "double_pendulum.py").write_text(text.replace("duration=5.0", "duration=0.2"))  # pictures take time
    out, made = run([sys.executable, "double_pendulum.py"], tmp_path)
    assert "accepted" in out
    assert f"report: {made.relative_to(tmp_path)}/report.html" in out
    iteration = made / "iterations" / "01"
    found = {path.name for path in iteration.iterdir()}
    assert found >= {"program.py", "stage.usda", "recording.rrd", "video.mp4", "frames", "review.json", "verdict.json"}
    assert json.loads((made / "run.json").read_text())["in_process"] is True


def test_a_bad_call_of_a_program_is_one_line(tmp_path: Path) -> None:
    """And is said before the simulator is loaded, which takes seconds."""
    (tmp_path / "bad.py").write_text(
        "import atexit, sys\natexit.register(lambda: print('newton' in sys.modules))\n\n"
        "def build(scene):\n"
        "    scene.box('b', size=(1, -1, 1), density=500.0)\n\n"
        "if __name__ == '__main__':\n"
        "    from wsim import run\n"
        "    run(build)\n"
    )
    ended = subprocess.run([sys.executable, "bad.py"], cwd=tmp_path, capture_output=True, text=True, timeout=STUCK)
    assert ended.returncode == 2
    assert ended.stdout == "False\n"
    assert ended.stderr.startswith('bad.py:5: box("b"): size[1] = -1 ')
    assert ended.stderr.count("\n") == 1
    (made,) = (tmp_path / "runs").iterdir()
    assert json.loads((made / "run.json").read_text())["status"] == "stopped"
    assert not (made / "accepted").exists()


def test_a_stage_that_the_check_refuses_is_one_line_too(tmp_path: Path) -> None:
    (tmp_path / "led.py").write_text(
        "def build(scene):\n"
        "    scene.box('k', size=(1, 1, 1), position=(0, 0, 1), kinematic=True, velocity=(1, 0, 0))\n"
        "    scene.box('b', size=(1, 1, 1), position=(3, 0, 1))\n"
        "    scene.joint_revolute('p', None, 'b', axis='Y')\n"
        "    scene.joint_fixed('f', 'k', 'b')\n\n"
        "if __name__ == '__main__':\n"
        "    from wsim import run\n"
        "    run(build)\n"
    )
    ended = subprocess.run([sys.executable, "led.py"], cwd=tmp_path, capture_output=True, text=True, timeout=STUCK)
    assert ended.returncode == 2
    assert ended.stderr.startswith("led.py: /World/f: joints hold the world and </World/k> together")
    assert ended.stderr.count("\n") == 1
