"""What the stage states of starts and of what is led, held against recordings of other starts and other ways."""

from __future__ import annotations

import dataclasses
import math

import pytest

from wsim.judge.checks.stated import CheckPath, CheckStart
from wsim.judge.evidence.evidence import Evidence
from wsim.program.mend.apply import mended
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.collect import collect


def thrown(scene, speed=3.0, spin=100.0, aside=0.0, tilt=0.0, swing=40.0):
    scene.simulation(duration=0.2, frame_rate=30)
    scene.box(
        "brick", size=(0.2, 0.3, 0.1), position=(aside, 0, 1), velocity=(speed, 0, 2), mass=1,
        angular_velocity_deg=(0, 0, spin), rotation_deg=(0, tilt, 0),
    )  # fmt: skip
    scene.box("still", size=(0.2, 0.2, 0.2), position=(0, 5, 1), mass=1)
    scene.box("bob", size=(0.4, 0.05, 0.05), mass=1, position=(0.2, 9, 2), angular_velocity_deg=(0, swing, 0))
    scene.joint_revolute("hinge", None, "bob", anchor=(0, 9, 2), axis="Y")


def led(scene, top=1.5, speed=0.3, spin=60.0):
    scene.simulation(duration=1.0, frame_rate=30)
    scene.box("lift", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
    scene.path("lift", times=[0, 1], positions=[(0, 0, 0.5), (0, 0, top)])
    scene.box("belt", size=(1, 1, 0.1), position=(0, 3, 0.5), kinematic=True, velocity=(speed, 0, 0))
    scene.cylinder(
        "table", radius=0.5, height=0.1, position=(0, 6, 0.5), kinematic=True, angular_velocity_deg=(0, 0, spin)
    )


def evidence(tmp_path, build, seed=0, **values):
    """What happens with those values, told as the world without them."""
    made = []
    for k, numbers in enumerate([{}, values]):
        scene, path = Scene(), tmp_path / f"{build.__name__}_{k}.usda"
        build(scene, **numbers)
        scene.save(path)
        made.append(collect(Simulation(path, "cpu", seeds=[seed])))
    return Evidence(dataclasses.replace(made[1], world=made[0].world).recording(0))


@pytest.mark.parametrize("seed", [0, 7])
def test_as_stated_all_passes(tmp_path, seed):
    for build, check in ((thrown, CheckStart()), (led, CheckPath())):
        found = check.run(evidence(tmp_path, build, seed))
        assert found and all(finding.passed for finding in found), found


@pytest.mark.parametrize(
    ("values", "prim", "value"),
    [
        ({"speed": 3.3}, "brick", 0.3),
        ({"spin": 110.0}, "brick", math.radians(10)),
        ({"aside": 0.02}, "brick", 0.02),
        ({"tilt": 5.0}, "brick", math.radians(5)),
        ({"swing": 44.0}, "bob", math.radians(4)),
    ],
)
def test_another_start_is_found_at_its_size(tmp_path, values, prim, value):
    failed = [finding for finding in CheckStart().run(evidence(tmp_path, thrown, **values)) if not finding.passed]
    assert {finding.prim for finding in failed} == {f"/World/{prim}"}
    assert max(finding.value for finding in failed) == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "prim", "value"),
    [
        ({"top": 1.65}, "lift", 0.15),
        ({"top": 0.5}, "lift", 1.0),
        ({"speed": 0.33}, "belt", 0.03),
        ({"spin": 66.0}, "table", math.radians(6)),
        ({"spin": -60.0}, "table", math.radians(120)),
    ],
)
def test_another_way_is_found_at_its_size(tmp_path, values, prim, value):
    failed = [finding for finding in CheckPath().run(evidence(tmp_path, led, **values)) if not finding.passed]
    assert [(finding.prim, finding.time) for finding in failed] == [(f"/World/{prim}", pytest.approx(1.0))]
    assert failed[0].value == pytest.approx(value, rel=1e-3)


def test_another_engine_s_model_may_start_anywhere(tmp_path):
    told = evidence(tmp_path, thrown, speed=6.0)
    told.recording.metadata.pop("loose_order")
    assert CheckStart().run(told) == []


@pytest.mark.parametrize(
    ("values", "failed"),
    [({}, set()), ({"top": 1.65}, set()), ({"speed": 0.33}, {"/World/belt"}), ({"spin": 54.0}, {"/World/table"})],
)
def test_in_a_table_of_poses_what_states_a_velocity_has_it(tmp_path, values, failed):
    """From wherever it starts; when a path has begun nobody says."""
    told = evidence(tmp_path, led, **values)
    told.recording.metadata.pop("loose_order")
    told.recording.body_q[..., 0] += 2.0
    assert {finding.prim for finding in CheckPath().run(told) if not finding.passed} == failed


def test_what_states_no_motion_may_be_led_by_a_script(tmp_path):
    told = evidence(tmp_path, led, speed=0.33, spin=54.0)
    told.recording.metadata.pop("loose_order")
    still = [
        body.model_copy(update={"velocity": (0, 0, 0), "angular_velocity": (0, 0, 0)}) for body in told.world.bodies
    ]
    world = told.world.model_copy(update={"bodies": still})
    assert CheckPath().run(Evidence(dataclasses.replace(told.recording, world=world))) == []


