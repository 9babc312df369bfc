"""Mechanisms that are hit keep their books: a blow gives no energy, and what is adrift keeps its momenta."""

from functools import partial

import numpy as np
import pytest

from tests.sim.struck_worlds import LINK, MASS, Books, at_random, cable, chain

BOTH = pytest.mark.parametrize("worlds", [1, 2])  # MuJoCo in C, and in Warp
SECONDS = 0.02
SEEDS = (2, 5, 9, 15, 20, 21, 23, 28, 33, 37, 41, 52)


@BOTH
@pytest.mark.parametrize("restitution", [0.5, 1.0])
@pytest.mark.parametrize("kind", ["joint_revolute", "joint_spherical"])
def test_a_chain_that_a_ball_hits_gains_nothing(tmp_path, kind, restitution, worlds):
    """By a step of the first order after the blow five links gained 2 % on hinges, and 68 % in 0.02 s on ball joints,
    which the ball, off their middle, sets spinning at 300 rad/s."""
    books = Books(tmp_path, partial(chain, kind=kind, e=restitution, mu=0.6), SECONDS, worlds)
    assert books.kinetic.min() < 0.999 * books.kinetic.max()  # it is hit
    assert max(books.gain) < 2e-5


@BOTH
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_a_cable_that_a_ball_hits_gains_nothing(tmp_path, restitution, worlds):
    """It gained 7 % and 35 %."""
    assert max(Books(tmp_path, partial(cable, e=restitution), SECONDS, worlds).gain) < 2e-5


@BOTH
@pytest.mark.parametrize(("kind", "links"), [("joint_spherical", 3), ("joint_revolute", 3), ("joint_fixed", 2)])
@pytest.mark.parametrize("restitution", [0.0, 1.0])
def test_links_adrift_keep_their_momenta(tmp_path, kind, links, restitution, worlds):
    """Hit at an end, in the middle of its side: momentum, and angular momentum about the world's origin."""
    build = partial(chain, kind=kind, links=links, hung=False, at=links - 1, off=0.0, e=restitution, mu=0.4,
                    gravity=False)  # fmt: skip
    books = Books(tmp_path, build, SECONDS, worlds)
    assert np.ptp(books.v[:, 0, 0]) > 0.1  # the other end knows of it
    assert max(books.gain) < 2e-5
    assert max(books.drift) < (2e-5 if restitution else 1e-4)  # at 0 the ball pushes on, in steps of the first order


@BOTH
def test_two_links_take_a_blow_as_their_equations_have_it(tmp_path, worlds):
    """M (q' after - q' before) = J^T P with M of two hanging rods, J the arms of the ball's height, P by Newton's e."""
    speed, ball, restitution, joint = 3.0, 0.5, 0.6, LINK
    build = partial(chain, kind="joint_revolute", links=2, at=1, off=0.0, e=restitution, mu=0.0, speed=speed, mass=ball,
                    gravity=False)  # fmt: skip
    books = Books(tmp_path, build, 0.01, worlds, time_step=1e-4)
    inertia = books._inertia[0, 1, 1]
    across = MASS * (joint / 2) ** 2 + inertia
    mass = np.array([[across + MASS * joint**2, MASS * joint * joint / 2], [MASS * joint * joint / 2, across]])
    arm = np.array([joint, joint / 2 - 0.03])  # of the ball's height below the first hinge, for each link's own angle
    give = 1.0 / ball + arm @ np.linalg.solve(mass, arm)
    rates = np.linalg.solve(mass, arm) * (1.0 + restitution) * speed / give
    hit = int(np.argmax(books.v[:, 0, 0] > 1e-3 * speed))
    assert books.v[hit, 0, 0] == pytest.approx(rates[0] * joint / 2, rel=1e-3)
    assert books.v[hit, 1, 0] == pytest.approx(rates[0] * joint + rates[1] * joint / 2, rel=1e-3)
    assert books.v[hit, 2, 0] == pytest.approx(speed - (1.0 + restitution) * speed / give / ball, rel=1e-3)


@pytest.mark.parametrize(("seed", "worlds"), [*((seed, 1) for seed in SEEDS), *((seed, 2) for seed in SEEDS[:4])])
def test_mechanisms_at_random(tmp_path, seed, worlds):
    """Two to six links on any joints, hung or adrift, bent, and a ball or two: no step gives energy.

    What lies on what hit it goes by the first order: so a step gave 4e-4 in one of these worlds.
    """
    books = Books(tmp_path, partial(at_random, seed=seed), 0.12, worlds)
    assert books.gain[0] < 5e-4
