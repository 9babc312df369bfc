"""Water that a landing body drives out, against continuity between two faces that close."""

import math

import pytest

from wsim.judge.checks.physics import CheckExplosion
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.squeezed import squeezed_speed

BLOCK, SPACING, WATER = 0.2, 0.03, "/World/water"  # 0.2 m square from above


def test_a_face_that_closes_drives_water_over_its_rim(pool):
    recording = pool(density=8500.0).recording
    evidence = Evidence(recording)
    (fluid,) = recording.world.fluids
    entry = math.sqrt(2.0 * 9.81 * 0.2)  # of the ball; the block falls half as deep
    block = math.sqrt(2.0 * 9.81 * 0.1) * BLOCK / SPACING  # v a^2 / (4 a h), h a quarter of a spacing
    ball = entry * 0.12 / SPACING
    assert squeezed_speed(evidence, fluid, math.inf) == pytest.approx(max(block, ball), rel=0.01)
    assert squeezed_speed(evidence, fluid, 1.0) == pytest.approx(BLOCK / SPACING, rel=0.01)


@pytest.mark.parametrize(("share", "passes"), [(0.95, True), (1.1, False)])
def test_water_that_is_driven_out_is_no_explosion(pool, share, passes):
    case = pool(density=8500.0)
    (water,) = case.recording.world.fluids
    case = case.world(fluids=[water.model_copy(update={"spacing": 0.02})])
    bound = squeezed_speed(Evidence(case.recording), case.recording.world.fluids[0], math.inf)
    fall = 3.0 * math.sqrt(2.0 * 9.81 * (case.recording.body_q[0, 1, 2] + 0.06))
    assert bound > 1.1 * fall  # so that the bound by a fall does not decide
    velocity = case.recording.fluids[WATER].velocity.copy()
    velocity[20, 5] = (share * bound, 0.0, 0.0)
    found = CheckExplosion().evaluate(Evidence(case.water(velocity=velocity).recording))
    assert next(finding for finding in found if finding.prim == WATER).passed == passes
