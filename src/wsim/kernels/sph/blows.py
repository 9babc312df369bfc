"""Blows that bodies' faces get from fluid, as impulses in whole numbers of a quantum."""

import warp as wp


@wp.func
def velocity_at(twist: wp.spatial_vector, arm: wp.vec3) -> wp.vec3:
    """Of a point of a body, `arm` off its centre of mass [m/s]."""
    return wp.spatial_top(twist) + wp.cross(wp.spatial_bottom(twist), arm)


@wp.func
def count_blow(impulse: wp.array2d(dtype=wp.int64), body: int, first: int, j: wp.vec3, quantum: float):
    """Add an impulse, or its moment, to a body's from column `first` on."""
    for axis in range(3):
        wp.atomic_add(impulse, body, first + axis, wp.int64(wp.rint(wp.float64(j[axis]) / wp.float64(quantum))))


@wp.kernel(enable_backward=False)
def add_blows(
    # Data in:
    quantum: float,  # [N s]
    spacing: float,
    dt: float,
    # Data in and out:
    impulse: wp.array2d(dtype=wp.int64),
    body_wrench: wp.array(dtype=wp.spatial_vector),
    body_f: wp.array(dtype=wp.spatial_vector),
):
    """Add what fluid gave to bodies' faces to the wrenches on them, and begin anew."""
    body = wp.tid()
    force = wp.vec3(0.0, 0.0, 0.0)
    torque = wp.vec3(0.0, 0.0, 0.0)
    per = wp.float64(quantum) / wp.float64(dt)
    for axis in range(3):
        force[axis] = float(wp.float64(impulse[body, axis]) * per)
        torque[axis] = float(wp.float64(impulse[body, axis + 3]) * per * wp.float64(spacing))
        impulse[body, axis] = wp.int64(0)
        impulse[body, axis + 3] = wp.int64(0)
    wrench = wp.spatial_vector(force, torque)
    body_wrench[body] = body_wrench[body] + wrench
    body_f[body] = body_f[body] + wrench
