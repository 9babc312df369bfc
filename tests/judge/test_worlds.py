"""Many worlds judged from arrays: each as if it were alone."""

from __future__ import annotations

import gc
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from wsim import helpers
from wsim.judge import judge
from wsim.judge.books.balance import Balance
from wsim.judge.checks.contact import CheckSupport
from wsim.judge.checks.continuity import CheckContinuity
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.rest import CheckJitter
from wsim.judge.decide import judge_copies
from wsim.judge.evidence.alike import alike
from wsim.judge.evidence.contact import _overlaps
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.worlds import judge_worlds, verdicts_of, weigh
from wsim.plan.schema import Plan
from wsim.recording.trajectories import Trajectories
from wsim.scene import Part, Scene
from wsim.scene.world import Body, Shape, Static, World

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


@pytest.fixture
def waiting() -> Iterator[None]:
    helpers.start(2)
    yield
    helpers.end()


def test_helpers_come_to_the_same_without_a_fork(planted: Trajectories, waiting, monkeypatch) -> None:
    monkeypatch.setattr("wsim.judge.worlds.CHUNK", 3)
    here = [verdict.model_dump_json() for verdict in verdicts_of(planted, sweep_plan())]
    monkeypatch.setattr(os, "fork", lambda: pytest.fail("it forks"))
    for _ in range(2):
        assert [verdict.model_dump_json() for verdict in verdicts_of(planted, sweep_plan(), 2)] == here


def test_no_garbage_is_looked_for_among_all_worlds_while_they_are_judged(planted: Trajectories, monkeypatch) -> None:
    looked = []
    monkeypatch.setattr(
        "wsim.judge.worlds.judge_copies", lambda copies: [looked.append(gc.isenabled()) for _ in copies]
    )
    verdicts_of(planted)
    assert not any(looked)
    assert len(looked) == WORLDS
    assert gc.isenabled()


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


def test_a_crash_in_one_world_blocks_that_one_alone(worlds: Trajectories, monkeypatch) -> None:
    sound = CheckEnergy.evaluate

    def evaluate(self, evidence):
        return [1 / 0] if evidence.body_q[0, 0, 0] == worlds.body_q[3, 0, 0, 0] else sound(self, evidence)

    monkeypatch.setattr(CheckEnergy, "evaluate", evaluate)  # of the one world whose box begins there
    found = judge_worlds(worlds, sweep_plan(), processes=2)
    assert found.status == ["blocked" if k == 3 else "accepted" for k in range(WORLDS)]
    assert [len(crashes) for crashes in found.crashes] == [int(k == 3) for k in range(WORLDS)]
    assert found.crashes[3][0].message == "CheckEnergy could not be evaluated: ZeroDivisionError: division by zero"
    assert found.failures(3) == []


def test_what_copies_ask_alike_is_worked_out_once_for_all(planted: Trajectories, monkeypatch) -> None:
    """Their books, distances, courses and trembling."""
    sound = [k for k in range(WORLDS) if k != 2]  # the one whose numbers are no numbers is told of by itself
    copies = [Evidence(planted.recording(k), sweep_plan()) for k in sound]
    calls: Counter[str] = Counter()

    def counted(function):
        def called(*given, **named):
            calls[function.__qualname__] += 1
            return function(*given, **named)

        return called

    for owner, name in (
        (Balance, "every"), (CheckContinuity, "_asked"), (CheckSupport, "_asked"), (CheckJitter, "_tremble"),
    ):  # fmt: skip
        monkeypatch.setattr(owner, name, counted(getattr(owner, name)))
    verdicts = judge_copies(copies)
    assert calls == {
        "Balance.every": 1, "CheckContinuity._asked": 1, "CheckSupport._asked": 1, "CheckJitter._tremble": 1,
    }  # fmt: skip
    for k, verdict in zip(sound, verdicts, strict=True):
        alone = judge(planted.recording(k), sweep_plan())
        assert [(f.check, f.passed, f.message, f.line) for f in verdict.findings] == [
            (f.check, f.passed, f.message, f.line) for f in alone.findings
        ]
        assert [f.target for f in verdict.findings] == [f.target for f in alone.findings]


