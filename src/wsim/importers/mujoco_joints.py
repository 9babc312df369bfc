"""MuJoCo's joints → a world's joints, with their springs, dampers, rotors and what drives them."""

from __future__ import annotations

import math
from typing import Any, Literal

import mujoco
import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.importers.mujoco_names import body_name, clean, element, prim_of
from wsim.importers.mujoco_tree import Tree
from wsim.scene.world import Give, Joint, Motor, Move

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
JOINT, FLAG = mujoco.mjtJoint, mujoco.mjtDisableBit
KINDS: dict[Any, Literal["revolute", "prismatic", "spherical"]] = {
    JOINT.mjJNT_HINGE: "revolute",
    JOINT.mjJNT_SLIDE: "prismatic",
    JOINT.mjJNT_BALL: "spherical",
}
FREEDOMS = {JOINT.mjJNT_FREE: 6, JOINT.mjJNT_BALL: 3}
HINGES = 3  # of a body, at most


def joints_of(model: Any, tree: Tree, b: int) -> list[Joint]:
    """What holds a body to the one that it hangs from; a free joint is none."""
    numbers = [int(model.body_jntadr[b]) + k for k in range(int(model.body_jntnum[b]))]
    if not numbers or kind_of(model, numbers[0]) == JOINT.mjJNT_FREE or why_not(model, b) is not None:
        return []
    last = numbers[-1]
    place = model.jnt_pos[last].copy()
    turn = to_axis(model.jnt_axis[last]) if len(numbers) == 1 else IDENTITY
    above, child = tree.parent(b), prim_of(body_name(model, b))
    position, rotation = tree.pose(b)
    at, facing = position + rotate(rotation, place), multiply(rotation, turn)
    parent = tree.pose(above) if above else (np.zeros(3), IDENTITY)
    back = conjugate(parent[1])
    name = clean(element(model, "joint", last)) if len(numbers) == 1 else "joints"
    return [
        Joint.model_validate(
            {
                "prim": f"{child}/{name}",
                "kind": KINDS[kind_of(model, last)],
                "parent": prim_of(body_name(model, above)) if above else None,
                "child": child,
                "parent_anchor": rotate(back, at - parent[0]).tolist(),
                "parent_turn": multiply(back, facing).tolist(),
                "child_anchor": place.tolist(),
                "child_turn": turn.tolist(),
                **(_single(model, last) if len(numbers) == 1 else _compound(model, numbers)),
            }
        )
    ]


def why_not(model: Any, b: int) -> str | None:
    """What keeps several joints of one body from being a compound joint; None where nothing does."""
    numbers = [int(model.body_jntadr[b]) + k for k in range(int(model.body_jntnum[b]))]
    if len(numbers) < 2:
        return None
    kinds = [kind_of(model, j) for j in numbers]
    hinges = [j for j, kind in zip(numbers, kinds, strict=True) if kind == JOINT.mjJNT_HINGE]
    if set(kinds) - {JOINT.mjJNT_HINGE, JOINT.mjJNT_SLIDE}:
        return f"{len(numbers)} joints of one body, one of them a ball joint"
    if set(kinds[len(kinds) - len(hinges) :]) - {JOINT.mjJNT_HINGE} or len(hinges) > HINGES:
        return f"{len(numbers)} joints of one body, in an order that is not sliders and then up to {HINGES} hinges"
    spread = any(np.linalg.norm(model.jnt_pos[j] - model.jnt_pos[hinges[-1]]) > 1e-9 for j in hinges)
    if spread and len(hinges) < len(numbers):
        return f"sliders and {len(hinges)} hinges of one body through different points"
    return None


def kind_of(model: Any, j: int) -> Any:
    """A joint's kind, as MuJoCo has it."""
    return JOINT(int(model.jnt_type[j]))


def freedoms(model: Any, j: int) -> slice:
    """A joint's degrees of freedom."""
    first = int(model.jnt_dofadr[j])
    return slice(first, first + FREEDOMS.get(kind_of(model, j), 1))


def loaded(model: Any, j: int) -> bool:
    """Whether a spring, a damper or a rotor acts along a joint."""
    dofs = freedoms(model, j)
    acting = [model.jnt_stiffness[j], *model.jnt_stiffnesspoly[j]] if _on(model, FLAG.mjDSBL_SPRING) else []
    acting += [*model.dof_damping[dofs], *model.dof_dampingpoly[dofs].ravel()] if _on(model, FLAG.mjDSBL_DAMPER) else []
    return any(value != 0.0 for value in [*acting, *model.dof_armature[dofs]])


def driven(model: Any, j: int) -> bool:
    """Whether an effort acts along a joint whose law is not stated: an actuator's, a tendon's."""
    acted = {int(model.actuator_trnid[a, 0]) for a in range(model.nu) if _by(model, a) in JOINTED} if model.nu else {}
    pulled = [t for t in range(model.ntendon) if pulls(model, t)]
    held = [w for t in pulled for w in range(model.tendon_adr[t], model.tendon_adr[t] + model.tendon_num[t])]
    threaded = {int(model.wrap_objid[w]) for w in held if model.wrap_type[w] == int(mujoco.mjtWrap.mjWRAP_JOINT)}
    return j in acted or j in threaded


JOINTED = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


