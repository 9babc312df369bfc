"""Contacts that we find, put among MuJoCo's own: places, normals and gaps, and the rest as MuJoCo mixes it."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.kernels.own_rows import Rows

Array = np.ndarray


def put_in_c(
    mujoco: Any, model: Any, data: Any, geoms: Array, position: Array, normal: Array, distance: Array, reach: float
) -> None:
    """Add contacts to MuJoCo's.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        data: MuJoCo's data.
        geoms: Of each contact, (n, 2).
        position: Halfway between the surfaces [m], (n, 3).
        normal: From the first geom to the second, (n, 3).
        distance: Gaps [m], (n,).
        reach: Gap at which a contact is one [m].
    """
    contact = mujoco.MjContact()
    contact.includemargin, contact.exclude, contact.efc_address = reach, 0, -1
    contact.solreffriction[:] = contact.adhesion = 0.0
    contact.flex[:] = contact.elem[:] = contact.vert[:] = -1
    friction = model.geom_friction[geoms].max(axis=1)[:, [0, 0, 1, 2, 2]]
    dims, frames = model.geom_condim[geoms].max(axis=1), _frames(normal).reshape(-1, 9)
    for k, (one, two) in enumerate(geoms.tolist()):
        contact.dist, contact.pos[:], contact.frame[:] = distance[k], position[k], frames[k]
        contact.solref[:], contact.solimp[:] = model.geom_solref[two], model.geom_solimp[two]
        contact.friction[:], contact.dim = friction[k], dims[k]
        contact.geom[:] = contact.geom1, contact.geom2 = one, two
        mujoco.mj_addContact(model, data, contact)


def rows_of(model: Any, data: Any, reach: float) -> Any:
    """MuJoCo Warp's contacts, for the kernels of `wsim.kernels.own_rows` to add to."""
    rows = Rows()
    rows.reach, rows.count = reach, data.nacon
    rows.geom_dim, rows.geom_friction = model.geom_condim, model.geom_friction
    rows.geom_solref, rows.geom_solimp = model.geom_solref, model.geom_solimp
    for name in (
        "dist", "pos", "frame", "includemargin", "friction", "solref", "solreffriction", "solimp", "dim", "geom",
        "adhesion", "type", "geomcollisionid", "efc_address", "worldid",
    ):  # fmt: skip
        setattr(rows, name, getattr(data.contact, name))
    return rows


def _frames(normal: Array) -> Array:
    """Right-handed frames (n, 3, 3) whose first rows are normals (n, 3)."""
    first = normal.astype(float)
    first /= np.linalg.norm(first, axis=1)[:, None]
    other = np.where(np.abs(first[:, :1]) > 0.5, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    second = other - (other * first).sum(axis=1)[:, None] * first
    second /= np.linalg.norm(second, axis=1)[:, None]
    return np.stack([first, second, np.cross(first, second)], axis=1)
