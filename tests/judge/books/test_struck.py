"""Blows on what hangs: ties pass the impulse on with the arms of its instant, not those halfway to the next frame.

A ball falls off centre on a light plate on a ball joint, its centre of mass LONG below. Of a frictionless blow at OFF
from the axis, by an impulse P, the plate of moment I about the joint gets the rate w = OFF P / I, and the ball of mass
m the velocity P / m; Newton's law of impact gives P (1 / m + OFF^2 / I) = (1 + e) u. The joint bears P upward, which
turns nothing as the plate hangs straight: at the arm halfway to the next frame it would, by P LONG w (h - s) / 2.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.judge.theory import RADIUS, G, ask, ball, box, record, times
from wsim.judge.checks.forces import CheckForces
from wsim.scene.world import Joint

TOP, LONG, OFF, THICK = 2.0, 0.2, 0.2, 0.03  # [m]
FRAME, FALL, BOUNCE = 6, 3.0, 0.5  # the blow is after that frame, at that speed [m/s], and parts by that share
BALL, PLATE = 15.0, 2.0  # [kg]


def struck(share, error=0.0):
    """The blow is `share` of an interval after a frame; the plate goes on by `error` of its rate faster."""
    t = times(0.12, 100.0)
    plate = box("plate", (0.5, 0.5, THICK), PLATE, friction=0.0)
    moment = plate.inertia[4] + PLATE * LONG**2
    push = (1.0 + BOUNCE) * FALL / (1.0 / BALL + OFF**2 / moment)
    rate = (1.0 + error) * OFF * push / moment
    hit = t[FRAME] + share * (t[1] - t[0])
    after = t > hit
    swing = solve_ivp(
        lambda _, y: (y[1], -PLATE * G * LONG / moment * math.sin(y[0])), (hit, t[-1]), (0.0, rate), rtol=1e-10,
        t_eval=t[after],
    )  # fmt: skip
    angle, spin = np.zeros_like(t), np.zeros_like(t)
    angle[after], spin[after] = swing.y
    sine, cosine, none = np.sin(angle), np.cos(angle), 0.0 * t
    place = np.stack([-LONG * sine, none, TOP - LONG * cosine], axis=1)
    velocity = np.stack([-LONG * cosine * spin, none, LONG * sine * spin], axis=1)
    since = t - hit
    speed = np.where(after, push / BALL - FALL, -FALL)
    height = TOP - LONG + THICK / 2 + RADIUS + speed * since - G * since**2 / 2
    falling = np.stack([none + OFF, none, height], axis=1), np.stack([none, none, speed - G * since], axis=1)
    joint = Joint(
        prim="/World/pin", kind="spherical", parent=None, child="/World/plate", parent_anchor=(0.0, 0.0, TOP),
        child_anchor=(0.0, 0.0, LONG),
    )  # fmt: skip
    rotation = np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], axis=1)
    return record(
        [plate, ball(mass=BALL)], np.stack([place, falling[0]], axis=1), np.stack([velocity, falling[1]], axis=1), t,
        rotation=np.stack([rotation, np.tile([0.0, 0.0, 0.0, 1.0], (len(t), 1))], axis=1),
        spin=np.stack([np.stack([none, spin, none], axis=1), np.zeros((len(t), 3))], axis=1), joints=[joint],
    )  # fmt: skip


def off(recording):
    return [finding.message for finding in ask(CheckForces(), recording) if not finding.passed]


@pytest.mark.parametrize("share", [0.02, 0.1, 0.5, 0.9])
def test_a_pin_passes_a_blow_on_as_the_plate_hung_at_its_instant(share):
    """Whenever it comes; soon after a frame the plate turns by 0.12 rad before the next."""
    assert off(struck(share)) == []


@pytest.mark.parametrize("share", [0.02, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("error", [-0.15, 0.15])
def test_a_seventh_of_the_rate_from_nowhere_is_found(share, error):
    """What hides less is 0.03 of the change of velocity, and which way the plate's face is as the ball meets it."""
    assert off(struck(share, error)) != []
