"""Steps in one go are the steps one by one."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from wsim.scene import Drive, Level, Noise, Scene
from wsim.sim import Simulation

EXAMPLES = Path(__file__).parents[2] / "examples"
FRAMES = 12
ROUNDING = 2.0**-23  # of single precision, of which Newton's arrays are


def pair(tmp_path: Path, build, controller=None) -> tuple[Simulation, Simulation]:
    """Two of a world: one to be stepped in one go, one step by step."""
    scene = Scene()
    build(scene)
    scene.save(tmp_path / "stage.usda")
    stage = tmp_path / "stage.usda"
    at_once, one_by_one = (Simulation(stage, "cpu", controller=controller) for _ in range(2))
    assert at_once.rigid is not None
    assert at_once.rigid.alone
    return at_once, one_by_one


def frame(at_once: Simulation, one_by_one: Simulation) -> None:
    at_once.advance_frame()
    for _ in range(one_by_one.substeps):
        one_by_one.step()
    assert at_once.time == one_by_one.time


def example(name: str):
    return runpy.run_path(str(EXAMPLES / f"{name}.py"))["build"]


@pytest.mark.parametrize(
    "name", ["stack_and_ball", "double_pendulum", "breaking_chain", "pulleys", "rack_and_pinion", "crank_ram"]
)
def test_a_frame_in_one_go_is_its_steps(tmp_path: Path, name: str) -> None:
    """Bit for bit."""
    both = pair(tmp_path, example(name))
    for _ in range(FRAMES):
        frame(*both)
    for array in ("body_q", "body_qd", "joint_q"):
        ours, theirs = (getattr(simulation.state, array).numpy() for simulation in both)
        assert np.abs(theirs).max() > 0.0
        assert (ours == theirs).all(), array


def rough(scene: Scene) -> None:
    """A cart drives, a ball and a box roll and slide, on ground of triangles that is curved."""
    scene.simulation(duration=1.0, frame_rate=60.0)
    land = scene.terrain(
        "land", size=(12.0, 8.0), cell=0.5, layers=[Noise(0.3, 4.0, octaves=2, seed=3), Level((0.0, 0.0), 1.0)]
    )
    cart = scene.vehicle("cart", "cart", position=land.place(0.0, 0.0))
    cart.drive(speed=2.0)
    scene.sphere("ball", radius=0.15, density=800.0, position=(2.0, 2.5, 1.0), velocity=(0.5, -1.0, 0.0))
    scene.box("box", size=(0.3, 0.2, 0.2), density=800.0, position=(-2.0, -2.0, 1.0), velocity=(1.0, 0.5, 0.0))


def test_what_touches_a_surface_in_one_go_goes_as_step_by_step(tmp_path: Path) -> None:
    """Newton's velocities, of which the surface is told the ways, are worked out along joints in single precision."""
    both = pair(tmp_path, rough)
    for _ in range(30):
        frame(*both)
    poses, twists = ([getattr(simulation.state, name).numpy() for simulation in both] for name in ("body_q", "body_qd"))
    assert np.abs(twists[1]).max() > 1.0
    assert np.abs(poses[0] - poses[1]).max() < 8.0 * ROUNDING * np.abs(poses[1]).max()
    # What rolls over curves amplifies it: the slope of the surface, and so each push, goes by where it is.
    assert np.abs(twists[0] - twists[1]).max() < 64.0 * ROUNDING * np.abs(twists[1]).max()


