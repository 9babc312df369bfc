"""Faces of what stands still or is led, which no fluid gets behind however thin or far from the tank it is."""

import warp as wp

from wsim.kernels.sph.blows import count_blow, velocity_at
from wsim.kernels.sph.openings import FREE

BOX = wp.constant(0)
ROUND = wp.constant(1)
MESH = wp.constant(2)


@wp.func
def _crossed(half: wp.vec3, before: wp.vec3, now: wp.vec3) -> wp.vec3:
    """The outward normal of the face of a box through which a point came in, from the frame of the box.

    The one that it was farthest beyond; of a point that was inside already, the nearest.
    """
    best = float(-1.0e30)
    normal = wp.vec3(0.0, 0.0, 0.0)
    outside = bool(False)
    for axis in range(3):
        if wp.abs(before[axis]) > half[axis]:
            outside = True
    for axis in range(3):
        at = wp.where(outside, before[axis], now[axis])
        beyond = wp.abs(at) - half[axis]
        if beyond > best:
            best = beyond
            normal = wp.vec3(0.0, 0.0, 0.0)
            normal[axis] = wp.where(at < 0.0, -1.0, 1.0)
    return normal


@wp.struct
class Faces:
    """Those of each world, W: `first` of each kind says where each world's begin, (W + 1,)."""

    plane_first: wp.array(dtype=int)
    plane: wp.array(dtype=wp.vec4)  # outward unit normal n, and n.x on it [m]
    box_first: wp.array(dtype=int)
    box: wp.array(dtype=wp.transform)
    box_half: wp.array(dtype=wp.vec3)  # [m]
    box_low: wp.array(dtype=wp.vec3)  # corners of what is upright around each [m]
    box_high: wp.array(dtype=wp.vec3)
    round_first: wp.array(dtype=int)
    round: wp.array(dtype=wp.transform)
    round_size: wp.array(dtype=wp.vec3)  # radius, half the height of the straight part [m]; 1 where the ends are flat
    mesh_first: wp.array(dtype=int)
    mesh: wp.array(dtype=wp.uint64)
    mesh_pose: wp.array(dtype=wp.transform)
    mesh_low: wp.array(dtype=wp.vec3)
    mesh_high: wp.array(dtype=wp.vec3)
    reach: float  # [m]: nothing is deeper in a mesh; it is put back before
    plane_flow: bool  # whether the flow is in the x-z plane: meshes are prisms without ends, and nothing leaves y = 0


@wp.func
def _between(low: wp.vec3, high: wp.vec3, x: wp.vec3) -> bool:
    return x[0] > low[0] and x[0] < high[0] and x[1] > low[1] and x[1] < high[1] and x[2] > low[2] and x[2] < high[2]


@wp.func
def _out_of_round(size: wp.vec3, x: wp.vec3) -> wp.vec3:
    """The way out of a sphere, a capsule or a cylinder along z, in its frame; 0 outside."""
    aside = wp.vec3(x[0], x[1], 0.0)
    beyond = wp.abs(x[2]) - size[1]
    if size[2] == 0.0:
        if beyond > 0.0:
            aside[2] = wp.sign(x[2]) * beyond
        return wp.max(size[0] - wp.length(aside), 0.0) * wp.normalize(aside)
    deep = size[0] - wp.length(aside)
    if deep <= 0.0 or beyond >= 0.0:
        return wp.vec3(0.0, 0.0, 0.0)
    if deep < -beyond:
        return deep * wp.normalize(aside)
    return wp.vec3(0.0, 0.0, -wp.sign(x[2]) * beyond)


@wp.func
def _out_of_mesh(mesh: wp.uint64, reach: float, x: wp.vec3) -> wp.vec3:
    """The way out of a closed mesh, in its frame; 0 outside, and deeper than `reach`."""
    found = wp.mesh_query_point_sign_winding_number(mesh, x, reach)
    if not found.result or found.sign > 0.0:
        return wp.vec3(0.0, 0.0, 0.0)
    return wp.mesh_eval_position(mesh, found.face, found.u, found.v) - x


@wp.func
def _out_of_prism(mesh: wp.uint64, reach: float, x: wp.vec3) -> wp.vec3:
    """The way out of a prism along y of which a flow in the x-z plane sees the sides alone."""
    found = wp.mesh_query_point_sign_normal(mesh, x, reach)
    if not found.result or found.sign > 0.0:
        return wp.vec3(0.0, 0.0, 0.0)
    out = wp.mesh_eval_position(mesh, found.face, found.u, found.v) - x
    out[1] = 0.0
    return out


