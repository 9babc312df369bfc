"""The benchmark of the judge: its split, its worlds, its tables, and that a planted fault is one."""

import dataclasses
import math
from collections import Counter
from functools import partial

import pytest

from benchmarks import judge_planted
from benchmarks.judge_worlds import FAULTS, WORLDS, in_program
from benchmarks.judge_worlds.fault import halves
from benchmarks.judge_worlds.in_recording import Teleport
from benchmarks.judge_worlds.tables import between_marks, interval, markdown, summary
from benchmarks.judge_worlds.tamper import Tamper, simulate
from benchmarks.judge_worlds.world import with_arguments
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation


def a_case(name: str) -> judge_planted.Case:
    return next(case for case in judge_planted.cases("all") if case.name == name)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setattr(judge_planted, "CACHE", tmp_path)
    return tmp_path


def test_there_are_enough_worlds_runs_kinds_and_faults():
    assert len(WORLDS) >= 25 and len({world.name for world in WORLDS}) == len(WORLDS)
    assert sum(len(world.plans) for world in WORLDS) >= 100
    assert len(FAULTS) >= 120 and len({fault.name for fault in FAULTS}) == len(FAULTS)
    assert len({fault.kind for fault in FAULTS}) >= 20
    assert {fault.made for fault in FAULTS} == {"program", "solver", "recording"}


def test_the_split_is_by_halves_of_every_kind_and_does_not_change():
    of = halves(FAULTS)
    assert set(of) == {fault.name for fault in FAULTS} and of == halves(list(reversed(FAULTS)))
    count = Counter(of.values())
    assert min(count.values()) > 0.4 * len(FAULTS)
    for kind in {fault.kind for fault in FAULTS}:
        here = Counter(of[fault.name] for fault in FAULTS if fault.kind == kind)
        assert abs(here["tuning"] - here["held-out"]) <= 1
    assert of != halves(FAULTS, seed=1)
    fewer = [fault for fault in FAULTS if fault.kind != "jitter"]
    assert halves(fewer) == {fault.name: of[fault.name] for fault in fewer}


def test_the_tuning_half_is_what_runs_by_default(monkeypatch):
    names = {}
    for half in ("tuning", "held-out", "all"):
        names[half] = {case.name for case in judge_planted.cases(half) if case.fault}
    assert names["tuning"] | names["held-out"] == names["all"] and not names["tuning"] & names["held-out"]
    asked = []
    monkeypatch.setattr(judge_planted, "outcomes", lambda wanted, *rest: asked.extend(wanted) or [])
    judge_planted.main([])
    assert {case.name for case in asked if case.fault} == names["tuning"]


@pytest.mark.parametrize("world", WORLDS, ids=lambda world: world.name)
def test_every_world_has_objectives_and_a_program(world):
    plan = world.plans[0]()
    assert plan.objectives
    program = world.write(plan)
    compile(program, "program.py", "exec")
    assert "def build(" in program


def test_every_fault_of_a_program_changes_it():
    worlds = {world.name: world for world in WORLDS}
    for fault in FAULTS:
        case = judge_planted.Case(worlds[fault.world], fault.variant, fault)
        same = case.program == judge_planted.Case(case.world, case.variant).program
        assert same == (fault.made != "program"), fault.name
        compile(case.program, "program.py", "exec")


def test_a_sound_world_and_its_fault(cache):
    case = a_case("sound | rest 0")
    assert judge_planted.run(case).status == "accepted"
    fault = next(f for f in FAULTS if f.world == "rest" and isinstance(f.tamper, Teleport))
    made = judge_planted.run(judge_planted.Case(case.world, 0, fault))
    assert not made.error and made.difference == pytest.approx(0.05, abs=1e-4)
    assert made.kind == "teleport for one frame" and made.made == "recording"
    # Judged again, nothing is recorded again.
    before = {path: path.stat().st_mtime_ns for path in cache.rglob("recording.rrd")}
    assert judge_planted.run(case, rejudge=True).status == "accepted"
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("recording.rrd")} == before


def test_a_fault_that_changes_too_little_is_none(cache):
    fault = next(f for f in FAULTS if f.world == "rest" and isinstance(f.tamper, Teleport))
    small = dataclasses.replace(fault, tamper=Teleport("box", (0.0, 0.0, 0.001), 2.0))
    world = next(world for world in WORLDS if world.name == "rest")
    monster = judge_planted.Case(world, 0, small)
    made = judge_planted.run(monster)
    assert "no fault" in made.error
    rows = summary([made])
    assert rows["faults"] == 0 and rows["broken"] == 1


