"""Short runs of MuJoCo's, as files: a model of its own and its states."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import mujoco
import numpy as np

from wsim.importers import read_npz
from wsim.judge import judge
from wsim.judge.verdict import Verdict
from wsim.recording import Recording

G = 9.81
FLOOR = '<geom name="floor" type="plane" size="0 0 1"/>'


def model_of(bodies: str, rest: str = "") -> str:
    """MJCF with a step of 1 ms."""
    return f'<mujoco><option timestep="0.001"/><worldbody>{bodies}</worldbody>{rest}</mujoco>'


def recorded(
    folder: Path,
    bodies: str,
    rest: str = "",
    *,
    speeds: Mapping[int, float] | None = None,
    seconds: float = 1.0,
    gravity: float = G,
    push: float = 0.0,
    poses: bool = False,
    judged_as: str | None = None,
) -> Recording:
    """A run at 60 frames a second, read back.

    Args:
        folder: For its files.
        bodies: The worldbody's XML.
        rest: What else the model has.
        speeds: At the start, by degree of freedom.
        seconds: How long.
        gravity: Of the run; the model has 9.81.
        push: Sideways on the first body, of its weight, that the model does not have.
        poses: Without velocities.
        judged_as: Bodies of the model that it is read with, where they are others.
    """
    path, states = folder / "scene.xml", folder / "run.npz"
    path.write_text(model_of(bodies, rest))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    model.opt.gravity[2] = -gravity
    for dof, speed in (speeds or {}).items():
        data.qvel[dof] = speed
    data.xfrc_applied[1, 0] = push * G * model.body_mass[1]
    rows = []
    for step in range(round(seconds * 1000) + 1):
        if step >= round(len(rows) * 1000 / 60):
            mujoco.mj_kinematics(model, data)
            rows.append([np.copy(x) for x in (data.time, data.qpos, data.qvel, data.xpos[1:], data.xquat[1:])])
        mujoco.mj_step(model, data)
    time, qpos, qvel, xpos, xquat = (np.array(column) for column in zip(*rows, strict=True))
    names = [model.body(b).name for b in range(1, model.nbody)]
    if poses:
        np.savez(states, time=time, body_names=names, xpos=xpos, xquat=xquat)
    else:
        np.savez(states, time=time, qpos=qpos, qvel=qvel)
    if judged_as is not None:
        path.write_text(model_of(judged_as, rest))
    return read_npz(states, path)


def verdict_of(folder: Path, bodies: str, rest: str = "", **run: object) -> Verdict:
    """What the judge says of a run."""
    return judge(recorded(folder, bodies, rest, **run))  # type: ignore[arg-type]
