"""Which fluid is about to go where what stands still has no particles yet."""

import warp as wp

from wsim.kernels.sph.openings import ACTIVE

BITS = 15  # of a tile's number along each axis; the world's come above
HALF = wp.constant(1 << (BITS - 1))
SPAN = wp.constant(1 << BITS)
MOST_HOPS = wp.constant(64)  # that a particle's way is looked at in


@wp.func
def tile_axis(x: float, inv_tile: float) -> int:
    """Number of a tile along an axis; there are no more beyond the last one."""
    return int(wp.clamp(wp.floor(x * inv_tile) + float(HALF), 0.0, float(SPAN - 1)))


@wp.func
def tile_key(world: int, ix: int, iy: int, iz: int) -> wp.int64:
    """One number for a tile of a world."""
    span = wp.int64(SPAN)
    return ((wp.int64(world) * span + wp.int64(ix)) * span + wp.int64(iy)) * span + wp.int64(iz)


@wp.func
def _is_home(home: wp.array(dtype=wp.int64), key: wp.int64) -> bool:
    k = wp.lower_bound(home, key)
    if k >= home.shape[0]:
        return False
    return home[k] == key


@wp.func
def _in_hollow(
    first: int, last: int, pose: wp.array(dtype=wp.transform), half: wp.array(dtype=wp.vec3), x: wp.vec3
) -> bool:  # fmt: skip
    inside = bool(False)
    for k in range(first, last):
        own = wp.transform_point(wp.transform_inverse(pose[k]), x)
        if wp.abs(own[0]) <= half[k][0] and wp.abs(own[1]) <= half[k][1] and wp.abs(own[2]) <= half[k][2]:
            inside = True
    return inside


@wp.kernel(enable_backward=False)
def find_strays(
    # Data in:
    particle_world: wp.array(dtype=int),
    flags: wp.array(dtype=int),
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    gravity: wp.array(dtype=wp.vec3),  # of each world [m/s^2]
    seconds: float,
    inv_tile: wp.vec3,  # [1/m]; 0 along an axis that is not cut
    guard: float,  # [m]; tiles so near to a particle's way must be home
    low: wp.vec3,  # corners of what is upright around all that stands still, as far out as a kernel reaches [m]
    high: wp.vec3,
    hollow_first: wp.array(dtype=int),  # (W + 1,): where each world's hollows begin
    hollow_pose: wp.array(dtype=wp.transform),
    hollow_half: wp.array(dtype=wp.vec3),
    home: wp.array(dtype=wp.int64),  # keys of tiles that are home, rising
    # Data out:
    stray: wp.array(dtype=wp.uint8),
    strays: wp.array(dtype=int),  # (W,): how many
):
    """Mark the particles whose way of the next seconds leads out of what is home: tiles, and hollows of tanks.

    Gravity alone bends it. What waits for a tap goes nowhere. What is far from all that stands still is home, too, and
    what is not finite is nowhere.
    """
    i = wp.tid()
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    fall = 0.5 * seconds * seconds * gravity[world]
    stray[i] = wp.uint8(0)
    if (flags[i] & ACTIVE) == 0 or not wp.isfinite(wp.dot(x, x) + wp.dot(v, v)):
        return
    hops = int(wp.clamp(wp.ceil((seconds * wp.length(v) + wp.length(fall)) / guard), 1.0, float(MOST_HOPS)))
    for hop in range(hops + 1):
        share = float(hop) / float(hops)
        y = x + share * seconds * v + share * share * fall
        near = bool(True)
        for axis in range(3):
            if y[axis] < low[axis] or y[axis] > high[axis]:
                near = False
        if near and not _in_hollow(hollow_first[world], hollow_first[world + 1], hollow_pose, hollow_half, y):
            for corner in range(8):
                cx = tile_axis(y[0] + guard * float(2 * (corner % 2) - 1), inv_tile[0])
                cy = tile_axis(y[1] + guard * float(2 * (corner / 2 % 2) - 1), inv_tile[1])
                cz = tile_axis(y[2] + guard * float(2 * (corner / 4) - 1), inv_tile[2])
                if not _is_home(home, tile_key(world, cx, cy, cz)):
                    stray[i] = wp.uint8(1)
    if stray[i] != wp.uint8(0):
        wp.atomic_add(strays, world, 1)