def test_what_is_not_recorded_is_not_judged(cache):
    made = judge_planted.run(a_case("sound | rest 1"), rejudge=True)
    assert "not recorded yet" in made.error and not made.status


def test_rates_and_their_confidence():
    low, high = interval(0, 60)
    assert low == 0.0 and high == pytest.approx(0.0602, abs=2e-4)  # n / (n + z^2) is certain of 60 good ones
    low, high = interval(5, 50)
    assert (low, high) == (pytest.approx(0.0435, abs=2e-4), pytest.approx(0.2136, abs=2e-4))
    assert interval(50, 50)[1] == pytest.approx(1.0) and math.isclose(interval(50, 50)[0], 1 - interval(0, 50)[1])


def test_tables_count_what_was_missed_and_what_was_wronged():
    make = judge_planted.Outcome
    found = [
        make("a", "w", "f", kind="k", made="solver", status="accepted"),
        make("b", "w", "f", kind="k", made="program", status="rejected", checks=["CheckMass"]),
        make("c", "w", "f", status="accepted"),
        make("d", "w", "f", status="rejected", checks=["CheckEnergy"]),
        make("e", "w", "f", kind="k", error="no fault"),
    ]
    counted = summary(found)
    assert (counted["faults"], counted["false_accepts"], counted["sound"], counted["false_rejects"]) == (2, 1, 2, 1)
    text = markdown(found)
    assert "| k | program, solver | 2 | 1 | 1 | CheckMass 1 |" in text
    assert "| f | 2 | 1 | 1 | CheckEnergy 1 |" in text
    assert "1 of 2 = 50.0 %" in text


def test_tables_go_between_the_marks_of_a_document():
    marks = "before\n<!-- faults:begin -->\n{}\n<!-- faults:end -->\nafter\n"
    assert between_marks(marks.format("old"), "new\n") == marks.format("new")
    assert between_marks(between_marks(marks, "x\n"), "new\n") == marks.format("new")
    with pytest.raises(ValueError, match="faults:begin"):
        between_marks("no marks", "new")


def test_programs_are_edited_by_call():
    program = 'def build(scene):\n    scene.box("a", size=(1, 1, 1))\n\nif __name__ == "__main__":\n    build(None)\n'
    assert "density=5.0" in with_arguments(program, "a", density="5.0")
    with pytest.raises(ValueError, match="'b'"):
        with_arguments(program, "b", density="5.0")
    with pytest.raises(ValueError, match="gravity"):
        in_program.replaced("gravity", "x")(program)
    longer = in_program.appended("scene.ground()")(program)
    compile(longer, "program.py", "exec")
    assert longer.index("scene.ground()") < longer.index("__main__")


@dataclasses.dataclass
class Counted(Tamper):
    """Counts its turns, and does nothing."""

    steps: int = 0
    frames: int = 0

    def stepped(self, simulation):
        self.steps += 1

    def frame(self, t, frame, world):
        self.frames += 1
        return frame


def test_a_tampering_has_a_turn_at_every_step_of_a_world_that_goes_a_frame_in_c(tmp_path):
    stage, tamper = falling(tmp_path), Counted()
    simulate(stage, tmp_path / "plain.rrd")
    simulate(stage, tmp_path / "counted.rrd", tamper)
    plain, counted = (read(tmp_path / name) for name in ("plain.rrd", "counted.rrd"))
    frames = len(plain.time)
    assert tamper.frames == frames
    assert tamper.steps == round(plain.time[-1] / plain.metadata["time_step"])
    assert counted.body_q == pytest.approx(plain.body_q, abs=1e-6)  # nothing else is changed


def test_a_tampering_that_has_no_turn_breaks_the_benchmark(tmp_path, monkeypatch):
    """As where a simulator goes on by what nobody has wrapped."""
    stage, advance = falling(tmp_path), Simulation.advance_frame
    monkeypatch.setattr(Simulation, "advance_frame", property(lambda self: partial(advance, self), lambda *_: None))
    with pytest.raises(RuntimeError, match=r"had 0 turns of .* at its stepped: it is no fault"):
        simulate(stage, tmp_path / "counted.rrd", Counted())


def falling(folder):
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=30.0)
    scene.sphere("ball", radius=0.1, density=600.0, position=(0.0, 0.0, 2.0))
    return scene.save(folder / "stage.usda")
