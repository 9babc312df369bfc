"""Runs of worlds with springs and ropes, for their tests."""

import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation


def run(tmp_path, device, build, seconds, worlds=1, rate=100.0):
    """The time step, and position and velocity of each body by name, (frames, 3) each."""
    scene = Scene()
    scene.simulation(frame_rate=rate)
    build(scene)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), device, worlds)
    poses, twists = [], []
    for frame in range(round(seconds * rate) + 1):
        if frame:
            simulation.advance_frame()
        poses.append(simulation.state.body_q.numpy().astype(float))
        twists.append(simulation.state.body_qd.numpy().astype(float))
    assert simulation.problems() == []
    names = [body.prim.rsplit("/", 1)[1] for body in simulation.world.bodies]
    rows = dict(zip(names, simulation.built.bodies, strict=True))
    # The last world of a batch: what holds there holds in all.
    last = simulation.model.body_count // max(1, simulation.model.world_count) * (worlds - 1)
    q = {name: np.array(poses)[:, row + last, :3] for name, row in rows.items()}
    v = {name: np.array(twists)[:, row + last, :3] for name, row in rows.items()}
    return simulation.dt, q, v


def period(values, rate=100.0):
    """Mean time between rising crossings of the mean [s]."""
    k = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    crossings = (k - values[k] / (values[k + 1] - values[k])) / rate
    return np.diff(crossings).mean()
