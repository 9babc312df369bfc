"""Many worlds in one solver: each gives what it gives alone, with its own water, walls, bodies and gravity."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

SPACING, SOUND, WORLDS = 0.03, 20.0, 64
STEPS = 60


def settings(k: int) -> dict[str, float]:
    """What world k has of its own."""
    return {
        "level": SPACING * (4 + k % 3),
        "width": SPACING * (6 + k % 2),
        "rest_density": 800.0 + 10.0 * k,
        "viscosity": 0.001 * (1 + k),
        "gravity": -(5.0 + 0.1 * k),
        "body_density": 100.0 + 12.0 * k,
        "body_height": 0.2 + 0.001 * k,
    }


def world(k: int) -> newton.ModelBuilder:
    s = settings(k)
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, s["gravity"]))
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    cells = box_lattice(np.array([s["width"], 6 * SPACING, s["level"]]), SPACING)
    builder.add_particles(
        pos=(cells.position + np.array([0.0, 0.0, 0.5 * s["level"]])).tolist(),
        vel=[(0.3, 0.0, 0.0)] * len(cells.position),
        mass=(s["rest_density"] * cells.volume).tolist(),
    )
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, s["body_height"]), wp.quat_identity()))
    builder.body_qd[body] = (0.0, 0.0, -1.0, 0.5, 0.0, 0.0)
    config = newton.ModelBuilder.ShapeConfig(density=s["body_density"])
    builder.add_shape_box(body, hx=SPACING, hy=SPACING, hz=SPACING, cfg=config)
    return builder


def simulate(worlds: list[int], device: str = "cpu", steps: int = STEPS) -> list[dict]:
    """Step these worlds together; what each holds at the end."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    for k in worlds:
        builder.add_world(world(k))
    for name in ("rest_density", "viscosity"):
        builder.custom_attributes[f"sph:{name}"].values = {i: settings(k)[name] for i, k in enumerate(worlds)}
    model = builder.finalize(device=device)
    tanks = tuple(
        OpenBox((0.0, 0.0, 0.2), (settings(k)["width"], 6 * SPACING, 0.4), world=i) for i, k in enumerate(worlds)
    )
    solver = SolverSPH(model, SolverSPH.Config(spacing=SPACING, speed_of_sound=SOUND), tanks)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    integrator = newton.solvers.SolverSemiImplicit(model)
    push = np.zeros(model.body_count)
    for _ in range(steps):
        state.clear_forces()
        solver.step(state, state, None, None, solver.config.max_time_step)
        push = np.maximum(push, np.abs(solver.body_wrench.numpy()[:, 2]))
        # Bodies by themselves: MuJoCo's C and Warp versions, which it chooses between by the number of worlds,
        # do not round alike.
        integrator.integrate_bodies(model, state, state, solver.config.max_time_step)
    solver.check(state)
    of_particle, of_body = model.particle_world.numpy(), model.body_world.numpy()
    return [
        {
            "position": state.particle_q.numpy()[of_particle == i],
            "velocity": state.particle_qd.numpy()[of_particle == i],
            "pressure": state.sph.pressure.numpy()[of_particle == i],
            "push": push[of_body == i],
            "pose": state.body_q.numpy()[of_body == i],
            "twist": state.body_qd.numpy()[of_body == i],
        }
        for i in range(len(worlds))
    ]


def test_a_world_in_a_batch_of_64_gives_bit_for_bit_what_it_gives_alone():
    batch = simulate(list(range(WORLDS)))
    for k in (0, 8, 31, 62):  # bodies over the water and in it
        alone = simulate([k])[0]
        for name, values in batch[k].items():
            assert values.tobytes() == alone[name].tobytes(), (k, name)
    assert batch[8]["push"][0] > 0.5  # [N]: the water does push on the body; measured 1.55
    assert len({result["position"].tobytes() for result in batch}) == WORLDS  # they do differ


def furthest(one: dict, other: dict) -> dict[str, float]:
    """Largest difference of each quantity, over its largest value."""
    return {name: float(np.abs(values - other[name]).max() / np.abs(values).max()) for name, values in one.items()}


@pytest.mark.cuda
def test_on_cuda_a_world_in_a_batch_of_64_gives_what_it_gives_alone_to_rounding():
    batch = simulate(list(range(WORLDS)), "cuda:0")
    for k in (0, 8, 31, 62):
        assert max(furthest(simulate([k], "cuda:0")[0], batch[k]).values()) < 1e-4, k


@pytest.mark.cuda
def test_cuda_gives_what_the_cpu_gives_to_rounding():
    for k in (0, 8, 31, 62):
        on_cpu, on_gpu = simulate([k])[0], simulate([k], "cuda:0")[0]
        assert max(furthest(on_cpu, on_gpu).values()) < 1e-3, k


def test_density_viscosity_and_gravity_are_the_worlds_own():
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    depth, densities, gravities = 8 * SPACING, (800.0, 1000.0, 1300.0), (-9.81, -3.7, -1.62)
    for density, gravity in zip(densities, gravities, strict=True):
        one = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, gravity))
        SolverSPH.register_custom_attributes(one)
        cells = box_lattice(np.array([6 * SPACING, 6 * SPACING, depth]), SPACING)
        z = cells.position[:, 2] + 0.5 * depth
        one.add_particles(
            pos=(cells.position + np.array([0.0, 0.0, 0.5 * depth])).tolist(),
            vel=[(0.0, 0.0, 0.0)] * len(z),
            mass=(density * cells.volume).tolist(),
            custom_attributes={"sph:pressure": (-density * gravity * (depth - z)).tolist()},
        )
        builder.add_world(one)
    builder.custom_attributes["sph:rest_density"].values = dict(enumerate(densities))
    model = builder.finalize(device="cpu")
    tank = (OpenBox((0.0, 0.0, 0.2), (6 * SPACING, 6 * SPACING, 0.4)),)
    sound = 10.0 * math.sqrt(9.81 * depth)
    solver = SolverSPH(model, SolverSPH.Config(spacing=SPACING, speed_of_sound=sound), tank)
    assert solver.rest_density.numpy() == pytest.approx(densities)
    state = model.state()
    for _ in range(300):
        solver.step(state, state, None, None, solver.config.max_time_step)
    world = model.particle_world.numpy()
    for i, (density, gravity) in enumerate(zip(densities, gravities, strict=True)):
        z, p = state.particle_q.numpy()[world == i, 2], state.sph.pressure.numpy()[world == i]
        slope, at_floor = np.polyfit(z, p, 1)
        assert slope == pytest.approx(density * gravity, rel=0.05)
        assert at_floor == pytest.approx(-density * gravity * depth, rel=0.05)
