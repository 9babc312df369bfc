"""MuJoCo's equality constraints → joints that close loops, and gears."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.importers.mujoco_names import body_name, element, prim_of
from wsim.importers.mujoco_tree import Pose, Tree
from wsim.scene.world import Gear, Joint

EQ, OBJ = mujoco.mjtEq, mujoco.mjtObj


def on(model: Any, e: int) -> bool:
    """Whether an equality acts from the start."""
    off = int(mujoco.mjtDisableBit.mjDSBL_EQUALITY | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    return bool(model.eq_active0[e]) and not model.opt.disableflags & off


def linear(model: Any, e: int) -> bool:
    """Whether a joint's equality makes it go in proportion to another."""
    return int(model.eq_obj2id[e]) >= 0 and not np.any(model.eq_data[e, 2:5])


def closing(model: Any, tree: Tree, e: int) -> Joint | None:
    """The joint of a connect or weld; None of any other, and between what moves as one."""
    kind = EQ(int(model.eq_type[e]))
    if kind not in (EQ.mjEQ_CONNECT, EQ.mjEQ_WELD) or not on(model, e):
        return None
    ends = [_end(model, e, side) for side in (0, 1)]
    roots = [tree.root(body) for body, _ in ends]
    if roots[0] == roots[1]:
        return None
    frames = [_placed(tree, body, pose) for body, pose in ends]
    one, two = (0, 1) if roots[1] else (1, 0)  # the child is one that moves
    return Joint.model_validate(
        {
            "prim": f"{prim_of(element(model, 'equality', e))}/joint",
            "kind": "fixed" if kind == EQ.mjEQ_WELD and model.eq_data[e, 10] > 0.0 else "spherical",
            "parent": prim_of(body_name(model, roots[one])) if roots[one] else None,
            "child": prim_of(body_name(model, roots[two])),
            "parent_anchor": frames[one][0].tolist(),
            "parent_turn": frames[one][1].tolist(),
            "child_anchor": frames[two][0].tolist(),
            "child_turn": frames[two][1].tolist(),
            "closing": True,
        }
    )


def gear(model: Any, e: int, prims: dict[int, str]) -> Gear | None:
    """The gear of a linear equality of two joints, whose prims are by number."""
    if EQ(int(model.eq_type[e])) != EQ.mjEQ_JOINT or not on(model, e) or not linear(model, e):
        return None
    one, two = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
    if one not in prims or two not in prims:
        return None
    offset, ratio = (float(x) for x in model.eq_data[e, :2])
    name = prim_of(element(model, "equality", e))
    return Gear(prim=name, first=prims[two], second=prims[one], ratio=ratio, offset=offset)


def _end(model: Any, e: int, side: int) -> tuple[int, Pose]:
    """The body at one end, and the frame that is held, in the body's."""
    number = int((model.eq_obj1id, model.eq_obj2id)[side][e])
    if int(model.eq_objtype[e]) == int(OBJ.mjOBJ_SITE):
        return int(model.site_bodyid[number]), (model.site_pos[number], Tree.xyzw(model.site_quat[number]))
    data, none = model.eq_data[e], np.array([0.0, 0.0, 0.0, 1.0])
    if EQ(int(model.eq_type[e])) == EQ.mjEQ_CONNECT:
        return number, (data[:3] if side == 0 else data[3:6], none)
    anchor = data[:3]  # in the second body; the first has it at its pose by the second's
    if side == 1:
        return number, (anchor, none)
    return number, (data[3:6], Tree.xyzw(data[6:10]))


def _placed(tree: Tree, body: int, pose: Pose) -> Pose:
    """A frame of a body in that of what it moves with."""
    root = tree.root(body)
    at, turn = tree.seen_from(root, body) if root else tree.pose(body)
    return at + rotate(turn, pose[0]), multiply(turn, pose[1])
