"""Contacts that we find, put among MuJoCo Warp's."""

import warp as wp

from wsim.kernels.surface import Found
from wsim.kernels.touches import Touches

vec5 = wp.types.vector(length=5, dtype=float)


@wp.struct
class Rows:
    """MuJoCo Warp's contacts, and what its model says of geoms."""

    reach: float
    geom_dim: wp.array(dtype=int)
    geom_friction: wp.array2d(dtype=wp.vec3)
    geom_solref: wp.array2d(dtype=wp.vec2)
    geom_solimp: wp.array2d(dtype=vec5)
    count: wp.array(dtype=int)
    dist: wp.array(dtype=float)
    pos: wp.array(dtype=wp.vec3)
    frame: wp.array(dtype=wp.mat33)
    includemargin: wp.array(dtype=float)
    friction: wp.array(dtype=vec5)
    solref: wp.array(dtype=wp.vec2)
    solreffriction: wp.array(dtype=wp.vec2)
    solimp: wp.array(dtype=vec5)
    dim: wp.array(dtype=int)
    geom: wp.array(dtype=wp.vec2i)
    adhesion: wp.array(dtype=float)
    type: wp.array(dtype=int)
    geomcollisionid: wp.array(dtype=int)
    efc_address: wp.array2d(dtype=int)
    worldid: wp.array(dtype=int)


@wp.func
def _frame(normal: wp.vec3) -> wp.mat33:
    other = wp.vec3(1.0, 0.0, 0.0)
    if wp.abs(normal[0]) > 0.5:
        other = wp.vec3(0.0, 1.0, 0.0)
    second = wp.normalize(other - wp.dot(other, normal) * normal)
    third = wp.cross(normal, second)
    return wp.mat33(normal[0], normal[1], normal[2], second[0], second[1], second[2], third[0], third[1], third[2])


@wp.func
def _put(rows: Rows, home: int, geoms: wp.vec2i, number: int, place: wp.vec3, normal: wp.vec3, distance: float) -> int:
    """Add a contact, its normal from the first geom to the second; its number, or -1 where there is no room."""
    k = wp.atomic_add(rows.count, 0, 1)
    if k >= rows.dist.shape[0]:
        return -1
    rows.dist[k] = distance
    rows.pos[k] = place
    rows.frame[k] = _frame(normal)
    rows.includemargin[k] = rows.reach
    one = rows.geom_friction[home % rows.geom_friction.shape[0], geoms[0]]
    two = rows.geom_friction[home % rows.geom_friction.shape[0], geoms[1]]
    rub = rows.friction[k]
    rub[0] = wp.max(one[0], two[0])
    rub[1] = rub[0]
    rub[2] = wp.max(one[1], two[1])
    rub[3] = wp.max(one[2], two[2])
    rub[4] = rub[3]
    rows.friction[k] = rub
    rows.solref[k] = rows.geom_solref[home % rows.geom_solref.shape[0], geoms[1]]
    rows.solreffriction[k] = wp.vec2(0.0, 0.0)
    rows.solimp[k] = rows.geom_solimp[home % rows.geom_solimp.shape[0], geoms[1]]
    rows.dim[k] = wp.max(rows.geom_dim[geoms[0]], rows.geom_dim[geoms[1]])
    rows.geom[k] = geoms
    rows.adhesion[k] = 0.0
    rows.type[k] = 1
    rows.geomcollisionid[k] = number
    for j in range(rows.efc_address.shape[1]):
        rows.efc_address[k, j] = -1
    rows.worldid[k] = home
    return k


@wp.kernel(enable_backward=False)
def add_found(
    # Data in:
    found: Found,
    probe_world: wp.array(dtype=int),
    probe_geom: wp.array(dtype=int),
    part_geom: wp.array(dtype=int),
    # Data out:
    rows: Rows,
    bend: wp.array(dtype=float),
):
    """Add what was found on surfaces."""
    probe, slot = wp.tid()
    if slot >= found.count[probe]:
        return
    geoms = wp.vec2i(part_geom[found.part[probe, slot]], probe_geom[probe])
    place = found.position[probe, slot]
    normal = found.normal[probe, slot]
    k = _put(rows, probe_world[probe], geoms, slot, place, normal, found.distance[probe, slot])
    if k >= 0:
        bend[k] = found.bend[probe, slot]


@wp.kernel(enable_backward=False)
def add_touches(
    # Data in:
    found: Touches,
    pairs: wp.array(dtype=wp.vec2i),
    # Data out:
    rows: Rows,
):
    """Add what was found of cylinders."""
    k = wp.tid()
    if k < wp.min(found.count[0], found.pair.shape[0]):
        _put(rows, found.world[k], pairs[found.pair[k]], 0, found.position[k], found.normal[k], found.distance[k])
