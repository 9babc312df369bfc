"""Worlds that differ in numbers, simulated as one batch: each moves as it does beside copies of itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from wsim.scene import Drive, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.alike import alike, topology
from wsim.sim.collect import collect

DURATION = 0.25  # [s]
Build = Callable[[Scene, np.random.Generator], None]


def loose(scene: Scene, draw: np.random.Generator) -> None:
    """Sizes, masses, starts, friction, restitution, gravity; what tumbles."""
    scene.simulation(duration=DURATION, gravity=(0.0, 0.0, -float(draw.uniform(3.0, 15.0))))
    surface = {"friction": draw.uniform(0.1, 0.9), "restitution": draw.uniform(0.1, 0.9)}
    scene.ground(**surface)
    size, speed = draw.uniform(0.2, 0.5), draw.uniform(1.0, 3.0)
    edges = (size, 0.8 * size, 0.6 * size)
    scene.box("slider", size=edges, mass=draw.uniform(1, 9), position=(0, 0, edges[2] / 2), velocity=(speed, 0, 0))
    scene.sphere("ball", radius=0.1 + size / 5, position=(0, 2, 1), density=draw.uniform(200, 5000), **surface)
    scene.box(
        "tumbler", size=(0.3, 0.2, size / 4), mass=1.0, position=(0, 6, 2), angular_velocity_deg=(300, 60 * speed, 500)
    )


def carried(scene: Scene, draw: np.random.Generator) -> None:
    """Rolling resistance, a belt, a pair's own law."""
    scene.simulation(duration=DURATION)
    size, speed = draw.uniform(0.2, 0.5), draw.uniform(1.0, 3.0)
    scene.ground(friction=draw.uniform(0.1, 0.9))
    scene.sphere(
        "roller", radius=size / 2, mass=1.0, position=(0, 4, size / 2), velocity=(speed, 0, 0), rolling=True,
        rolling_friction=draw.uniform(0.01, 0.05),
    )  # fmt: skip
    belt = scene.box("belt", size=(3, 1, 0.1), position=(0, 8, 0.05), static=True)
    scene.surface_velocity(belt, velocity=(speed, 0.0, 0.0))
    load = scene.box("load", size=(0.2, 0.2, 0.2), mass=2.0, position=(0, 8, 0.2))
    scene.contact(belt, load, friction=draw.uniform(0.1, 0.5))


def held(scene: Scene, draw: np.random.Generator) -> None:
    """Anchors, arms, starts, stops, drives and their bounds, dry friction, springs, ropes, gears, what breaks."""
    scene.simulation(duration=DURATION)
    arm, rate = draw.uniform(0.4, 0.8), draw.uniform(1.0, 4.0)
    scene.box("bob", size=(arm, 0.05, 0.05), mass=draw.uniform(1, 5), position=(arm / 2, 0, 2),
              angular_velocity_deg=(0, math.degrees(rate), 0), velocity=(0, 0, -rate * arm / 2))  # fmt: skip
    scene.joint_revolute("hinge", None, "bob", anchor=(0, 0, 2), axis="Y", friction=draw.uniform(0.1, 0.5),
                         limits_deg=(-200, draw.uniform(5, 20)))  # fmt: skip
    drive = Drive(stiffness=draw.uniform(20, 60), damping=draw.uniform(1, 5), position=30 * rate, max_force=rate * 3)
    scene.box("driven", size=(arm, 0.1, 0.1), mass=1.0, position=(0, 1, 2))
    scene.joint_revolute("motor", None, "driven", anchor=(0, 1, 2), axis="Z", drive=drive)
    scene.box("follower", size=(arm, 0.1, 0.1), mass=1.0, position=(1, 1, 2))
    scene.joint_revolute("geared", None, "follower", anchor=(1, 1, 2), axis="Z")
    scene.gear("teeth", "motor", "geared", ratio=-draw.uniform(0.5, 2.0))
    scene.box("weight", size=(0.1, 0.1, 0.1), mass=draw.uniform(0.5, 2), position=(0, 2, 1))
    scene.spring("coil", None, "weight", stiffness=draw.uniform(50, 200), damping=0.5, anchor_a=(0, 2, 2))
    scene.box("tied", size=(0.1, 0.1, 0.1), mass=1.0, position=(draw.uniform(0.3, 0.6), 3, 2))
    scene.rope("rope", None, "tied", anchor_a=(0, 3, 2), length=draw.uniform(0.62, 0.8))
    scene.box("hung", size=(0.1, 0.1, 0.1), mass=2.0, position=(0, 4, 1))
    scene.joint_fixed("glue", None, "hung", anchor=(0, 4, 1.05), break_force=draw.choice([10.0, 40.0]))


