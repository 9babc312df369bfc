"""MuJoCo's joints → a world's joints."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.importers.mujoco_names import body_name, clean, element, prim_of
from wsim.importers.mujoco_tree import Tree
from wsim.scene.world import Joint

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
KINDS = {
    mujoco.mjtJoint.mjJNT_HINGE: "revolute",
    mujoco.mjtJoint.mjJNT_SLIDE: "prismatic",
    mujoco.mjtJoint.mjJNT_BALL: "spherical",
}


def joints_of(model: Any, tree: Tree, b: int) -> list[Joint]:
    """What holds a body to the one that it hangs from; a free joint is none."""
    count, first = int(model.body_jntnum[b]), int(model.body_jntadr[b])
    if count != 1 or mujoco.mjtJoint(int(model.jnt_type[first])) not in KINDS:
        return []
    kind = KINDS[mujoco.mjtJoint(int(model.jnt_type[first]))]
    above, child = tree.parent(b), prim_of(body_name(model, b))
    place, turn = model.jnt_pos[first].copy(), _to_axis(model.jnt_axis[first])
    position, rotation = tree.pose(b)
    at, facing = position + rotate(rotation, place), multiply(rotation, turn)
    parent = tree.pose(above) if above else (np.zeros(3), IDENTITY)
    back = conjugate(parent[1])
    return [
        Joint.model_validate(
            {
                "prim": f"{child}/{clean(element(model, 'joint', first))}",
                "kind": kind,
                "parent": prim_of(body_name(model, above)) if above else None,
                "child": child,
                "parent_anchor": rotate(back, at - parent[0]).tolist(),
                "parent_turn": multiply(back, facing).tolist(),
                "child_anchor": place.tolist(),
                "child_turn": turn.tolist(),
                **_limits(model, first),
            }
        )
    ]


def _limits(model: Any, j: int) -> dict[str, float]:
    """From the reference pose; of a ball joint how far it turns in all."""
    if not model.jnt_limited[j] or model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_LIMIT):
        return {}
    if int(model.jnt_type[j]) == int(mujoco.mjtJoint.mjJNT_BALL):
        return {"high": float(model.jnt_range[j, 1])}
    low, high = (float(x) - float(model.qpos0[model.jnt_qposadr[j]]) for x in model.jnt_range[j])
    return {"low": low, "high": high}


def _to_axis(axis: np.ndarray) -> np.ndarray:
    """The shortest rotation of +X onto a unit axis, xyzw."""
    x, y, z = (float(c) for c in axis)
    if x < -1.0 + 1e-12:
        return np.array([0.0, 0.0, 1.0, 0.0])
    q = np.array([0.0, -z, y, 1.0 + x])
    return q / math.sqrt(float(q @ q))
