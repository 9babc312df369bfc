"""Worlds that were drawn as sound ones, and rejected once for what is lost in rounding: they are accepted."""

import pytest

from benchmarks.judge_sound import EVIDENCE, outcomes, simulated, stage_of, world_of
from tests.judge.theory import ask, edited
from wsim.judge.checks.energy import CheckEnergy


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