@wp.kernel(enable_backward=False)
def keep_out(
    # Data in:
    particle_world: wp.array(dtype=int),
    mass: wp.array(dtype=float),
    faces: Faces,
    dt: float,
    # Data in and out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    on_walls: wp.array(dtype=wp.vec3),
):
    """Put fluid that has come through a face in this step back to it, and stop it there: v.n >= 0, as at a wall.

    Particles of walls push with their pressure; between them, and past the rim of a tank, which is too thin for them,
    a drop of its own would slip through.
    """
    i = wp.tid()
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    before = x - dt * v
    stop = wp.vec3(0.0, 0.0, 0.0)
    for k in range(faces.box_first[world], faces.box_first[world + 1]):
        if _between(faces.box_low[k], faces.box_high[k], x):
            into = wp.transform_inverse(faces.box[k])
            own = wp.transform_point(into, x)
            half = faces.box_half[k]
            if wp.abs(own[0]) < half[0] and wp.abs(own[1]) < half[1] and wp.abs(own[2]) < half[2]:
                side = _crossed(half, wp.transform_point(into, before), own)
                n = wp.transform_vector(faces.box[k], side)
                x += (wp.dot(wp.abs(side), half) - wp.dot(side, own)) * n
                stop -= wp.min(wp.dot(v + stop, n), 0.0) * n
    for k in range(faces.round_first[world], faces.round_first[world + 1]):
        own = wp.transform_point(wp.transform_inverse(faces.round[k]), x)
        out = wp.transform_vector(faces.round[k], _out_of_round(faces.round_size[k], own))
        x += out
        stop -= wp.min(wp.dot(v + stop, wp.normalize(out)), 0.0) * wp.normalize(out)
    for k in range(faces.mesh_first[world], faces.mesh_first[world + 1]):
        if _between(faces.mesh_low[k], faces.mesh_high[k], x):
            out = wp.vec3(0.0, 0.0, 0.0)
            if faces.plane_flow:
                out = _out_of_prism(faces.mesh[k], faces.reach, x)
            else:
                own = wp.transform_point(wp.transform_inverse(faces.mesh_pose[k]), x)
                out = wp.transform_vector(faces.mesh_pose[k], _out_of_mesh(faces.mesh[k], faces.reach, own))
            x += out
            stop -= wp.min(wp.dot(v + stop, wp.normalize(out)), 0.0) * wp.normalize(out)
    for k in range(faces.plane_first[world], faces.plane_first[world + 1]):
        plane = faces.plane[k]
        n = wp.vec3(plane[0], plane[1], plane[2])
        deep = plane[3] - wp.dot(n, x)
        if deep > 0.0:
            x += deep * n
            stop -= wp.min(wp.dot(v + stop, n), 0.0) * n
    position[i] = x
    velocity[i] = v + stop
    on_walls[i] = on_walls[i] - mass[i] / dt * stop


@wp.struct
class LedFaces:
    """Shapes of bodies that are led, those of each world, W, next to each other."""

    first: wp.array(dtype=int)  # (W + 1,)
    body: wp.array(dtype=int)
    pose: wp.array(dtype=wp.transform)  # in the body's frame
    kind: wp.array(dtype=int)  # BOX, ROUND or MESH
    size: wp.array(dtype=wp.vec3)  # half the edges of a box, or as `Faces.round_size` [m]
    mesh: wp.array(dtype=wp.uint64)
    ball: wp.array(dtype=float)  # radius of one about the frame's origin that has all of it [m]
    reach: float  # as of `Faces`


@wp.func
def _out_of_led(faces: LedFaces, k: int, before: wp.vec3, x: wp.vec3) -> wp.vec3:
    """The way out of shape k, in its frame; 0 outside."""
    size = faces.size[k]
    if faces.kind[k] == BOX:
        if not _between(-size, size, x):
            return wp.vec3(0.0, 0.0, 0.0)
        side = _crossed(size, before, x)
        return (wp.dot(wp.abs(side), size) - wp.dot(side, x)) * side
    if faces.kind[k] == ROUND:
        return _out_of_round(size, x)
    return _out_of_mesh(faces.mesh[k], faces.reach, x)


@wp.kernel(enable_backward=False)
def keep_out_of_led(
    # Data in:
    particle_world: wp.array(dtype=int),
    stage: wp.array(dtype=int),  # empty where no water is led through pipes (`openings`)
    mass: wp.array(dtype=float),
    faces: LedFaces,
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_com: wp.array(dtype=wp.vec3),
    spacing: float,
    quantum: float,  # [N s]
    dt: float,
    # Data in and out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    impulse: wp.array2d(dtype=wp.int64),
):
    """Put fluid that a led body's face went over in this step back before it, and let it go as fast as the face.

    Its pressure alone is no wall: beside a void it leaves the water, and a thin sheet that a wall runs into is gone
    through.
    """
    i = wp.tid()
    if stage.shape[0] > 0:
        if stage[i] != FREE:
            return
    x = position[i]
    v = velocity[i]
    for k in range(faces.first[particle_world[i]], faces.first[particle_world[i] + 1]):
        body = faces.body[k]
        pose = body_q[body] * faces.pose[k]
        into = wp.transform_inverse(pose)
        own = wp.transform_point(into, x)
        if wp.length(own) < faces.ball[k]:
            arm = x - wp.transform_point(body_q[body], body_com[body])
            wall = velocity_at(body_qd[body], arm)
            out = wp.transform_vector(pose, _out_of_led(faces, k, wp.transform_point(into, x - dt * (v - wall)), own))
            n = wp.normalize(out)
            stop = -wp.min(wp.dot(v - wall, n), 0.0) * n
            x += out
            v += stop
            count_blow(impulse, body, 0, -mass[i] * stop, quantum)
            count_blow(impulse, body, 3, wp.cross(arm, -mass[i] * stop), quantum * spacing)
    position[i] = x
    velocity[i] = v
