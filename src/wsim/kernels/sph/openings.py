"""Where water comes in and where it leaves: taps, rain, drains, the open ends of a channel.

All particles that a world will ever have are there from the start. Those that are not in it are parked: out of reach of
all others, and sorted into a cell that nothing comes near. A tap takes them from there and leads them along a pipe as
deep as a kernel reaches, at the speed of its flow, so that the water at its mouth has neighbours all around (the inlet
buffers of Tafuni et al. 2018). What the pipe's wall does is in
`pipes`. A drain leads away what has come through its face, and parks it. Water in pipes pushes
and is pushed, but goes its own way.

The `stage` of a particle is `FREE`, `PARKED`, 1 + the place at a mouth that it comes from, or -2 - the drain that it
leaves by.

Which parked particle is next follows from a scan in the order of their numbers: a run repeats bit for bit.
"""

import warp as wp

from wsim.kernels.schedules import Keys, sum_between
from wsim.kernels.sph.grid import PARKED
from wsim.kernels.sph.species import Species

FREE = wp.constant(0)  # of a particle's stage: it goes as the fluid's equations have it
ACTIVE = wp.constant(1)  # newton.ParticleFlags.ACTIVE
SHARES = wp.constant(wp.float64(1073741824.0))  # 2^30: integers add up in any order to the same


@wp.struct
class Taps:
    """T taps of all worlds, and the Q places at their mouths that particles come from, world by world."""

    pose: wp.array(dtype=wp.transform)  # (T,): of each mouth; water flows along its z
    half: wp.array(dtype=wp.vec2)  # (T,): half its width and height [m]; of a round one the radius, twice
    round: wp.array(dtype=int)
    area: wp.array(dtype=wp.float64)  # [m^2]
    layer: wp.array(dtype=wp.float64)  # from one layer of particles to the next along the flow [m]
    depth: wp.array(dtype=float)  # of its pipe [m]; 0 where there is none
    mass: wp.array(dtype=float)  # of a particle [kg]
    speed: wp.array(dtype=float)  # that water leaves at without a pipe [m/s]
    keys: Keys  # (T, 1, K): of the rate [m^3/s]
    tap: wp.array(dtype=int)  # (Q,): whose a place is
    place: wp.array(dtype=wp.vec3)  # in the mouth [m]
    phase: wp.array(dtype=wp.float64)  # how far its first particle has come at the start [layers]
    world: wp.array(dtype=int)  # (Q,)
    first: wp.array(dtype=int)  # (W + 1,): where each world's places begin
    place_first: wp.array(dtype=int)  # (T + 1,): where each tap's places begin
    tap_first: wp.array(dtype=int)  # (W + 1,): where each world's taps begin


@wp.struct
class Drains:
    """D drains of all worlds, world by world."""

    pose: wp.array(dtype=wp.transform)  # (D,): of each face; water flows along its z
    half: wp.array(dtype=wp.vec2)  # (D,): half its width and height [m]; of a round one the radius, twice
    round: wp.array(dtype=int)
    depth: wp.array(dtype=float)  # how far behind its face a particle is parked [m]
    falls: wp.array(dtype=int)  # whether water falls freely behind it, or goes on as it came
    first: wp.array(dtype=int)  # (W + 1,): where each world's begin


@wp.struct
class Tally:
    """What has come and gone in each world, in particles, and the mass that has left."""

    released: wp.array(dtype=int)
    drained: wp.array(dtype=int)
    missing: wp.array(dtype=int)  # that were due while none was parked
    drained_mass: wp.array(dtype=wp.int64)  # [unit / 2^30]
    unit: wp.array(dtype=wp.float64)  # [kg]


@wp.kernel(enable_backward=False)
def run_taps(
    # Data in:
    taps: Taps,
    h: wp.float64,
    # Data in and out:
    clock: wp.array(dtype=wp.float64),  # (T,) [s]
    poured: wp.array(dtype=wp.float64),  # (T,) [m^3]
    # Data out:
    travel: wp.array(dtype=wp.float64),  # (T,): how far water in each pipe goes in this step, in the mean [m]
    before: wp.array(dtype=wp.float64),  # (T,): layers that had gone at its start
):
    """Let each tap's clock go on by a step of `h` [s]."""
    t = wp.tid()
    before[t] = poured[t] / (taps.area[t] * taps.layer[t])
    clock[t] = clock[t] + h
    total = sum_between(taps.keys, t, 0, wp.float64(0.0), clock[t])[0]
    travel[t] = (total - poured[t]) / taps.area[t]
    poured[t] = total


