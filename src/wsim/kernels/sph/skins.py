"""Triangles that no fluid passes: of what stands still and of what moves, however thin."""

import math

import warp as wp

from wsim.kernels.sph.blows import count_blow, velocity_at
from wsim.kernels.sph.openings import FREE

NAN = wp.constant(math.nan)
# Of a spacing: how far off a triangle a particle is kept.
CLEARANCE = wp.constant(1.0e-3)
# Faces that a particle slides along in one step; then it stays.
SLIDES = wp.constant(4)


@wp.kernel(enable_backward=False)
def keep_out_of_skins(
    # Data in:
    particle_world: wp.array(dtype=int),
    stage: wp.array(dtype=int),  # empty where no water is led through pipes (`openings`)
    mass: wp.array(dtype=float),
    skin_first: wp.array(dtype=int),  # (W + 1,): where each world's skins begin
    skin_mesh: wp.array(dtype=wp.uint64),
    skin_body: wp.array(dtype=int),  # whose frame it is in; -1: the world's
    skin_ball: wp.array(dtype=wp.vec4),  # centre and radius [m] of a ball around it, in that frame
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_com: wp.array(dtype=wp.vec3),
    pose_before: wp.array(dtype=wp.transform),  # of bodies, when `kept` was
    spacing: float,
    quantum: float,  # [N s]: impulses on bodies are added up in whole numbers of it, so that their order is all one
    dt: float,
    # Data in and out:
    kept: wp.array(dtype=wp.vec3),  # where each particle was when this was last asked
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    # Data out:
    on_walls: wp.array(dtype=wp.vec3),  # force on what stands still [N], added to
    impulse: wp.array2d(dtype=wp.int64),  # (bodies, 6) on each about its centre of mass, in quanta, added to
):
    """Stop fluid at the triangles that its way since the last time crosses, seen from what they belong to.

    A particle is put back to the side that it came from, slides on along the face, and loses what of its velocity went
    into it, relative to the face: v.n >= 0. What has come farther than a spacing was put there, and crosses nothing.
    """
    i = wp.tid()
    if stage.shape[0] > 0:
        if stage[i] != FREE:
            kept[i] = wp.vec3(NAN, NAN, NAN)
            return
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    start = kept[i]
    if not (wp.length(x - start) < spacing):
        start = x
    clear = CLEARANCE * spacing
    fixed = wp.vec3(0.0, 0.0, 0.0)
    for k in range(skin_first[world], skin_first[world + 1]):
        body = skin_body[k]
        now = wp.transform_identity()
        then = wp.transform_identity()
        if body >= 0:
            now = body_q[body]
            then = pose_before[body]
        b = wp.transform_point(wp.transform_inverse(now), x)
        a = wp.transform_point(wp.transform_inverse(then), start)
        ball = skin_ball[k]
        near = wp.length(b - wp.vec3(ball[0], ball[1], ball[2])) < ball[3] + wp.length(b - a) + clear
        if near:
            moved = bool(False)
            stop = wp.vec3(0.0, 0.0, 0.0)
            slide = int(0)
            while slide <= SLIDES:
                way = b - a
                far = wp.length(way)
                if far < 1.0e-12:
                    break
                way = way / far
                met = wp.mesh_query_ray(skin_mesh[k], a, way, far + clear)
                if not met.result:
                    break
                moved = True
                if slide == SLIDES:
                    b = a
                    break
                n = met.normal
                if wp.dot(n, way) > 0.0:
                    n = -n
                at = a + met.t * way
                a = a + wp.max(met.t - clear, 0.0) * way
                b = b + wp.max(clear - wp.dot(b - at, n), 0.0) * n
                out = wp.transform_vector(now, n)
                wall = wp.vec3(0.0, 0.0, 0.0)
                if body >= 0:
                    wall = velocity_at(body_qd[body], wp.transform_vector(now, at - body_com[body]))
                stop -= wp.min(wp.dot(v + stop - wall, out), 0.0) * out
                slide += 1
            if moved:
                x = wp.transform_point(now, b)
                v += stop
                if body >= 0:
                    j = -mass[i] * stop
                    arm = x - wp.transform_point(now, body_com[body])
                    count_blow(impulse, body, 0, j, quantum)
                    count_blow(impulse, body, 3, wp.cross(arm, j), quantum * spacing)
                else:
                    fixed += stop
    kept[i] = x
    position[i] = x
    velocity[i] = v
    if on_walls.shape[0] > 0:
        on_walls[i] = on_walls[i] - mass[i] / dt * fixed
