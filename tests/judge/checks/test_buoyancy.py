"""The lift of what lies in a fluid, against Archimedes, and what is too small to have one."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.conftest import BALL, BALL_PRIM, RATE, SPACING, WATER
from tests.judge.theory import G, ask, only, with_world
from wsim.judge.checks.buoyancy import CheckBuoyancy, CheckResolved

LIFT = 1000.0 * G * 4.0 / 3.0 * np.pi * BALL**3  # [N], of the ball that lies on the floor


def pushed(case, ball, block=0.0):
    """Its recording, in which the fluid gives the ball and the block forces upwards [N]."""
    impulse = np.zeros((len(case.recording.time), 2, 3))
    impulse[1:, 0, 2], impulse[1:, 1, 2] = block / RATE, ball / RATE
    return replace(case.recording, applied_impulse=impulse)


@pytest.mark.parametrize(("share", "sound"), [(1.0, True), (0.9, True), (1.1, True), (0.2, False), (-8.0, False)])
def test_what_lies_on_the_floor_is_lifted_by_what_it_displaces(pool, share, sound):
    finding = only(ask(CheckBuoyancy(), pushed(pool(), share * LIFT)))
    assert finding.prim == BALL_PRIM and finding.passed is sound
    assert finding.value == pytest.approx(share * LIFT, rel=1e-6) and finding.expected == pytest.approx(LIFT, rel=0.02)
    assert sound or "displaces weighs" in finding.message


def test_water_that_presses_down_what_is_lighter_than_it_is_no_water(pool):
    """A ball of 500 kg/m^3 stays on the floor: no force says that it should, whatever the contact table has."""
    case = pool()
    bodies = [one.model_copy(update={"mass": 0.06 * one.mass}) for one in case.recording.world.bodies]
    light = with_world(pushed(case, -4.0 * LIFT), bodies=bodies)
    assert not only(ask(CheckBuoyancy(), light)).passed


def test_what_floats_moves_or_lies_in_water_that_moves_is_not_asked(pool):
    case = pool()
    moving = pushed(case, 0.0)
    track = moving.fluids[WATER]
    wild = replace(track, velocity=np.full_like(track.velocity, 0.5))
    assert ask(CheckBuoyancy(), replace(moving, fluids={WATER: wild})) == []
    rolls = moving.body_qd.copy()
    rolls[:, 1, 0] = 0.5
    assert ask(CheckBuoyancy(), replace(moving, body_qd=rolls)) == []
    assert ask(CheckBuoyancy(), case.recording) == []  # what bodies got is not recorded


@pytest.mark.parametrize(("spacing", "sound"), [(0.02, True), (BALL, True), (1.9 * BALL, False), (3.0 * BALL, False)])
def test_what_is_smaller_than_the_particles_is_told(pool, spacing, sound):
    case = pool()
    fluids = [case.recording.world.fluids[0].model_copy(update={"spacing": spacing})]
    finding = only(ask(CheckResolved(), with_world(pushed(case, LIFT), fluids=fluids)))
    assert finding.passed is sound and finding.value == pytest.approx(2.0 * BALL / spacing, rel=1e-6)
    if not sound:
        assert finding.target.parameter == "spacing" and finding.target.suggested == pytest.approx(0.4 * BALL)


def test_what_stays_dry_may_be_as_small_as_it_likes(pool):
    case = pool()
    fluids = [case.recording.world.fluids[0].model_copy(update={"spacing": 3.0 * SPACING})]
    assert ask(CheckResolved(), with_world(pushed(case, 0.0), fluids=fluids)) == []
