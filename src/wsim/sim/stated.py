"""The numbers of a builder that a world's description states, for many worlds at once and without an import each.

Newton's importer takes some thirty milliseconds a stage. Of plain shapes, loose or on joints that make trees, all that
differs from world to world, where their stages are of one skeleton (`wsim.scene.skeleton`), is what
`wsim.scene.describe` has read already.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from newton import GeoType, JointType

from wsim.scene.world import Body, Joint, Shape, World
from wsim.sim.numbers import plain_text, values_of
from wsim.solvers.contact_config import ContactConfig

Array = np.ndarray

PLAIN = ("box", "sphere", "cylinder", "capsule", "plane")
CLOSE = 1e-5  # relative: the importer adds up in single precision
NEAR = 1e-6  # of a pose likewise [m], and of a quaternion
MASSES = ("body_mass", "body_inv_mass", "body_com", "body_inertia", "body_inv_inertia")
GRAVITY = "_gravity"
# What a builder has of each degree of freedom; of a stop or a drive that no world has, any one number will do.
JOINTS: dict[str, Callable[[Joint], float]] = {
    "joint_limit_lower": lambda joint: joint.low or 0.0,
    "joint_limit_upper": lambda joint: joint.high or 0.0,
    "joint_friction": lambda joint: joint.friction,
    "joint_target_q": lambda joint: joint.drive.position if joint.drive else 0.0,
    "joint_target_qd": lambda joint: joint.drive.velocity if joint.drive else 0.0,
    "joint_target_ke": lambda joint: joint.drive.stiffness if joint.drive else 0.0,
    "joint_target_kd": lambda joint: joint.drive.damping if joint.drive else 0.0,
}
NO_MOMENT = 1e-6  # of the trace: a product of inertia below is rounding


def unstated(world: World) -> str:
    """Of what a world has that descriptions do not state all numbers of the importer; "" where there is none.

    They do of bodies of plain shapes alone, loose or on joints that make trees.
    """
    has = {
        "gears": world.gears,
        "springs": world.springs,
        "ropes": world.ropes,
        "another engine's doing": world.foreign,
        "joints that close loops or break": [joint for joint in world.joints if joint.closing],
        "meshes": [shape for shape in _shapes(world) if shape.kind not in PLAIN],
        "paths": [body for body in world.bodies if body.path],
    }
    found = [what for what, own in has.items() if own]
    return f"worlds have {', '.join(found)}" if found else ""


def state_numbers(builder: Any, world: World) -> bool:
    """Give a builder the masses, velocities and poses of the description: the judge's, and those of any other world.

    The importer has the same but for rounding: masses are added up in single precision, poses are products of matrices
    whose last bits depend on their order. Where it has not, all is left as it is.

    Returns:
        Whether it was so of all bodies.
    """
    told, index, close = _of_bodies([world]), _indices(builder.body_label), True
    for j, body in enumerate(world.bodies):
        k = index.get(body.prim)
        if k is None or not _close(builder, k, body):
            close = False
            continue
        for name in MASSES:
            _put(getattr(builder, name), k, told[name][0, j])
        at = _free_joint(builder, k)
        if at is None:  # where it starts follows from its joint
            continue
        _put(builder.body_qd, k, told["body_qd"][0, j])
        speeds, places = builder.joint_qd_start[at], builder.joint_q_start[at]
        builder.joint_qd[speeds : speeds + 6] = told["body_qd"][0, j].tolist()
        if _near(builder.body_q[k], told["body_q"][0, j]):
            _put(builder.body_q, k, told["body_q"][0, j])
            builder.joint_q[places : places + 7] = told["body_q"][0, j].tolist()
    shapes = {shape.prim: shape for shape in _shapes(world) if shape.kind in PLAIN}
    for k, label in enumerate(builder.shape_label):
        if label in shapes:
            pose = np.array([*shapes[label].position, *shapes[label].rotation], dtype=np.float32)
            if _near(builder.shape_transform[k], pose):
                _put(builder.shape_transform, k, pose)
    return close


def _put(values: list[Any], k: int, numbers: Array) -> None:
    values[k] = type(values[k])(*numbers.ravel().tolist())


def _near(pose: Any, told: Array) -> bool:
    held = np.array(pose, dtype=np.float64)
    return bool((np.abs(held - told) <= NEAR * (1.0 + np.abs(held))).all())


def _close(builder: Any, k: int, body: Body) -> bool:
    moments, trace = np.array(body.inertia), sum(body.inertia[::4])
    velocity = np.array([*body.velocity, *body.angular_velocity])
    reach = np.sqrt(trace / body.mass) + float(np.abs(body.com).max())
    pairs = (
        (body.mass, builder.body_mass[k], body.mass),
        (body.com, builder.body_com[k], reach),
        (moments, np.array(builder.body_inertia[k]).ravel(), trace),
        (velocity, builder.body_qd[k], float(np.abs(velocity).max())),
    )
    return all(bool((np.abs(np.subtract(ours, theirs)) <= CLOSE * size).all()) for ours, theirs, size in pairs)


def _of_bodies(worlds: Sequence[World]) -> dict[str, Array]:
    """What descriptions state of each world's bodies, (N, bodies, …), under the builder's names."""
    shape = (len(worlds), len(worlds[0].bodies))

    def stack(width: int, *names: str) -> Array:
        found = [[sum((getattr(body, name) for name in names), ()) for body in world.bodies] for world in worlds]
        return np.array(found, dtype=np.float64).reshape(*shape, width)

    inertia = stack(9, "inertia").reshape(*shape, 3, 3)
    trace = np.trace(inertia, axis1=-2, axis2=-1)[..., None, None]
    inertia = np.where((np.abs(inertia) < NO_MOMENT * trace) & ~np.eye(3, dtype=bool), 0.0, inertia)
    mass = np.array([[body.mass for body in world.bodies] for world in worlds]).reshape(shape)
    solid = np.where(np.linalg.det(inertia)[..., None, None] > 0.0, inertia, np.eye(3))
    told = {
        "body_mass": mass,
        "body_inv_mass": 1.0 / mass,
        "body_com": stack(3, "com"),
        "body_inertia": inertia,
        "body_inv_inertia": np.linalg.inv(solid),
        "body_q": stack(7, "position", "rotation"),
        "body_qd": stack(6, "velocity", "angular_velocity"),
    }
    return {name: numbers.astype(np.float32) for name, numbers in told.items()}


def numbers_of(first: Any, worlds: Sequence[World]) -> dict[str, Array] | None:
    """What other worlds' builders have other than the first one's, (N, …) in single precision, under its names.

    What a description states as the first one does is left as the importer has it.

    Args:
        first: The builder of the first of the worlds, its bodies' numbers stated.
        worlds: All, plain and of one topology.

    Returns:
        None where the builder has what no description states.
    """
    shapes = {shape.prim: shape for shape in _shapes(worlds[0])}
    prims = [body.prim for body in worlds[0].bodies]
    free = {k: joint for k in range(first.body_count) if (joint := _free_joint(first, k)) is not None}
    tied = [joint.prim for joint in worlds[0].joints]
    named = {str(first.joint_label[j]): j for j in range(first.joint_count) if j not in free.values()}
    if (
        sorted(first.body_label) != sorted(prims)
        or set(tied) != named.keys()
        or len(tied) + len(free) != first.joint_count
    ):
        return None
    order = [prims.index(label) for label in first.body_label]
    held = [j for k, j in enumerate(order) if k not in free]
    if any(_moved(world, worlds[0], held) for world in worlds[1:]):
        return None
    if any(label not in shapes for label in first.shape_label):
        return None
    bodies = {name: own[:, order] for name, own in _of_bodies(worlds).items()}
    found = {name: _changed(_held(first, name), own) for name, own in bodies.items()}
    for name, width in (("joint_q", 7), ("joint_qd", 6)):
        starts, source = getattr(first, f"{name}_start"), bodies[f"body_{name[6:]}"]
        places = np.array([starts[joint] for joint in free.values()], dtype=np.int64)
        found[name] = np.repeat(np.array(getattr(first, name), dtype=np.float32)[None], len(worlds), axis=0)
        columns = (places[:, None] + np.arange(width)).ravel()
        found[name][:, columns] = _changed(found[name][0][columns], source[:, list(free)].reshape(len(worlds), -1))
    gravity = np.array([world.gravity for world in worlds], dtype=np.float32)
    found[GRAVITY] = _changed(np.asarray(first.gravity, dtype=np.float32), gravity)
    return found | _of_joints(first, worlds, named) | _of_shapes(first, worlds)


def _moved(world: World, first: World, bodies: Sequence[int]) -> bool:
    """Whether bodies that joints hold start otherwise than in the first world: their coordinates follow from it."""
    names = ("position", "rotation", "velocity", "angular_velocity")
    return any(getattr(world.bodies[k], name) != getattr(first.bodies[k], name) for k in bodies for name in names)


def _of_joints(first: Any, worlds: Sequence[World], index: Mapping[str, int]) -> dict[str, Array]:
    """Stops, friction and drives of hinges and sliders, (N, degrees of freedom), under the builder's names."""
    own = [k for k, joint in enumerate(worlds[0].joints) if joint.kind in ("revolute", "prismatic")]
    at = [index[worlds[0].joints[k].prim] for k in own]
    found = {}
    for name, told in JOINTS.items():
        rows = [[told(world.joints[k]) for k in own] for world in worlds]
        numbers = np.array(rows, dtype=np.float64).astype(np.float32).reshape(len(worlds), -1)
        found[name] = np.repeat(_held(first, name)[None], len(worlds), axis=0)
        starts = first.joint_q_start if name == "joint_target_q" else first.joint_qd_start
        places = [starts[j] for j in at]
        found[name][:, places] = _changed(found[name][0][places], numbers)
    return found


