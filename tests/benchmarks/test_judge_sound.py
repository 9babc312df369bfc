"""Worlds that were drawn as sound ones, and rejected once for what is lost in rounding: they are accepted."""

import dataclasses
import math

import numpy as np
import pytest

from benchmarks.judge_sound import EVIDENCE, outcomes, simulated, stage_of, world_of
from tests.judge.theory import ask, edited, with_world
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.checks.recorded_ties import CheckRecordedTies


@pytest.mark.parametrize(
    ("kind", "seed"),
    [
        pytest.param("mixed", 18, id="a linkage that rests, adrift: its loop closes at 5e-7 m/s"),
        pytest.param("gears", 13, id="a train that dry friction holds turns by 3e-7 rad"),
        pytest.param("rolling", 16, id="what rolls adrift grazes its floor, along any normal"),
    ],
)
def test_what_is_lost_in_rounding_is_no_fault(kind, seed):
    assert [(each.evidence, each.failed) for each in outcomes(kind, seed) if each.status != "accepted"] == []


def test_a_resting_linkage_that_begins_to_turn_is_found():
    """By 5 mrad/s, 0.6 mm/s at its end; it closes with a thousandth of that."""
    stage, _ = stage_of("mixed", 18)
    track, world = simulated(stage), world_of(stage)
    row = next(k for k, body in enumerate(world.bodies) if body.prim.endswith("linkages2_crank"))
    faster = edited(
        EVIDENCE["recorded"](track, world), "body_qd", (slice(12, None), row, slice(3, 6)), (0.0, 5e-3, 0.0)
    )
    assert any(not finding.passed for finding in ask(CheckEnergy(), faster))


def recorded(kind, seed):
    """A drawn world as wsim records it, and the rows of its bodies by their names."""
    stage, _ = stage_of(kind, seed)
    world = world_of(stage)
    rows = {body.prim.split("/")[-1]: row for row, body in enumerate(world.bodies)}
    return EVIDENCE["recorded"](simulated(stage), world), rows


def fails(check, recording):
    return [finding.message for finding in ask(check, recording) if not finding.passed]


def test_a_box_that_turns_on_a_crest_rubs_at_all_of_it():
    """It lies on a ridge by a line of points that slip each its own way; a tenth of its weight, along it, is found."""
    recording, row = recorded("hills", 30)
    assert fails(CheckForces(), recording) == []
    pull = -0.1 * recording.world.gravity[2] * (recording.time[1] - recording.time[0])
    faster = edited(recording, "body_qd", (slice(79, None), row["hills1_0"], 1), pull)
    assert any("hills1_0 is pushed" in message for message in fails(CheckForces(), faster))


def test_friction_leans_as_the_normals_under_a_box_in_a_valley_do():
    """They lean apart by 53 degrees along its slip: it rubs with 0.90 of its friction; a tenth less is found."""
    recording, _ = recorded("hills", 33)
    assert fails(CheckRecordedForces(), recording) == []
    track = recording.contacts
    sums = track.sums.copy()
    sums[:, :3] = track.along + 0.9 * (track.impulse - track.along)
    less = dataclasses.replace(recording, contacts=dataclasses.replace(track, sums=sums))
    assert any("slip, and rub" in message for message in fails(CheckRecordedForces(), less))


def test_a_ball_that_hops_in_every_interval_is_not_one_that_stands():
    """Each hop takes 1 - e^2 of its height; that a tenth of its speed is gone besides is found."""
    recording, row = recorded("thrown", 32)
    assert fails(CheckEnergy(), recording) == []
    slow = edited(
        recording, "body_qd", (slice(15, None), row["thrown0_0"], 2), -0.1 * recording.body_qd[15:, row["thrown0_0"], 2]
    )
    assert any("that nothing takes" in message for message in fails(CheckEnergy(), slow))


def test_capsules_that_rock_side_by_side_push_at_both_ends():
    """One rolls over another, 3 mrad askew, and is held now at one end, now at the other; a turn besides is found."""
    recording, row = recorded("rolling", 27)
    assert fails(CheckForces(), recording) == []
    turn = 0.1 * recording.body_qd[30, row["rolling1_2"], 3:]
    turned = edited(recording, "body_qd", (slice(30, None), row["rolling1_2"], slice(3, 6)), turn)
    assert any("rolling1_2 is turned" in message for message in fails(CheckForces(), turned))


def test_a_damped_spring_that_swings_by_a_radian_a_frame():
    """Two frames do not tell what its damper takes in between, their lengths besides do: a tenth less is found."""
    recording, _ = recorded("springs", 26)
    assert fails(CheckEnergy(), recording) == []
    springs = [each.model_copy(update={"damping": 0.9 * each.damping}) for each in recording.world.springs]
    assert any(
        "that nothing takes" in message for message in fails(CheckEnergy(), with_world(recording, springs=springs))
    )


def test_a_rope_that_hangs_slack_at_the_start_comes_taut_in_the_first_interval():
    """The jerk takes 92 % of what its bob has, and all of it pulls as the rope lies then.

    That its speed is a tenth less than it had to be is found, and so is a tenth of a pull aside.
    """
    recording, row = recorded("ropes", 24)
    assert fails(CheckEnergy(), recording) + fails(CheckRecordedTies(), recording) == []
    bob = recording.body_qd[20:, row["ropes0_0"], :3]
    slow = edited(recording, "body_qd", (slice(20, None), row["ropes0_0"], slice(3)), -0.1 * bob)
    assert any("ropes0_0 gains" in message for message in fails(CheckEnergy(), slow))  # where it is lower it lacks most
    cords = recording.ties.cords.copy()
    aside = np.cross(cords[20, 0, :3], (0.0, 0.0, 1.0))
    cords[20, 0, :3] += 0.1 * np.linalg.norm(cords[20, 0, :3]) * aside / np.linalg.norm(aside)
    bent = dataclasses.replace(recording, ties=dataclasses.replace(recording.ties, cords=cords))
    assert any("pulls beside its way" in message for message in fails(CheckRecordedTies(), bent))


def test_a_stop_that_catches_what_a_drive_throws_within_a_frame():
    """It turned by 0.16 rad between two frames at rest. And a slider's drive is as damped as it went, where dry
    friction comes to hold another joint of its arm.

    A tenth of what the slider passes on is found, and of the hinge's torque about its anchor, once it lies still.
    """
    recording, _ = recorded("arms", 30)
    assert fails(CheckRecordedTies(), recording) == []
    names = [joint.prim.split("/")[-1] for joint in recording.world.joints]
    for name, column, frame in (("arms0_2_slider", 12, 6), ("arms2_1_hinge", 12, 20)):
        joints = recording.ties.joints.copy()
        joints[frame, names.index(name), column] *= 0.9
        wrong = dataclasses.replace(recording, ties=dataclasses.replace(recording.ties, joints=joints))
        assert any(name in message for message in fails(CheckRecordedTies(), wrong))


@pytest.mark.parametrize(("kind", "seed"), [("cables", 29), ("cables", 35), ("arms", 20), ("ropes", 22)])
def test_what_is_drawn_is_a_world(kind, seed):
    """Cables are slender, links no denser than osmium, and weights are not in each other."""
    stage, _ = stage_of(kind, seed)
    world = world_of(stage)
    for body in world.bodies:
        assert body.mass < 22_600.0 * body.volume
    balls = [body for body in world.bodies if body.shapes[0].kind == "sphere"]
    for k, one in enumerate(balls):
        for other in balls[:k]:
            assert math.dist(one.position, other.position) > one.shapes[0].size[0] + other.shapes[0].size[0]