@wp.func
def within(half: wp.vec2, is_round: int, x: wp.vec3) -> bool:
    """Whether a place in the frame of a mouth or a face is before or behind it."""
    if is_round != 0:
        return x[0] * x[0] + x[1] * x[1] <= half[0] * half[0]
    return wp.abs(x[0]) <= half[0] and wp.abs(x[1]) <= half[1]


@wp.kernel(enable_backward=False)
def take_in(
    # Data in:
    particle_world: wp.array(dtype=int),
    mass: wp.array(dtype=float),
    position: wp.array(dtype=wp.vec3),
    drains: Drains,
    # Data in and out:
    stage: wp.array(dtype=int),
    # Data out:
    tally: Tally,
):
    """Let what has come through the face of a drain leave by it; before walls put it back, where it is in one."""
    i = wp.tid()
    if stage[i] != FREE:
        return
    world = particle_world[i]
    for d in range(drains.first[world], drains.first[world + 1]):
        own = wp.transform_point(wp.transform_inverse(drains.pose[d]), position[i])
        if own[2] > 0.0 and own[2] <= drains.depth[d] and within(drains.half[d], drains.round[d], own):
            stage[i] = -2 - d  # and ACTIVE still, until this step has led it
            wp.atomic_add(tally.drained, world, 1)
            share = wp.float64(mass[i]) / tally.unit[world] * SHARES
            wp.atomic_add(tally.drained_mass, world, wp.int64(wp.rint(share)))
            return


@wp.kernel(enable_backward=False)
def lead_water(
    # Data in:
    fluid: Species,
    gravity: wp.array(dtype=wp.vec3),
    mass: wp.array(dtype=float),
    parking: wp.vec3,
    taps: Taps,
    travel: wp.array(dtype=wp.float64),
    drains: Drains,
    dt: float,
    # Data in and out:
    stage: wp.array(dtype=int),
    flags: wp.array(dtype=int),
    # Data out:
    tally: Tally,
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float),
    on_walls: wp.array(dtype=wp.vec3),
    given: wp.array(dtype=wp.vec3),
):
    """Move the water in pipes, whatever walls they are in: let out what has come to a mouth, park what has left.

    `fluid` has the positions and velocities that this step began with. `given` is what the free water gets [N]: against
    the push of it and of bodies on what is in pipes, and the momentum that comes and goes with particles.
    """
    s = wp.tid()
    i = fluid.order[s]
    at = stage[i]
    given[i] = wp.vec3(0.0, 0.0, 0.0)
    if at == FREE:
        return
    p = fluid.point[s]
    m = fluid.motion[s]
    x = wp.vec3(p[0], p[1], p[2])
    v = wp.vec3(m[0], m[1], m[2])
    g = gravity[fluid.world[i]]
    if flags[i] & ACTIVE != 0:  # it was free until now
        given[i] = -mass[i] / dt * velocity[i]
        flags[i] = flags[i] & ~ACTIVE
    elif at != PARKED:
        given[i] = mass[i] * (g - (velocity[i] - v) / dt)
        if on_walls.shape[0] > 0:
            given[i] = given[i] - on_walls[i]
            on_walls[i] = wp.vec3(0.0, 0.0, 0.0)
    if at > FREE:
        q = at - 1
        t = taps.tap[q]
        way = wp.transform_vector(taps.pose[t], wp.vec3(0.0, 0.0, 1.0))
        v = float(travel[t]) / dt * way
        x += dt * v
        if wp.dot(x - wp.transform_get_translation(taps.pose[t]), way) >= 0.0:
            stage[i] = FREE
            flags[i] = flags[i] | ACTIVE
            given[i] = given[i] + mass[i] / dt * v
            wp.atomic_add(tally.released, fluid.world[i], 1)
    elif at < PARKED:
        d = -2 - at
        way = wp.transform_vector(drains.pose[d], wp.vec3(0.0, 0.0, 1.0))
        if drains.falls[d] != 0:
            v += dt * g
            pressure[i] = 0.0
        v -= wp.min(wp.dot(v, way), 0.0) * way  # nothing comes back
        x += dt * v
        if wp.dot(x - wp.transform_get_translation(drains.pose[d]), way) > drains.depth[d]:
            at = PARKED
            stage[i] = PARKED
    if at == PARKED:
        x = parking
        v = wp.vec3(0.0, 0.0, 0.0)
        pressure[i] = 0.0
        if on_walls.shape[0] > 0:
            on_walls[i] = wp.vec3(0.0, 0.0, 0.0)
    position[i] = x
    velocity[i] = v


