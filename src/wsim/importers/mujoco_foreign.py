"""What a MuJoCo model has that no world can hold: each is named, and its trajectories are not judged."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_equalities import linear, on
from wsim.importers.mujoco_joints import JOINTED, driven, freedoms, kind_of, loaded, pulls, why_not
from wsim.importers.mujoco_names import element, prim_of
from wsim.importers.mujoco_tree import Tree
from wsim.scene.world import Foreign


def foreign(model: Any, tree: Tree) -> list[Foreign]:
    """All of it, in the model's order."""
    parts = (_surroundings, _geometry, _joints, _tendons, _actuators, _equalities)
    return [*_bodies(model, tree), *(one for part in parts for one in part(model))]


def _of(prim: str, feature: str) -> Foreign:
    return Foreign(prim=prim, feature=feature)


def _surroundings(model: Any) -> Iterator[Foreign]:
    option = model.opt
    if option.density > 0.0 or option.viscosity > 0.0:
        what = f"a medium of density {option.density:g} kg/m^3 and viscosity {option.viscosity:g} Pa s, which drags"
        yield _of("/World", what)
    if option.enableflags & int(mujoco.mjtEnableBit.mjENBL_OVERRIDE):
        yield _of("/World", "contact parameters that override those of all pairs")
    if model.nflex:
        yield from (_of(prim_of(element(model, "flex", k)), "a deformable body (flex)") for k in range(model.nflex))


def _bodies(model: Any, tree: Tree) -> Iterator[Foreign]:
    for b in range(1, model.nbody):
        prim = prim_of(element(model, "body", b))
        weighs = [model.body_gravcomp[one] for one in tree.members(tree.root(b)) if model.body_mass[one] > 0.0]
        if tree.root(b) == b and len(set(weighs)) > 1:
            yield _of(prim, "parts of different gravity compensation (gravcomp)")
        if model.body_mocapid[b] >= 0:
            yield _of(prim, "a mocap body, which is moved by hand")
        if model.body_plugin[b] >= 0:
            yield _of(prim, "forces of a plugin")


def _geometry(model: Any) -> Iterator[Foreign]:
    for g in np.flatnonzero((model.geom_contype != 0) | (model.geom_conaffinity != 0)):
        name = prim_of(element(model, "geom", int(g)))
        kind = mujoco.mjtGeom(int(model.geom_type[g]))
        if kind == mujoco.mjtGeom.mjGEOM_SDF:
            yield _of(name, f"a collision shape of kind {kind.name[7:].lower()}")
        if model.geom_margin[g] > 0.0 and kind in (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD):
            yield _of(name, f"contacts that push from {model.geom_margin[g]:g} m away (margin)")
        if model.geom_gap[g] > 0.0:
            yield _of(name, f"contacts that do not push (gap {model.geom_gap[g]:g} m)")
        if np.any(model.geom_surfacevel[g]):
            yield _of(name, "a surface that moves (surfacevel)")
        if model.geom_adhesion[g] > 0.0:
            yield _of(name, f"a surface that sticks (adhesion {model.geom_adhesion[g]:g} N)")
    for pair in range(model.npair):
        if model.pair_margin[pair] > 0.0 or model.pair_gap[pair] > 0.0 or model.pair_adhesion[pair] > 0.0:
            yield _of(prim_of(element(model, "pair", pair)), "a contact pair with a margin, a gap or adhesion")


def _joints(model: Any) -> Iterator[Foreign]:
    for b in range(1, model.nbody):
        reason = why_not(model, b)
        if reason is not None:
            yield _of(prim_of(element(model, "body", b)), reason)
    for j in range(model.njnt):
        if kind_of(model, j) == mujoco.mjtJoint.mjJNT_FREE:
            loose = loaded(model, j) or np.any(model.dof_frictionloss[freedoms(model, j)])
            if loose or driven(model, j):
                yield _of(prim_of(element(model, "joint", j)), "damping, a spring or a drive on a body that is free")


def _tendons(model: Any) -> Iterator[Foreign]:
    """Those through points: of those along joints the joints have what they do."""
    for t in range(model.ntendon):
        if model.wrap_type[model.tendon_adr[t]] != int(mujoco.mjtWrap.mjWRAP_JOINT) and pulls(model, t):
            yield _of(prim_of(element(model, "tendon", t)), "a tendon through points in space")


def _actuators(model: Any) -> Iterator[Foreign]:
    """Those that push on bodies: of those on joints and tendons these have what they do."""
    carried = (*JOINTED, mujoco.mjtTrn.mjTRN_TENDON)
    for a in range(model.nu):
        kind = mujoco.mjtTrn(int(model.actuator_trntype[a]))
        if kind not in carried:
            what = f"an actuator that pushes on a {kind.name[6:].lower()}"
            yield _of(prim_of(element(model, "actuator", a)), what)


def _equalities(model: Any) -> Iterator[Foreign]:
    """Those that a world has no joint for: of tendons along joints the joints have what they do."""
    kinds = mujoco.mjtEq
    for e in range(model.neq):
        kind = kinds(int(model.eq_type[e]))
        if not on(model, e) or kind in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD, kinds.mjEQ_TENDON):
            continue
        hinged = kind == kinds.mjEQ_JOINT and linear(model, e)
        single = [model.body_jntnum[model.jnt_bodyid[j]] == 1 for j in _ends(model, e)] if hinged else [False]
        if not all(single):
            yield _of(prim_of(element(model, "equality", e)), f"an equality constraint ({kind.name[5:].lower()})")


def _ends(model: Any, e: int) -> tuple[int, int]:
    return int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
