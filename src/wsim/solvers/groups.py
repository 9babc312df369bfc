"""Which bodies joints tie together: what hits one of them is felt by all in the same instant."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def tied_groups(mujoco: Any, model: Any) -> Array:
    """Of each of MuJoCo's bodies the number of its group, (bodies,): 0 for what is fixed to the world.

    Joints are trees, and equalities that act tie two trees; what hangs on the world by joints is a group of its own.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
    """
    kinds, groups = mujoco.mjtObj, np.asarray(model.body_treeid + 1)
    owners = {
        int(kinds.mjOBJ_BODY): np.arange(model.nbody),
        int(kinds.mjOBJ_SITE): model.site_bodyid,
        int(kinds.mjOBJ_JOINT): model.jnt_bodyid,
    }
    for k in np.flatnonzero(model.eq_active0):
        owner = owners.get(int(model.eq_objtype[k]))
        if owner is None or model.eq_obj2id[k] < 0:
            continue
        one, two = (int(groups[owner[end[k]]]) for end in (model.eq_obj1id, model.eq_obj2id))
        if one and two:
            groups[groups == max(one, two)] = min(one, two)
    return groups