def _of_shapes(first: Any, worlds: Sequence[World]) -> dict[str, Array]:
    if not first.shape_label:  # water that nothing holds
        return {}
    order = [{shape.prim: k for k, shape in enumerate(_shapes(worlds[0]))}[label] for label in first.shape_label]
    rows = [[shapes[k] for k in order] for shapes in map(_shapes, worlds)]
    least = 2.0 * ContactConfig().smallest_friction
    told = {
        "shape_scale": [[_scale(shape) for shape in row] for row in rows],
        "shape_transform": [[(*shape.position, *shape.rotation) for shape in row] for row in rows],
        "shape_material_mu": [[max(shape.friction or 0.0, least) for shape in row] for row in rows],
        "shape_material_restitution": [[shape.restitution or 0.0 for shape in row] for row in rows],
    }
    found = {name: _changed(_held(first, name), np.array(own, dtype=np.float32)) for name, own in told.items()}
    scale = found["shape_scale"].astype(np.float64)
    kinds = np.array([int(kind) for kind in first.shape_type])
    radius = np.where(kinds == GeoType.BOX, np.linalg.norm(scale, axis=-1), scale[..., 0])
    radius = np.where((kinds == GeoType.CYLINDER) | (kinds == GeoType.CAPSULE), scale[..., 0] + scale[..., 1], radius)
    radius = np.where(kinds == GeoType.PLANE, 0.0, radius).astype(np.float32)
    return found | {"shape_collision_radius": _changed(_held(first, "shape_collision_radius"), radius)}


