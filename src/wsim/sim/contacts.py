"""What the contact law needs of a stage: the law of each pair of surfaces, and MuJoCo's rows made hard."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np

from wsim.scene.contact import pair_law
from wsim.scene.world import Shape, World
from wsim.solvers.contact_law import ContactConfig

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
    """Let no body touch the static object that a joint ties it to, as two bodies that a joint ties do not."""
    for joint in world.joints:
        if joint.fixture is not None:
            tied, held = (_shapes_of(builder, prim) for prim in (joint.fixture, joint.child))
            for k in held:
                for other in tied:
                    builder.add_shape_collision_filter_pair(k, other)


def _shapes_of(builder: Any, prim: str) -> list[int]:
    labels = [str(label) for label in builder.shape_label]
    return [k for k, label in enumerate(labels) if label == prim or label.startswith(prim + "/")]


def contact_law(model: Any, world: World) -> tuple[Array, Array]:
    """The class of each shape of the model's first world, (shapes,), and the law of two classes, (classes, classes, 4).

    A law is friction, restitution, spinning and rolling friction [m].
    """
    bodies = [shape for body in world.bodies for shape in body.shapes]
    known = {shape.prim: shape for shape in [*bodies, *(s for static in world.statics for s in static.shapes)]}
    count = model.shape_count // max(1, model.world_count)
    surfaces: dict[tuple[Any, ...], Shape] = {}
    classes = np.zeros(count, dtype=np.int64)
    collides = (model.shape_flags.numpy() & int(newton.ShapeFlags.COLLIDE_SHAPES)) != 0
    for k, label in enumerate(model.shape_label[:count]):
        if not collides[k]:
            continue
        shape = _of_label(str(label), known)
        key = (shape.friction, shape.restitution)
        surfaces.setdefault(key, shape)
        classes[k] = list(surfaces).index(key)
    law = np.zeros((len(surfaces), len(surfaces), 4))
    for i, a in enumerate(surfaces.values()):
        for j, b in enumerate(surfaces.values()):
            pair = pair_law(world, a, b)
            law[i, j, :2] = pair.friction, pair.restitution
    return classes, law


def _of_label(label: str, known: dict[str, Shape]) -> Shape:
    """The stage's shape behind one of the model's, which may be a part of it (a mesh in convex pieces)."""
    while label not in known and "/" in label:
        label = label.rsplit("/", 1)[0]
    return known[label]
