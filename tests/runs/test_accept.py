"""Acceptance: what only served the review goes, and the bare program must go the same way."""

from __future__ import annotations

import ast
import hashlib
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.crashing import crashing
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.verdict import Verdict
from wsim.program.bare import bare
from wsim.runs.accept import accept
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.runs.trajectory import Trajectory

HEAD = "from wsim.scene import Scene\n\n\n"
SETTINGS = Settings(device="cpu", pictures=False)


def program(body: str) -> str:
    return f"{HEAD}def build(scene: Scene) -> None:\n" + "".join(f"    {line}\n" for line in body.splitlines())


# --- what goes

STAYS = [
    'scene.camera("side", eye=(0, -4, 1), target=(0, 0, 1))',
    'scene.camera("side_review_", eye=(0, -4, 1), target=(0, 0, 1))',
    'review_density = scene.param("review_density", 600.0)',
    'scene.box("review_box", size=(1, 1, 1))',
    'far = scene.camera("review_far", eye=(0, -9, 1), target=(0, 0, 1))\nscene.box(far.prim.name, size=(1, 1, 1))',
    'text = "print(1)"\n# print(2)',
    "printed = [print]",
]


@pytest.mark.parametrize("body", STAYS)
def test_what_the_world_needs_stays(body: str) -> None:
    assert bare(program(body)) == program(body)


GOES = {
    'x = 1\nprint("x", x)': "x = 1",
    'print("x")  # here it is': "pass  # here it is",
    'scene.camera("review_far", eye=(0, -9, 1), target=(0, 0, 1))\nx = 1': "x = 1",
    'scene.camera(\n    "review_far",\n    eye=(0, -9, 1),\n    target=(0, 0, 1),\n)\nx = 1': "x = 1",
    'scene.camera(eye=(0, -9, 1), target=(0, 0, 1), name="review_far")\nx = 1': "x = 1",
    'far = scene.camera("review_far", eye=(0, -9, 1), target=(0, 0, 1))\nx = 1': "x = 1",
    'scene.light("review_lamp")\nx = 1': "x = 1",
    # a block that would be empty
    'if True:\n    print("a")': "if True:\n    pass",
    'if True:\n    print("a")\n    print("b")\nx = 1': "if True:\n    pass\n    pass\nx = 1",
    "for k in range(3):\n    print(k)\nelse:\n    print(4)": "for k in range(3):\n    pass\nelse:\n    pass",
    "try:\n    x = 1\nexcept ValueError:\n    print(1)\nfinally:\n    print(2)": (
        "try:\n    x = 1\nexcept ValueError:\n    pass\nfinally:\n    pass"
    ),
    "match 1:\n    case 1:\n        print(1)\n    case _:\n        x = 1\n        print(2)": (
        "match 1:\n    case 1:\n        pass\n    case _:\n        x = 1"
    ),
    # nested, and in an order in which lines move
    "for k in a:\n    x = k\n    print(k)\n    for j in b:\n        y = j\n        print(j)\nprint(9)\nz = 1": (
        "for k in a:\n    x = k\n    for j in b:\n        y = j\nz = 1"
    ),
    "print(1)\nif True:\n    x = 1\n    print(2)\nprint(3)\ny = 2\nprint(4)": "if True:\n    x = 1\ny = 2",
    # beside something else on its line
    "x = 1; print(x)": "x = 1; pass",
    "print(1); x = 1; print(2)": "pass; x = 1; pass",
    "if True: print(1)": "if True: pass",
    'title = "né…"; print(title)': 'title = "né…"; pass',
}


@pytest.mark.parametrize("body", GOES)
def test_what_served_the_review_goes(body: str) -> None:
    made = bare(program(body))
    ast.parse(made)
    assert made == program(GOES[body])
    assert bare(made) == made


def test_the_text_keeps_its_form() -> None:
    text = program("x = 1  # a comment\n\nprint(x)\n\ny = 'a\\\nb'").replace("\n", "\r\n").removesuffix("\r\n")
    made = bare(text)
    assert made == text.replace("    print(x)\r\n", "")


# --- how far two runs are apart


