"""The benchmark of generated faults: its draws, its families, that a fault is what it says, its curves, a small run."""

import dataclasses
import json
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from benchmarks import judge_faults
from benchmarks.judge_families import record, stepping
from benchmarks.judge_families.curves import BEGIN, END, curves, draw, put, tables
from benchmarks.judge_families.drawn import Draw, Sound
from benchmarks.judge_families.family import movers
from benchmarks.judge_families.pushed import Steady
from benchmarks.judge_families.register import FAMILIES, MECHANISMS
from benchmarks.judge_families.trial import Outcome, halves, run, trials
from wsim.importers.trajectory import velocities


@pytest.fixture(scope="module", autouse=True)
def cache():
    """Recordings of these tests alone, made once."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(record, "CACHE", Path(folder))
        yield


def a_world(mechanism, k=0):
    return Sound(MECHANISMS[mechanism], k)


def test_there_are_enough_families_and_each_has_worlds():
    assert len(FAMILIES) >= 25 and len(MECHANISMS) >= 20
    for family in FAMILIES.values():
        assert list(family.sizes) == sorted(family.sizes) and family.limit > 0
        assert any(family.suits(mechanism) for mechanism in MECHANISMS.values()), family.name
    count = Counter(halves(list(FAMILIES)).values())
    assert min(count.values()) > 0.3 * len(FAMILIES)
    names = [trial.name for trial in trials("all", 2, 2)]
    assert len(names) == len(set(names))


def test_the_tuning_half_and_the_held_out_half_share_no_family():
    of = {half: {trial.family for trial in trials(half, 1, 0)} for half in ("tuning", "held-out", "all")}
    assert of["tuning"] | of["held-out"] == of["all"] and not of["tuning"] & of["held-out"]


def test_a_world_is_the_same_each_time_and_another_for_another_number():
    assert record._text(a_world("throw").stage) == record._text(a_world("throw").stage)
    assert record._text(a_world("throw").stage) != record._text(a_world("throw", 1).stage)


def test_worlds_are_of_all_sizes_and_gravities():
    worlds = [record.world_of(a_world("throw", k).stage) for k in range(12)]
    sizes = [max(world.bodies[0].shapes[0].size) for world in worlds]
    pulls = [-world.gravity[2] for world in worlds]
    assert min(sizes) < 0.1 and max(sizes) > 2.0 and min(pulls) < 5.0 < 15.0 < max(pulls)


def test_a_ghost_force_gives_the_momentum_of_its_impulse():
    sound = a_world("spinner")
    mass = record.world_of(sound.stage).bodies[0].mass
    track = record.simulated(sound.stage, Steady(0, 2.0 * mass, (0.6, 0.0, 0.8), 0.1, 0.3))
    assert track.qd[-1, 0, :3] == pytest.approx(2.0 * 0.2 * np.array([0.6, 0.0, 0.8]), abs=2.0 * 2e-3)


def test_the_short_cut_is_the_simulator(tmp_path):
    from wsim.sim import Simulation

    stage = tmp_path / "stage.usda"
    stage.write_text(a_world("skid").stage)
    short, whole = (Simulation(stage, device="cpu") for _ in range(2))
    advance = stepping.Stepper(short)
    assert advance.direct
    for _ in range(5):
        advance.frame()
        whole.advance_frame()
    assert np.array_equal(short.state.body_q.numpy(), whole.state.body_q.numpy())
    assert np.array_equal(short.state.body_qd.numpy(), whole.state.body_qd.numpy())


@pytest.mark.parametrize("name", ["shifted", "spin", "time stretch", "creeping", "joint apart", "tipped"])
def test_velocities_go_with_the_poses_that_a_hand_changed(name):
    family = FAMILIES[name]
    mechanism = next(each for each in ("throw", "spinner", "lying", "pendulum", "slide") if
                     family.suits(MECHANISMS[each]))  # fmt: skip
    faulty = family.make(a_world(mechanism), family.sizes[2], Draw(name))
    track, world = faulty.track, faulty.world
    found = velocities(track.time, track.q.astype(float), world)[2:-2]
    error = np.abs(found - track.qd[2:-2])[:, movers(world)]
    sound = record.simulated(a_world(mechanism).stage)
    usual = np.abs(velocities(sound.time, sound.q.astype(float), world) - sound.qd)[2:-2].max()
    scale = max(np.abs(track.qd).max(), 1e-3)
    assert error.max() < max(3.0 * usual, 0.1 * scale)


def test_a_small_run(tmp_path, capsys):
    """A sound world is accepted, gravity at less than six tenths is not."""
    file, document = tmp_path / "found.json", tmp_path / "judge.md"
    document.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    asked = ["sound | throw 0 ", "gravity | 0.8 | 0", "unplanned kinematic | 1 | 0"]
    code = judge_faults.main(["--half", "all", "--only", *asked, "--json", str(file), "--docs", str(document)])
    made = json.loads(file.read_text())
    status = {trial["name"]: trial["status"] for trial in made["trials"]}
    assert code == 0 and len(status) == 4
    assert {found for name, found in status.items() if name.startswith("sound")} == {"accepted"}
    assert status["gravity | 0.8 | 0"] == "rejected"
    assert {curve["family"] for curve in made["curves"]} == {"gravity", "unplanned kinematic"}
    assert "| gravity | of the quantity | 0.8: 1/1 | 0.8 | 0.1 | 0 of 1 |" in document.read_text()
    assert "0 trials broke" in capsys.readouterr().out


def outcome(k, size, status, family="gravity"):
    return Outcome(f"{family} | {size} | {k}", family, size, half="tuning", status=status, checks=["CheckForces"])


def test_the_least_size_that_is_found_and_what_was_missed(tmp_path):
    status = {0.03: 9, 0.1: 5, 0.2: 1, 0.4: 0, 0.8: 0}  # accepted, of ten
    made = [outcome(k, size, "accepted" if k < n else "rejected") for size, n in status.items() for k in range(10)]
    made += [outcome(10, 0.8, "no effect"), dataclasses.replace(outcome(11, 0.8, ""), error="broke")]
    (curve,) = curves(made)
    assert curve.least == 0.2 and curve.missed == (6, 40)
    assert curve.points[0].bounds == (pytest.approx(0.0179, abs=1e-4), pytest.approx(0.4042, abs=1e-4))  # 1 of 10
    assert "6 of 40 = 15.0 %" in tables(made)
    (never,) = curves([outcome(0, 0.8, "accepted")])
    assert never.least is None
    assert draw(made, tmp_path / "curves.png").stat().st_size > 1000
    with pytest.raises(ValueError, match="curves:begin"):
        put("no marks", "new")


def test_what_slides_on_without_a_push_is_no_blow():
    """A driven block leaves the ground's push for a step, at no speed: there was a division by zero in the judge."""
    (trial,) = trials("all", 3, 1, ["unplanned drive | 0.1 | 2"])
    made = run(trial)
    assert not made.error
    assert made.status == "rejected"
