"""Predicates of fluid on the tank in which a block floats and a ball sinks."""

from dataclasses import replace

import numpy as np
import pytest

from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import Signals, evaluate, parse
from wsim.recording.recording import FluidTrack

BLOCK, BALL, WATER = "wooden_block", "steel_ball", "/World/water"
LEVEL = 0.3 + (0.6 * 0.0056 + 4 / 3 * np.pi * 0.06**3) / (0.66 * 0.51)  # over the floor, with what both displace


def found(text, case):
    return evaluate(parse(text), Signals.of_recording(case.recording))


def test_the_block_floats_as_archimedes_has_it(pool):
    outcome = found(f"floats({BLOCK}, water)", pool())
    measure = outcome.measures[0]
    # 0.6 of its 0.14 m, to half a spacing of 0.03 m.
    assert outcome.satisfied[0] and measure.expected == pytest.approx(0.084, rel=1e-3)
    assert outcome.margin[0] <= 0.015 and outcome.units == ["m"]


@pytest.mark.parametrize("lift", [0.02, -0.02])
def test_a_block_that_floats_too_high_or_too_low_does_not(pool, lift):
    outcome = found(f"floats({BLOCK}, water)", pool(lift=lift))
    # The surface goes the other way, by what the body displaces less or more.
    off = 0.02 / (1.0 - 0.2 * 0.2 / (0.66 * 0.51))
    assert not outcome.satisfied[0] and outcome.margin[0] == pytest.approx(0.015 - off, abs=2e-4)
    assert found(f"floats({BLOCK}, water, within 3 cm)", pool(lift=lift)).satisfied[0]


def test_what_is_too_heavy_never_floats(pool):
    case = pool()
    heavy = case.body("/World/wooden_block", mass=1.2 * 5.6)
    outcome = found(f"floats({BLOCK}, water)", heavy)
    assert not outcome.satisfied[0] and outcome.margin[0] == pytest.approx(1.0 - 0.6 * 1.2 / 0.6)
    assert outcome.units == ["1"]  # as deep as what floats may be, and heavier than what does
    assert not found(f"floats({BALL}, water)", case).satisfied[0]


def test_the_ball_sinks_and_is_submerged_and_the_block_is_neither(pool):
    case = pool()
    assert found(f"sinks({BALL}, water)", case).satisfied[0]
    assert not found(f"sinks({BLOCK}, water)", case).satisfied[0]
    under = found(f"submerged({BALL}, water)", case)
    assert under.margin[0] == pytest.approx(LEVEL - 0.12, abs=2e-3)
    above = found(f"submerged({BLOCK}, water)", case)
    assert above.margin[0] == pytest.approx(-0.4 * 0.14, abs=5e-3)
    assert found(f"not submerged({BALL}, water)", case).margin[0] == pytest.approx(-under.margin[0])


def test_a_ball_that_hovers_under_water_has_not_sunk(pool):
    case = pool().edit("body_q", (slice(None), 1, 2), 0.02 + 0.06 + 0.02)
    outcome = found(f"sinks({BALL}, water)", case)
    assert not outcome.satisfied[0] and outcome.margin[0] == pytest.approx(0.015 - 0.02, abs=1e-6)
    assert found(f"submerged({BALL}, water)", case).satisfied[0]


def test_fills_to_is_the_level_over_the_floor(pool):
    case = pool()
    assert found(f"fills_to(water, {LEVEL} m)", case).margin[0] == pytest.approx(0.015, abs=1e-3)
    assert found(f"fills_to(water, {LEVEL + 0.02} m)", case).margin[0] == pytest.approx(-0.005, abs=1e-3)
    assert found(f"fills_to(water, {LEVEL - 0.02} m)", case).margin[0] == pytest.approx(-0.005, abs=1e-3)


def pouring(case):
    """The upper half of the water comes in at 2 s; until then it is far beside the tank."""
    track = case.recording.fluids[WATER]
    position = track.position.copy()
    upper = position[0, :, 2] > np.median(position[0, :, 2])
    position[np.ix_(track.time < 2.0, np.flatnonzero(upper), [0])] += 9.0
    water = FluidTrack(track.time, position, track.velocity, track.density)
    return case.changed(fluids={WATER: replace(water)}), float(upper.mean())


