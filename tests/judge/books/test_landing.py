"""A cube that slides and rocks lands on one corner after another between two frames, and no frame shows its slips.

Each landing is Newton's and Coulomb's, at single points: of a cube about its centre the mass that a corner feels is
known, and between landings it falls and turns at one rate.
"""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, box, ground, record, times
from wsim.geometry.rotations import matrices, multiply
from wsim.judge.books.forces import Poses
from wsim.judge.books.landing import keeps_way, landing
from wsim.judge.books.touching import Touching
from wsim.judge.checks.forces import CheckForces
from wsim.judge.evidence.evidence import Evidence

MU, E, EDGE, SPEED = 0.3, 0.7, 0.02, 0.5
CORNERS = 0.5 * EDGE * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
STEPS = 400  # of a frame


def rocking(*, friction=MU, pull=0.0, seconds=0.3, rate=120.0):
    """A cube let go just above the ground on which it then slides, tilted; pulled aside by `pull` of its weight."""
    t, dt = times(seconds, rate), 1.0 / rate / STEPS
    turn = np.array([0.06, 0.04, 0.3, 0.0])
    turn[3] = np.sqrt(1.0 - turn @ turn)
    x = np.array([0.0, 0.0, 1e-4 - (CORNERS @ matrices(turn).T)[:, 2].min()])
    v, w = np.array([SPEED, 0.1, 0.0]), np.zeros(3)
    found = [(x, turn, v, w)]
    for _ in t[1:]:
        for _ in range(STEPS):
            v = v + dt * G * np.array([0.0, pull, -1.0])
            x, angle = x + dt * v, 0.5 * dt * w
            turn = multiply(np.append(angle, 1.0), turn)
            turn /= np.linalg.norm(turn)
            for arm in CORNERS @ matrices(turn).T:
                if x[2] + arm[2] < 0.0 and (v + np.cross(w, arm))[2] < 0.0:
                    v, w = landed(v, w, arm, friction)
        found.append((x, turn, v, w))
    place, way, speed, spin = (np.array(each) for each in zip(*found, strict=True))
    floor, cube = ground(MU), box(size=(EDGE,) * 3, mass=1.0, friction=MU)
    return record([cube], place, speed, t, rotation=way, spin=spin, statics=[floor])


def landed(v, w, arm, friction):
    """The velocities after a corner met the ground; of a cube of mass 1."""
    inertia = EDGE**2 / 6.0
    cross = np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
    felt = np.eye(3) - cross @ cross / inertia  # change of the corner's velocity by an impulse on it
    u = v + np.cross(w, arm)
    wanted = np.array([0.0, 0.0, -E * u[2]])
    push = np.linalg.solve(felt, wanted - u)  # it sticks
    if np.linalg.norm(push[:2]) > friction * push[2]:
        way = np.append(-friction * u[:2] / np.linalg.norm(u[:2]), 1.0)
        push = -(1.0 + E) * u[2] / (felt @ way)[2] * way
    return v + push, w + np.cross(arm, push) / inertia


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


def test_what_lands_by_the_laws_is_accepted():
    assert accepted(rocking())


@pytest.mark.parametrize("friction", [0.27, 0.33])
def test_friction_that_is_not_stated_is_found(friction):
    assert not accepted(rocking(friction=friction))


def test_a_pull_is_found():
    assert not accepted(rocking(pull=0.1))


@pytest.mark.parametrize(
    ("gap", "down", "expected"),
    [(1e-3, 0.5, np.hypot(0.5, np.sqrt(2e-3 * G))), (1e-3, 0.05, np.hypot(0.05, np.sqrt(2e-3 * G))),
     (5e-5, 0.5, 0.5), (0.02, 0.5, 0.0), (0.0, 0.0, 0.0),
     (1e-3, -0.03, np.hypot(0.03, np.sqrt(2e-3 * G))), (1e-3, -0.05, 0.0), (5e-5, -0.03, 0.0)],
)  # fmt: skip
def test_only_what_meets_within_the_interval_lands(gap, down, expected):
    """All of its speed is changed on the ground, and of its fall; none of what lies there, or comes down later.

    What rises at 0.03 m/s from a gap of 1 mm is back after 17 ms, at 0.05 m/s after 20.2.
    """
    t = times(0.1)
    place, speed = (np.tile(each, (len(t), 1)) for each in ((0.0, 0.0, RADIUS + gap), (3.0, 0.0, -down)))
    evidence = Evidence(record([ball()], place, speed, t, statics=[ground()]))
    touching, motion = Touching.of(evidence), evidence.motion
    poses = Poses(evidence.body_q[0], motion.com[0], motion.v[0], motion.w[0])
    contacts = touching.at(poses.q, 0.05)
    landed = landing(touching, contacts, poses, np.array([0.02]), motion.mass)
    assert landed == pytest.approx([expected], abs=1e-5)
    assert keeps_way(contacts, np.array([3.0]), landed) == (expected == 0.0)


@pytest.mark.parametrize(("bounce", "expected"), [(0.5, 0.3 * 3.0), (0.25, 0.3 * 5.0), (None, 0.0)])
def test_what_parts_has_landed_as_fast_as_its_bounce_has_it(bounce, expected):
    """It met at v / e and parts at v: changed by (1 + 1 / e) v on the ground; what does not bounce parts unpushed."""
    t = times(0.1)
    body = ball()
    shapes = [body.shapes[0].model_copy(update={"restitution": bounce})]
    place, speed = (np.tile(each, (len(t), 1)) for each in ((0.0, 0.0, RADIUS + 1e-3), (0.0, 0.0, 0.3)))
    evidence = Evidence(record([body.model_copy(update={"shapes": shapes})], place, speed, t, statics=[ground()]))
    touching, motion = Touching.of(evidence), evidence.motion
    poses = Poses(evidence.body_q[1], motion.com[1], motion.v[1], motion.w[1])
    landed = landing(touching, touching.at(poses.q, 0.05), poses, np.array([0.02]), motion.mass, 1)
    assert landed == pytest.approx([expected], rel=1e-5)
