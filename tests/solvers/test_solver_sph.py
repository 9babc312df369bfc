"""SolverSPH against hydrostatics, Archimedes, and the conservation laws; coarse, on the CPU."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers import launch
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 1000.0, 9.81


def make_builder() -> newton.ModelBuilder:
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    return builder


def fill(builder: newton.ModelBuilder, size: tuple[float, float, float], spacing: float, speed_of_sound: float) -> None:
    """Water at rest on z = 0, its density already hydrostatic."""
    cells = box_lattice(np.array(size), spacing)
    position = cells.position + np.array([0.0, 0.0, 0.5 * size[2]])
    pressure = RHO * G * (size[2] - position[:, 2])
    builder.add_particles(
        pos=position.tolist(),
        vel=[(0.0, 0.0, 0.0)] * len(position),
        mass=(RHO * cells.volume).tolist(),
        custom_attributes={"sph:pressure": pressure.tolist()},
    )


def tank_of(size: tuple[float, float, float], height: float) -> tuple[OpenBox, ...]:
    return (OpenBox(center=(0.0, 0.0, 0.5 * height), size=(size[0], size[1], height)),)


def advance(solver: SolverSPH, state: newton.State, seconds: float, rigid=None) -> int:
    steps = math.ceil(seconds / solver.config.max_time_step)
    control = solver.model.control()
    for _ in range(steps):
        state.clear_forces()
        solver.step(state, state, control, None, seconds / steps)
        if rigid is not None:
            rigid.step(state, state, control, None, seconds / steps)
    return steps


def test_still_water_stays_still_with_hydrostatic_pressure():
    size, spacing = (0.3, 0.3, 0.3), 0.03
    sound = 10.0 * math.sqrt(G * size[2])
    builder = make_builder()
    fill(builder, size, spacing, sound)
    model = builder.finalize(device="cpu")
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=sound), tank_of(size, 0.4))
    state = model.state()
    kinetic = np.zeros((3, 10))
    for sample in np.ndindex(*kinetic.shape):
        advance(solver, state, 0.1)
        speed2 = (state.particle_qd.numpy() ** 2).sum(axis=1)
        kinetic[sample] = 0.5 * (model.particle_mass.numpy() * speed2).sum() / (RHO * math.prod(size) * G * size[2])
    solver.check(state)
    # The lattice slips into disorder, which stirs the water, and that dies away: measured 8e-5 of m g H after 3 s.
    assert kinetic[2, -3:].mean() < 1e-4
    assert kinetic[2, -3:].mean() < 0.8 * kinetic[2, :3].mean()
    assert kinetic.max() < 1e-3

    z = state.particle_q.numpy()[:, 2]
    pressure = state.sph.pressure.numpy()
    slope, at_floor = np.polyfit(z, pressure, 1)
    assert at_floor == pytest.approx(RHO * G * size[2], rel=0.03)  # p = rho g H at the floor; measured 1.7 % over
    assert slope == pytest.approx(-RHO * G, rel=0.03)
    position = state.particle_q.numpy()
    assert (np.abs(position[:, :2]) < 0.15).all()
    assert (z > 0.0).all()


@pytest.mark.parametrize("specific", [0.4, 0.8])
def test_box_floats_at_archimedes_depth(specific):
    """A box 0.15 m high with 7 particles a side; Archimedes: draft = specific density x height."""
    size, spacing, edge = (0.36, 0.36, 0.3), 0.15 / 7.0, 0.15
    sound = 10.0 * math.sqrt(G * size[2])
    builder = make_builder()
    draft = specific * edge
    level = size[2] + edge * edge * draft / (size[0] * size[1])  # once the box is in
    start = level - draft + 0.5 * edge
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, start), wp.quat_identity()), label="box")
    config = newton.ModelBuilder.ShapeConfig(density=specific * RHO)
    builder.add_shape_box(body, hx=0.5 * edge, hy=0.5 * edge, hz=0.5 * edge, cfg=config)
    fill(builder, (size[0], size[1], level), spacing, sound)
    position = np.array(builder.particle_q)
    dry = (np.abs(position - np.array([0.0, 0.0, start])) < 0.5 * edge + 0.4 * spacing).all(axis=1)
    keep = np.flatnonzero(~dry)
    density = builder.custom_attributes["sph:pressure"].values
    kept = {k: density[int(i)] for k, i in enumerate(keep)}
    builder.custom_attributes["sph:pressure"].values = kept
    for name in ("particle_q", "particle_qd", "particle_mass", "particle_radius", "particle_flags", "particle_world"):
        setattr(builder, name, [getattr(builder, name)[i] for i in keep])
    model = builder.finalize(device="cpu")
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=sound), tank_of(size, 0.45))
    rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, use_mujoco_contacts=True)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)

    heights, lifts = [], []
    for _ in range(20):
        advance(solver, state, 0.05, rigid)
        heights.append(float(state.body_q.numpy()[0, 2]))
        lifts.append(float(solver.body_wrench.numpy()[0, 2]))
    # The level follows from the water's volume, measured by its particles' masses.
    water = float(model.particle_mass.numpy().sum()) / RHO
    rest = np.mean(heights[10:])
    bottom = rest - 0.5 * edge
    measured_level = (water + edge * edge * max(0.0, draft)) / (size[0] * size[1])
    measured = measured_level - bottom
    assert measured == pytest.approx(draft, abs=0.04 * edge)
    # The start rings: the slowest tone of the tank, damped by 0.3 a second, moves the lift by 15 %; its mean carries.
    assert np.mean(lifts[10:]) == pytest.approx(specific * RHO * edge**3 * G, rel=0.05)


def test_fluid_and_body_exchange_momentum_without_loss():
    """No gravity, no walls: what the body gains the fluid loses, to float32."""
    builder = make_builder()
    builder.gravity = wp.vec3(0.0, 0.0, 0.0)
    cells = box_lattice(np.array([0.2, 0.2, 0.2]), 0.02)
    builder.add_particles(
        pos=cells.position.tolist(),
        vel=[(0.0, 0.0, 1.0)] * len(cells.position),
        mass=(RHO * cells.volume).tolist(),
        custom_attributes={"sph:pressure": [0.0] * len(cells.position)},
    )
    body = builder.add_body(xform=wp.transform(wp.vec3(0.03, 0.0, 0.16), wp.quat_identity()))
    builder.add_shape_box(body, hx=0.05, hy=0.05, hz=0.05, cfg=newton.ModelBuilder.ShapeConfig(density=500.0))
    model = builder.finalize(device="cpu")
    model.set_gravity((0.0, 0.0, 0.0))
    solver = SolverSPH(model, SolverSPH.Config(spacing=0.02, speed_of_sound=20.0))
    rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, use_mujoco_contacts=True)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    mass, body_mass = model.particle_mass.numpy().astype(float), float(model.body_mass.numpy()[0])

    def momentum() -> np.ndarray:
        fluid = (mass[:, None] * state.particle_qd.numpy()).sum(axis=0)
        return fluid + body_mass * state.body_qd.numpy()[0, :3]

    before = momentum()
    advance(solver, state, 0.1, rigid)
    assert abs(float(state.body_qd.numpy()[0, 2])) > 0.2  # it was hit
    assert np.abs(momentum() - before).max() < 1e-4 * np.linalg.norm(before)


def test_light_body_falls_on_water_and_stays_finite():
    """Specific density 0.1: the added mass is many times the body's own."""
    size, spacing = (0.3, 0.3, 0.15), 0.03
    sound = 20.0
    builder = make_builder()
    fill(builder, size, spacing, sound)
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, 0.24), wp.quat_identity()))
    builder.add_shape_box(body, hx=0.06, hy=0.06, hz=0.06, cfg=newton.ModelBuilder.ShapeConfig(density=100.0))
    model = builder.finalize(device="cpu")
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=sound), tank_of(size, 0.5))
    rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, use_mujoco_contacts=True)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    advance(solver, state, 1.0, rigid)
    height = float(state.body_q.numpy()[0, 2])
    assert 0.15 < height < 0.25  # on the surface, neither thrown out nor sunk


