"""What the contact law needs of a stage: the law of each pair of surfaces, and MuJoCo's rows made hard."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import newton
import numpy as np

from wsim.recording.contacts import shapes_of
from wsim.scene.contact import curvature, pair_laws, within
from wsim.scene.world import Shape, World
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.surfaces import Surfaces

Array = np.ndarray


def harden_contacts(builder: Any, config: ContactConfig) -> None:
    """Make contacts and stops hard, and stops known before they are reached.

    Args:
        builder: The `newton.ModelBuilder`, with MuJoCo's custom attributes registered.
        config: The law's.
    """
    impedance = (config.impedance, config.impedance, 0.001, 0.5, 2.0)
    shapes, dofs = range(builder.shape_count), range(builder.joint_dof_count)
    builder.shape_gap = [0.0] * builder.shape_count
    builder.shape_material_mu = [max(mu, 2.0 * config.smallest_friction) for mu in builder.shape_material_mu]
    builder.custom_attributes["mujoco:geom_solimp"].values = dict.fromkeys(shapes, impedance)
    builder.custom_attributes["mujoco:solimplimit"].values = dict.fromkeys(dofs, impedance)
    builder.custom_attributes["mujoco:solimpfriction"].values = dict.fromkeys(dofs, impedance)
    builder.custom_attributes["mujoco:limit_margin"].values = dict.fromkeys(dofs, config.limit_reach)


def spare_kinematic(builder: Any) -> None:
    """Let no kinematic body touch what never yields, a static or another: neither gives way, and solvers shake."""
    kinematic = [bool(flags & int(newton.BodyFlags.KINEMATIC)) for flags in builder.body_flags]
    fixed = [body < 0 or kinematic[body] for body in builder.shape_body]
    driven = [k for k, body in enumerate(builder.shape_body) if body >= 0 and kinematic[body]]
    for k in driven:
        for other in range(builder.shape_count):
            if fixed[other] and builder.shape_body[other] != builder.shape_body[k]:
                builder.add_shape_collision_filter_pair(k, other)


def spare_tied(builder: Any, world: World) -> None:
    """Let no body touch what a joint ties it to, be it static, or what a gear meshes it with."""
    joints = {joint.prim: joint for joint in world.joints}
    pairs = [(joint.parent or joint.fixture, joint.child) for joint in world.joints]
    pairs += [(joints[gear.first].child, joints[gear.second].child) for gear in world.gears]
    for first, second in pairs:
        if first is None or first == second:
            continue
        tied, held = (_shapes_of(builder, prim) for prim in (first, second))
        for k in held:
            for other in tied:
                builder.add_shape_collision_filter_pair(k, other)


def _shapes_of(builder: Any, prim: str) -> list[int]:
    labels = [str(label) for label in builder.shape_label]
    return [k for k, label in enumerate(labels) if prim in (label, whole(label)) or label.startswith(prim + "/")]


def let_roll(builder: Any, world: World) -> None:
    """Give contacts rows for spinning and rolling where a shape rolls against friction; others keep three rows."""
    rows = rows_of_rolling(builder, world)
    if rows:
        builder.custom_attributes["mujoco:condim"].values = rows


def rows_of_rolling(builder: Any, world: World) -> dict[int, int]:
    """How many rows a contact of each shape has; nothing where nothing rolls against friction."""
    if not any(shape.rolling for shape in _shapes(world).values()) and not any(pair.rolling for pair in world.contacts):
        return {}
    surfaces = _surfaces([str(label) for label in builder.shape_label], world)
    kinds = np.column_stack([surfaces.classes[0], surfaces.curvature[0] > 0.0, np.array(builder.shape_body) >= 0])
    needs = set()
    for one in {tuple(kind) for kind in kinds.tolist()}:
        for other in {tuple(kind) for kind in kinds.tolist()}:
            # Of a contact one side asks for the rows: of two that move the round one.
            asks = one[2] and (one[1] or (other[1] and not other[2]))
            if asks and surfaces.law[0, one[0], other[0], 2] > 0.0:
                needs.add(one)
    rows = {k: 6 for k, kind in enumerate(kinds.tolist()) if tuple(kind) in needs}
    return dict.fromkeys(range(builder.shape_count), 3) | rows


def surfaces_of(model: Any, worlds: Sequence[World]) -> Surfaces:
    """The surfaces of the model's shapes: of all worlds alike, or of each."""
    labels = _labels(model)
    return Surfaces.of([_surfaces(labels, world) for world in worlds])


def _surfaces(labels: list[str], world: World) -> Surfaces:
    moving = {shape.prim for body in world.bodies for shape in body.shapes}
    known = _shapes(world)
    named = {prim for contact in world.contacts for prim in (contact.first, contact.second)}
    kinds: dict[tuple[Any, ...], Shape] = {}
    index: dict[tuple[Any, ...], int] = {}
    classes, bends = np.zeros(len(labels), dtype=np.int64), np.zeros(len(labels))
    for k, label in enumerate(labels):
        shape = _of_label(label, known)
        owners = tuple(sorted(prim for prim in named if within(shape.prim, prim))) if named else ()
        key = (shape.friction, shape.restitution, shape.rolling, owners)
        kinds.setdefault(key, shape)
        classes[k] = index.setdefault(key, len(index))
        bends[k] = curvature(shape, moves=shape.prim in moving)
    return Surfaces(classes[None], pair_laws(world, list(kinds.values()))[None], bends[None])


def surface_velocities(model: Any, worlds: Sequence[World]) -> Array:
    """How each shape of all worlds alike, or of each, moves its surface [m/s], in its body's or the world's axes,
    (N, shapes, 3)."""
    labels, found = _labels(model), []
    for world in worlds:
        known = _shapes(world)
        found.append([_of_label(label, known).surface_velocity for label in labels])
    return np.array(found).reshape(len(worlds), -1, 3)


def shape_numbers(model: Any, world: World) -> Array:
    """The number of each shape of the first world as a recording counts them, (shapes,); -1 for what it has not."""
    known = _shapes(world)
    number = {shape.prim: k for k, shape in enumerate(shapes_of(world))}
    return np.array([number.get(_of_label(label, known).prim, -1) for label in _labels(model)], dtype=np.int64)


def shape_prims(model: Any, world: World) -> list[str]:
    """The prim behind each shape of the model's first world."""
    known = _shapes(world)
    return [_of_label(label, known).prim for label in _labels(model)]


def _labels(model: Any) -> list[str]:
    """Of the shapes of the model's first world; the others have the same."""
    return [str(label) for label in model.shape_label[: model.shape_count // max(1, model.world_count)]]


def _shapes(world: World) -> dict[str, Shape]:
    bodies = [shape for body in world.bodies for shape in body.shapes]
    still = [shape for static in world.statics for shape in static.shapes]
    # What draws springs and ropes and marks their points: nothing touches it.
    drawn = [Shape(prim=cord.prim, kind="sphere", size=(cord.radius,), collides=False) for cord in world.cords]
    return {shape.prim: shape for shape in [*bodies, *still, *drawn]}


def _of_label(label: str, known: dict[str, Shape]) -> Shape:
    """The stage's shape behind one of the model's, which may be a part of it."""
    label = label if label in known else whole(label)
    while label not in known and "/" in label:
        label = label.rsplit("/", 1)[0]
    return known[label]


def whole(label: str) -> str:
    """The label of the mesh that Newton made a shape of: to collide, its second convex part and so on; to look at."""
    return re.sub(r"_convex_\d+$", "", label).removesuffix("_visual")
