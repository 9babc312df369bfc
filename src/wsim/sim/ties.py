"""Joints, springs and ropes of a world under MuJoCo's numbers, for what they give to be recorded."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.recording.ties import cord_ends
from wsim.scene.world import Joint, World
from wsim.solvers.tie_impulses import WORLD, TiedCord, TiedJoint

Array = np.ndarray
OWN = ("revolute", "prismatic")  # kinds with one motion of their own


def ties_of(solver: Any, world: World) -> tuple[list[TiedJoint], list[TiedCord]]:
    """The joints and the cords of the first world, in the order in which a recording counts them.

    Args:
        solver: Newton's MuJoCo solver.
        world: What the stage states.
    """
    model, labels = solver.mj_model, [str(label) for label in solver.model.body_label]
    known = solver.mjc_body_to_newton.numpy()[0].tolist()
    body = {labels[newton]: mujoco for mujoco, newton in enumerate(known) if newton >= 0}
    names = [str(label) for label in solver.model.joint_label]
    own = {names[k]: j for j, k in enumerate(solver.mjc_jnt_to_newton_jnt.numpy()[0].tolist())}
    holds = _constraints(solver)
    joints = [_joint(joint, body, own, holds.get(joint.prim, ())) for joint in world.joints]
    tendons = solver.mjc_tendon_to_newton_tendon.numpy()[0].tolist() if model.ntendon else []
    ends = cord_ends(world)
    cords = [
        TiedCord(tendons.index(k), tuple(body[world.bodies[row].prim] for cord, row in ends if cord == k))
        for k in range(len(world.cords))  # they are added before all other tendons
    ]
    return joints, cords


def _constraints(solver: Any) -> dict[str, tuple[int, ...]]:
    """MuJoCo's equality constraints by the prim that they hold for."""
    if not solver.mj_model.neq:
        return {}
    labels = getattr(solver.model.mujoco, "equality_constraint_label", [])
    found: dict[str, tuple[int, ...]] = {}
    for eq, newton in enumerate(solver.mjc_eq_to_newton_eq.numpy()[0].tolist()):
        if newton >= 0:
            found[str(labels[newton])] = (*found.get(str(labels[newton]), ()), eq)
    return found


def _joint(joint: Joint, body: dict[str, int], own: dict[str, int], holds: tuple[int, ...]) -> TiedJoint:
    moves = joint.kind in OWN
    axis = rotate(np.array(joint.child_turn), np.eye(3)["XYZ".index(joint.axis)]) if moves else np.zeros(3)
    return TiedJoint(
        parent=WORLD if joint.parent is None else body[joint.parent],
        child=body[joint.child],
        anchor=np.array(joint.child_anchor or (0.0, 0.0, 0.0)),
        axis=np.asarray(axis),
        slides=joint.kind == "prismatic",
        joint=own.get(joint.prim, -1) if moves else -1,
        equalities=holds if joint.closing else (),
    )