@pytest.mark.parametrize("build", [loose, carried, held])
def test_each_world_moves_as_among_copies_of_itself(tmp_path: Path, build: Build) -> None:
    stages = _stages(tmp_path, build, 3)
    batch = collect(Simulation(stages, "cpu"))
    for k, stage in enumerate(stages):
        alone = collect(Simulation(stage, "cpu", world_count=2, time_step=batch.metadata["time_step"]))
        assert batch.worlds[k] == alone.world
        np.testing.assert_allclose(batch.body_q[k], alone.body_q[0], atol=2e-5)
        np.testing.assert_allclose(batch.body_qd[k], alone.body_qd[0], atol=2e-3)
        for name, values in alone.scalars.items():
            # Each solution may leave 0.02 m/s^2 of a body's acceleration without a cause (`ContactConfig.unbalanced`).
            off = 2 * 0.02 * 2.5 if name.startswith("force/") else 1e-2
            np.testing.assert_allclose(batch.scalars[name][k], values[0], rtol=1e-3, atol=off, err_msg=name)
    assert np.abs(batch.body_q[1:] - batch.body_q[:1]).max(axis=(0, 1, 3)).min() > 1e-3  # they do differ
    assert np.abs(batch.body_q - batch.body_q[:, :1]).max(axis=(0, 1, 3)).min() > 1e-2  # and move


def led(scene: Scene, draw: np.random.Generator) -> None:
    """A path, and triangles to roll on; both are of the world, not its numbers."""
    scene.ground()
    lift = scene.box("lift", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
    scene.path(lift, times=(0, 0.1, 0.2), positions=((0, 0, 0.5), (0, 0, 0.56), (0, 0, 0.5)))
    scene.box("load", size=(0.3,) * 3, density=600.0, position=(0, 0, 0.7))
    scene.height_field("slope", heights=lambda x, y: 0.3 * x, size=(2, 2), cells=(8, 8), position=(0, 3, 1))
    scene.sphere("ball", radius=0.1, density=600.0, position=(0, 3, 1.12), velocity=(draw.uniform(1.0, 2.0), 0, 0))


@pytest.mark.parametrize("pushed", [False, True])
@pytest.mark.parametrize("build", [loose, carried, held, led])
def test_steps_that_are_replayed_are_the_steps(tmp_path: Path, build: Build, pushed: bool) -> None:
    """Bit for bit, and with what a controller has pushed with at the time."""
    stages = _stages(tmp_path, build, 2)
    replayed, one_by_one = (Simulation(stages, "cpu") for _ in range(2))
    for k in range(40):
        if pushed and k % 10 == 5:
            for simulation in (replayed, one_by_one):
                force = simulation.control_force.numpy()
                force[..., 2] = 1e-2 * k
                simulation.control_force.assign(force)
                simulation._steered = True
        replayed.step()
        one_by_one._push_and_move()
    for array in ("body_q", "body_qd", "joint_q"):
        ours, theirs = (getattr(simulation.state, array).numpy() for simulation in (replayed, one_by_one))
        assert np.abs(theirs).max() > 0.0
        assert (ours == theirs).all(), array


def test_a_world_that_breaks_leaves_the_others_as_they_are(tmp_path: Path) -> None:
    stages, states = _stages(tmp_path, loose, 3), []
    for broken in (False, True):
        simulation = Simulation(stages, "cpu")
        if broken:
            speeds = simulation.state.joint_qd.numpy().reshape(3, -1)
            speeds[1] = np.nan
            simulation.state.joint_qd.assign(speeds.ravel())
        trajectories = collect(simulation)
        states.append(trajectories.body_q)
        assert [bool(problems) for problems in trajectories.problems] == [False, broken, False]
    sound, beside = states
    assert np.array_equal(sound[[0, 2]], beside[[0, 2]])
    assert not np.isfinite(beside[1, -1]).all()


def test_worlds_are_sorted_by_what_they_are_made_of(tmp_path: Path) -> None:
    worlds = [describe(stage) for stage in _stages(tmp_path, loose, 2) + _stages(tmp_path, held, 2)]
    assert alike(worlds) == [[0, 1], [2, 3]]
    bob = worlds[2].joints[0]
    for change in ({"high": None}, {"friction": 0.0}, {"axis": "X"}):
        joints = [bob.model_copy(update=change), *worlds[2].joints[1:]]
        assert topology(worlds[2].model_copy(update={"joints": joints})) != topology(worlds[2]), change
    joints = [bob.model_copy(update={"high": 0.0, "friction": 7.0}), *worlds[2].joints[1:]]
    assert topology(worlds[2].model_copy(update={"joints": joints})) == topology(worlds[2])


def test_other_worlds_are_no_batch(tmp_path: Path) -> None:
    stages = _stages(tmp_path, loose, 1) + _stages(tmp_path, held, 1)
    with pytest.raises(ValueError, match=r"held_0.usda is another world than .*loose_0.usda"):
        Simulation(stages, "cpu")
    with pytest.raises(ValueError, match="world_count=3: 2 stages are as many worlds"):
        Simulation(stages, "cpu", world_count=3)


def _stages(folder: Path, build: Build, count: int) -> list[Path]:
    stages = []
    for k in range(count):
        scene = Scene()
        build(scene, np.random.default_rng(k))
        stages.append(folder / f"{build.__name__}_{k}.usda")
        scene.save(stages[-1])
    return stages
