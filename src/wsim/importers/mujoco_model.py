"""An MJCF or URDF file → a world: bodies, what never moves, joints and gravity, as MuJoCo compiles them."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.errors import UserError
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.geometry.shapes import Solid
from wsim.importers.mujoco_state import body_name, load_model
from wsim.scene.world import Body, Joint, Shape, Static, World

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
Pose = tuple[np.ndarray, np.ndarray]  # position (3,), quaternion xyzw (4,)


def world_of(path: Path) -> World:
    """The world of a model in its reference pose, bodies as `/World/<name>`.

    Bodies that no joint lets move are fixed objects. Shapes that neither collide with anything nor are of a kind that
    the judge knows are left out.

    Raises:
        UserError: MuJoCo does not read the file, or something collides with a shape that the judge does not know.
    """
    model = load_model(path)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    poses = [(data.xpos[b].copy(), _xyzw(data.xquat[b])) for b in range(model.nbody)]
    fixed = [model.body_weldid[b] == 0 for b in range(model.nbody)]
    bodies, statics, joints = [], [], []
    for b in range(model.nbody):
        geoms = range(model.body_geomadr[b], model.body_geomadr[b] + model.body_geomnum[b])
        if not fixed[b]:
            bodies.append(_body(model, b, poses[b], [s for g in geoms if (s := _shape(model, g, None))]))
            joints += _joints(model, b, poses, fixed)
            continue
        for g in geoms:  # each on its own where the world has them, as an object of the plan would be
            shape = _shape(model, g, poses[b])
            if shape is not None:
                statics.append((shape.prim if b == 0 else _prim(body_name(model, b)), shape))
    return World(
        combine="larger",
        name=_clean(path.stem),
        gravity=tuple(model.opt.gravity.tolist()),
        time_step=float(model.opt.timestep),
        bodies=bodies,
        statics=[
            Static(prim=prim, shapes=[shape for owner, shape in statics if owner == prim])
            for prim in dict.fromkeys(owner for owner, _ in statics)
        ],
        joints=joints,
    )


def _body(model: Any, b: int, pose: Pose, shapes: list[Shape]) -> Body:
    axes = np.stack([rotate(_xyzw(model.body_iquat[b]), axis) for axis in np.eye(3)], axis=1)
    body = Body(
        prim=_prim(body_name(model, b)),
        mass=float(model.body_mass[b]),
        volume=0.0,
        com=tuple(model.body_ipos[b].tolist()),
        inertia=tuple((axes @ np.diag(model.body_inertia[b]) @ axes.T).reshape(-1).tolist()),
        position=tuple(pose[0].tolist()),
        rotation=tuple(pose[1].tolist()),
        shapes=shapes,
    )
    if not shapes:
        raise UserError(f"{body.prim} has no shape that the judge knows; give it a collision geometry")
    return body.model_copy(update={"volume": float(Solid(body.shapes).volume)})


def _shape(model: Any, g: int, frame: Pose | None) -> Shape | None:
    """A geometry in its body's frame, or in the world's where `frame` is its fixed body's pose."""
    kinds = mujoco.mjtGeom
    name = _clean(str(model.geom(g).name) or f"geom_{g}")
    collides = bool(model.geom_contype[g] or model.geom_conaffinity[g])
    position, rotation = model.geom_pos[g].copy(), _xyzw(model.geom_quat[g])
    if frame is not None:
        position, rotation = frame[0] + rotate(frame[1], position), multiply(frame[1], rotation)
    a, b, c = (float(x) for x in model.geom_size[g])
    sizes: dict[Any, tuple[str, tuple[float, ...]]] = {
        kinds.mjGEOM_BOX: ("box", (2 * a, 2 * b, 2 * c)),  # MuJoCo has half the edges and half the lengths
        kinds.mjGEOM_SPHERE: ("sphere", (a,)),
        kinds.mjGEOM_CAPSULE: ("capsule", (a, 2 * b)),
        kinds.mjGEOM_CYLINDER: ("cylinder", (a, 2 * b)),
        kinds.mjGEOM_PLANE: ("plane", ()),
    }
    kind = mujoco.mjtGeom(int(model.geom_type[g]))
    if kind == kinds.mjGEOM_MESH:
        mesh = _mesh(model, int(model.geom_dataid[g]))
        shape_kind, size = "mesh", tuple(np.ptp(np.array(mesh["vertices"]), axis=0).tolist())
    elif kind in sizes:
        (shape_kind, size), mesh = sizes[kind], {}
    elif collides:
        raise UserError(f"geom {name} is a {kind.name[7:].lower()}, which the judge does not know; use a mesh of it")
    else:
        return None
    body = int(model.geom_bodyid[g])
    return Shape.model_validate(
        {
            "prim": _prim(name) if body == 0 else f"{_prim(body_name(model, body))}/{name}",
            "kind": shape_kind,
            "size": size,
            "position": tuple(position.tolist()),
            "rotation": tuple(rotation.tolist()),
            "color": tuple(float(x) for x in model.geom_rgba[g, :3]),
            "opacity": float(model.geom_rgba[g, 3]),
            "collides": collides,
            "friction": float(model.geom_friction[g, 0]),
            **mesh,
        }
    )


