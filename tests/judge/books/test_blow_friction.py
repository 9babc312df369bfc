"""Friction within a blow: a ball that glances off the floor sticks or slides as Coulomb's law has it (Routh 1860)."""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, ground, record, times
from wsim.judge.checks.impacts import CheckBlowFriction, CheckRestitution

WHEN, BOUNCE = 0.2037, 0.5  # [s]; the restitution
SLIDES, STICKS = (3.0, 2.0, 0.2), (1.0, 2.0, 0.8)  # along and down [m/s]; friction


def glancing(along, down, friction, share):
    """A ball that meets the floor and gets `share` of the friction that the law gives it."""
    t = times(0.4, 60.0)
    since, free = t - WHEN, t > WHEN
    # To grip takes 2/7 of the slip: at the point a ball feels 2/7 of its mass.
    gave = share * min(friction * (1.0 + BOUNCE) * down, 2.0 / 7.0 * along)
    speed, spin = np.where(free, along - gave, along), np.where(free, 2.5 * gave / RADIUS, 0.0)
    up = np.where(free, BOUNCE * down, -down)
    none, angle = 0.0 * t, spin * since
    place = np.stack([speed * since, none, RADIUS + up * since - G * since**2 / 2], 1)
    things = []
    for thing in (ball(), ground()):
        shape = thing.shapes[0].model_copy(update={"friction": friction, "restitution": BOUNCE})
        things.append(thing.model_copy(update={"shapes": [shape]}))
    return record(
        things[:1], place, np.stack([speed, none, up - G * since], 1), t, statics=things[1:],
        rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], 1),
        spin=np.stack([none, spin, none], 1),
    )  # fmt: skip


@pytest.mark.parametrize("motion", [SLIDES, STICKS])
def test_what_the_law_gives_is_accepted(motion):
    for check in (CheckBlowFriction, CheckRestitution):
        assert [finding.passed for finding in ask(check(), glancing(*motion, 1.0))] == [True]


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 1.1, 2.0])
@pytest.mark.parametrize("motion", [SLIDES, STICKS])
def test_more_or_less_is_found(motion, share):
    assert [finding.passed for finding in ask(CheckBlowFriction(), glancing(*motion, share))] == [False]
