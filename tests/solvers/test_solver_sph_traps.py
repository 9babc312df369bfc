"""What goes wrong in SPH codes without a word: each trap, sprung on purpose."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.fluids import seed, sph_config
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DP = 1000.0, 9.81, 0.03
SIZE, LEVEL = (14 * DP, 14 * DP), 9 * DP
SOUND = 10.0 * math.sqrt(G * LEVEL)


def pool(half: tuple[float, float, float], center: float, density: float, fixed: bool = False):
    """A pool of still water, level with z = LEVEL, and a box at height `center`; where it is there is no water."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, center), wp.quat_identity()), is_kinematic=fixed)
    config = newton.ModelBuilder.ShapeConfig(density=density)
    builder.add_shape_box(body, hx=half[0], hy=half[1], hz=half[2], cfg=config)
    cells = box_lattice(np.array([*SIZE, LEVEL]), DP)
    position = cells.position + np.array([0.0, 0.0, 0.5 * LEVEL])
    position = position[(np.abs(position - np.array([0.0, 0.0, center])) > np.array(half) - 1e-6).any(axis=1)]
    builder.add_particles(
        pos=position.tolist(),
        vel=[(0.0, 0.0, 0.0)] * len(position),
        mass=[RHO * float(cells.volume[0])] * len(position),
        custom_attributes={"sph:pressure": (RHO * G * (LEVEL - position[:, 2])).tolist()},
    )
    model = builder.finalize(device="cpu")
    tank = (OpenBox((0.0, 0.0, LEVEL), (*SIZE, 2.0 * LEVEL)),)
    solver = SolverSPH(model, SolverSPH.Config(spacing=DP, speed_of_sound=SOUND), tank)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    return solver, state


def advance(solver, state, seconds: float, rigid=None, velocity: float = 0.0) -> list[float]:
    """Step; the body is moved by its solver, or along z at a velocity. Returns the lift of each step [N]."""
    steps = math.ceil(seconds / solver.config.max_time_step)
    dt, lifts = seconds / steps, []
    control = solver.model.control()
    for _ in range(steps):
        state.clear_forces()
        solver.step(state, state, control, None, dt)
        lifts.append(float(solver.body_wrench.numpy()[0, 2]))
        if rigid is not None:
            rigid.step(state, state, control, None, dt)
        elif velocity:
            pose = state.body_q.numpy()
            pose[0, 2] += velocity * dt
            state.body_q.assign(pose)
    return lifts


def rigid_of(solver):
    return newton.solvers.SolverMuJoCo(solver.model, use_mujoco_cpu=True, use_mujoco_contacts=True)


@pytest.mark.parametrize("layers", [1, 2, 4])
def test_lift_is_there_from_the_first_layer(layers):
    """A box held with `layers` spacings of draft feels the weight of the water that it displaces, to a fifth of one."""
    half, draft = 3 * DP, layers * DP
    solver, state = pool((half, half, half), LEVEL - draft + half, 500.0, fixed=True)
    lifts = advance(solver, state, 0.6)
    area = 4.0 * half * half
    held = float(np.mean(lifts[len(lifts) // 2 :])) / (RHO * G * area)
    assert held == pytest.approx(draft, abs=0.2 * DP)


def test_no_gap_opens_under_a_floating_box():
    half = 3 * DP
    solver, state = pool((half, half, half), LEVEL, 500.0)
    advance(solver, state, 1.0, rigid_of(solver))
    center = state.body_q.numpy()[0, :3]
    particles = state.particle_q.numpy()
    below = particles[(np.abs(particles[:, :2] - center[:2]) < 0.6 * half).all(axis=1) & (particles[:, 2] < center[2])]
    gap = float(center[2] - half - below[:, 2].max())
    assert 0.2 * DP < gap < 0.75 * DP  # half a spacing is where the lattice carries on


@pytest.mark.parametrize("density", [100.0, 500.0, 900.0])
def test_what_is_lighter_than_water_comes_up(density):
    """Let go under water at rest; a solid of density 500 must not sink, and a light one must not blow up."""
    half = 2.0 * DP  # and wide enough to float upright at every density
    solver, state = pool((4 * DP, 4 * DP, half), 5.0 * DP, density)
    advance(solver, state, 2.0, rigid_of(solver))
    solver.check(state)
    draft = density / RHO * 2.0 * half
    # The pool was level with the box under water; what of it comes out lowers the level.
    level = LEVEL - (2.0 * half - draft) * (8 * DP) ** 2 / (SIZE[0] * SIZE[1])
    assert state.body_q.numpy()[0, 2] == pytest.approx(level - draft + half, abs=0.5 * DP)


def test_neighbour_lists_follow_a_body_through_still_water():
    """The body alone moves: were the lists kept by the fluid's own motion, it would pass through the water unseen."""
    half = 2.5 * DP
    solver, state = pool((half, half, half), LEVEL + half + 3.0 * DP, 500.0, fixed=True)
    state.body_qd.assign(np.array([[0.0, 0.0, -20.0 * DP, 0.0, 0.0, 0.0]]))
    advance(solver, state, 0.4, velocity=-20.0 * DP)  # 8 spacings: 3 of air, 5 of water
    center = state.body_q.numpy()[0, :3]
    inside = (np.abs(state.particle_q.numpy() - center) < half - 0.5 * DP).all(axis=1)
    assert not inside.any()
    assert solver.body_wrench.numpy()[0, 2] > 0.5 * RHO * G * (2 * half) ** 2 * 4.0 * DP


@pytest.mark.parametrize("density", [100.0, 700.0])
def test_thin_plate_stays_afloat(density):
    """Half a spacing thick: water on one side within the kernel's reach of the other. The lighter rides 1.02 high."""
    solver, state = pool((4 * DP, 4 * DP, 0.25 * DP), LEVEL + 0.3 * DP, density)
    advance(solver, state, 1.5, rigid_of(solver))
    solver.check(state)
    pose = state.body_q.numpy()[0]
    assert pose[2] == pytest.approx(LEVEL, abs=1.1 * DP)
    upright = 1.0 - 2.0 * (pose[3] ** 2 + pose[4] ** 2)
    assert upright > math.cos(math.radians(5.0))


def test_the_waters_mass_is_its_volume():
    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.5, 0.4, 0.3))
    scene.fluid("water", fills=tank, level=0.2, spacing=0.03)
    world = describe(scene.stage)
    assert seed(world.fluids[0], world, sph_config([world]), {}).mass.sum() == pytest.approx(
        1000.0 * 0.5 * 0.4 * 0.2, rel=1e-6
    )