def test_result_does_not_depend_on_the_number_of_threads_and_repeats_bit_for_bit(monkeypatch):
    size, spacing = (0.2, 0.2, 0.2), 0.02
    builder = make_builder()
    fill(builder, size, spacing, 20.0)
    model = builder.finalize(device="cpu")
    states = []
    for threads in (1, 2, 3, 2):
        monkeypatch.setattr(launch, "thread_count", lambda threads=threads: threads)
        launch._pool.cache_clear()
        config = SolverSPH.Config(spacing=spacing, speed_of_sound=20.0)
        solver = SolverSPH(model, config, tank_of((0.3, 0.2, 0.2), 0.4))
        state = model.state()
        advance(solver, state, 0.1)
        states.append(state.particle_q.numpy().tobytes() + state.sph.pressure.numpy().tobytes())
    launch._pool.cache_clear()
    assert len(set(states)) == 1


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"spacing": 0.0}, "spacing"),
        ({"spacing": math.nan}, "spacing"),
        ({"speed_of_sound": 0.0}, "speed_of_sound"),
        ({"viscosity": -1.0}, "viscosity"),
        ({"cells_per_support": 9}, "cells_per_support"),
    ],
)
def test_settings_out_of_range_are_named(settings, name):
    with pytest.raises(ValueError, match=name):
        SolverSPH.Config(**{"speed_of_sound": 10.0, **settings})


