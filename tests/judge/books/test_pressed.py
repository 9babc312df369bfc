"""A card on the ground that is struck: its edge is pressed on the ground, which answers by the laws of rigid bodies."""

import numpy as np
import pytest

from tests.judge.theory import box, ground, record, times
from wsim.judge.books.forces import Poses
from wsim.judge.books.pressed import pushed_back
from wsim.judge.books.touching import Contacts, Touching
from wsim.judge.evidence.evidence import Evidence

THICK, WIDE, TALL, MASS, MU = 0.02, 0.1, 0.2, 1.5, 0.4
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
NONE = np.zeros((1, 3))


def answer(height, *, bounce=2.0, rubs=NONE, edge=0.5 * THICK):
    """Of a card that is struck along X at a height over its middle, and touches the ground with one edge."""
    t = times(0.1)
    place = np.tile((0.0, 0.0, 0.5 * TALL), (len(t), 1))
    card = box(size=(THICK, WIDE, TALL), mass=MASS, friction=MU)
    evidence = Evidence(record([card], place, 0.0 * place, t, statics=[ground(MU)]))
    touching, motion = Touching.of(evidence), evidence.motion
    poses = Poses(evidence.body_q[0], motion.com[0], motion.v[0], motion.w[0])
    at = np.array([-0.5 * THICK, 0.0, 0.5 * TALL + height])
    blow, stands = (contact(-1, 0, point, way) for point, way in ((at, X), (np.array([edge, 0.0, 0.0]), Z)))
    return pushed_back(motion, touching, poses, blow, stands, bounce, rubs)


def contact(one, two, point, normal):
    rows = np.array([one]), np.array([two])
    return Contacts(*rows, np.array([[1, 0]]), point[None], normal[None], np.zeros(1))


def test_above_its_middle_the_far_edge_answers():
    """The impulse turns the card over that edge; by how much it meets the ground follows from both arms."""
    height, inertia = 0.05, MASS * (THICK**2 + TALL**2) / 12.0
    push = 2.0 / (1.0 / MASS + height**2 / inertia)
    passed = height * 0.5 * THICK / inertia  # of the blow's impulse, to how fast the edge goes down
    given = push * passed / (1.0 / MASS + (0.5 * THICK) ** 2 / inertia)
    along = 1.0 / MASS - height * 0.5 * TALL / inertia  # and to how it slips
    expected = given * (passed + MU * np.hypot(along, passed))
    assert answer(height) == pytest.approx(expected, rel=1e-5)
    assert answer(height, bounce=1.0) == pytest.approx(0.5 * expected, rel=1e-5)


def test_what_the_blow_lifts_does_not_answer():
    assert answer(0.05, edge=-0.5 * THICK) == 0.0
    assert answer(0.0) == pytest.approx(0.0, abs=1e-6)


def test_friction_that_presses_counts_and_friction_that_lifts_does_not():
    assert answer(0.0, rubs=np.array([-0.3 * Z])) > 0.0
    assert answer(0.0, rubs=np.array([0.3 * Z])) == pytest.approx(0.0, abs=1e-6)