@wp.kernel(enable_backward=False)
def find_due(
    # Data in:
    taps: Taps,
    poured: wp.array(dtype=wp.float64),
    before: wp.array(dtype=wp.float64),
    # Data out:
    due: wp.array(dtype=int),  # (Q + 1,)
):
    """Which places at mouths are to let a particle go in this step: one more layer has gone there."""
    q = wp.tid()
    t = taps.tap[q]
    now = poured[t] / (taps.area[t] * taps.layer[t])
    due[q] = 0
    if wp.floor(now + taps.phase[q]) > wp.floor(before[t] + taps.phase[q]):
        due[q] = 1


@wp.kernel(enable_backward=False)
def find_parked(
    # Data in:
    stage: wp.array(dtype=int),
    # Data out:
    parked: wp.array(dtype=int),  # (n + 1,)
):
    """Mark the particles that are parked."""
    i = wp.tid()
    parked[i] = 0
    if stage[i] == PARKED:
        parked[i] = 1


@wp.kernel(enable_backward=False)
def list_due(
    # Data in:
    taps: Taps,
    due: wp.array(dtype=int),
    rank: wp.array(dtype=int),
    # Data out:
    listed: wp.array(dtype=int),  # (Q,): those of each world that are due, from where its places begin
):
    """Gather the places that are due, world by world."""
    q = wp.tid()
    if due[q] != 0:
        first = taps.first[taps.world[q]]
        listed[first + rank[q] - rank[first]] = q


@wp.kernel(enable_backward=False)
def find_missing(
    # Data in:
    taps: Taps,
    world_first: wp.array(dtype=int),
    rank: wp.array(dtype=int),
    parked_rank: wp.array(dtype=int),
    # Data out:
    missing: wp.array(dtype=int),
):
    """Count what is due in each world while nothing is parked."""
    w = wp.tid()
    wanted = rank[taps.first[w + 1]] - rank[taps.first[w]]
    there = parked_rank[world_first[w + 1]] - parked_rank[world_first[w]]
    missing[w] = missing[w] + wp.max(wanted - there, 0)


@wp.kernel(enable_backward=False)
def release(
    # Data in:
    taps: Taps,
    poured: wp.array(dtype=wp.float64),
    travel: wp.array(dtype=wp.float64),
    particle_world: wp.array(dtype=int),
    world_first: wp.array(dtype=int),
    listed: wp.array(dtype=int),
    rank: wp.array(dtype=int),
    parked: wp.array(dtype=int),
    parked_rank: wp.array(dtype=int),
    dt: float,
    # Data in and out:
    stage: wp.array(dtype=int),
    flags: wp.array(dtype=int),
    tally: Tally,
    # Data out:
    mass: wp.array(dtype=float),
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float),
    given: wp.array(dtype=wp.vec3),
):
    """Put the first of the parked particles where one is due: at the far end of a pipe, or in the air where none is."""
    i = wp.tid()
    if parked[i] == 0:
        return
    world = particle_world[i]
    first = taps.first[world]
    turn = parked_rank[i] - parked_rank[world_first[world]]
    if turn >= rank[taps.first[world + 1]] - rank[first]:
        return
    q = listed[first + turn]
    t = taps.tap[q]
    gone = poured[t] / (taps.area[t] * taps.layer[t]) + taps.phase[q]
    along = float(gone - wp.floor(gone)) * float(taps.layer[t])
    speed = float(travel[t]) / dt
    if taps.depth[t] > 0.0:
        along += 0.5 * float(taps.layer[t]) - taps.depth[t]
        stage[i] = q + 1
    else:
        stage[i] = FREE
        flags[i] = flags[i] | ACTIVE
        wp.atomic_add(tally.released, world, 1)
        speed = taps.speed[t]
        along = 0.0
        given[i] = taps.mass[t] * speed / dt * wp.transform_vector(taps.pose[t], wp.vec3(0.0, 0.0, 1.0))
    place = taps.place[q]
    position[i] = wp.transform_point(taps.pose[t], wp.vec3(place[0], place[1], place[2] + along))
    velocity[i] = wp.transform_vector(taps.pose[t], wp.vec3(0.0, 0.0, speed))
    pressure[i] = 0.0
    mass[i] = taps.mass[t]