class Pushes:
    """Turns an arm, pushes its joint and the arm, and lets a free body be pushed as well."""

    def __call__(self, t: float, simulation: Simulation) -> None:
        targets, forces = simulation.control.joint_target_q.numpy(), simulation.control.joint_f.numpy()
        labels = [str(label) for label in simulation.model.joint_label]
        dof = int(simulation.model.joint_qd_start.numpy()[labels.index("/World/hinge")])
        moved = np.full(1, 0.4 * np.sin(9.0 * t) - targets[dof], dtype=np.float32)
        assert simulation.rigid is not None and simulation.rigid.ledger is not None
        simulation.rigid.ledger.retarget(np.array([dof]), moved)
        targets[dof] += moved[0]
        forces[dof] = 3.0 * np.cos(5.0 * t)
        simulation.control.joint_target_q.assign(targets)
        simulation.control.joint_f.assign(forces)
        push = np.array([1.0, -2.0, 5.0, 0.3, 0.2, -0.1], dtype=np.float32)
        assert simulation.control_force is not None
        simulation.control_force.assign(np.tile(push * np.sin(3.0 * t), (simulation.model.body_count, 1)))


def pushed(scene: Scene) -> None:
    scene.simulation(duration=1.0, frame_rate=60.0)
    scene.ground()
    drive = Drive(stiffness=80.0, damping=1.0, max_force=30.0)
    arm = scene.box("arm", size=(0.6, 0.05, 0.05), density=2700.0, position=(0.3, 0.0, 1.0))
    scene.joint_revolute("hinge", None, arm, anchor=(0.0, 0.0, 1.0), axis="Y", drive=drive)
    hand = scene.box("hand", size=(0.2, 0.05, 0.05), density=2700.0, position=(0.7, 0.0, 1.0))
    scene.joint_spherical("wrist", arm, hand, anchor=(0.6, 0.0, 1.0))
    scene.box("block", size=(0.2, 0.3, 0.4), density=300.0, position=(0.0, 2.0, 1.0), angular_velocity_deg=(200, 0, 90))


@pytest.mark.parametrize("ball_too", [False, True])
def test_the_books_in_one_go_are_those_of_the_steps(tmp_path: Path, ball_too: bool) -> None:
    """What pushes a joint without axes of its own has them kept step by step."""

    class More(Pushes):
        def __call__(self, t: float, simulation: Simulation) -> None:
            super().__call__(t, simulation)
            labels = [str(label) for label in simulation.model.joint_label]
            dof = int(simulation.model.joint_qd_start.numpy()[labels.index("/World/wrist")])
            forces = simulation.control.joint_f.numpy()
            forces[dof : dof + 3] = 0.2 * ball_too
            simulation.control.joint_f.assign(forces)

    both = pair(tmp_path, pushed, More())
    entries = []
    for _ in range(FRAMES):
        frame(*both)
        entries.append([simulation.rigid.ledger.take() for simulation in both if simulation.rigid.ledger])
    for name in ("impulse", "control", "work", "drives", "unsure", "effort"):
        ours, theirs = (np.array([getattr(pair[k], name) for pair in entries]) for k in (0, 1))
        assert np.abs(theirs).max() > 1e-4, name
        # A frame's sums round once a step, of what each of them is.
        assert np.abs(ours - theirs).max() < 32.0 * ROUNDING * np.abs(theirs).max(), name
    for array in ("body_q", "body_qd"):
        ours, theirs = (getattr(simulation.state, array).numpy() for simulation in both)
        assert (ours == theirs).all(), array


def test_bodies_move_as_newton_has_them(tmp_path: Path) -> None:
    """Velocities by MuJoCo's data are those of Newton's state, of loose bodies and of those on joints."""
    simulation, _ = pair(tmp_path, pushed, Pushes())
    assert simulation.rigid is not None
    for _ in range(FRAMES):
        simulation.advance_frame()
        found, told = simulation.rigid.solver.motion.twists(), simulation.state.body_qd.numpy()
        assert np.abs(told).max() > 1.0
        assert np.abs(found - told).max() < 8.0 * ROUNDING * np.abs(told).max()


@pytest.mark.parametrize("name", ["conveyor", "floating_blocks"])
def test_who_is_looked_at_between_frames_is_not_alone(tmp_path: Path, name: str) -> None:
    scene = Scene()
    example(name)(scene)
    scene.save(tmp_path / "stage.usda")
    simulation = Simulation(tmp_path / "stage.usda", "cpu")
    assert simulation.rigid is not None
    assert not simulation.rigid.alone
