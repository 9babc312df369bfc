"""Arrays and names of a trajectory → a recording."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np
from pydantic import ValidationError

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.importers.differences import velocities
from wsim.importers.mujoco_model import world_of
from wsim.importers.mujoco_names import clean
from wsim.importers.mujoco_state import bodies_of_states
from wsim.recording import Frame, RecordingWriter
from wsim.recording.recording import Recording
from wsim.scene.describe import describe
from wsim.scene.world import World

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]

MODELS = (".xml", ".mjcf", ".urdf", ".usd", ".usda", ".usdc", ".json")


def read_npz(path: str | Path, model: str | Path | None = None) -> Recording:
    """Read a trajectory of rigid bodies that MuJoCo, Newton or anything else made.

    The file holds `time` (T,) [s] and the poses in one of three forms:

    - MuJoCo's state: `qpos` (T, nq) and `qvel` (T, nv), for which the model must be MJCF;
    - MuJoCo's bodies: `body_names` (B,), `xpos` (T, B, 3) [m] and `xquat` (T, B, 4) in wxyz;
    - Newton's bodies: `body_names` (B,) and `body_q` (T, B, 7), xyz and then the quaternion in xyzw.

    Bodies' velocities are `body_qd` (T, B, 6), linear of the centre of mass [m/s] and angular [rad/s], both in the
    world's frame; if they are left out they are the poses' differences. `contact_force` (T, B, 3) [N],
    `held_energy` (T,) [J] of the springs and rotors in joints, and `world` (a `wsim.scene.world.World` as JSON) may be
    there.

    Args:
        path: A NumPy .npz file.
        model: What the world is made of: MJCF or URDF (.xml, .mjcf, .urdf), a USD stage, or a World as .json; the
            file's own `world` by default. Bodies are found by name: the last part of a path will do.

    Raises:
        UserError: A file or an array is missing, or does not fit; the message names it.
    """
    path = Path(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, EOFError, ValueError, TypeError, AttributeError, BadZipFile) as error:  # EOFError: no bytes
        raise UserError(f"{path} cannot be read as a NumPy .npz file: {error}") from error
    if "time" not in arrays:
        raise UserError(f"{path} has no array time (T,) [s]; it has {sorted(arrays)}")
    if {"qpos", "qvel"} <= set(arrays):
        if model is None or Path(model).suffix not in (".xml", ".mjcf"):
            raise UserError(f"{path} holds qpos and qvel: give the MJCF that they are of with --model scene.xml")
        arrays |= bodies_of_states(Path(model), arrays["qpos"], arrays["qvel"])
    world = read_model(Path(model)) if model is not None else _own_world(path, arrays)
    try:
        return from_arrays(arrays, world, path)
    except ValueError as error:
        raise UserError(f"{path}: {error}") from error


def read_model(path: Path) -> World:
    """The world that a model file describes; UserError."""
    if not path.is_file():
        raise UserError(f"{path}: no such model")
    if path.suffix in (".xml", ".mjcf", ".urdf"):
        return world_of(path)
    if path.suffix in (".usd", ".usda", ".usdc"):
        return describe(path)
    if path.suffix == ".json":
        return _world(path.read_text(encoding="utf-8"), str(path))
    raise UserError(f"{path}: a model ends in one of {', '.join(MODELS)}")


def from_arrays(arrays: Mapping[str, Array], world: World, source: Path = Path("trajectory")) -> Recording:
    """A recording of arrays named as in `read_npz`, in the world that they are of.

    The run's duration and frame rate, and where each body starts, are taken from the arrays.

    Raises:
        ValueError: An array is missing or has the wrong shape, a body of the world has no column, or times do not
            increase.
    """
    time = np.asarray(arrays["time"], dtype=np.float64)
    if time.ndim != 1 or len(time) < 2 or not (np.diff(time) > 0.0).all():
        raise ValueError("time must be (T,) with T >= 2, increasing [s]")
    names = [str(name) for name in arrays.get("body_names", [])]
    columns = _columns(names, world)
    body_q = _poses(arrays, (len(time), len(names)))[:, columns]
    velocity = _array(arrays, "body_qd", (len(time), len(names), 6))
    force = _array(arrays, "contact_force", (len(time), len(names), 3))
    body_qd = velocities(time, body_q, world) if velocity is None else velocity[:, columns]
    metadata: dict[str, Any] = {"complete": True, "imported_from": str(source), "velocities": "own"}
    if velocity is None:  # they are known no better than frames follow one another
        metadata |= {"velocities": "differences", "time_step": float(np.median(np.diff(time)))}
    impulse, work = _lifted(world, time, body_q)
    return Recording(
        path=source,
        world=_started(world, time, body_q, body_qd),
        metadata=metadata,
        time=time,
        body_q=body_q.astype(np.float32),
        body_qd=body_qd.astype(np.float32),
        contact_force=np.zeros((*body_q.shape[:2], 3), np.float32) if force is None else force[:, columns],
        fluids={},
        scalars=_work(arrays, world, len(time)),
        log=[],
        images={},
        applied_impulse=impulse,
        applied_work=work,
    )


def save(recording: Recording, path: Path) -> Path:
    """Write an imported recording as wsim's own, so that a viewer opens it."""
    metadata = {key: value for key, value in recording.metadata.items() if key != "complete"}
    with RecordingWriter(path, recording.world, metadata) as writer:
        for k, t in enumerate(recording.time):
            writer.frame(float(t), Frame(recording.body_q[k], recording.body_qd[k], recording.contact_force[k]))
    return path


