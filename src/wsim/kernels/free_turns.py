"""How a rigid body turns of itself, in double precision."""

import warp as wp

LARGEST_TURN = wp.constant(wp.float64(0.05))  # [rad] of a part of a step
MOST_PARTS = wp.constant(1000)


@wp.func
def about(axis: wp.vec3d, angle: wp.float64) -> wp.quatd:
    """The turn about a unit vector."""
    half = wp.float64(0.5) * angle
    return wp.quatd(axis * wp.sin(half), wp.cos(half))


@wp.func
def turned_by(vector: wp.vec3d) -> wp.quatd:
    """The turn about a vector by its length [rad]."""
    angle = wp.length(vector)
    if angle > wp.float64(0.0):
        return about(vector / angle, angle)
    return wp.quatd(wp.float64(0.0), wp.float64(0.0), wp.float64(0.0), wp.float64(1.0))


@wp.func
def free_turn(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d, h: wp.float64) -> wp.quatd:
    """How a rigid body turns in `h` [s] if nothing acts on it, from its spin, in its own axes.

    The energy is |L|^2 / 2 I_2 plus a part of L_1 and one of L_3 alone, the moments in rising order. Each part turns
    the body about one axis, that of the first about L itself; these turns, put together symmetrically (Touma and Wisdom
    1994), keep the momentum and add no energy over time, and of a body with two equal moments they are the motion.
    """
    momentum = wp.cw_mul(moments, wp.quat_rotate_inv(principal, spin))
    turning = wp.length(spin) * h / LARGEST_TURN
    parts = MOST_PARTS
    if turning < wp.float64(MOST_PARTS):
        parts = wp.max(1, int(wp.ceil(turning)))
    s = h / wp.float64(parts)
    none = wp.float64(0.0)
    one = wp.float64(1.0)
    first, third = wp.vec3d(one, none, none), wp.vec3d(none, none, one)
    k1 = wp.float64(0.5) * s * (one / moments[0] - one / moments[1])
    k3 = s * (one / moments[2] - one / moments[1])
    turn = wp.quatd(none, none, none, one)
    for _ in range(parts):
        a = about(first, k1 * momentum[0])
        momentum = wp.quat_rotate_inv(a, momentum)
        b = about(third, k3 * momentum[2])
        momentum = wp.quat_rotate_inv(b, momentum)
        c = about(first, k1 * momentum[0])
        momentum = wp.quat_rotate_inv(c, momentum)
        turn = turn * a * b * c
    turn = turn * turned_by(momentum * (h / moments[1]))
    return principal * turn * wp.quat_inverse(principal)


@wp.func
def in_axes(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d) -> wp.vec3d:
    """Angular momentum about the centre of mass, in the body's axes."""
    return wp.quat_rotate(principal, wp.cw_mul(moments, wp.quat_rotate_inv(principal, spin)))


@wp.func
def spin_of(principal: wp.quatd, moments: wp.vec3d, momentum: wp.vec3d) -> wp.vec3d:
    """Spin of an angular momentum about the centre of mass, in the body's axes."""
    return wp.quat_rotate(principal, wp.cw_div(wp.quat_rotate_inv(principal, momentum), moments))


@wp.func
def spin_after(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d, turn: wp.quatd) -> wp.vec3d:
    """Spin with which a free body ends its turn, in its own axes."""
    return spin_of(principal, moments, wp.quat_rotate_inv(turn, in_axes(principal, moments, spin)))
