"""Contacts that we find, put among MuJoCo's own: places, normals and gaps, and the rest as MuJoCo mixes it."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.geometry.rotations import cross, lengths
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
    if not len(geoms):
        return
    contact = mujoco.MjContact()
    contact.includemargin, contact.exclude, contact.efc_address = reach, 0, -1
    contact.solreffriction[:] = contact.adhesion = 0.0
    contact.flex[:] = contact.elem[:] = contact.vert[:] = -1
    first = data.ncon
    for _ in range(len(geoms)):
        mujoco.mj_addContact(model, data, contact)
    added = data.ncon - first  # less where MuJoCo has no room for more, of which it has a warning
    geoms, ours, own = geoms[:added], data.contact, slice(first, data.ncon)
    ours.geom[own], ours.geom1[own], ours.geom2[own] = geoms, geoms[:, 0], geoms[:, 1]
    ours.dist[own], ours.pos[own], ours.frame[own] = distance[:added], position[:added], _frames(normal[:added])
    ours.solref[own], ours.solimp[own] = model.geom_solref[geoms[:, 1]], model.geom_solimp[geoms[:, 1]]
    ours.friction[own] = model.geom_friction[geoms].max(axis=1)[:, [0, 0, 1, 2, 2]]
    ours.dim[own] = model.geom_condim[geoms].max(axis=1)


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
    """Right-handed frames, row by row, (n, 9), whose first rows are normals (n, 3)."""
    first = normal.astype(float)
    first /= lengths(first)[:, None]
    other = np.where(np.abs(first[:, :1]) > 0.5, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    second = other - (other * first).sum(axis=1)[:, None] * first
    second /= lengths(second)[:, None]
    return np.concatenate([first, second, cross(first, second)], axis=1)
