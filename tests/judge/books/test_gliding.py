"""What rolls or slides on is carried by what it touches; what it never comes to carries nothing."""

import numpy as np
import pytest

from tests.judge.theory import EDGE, RADIUS, G, ask, ball, box, edited, ground, record, sliding, times
from wsim.judge.checks.forces import CheckForces
from wsim.scene.world import Shape, Static


def off(recording):
    return [finding for finding in ask(CheckForces(), recording) if not finding.passed]


def rolling(speed=2.0, rate=30.0, statics=None, **bodies):
    """A ball that rolls along the ground."""
    t = times(1.2, rate)
    none = 0.0 * t
    places = np.stack([speed * t, none, none + RADIUS], 1)
    velocity, spin = np.stack([none + speed, none, none], 1), np.stack([none, none + speed / RADIUS, none], 1)
    half = 0.5 * speed / RADIUS * t
    turn = np.stack([none, np.sin(half), none, np.cos(half)], 1)
    statics = [ground()] if statics is None else statics
    return record([ball(**bodies)], places, velocity, t, rotation=turn, spin=spin, statics=statics)


def lifted(recording, by):
    return edited(recording, "body_q", (slice(None), 0, 2), by)


@pytest.mark.parametrize("gap", [0.0, 1e-5])
def test_what_rolls_on_the_ground_is_sound(gap):
    assert off(lifted(rolling(), gap)) == []


@pytest.mark.parametrize("gap", [2e-3, 4e-3, 8e-3])
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_what_rolls_above_the_ground_is_found(gap, speed):
    """In a frame of 1/30 s it would fall by 5.4 mm: it could come to the ground from there, and back from 1.4 mm."""
    assert off(lifted(rolling(speed), gap))[-1].value == pytest.approx(4.0 * G, rel=0.01)


def test_what_slides_above_the_ground_is_found():
    pulled = sliding(0.5 * G)
    assert off(pulled) == []
    found = off(lifted(pulled, 2e-3))
    assert "too far away" in found[-1].message


def test_what_hops_once_a_frame_is_sound():
    """A ball that bounces with the frames' period is seen in the air each time, at a height of up to g h^2 / 8."""
    t = times(1.2)
    none, up = 0.0 * t, G * (t[1] - t[0]) ** 2 / 8.0
    hop = record([ball()], np.stack([2.0 * t, none, none + RADIUS + 0.9 * up], 1),
                 np.stack([none + 2.0, none, none], 1), t, statics=[ground(0.0)])  # fmt: skip
    assert not any("too far away" in finding.message for finding in off(hop))
    assert any("too far away" in finding.message for finding in off(lifted(hop, 0.7 * up)))


def test_what_may_be_carried_by_a_mesh_is_not_asked():
    """Its triangles may stand for what is curved."""
    corners = [(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)]
    flat = Shape(
        prim="/World/m/g",
        kind="mesh",
        size=(),
        vertices=corners,
        triangles=[(0, 1, 2), (0, 2, 3)],
        exact=True,
        friction=0.5,
    )
    above = lifted(rolling(statics=[Static(prim="/World/m", shapes=[flat])]), 1e-3)
    assert not any("too far away" in finding.message for finding in off(above))


def test_what_may_be_carried_by_what_goes_along_is_not_asked():
    """A box that goes under it all the while, unseen between the frames as it may be, may hold it up."""
    t = times(1.2)
    none = 0.0 * t
    places = np.stack([np.stack([t, none, none + 3 * EDGE / 2 + 1e-3], 1), np.stack([t, none, none + EDGE / 2], 1)], 1)
    speeds = np.tile([1.0, 0.0, 0.0], (len(t), 2, 1))
    recording = record([box(), box("under", kinematic=True)], places, speeds, t, statics=[ground()])
    assert not any("too far away" in finding.message for finding in off(recording))
