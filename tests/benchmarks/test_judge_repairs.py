"""Suggestions applied by program: what they say is written, no more, and what they leave open is refused."""

import pytest

from benchmarks.judge_families import record
from benchmarks.judge_mends.trial import Outcome, mend
from benchmarks.judge_repairs import tables
from wsim.judge.verdict import RepairTarget
from wsim.program.compose import compose
from wsim.program.mend import NotMendedError, mended
from wsim.program.mend.unroll import unrolled
from wsim.rules.planner import plan as make_plan

PLAN = make_plan("A tower of three boxes stands on the ground for 0.5 seconds")
PROGRAM = unrolled(compose(PLAN))


def told(**target):
    return RepairTarget.model_validate({"kind": "physical parameter", "prim": "/World/box_2", **target})


@pytest.mark.parametrize(
    ("target", "written"),
    [
        ({"parameter": "density", "suggested": 700.0}, "density=700.0"),
        ({"parameter": "friction", "suggested": 0.4}, "friction=0.4"),
        ({"parameter": "position", "vector": (1.0, 2.0, 0.5)}, "position=(1.0, 2.0, 0.5)"),
        ({"parameter": "size", "vector": (0.1, 0.2, 0.3)}, "size=(0.1, 0.2, 0.3)"),
        ({"parameter": "velocity.z", "suggested": 3.0}, "velocity=(0.0, 0.0, 3.0)"),
        ({"parameter": "duration", "suggested": 4.5, "prim": None}, "duration=4.5"),
        ({"parameter": "gravity", "vector": (0.0, 0.0, -9.8), "prim": None}, "gravity=(0.0, 0.0, -9.8)"),
        ({"parameter": "target", "vector": (0.0, 0.0, 1.0), "prim": "/World/side"}, "target=(0.0, 0.0, 1.0)"),
    ],
)  # fmt: skip
def test_a_value_is_written_into_the_call_that_makes_the_prim(target, written):
    after = mended(PROGRAM, told(**target), PLAN)
    assert written in after
    changed = [line for line in after.splitlines() if line not in PROGRAM.splitlines()]
    assert len(changed) == 1 and written in changed[0]


@pytest.mark.parametrize(
    "target",
    [
        {"parameter": "density", "direction": "lower"},
        {"parameter": "drive.damping", "suggested": 3.0},
        {"parameter": "position", "vector": (0.0, 0.0, 1.0), "prim": "/World/nobody"},
        {"kind": "controller", "parameter": "control", "direction": "add", "prim": None},
        {"parameter": "velocity", "suggested": 3.0},
        {"parameter": "break_force", "direction": "remove"},
    ],
)
def test_what_says_too_little_or_names_nothing_is_not_mended(target):
    if target["parameter"] == "velocity":  # a speed without a direction, of what stands still
        target = {**target, "parameter": "velocity", "prim": "/World/box_2"}
        program = PROGRAM.replace("scene.box('box_2'", "scene.box('box_2', velocity=(0.0, 0.0, 0.0)")
        assert program != PROGRAM
    else:
        program = PROGRAM
    with pytest.raises(NotMendedError):
        mended(program, told(**target), PLAN)


def test_an_object_is_removed_and_put_back_as_the_plan_has_it():
    without = mended(PROGRAM, told(direction="remove"), PLAN)
    assert "box_2" not in without.partition("scene.ground")[2] and "'box_3'" in without
    again = mended(without, told(kind="missing object", direction="add"), PLAN)
    assert sorted(again.splitlines()) == sorted(PROGRAM.splitlines())


def test_a_drive_is_set_in_the_programs_units():
    program = (
        "from wsim.scene import Drive, Scene\n\ndef build(scene):\n    a = scene.box('a', size=(1, 1, 1))\n"
        "    scene.joint_revolute('hub', None, a, drive=Drive(position=10.0, stiffness=5.0))\n"
    )
    target = RepairTarget(
        kind="drive", prim="/World/hub", parameter="drive.position", suggested=3.141592653589793, unit="rad"
    )
    assert "Drive(position=180.0, stiffness=5.0)" in mended(program, target, PLAN)


def test_a_wrong_program_is_mended_by_its_first_suggestion(tmp_path, monkeypatch):
    monkeypatch.setattr(record, "CACHE", tmp_path)
    camera = PLAN.cameras[0]
    away = RepairTarget(kind="camera", prim=f"/World/{camera.name}", parameter="target", vector=(0.0, -50.0, 20.0))
    made = Outcome("camera_away", "tuning", 0)
    fixed = PROGRAM.replace(f'scene.camera("{camera.name}",', f'scene.camera("{camera.name}", fixed=True,')
    mend(made, mended(fixed, away, PLAN), PLAN, PLAN)
    assert (made.found, made.rounds, made.error, made.left) == ("CheckInFrame", 1, "", []), made


def test_the_table_counts_what_was_mended():
    made = [
        Outcome("a", "tuning", k, world="w", found="CheckMass", rounds=rounds) for k, rounds in enumerate((1, 2, 0))
    ]
    made.append(Outcome("b", "tuning", 0, error="no world was found for it"))
    assert "| all | 1 of 3 = 33% (6% to 79%) | 2 of 3 = 67% (21% to 94%) |" in tables(made)