def test_density_that_was_never_set_is_the_rest_density():
    builder = make_builder()
    cells = box_lattice(np.array([0.1, 0.1, 0.1]), 0.02)
    count = len(cells.position)
    builder.add_particles(
        pos=cells.position.tolist(), vel=[(0.0, 0.0, 0.0)] * count, mass=(RHO * cells.volume).tolist()
    )
    model = builder.finalize(device="cpu")
    solver = SolverSPH(model, SolverSPH.Config(spacing=0.02, speed_of_sound=10.0))
    state = model.state()
    advance(solver, state, 0.002)
    assert np.abs(state.sph.pressure.numpy()).max() < 1e-3 * RHO * 100.0
    fallen = state.particle_qd.numpy()[:, 2].mean()
    assert fallen == pytest.approx(-G * 0.002, rel=0.01)


def test_model_without_particles_is_refused():
    model = make_builder().finalize(device="cpu")
    with pytest.raises(ValueError, match="no particles"):
        SolverSPH(model, SolverSPH.Config(speed_of_sound=10.0))


def test_a_container_that_is_too_narrow_for_the_spacing_is_named():
    builder = make_builder()
    fill(builder, (0.3, 0.3, 0.1), 0.05, 10.0)
    model = builder.finalize(device="cpu")
    with pytest.raises(ValueError, match=r"spacing = 0.05 m is too coarse .* needs 4; use spacing <= 0.025"):
        SolverSPH(model, SolverSPH.Config(spacing=0.05, speed_of_sound=10.0), tank_of((0.3, 0.1, 0.3), 0.3))


def still_pool(device: str = "cpu"):
    builder = make_builder()
    fill(builder, (0.2, 0.2, 0.1), 0.025, 10.0)
    model = builder.finalize(device=device)
    solver = SolverSPH(model, SolverSPH.Config(spacing=0.025, speed_of_sound=10.0), tank_of((0.2, 0.2, 0.1), 0.2))
    return solver, model.state()


def test_check_finds_what_is_not_finite():
    solver, state = still_pool()
    position = state.particle_q.numpy()
    position[17, 1] = math.nan
    state.particle_q.assign(position)
    with pytest.raises(RuntimeError, match="particle 17 of world 0 is not finite"):
        solver.check(state)


def test_check_finds_what_is_faster_than_sound():
    solver, state = still_pool()
    velocity = state.particle_qd.numpy()
    velocity[3] = (0.0, 0.0, 11.0)
    state.particle_qd.assign(velocity)
    with pytest.raises(RuntimeError, match=r"moves at 11 m/s, faster than sound at speed_of_sound = 10 m/s"):
        solver.check(state)


def test_check_counts_what_has_left_the_domain():
    solver, state = still_pool()
    assert solver.check(state) == 0
    position = state.particle_q.numpy()
    position[:2] = (0.0, 0.0, -5.0)
    state.particle_q.assign(position)
    assert solver.check(state) == 2