# ---- what the repairs say, put into the program, is what happened
THROWN = """
def build(scene):
    scene.simulation(duration=0.2, frame_rate=30)
    scene.box("brick", size=(0.2, 0.3, 0.1), position=(0, 0, 1), velocity=(3, 0, 2), mass=1,
              angular_velocity_deg=(0, 0, 100), rotation_deg=(10, 20, 30))
"""
LED = """
def build(scene):
    scene.simulation(duration=1.0, frame_rate=30)
    lift = scene.box("lift", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
    scene.path(lift, times=[0, 0.5, 1], positions=[(0, 0, 0.5), (0, 0, 0.9), (0, 0, 1.5)],
               rotations_deg=[(0, 0, 0), (0, 0, 10), (0, 0, 30)])
    scene.box("belt", size=(1, 1, 0.1), position=(0, 3, 0.5), kinematic=True, velocity=(0.3, 0, 0))
    scene.cylinder("table", radius=0.5, height=0.1, position=(0, 6, 0.5), kinematic=True,
                   angular_velocity_deg=(0, 0, 60))
"""


def built(tmp_path, program, name):
    scene, space = Scene(), {}
    exec(program, space)
    space["build"](scene)
    return scene.save(tmp_path / f"{name}.usda")


@pytest.mark.parametrize(
    ("program", "check", "stated", "happened"),
    [
        (THROWN, CheckStart(), "velocity=(3, 0, 2)", "velocity=(3, 0, 2.5)"),
        (THROWN, CheckStart(), "position=(0, 0, 1)", "position=(0, 0.1, 1)"),
        (THROWN, CheckStart(), "(10, 20, 30)", "(-15, 24, 70)"),
        (THROWN, CheckStart(), "(0, 0, 100)", "(20, 0, 100)"),
        (LED, CheckPath(), "velocity=(0.3, 0, 0)", "velocity=(0.3, 0.1, 0)"),
        (LED, CheckPath(), "(0, 0, 60)", "(0, 0, 200)"),
        (LED, CheckPath(), "(0, 0, 0.9)", "(0, 0.2, 0.8)"),
        (LED, CheckPath(), "(0, 0, 10)", "(0, 0, 25)"),
    ],
)
def test_the_repair_states_what_happened(tmp_path, program, check, stated, happened):
    moved = collect(Simulation(built(tmp_path, program.replace(stated, happened), "moved"), "cpu"))
    for rounds in range(3):
        told = dataclasses.replace(moved, world=describe(built(tmp_path, program, "told")))
        evidence_of = Evidence(told.recording(0))
        found = check.run(evidence_of)
        failed = [finding for finding in found if not finding.passed]
        assert failed or rounds
        if not failed:
            break
        program = mended(program, check.repair(failed[0], evidence_of))
    assert found and not failed, failed
    assert stated not in program


def meshed(scene, spin=0.0):
    scene.simulation(duration=0.2, frame_rate=30)
    for k, spins in enumerate((spin, 0.0)):
        turning = {"position": (k, 0, 1), "density": 500, "angular_velocity_deg": (0, 0, spins)}
        scene.cylinder(f"wheel{k}", radius=0.1, height=0.05, **turning)
        scene.joint_revolute(f"axle{k}", None, f"wheel{k}", axis="Z")
    scene.gear("mesh", "axle0", "axle1", ratio=-1.0)


def test_what_a_gear_turns_is_not_stated_to_stand(tmp_path):
    """What it meshes with is stated to turn; where nothing is, neither does."""

    def turned(scene):
        meshed(scene, spin=100.0)

    assert all(finding.passed for finding in CheckStart().run(evidence(tmp_path, turned)))
    assert not all(finding.passed for finding in CheckStart().run(evidence(tmp_path, meshed, spin=100.0)))


def hung(scene, speed=0.0, spin=0.0):
    scene.simulation(duration=0.2, frame_rate=30)
    scene.sphere("bob", radius=0.1, position=(0, 0, 1), density=500, velocity=(speed, 0, 0))
    scene.joint_revolute("hinge", None, "bob", anchor=(0, 0, 2), axis="Y")
    scene.sphere("tethered", radius=0.1, position=(3, 0, 1), density=500, angular_velocity_deg=(0, 0, spin))
    scene.rope("rope", None, "tethered", anchor_a=(3, 0, 2))
    scene.box("weight", size=(0.1,) * 3, position=(6, 0, 1), mass=1.0, angular_velocity_deg=(0, 0, spin))
    scene.spring("coil", None, "weight", stiffness=100, anchor_a=(6, 0, 2))


@pytest.mark.parametrize("moved", [{"speed": 0.5}, {"spin": 5.0}])
def test_what_hangs_and_is_stated_to_stand_stands(tmp_path, moved):
    """Where nothing of a mechanism is stated to move, joints make no speed of it; ropes and springs never do."""
    stated, other = (evidence(tmp_path, hung, **given) for given in ({}, moved))
    assert all(finding.passed for finding in CheckStart().run(stated))
    spoiled = Evidence(dataclasses.replace(other.recording, world=stated.world))
    assert not all(finding.passed for finding in CheckStart().run(spoiled))
