"""How the slip is guessed that a solution will leave."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.slips import extrapolated, seek_slip

NEAR = (ContactConfig().tolerance, ContactConfig().rough)  # [m/s]
slopes = st.floats(-5.0, 0.94)
slips = st.floats(0.1, 10.0)


@given(slopes, slips, st.floats(0.0, 5.0), st.integers(1, 4))
def test_two_solutions_tell_where_what_is_left_is_the_guess(slope, fixed, first, contacts):
    """Where it goes with the guess by a straight line, for all contacts of a body alike."""
    guess = np.full(contacts, first)
    left = fixed + slope * (guess - fixed)
    bodies = np.tile([0, 1], (contacts, 1))
    again = extrapolated(guess, left, (guess, left), bodies)
    assert again == pytest.approx(np.maximum(left, 0.0))  # of one solution, what it left
    if np.abs(again - guess).max() < 1e-3:
        return
    left_again = fixed + slope * (again - fixed)
    assert extrapolated(again, left_again, (guess, left), bodies) == pytest.approx(fixed, rel=1e-5)


@given(st.lists(st.tuples(slopes, slips, st.floats(0.0, 5.0)), min_size=2, max_size=5))
def test_bodies_that_do_not_touch_each_other_do_not_count(of_each):
    slope, fixed, guess = (np.array(values) for values in zip(*of_each, strict=True))
    bodies = np.stack([np.zeros(len(slope), dtype=int), np.arange(1, len(slope) + 1)], axis=1)
    left = fixed + slope * (guess - fixed)
    again = np.maximum(left, 0.0)
    left_again = fixed + slope * (again - fixed)
    found = extrapolated(again, left_again, (guess, left), bodies)
    told = np.abs(again - guess) > 1e-3
    assert found[told] == pytest.approx(fixed[told], rel=1e-5)


def test_a_body_s_contacts_are_weighed_together():
    """Two whose slips change each other's: the share is that of least squares, not each contact's own."""
    turn = np.array([[-0.5, -0.3], [-0.4, 0.1]])
    fixed = np.array([2.0, 1.0])

    def leave(guess):
        return fixed + turn @ (guess - fixed)

    bodies, first = np.array([[0, 1], [0, 1]]), np.array([1.0, 1.5])
    second = leave(first)
    found = extrapolated(second, leave(second), (first, second), bodies)
    rest, before = leave(second) - second, second - first
    shares = np.linspace(0.0, 1.0, 10001)
    left = [np.linalg.norm((1 - share) * rest + share * before) for share in shares]
    share = shares[int(np.argmin(left))]
    assert found == pytest.approx((1 - share) * leave(second) + share * second, abs=1e-3)


@given(st.floats(-0.9, 0.94), slips, st.floats(0.0, 1.9))
def test_a_line_takes_three_solutions(slope, fixed, first):
    """A guess, what it leaves, and where the line through both has its fixed point; none is asked for twice."""
    asked = []

    def leave(guess):
        asked.append(float(guess[0]))
        return fixed + slope * (guess - fixed)

    seek_slip(leave, np.full(2, first * fixed), np.tile([0, 1], (2, 1)), False, ContactConfig(), NEAR)
    assert asked[-1] == pytest.approx(fixed, abs=20 * ContactConfig().rough)
    assert len(asked) <= 3 and len(set(asked)) == len(asked)


def test_of_guesses_that_none_settles_the_nearest_counts():
    """What is left jumps: no guess is left as it was."""
    asked = []

    def leave(guess):
        asked.append(guess)
        return np.where(guess < 1.0, 3.0, 0.0)

    seek_slip(leave, np.array([0.0]), np.array([[0, 1]]), False, ContactConfig(), NEAR)
    assert len(asked) == ContactConfig().most_solutions + 1
    off = [float(abs(leave(guess) - guess)[0]) for guess in list(asked)]
    assert off[-1] == min(off) < 2.0