def trajectory(body_q: np.ndarray, **particles: np.ndarray) -> Trajectory:
    return Trajectory(np.arange(len(body_q)) / 10.0, body_q, particles)


def test_the_largest_distance_counts() -> None:
    still = np.zeros((3, 2, 7))
    still[..., 6] = 1.0
    moved, turned = still.copy(), still.copy()
    moved[1, 1, :3] = (0.0, 3.0, 4.0)
    turned[2, 0, 3:] = (np.sin(0.005), 0.0, 0.0, np.cos(0.005))
    water = np.zeros((5, 3))
    assert trajectory(still).distance(trajectory(still)) == 0.0
    assert trajectory(still).distance(trajectory(moved)) == 5.0
    assert trajectory(still).distance(trajectory(turned)) == pytest.approx(0.01, rel=1e-4)  # [m] at 1 m: 0.01 rad
    assert trajectory(still, w=water).distance(trajectory(still, w=water + np.array((0.0, 0.0, 2.0)))) == 2.0
    assert trajectory(still[:, :0], w=water).distance(trajectory(still[:, :0], w=water)) == 0.0


def test_what_cannot_be_compared_is_infinitely_far() -> None:
    still, water = np.zeros((3, 2, 7)), np.zeros((5, 3))
    assert trajectory(still).distance(trajectory(still[:2])) == np.inf
    assert trajectory(still).distance(trajectory(still[:, :1])) == np.inf
    assert trajectory(still, w=water).distance(trajectory(still)) == np.inf
    assert trajectory(still).distance(trajectory(still, w=water)) == np.inf
    assert trajectory(still, w=water).distance(trajectory(still, w=water[:4])) == np.inf
    assert np.isnan(trajectory(still, w=water).distance(trajectory(still, w=water * np.nan)))


# --- whole acceptances

BALL = """\
print("a ball")
scene.simulation(duration=0.2, frame_rate=10.0)
scene.sphere("ball", radius=0.1, density=600.0, position=(0.0, 0.0, 2.0){more})
scene.camera("review_side", eye=(0.0, -4.0, 1.0), target=(0.0, 0.0, 1.0))
"""


def accepted(folder: Path, text: str) -> SimpleNamespace:
    """A run whose first iteration was accepted."""
    run = RunFolder(folder / "run")
    iteration = run.iteration(1)
    (iteration / "program.py").write_text(text)
    verdict = Iteration.of(iteration / "program.py", iteration, None, SETTINGS).run()
    assert verdict.status == "accepted", verdict.summary
    return SimpleNamespace(run=run, iteration=iteration)


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    return accepted(tmp_path_factory.mktemp("ball"), program(BALL.format(more="")))


def stamped(run: RunFolder) -> dict[str, object]:
    folder = run.path / "accepted"
    assert {path.name for path in folder.iterdir()} == {"program.py", "stage.usda", "acceptance.json", "SHA256SUMS"}
    sums = dict(reversed(line.split("  ")) for line in (folder / "SHA256SUMS").read_text().splitlines())  # type: ignore[misc]
    assert sums == {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in ("program.py", "stage.usda")
    }
    assert not (run.path / "accepted.partial").exists()
    return json.loads((folder / "acceptance.json").read_text())


def test_the_bare_program_goes_the_same_way_and_is_stamped(ball: SimpleNamespace) -> None:
    verdict = accept(ball.run, Iteration(ball.iteration, None, SETTINGS))
    assert verdict.status == "accepted"
    assert stamped(ball.run) == {"stripped": True, "largest_distance_m": 0.0}
    text = (ball.run.path / "accepted" / "program.py").read_text()
    assert "print" not in text
    assert "review_" not in text + (ball.run.path / "accepted" / "stage.usda").read_text()
    assert "review_" in (ball.iteration / "stage.usda").read_text()


