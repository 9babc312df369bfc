"""A ball that rolls is slowed by 5/7 C g where its surfaces state a resistance C, and by nothing where they do not."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, ground, record, times
from wsim.judge.checks.rolling import CheckRolling

C, SPEED = 0.02, 2.0


def rolling(slowing, stated=None, start=SPEED):
    """A ball on the ground that starts at 2 m/s and loses `slowing` [m/s^2]."""
    t = times(1.0, 60.0)
    way, speed = start * t - slowing * t**2 / 2, start - slowing * t
    none, angle = 0.0 * t, way / RADIUS
    body = ball()
    body = body.model_copy(update={"shapes": [body.shapes[0].model_copy(update={"rolling": stated})]})
    return record(
        [body], np.stack([way, none, none + RADIUS], 1), np.stack([speed, none, none], 1), t, statics=[ground()],
        rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], 1),
        spin=np.stack([none, speed / RADIUS, none], 1),
    )  # fmt: skip


def accepted(recording):
    (finding,) = ask(CheckRolling(), recording)
    return finding.passed


@pytest.mark.parametrize("resistance", [0.0, 0.005, C, 0.1])
def test_what_is_slowed_as_stated_is_accepted(resistance):
    assert accepted(rolling(5.0 / 7.0 * resistance * G, resistance or None))


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 1.1, 2.0])
def test_another_resistance_is_found(share):
    assert not accepted(rolling(share * 5.0 / 7.0 * C * G, C))


@pytest.mark.parametrize("slowing", [0.01, -0.01])
def test_nothing_slows_or_speeds_up_what_states_no_resistance(slowing):
    assert accepted(rolling(0.0))
    assert not accepted(rolling(slowing))


@pytest.mark.parametrize(("near", "asked"), [(1e-4, False), (0.5, True)])
def test_what_is_touched_on_its_way_is_not_asked(near, asked):
    """A ball that another one came by to slow, between two of the frames that open, halve and close a span."""
    alone, t = rolling(0.01), times(1.0, 60.0)
    first = alone.body_q[:, 0].astype(np.float64)
    beside = np.isin(np.arange(len(t)) % 8, (2, 3, 4, 5))  # spans of 16 begin each 8
    second = first.copy()
    second[:, 1] += 2 * RADIUS + near + np.where(beside, 0.0, 5e-3)
    world = alone.world
    other = world.bodies[0].model_copy(update={"prim": "/World/other"})
    q, qd = (np.stack([a, b], 1) for a, b in ((first, second), (alone.body_qd[:, 0], alone.body_qd[:, 0])))
    both = replace(
        alone, world=world.model_copy(update={"bodies": [world.bodies[0], other]}), body_q=q.astype(np.float32),
        body_qd=qd, contact_force=np.zeros((len(t), 2, 3), dtype=np.float32),
    )  # fmt: skip
    assert bool(ask(CheckRolling(), both)) == asked
