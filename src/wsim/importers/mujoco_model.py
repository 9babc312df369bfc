"""An MJCF or URDF file → a world: bodies, what never moves, joints and gravity, as MuJoCo compiles them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.geometry.shapes import Solid
from wsim.importers.mujoco_contacts import give_of, with_contacts
from wsim.importers.mujoco_equalities import closing, gear
from wsim.importers.mujoco_foreign import foreign
from wsim.importers.mujoco_joints import joints_of
from wsim.importers.mujoco_names import body_name, prim_of
from wsim.importers.mujoco_shapes import shape_of, stand_in
from wsim.importers.mujoco_state import load_model
from wsim.importers.mujoco_tree import Tree
from wsim.scene.world import Body, Shape, Static, World


def world_of(path: Path) -> World:
    """The world of a model in its reference pose, bodies as `/World/<name>`.

    What is welded together is one body, by the name of the one that has the joint. Bodies that no joint lets move are
    fixed objects. What acts in the model and has no place in a world is named in `World.foreign`.

    Raises:
        UserError: MuJoCo does not read the file.
    """
    model = load_model(path)
    tree = Tree(model)
    shapes = _shapes(model, tree)
    statics: dict[str, list[Shape]] = {}
    for b in tree.members(0):
        for g in (g for g in tree.geoms(b) if g in shapes):
            # Each on its own where the world has them, as an object of the plan would be.
            statics.setdefault(shapes[g].prim if b == 0 else prim_of(body_name(model, b)), []).append(shapes[g])
    weightless = bool(model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY))
    joints = [joint for b in tree.roots for joint in joints_of(model, tree, b)]
    prims = {int(model.body_jntadr[b]): one[0].prim for b in tree.roots if len(one := joints_of(model, tree, b)) == 1}
    world = World(
        combine="larger",
        cone="pyramid" if model.opt.cone == int(mujoco.mjtCone.mjCONE_PYRAMIDAL) else "round",
        give=give_of(model),
        name=prim_of(path.stem).removeprefix("/World/"),
        gravity=(0.0, 0.0, 0.0) if weightless else tuple(model.opt.gravity.tolist()),
        time_step=float(model.opt.timestep),
        stepped="neither" if model.opt.integrator == int(mujoco.mjtIntegrator.mjINT_RK4) else "joints",
        bodies=[_body(model, tree, b, shapes) for b in tree.roots],
        statics=[Static(prim=prim, shapes=shapes) for prim, shapes in statics.items()],
        joints=joints + [joint for e in range(model.neq) if (joint := closing(model, tree, e)) is not None],
        gears=[made for e in range(model.neq) if (made := gear(model, e, prims)) is not None],
        foreign=foreign(model, tree),
    )
    return with_contacts(model, tree, world, shapes)


def _shapes(model: Any, tree: Tree) -> dict[int, Shape]:
    """The shapes of all geometries, in the frame of what moves with them."""
    found = {}
    for g in range(model.ngeom):
        b = int(model.geom_bodyid[g])
        root = tree.root(b)
        frame = tree.seen_from(root, b) if root else tree.pose(b)
        shape = shape_of(model, g, frame, prim_of(body_name(model, root)) if root else None)
        if shape is not None:
            found[g] = shape
    return found


def _body(model: Any, tree: Tree, root: int, known: dict[int, Shape]) -> Body:
    """A body and all that is welded to it, in its frame."""
    prim, members = prim_of(body_name(model, root)), tree.members(root)
    mass, com, inertia = tree.weight(members, tree.pose(root))
    shapes = [known[g] for b in members for g in tree.geoms(b) if g in known]
    position, rotation = tree.pose(root)
    kinematic = bool(model.body_mocapid[root] >= 0)
    shapes = shapes or [stand_in(prim, com, inertia, mass)]
    return Body(
        prim=prim,
        mass=mass or 1.0,  # of what is moved by hand none is stated, and none matters
        volume=float(Solid(shapes).volume) if any(shape.collides for shape in shapes) else 0.0,
        com=tuple(com.tolist()),
        inertia=tuple((inertia if mass > 0.0 else np.eye(3)).reshape(-1).tolist()),
        position=tuple(position.tolist()),
        rotation=tuple(rotation.tolist()),
        kinematic=kinematic,
        lift=float(model.body_gravcomp[members] @ model.body_mass[members] / mass) if mass > 0.0 else 0.0,
        shapes=shapes,
    )
