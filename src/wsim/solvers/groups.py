"""Which bodies joints tie together: what hits one of them is felt by all in the same instant, and they move as one."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray
FREE = 6  # degrees of freedom of what no joint holds


def tied_groups(mujoco: Any, model: Any) -> Array:
    """Of each of MuJoCo's bodies the number of its group, (bodies,): 0 for what is fixed to the world.

    Joints are trees, and equalities that act tie two trees; what hangs on the world by joints is a group of its own.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
    """
    kinds, groups = mujoco.mjtObj, np.asarray(model.body_treeid + 1)
    owners = {int(kinds.mjOBJ_BODY): np.arange(model.nbody), int(kinds.mjOBJ_SITE): model.site_bodyid}
    gear = int(mujoco.mjtEq.mjEQ_JOINT)  # of which MuJoCo leaves the kind of its ends unsaid
    for k in np.flatnonzero(model.eq_active0):
        owner = model.jnt_bodyid if model.eq_type[k] == gear else owners.get(int(model.eq_objtype[k]))
        if owner is None or model.eq_obj2id[k] < 0:
            continue
        one, two = (int(groups[owner[end[k]]]) for end in (model.eq_obj1id, model.eq_obj2id))
        if one and two:
            groups[groups == max(one, two)] = min(one, two)
    return groups


def mechanisms(mujoco: Any, model: Any, groups: Array, stated: Array, *, driven: bool) -> Array:
    """Of each of MuJoCo's bodies the number of its mechanism, (bodies,): 0 for what is of none.

    A mechanism is a group with a joint, or what springs and ropes tie to it or to each other, or what a spring or a
    damper pulls, all of which its smooth step moves: one with a part that goes as stated is none.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        groups: Of the bodies (`tied_groups`).
        stated: Whether a body goes as is stated, (bodies,).
        driven: Whether what has a drive that is a constraint row may be one.
    """
    together, barred = groups.copy(), set(groups[stated].tolist())
    sprung, gives = np.zeros(model.nbody, dtype=bool), (model.tendon_stiffness > 0.0) | (model.tendon_damping > 0.0)
    for tendon in range(model.ntendon):
        bodies = tendon_bodies(mujoco, model, tendon)
        sprung[bodies] |= gives[tendon]
        own = sorted({int(together[body]) for body in bodies} - {0})
        if not driven and model.wrap_type[model.tendon_adr[tendon]] == mujoco.mjtWrap.mjWRAP_JOINT:
            barred |= {int(groups[body]) for body in bodies}
        together[np.isin(together, own)] = own[0] if own else 0
    barred = {int(together[body]) for body in np.flatnonzero(np.isin(groups, list(barred)))} | {0}
    found = np.zeros(model.nbody, dtype=int)
    for number in sorted(set(together.tolist()) - barred):
        parts = np.flatnonzero(together == number)
        if len(parts) > 1 or np.count_nonzero(model.dof_bodyid == parts[0]) < FREE or sprung[parts[0]]:
            found[parts] = found.max() + 1
    return found


def joint_root(model: Any, one: int, two: int) -> int:
    """The body that two bodies both hang on, which may be one of them; 0 where that is the world."""
    above = {one}
    while one:
        one = int(model.body_parentid[one])
        above.add(one)
    while two not in above:
        two = int(model.body_parentid[two])
    return two


def tendon_bodies(mujoco: Any, model: Any, tendon: int) -> list[int]:
    """The bodies that a tendon pulls or runs round."""
    owners = {
        int(mujoco.mjtWrap.mjWRAP_JOINT): model.jnt_bodyid,
        int(mujoco.mjtWrap.mjWRAP_SITE): model.site_bodyid,
        int(mujoco.mjtWrap.mjWRAP_SPHERE): model.geom_bodyid,
        int(mujoco.mjtWrap.mjWRAP_CYLINDER): model.geom_bodyid,
    }
    first = model.tendon_adr[tendon]
    ways = range(first, first + model.tendon_num[tendon])
    return [int(owners[kind][model.wrap_objid[k]]) for k in ways if (kind := int(model.wrap_type[k])) in owners]
