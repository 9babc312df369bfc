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
    impulse: wp.array(dtype=wp.spatial_vector),
    work: wp.array(dtype=wp.float32),
):
    """Add a step's impulse [N s, N m s] and work [J] on each body; the work is that of the mean of the two twists."""
    body = wp.tid()
    push = body_f[body]
    impulse[body] = impulse[body] + push * dt
    work[body] = work[body] + 0.5 * dt * wp.dot(push, before[body] + after[body])


@wp.kernel(enable_backward=False)
def accumulate_control(
    # Data in:
    force: wp.array(dtype=wp.spatial_vector),
    dt: float,
    # Data out:
    impulse: wp.array(dtype=wp.spatial_vector),
):
    """Add a step's impulse of control on each body [N s, N m s]."""
    body = wp.tid()
    impulse[body] = impulse[body] + force[body] * dt


@wp.kernel(enable_backward=False)
def accumulate_drive(
    # Data in:
    effort: wp.array(dtype=wp.float32),  # of the drives at the step's end
    joint_f: wp.array(dtype=wp.float32),  # of the controller
    armature: wp.array(dtype=wp.float32),  # of rotors, which keep a part
    stiffness: wp.array(dtype=wp.float32),  # of the drives
    strength: wp.array(dtype=wp.float32),
    first_order: bool,
    before: wp.array(dtype=wp.float32),
    after: wp.array(dtype=wp.float32),
    dt: float,
    # Data out:
    last: wp.array(dtype=wp.float32),  # effort as it was told a step ago
    work: wp.array(dtype=wp.float32),
    unsure: wp.array(dtype=wp.float32),
):
    """Add a step's work [J] on each degree of freedom, and what the effort's change in the step leaves open of it.

    The effort is taken as the mean of both ends (trapezoidal rule), which is right but for the product of both changes.
    A step of first order takes a drive's spring as it was at its start, and its damper as it is at its end. What rotors
    gain in the step does not come to the bodies.
    """
    dof = wp.tid()
    change = effort[dof] - last[dof]
    mean = 0.5 * (before[dof] + after[dof])
    push = effort[dof] - 0.5 * change
    if first_order:
        push = wp.clamp(effort[dof] + stiffness[dof] * dt * after[dof], -strength[dof], strength[dof])
    open_ = wp.abs(change * (after[dof] - before[dof]))
    spun = armature[dof] * mean * (after[dof] - before[dof])
    work[dof] = work[dof] + dt * (push + joint_f[dof]) * mean - spun
    unsure[dof] = unsure[dof] + dt * open_
    last[dof] = effort[dof]


@wp.kernel(enable_backward=False)
def shift_effort(
    # Data in:
    dof: wp.array2d(dtype=int),
    moved: wp.array2d(dtype=float),  # by how much each target did [rad or m]
    stiffness: wp.array(dtype=float),  # of each degree of freedom
    strength: wp.array(dtype=float),
    # Data out:
    last: wp.array(dtype=float),
):
    """Take along, with a drive's target that jumps between two steps, the effort that its next change is from."""
    world, joint = wp.tid()
    at = dof[world, joint]
    jumped = moved[world, joint]
    if jumped != 0.0:
        last[at] = wp.clamp(last[at] + stiffness[at] * jumped, -strength[at], strength[at])