def _scale(shape: Shape) -> tuple[float, float, float]:
    """As Newton has it: half edges, or radius and half the height."""
    size = shape.size
    if shape.kind == "box":
        return 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]
    return (size[0] if size else 0.0, 0.5 * size[1] if len(size) > 1 else 0.0, 0.0)


def _shapes(world: World) -> list[Shape]:
    moving = [shape for body in world.bodies for shape in body.shapes]
    return moving + [shape for static in world.statics for shape in static.shapes]


def _held(builder: Any, name: str) -> Array:
    return np.array([np.asarray(each) for each in getattr(builder, name)], dtype=np.float32)


def _changed(first: Array, told: Array) -> Array:
    """The first world's numbers, and the others' own where they state others than the first."""
    return np.where(told == told[:1], first.reshape(told.shape[1:]), told).astype(np.float32)


def _indices(labels: Sequence[str]) -> dict[str, int]:
    return {str(label): k for k, label in enumerate(labels)}


def _free_joint(builder: Any, body: int) -> int | None:
    """The joint by which a body is free in the world; None if it has another."""
    for joint, child in enumerate(builder.joint_child):
        if child == body and builder.joint_type[joint] == JointType.FREE and builder.joint_parent[joint] < 0:
            upright = np.array_equal(np.array(builder.joint_X_p[joint]), (0.0,) * 6 + (1.0,))
            return joint if upright else None
    return None


def confirmed(own: Any, known: Mapping[str, str], told: Mapping[str, Array], k: int) -> bool:
    """Whether an imported builder is, to the last bit, the first with the numbers of world k.

    Args:
        own: The builder of world k.
        known: `wsim.sim.numbers.texts` of the first.
        told: `numbers_of`.
        k: The world.
    """
    for name, value in values_of(own).items():
        if name in told:
            held = np.array([np.asarray(each) for each in value], dtype=np.float32)
            if held.tobytes() != told[name][k].tobytes():
                return False
        elif plain_text(value) != known[name]:
            return False
    return True


def replicate(builder: Any, first: Any, told: Mapping[str, Array]) -> None:
    """Fill an empty builder with copies of the first, each with its world's numbers."""
    builder.replicate(first, len(told[GRAVITY]))
    for name, numbers in told.items():
        rows = numbers if name == GRAVITY else numbers.reshape(-1, *numbers.shape[2:])
        setattr(builder, "world_gravity" if name == GRAVITY else name, list(rows) if rows.ndim > 1 else rows.tolist())