def test_copies_may_differ_in_how_they_start_and_in_their_masses(worlds: Trajectories) -> None:
    """A box that slides, thrown at another speed and of another mass in each copy, has its own forces in each."""
    frames, t = len(worlds.time), worlds.time[None, :, None]
    speed, mass = np.linspace(0.2, 0.9, WORLDS), np.linspace(2.0, 9.0, WORLDS)
    body_q, body_qd, force = (np.zeros((WORLDS, frames, 1, width)) for width in (7, 6, 3))
    stop = (speed / (0.5 * G))[:, None, None]
    moving = np.minimum(t, stop)
    body_q[..., 0] = speed[:, None, None] * moving - 0.25 * G * moving**2
    body_q[..., 2], body_q[..., 6] = 0.1, 1.0
    body_qd[..., 0] = np.maximum(speed[:, None, None] - 0.5 * G * t, 0.0)
    force[..., 2] = mass[:, None, None] * G
    force[..., 0] = np.where(t < stop, -0.5 * force[..., 2], 0.0)
    shape = Shape(prim="/World/box/geometry", kind="box", size=(0.2, 0.2, 0.2), friction=0.5)
    box = Body(
        prim="/World/box", mass=4.0, volume=0.008, inertia=tuple((np.eye(3) * 4.0 * 0.04 / 6.0).ravel().tolist()),
        position=(0.0, 0.0, 0.1), rotation=(0.0, 0.0, 0.0, 1.0), shapes=[shape],
    )  # fmt: skip
    floor = Shape(prim="/World/ground/geometry", kind="plane", size=(), friction=0.5)
    world = World(duration=0.6, frame_rate=50.0, bodies=[box], statics=[Static(prim="/World/ground", shapes=[floor])])
    force[3] *= 1.5  # one copy's forces are those of another mass
    body_q[5, 12:, 0, 0] += 0.05  # one jumps aside
    told = {"time_step": 1.0 / 800.0}
    copies = Trajectories(world, worlds.time, body_q, body_qd, force, mass=mass[:, None], metadata=told)
    # The last two are said to have a floor of ice: their motion is not one of that world.
    ice = floor.model_copy(update={"friction": 0.05})
    other = world.model_copy(update={"statics": [Static(prim="/World/ground", shapes=[ice])]})
    worlds_of = [copies.world_of(k) if k < 6 else other for k in range(WORLDS)]
    assert [alike(worlds_of[0], each) for each in worlds_of] == [k < 6 for k in range(WORLDS)]
    for given in (copies, replace(copies, worlds=worlds_of)):
        found = judge_worlds(given, None, 1)
        for k in range(WORLDS):
            alone = judge(given.recording(k))
            wrong = k in (3, 5) or (k >= 6 and given is not copies)
            assert found.status[k] == alone.status == ("rejected" if wrong else "accepted"), alone.summary
            assert sorted(found.failures(k)) == sorted({f.objective or f.check for f in alone.failures})


def sliding(edge: float, friction: float, ice: float, t: np.ndarray) -> tuple[World, np.ndarray, np.ndarray]:
    """A box of an edge thrown at 0.8 m/s that friction slows down, in a world that states another; place, velocity."""
    mass = 500.0 * edge**3
    body_q, body_qd = np.zeros((len(t), 1, 7)), np.zeros((len(t), 1, 6))
    moving = np.minimum(t, 0.8 / (friction * G))
    body_q[:, 0, 0], body_q[:, 0, 2], body_q[:, 0, 6] = 0.8 * moving - friction * G * moving**2 / 2, edge / 2, 1.0
    body_qd[:, 0, 0] = 0.8 - friction * G * moving
    box = Body(
        prim="/World/box", mass=mass, volume=edge**3,
        inertia=tuple((np.eye(3) * mass * edge**2 / 6.0).ravel().tolist()),
        position=(0.0, 0.0, edge / 2), rotation=(0.0, 0.0, 0.0, 1.0), velocity=(0.8, 0.0, 0.0),
        shapes=[Shape(prim="/World/box/geometry", kind="box", size=(edge,) * 3, friction=ice)],
    )  # fmt: skip
    floor = Static(prim="/World/ground", shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=())])
    return World(duration=0.6, frame_rate=50.0, bodies=[box], statics=[floor]), body_q, body_qd