def _mesh(model: Any, mesh: int) -> dict[str, Any]:
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    face, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    return {
        "vertices": model.mesh_vert[first : first + count].tolist(),
        "triangles": model.mesh_face[face : face + faces].tolist(),
    }


def _joints(model: Any, b: int, poses: list[Pose], fixed: list[bool]) -> list[Joint]:
    """What holds a body to the one that it hangs from; a free joint is none.

    A body with several joints, or welded to one that moves, is known to hang together with it, but not how.
    """
    kinds = {
        mujoco.mjtJoint.mjJNT_HINGE: "revolute",
        mujoco.mjtJoint.mjJNT_SLIDE: "prismatic",
        mujoco.mjtJoint.mjJNT_BALL: "spherical",
    }
    above, count, first = int(model.body_parentid[b]), int(model.body_jntnum[b]), int(model.body_jntadr[b])
    if count == 1 and int(model.jnt_type[first]) == int(mujoco.mjtJoint.mjJNT_FREE):
        return []
    ends = {"parent": None if fixed[above] else _prim(body_name(model, above)), "child": _prim(body_name(model, b))}
    if count != 1:
        kind = "fixed" if count == 0 else "spherical"
        return [Joint.model_validate({"prim": f"{ends['child']}/joint", "kind": kind, **ends})]
    kind = kinds[mujoco.mjtJoint(int(model.jnt_type[first]))]
    place, turn = model.jnt_pos[first].copy(), _to_axis(model.jnt_axis[first])
    at, facing = poses[b][0] + rotate(poses[b][1], place), multiply(poses[b][1], turn)
    parent = (np.zeros(3), IDENTITY) if fixed[above] else poses[above]
    back = conjugate(parent[1])
    limited = bool(model.jnt_limited[first]) and kind != "spherical"
    low, high = (float(x) - float(model.qpos0[model.jnt_qposadr[first]]) for x in model.jnt_range[first])
    return [
        Joint.model_validate(
            {
                "prim": f"{ends['child']}/{_clean(str(model.joint(first).name) or 'joint')}",
                "kind": kind,
                **ends,
                "parent_anchor": rotate(back, at - parent[0]).tolist(),
                "parent_turn": multiply(back, facing).tolist(),
                "child_anchor": place.tolist(),
                "child_turn": turn.tolist(),
                **({"low": low, "high": high} if limited else {}),
            }
        )
    ]


def _to_axis(axis: np.ndarray) -> np.ndarray:
    """The shortest rotation of +X onto a unit axis, xyzw."""
    x, y, z = (float(c) for c in axis)
    if x < -1.0 + 1e-12:
        return np.array([0.0, 0.0, 1.0, 0.0])
    q = np.array([0.0, -z, y, 1.0 + x])
    return q / math.sqrt(float(q @ q))


def _xyzw(wxyz: np.ndarray) -> np.ndarray:
    return np.array([wxyz[1], wxyz[2], wxyz[3], wxyz[0]], dtype=np.float64)


def _prim(name: str) -> str:
    return f"/World/{_clean(name)}"


def _clean(name: str) -> str:
    """A name as a prim may have it."""
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"_{word}" if word[:1].isdigit() else word