def test_what_is_not_poured_in_yet_does_not_fill(pool):
    case, share = pouring(pool())
    assert found(f"fills_to(water, {LEVEL} m)", case).satisfied[0]
    early = found(f"always[0, 1](fills_to(water, {LEVEL} m))", case)
    assert early.margin[0] == pytest.approx(0.015 - share * 0.3, abs=1e-3)


def test_fluid_outside_is_not_inside_and_not_conserved(pool):
    case, share = pouring(pool())
    assert found("stays_inside(water, tank)", pool()).margin[0] == pytest.approx(0.01)
    assert found("stays_inside(water, tank)", case).margin[0] == pytest.approx(0.01 - share)
    assert found("always[2, 4](stays_inside(water, tank))", case).satisfied[0]
    assert found("conserves(mass, water)", pool()).satisfied[0]
    mass = 1000.0 * 0.66 * 0.51 * 0.3
    assert found("conserves(mass, water)", case).margin[0] == pytest.approx((0.02 - share) * mass)


def test_what_needs_particles_says_so_of_many_worlds(pool):
    signals = Signals.of_recording(pool().recording)
    many = Signals(
        signals.world, signals.time,
        *(np.repeat(array, 2, axis=0) for array in (signals.body_q, signals.body_qd, signals.contact_force)),
    )  # fmt: skip
    for text in (f"floats({BLOCK}, water)", f"sinks({BLOCK}, water)", f"submerged({BLOCK}, water)",
                 "fills_to(water, 0.3 m)", "stays_inside(water, tank)", "conserves(mass, water)"):  # fmt: skip
        with pytest.raises(MissingError, match="only a recording of one world has; these signals are of 2 worlds"):
            evaluate(parse(text), many)
    assert evaluate(parse(f"stays_inside({BALL}, tank)"), many).margin.shape == (2,)


@pytest.mark.parametrize("rate", [1.5, -0.7])
def test_a_fluid_that_turns_as_a_whole_swirls(pool, rate):
    """v = w x r about any middle, with any speed besides, has L / I = w."""
    case = pool()
    track = case.recording.fluids[WATER]
    carried = np.array([0.3, 0.0, 0.1])
    turn = np.cross([0.0, 0.0, rate], track.position - [0.1, -0.2, 0.0])
    water = case.water(velocity=(turn + carried).astype(np.float32))
    low, high = np.degrees(rate) - 5.0, np.degrees(rate) + 20.0
    assert found(f"swirls_between(water, z, {low} deg/s, {high} deg/s)", water).margin[0] == pytest.approx(
        5.0, rel=1e-3
    )
    assert found("swirls_between(water, x, -1 deg/s, 1 deg/s)", water).satisfied[0]
    assert not found(f"swirls_between(water, z, {low} deg/s, {high} deg/s)", case).satisfied[0]  # at rest


def test_a_level_in_a_vessel_is_that_of_what_is_in_it(pool):
    """Half of the water, poured in at 2 s: the other half stands at half the height before."""
    case, share = pouring(pool())
    assert found("level_in(water, tank, 0.3 m)", case).margin[0] == pytest.approx(0.015, abs=1e-3)
    early = found("always[0, 1](level_in(water, tank, 0.3 m, within 1 cm))", case)
    assert early.margin[0] == pytest.approx(0.01 - share * 0.3, abs=1e-3)
    half = (1.0 - share) * 0.3
    assert found(f"always[0, 1](level_in(water, tank, {half} m, within 1 cm))", case).margin[0] == pytest.approx(
        0.01, abs=1e-3
    )


def test_a_vessel_is_filled_by_the_part_that_is_in_it(pool):
    case, share = pouring(pool())
    assert found("fills(water, tank)", case).margin[0] == pytest.approx(0.1)
    assert found("always[0, 1](fills(water, tank))", case).margin[0] == pytest.approx(0.1 - share)
    assert found("always[0, 1](fills(water, tank, share 40 %))", case).satisfied[0] == (share <= 0.6)


def test_what_is_out_of_the_tank_does_not_float_in_it(pool):
    case = pool().edit("body_q", (slice(60, None), 0, 0), 0.6)
    outcome = found(f"floats({BLOCK}, water)", case)
    assert not outcome.satisfied[0] and outcome.margin[0] == pytest.approx(0.33 - 0.6, abs=1e-6)
