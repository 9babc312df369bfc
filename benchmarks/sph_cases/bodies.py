"""Rigid bodies beside the fluid of a case: their solver, and water that leaves room for them."""

from __future__ import annotations

from collections.abc import Iterator

import newton
import numpy as np
import warp as wp

from wsim.sim.rigid import ROWS_A_CONTACT, contact_capacity


def make_rigid(model: newton.Model) -> newton.solvers.SolverMuJoCo:
    """MuJoCo in C for one world on a CPU, MuJoCo Warp otherwise, with room for every contact that there can be."""
    if not model.device.is_cuda and model.world_count <= 1:
        return newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, use_mujoco_contacts=True)
    capacity = contact_capacity(model)
    return newton.solvers.SolverMuJoCo(
        model, use_mujoco_contacts=True, nconmax=capacity, njmax=ROWS_A_CONTACT * capacity + 64
    )


def add_body(builder: newton.ModelBuilder, center: tuple[float, float, float], plane: bool) -> int:
    """A loose body at `center` [m]; with `plane` one that moves in the x-z plane and turns about y alone.

    A plane's particles all stand at y = 0. A body that a contact tips out of the plane by a hair would carry its
    particles out of it, and the water after them.
    """
    pose = wp.transform(wp.vec3(*center), wp.quat_identity())
    if not plane:
        return builder.add_body(xform=pose)
    axis = newton.ModelBuilder.JointDofConfig.create_unlimited
    body = builder.add_link(xform=pose)
    joint = builder.add_joint_d6(
        -1,
        body,
        linear_axes=[axis(newton.Axis.X), axis(newton.Axis.Z)],
        angular_axes=[axis(newton.Axis.Y)],
        parent_xform=pose,
    )
    builder.add_articulation([joint])
    return body


def outside_box(position: np.ndarray, center: tuple[float, ...], half: tuple[float, ...]) -> np.ndarray:
    """Which positions [m], shape (n, 3), are outside an upright box of half edge lengths `half` [m]."""
    return (np.abs(position - np.array(center)) >= np.array(half)).any(axis=1)


def tilt(quaternion: np.ndarray) -> np.ndarray:
    """Angle between a body's z axis and the vertical [deg]; quaternions xyzw, shape (..., 4)."""
    x, y = quaternion[..., 0], quaternion[..., 1]
    return np.degrees(np.arccos(np.clip(1.0 - 2.0 * (x * x + y * y), -1.0, 1.0)))


def chunks(items: tuple, size: int) -> Iterator[tuple]:
    """The items, `size` at a time."""
    for first in range(0, len(items), size):
        yield items[first : first + size]
