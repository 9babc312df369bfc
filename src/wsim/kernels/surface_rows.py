"""What was found on surfaces, put among MuJoCo Warp's contacts."""

import warp as wp

from wsim.kernels.surface import Found


@wp.func
def _frame(normal: wp.vec3) -> wp.mat33:
    other = wp.vec3(1.0, 0.0, 0.0)
    if wp.abs(normal[0]) > 0.5:
        other = wp.vec3(0.0, 1.0, 0.0)
    second = wp.normalize(other - wp.dot(other, normal) * normal)
    third = wp.cross(normal, second)
    return wp.mat33(normal[0], normal[1], normal[2], second[0], second[1], second[2], third[0], third[1], third[2])


@wp.kernel(enable_backward=False)
def add(
    # Data in:
    found: Found,
    probe_world: wp.array(dtype=int),
    probe_geom: wp.array(dtype=int),
    part_geom: wp.array(dtype=int),
    geom_dim: wp.array(dtype=int),
    geom_friction: wp.array2d(dtype=wp.vec3),
    geom_solref: wp.array2d(dtype=wp.vec2),
    geom_solimp: wp.array2d(dtype=wp.types.vector(length=5, dtype=float)),
    reach: float,
    # Data out:
    count: wp.array(dtype=int),
    dist: wp.array(dtype=float),
    pos: wp.array(dtype=wp.vec3),
    frame: wp.array(dtype=wp.mat33),
    margin: wp.array(dtype=float),
    friction: wp.array(dtype=wp.types.vector(length=5, dtype=float)),
    solref: wp.array(dtype=wp.vec2),
    solreffriction: wp.array(dtype=wp.vec2),
    solimp: wp.array(dtype=wp.types.vector(length=5, dtype=float)),
    dim: wp.array(dtype=int),
    geom: wp.array(dtype=wp.vec2i),
    adhesion: wp.array(dtype=float),
    kind: wp.array(dtype=int),
    number: wp.array(dtype=int),
    row: wp.array2d(dtype=int),
    world: wp.array(dtype=int),
    bend: wp.array(dtype=float),
):
    """Add what was found to MuJoCo Warp's contacts."""
    probe, slot = wp.tid()
    if slot >= found.count[probe]:
        return
    k = wp.atomic_add(count, 0, 1)
    if k >= dist.shape[0]:
        return
    own = probe_geom[probe]
    fixed = part_geom[found.part[probe, slot]]
    home = probe_world[probe]
    dist[k] = found.distance[probe, slot]
    pos[k] = found.position[probe, slot]
    frame[k] = _frame(found.normal[probe, slot])
    margin[k] = reach
    rubs = geom_friction[home % geom_friction.shape[0], own]
    other = geom_friction[home % geom_friction.shape[0], fixed]
    rub = friction[k]
    rub[0] = wp.max(rubs[0], other[0])
    rub[1] = rub[0]
    rub[2] = wp.max(rubs[1], other[1])
    rub[3] = wp.max(rubs[2], other[2])
    rub[4] = rub[3]
    friction[k] = rub
    solref[k] = geom_solref[home % geom_solref.shape[0], own]
    solreffriction[k] = wp.vec2(0.0, 0.0)
    solimp[k] = geom_solimp[home % geom_solimp.shape[0], own]
    dim[k] = wp.max(geom_dim[own], geom_dim[fixed])
    geom[k] = wp.vec2i(fixed, own)
    adhesion[k] = 0.0
    kind[k] = 1
    number[k] = slot
    for j in range(row.shape[1]):
        row[k, j] = -1
    world[k] = home
    bend[k] = found.bend[probe, slot]
