"""What a MuJoCo model has that no world can hold: each is named, and its trajectories are not judged."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_names import element, prim_of
from wsim.importers.mujoco_tree import Tree
from wsim.scene.world import Foreign


def foreign(model: Any, tree: Tree) -> list[Foreign]:
    """All of it, in the model's order."""
    parts = (_surroundings, _bodies, _geometry, _joints, _tendons, _actuators, _equalities)
    return [one for part in parts for one in part(model)]


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


def _bodies(model: Any) -> Iterator[Foreign]:
    for b in range(1, model.nbody):
        prim = prim_of(element(model, "body", b))
        if model.body_gravcomp[b] != 0.0:
            yield _of(prim, f"gravity compensation (gravcomp {model.body_gravcomp[b]:g})")
        if model.body_mocapid[b] >= 0:
            yield _of(prim, "a mocap body, which is moved by hand")
        if model.body_plugin[b] >= 0:
            yield _of(prim, "forces of a plugin")
        if model.body_jntnum[b] > 1:
            yield _of(prim, f"{model.body_jntnum[b]} joints of one body")


def _geometry(model: Any) -> Iterator[Foreign]:
    for g in np.flatnonzero((model.geom_contype != 0) | (model.geom_conaffinity != 0)):
        name = prim_of(element(model, "geom", int(g)))
        kind = mujoco.mjtGeom(int(model.geom_type[g]))
        if kind == mujoco.mjtGeom.mjGEOM_SDF:
            yield _of(name, f"a collision shape of kind {kind.name[7:].lower()}")
        if model.geom_margin[g] > 0.0:
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
    for j in range(model.njnt):
        first = int(model.jnt_dofadr[j])
        kind = mujoco.mjtJoint(int(model.jnt_type[j]))
        count = {mujoco.mjtJoint.mjJNT_FREE: 6, mujoco.mjtJoint.mjJNT_BALL: 3}.get(kind, 1)
        dofs = slice(first, first + count)
        prim = prim_of(element(model, "joint", j))
        springs = model.jnt_stiffness[j] != 0.0 or np.any(model.jnt_stiffnesspoly[j])
        if springs:
            yield _of(prim, "a joint's spring (stiffness)")
        if np.any(model.dof_damping[dofs]) or np.any(model.dof_dampingpoly[dofs]):
            yield _of(prim, "a joint's damping")
        if np.any(model.dof_armature[dofs]):
            yield _of(prim, "a joint's rotor (armature)")
        if np.any(model.dof_frictionloss[dofs]):
            yield _of(prim, "a joint's dry friction (frictionloss)")


def _tendons(model: Any) -> Iterator[Foreign]:
    for t in range(model.ntendon):
        yield _of(prim_of(element(model, "tendon", t)), "a tendon")


def _actuators(model: Any) -> Iterator[Foreign]:
    for a in range(model.nu):
        yield _of(prim_of(element(model, "actuator", a)), "an actuator")


def _equalities(model: Any) -> Iterator[Foreign]:
    for e in range(model.neq):
        kind = mujoco.mjtEq(int(model.eq_type[e])).name[5:].lower()
        yield _of(prim_of(element(model, "equality", e)), f"an equality constraint ({kind})")