def _lifted(world: World, time: Array, body_q: Array) -> tuple[Array | None, Array | None]:
    """Impulse and work of what carries a share of bodies' weights; None where nothing does."""
    share = np.array([body.lift * body.mass for body in world.bodies])
    if not share.any():
        return None, None
    com = np.array([body.com for body in world.bodies])
    centre = body_q[:, :, :3] + rotate(body_q[:, :, 3:], np.broadcast_to(com, body_q[:, :, :3].shape))
    force = -share[:, None] * np.array(world.gravity)
    impulse = np.diff(time, prepend=time[0])[:, None, None] * force
    work = np.einsum("bi,tbi->tb", force, np.diff(centre, axis=0, prepend=centre[:1]))
    return impulse, work


def _work(arrays: Mapping[str, Array], world: World, frames: int) -> dict[str, Array]:
    """What springs and rotors in joints gave since the frame before [J], where nothing else drives any."""
    held = _array(arrays, "held_energy", (frames,))
    if held is None or not all(joint.drive.told for joint in world.joints if joint.drive is not None):
        return {}
    return {"work/drives": -np.diff(held, prepend=held[0])}


def _own_world(path: Path, arrays: Mapping[str, Array]) -> World:
    if "world" not in arrays:
        raise UserError(
            f"{path} does not say what its bodies are; give the model with --model ({', '.join(MODELS)}), or keep a "
            "World as JSON in an array called world"
        )
    return _world(str(arrays["world"]), f"{path}: world")


def _world(text: str, where: str) -> World:
    try:
        return World.model_validate_json(text)
    except (ValidationError, json.JSONDecodeError) as error:
        raise UserError(f"{where} is no World: {error}") from error


def _columns(names: Sequence[str], world: World) -> list[int]:
    """The column of each of the world's bodies, by whole name or by the last part of a path."""
    last = {name.rsplit("/", 1)[-1]: k for k, name in reversed(list(enumerate(names)))}
    known = {clean(name): k for name, k in last.items()} | last | {name: k for k, name in enumerate(names)}
    missing = [body.prim for body in world.bodies if body.prim not in known and body.prim.split("/")[-1] not in known]
    if missing:
        raise ValueError(f"body_names has no {', '.join(missing)} of the model; it has {', '.join(names) or 'nothing'}")
    return [known.get(body.prim, known.get(body.prim.split("/")[-1], -1)) for body in world.bodies]


def _poses(arrays: Mapping[str, Array], shape: tuple[int, int]) -> Array:
    """Poses (T, B, 7), xyzw, from Newton's array or from MuJoCo's two."""
    body_q = _array(arrays, "body_q", (*shape, 7))
    if body_q is not None:
        return body_q
    position, wxyz = _array(arrays, "xpos", (*shape, 3)), _array(arrays, "xquat", (*shape, 4))
    if position is None or wxyz is None:
        raise ValueError(f"no poses: give body_q, xpos and xquat, or qpos and qvel; it has {sorted(arrays)}")
    return np.concatenate([position, wxyz[..., [1, 2, 3, 0]]], axis=-1)


def _array(arrays: Mapping[str, Array], name: str, shape: tuple[int, ...]) -> Array | None:
    if name not in arrays:
        return None
    array = np.asarray(arrays[name], dtype=np.float64)
    if array.shape != shape:
        count = len(arrays.get("body_names", []))
        raise ValueError(f"{name} has shape {array.shape}; with {shape[0]} times and {count} names it must be {shape}")
    return array


def _started(world: World, time: Array, body_q: Array, body_qd: Array) -> World:
    """The world with the trajectory's duration, frame rate and first frame; what is led keeps its stated velocity."""
    bodies = []
    for i, body in enumerate(world.bodies):
        start: dict[str, object] = {"position": tuple(map(float, body_q[0, i, :3]))}
        start["rotation"] = tuple(map(float, body_q[0, i, 3:]))
        if not body.kinematic:
            start["velocity"] = tuple(map(float, body_qd[0, i, :3]))
            start["angular_velocity"] = tuple(map(float, body_qd[0, i, 3:]))
        bodies.append(body.model_copy(update=start))
    rate = 1.0 / float(np.median(np.diff(time)))
    return world.model_copy(update={"bodies": bodies, "duration": float(time[-1]), "frame_rate": rate})
