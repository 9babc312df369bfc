"""Read URDF and MJCF by MuJoCo's own compiler: bodies with what is seen and what collides, masses, joints, limits."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import mujoco
import numpy as np
from pxr import Tf

from wsim.intake.model import Body, Collider, IntakeError, Joint, JointKind, Mesh, Model
from wsim.intake.read_usd import plain

_JOINTS: dict[int, JointKind] = {
    int(mujoco.mjtJoint.mjJNT_BALL): "spherical",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic",
    int(mujoco.mjtJoint.mjJNT_HINGE): "revolute",
}
_FREE = int(mujoco.mjtJoint.mjJNT_FREE)
_SHAPES: dict[int, Literal["sphere", "capsule", "cylinder", "box"]] = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}


def read_mujoco(path: Path) -> Model:
    """Bodies, joints and masses of a URDF or MJCF file, as they stand at the start."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.discardvisual = False  # what a URDF shows, too
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    notes = ["the friction, damping and springs of its joints are not carried"] if model.njnt else []
    notes += [f"{what} are not carried" for what, count in _left_out(model).items() if count]
    owner = _owners(model, path.name)
    names = _names([str(model.body(b).name) for b in sorted(set(owner.values()))])
    bodies = {b: _body(model, data, names[k], b, owner, notes) for k, b in enumerate(sorted(set(owner.values())))}
    taken = {body.name for body in bodies.values()} | {"Looks"}
    joints = [_joint(model, data, b, bodies, owner, taken) for b in bodies if _hangs(model, b)]
    return Model(list(bodies.values()), "z", "+x", 1.0, joints, list(dict.fromkeys(notes)))


def _left_out(model: Any) -> dict[str, int]:
    fixed = int((model.geom_bodyid == 0).sum())
    return {"actuators": model.nu, "tendons": model.ntendon, "equality constraints": model.neq, "world geoms": fixed}


def _moving(model: Any, body: int) -> list[int]:
    """The joints of a body, but for a free one."""
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    return [joint for joint in range(first, first + count) if model.jnt_type[joint] != _FREE]


def _hangs(model: Any, body: int) -> bool:
    return bool(_moving(model, body)) and int(model.body_parentid[body]) != 0


def _owners(model: Any, name: str) -> dict[int, int]:
    """Which body each is part of: without a joint it is part of what carries it.

    Raises:
        IntakeError: If there is no body, several stand apart, or one has several joints.
    """
    owner: dict[int, int] = {}
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        if len(_moving(model, body)) > 1:
            raise IntakeError(f"body = {model.body(body).name} of {name} has several joints; put a body between them")
        owner[body] = body if parent == 0 or _moving(model, body) else owner[parent]
    roots = [body for body in set(owner.values()) if int(model.body_parentid[body]) == 0]
    if len(roots) != 1:
        raise IntakeError(f"bodies = {len(roots)} of {name} stand apart; an asset is one: give each a file")
    return owner


def _names(names: list[str]) -> list[str]:
    found: list[str] = []
    for k, name in enumerate(names):
        valid = Tf.MakeValidIdentifier(name or f"body_{k}")
        found.append(valid if valid not in (*found, "Looks") else f"{valid}_{k}")
    return found


def _body(model: Any, data: Any, name: str, body: int, owner: dict[int, int], notes: list[str]) -> Body:
    """A body with all that is fixed to it."""
    mine = [b for b, of in owner.items() if of == body]
    geoms = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in mine]
    touched = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
    shown = [g for g in geoms if g not in touched] or touched
    meshes = [mesh for g in shown if (mesh := _mesh(model, data, g, notes)) is not None]
    if not meshes:
        raise IntakeError(f"body = {name} shows nothing; give it a visual mesh, or fix it to another body")
    mass = float(model.body_mass[mine].sum())
    com = inertia = None
    if mass > 0.0:
        com = (model.body_mass[mine, None] * data.xipos[mine]).sum(axis=0) / mass
        inertia = np.zeros((3, 3))
        for b in mine:
            axes, arm = data.ximat[b].reshape(3, 3), data.xipos[b] - com
            inertia += axes @ np.diag(model.body_inertia[b]) @ axes.T
            inertia += model.body_mass[b] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    colliders = [shape for g in touched if (shape := _collider(model, data, g)) is not None]
    return Body(
        name,
        meshes,
        colliders,
        mass or None,
        com,
        inertia,
        data.xpos[body].copy(),
        data.xmat[body].reshape(3, 3).copy(),
    )


def _size(model: Any, geom: int) -> tuple[float, ...]:
    """As `plain` has it; MuJoCo's are half lengths."""
    x, y, z = (float(v) for v in model.geom_size[geom])
    kind = _SHAPES[int(model.geom_type[geom])]
    return {"sphere": (x,), "box": (2 * x, 2 * y, 2 * z)}.get(kind, (x, 2 * y))


def _triangles(model: Any, geom: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Points and faces of a geom, in its frame; None of a plane, a height field or the like."""
    if int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_MESH):
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        return np.array(model.mesh_vert[first : first + count], float), np.array(model.mesh_face[start : start + faces])
    if int(model.geom_type[geom]) not in _SHAPES:
        return None
    made = plain(_SHAPES[int(model.geom_type[geom])], _size(model, geom))
    return np.asarray(made.vertices), np.asarray(made.faces)


def _mesh(model: Any, data: Any, geom: int, notes: list[str]) -> Mesh | None:
    found = _triangles(model, geom)
    if found is None:
        notes.append("planes, ellipsoids and height fields are not carried")
        return None
    material = int(model.geom_matid[geom])
    red, green, blue = (model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom])[:3]
    color = (round(float(red), 4), round(float(green), 4), round(float(blue), 4))
    name = str(model.geom(geom).name) or str(model.body(int(model.geom_bodyid[geom])).name) or "look"
    mesh = Mesh(name, found[0], found[1].astype(np.int64), color)
    return mesh.moved(data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom])


def _collider(model: Any, data: Any, geom: int) -> Collider | None:
    """As MuJoCo has it: of a mesh its hull."""
    turn, at = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]
    kind = _SHAPES.get(int(model.geom_type[geom]))
    if kind is not None and kind != "capsule":
        return Collider(kind, _size(model, geom)).moved(turn, at)
    found = _triangles(model, geom)
    return None if found is None else Collider("hull", points=found[0]).moved(turn, at)


def _joint(model: Any, data: Any, body: int, bodies: dict[int, Body], owner: dict[int, int], taken: set[str]) -> Joint:
    (joint,) = _moving(model, body)
    kind = _JOINTS[int(model.jnt_type[joint])]
    name = Tf.MakeValidIdentifier(str(model.joint(joint).name) or f"{bodies[body].name}_joint")
    while name in taken:
        name += "_joint"
    taken.add(name)
    limits = None
    if model.jnt_limited[joint] and kind != "spherical":
        low, high = model.jnt_range[joint] - model.qpos0[model.jnt_qposadr[joint]]
        limits = (float(np.degrees(low)), float(np.degrees(high))) if kind == "revolute" else (float(low), float(high))
    parent = bodies[owner[int(model.body_parentid[body])]].name
    at, axis = data.xanchor[joint].copy(), data.xaxis[joint].copy()
    return Joint(name, kind, parent, bodies[body].name, at, axis, limits)
