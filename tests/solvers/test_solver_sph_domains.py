"""Flows in a plane and in periodic boxes: what holds them there."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DP = 1000.0, 9.81, 0.05


def builder_of(gravity: float = -G) -> newton.ModelBuilder:
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, gravity))
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    return builder


def add_plane_of_water(builder: newton.ModelBuilder, width: float, depth: float) -> None:
    """One layer at y = 0, hydrostatic, on z = 0."""
    cells = box_lattice(np.array([width, 1.0, depth]), DP, plane=True)
    z = cells.position[:, 2] + 0.5 * depth
    builder.add_particles(
        pos=(cells.position + np.array([0.0, 0.0, 0.5 * depth])).tolist(),
        vel=[(0.0, 0.0, 0.0)] * len(z),
        mass=[RHO * DP * DP] * len(z),
        custom_attributes={"sph:pressure": (RHO * G * (depth - z)).tolist()},
    )


def test_a_body_that_rolls_does_not_take_the_water_out_of_the_plane():
    builder = builder_of()
    turned = wp.quat_from_axis_angle(wp.vec3(1.0, 0.0, 0.0), 0.05)  # already a little about x
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, 0.9), turned))
    config = newton.ModelBuilder.ShapeConfig(density=600.0)
    builder.add_shape_box(body, hx=0.15, hy=0.5, hz=0.1, cfg=config)
    add_plane_of_water(builder, 1.0, 0.5)
    model = builder.finalize(device="cpu")
    sound = 10.0 * math.sqrt(2.0 * G)
    tank = (OpenBox((0.0, 0.0, 0.5), (1.0, 1.0, 1.0)),)
    solver = SolverSPH(model, SolverSPH.Config(spacing=DP, speed_of_sound=sound, dimensions=2), tank)
    rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True)
    state, control = model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for _ in range(600):
        state.clear_forces()
        solver.step(state, state, control, None, solver.config.max_time_step)
        wrench = solver.body_wrench.numpy()[0]
        assert wrench[1] == wrench[3] == wrench[5] == 0.0  # no force along y, no torque but about y
        rigid.step(state, state, control, None, solver.config.max_time_step)
    solver.check(state)
    assert (state.particle_q.numpy()[:, 1] == 0.0).all()
    assert solver.body_wrench.numpy()[0, 2] > 100.0  # it is in the water


@pytest.mark.parametrize("floor", ["ground plane", "slab"])
def test_a_floor_ends_where_the_period_does(floor):
    """Were it to go on, a column at the seam would stand on the floor and on its images, and be thrown up."""
    builder = builder_of()
    if floor == "slab":
        place = wp.transform(wp.vec3(0.0, 0.0, -0.2), wp.quat_identity())
        builder.add_shape_box(-1, xform=place, hx=1.5, hy=0.5, hz=0.2)
    else:
        builder.add_ground_plane()
    add_plane_of_water(builder, 1.0, 0.4)
    model = builder.finalize(device="cpu")
    sound = 10.0 * math.sqrt(G * 0.4)
    config = SolverSPH.Config(spacing=DP, speed_of_sound=sound, dimensions=2, periodic=((-0.5, 0.5), None, None))
    solver = SolverSPH(model, config)
    x = solver.wall_position.numpy()[:, 0]
    assert (x > -0.5).all() and (x < 0.5).all()
    assert len(np.unique(x.round(4))) == 20
    state = model.state()
    for _ in range(50):
        solver.step(state, state, None, None, config.max_time_step)
    assert np.abs(state.particle_qd.numpy()).max() < 0.02 * math.sqrt(G * 0.4)


def test_momentum_of_a_periodic_box_is_kept_and_positions_stay_inside():
    builder = builder_of(0.0)
    cells = box_lattice(np.ones(3), 1.0 / 12.0)
    rng = np.random.default_rng(5)
    velocity = rng.normal(size=cells.position.shape)
    builder.add_particles(cells.position.tolist(), velocity.tolist(), (RHO * cells.volume).tolist())
    model = builder.finalize(device="cpu")
    ends = ((-0.5, 0.5),) * 3
    solver = SolverSPH(model, SolverSPH.Config(spacing=1.0 / 12.0, speed_of_sound=30.0, periodic=ends))
    state = model.state()
    mass = model.particle_mass.numpy().astype(float)[:, None]

    def momentum() -> np.ndarray:
        return (mass * state.particle_qd.numpy()).sum(axis=0)

    before, size = momentum(), (mass * np.abs(velocity)).sum()
    for _ in range(200):
        solver.step(state, state, None, None, solver.config.max_time_step)
    assert np.abs(momentum() - before).max() < 1e-5 * size
    assert (np.abs(state.particle_q.numpy()) <= 0.5 + 1e-6).all()
    assert solver.check(state) == 0


def test_settings_of_the_domain_that_cannot_work_are_named():
    with pytest.raises(ValueError, match=r"periodic x = \(0.0, 0.2\) is 0.2 m long; it must span more than"):
        SolverSPH.Config(spacing=DP, speed_of_sound=10.0, periodic=((0.0, 0.2), None, None))
    with pytest.raises(ValueError, match="dimensions = 1 must be 2 or 3"):
        SolverSPH.Config(speed_of_sound=10.0, dimensions=1)
    with pytest.raises(ValueError, match="periodic y has no meaning"):
        SolverSPH.Config(spacing=DP, speed_of_sound=10.0, dimensions=2, periodic=(None, (0.0, 9.0), None))


def test_viscosity_limits_the_time_step():
    thin = SolverSPH.Config(spacing=0.01, speed_of_sound=1.0, viscosity=0.0).max_time_step
    thick = SolverSPH.Config(spacing=0.01, speed_of_sound=1.0, viscosity=100.0)
    assert 1.0 / thick.max_time_step - 1.0 / thin == pytest.approx(100.0 / (0.125 * thick.smoothing_length**2 * 1000.0))


@pytest.mark.parametrize("ratio", [1.3, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_laminar_factor_goes_to_the_integrals(dimensions, ratio):
    """2 (d + 2) with many neighbours; never below it, for a sum over few misses the nearest."""
    config = SolverSPH.Config(spacing=0.01, speed_of_sound=1.0, dimensions=dimensions, smoothing_ratio=ratio)
    whole = 2.0 * (dimensions + 2)
    assert whole < config.laminar_factor < 1.2 * whole
    if ratio == 4.0:
        assert config.laminar_factor == pytest.approx(whole, rel=0.005)


def test_particles_without_mass_and_attributes_of_the_wrong_length_are_refused():
    builder = builder_of()
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
    with pytest.raises(ValueError, match=r"particle 0 has mass 0.0; it must be > 0"):
        SolverSPH(builder.finalize(device="cpu"), SolverSPH.Config(speed_of_sound=10.0))
    builder = builder_of()
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    model = builder.finalize(device="cpu")
    model.sph.viscosity = wp.array([0.1, 0.2, 0.3], dtype=float, device="cpu")
    with pytest.raises(ValueError, match="3 values of sph:viscosity for 1 worlds"):
        SolverSPH(model, SolverSPH.Config(speed_of_sound=10.0))


def test_shapes_that_the_fluid_cannot_see_are_named():
    builder = builder_of()
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    builder.add_shape_cone(-1, radius=0.1, half_height=0.1, label="spire")
    model = builder.finalize(device="cpu")
    with pytest.warns(UserWarning, match="does not see spire, a CONE"):
        SolverSPH(model, SolverSPH.Config(speed_of_sound=10.0))
