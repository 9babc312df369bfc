"""Many worlds judged from arrays: each as if it were alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wsim.judge import judge
from wsim.judge.worlds import judge_worlds, weigh
from wsim.plan.schema import Plan
from wsim.recording.trajectories import Trajectories
from wsim.scene import Scene

WORLDS, G = 8, 9.81
BALL = {"kind": "proxy", "primitive": "sphere", "size": [0.1]}
WOOD = (0.5, 0.3, 0.1)
GROUND = {"kind": "proxy", "primitive": "ground"}


def sweep_plan() -> Plan:
    box = {"role": "rigid_body", "construction": {"kind": "proxy", "primitive": "box", "size": [0.2, 0.2, 0.2]}}
    wood = {"material": {"name": "wood", "density": 500.0, "color": WOOD}}
    return Plan.model_validate(
        {
            "title": "box",
            "prompt": "A box rests on the ground beside a ball that falls.",
            "objects": [
                {"name": "ground", "role": "terrain", "state": "static", "construction": GROUND},
                {"name": "box", "state": "dynamic", **box, **wood},
                {"name": "ball", "state": "dynamic", **box, **wood, "construction": BALL},
            ],
            "objectives": [{"kind": "rests_on", "object": "box", "ref": "ground"}],
            "simulation": {"duration": 0.6, "frame_rate": 50.0},
        }
    )  # fmt: skip


@pytest.fixture(scope="module")
def worlds(tmp_path_factory: pytest.TempPathFactory) -> Trajectories:
    """Eight copies side by side on MuJoCo Warp, each set up by another hand."""
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    scene = Scene()
    scene.simulation(duration=0.6, frame_rate=50.0)
    scene.ground()
    scene.box("box", size=(0.2, 0.2, 0.2), density=500.0, color=WOOD, position=(0.0, 0.0, 0.1))
    scene.sphere("ball", radius=0.1, density=500.0, color=WOOD, position=(1.0, 0.0, 3.0))
    stage = scene.save(tmp_path_factory.mktemp("sweep") / "stage.usda")
    return collect(Simulation(stage, device="cpu", world_count=WORLDS, seeds=range(WORLDS)))


@pytest.fixture(scope="module")
def planted(worlds: Trajectories) -> Trajectories:
    """The same, with a fault in five of them."""
    body_q, body_qd, mass = worlds.body_q.copy(), worlds.body_qd.copy(), np.array(worlds.mass)
    body_q[1, 10:, 0, 2] += 0.05  # hangs in the air
    body_q[2, 15, 1, 0] = np.nan
    body_qd[4, :, 1, 2] *= 20.0  # a ball that reports 20 times its speed
    mass[5, 0] *= 3.0  # carried with a third of its weight
    problems = [[] for _ in range(WORLDS)]
    problems[6] = ["contact buffers overflowed"]
    return replace(worlds, body_q=body_q, body_qd=body_qd, mass=mass, problems=problems)


def test_worlds_are_collected_as_they_fall(worlds: Trajectories) -> None:
    assert worlds.body_q.shape == (WORLDS, 31, 2, 7)
    assert worlds.time == pytest.approx(np.arange(31) / 50.0)
    ball, box = worlds.body_q[:, :, 1, 2], worlds.body_q[:, :, 0, 2]
    assert ball == pytest.approx(np.broadcast_to(3.0 - G * worlds.time**2 / 2, ball.shape), abs=0.01)
    assert np.ptp(ball[:, 0]) > 0.0  # no two begin alike
    assert box == pytest.approx(0.1, abs=1e-4)
    assert worlds.contact_force[:, -1, 0, 2] == pytest.approx(4.0 * G, rel=0.01)
    assert worlds.contact_force[:, 1:, 1] == pytest.approx(0.0)
    assert worlds.problems == [[]] * WORLDS


@pytest.mark.parametrize("processes", [1, 2])
def test_each_verdict_is_that_of_the_world_alone(planted: Trajectories, processes: int, monkeypatch) -> None:
    monkeypatch.setattr("wsim.judge.worlds.CHUNK", 3)  # so that two processes have something to share
    plan, told = sweep_plan(), []
    found = judge_worlds(planted, plan, processes, lambda stage, done, total: told.append((stage, done, total)))
    assert told == [("judging", done, WORLDS) for done in (3, 6, 8)]
    assert found.status == ["accepted" if k in (0, 3, 7) else "rejected" for k in range(WORLDS)]
    assert found.accepted.tolist() == [status == "accepted" for status in found.status]
    for k in range(WORLDS):
        alone = judge(planted.recording(k), plan)
        assert found.status[k] == alone.status
        assert len(found.failures(k)) == len(alone.failures)
        margins = sorted(f.margin for f in alone.findings if f.margin is not None)
        here = [margin[k] for margin in found.margin.values()]
        assert sorted(m for m in here if not np.isnan(m)) == pytest.approx(margins, nan_ok=True)


def test_a_formula_is_weighed_on_all_worlds_at_once(planted: Trajectories) -> None:
    from wsim.judge.language import Signals, evaluate, parse

    formula = parse("always (rests_on(box, ground))")
    all_at_once = weigh(planted, formula)
    assert all_at_once.satisfied.tolist()[:2] == [True, False]
    for k in range(WORLDS):
        alone = evaluate(formula, Signals.of_recording(planted.recording(k)))
        assert alone.satisfied[0] == all_at_once.satisfied[k]
        assert alone.margin[0] == pytest.approx(all_at_once.margin[k])


def test_arrays_that_do_not_fit_are_refused(worlds: Trajectories) -> None:
    with pytest.raises(ValueError, match=r"body_qd has shape \(8, 31, 2, 5\); it must be \(8, 31, 2, 6\)"):
        replace(worlds, body_qd=worlds.body_qd[..., :5])
    with pytest.raises(ValueError, match="one for each of 8 worlds"):
        replace(worlds, problems=[[]])


def test_a_world_with_fluid_is_not_collected(tmp_path: Path) -> None:
    from wsim.errors import UserError
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3))
    scene.fluid("water", fills=tank, level=0.12, spacing=0.06)
    with pytest.raises(UserError, match="/World/water"):
        collect(Simulation(scene.save(tmp_path / "stage.usda"), device="cpu"))
