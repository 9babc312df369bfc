"""What bodies do is kept on the device: the same numbers as are read from state and solver frame by frame."""

from functools import partial

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.collect import collect

WORLDS, G = 3, 9.81


def stage_of(folder):
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=50.0)
    scene.ground(friction=0.5)
    scene.box("low", size=(0.2,) * 3, mass=2.0, position=(0.0, 0.0, 0.1))
    scene.box("high", size=(0.2,) * 3, mass=1.0, position=(0.02, 0.0, 0.3))
    scene.sphere("ball", radius=0.1, mass=0.5, position=(1.0, 0.0, 0.102), velocity=(1.0, 0.0, -0.5), restitution=0.5)
    return scene.save(folder / "stage.usda")


def told_by(simulation):
    """Forces (W, bodies, 3) and deepest contacts (W,), worked out from the solver's rows by NumPy."""
    data, model = simulation.rigid.solver.mjw_data, simulation.model
    count, worlds = int(data.nacon.numpy()[0]), model.world_count
    force, deepest = np.zeros((model.body_count, 3)), np.zeros(worlds)
    shapes = simulation.rigid.solver.mjc_geom_to_newton_shape.numpy()
    bodies, contact = np.append(model.shape_body.numpy(), -1), data.contact
    for k in range(count):
        w, rows = int(contact.worldid.numpy()[k]), contact.efc_address.numpy()[k]
        deepest[w] = max(deepest[w], -float(contact.dist.numpy()[k]))
        if rows[0] < 0:
            continue
        push = contact.frame.numpy()[k].reshape(3, 3).T.astype(float) @ data.efc.force.numpy()[w, rows[:3]]
        for geom, sign in zip(contact.geom.numpy()[k], (-1.0, 1.0), strict=True):
            if bodies[shapes[w, geom]] >= 0:
                force[bodies[shapes[w, geom]]] += sign * push
    return force.reshape(worlds, -1, 3), deepest


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_tracks_are_what_the_state_and_the_solver_say(tmp_path, device):
    """On a GPU two runs add up in different orders: what rests creeps by 1e-7 m/s, in each by its own.

    Of 2 kg in a step of 1.25 ms that is 2e-4 N. Half a metre up, single precision has steps of 3e-8 m.
    """
    stage = stage_of(tmp_path)
    kept = collect(Simulation(stage, device=device, world_count=WORLDS, seeds=range(WORLDS)))
    simulation = Simulation(stage, device=device, world_count=WORLDS, seeds=range(WORLDS))
    rows, same = simulation.built.bodies, np.array_equal if device == "cpu" else partial(np.allclose, atol=1e-5)
    near, depth = (1e-4, 1e-9) if device == "cpu" else (1e-3, 3e-8)  # [N], [m]
    for frame in range(len(kept.time)):
        if frame:
            simulation.advance_frame()
        force, deepest = told_by(simulation)
        q, qd = (
            array.numpy().reshape(WORLDS, len(force[0]), -1)
            for array in (simulation.state.body_q, simulation.state.body_qd)
        )
        assert same(kept.body_q[:, frame], q[:, rows])
        assert same(kept.body_qd[:, frame], qd[:, rows])
        assert kept.contact_force[:, frame] == pytest.approx(force[:, rows], rel=1e-5, abs=near)
        assert kept.penetration[:, frame] == pytest.approx(deepest, rel=1e-6, abs=depth)


def test_what_stands_is_pressed_by_what_it_carries(tmp_path):
    """Over the second half of the run the ground carries both boxes, and the lower one the upper."""
    for worlds in (1, WORLDS):  # in C, and by MuJoCo Warp
        kept = collect(Simulation(stage_of(tmp_path), device="cpu", world_count=worlds))
        names = [body.prim.rsplit("/", 1)[-1] for body in kept.world.bodies]
        mean = kept.contact_force[:, 5:].mean(axis=1)
        for name, mass in (("low", 2.0), ("high", 1.0)):  # net: the lower one's own weight
            assert mean[:, names.index(name)] == pytest.approx(np.tile([0.0, 0.0, mass * G], (worlds, 1)), abs=0.05)
