"""A ball that spins fast goes several radii between two frames: where it is hit it has the surface of a ball there."""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, ground, record, times
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.evidence.evidence import Evidence
from wsim.recording.contacts import ContactTrack

MASS, ALONG, FALLS, HIT = 4.0, 12.0, 5.0, 6  # [kg], [m/s], [m/s] as it lands, and the frame just after which it does


def landing(kept):
    """It spins as it goes, lands without a bounce at the start of an interval, and keeps so much of its speed then."""
    t = times(0.5)
    since = t - t[HIT]
    before = since <= 0.0
    speed = np.where(before, ALONG, kept * ALONG)
    fall = np.where(before, -FALLS - G * since, 0.0)
    high = RADIUS + np.where(before, -FALLS * since - G * since**2 / 2.0, 0.0)
    none = 0.0 * t
    pressed = np.where(before, 0.0, MASS * G / 30.0)
    pressed[HIT + 1] += MASS * FALLS
    frames = np.flatnonzero(pressed).astype(np.int32)
    sums = np.zeros((len(frames), 16), np.float32)
    place = np.stack([speed * since, none, high], 1)
    for row, k in zip(sums, frames, strict=True):
        at = place[HIT] if k == HIT + 1 else 0.5 * (place[k - 1] + place[k])
        row[2], row[3], row[6], row[7] = pressed[k], pressed[k], pressed[k], pressed[k] * at[0]
    # Shapes: the ball's, then the ground's. The first of the pair is the ground's.
    track = ContactTrack(frames, np.tile(np.array([1, 0], np.int32), (len(frames), 1)), sums)
    velocity = np.stack([speed, none, fall], 1)
    spin = np.stack([none, ALONG * kept ** (~before) / RADIUS, none], 1)
    return record([ball()], place, velocity, t, spin=spin, statics=[ground()], contacts=track)


def test_its_surface_meets_the_ground_as_fast_as_it_falls():
    evidence = Evidence(landing(1.0))
    slip = RecordedContacts(evidence, evidence.recording.contacts).slip
    assert slip[0, 0] == pytest.approx([0.0, 0.0, -FALLS], abs=1e-5)
    assert slip[1:] == pytest.approx(np.zeros((len(slip) - 1, 2, 3)), abs=1e-4)  # it rolls on


@pytest.mark.parametrize(("kept", "holds"), [(1.0, True), (0.9, False)])
def test_a_blow_takes_what_it_falls_with_and_no_more(kept, holds):
    wrong = [finding.message for finding in ask(CheckEnergy(), landing(kept)) if not finding.passed]
    assert (wrong == []) == holds, wrong
