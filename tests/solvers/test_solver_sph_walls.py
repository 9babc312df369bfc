"""Walls let nothing through: not what is fast, not what creeps into an edge under the weight of the water."""

import math
from pathlib import Path

import newton
import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

DP, SOUND = 0.02, 10.0
INNER = np.array([12.0, 10.0, 8.0]) * DP
SLAB = np.array([1.5, 5.0, 4.0]) * DP  # half sizes of what stands across the middle of the box


def lumps(seed: int) -> tuple[SolverSPH, newton.State]:
    """Two lumps of water that fly, without weight, in a closed box with a slab across it, most of them into edges."""
    draw = np.random.default_rng(seed)
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, 0.0))
    SolverSPH.register_custom_attributes(builder)
    builder.add_shape_box(-1, hx=SLAB[0], hy=SLAB[1], hz=SLAB[2])
    lump = (np.indices((4, 4, 4)).reshape(3, -1).T - 1.5) * DP
    for side in (-1.0, 1.0):
        center = np.array([0.5 * side * (INNER[0] / 2 + SLAB[0]), *draw.uniform(-0.5, 0.5, 2) * DP])
        way = draw.uniform(0.3, 1.0, 3) * draw.choice([-1.0, 1.0], 3)
        speed = SOUND * draw.uniform(0.2, 0.6)
        builder.add_particles(
            pos=(center + lump).tolist(),
            vel=[tuple(speed * way / np.linalg.norm(way))] * len(lump),
            mass=[1000.0 * DP**3] * len(lump),
        )
    tank = OpenBox(center=(0.0, 0.0, 0.0), size=tuple(INNER), closed=True)
    model = builder.finalize(device="cpu")
    return SolverSPH(model, SolverSPH.Config(spacing=DP, speed_of_sound=SOUND), (tank,)), model.state()


@pytest.mark.parametrize("seed", range(4))
def test_water_stops_at_a_walls_face_and_the_wall_gets_what_it_loses(seed):
    solver, state = lumps(seed)
    mass, started = solver.model.particle_mass.numpy()[:, None], state.particle_qd.numpy().copy()
    dt, furthest = solver.config.max_time_step, 0.0
    for _ in range(math.ceil(6.0 * INNER.max() / SOUND / dt)):
        solver.step(state, state, None, None, dt)
        place = state.particle_q.numpy()
        furthest = max(furthest, (np.abs(place) - INNER / 2).max(), (SLAB[0] - np.abs(place[:, 0])).max())
    # No further behind a face than one step takes it: 0.65 spacings at the speed of sound, 0.4 at what they fly with.
    assert furthest < 0.4 * DP
    lost = (mass * (started - state.particle_qd.numpy())).sum(axis=0)
    assert solver.take_wall_impulse()[0] == pytest.approx(lost, abs=1e-4 * float((mass * SOUND).sum()))


@pytest.mark.parametrize("seed", range(3))
def test_a_block_that_lands_in_shallow_water_presses_none_of_it_through_the_floor(seed, tmp_path: Path):
    """The film goes out from under it at half the speed of sound, in gaps that no particle fits in."""
    draw = np.random.default_rng(seed)
    level, drop, density = 2.0 * DP, draw.uniform(0.0, 0.05), draw.uniform(700.0, 900.0)
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=10.0)
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.4), wall=0.02)
    scene.fluid("water", fills=tank, level=level, spacing=DP)
    scene.box("block", size=(0.2, 0.2, 0.16), density=density, position=(0.0, 0.0, 0.02 + level + drop + 0.08))
    simulation = Simulation(scene.save(tmp_path / "drop.usda"), "cpu")
    for _ in range(10):
        simulation.advance_frame()
    place = simulation.state.particle_q.numpy()
    beyond = np.maximum(np.abs(place[:, :2]).max(axis=1) - 0.2, 0.02 - place[:, 2])
    assert beyond.max() < 0.5 * DP
