"""Bodies on a tank's floor and just over it, against Archimedes; what lies in a hull is not lifted through it."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DP = 1000.0, 9.81, 0.02
SIZE, LEVEL, EDGE = (14 * DP, 14 * DP), 12 * DP, 3 * DP  # the last is half of a body's size
BALL, BOX = 4.0 / 3.0 * math.pi * EDGE**3, (2.0 * EDGE) ** 3


def in_ball(points: np.ndarray) -> np.ndarray:
    """Depth below its surface [m]."""
    return EDGE - np.linalg.norm(points, axis=1)


def in_box(points: np.ndarray) -> np.ndarray:
    return EDGE - np.abs(points).max(axis=1)


def tank(
    builder: newton.ModelBuilder, out: np.ndarray, count: int, device: str = "cpu"
) -> tuple[newton.Model, SolverSPH]:
    """Still water, of which `count` particles, where `out` is greatest, make room for bodies."""
    place = lattice()
    place = place[np.argsort(-out, kind="stable")[count:]]
    builder.add_particles(
        pos=place.tolist(), vel=[(0.0, 0.0, 0.0)] * len(place), mass=[RHO * DP**3] * len(place),
        custom_attributes={"sph:pressure": (RHO * G * (LEVEL - place[:, 2])).tolist()},
    )  # fmt: skip
    model = builder.finalize(device=device)
    config = SolverSPH.Config(spacing=DP, speed_of_sound=10.0 * math.sqrt(G * LEVEL))
    return model, SolverSPH(model, config, (OpenBox((0.0, 0.0, LEVEL), (*SIZE, 2.0 * LEVEL)),))


def lattice() -> np.ndarray:
    return box_lattice(np.array([*SIZE, LEVEL]), DP).position + np.array([0.0, 0.0, 0.5 * LEVEL])


def world() -> newton.ModelBuilder:
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    SolverSPH.register_custom_attributes(builder)
    return builder


def lifts(model: newton.Model, solver: SolverSPH, seconds: float) -> np.ndarray:
    """Mean upward force on each body that is held where it is, in the later half [N], and on all that stands still."""
    state, dt = model.state(), solver.config.max_time_step
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    steps = round(seconds / dt)
    forces = []
    for k in range(steps):
        if k == steps // 2:
            solver.take_wall_impulse()
        state.clear_forces()
        solver.step(state, state, None, None, dt)
        forces.append(solver.body_wrench.numpy()[:, 2])
    walls = solver.take_wall_impulse()[0, 2] / (dt * (steps - steps // 2))
    return np.append(np.mean(forces[steps // 2 :], axis=0), walls)


def held(shape: str, height: float, device: str = "cpu") -> tuple[newton.Model, SolverSPH]:
    """A ball or a box whose middle is so high over the floor [m]."""
    builder = world()
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, height), wp.quat_identity()))
    if shape == "ball":
        builder.add_shape_sphere(body, radius=EDGE)
    else:
        builder.add_shape_box(body, hx=EDGE, hy=EDGE, hz=EDGE)
    volume, depth = (BALL, in_ball) if shape == "ball" else (BOX, in_box)
    return tank(builder, depth(lattice() - np.array([0.0, 0.0, height])), round(volume / DP**3), device)


@pytest.mark.parametrize(
    ("shape", "over", "share"),
    [("ball", 0.0, 0.05), ("box", 0.0, 0.05), ("box", 0.25 * DP, 0.05), ("box", DP, 0.05)],
    ids=["a ball on it", "a box flush on it", "a box a quarter of a spacing over it", "a box one spacing over it"],
)
def test_what_is_on_the_floor_has_its_lift(shape, over, share):
    """Measured: 8.7 N of 8.88, and 16.6, 16.4 and 16.9 of 16.95; from fluid alone 0.9 and -22.5 N, the last 14.9."""
    model, solver = held(shape, EDGE + over)
    lift, on_walls = lifts(model, solver, 0.8)
    assert lift == pytest.approx(RHO * G * (BALL if shape == "ball" else BOX), rel=share)
    # What presses the body up in the gap presses the floor down: together they bear the water.
    assert lift + on_walls == pytest.approx(-G * float(model.particle_mass.numpy().sum()), rel=0.02)  # it sloshes


@pytest.mark.cuda
@pytest.mark.parametrize("shape", ["ball", "box"])
def test_on_cuda_what_is_on_the_floor_has_its_lift(shape):
    lift = lifts(*held(shape, EDGE, "cuda:0"), 0.8)[0]
    assert lift == pytest.approx(RHO * G * (BALL if shape == "ball" else BOX), rel=0.1)


def test_where_the_water_has_left_the_gap_falls_dry():
    """Flush on the floor, and all the water lifted off at once: the middle of the face is told by its rim, and that by
    the fluid, until nobody is told any more."""
    model, solver = held("box", EDGE)
    state, dt = model.state(), solver.config.max_time_step
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    rising = []
    for step in range(120):
        if step == 40:
            state.particle_q.assign(state.particle_q.numpy() + np.array([0.0, 0.0, 1.5 * LEVEL], dtype=np.float32))
        state.clear_forces()
        solver.step(state, state, None, None, dt)
        rising.append(float(solver.body_wrench.numpy()[0, 2]))
    assert rising[39] == pytest.approx(RHO * G * BOX, rel=0.1)
    assert rising[41] > 0.5 * RHO * G * (2.0 * EDGE) ** 2 * LEVEL * (2.0 / 6.0) ** 2  # from the middle alone
    assert rising[-1] == 0.0


def test_water_does_not_lift_what_lies_on_the_bottom_of_a_hull():
    """A bottom one spacing thick lets water near what lies on it; it is on the other side of that."""
    builder, bottom = world(), LEVEL - 5 * DP
    hull = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, bottom), wp.quat_identity()))
    half, wall = 5 * DP, 0.5 * DP
    builder.add_shape_box(hull, xform=wp.transform(wp.vec3(0, 0, wall), wp.quat_identity()), hx=half, hy=half, hz=wall)
    for axis in range(2):
        for side in (-1.0, 1.0):
            at, edge = [0.0, 0.0, half + wall], [half, half, half - wall]
            at[axis], edge[axis] = side * (half - wall), wall
            builder.add_shape_box(
                hull, xform=wp.transform(wp.vec3(*at), wp.quat_identity()), hx=edge[0], hy=edge[1], hz=edge[2]
            )
    cargo = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, bottom + 2 * wall + 2 * DP), wp.quat_identity()))
    builder.add_shape_box(cargo, hx=2 * DP, hy=2 * DP, hz=2 * DP)
    place = lattice()
    inside = (np.abs(place[:, :2]) < half).all(axis=1) & (place[:, 2] > bottom)
    model, solver = tank(builder, inside.astype(float), int(inside.sum()))
    assert abs(lifts(model, solver, 0.5)[1]) < 0.1 * RHO * G * (4 * DP) ** 3  # all that is wet would give it 0.8
