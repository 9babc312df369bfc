"""Planks stacked in a helix, with poses from numpy rotation matrices."""
import numpy as np
from numpy import cos, deg2rad, pi, sin
from numpy.linalg import norm

from wsim.scene import Scene


def rotation_z(angle: float) -> np.ndarray:
    c, s = cos(angle), sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def build(scene: Scene) -> None:
    scene.ground()
    n, step = 14, deg2rad(15.0)
    thickness = 0.04
    offset = np.array([0.02, 0.0, 0.0])
    for k in range(n):
        R = rotation_z(k * step)
        center = R @ offset + np.array([0, 0, (k + 0.5) * (thickness + 1e-3)])
        yaw = np.rad2deg(np.arctan2(R[1, 0], R[0, 0]))
        assert np.isclose(np.linalg.det(R), 1.0)
        scene.box(f"plank_{k}", size=(0.6, 0.15, thickness), position=center, rotation_deg=(0, 0, yaw), density=550)
    eye = np.array([2.0, -2.0, 1.0])
    eye *= 3.0 / norm(eye)
    scene.camera("corner", eye=tuple(eye), target=(0.0, 0.0, thickness * n / 2), fov=float(np.clip(50.0, 10, 2 * pi * 10)))
