"""Rotations against each other and against what is known."""

import math

import numpy as np
import pytest

from wsim.geometry.rotations import (
    conjugate,
    level,
    line_of_sight,
    matrices,
    mean_rotation,
    multiply,
    rotate,
    sides_of,
    tilt,
)


def about(axis: int, degrees: float) -> np.ndarray:
    half = math.radians(degrees) / 2
    return np.append(np.eye(3)[axis] * math.sin(half), math.cos(half))


def test_x_turned_about_z_is_y() -> None:
    assert rotate(about(2, 90.0), np.array([1.0, 0.0, 0.0])) == pytest.approx([0.0, 1.0, 0.0])


def test_a_product_turns_by_its_second_first() -> None:
    a, b = about(0, 40.0), about(2, 70.0)
    v = np.array([[0.3, -0.2, 0.9], [1.0, 2.0, 3.0]])
    assert rotate(multiply(a, b), v) == pytest.approx(rotate(a, rotate(b, v)))
    assert rotate(conjugate(a), rotate(a, v)) == pytest.approx(v)


def test_matrices_turn_as_quaternions_do() -> None:
    q = np.stack([about(0, 40.0), about(1, -20.0), multiply(about(0, 10.0), about(2, 100.0))])
    v = np.array([0.3, -0.2, 0.9])
    assert matrices(q) @ v == pytest.approx(rotate(q, v[None]))
    assert matrices(q[2]) == pytest.approx(matrices(q)[2])


def test_mean_rotation_ignores_sign() -> None:
    mean = mean_rotation(np.stack([about(0, 10.0), -about(0, 14.0)]))
    assert abs(mean @ about(0, 12.0)) == pytest.approx(1.0, abs=1e-6)


def test_who_looks_along_y_has_x_to_the_right() -> None:
    right, forward = line_of_sight((0.0, -4.0, 1.0), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    assert right == pytest.approx([1.0, 0.0, 0.0])
    assert forward == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize("target", [(0.0, 0.0, 1.0), (0.0, 0.0, -3.0), (0.0, 0.0, 0.0)])
def test_who_looks_along_up_or_at_oneself_has_a_right_all_the_same(target) -> None:
    right, forward = line_of_sight((0.0, 0.0, 0.0), target, (0.0, 0.0, 1.0))
    assert np.linalg.norm(right) == pytest.approx(1.0)
    assert np.linalg.norm(forward) == pytest.approx(1.0)
    assert right @ forward == pytest.approx(0.0)


def test_a_tilt_is_since_the_start_and_a_yaw_is_none() -> None:
    lying = about(0, 90.0)
    q = np.stack([lying, multiply(about(2, 50.0), lying), multiply(about(0, 30.0), lying)])
    assert tilt(q) == pytest.approx([0.0, 0.0, 30.0], abs=1e-5)


def test_level_axes_are_square_to_up_and_x_and_y_where_it_is_z():
    assert np.array_equal(sides_of(np.array([0.0, 0.0, 1.0])), np.eye(3)[:2])
    for up in (np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])):
        axes = np.vstack([sides_of(up), up])
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12) and np.linalg.det(axes) == pytest.approx(1.0)
        assert level(np.array([[1.0, 2.0, 3.0]]), up) @ up == pytest.approx(0.0, abs=1e-12)
