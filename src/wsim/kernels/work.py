"""Sums, over the steps of a frame, what pushes bodies and joints from outside, and the work it does."""

import warp as wp


@wp.kernel(enable_backward=False)
def accumulate_push(
    # Data in:
    body_f: wp.array(dtype=wp.spatial_vector),  # force and torque at the centre of mass, world
    before: wp.array(dtype=wp.spatial_vector),  # twist at the step's start
    after: wp.array(dtype=wp.spatial_vector),  # and at its end
    dt: float,
    # Data out:
    impulse: wp.array(dtype=wp.vec3),
    work: wp.array(dtype=wp.float32),
):
    """Add a step's impulse [N s] and work [J] on each body; the work is that of the mean of the two twists."""
    body = wp.tid()
    push = body_f[body]
    impulse[body] = impulse[body] + wp.spatial_top(push) * dt
    work[body] = work[body] + 0.5 * dt * wp.dot(push, before[body] + after[body])


@wp.kernel(enable_backward=False)
def accumulate_drive(
    # Data in:
    effort: wp.array(dtype=wp.float32),  # of the drives
    joint_f: wp.array(dtype=wp.float32),  # of the controller
    before: wp.array(dtype=wp.float32),
    after: wp.array(dtype=wp.float32),
    dt: float,
    # Data out:
    work: wp.array(dtype=wp.float32),
):
    """Add a step's work [J] on each degree of freedom."""
    dof = wp.tid()
    work[dof] = work[dof] + 0.5 * dt * (effort[dof] + joint_f[dof]) * (before[dof] + after[dof])
