"""How a batch of worlds seeks the slip, and what solves it."""

from functools import partial

import mujoco_warp
import numpy as np
import pytest
import warp as wp
from mujoco_warp import SolverType

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers import solver_rigid
from wsim.solvers.contact_config import ContactConfig


def simulation_of(tmp_path, build):
    scene = Scene()
    build(scene)
    return Simulation(scene.save(tmp_path / "stage.usda"), "cpu", 2)


def plough(scene):
    scene.ground()
    motion = {"kinematic": True, "velocity": (2.0, 0, 0), "friction": 0.9}
    scene.box("plough", size=(0.2, 1, 0.4), position=(-0.3, 0, 0.21), **motion)
    scene.box("crate", size=(0.3,) * 3, density=600, position=(0, 0, 0.15), friction=0.9)


@pytest.mark.parametrize("loops", [True, False])
def test_worlds_seek_until_they_have_found_or_a_given_number_of_times(tmp_path, loops):
    """What rests takes one solution with a guess; a crate that a plough shoves more than graphs without loops give."""
    simulation = simulation_of(tmp_path, plough)
    solver = simulation.rigid.solver
    solver.mjw_model.opt.graph_conditional = loops  # without: as drivers before 12.4 have it
    config = solver.contact_config
    simulation._replays = False  # a graph would not come by here
    law, solved, turns = solver._law_warp, [0], []
    solve, seek = law._solve, law._seek

    def counted(model, data):
        solved[0] += 1
        solve(model, data)

    def sought(model, data):
        solved[0] = 0
        seek(model, data)
        turns.append(solved[0])

    law._solve, law._seek = counted, sought
    simulation.step()
    at_rest = list(turns)
    while simulation.time < (0.065 if loops else 0.04):  # the longer it is shoved, the more solutions a step takes
        simulation.step()
    assert simulation.problems() == []
    if loops:
        assert max(at_rest) == 1
        assert config.solutions_unrolled < max(turns) <= config.most_solutions + 1
    else:
        assert set(turns) == {config.solutions_unrolled}


def heap(scene):
    draw = np.random.default_rng(2)
    scene.ground()
    for k in range(12):
        at = np.array((0.11 * (k % 2), 0.11 * (k // 2 % 2), 0.07 + 0.12 * (k // 4))) + draw.uniform(-0.01, 0.01, 3)
        scene.box(
            f"box{k}", size=(0.1,) * 3, density=600, position=tuple(at), rotation_deg=tuple(draw.uniform(-15, 15, 3))
        )


def without_a_cause(solver):
    """The most that a body is accelerated by no force of the step's last solution [m/s^2]."""
    data, found = solver.mjw_data, wp.zeros_like(solver.mjw_data.qacc)
    mujoco_warp.mul_m(solver.mjw_model, data, found, data.qacc)
    left = found.numpy() - data.qfrc_smooth.numpy() - data.qfrc_constraint.numpy()
    return np.abs(left[:, : solver.mj_model.nv].reshape(2, -1, 6)[..., :3]).max() / (600 * 0.1**3)


def test_conjugate_gradients_leave_a_heap_no_more_than_rounding_does(tmp_path, monkeypatch):
    """Where a world has too many degrees of freedom to be factored, they have the turns that hard contacts need.

    Rounding alone leaves 0.1 to 0.4 m/s^2 in a heap of boxes; Newton's method leaves 0.05 here.
    """
    monkeypatch.setattr(solver_rigid, "ContactConfig", partial(ContactConfig, most_factored=10))
    simulation = simulation_of(tmp_path, heap)
    solver, left = simulation.rigid.solver, []
    assert solver.mjw_model.opt.solver == SolverType.CG
    while simulation.time < 0.08:
        simulation.step()
        left.append(without_a_cause(solver))
    assert simulation.problems() == []
    assert max(left) < 0.4
