"""Which of a MuJoCo model's geometries touch each other, and by what law where that is not the surfaces' own."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_joints import give_by
from wsim.importers.mujoco_shapes import collides
from wsim.importers.mujoco_tree import Tree
from wsim.scene.contact import pair_law
from wsim.scene.world import Contact, Give, Shape, World

TURNS, ROLLS = 4, 6  # contact dimensions from which a contact resists turning about its normal, and rolling
Pairs = dict[tuple[int, int], int]  # of geometries, to the number of a pair of its own law


def with_contacts(model: Any, tree: Tree, world: World, shapes: dict[int, Shape]) -> World:
    """A world with `apart` and `contacts` by its model, of whose geometries `shapes` are in it."""
    stated: Pairs = {(int(model.pair_geom1[p]), int(model.pair_geom2[p])): p for p in range(model.npair)}
    numbers = [g for g in shapes if collides(model, g) or any(g in pair for pair in stated)]
    owner = {shape.prim: body.prim for body in world.bodies for shape in body.shapes}
    owner |= {shape.prim: static.prim for static in world.statics for shape in static.shapes}
    moves = {body.prim for body in world.bodies if not body.kinematic}
    apart: dict[tuple[str, str], list[tuple[str, str]]] = {}
    meet: set[tuple[str, str]] = set()
    contacts = []
    for k, g in enumerate(numbers):
        for h in numbers[k + 1 :]:
            a, b = shapes[g], shapes[h]
            owners = owner[a.prim], owner[b.prim]
            if owners[0] == owners[1] or not moves & set(owners):
                continue
            pair = stated.get((g, h), stated.get((h, g)))
            if not _touch(model, tree, g, h, pair):
                apart.setdefault(owners, []).append((a.prim, b.prim))
                continue
            meet.add(owners)
            law = _law(model, world, (g, a), (h, b), pair)
            contacts += [law] if law is not None else []
    kept = [one for owners, pairs in apart.items() for one in (pairs if owners in meet else [owners])]
    return world.model_copy(update={"apart": kept, "contacts": contacts})


def give_of(model: Any) -> Give:
    """How its contacts yield."""
    touching = [g for g in range(model.ngeom) if collides(model, g)]
    solref = np.concatenate([model.geom_solref[touching], model.pair_solref])
    return give_by(model, solref, np.concatenate([model.geom_solimp[touching], model.pair_solimp]))


def _touch(model: Any, tree: Tree, g: int, h: int, pair: int | None) -> bool:
    """Whether two geometries collide where they meet (MuJoCo's documentation, Computation: Collision, Selection)."""
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT):
        return False
    if pair is not None:
        return True
    one, two = int(model.geom_bodyid[g]), int(model.geom_bodyid[h])
    low, high = sorted((one, two))
    if (low << 16) + high in model.exclude_signature:
        return False
    roots = tree.root(one), tree.root(two)
    related = any(tree.parent(b) == a and a > 0 for a, b in (roots, roots[::-1]) if b > 0)
    if related and not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT):
        return False
    masks = model.geom_contype, model.geom_conaffinity
    return bool(masks[0][g] & masks[1][h] or masks[0][h] & masks[1][g])


def _law(model: Any, world: World, one: tuple[int, Shape], two: tuple[int, Shape], pair: int | None) -> Contact | None:
    """What holds between two geometries where it is not what their own surfaces combine to."""
    (g, a), (h, b) = one, two
    if pair is not None:
        dimension, friction = int(model.pair_dim[pair]), model.pair_friction[pair][[0, 2, 3]]
    else:
        order = int(model.geom_priority[g]) - int(model.geom_priority[h])
        chosen = [g, h] if order == 0 else [g] if order > 0 else [h]
        dimension = int(max(model.geom_condim[chosen]))
        friction = model.geom_friction[chosen].max(axis=0)
    slides = float(friction[0]) if dimension > 1 else 0.0
    arm = max(float(friction[1]) * (dimension >= TURNS), float(friction[2]) * (dimension >= ROLLS))
    if arm == 0.0 and abs(slides - pair_law(world, a, b).friction) <= 1e-9:
        return None
    size = min(float(model.geom_rbound[k]) for k in (g, h) if model.geom_rbound[k] > 0.0)
    return Contact(prim=f"{a.prim}/contact", first=a.prim, second=b.prim, friction=slides, rolling=arm / size)
