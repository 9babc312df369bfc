"""Friction shares its cone with what resists rolling: a ball that slips while it rolls goes by both, by their speeds.

Of a push N a slip u takes mu N * mu u / D, and turning at w takes the torque rho N * rho w / D, rho = C R, D = sqrt((mu
u)^2 + (rho w)^2): the two are one ellipsoid's, which is widest against both speeds together.
"""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, ground, record, times
from wsim.judge.books.sharing import share
from wsim.judge.checks.forces import CheckForces

MU, C = 0.5, 0.1
BELT = 2.0  # [m/s]


def carried(*, rubs=1.0, alone=False, seconds=1.2):
    """A ball that a belt takes along, from rest; friction `rubs` times the law's, or as if nothing shared its cone."""
    t, parts = times(seconds, 60.0), 400
    lever = C * RADIUS

    def change(v, w):
        slips, resisted = MU * abs(v - RADIUS * w - BELT), lever * abs(w)
        both = np.hypot(slips, resisted)
        rub = rubs * MU * G * np.sign(BELT + RADIUS * w - v) * (1.0 if alone else slips / both)
        return rub, (-RADIUS * rub - lever * G * np.sign(w) * resisted / both) / (0.4 * RADIUS**2)

    state, found, dt = np.zeros(3), [np.zeros(3)], 1.0 / 60.0 / parts
    for _ in t[1:]:
        for _ in range(parts):
            half = state[1:] + 0.5 * dt * np.array(change(*state[1:]))
            state = state + dt * np.array([half[0], *change(*half)])
        found.append(state)
    way, speed, spin = np.array(found).T
    angle, none = np.cumsum(np.r_[0.0, 0.5 * (spin[1:] + spin[:-1])]) / 60.0, 0.0 * t
    body, floor = ball(), ground(MU)
    body = body.model_copy(update={"shapes": [body.shapes[0].model_copy(update={"rolling": C})]})
    belt = floor.shapes[0].model_copy(update={"surface_velocity": (BELT, 0.0, 0.0)})
    return record(
        [body], np.stack([way, none, none + RADIUS], 1), np.stack([speed, none, none], 1), t,
        statics=[floor.model_copy(update={"shapes": [belt]})],
        rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], 1),
        spin=np.stack([none, spin, none], 1),
    )  # fmt: skip


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


def test_what_slips_and_rolls_by_the_law_is_accepted():
    assert accepted(carried())


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
