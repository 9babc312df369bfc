"""`run_program` with a program's own `control`: it pushes, it drives a joint, and it fails in every way."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from wsim.judge.verdict import Verdict
from wsim.program.sandbox import available
from wsim.recording import Recording, read
from wsim.runs.alone import run_in_folder
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

G = 9.81
BUILD = """\
from wsim.scene import Drive

MOTOR = Drive(stiffness=200.0, damping=10.0)

def build(scene):
    scene.simulation(duration=0.6, frame_rate=20.0)
    scene.box("held", size=(0.2, 0.2, 0.2), mass=2.0, position=(0.0, 0.0, 1.0))
    scene.box("falls", size=(0.2, 0.2, 0.2), mass=2.0, position=(1.0, 0.0, 9.0))
    arm = scene.box("arm", size=(0.5, 0.05, 0.05), mass=0.5, position=(3.25, 0.0, 1.0))
    scene.joint_revolute("hinge", None, arm, anchor=(3.0, 0.0, 1.0), axis="Z", drive=MOTOR)

def control(world, t):
"""
FIRST_LINE = BUILD.count("\n") + 1
SETTINGS = Settings(device="cpu", pictures=False)


@pytest.fixture
def run(tmp_path: Path):
    """Run a program with this body of `control`."""

    def one(body: str, settings: Settings = SETTINGS) -> tuple[Verdict, Path]:
        (tmp_path / "program.py").write_text(BUILD + body)
        folder = RunFolder.create(tmp_path / "runs", "control").iteration(1)
        return Iteration.of(tmp_path / "program.py", folder, None, settings).run(), folder

    return one


def recording_of(folder: Path) -> Recording:
    return read(folder / "recording.rrd")


def test_a_force_holds_a_body_up_and_a_drive_follows_its_target(run) -> None:
    verdict, folder = run(
        f'    world.apply_force("held", (0.0, 0.0, 2.0 * {G}))\n    world.joint("hinge").target = min(0.5, 2.5 * t)\n'
    )
    assert verdict.status == "accepted", verdict.summary
    recording = recording_of(folder)
    t = recording.time
    assert np.ptp(recording.position("/World/held"), axis=0).max() < 1e-3
    assert recording.position("/World/falls")[:, 2] == pytest.approx(9.0 - 0.5 * G * t**2, abs=0.02)
    bodies = [body.prim for body in recording.world.bodies]
    z, w = recording.body_q[:, bodies.index("/World/arm"), 5:7].T
    angle = 2.0 * np.arctan2(z, w)
    assert angle[-4:] == pytest.approx(0.5, rel=0.03)
    lag = 10.0 / 200.0  # [s], damping / stiffness: it follows a ramp this much late
    ramp = (t > 0.1) & (t < 0.19)
    assert angle[ramp] == pytest.approx(2.5 * (t[ramp] - lag), abs=0.06)


def test_control_is_given_the_state_of_now(run) -> None:
    """A spring and damper to x = 0.3 m, made of what `control` is told; wrong states would let it drift or ring."""
    verdict, folder = run(
        "    import numpy as np\n"
        "    body = world.body('held')\n"
        "    pull = 100.0 * (np.array((0.3, 0.0, 1.0)) - body.position) - 20.0 * body.velocity\n"
        f"    world.apply_force('held', 2.0 * (pull + np.array((0.0, 0.0, {G}))))\n"
    )
    assert verdict.status == "accepted", verdict.summary
    recording = recording_of(folder)
    x, t = recording.position("/World/held")[:, 0], recording.time
    assert x == pytest.approx(0.3 * (1.0 - (1.0 + 10.0 * t) * np.exp(-10.0 * t)), abs=0.01)  # critically damped


# body: (summary's kind, part of the message, whether the line is known)
FAILS = {
    "    if t > 0.1:\n        raise RuntimeError('enough')\n": ("exception", "RuntimeError: enough", 1),
    "    if t > 0.1:\n        import time\n        time.sleep(1e9)\n": ("timeout", "did not end within", None),
    "    if t > 0.1:\n        world.apply_force('held', (0, 0, float('nan')))\n": (
        "value",
        "body_force[0][0][2] = nan",
        None,
    ),
    "    world.joint('hinge').target = float('inf')\n": ("value", "joint_target[0][0] = inf", None),
    "    world.body('hold')\n": ("exception", "no body 'hold'; known: held", 0),
}


@pytest.mark.parametrize("body", FAILS)
def test_a_control_that_fails_is_a_finding(run, body: str) -> None:
    kind, message, line = FAILS[body]
    verdict, folder = run(body)
    assert verdict.status == "rejected"
    assert f"({kind})" in verdict.summary
    (finding,) = verdict.findings
    assert (finding.check, finding.passed) == ("control", False)
    assert message in finding.message
    assert finding.line == (None if line is None else f"program.py:{FIRST_LINE + line}")
    assert Verdict.model_validate_json((folder / "verdict.json").read_text()) == verdict
    assert message in json.loads((folder / "checks.json").read_text())["simulation"]["error"]
    if "t > 0.1" in body:  # what happened until then is kept, and says that it is not all
        recording = recording_of(folder)
        assert not recording.metadata["complete"]
        assert recording.time.tolist() == pytest.approx([0.0, 0.05, 0.1])
    assert not list(folder.glob("*.partial"))


@pytest.mark.parametrize("isolation", ["bubblewrap", "landlock"])
def test_a_control_reaches_nothing(run, tmp_path: Path, isolation: str) -> None:
    if problem := available()[isolation]:
        pytest.skip(f"{isolation}: {problem}")
    secret = tmp_path / "secret"
    secret.write_text("topsecret")
    verdict, _ = run(
        f"    open({str(secret)!r}, 'w').write('x')\n", Settings("cpu", isolation=isolation, pictures=False)
    )
    assert verdict.status == "rejected"
    assert "Error" in verdict.findings[0].message
    assert secret.read_text() == "topsecret"


def test_a_run_that_breaks_off_says_so_in_its_run_json(tmp_path: Path) -> None:
    run = RunFolder.create(tmp_path, "breaks")
    program = tmp_path / "program.py"
    program.write_text("def build(scene):\n    scene.box('b', size=(1, 1, 1), density=500.0)\n")

    def interrupt(stage: str, done: float, total: float) -> None:
        if stage == "compiling kernels":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_in_folder(run, program, None, SETTINGS, interrupt)
    assert (run.facts()["status"], run.facts()["summary"]) == ("stopped", "interrupted")
    assert {path.name for path in run.iteration(1).iterdir()} == {"program.py", "stage.usda", "checks.json"}


def test_parameters_and_seed_of_the_program_reach_the_recording(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "def build(scene):\n"
        "    scene.simulation(duration=0.1, frame_rate=20.0)\n"
        "    radius = scene.param('radius', 0.1)\n"
        "    scene.sphere('ball', radius=radius, density=1000.0, position=(0.0, 0.0, 5.0))\n"
    )
    folder = RunFolder.create(tmp_path, "parameters").iteration(1)
    settings = Settings(device="cpu", pictures=False, params={"radius": 0.2})
    assert Iteration.of(program, folder, None, settings).run().status == "accepted"
    recording = recording_of(folder)
    assert recording.metadata["params"] == {"radius": 0.2}
    (ball,) = recording.world.bodies
    assert ball.mass == pytest.approx(1000.0 * 4.0 / 3.0 * math.pi * 0.2**3, rel=1e-6)
