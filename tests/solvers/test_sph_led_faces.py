"""Fluid that a led body runs into goes before it: none gets in, and what it gains the body has lost."""

import newton
import numpy as np
import pytest
import trimesh
import warp as wp

from wsim.solvers.solver_sph import SolverSPH

DP, SPEED, SOUND = 0.02, 3.0, 15.0
HALF = 0.1 * DP  # of a plate: without faces drops come out of it behind


def add_plate(builder: newton.ModelBuilder, body: int, kind: str) -> None:
    """A plate, or what is as thin where it is met, across X."""
    across = wp.transform(wp.vec3(0.0, 0.0, 0.0), wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), 0.5 * np.pi))
    if kind == "box":
        builder.add_shape_box(body, hx=HALF, hy=0.1, hz=0.1)
    elif kind == "cylinder":
        builder.add_shape_cylinder(body, xform=across, radius=0.1, half_height=HALF)
    else:
        solid = trimesh.creation.box((2 * HALF, 0.2, 0.2))
        builder.add_shape_mesh(body, mesh=newton.Mesh(solid.vertices, solid.faces.reshape(-1)))


@pytest.mark.parametrize("kind", ["box", "cylinder", "mesh"])
@pytest.mark.parametrize("spin", [0.0, 40.0])
def test_a_sheet_of_drops_is_swept_along(kind: str, spin: float) -> None:
    """One drop thick and far apart, before a plate that is too thin to press on them."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    SolverSPH.register_custom_attributes(builder)
    places = np.stack(np.meshgrid([0.02], 3 * DP * np.arange(-1, 2), 3 * DP * np.arange(-1, 2)), -1).reshape(-1, 3)
    mass = 1000.0 * DP**3
    for place in places:
        builder.add_particle(wp.vec3(*place), wp.vec3(0.0, 0.0, 0.0), mass)
    body = builder.add_body(xform=wp.transform(wp.vec3(-0.02, 0.0, 0.0), wp.quat_identity()), is_kinematic=True)
    add_plate(builder, body, kind)
    model = builder.finalize(device="cpu")
    model.body_com.zero_()
    solver, state = SolverSPH(model, SolverSPH.Config(spacing=DP, speed_of_sound=SOUND)), model.state()
    dt, given, turned = 0.5 * solver.config.max_time_step, np.zeros(3), 0.0
    for k in range(round(0.06 / SPEED / dt)):
        turned = spin * k * dt  # about X, across the plate
        turn = (np.sin(0.5 * turned), 0.0, 0.0, np.cos(0.5 * turned))
        state.body_q.assign(np.array([[-0.02 + SPEED * k * dt, 0.0, 0.0, *turn]], dtype=np.float32))
        state.body_qd.assign(np.array([[SPEED, 0.0, 0.0, spin, 0.0, 0.0]], dtype=np.float32))
        state.clear_forces()
        solver.step(state, state, None, None, dt)
        given += dt * solver.body_wrench.numpy()[0, :3]
    front = float(state.body_q.numpy()[0, 0]) + HALF
    assert (state.particle_q.numpy()[:, 0] > front - 1e-5).all()
    assert (state.particle_qd.numpy()[:, 0] > SPEED - 1e-3).all()
    momentum = mass * state.particle_qd.numpy().sum(axis=0)
    assert given == pytest.approx(-momentum, abs=1e-4 * float(np.linalg.norm(momentum)))
