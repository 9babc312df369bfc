"""Friction shares its cone with what resists rolling: a ball that slips while it rolls goes by both, by their speeds.

Of a push N a slip u takes mu N * mu u / D, and turning at w takes the torque rho N * rho w / D, rho = C R, D = sqrt((mu
u)^2 + (rho w)^2): the two are one ellipsoid's, which is widest against both speeds together.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from tests.judge.theory import RADIUS, G, ask, ball, ground, record, times
from wsim.judge.books.forces import Poses, pushes
from wsim.judge.books.sharing import share
from wsim.judge.books.touching import Contacts
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.rolling import CheckRolling

MU, C = 0.5, 0.1
BELT = 2.0  # [m/s]


def carried(*, rubs=1.0, resists=1.0, alone=False, seconds=1.2, belt=BELT, mu=MU, c=C):
    """A ball that a belt takes along, from rest; friction `rubs` times the law's, or as if nothing shared its cone.

    What resists its rolling is `resists` times the law's.
    """
    t, parts = times(seconds, 60.0), 400
    lever = c * RADIUS

    def change(v, w):
        slips, resisted = mu * abs(v - RADIUS * w - belt), lever * abs(w)
        both = np.hypot(slips, resisted)
        rub = rubs * mu * G * np.sign(belt + RADIUS * w - v) * (1.0 if alone else slips / both)
        return rub, (-RADIUS * rub - resists * lever * G * np.sign(w) * resisted / both) / (0.4 * RADIUS**2)

    state, found, dt = np.zeros(3), [np.zeros(3)], 1.0 / 60.0 / parts
    for _ in t[1:]:
        for _ in range(parts):
            half = state[1:] + 0.5 * dt * np.array(change(*state[1:]))
            state = state + dt * np.array([half[0], *change(*half)])
        found.append(state)
    way, speed, spin = np.array(found).T
    angle, none = np.cumsum(np.r_[0.0, 0.5 * (spin[1:] + spin[:-1])]) / 60.0, 0.0 * t
    body, floor = ball(), ground(mu)
    body = body.model_copy(update={"shapes": [body.shapes[0].model_copy(update={"rolling": c})]})
    runs = floor.shapes[0].model_copy(update={"surface_velocity": (belt, 0.0, 0.0)})
    return record(
        [body], np.stack([way, none, none + RADIUS], 1), np.stack([speed, none, none], 1), t,
        statics=[floor.model_copy(update={"shapes": [runs]})],
        rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], 1),
        spin=np.stack([none, spin, none], 1),
    )  # fmt: skip


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


def test_what_slips_and_rolls_by_the_law_is_accepted():
    assert accepted(carried())


def test_what_rolls_on_and_hardly_slips_takes_nearly_all_of_one_and_some_of_the_other():
    """In the end it slips by less than 2 cm/s: 0.14 of its friction beside 0.99 of what resists rolling."""
    recording = carried(belt=0.6, mu=0.25, c=0.05)
    assert accepted(recording)
    assert all(finding.passed for finding in ask(CheckRolling(), recording))


@pytest.mark.parametrize(("rubs", "resists"), [(0.9, 1.0), (1.1, 1.0), (1.0, 0.9), (1.0, 1.1)])
def test_a_tenth_more_or_less_of_either_is_found_there_too(rubs, resists):
    recording = carried(belt=0.6, mu=0.25, c=0.05, rubs=rubs, resists=resists)
    found = [*ask(CheckForces(), recording), *ask(CheckRolling(), recording)]
    assert not all(finding.passed for finding in found)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_friction_and_what_resists_rolling_share_a_ball_of_their_shares(seed):
    """On it all is explained, and nothing of a sixth more: of any way of the turning, of friction and of the normal."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    normal, w = turn[:, 0], 10.0 * (np.cos(a := rng.uniform(0, 7)) * turn[:, 1] + np.sin(a) * turn[:, 2])
    contact = Contacts(
        np.array([-1]), np.array([0]), np.zeros((1, 2), int), np.zeros((1, 3)), normal[None], np.zeros(1)
    )
    none = np.zeros((1, 3))
    poses = Poses(np.array([[0, 0, 0, 0, 0, 0, 1.0]]), none, none, w[None])
    columns = pushes(contact, poses, np.array([MU]), np.zeros((1, 2, 3)), np.array([C]))
    matrix = (columns.on_two / np.r_[1, 1, 1, C / MU, C / MU, C / MU]).T
    way = np.cos(b := rng.uniform(0, 7)) * turn[:, 1] + np.sin(b) * turn[:, 2]
    of_all = rng.uniform(0.0, 0.5 * np.pi)
    for more, explained in ((1.0, True), (1.18, False)):
        shares = MU * more * np.r_[np.cos(of_all) * way, -np.sin(of_all) * w / 10.0]
        left = nnls(matrix, np.r_[normal, none[0]] + shares)[1]
        assert (left < 1e-9) == explained


@pytest.mark.parametrize("rubs", [0.9, 0.97, 1.03, 1.1])
def test_more_or_less_friction_is_found(rubs):
    assert not accepted(carried(rubs=rubs))


def test_all_of_its_friction_is_too_much_where_it_rolls():
    assert not accepted(carried(alone=True, seconds=0.2))


def test_the_share_is_that_of_the_speeds():
    one, up = np.ones(1), np.array([[0.0, 0.0, 1.0]])
    rolls, spins = np.array([[0.0, 3.0, 0.0]]), np.array([[0.0, 0.0, 3.0]])
    assert share(0.5 * one, 0.1 * one, 0.8 * one, rolls, up) == pytest.approx(0.4 / np.hypot(0.4, 0.3))
    assert share(0.5 * one, 0.1 * one, 0.8 * one, spins, up) == pytest.approx(0.4 / np.hypot(0.4, 0.3 * np.pi / 2.0))
    assert share(0.5 * one, 0.0 * one, 0.8 * one, rolls, up) == 1.0
