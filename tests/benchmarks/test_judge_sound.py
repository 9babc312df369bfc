"""Worlds that were drawn as sound ones, and rejected once for what is lost in rounding: they are accepted."""

import dataclasses

import pytest

from benchmarks.judge_sound import EVIDENCE, outcomes, simulated, stage_of, world_of
from tests.judge.theory import ask, edited
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded import CheckRecordedForces


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