def _by(model: Any, a: int) -> Any:
    return mujoco.mjtTrn(int(model.actuator_trntype[a]))


def pulls(model: Any, t: int) -> bool:
    """Whether a tendon does anything but measure."""
    acted = [a for a in range(model.nu) if _by(model, a) == mujoco.mjtTrn.mjTRN_TENDON]
    tied = [e for e in range(model.neq) if model.eq_type[e] == int(mujoco.mjtEq.mjEQ_TENDON)]
    names = ("stiffness", "stiffnesspoly", "damping", "dampingpoly", "frictionloss", "armature", "limited")
    return (
        any(np.any(getattr(model, f"tendon_{name}")[t]) for name in names)
        or any(int(model.actuator_trnid[a, 0]) == t for a in acted)
        or any(t in (int(model.eq_obj1id[e]), int(model.eq_obj2id[e])) for e in tied)
    )


def _on(model: Any, flag: Any) -> bool:
    return not model.opt.disableflags & int(flag)


def _single(model: Any, j: int) -> dict[str, Any]:
    at = int(model.jnt_qposadr[j])
    found: dict[str, Any] = {"friction": _dry(model, j)}
    if kind_of(model, j) != JOINT.mjJNT_BALL:
        found["armature"] = float(model.dof_armature[freedoms(model, j)][0])
    if loaded(model, j) or driven(model, j):
        law = not driven(model, j) and not np.any(model.jnt_stiffnesspoly[j])
        found["drive"] = Motor(
            stiffness=float(model.jnt_stiffness[j]) if _on(model, FLAG.mjDSBL_SPRING) else 0.0,
            damping=float(model.dof_damping[freedoms(model, j)][0]) if _on(model, FLAG.mjDSBL_DAMPER) else 0.0,
            position=float(model.qpos_spring[at] - model.qpos0[at]),
            told=law and not np.any(model.dof_dampingpoly[freedoms(model, j)]),
        )
    if model.jnt_limited[j] and _on(model, FLAG.mjDSBL_LIMIT | FLAG.mjDSBL_CONSTRAINT):
        low, high = (float(x) for x in model.jnt_range[j])
        if kind_of(model, j) == JOINT.mjJNT_BALL:
            return {**found, "high": high}  # how far it turns in all
        found["give"] = give_by(model, model.jnt_solref[[j]], model.jnt_solimp[[j]])
        found |= {"low": low - float(model.qpos0[at]), "high": high - float(model.qpos0[at])}
    return found


def give_by(model: Any, solref: np.ndarray, solimp: np.ndarray) -> Give:
    """How far constraints yield by their references (n, 2) and impedances (n, 5), the softest of them.

    MuJoCo's documentation, Computation: Constraint model: a time constant and a damping ratio, or stiffness and damping
    as numbers below 0; the impedance rises to its full value over a width. No time constant is below two steps.
    """
    if not len(solref):
        return Give()
    full = solimp[:, 1]
    direct = solref[:, 0] < 0.0
    limited = np.maximum(solref[:, 0], 2.0 * model.opt.timestep) * np.maximum(solref[:, 1], 0.0)
    times = full * np.where(direct, 1.0 / np.sqrt(np.maximum(-solref[:, 0], 1e-9)), limited)
    # Friction takes the share d of an acceleration a that opposes it, and by its damping 2 / t of a slip v:
    # v = (1 - d) a t / 2 d is what it leaves.
    share = np.clip(0.5 * (solimp[:, 0] + full), 0.01, 0.99)
    damped = np.where(direct, 2.0 * full / np.maximum(-solref[:, 1], 1e-9), full * np.maximum(solref[:, 0], 1e-9))
    creep = ((1.0 - share) / share * 0.5 * damped).max()
    return Give(time=float(times.max()), depth=float(solimp[:, 2].max()), creep=float(creep))


def _dry(model: Any, j: int) -> float:
    flags = FLAG.mjDSBL_FRICTIONLOSS | FLAG.mjDSBL_CONSTRAINT
    return float(model.dof_frictionloss[freedoms(model, j)].max()) if _on(model, flags) else 0.0


def _compound(model: Any, numbers: list[int]) -> dict[str, Any]:
    moves = [
        Move(
            kind="revolute" if kind_of(model, j) == JOINT.mjJNT_HINGE else "prismatic",
            axis=tuple(model.jnt_axis[j].tolist()),
            point=tuple((model.jnt_pos[j] - model.jnt_pos[numbers[-1]]).tolist()),
            acts=bool(loaded(model, j) or driven(model, j) or model.jnt_limited[j] or _dry(model, j) > 0.0),
        )
        for j in numbers
    ]
    drive = None
    if any(loaded(model, j) or driven(model, j) for j in numbers):
        drive = Motor(told=not any(driven(model, j) for j in numbers))
    return {"kind": "compound", "moves": moves, "drive": drive}


def to_axis(axis: np.ndarray) -> np.ndarray:
    """The shortest rotation of +X onto a unit axis, xyzw."""
    x, y, z = (float(c) for c in axis)
    if x < -1.0 + 1e-12:
        return np.array([0.0, 0.0, 1.0, 0.0])
    q = np.array([0.0, -z, y, 1.0 + x])
    return q / math.sqrt(float(q @ q))
