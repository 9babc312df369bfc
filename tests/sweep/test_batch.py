"""Candidates that are simulated together come out as they do one by one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from wsim import helpers
from wsim.plan.schema import Plan
from wsim.scene import Scene
from wsim.sweep import Axis, Spec, SweepFolder, sweep
from wsim.sweep import batch as batched
from wsim.sweep import work as working
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.pool import each
from wsim.sweep.work import Shard

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.5)
    scene.ground(friction=0.5)
    edge = scene.param("edge", 0.2, low=0.05, high=0.5)
    if edge > 0.45:
        raise ValueError("too large")
    scene.box("box", size=(edge, edge, edge), position=(0, 0, edge / 2), velocity=(1, 0, 0), density=500.0,
              friction=scene.param("friction", 0.3, low=0.0, high=1.0))
    if scene.param("ball", 0.0, low=0.0, high=1.0) > 0.5:
        scene.sphere("ball", radius=0.1, position=(3, 0, 1), density=500.0)
"""


def work(shard: Shard) -> list[Outcome]:
    """All outcomes of a shard, as its candidates stand in it."""
    found = [pair for some in working.work(shard) for pair in some]
    assert sorted(place for place, _ in found) == list(range(len(shard.candidates)))
    return [outcome for _, outcome in sorted(found, key=lambda pair: pair[0])]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "program.py").write_text(PROGRAM)
    return tmp_path


def test_together_is_as_one_by_one(folder: Path) -> None:
    points = [{}, {"edge": 0.1}, {"ball": 1.0}, {"friction": 0.1}, {"edge": 0.5}, {"ball": 1.0, "edge": 0.3}]
    candidates = tuple(Candidate(number=k, params=point) for k, point in enumerate(points))
    one_by_one = work(Shard(candidates, folder, Spec()))
    together = work(Shard(candidates, folder, Spec(worlds=4)))
    assert [outcome.status for outcome in together] == ["accepted"] * 4 + ["rejected", "accepted"]
    assert [outcome.status for outcome in together] == [outcome.status for outcome in one_by_one]
    assert [outcome.candidate for outcome in together] == list(candidates)
    assert together[4].reason == one_by_one[4].reason
    assert [outcome.together for outcome in together] == [3, 3, 2, 3, 1, 2]
    assert not any(outcome.note for outcome in together)


HUNG = """
def build(scene):
    scene.simulation(duration=0.1)
    scene.box("arm", size=(0.5, 0.1, 0.1), density=500.0, position=(0.25, 0, 2))
    scene.joint_revolute("hinge", None, "arm", anchor=(0, 0, scene.param("height", 2.0, low=1.9, high=2.1)), axis="Y")
"""