def differing() -> Trajectories:
    """Boxes of six sizes and frictions; the third slides as on another floor, the fifth half its size in the ground."""
    t = np.arange(31) / 50.0
    edges, frictions = np.linspace(0.05, 0.6, 6), np.linspace(0.25, 0.5, 6)
    said = np.where(np.arange(6) == 2, 0.6, frictions)
    made = [sliding(*each, t) for each in zip(edges, frictions, said, strict=True)]
    worlds, body_q, body_qd = (list(part) for part in zip(*made, strict=True))
    body_q[4][:, 0, 2] = 0.0
    force = np.zeros((6, 31, 1, 3))
    force[..., 2] = G * 500.0 * edges[:, None, None] ** 3
    return Trajectories(
        worlds[0], t, np.array(body_q), np.array(body_qd), force, metadata={"time_step": 1 / 800}, worlds=worlds
    )


def test_worlds_of_other_sizes_and_frictions_are_worked_out_at_once(monkeypatch) -> None:
    """Their books are one call, and so are distances, courses and trembling; each has its own shapes and laws in it."""
    worlds, calls = differing(), Counter()

    def counted(function):
        def called(*given, **named):
            calls[function.__qualname__] += 1
            return function(*given, **named)

        return called

    named = (Balance, "every"), (CheckContinuity, "_asked"), (CheckSupport, "_asked"), (CheckJitter, "_tremble")
    for owner, name in named:
        monkeypatch.setattr(owner, name, counted(getattr(owner, name)))
    monkeypatch.setattr("wsim.judge.evidence.contact._overlaps", counted(_overlaps))
    verdicts = verdicts_of(worlds)
    assert calls == {**{f"{owner.__name__}.{name}": 1 for owner, name in named}, "_overlaps": 1}
    assert [verdict.status for verdict in verdicts] == ["rejected" if k in (2, 4) else "accepted" for k in range(6)]
    for k, verdict in enumerate(verdicts):
        alone = judge(worlds.recording(k))
        assert [(f.check, f.passed, f.message) for f in verdict.findings] == [
            (f.check, f.passed, f.message) for f in alone.findings
        ]
        values, own = ([f.value for f in each.findings if f.value is not None] for each in (verdict, alone))
        assert values == pytest.approx(own, abs=1e-12, nan_ok=True)


def test_bodies_of_several_shapes_and_slopes_are_each_worlds_own(tmp_path) -> None:
    """Hammers whose heads differ, and cylinders on ramps of other slopes and thicknesses, are judged as each alone."""
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    stages = []
    for k in range(3):
        scene, edge = Scene(), 0.1 + 0.03 * k
        scene.simulation(duration=0.4, frame_rate=30.0)
        scene.ground(friction=0.5)
        head, handle = Part("box", size=(edge,) * 3), Part("box", size=(0.4, 0.05, 0.05), position=(0.25, 0.0, 0.0))
        scene.compound("hammer", parts=[head, handle], position=(0.0, 0.0, 0.3 + edge))
        thick = 0.1 + 0.01 * k
        scene.box("ramp", size=(1, 1, thick), position=(-2, 0, 0.3), rotation_deg=(0, 15 + k, 0), static=True)
        scene.cylinder("log", radius=edge / 2, height=0.2, position=(-2.0, 0.0, 0.6), density=400.0)
        stages.append(scene.save(tmp_path / f"stage_{k}.usda"))
    worlds = collect(Simulation(stages, device="cpu"))
    body_q = worlds.body_q.copy()
    body_q[1, :, 0, 2] += 0.03  # a hammer that hangs over where it falls
    verdicts = verdicts_of(replace(worlds, body_q=body_q))
    assert [verdict.status for verdict in verdicts] == ["accepted", "rejected", "accepted"]
    for k, verdict in enumerate(verdicts):
        alone = judge(replace(worlds, body_q=body_q).recording(k))
        assert [(f.check, f.passed, f.message) for f in verdict.findings] == [
            (f.check, f.passed, f.message) for f in alone.findings
        ]


def test_what_cannot_be_worked_out_at_once_is_told(monkeypatch) -> None:
    """The verdicts are those of each world by itself, and somebody learns of it."""
    worlds, every = differing(), Balance.every

    def one_alone(self):
        if len(self._copies) > 1:
            raise ZeroDivisionError("planted")
        return every(self)

    sound = [verdict.summary for verdict in verdicts_of(worlds)]
    monkeypatch.setattr(Balance, "every", one_alone)
    with pytest.warns(RuntimeWarning, match="books of 6 worlds cannot .* by itself: ZeroDivisionError: planted"):
        assert [verdict.summary for verdict in verdicts_of(worlds)] == sound


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