def test_a_bare_world_that_cannot_be_judged_in_full_is_blocked_and_not_stamped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ball = accepted(tmp_path, program(BALL.format(more="")))
    crashing(monkeypatch, CheckEnergy)
    verdict = accept(ball.run, Iteration(ball.iteration, None, SETTINGS))
    assert verdict.status == "blocked"
    assert verdict.failures == []
    assert [crash.check for crash in verdict.crashes] == ["CheckEnergy"]
    assert verdict.summary.startswith("The bare program: CheckEnergy could not be evaluated: ZeroDivisionError")
    assert not (ball.run.path / "accepted").exists()


def test_an_earlier_run_of_the_same_program_is_the_second_run(tmp_path: Path, ball: SimpleNamespace) -> None:
    run = RunFolder(tmp_path)
    iteration = run.iteration(1)
    for name in ("stage.usda", "recording.rrd", "verdict.json"):
        (iteration / name).write_bytes((ball.iteration / name).read_bytes())
    (iteration / "program.py").write_text(bare((ball.iteration / "program.py").read_text()))
    earlier = Trajectory.of(ball.iteration / "recording.rrd")
    told: list[str] = []
    verdict = accept(run, Iteration(iteration, None, SETTINGS, lambda stage, *_: told.append(stage)), earlier)
    assert verdict.status == "accepted"
    assert told == []  # nothing had to be run
    assert stamped(run) == {"stripped": False, "largest_distance_m": 0.0}

    moved = Trajectory(earlier.time, earlier.body_q + 1e-9, earlier.particles)
    refused = accept(run, Iteration(iteration, None, SETTINGS), earlier=moved)
    (finding,) = refused.failures
    assert (refused.status, finding.check, finding.limit) == ("rejected", "CheckReproduced", 0.0)
    assert 1e-10 < finding.value < 1e-8
    assert (run.path / "accepted" / "SHA256SUMS").is_file()  # the last that was accepted stays


# Of a million values, so far apart that a float32 pose tells any two of them from each other.
RANDOM = "time.time_ns() % 1_000_003 * 1e-7"


@pytest.mark.parametrize(
    "more",
    [
        f", velocity=({RANDOM}, 0.0, 0.0)",
        ", velocity=(__import__('random').random(), 0.0, 0.0)",
        # It turns about its own centre, which stays where it is.
        f", angular_velocity_deg=(60.0 + 100.0 * ({RANDOM}), 0.0, 0.0)",
    ],
)
def test_a_program_that_is_another_each_time_is_rejected(tmp_path: Path, more: str) -> None:
    text = program("import time\n" + BALL.format(more=more))
    made = accepted(tmp_path, text)
    verdict = accept(made.run, Iteration(made.iteration, None, SETTINGS))
    assert verdict.status == "rejected"
    (finding,) = verdict.failures
    assert finding.check == "CheckReproduced"
    assert finding.value is not None
    assert finding.value > 0.0
    assert finding.target is not None
    assert finding.target.kind == "program"
    assert [path.name for path in made.run.path.iterdir()] == ["iterations"]


def test_a_bare_program_that_makes_no_world_is_rejected(tmp_path: Path, ball: SimpleNamespace) -> None:
    """What is printed was needed."""
    run = RunFolder(tmp_path)
    iteration = run.iteration(1)
    for name in ("stage.usda", "recording.rrd", "verdict.json"):
        (iteration / name).write_bytes((ball.iteration / name).read_bytes())
    (iteration / "program.py").write_text(program("print(x := 1)\n" + BALL.format(more=", velocity=(x, 0, 0)")))
    verdict = accept(run, Iteration(iteration, None, SETTINGS))
    assert verdict.status == "rejected"
    assert [finding.check for finding in verdict.failures] == ["build"]
    assert [path.name for path in run.path.iterdir()] == ["iterations"]


def test_what_is_interrupted_leaves_nothing_half_written(tmp_path: Path, ball: SimpleNamespace) -> None:
    run = RunFolder(tmp_path)
    before = Verdict.model_validate_json((ball.iteration / "verdict.json").read_text())

    def interrupt(stage: str, done: float, total: float) -> None:
        if stage.startswith("simulating"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        accept(run, Iteration(ball.iteration, None, SETTINGS, interrupt))
    assert list(run.path.iterdir()) == []
    assert Verdict.model_validate_json((ball.iteration / "verdict.json").read_text()) == before