def test_why_stages_are_read_one_by_one_is_noted(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(HUNG)
    candidates = tuple(Candidate(number=k, params={"height": 1.98 + 0.02 * k}) for k in range(2))
    found = work(Shard(candidates, tmp_path, Spec(worlds=4)))
    assert [outcome.together for outcome in found] == [2, 2]
    for outcome in found:
        assert "one by one" in outcome.note
        assert "no description states" in outcome.note


WET = """
def build(scene):
    scene.simulation(duration=0.4)
    level = scene.param("level", 0.12, low=0.05, high=0.3)
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.4), position=(0, 0, 0))
    scene.fluid("water", fills=tank, level=level, spacing=0.03)
    density = scene.param("density", 500.0, low=100.0, high=3000.0)
    draught = 0.12 * min(density / 1000.0, 1.0)
    scene.box("block", size=(0.12, 0.12, 0.12), density=density, position=(0, 0, level + 0.06 - draught))
"""


def test_worlds_with_fluid_go_together(tmp_path: Path) -> None:
    """Other levels, other blocks: the verdicts are those that they have one by one."""
    (tmp_path / "program.py").write_text(WET)
    points = [{}, {"level": 0.09}, {"density": 300.0}, {"level": 0.15, "density": 800.0}]
    candidates = tuple(Candidate(number=k, params=point) for k, point in enumerate(points))
    together = work(Shard(candidates, tmp_path, Spec(worlds=8)))
    assert [outcome.together for outcome in together] == [4] * 4
    assert not any(outcome.note for outcome in together)
    one_by_one = work(Shard(candidates, tmp_path, Spec()))
    assert [outcome.status for outcome in together] == [outcome.status for outcome in one_by_one]


HELD = """
import numpy as np

total = 0.0

def build(scene):
    scene.simulation(duration=0.5)
    mass = scene.param("mass", 2.0, low=0.5, high=8.0)
    scene.box("kite", size=(0.2, 0.2, 0.2), mass=mass, position=(0, 0, 1))

def control(world, t):
    "A spring, a damper and an integral that is the program's own."
    global total
    kite = world.body("kite")
    off = 1.0 - float(kite.position[0, 2])
    total += 0.01 * off
    world.apply_force("kite", (0.0, 0.0, 80.0 * off - 5.0 * float(kite.velocity[0, 2]) + 40.0 * total))
    if t > 0.3 and world.body("kite").position[0, 2] < LEAST:
        raise ValueError("too low")
"""


def test_worlds_under_control_go_together(tmp_path: Path) -> None:
    """Each as if it were the only one that the program knows."""
    (tmp_path / "program.py").write_text(HELD.replace("LEAST", "0.0"))
    candidates = tuple(Candidate(number=k, params={"mass": 0.5 + k}) for k in range(4))
    together = work(Shard(candidates, tmp_path, Spec(worlds=8)))
    assert [outcome.together for outcome in together] == [4] * 4
    assert [outcome.status for outcome in together] == ["accepted"] * 4
    assert [outcome.status for outcome in work(Shard(candidates, tmp_path, Spec()))] == ["accepted"] * 4


def test_control_that_fails_in_one_world_fails_that_one(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(HELD.replace("LEAST", "0.6"))
    candidates = tuple(Candidate(number=k, params={"mass": mass}) for k, mass in enumerate((0.5, 1.0, 8.0)))
    found = work(Shard(candidates, tmp_path, Spec(worlds=8)))
    assert [outcome.status for outcome in found] == ["accepted", "accepted", "rejected"]
    assert "too low" in found[2].reason
    assert "run by itself, as 3 worlds could not be at once" in found[0].note


def test_who_draws_nothing_is_not_shared_out(monkeypatch: pytest.MonkeyPatch) -> None:
    shared: list[str] = []

    def put(call: Any, items: Any, processes: int) -> list[str]:
        shared.extend(each[0].program for each in items)
        return ["it cannot be"] * len(items)

    monkeypatch.setattr(working, "shared_out", put)
    plain, drawn = Candidate(number=0), Candidate(number=1, draws={"ball.mass": 2.0}, program="drawn.py")
    built = SimpleNamespace(seconds=0.5)
    ((number, failed),) = working._set_draws([(plain, None, built), (drawn, None, built)], 2)  # type: ignore[list-item]
    assert (number, failed.reason, shared) == (1, "it cannot be", ["drawn.py"])


def test_no_more_fluid_to_a_batch_than_memory_holds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "program.py").write_text(WET)
    candidates = tuple(Candidate(number=k, params={"density": 200.0 + 50.0 * k}) for k in range(3))
    need = 0.3 * 0.3 * 0.12 / 0.03**3 * (0.4 * 30 + 1) * 28  # [bytes] of a world
    monkeypatch.setattr(batched, "free_memory", lambda: 4.5 * need)
    assert [outcome.together for outcome in work(Shard(candidates, tmp_path, Spec(worlds=8)))] == [2, 2, 1]


def test_cores_change_nothing_but_the_time(folder: Path) -> None:
    points = [{}, {"edge": 0.1}, {"friction": 0.1}, {"edge": 0.5}, {"edge": 0.3, "friction": 0.7}]
    candidates = tuple(Candidate(number=k, params=point, seed=k % 2) for k, point in enumerate(points))
    shards = [Shard(candidates, folder, Spec(worlds=8), cores) for cores in (1, 3)]
    found = {shard.cores: told for shard, told in each(work, shards, 1, 600.0)}
    one, several = ([each.model_copy(update={"seconds": 0.0}) for each in found[cores]] for cores in (1, 3))
    assert [outcome.status for outcome in one] == ["accepted"] * 3 + ["rejected", "accepted"]
    assert several == one


def test_what_finds_no_room_is_split_and_not_lost(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes, follow = [], batched.follow

    def tight(simulation: Any) -> Any:
        sizes.append(simulation.model.world_count)
        if sizes[-1] > 2:
            raise RuntimeError("Failed to allocate 123 bytes on device 'cuda:0'")
        return follow(simulation)

    monkeypatch.setattr(batched, "follow", tight)
    candidates = tuple(Candidate(number=k, params={"friction": 0.1 * k}) for k in range(3))
    found = work(Shard(candidates, folder, Spec(worlds=8)))
    assert [outcome.status for outcome in found] == ["accepted"] * 3
    assert sizes == [3, 1, 2]


def test_a_batch_that_cannot_be_run_as_one_says_so(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each has its verdict by itself, and why it took so long is beside it."""

    def broken(simulation: Any) -> Any:
        raise RuntimeError("planted")

    monkeypatch.setattr(batched, "follow", broken)
    candidates = tuple(Candidate(number=k, params={"friction": 0.1 * k}) for k in range(3))
    found = work(Shard(candidates, folder, Spec(worlds=8)))
    assert [(outcome.status, outcome.together) for outcome in found] == [("accepted", 1)] * 3
    assert {outcome.note for outcome in found} == {
        "run by itself, as 3 worlds could not be at once: RuntimeError: planted"
    }


def test_a_whole_sweep_of_batches(folder: Path) -> None:
    spec = Spec(axes=[Axis.parse("friction=0.05:0.9")], samples=3, worlds=3)
    made = SweepFolder.create(folder / "runs", "slides", spec, [folder / "program.py"])
    found = sweep(made, workers=1)
    assert sorted(outcome.candidate.number for outcome in found) == list(range(4))
    assert {outcome.status for outcome in found} == {"accepted"}


def test_a_stage_that_cannot_be_described_goes_alone(folder: Path) -> None:
    """There it is said why; it had taken all candidates of its shard with it."""
    stages = []
    for name in ("one", "other"):
        scene = Scene()
        scene.box("box", size=(0.2, 0.2, 0.2), mass=1.0)
        stages.append(scene.save(folder / f"{name}.usda"))
    made = [SimpleNamespace(stage=stage, program=folder / "program.py") for stage in (stages[0], folder, stages[1])]
    built: Any = [(Candidate(number=k), iteration, b"") for k, iteration in enumerate(made)]
    assert [[member.candidate.number for member in batch] for batch in batched.batches(built, 8)] == [[0, 2]]


def test_helpers_have_what_judges_contacts_before_they_are_forked() -> None:
    """Else each of them loads it anew: 0.2 s of CPU, in the first batch."""
    asked = "import sys, wsim.sweep.work; print('mujoco' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True).stdout == "True\n"


FARTHER = {
    "title": "slides", "prompt": "A box slides.",
    "objects": [
        {"name": "ground", "role": "terrain", "state": "static",
         "construction": {"kind": "proxy", "primitive": "ground"}},
        {"name": "box", "role": "rigid_body", "state": "dynamic", "material": {"name": "wood", "density": 500.0},
         "construction": {"kind": "proxy", "primitive": "box", "size": [0.2, 0.2, 0.2]}},
    ],
    "objectives": [{"kind": "formula", "object": "box", "formula": {
        "op": "reaches", "object": "box", "target": [0.3, 0.0, 0.1], "within": 0.06,
    }}],
    "simulation": {"duration": 0.5, "frame_rate": 60.0},
}  # fmt: skip


def test_outcomes_that_helpers_take_are_those_of_one_process(folder: Path) -> None:
    """The slippery one goes 0.38 m in its half second, the others v^2 / 2 g mu = 0.17 m."""
    points = [{"edge": 0.18}, {"friction": 0.1}, {"edge": 0.22}, {"edge": 0.21}]
    candidates = tuple(Candidate(number=k + 1, params=point) for k, point in enumerate(points))
    (folder / "plan.json").write_text(Plan.model_validate(FARTHER).model_dump_json())
    here = work(Shard(candidates, folder, Spec(worlds=4)))
    helpers.start(2)
    try:
        there = work(Shard(candidates, folder, Spec(worlds=4), cores=2))
    finally:
        helpers.end()
    assert [replaced(outcome, seconds=0.0) for outcome in there] == [replaced(outcome, seconds=0.0) for outcome in here]
    assert [outcome.status for outcome in here] == ["rejected", "accepted", "rejected", "rejected"]
    assert all(outcome.margins and outcome.together == 4 for outcome in here)


def replaced(outcome: Outcome, **fields: object) -> Outcome:
    return outcome.model_copy(update=fields)
