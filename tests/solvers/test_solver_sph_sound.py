"""Sound in a still tank: walls neither feed nor eat it; what damps it is the density diffusion, at its known rate."""

import math

import newton
import numpy as np
import pytest

from wsim.geometry.filled import box_lattice
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DEPTH, WIDTH, SPACING = 1000.0, 9.81, 0.6, 0.16, 0.02
SOUND = 10.0 * math.sqrt(G * DEPTH)
WAVENUMBER = 0.5 * math.pi / DEPTH  # a quarter of a wave between the floor and the surface: the slowest tone


def tone_of(diffusion: float, seconds: float = 2.4) -> tuple[np.ndarray, np.ndarray]:
    """Amplitude [m/s] of the tone over time [s]: a narrow tank, so that walls are near to every particle."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    SolverSPH.register_custom_attributes(builder)
    cells = box_lattice(np.array([WIDTH, SPACING, DEPTH]), SPACING)
    position = cells.position * [1.0, 0.0, 1.0] + [0.0, 0.0, 0.5 * DEPTH]
    shape = np.sin(WAVENUMBER * position[:, 2])
    velocity = np.zeros_like(position)
    velocity[:, 2] = -0.01 * shape
    builder.add_particles(
        pos=position.tolist(),
        vel=velocity.tolist(),
        mass=[RHO * DEPTH * WIDTH / len(position)] * len(position),
        custom_attributes={"sph:pressure": (RHO * G * (DEPTH - position[:, 2])).tolist()},
    )
    model = builder.finalize(device="cpu")
    config = SolverSPH.Config(
        spacing=SPACING, speed_of_sound=SOUND, dimensions=2, density_diffusion=diffusion, artificial_viscosity=0.0,
        viscosity=0.0,
    )  # fmt: skip
    height = DEPTH + 4.0 * SPACING
    solver = SolverSPH(model, config, (OpenBox(center=(0.0, 0.0, 0.5 * height), size=(WIDTH, 1.0, height)),))
    state, control = model.state(), model.control()
    steps = math.ceil(seconds / config.max_time_step)
    amplitude = []
    for _ in range(steps):
        solver.step(state, state, control, None, seconds / steps)
        amplitude.append(2.0 * float(np.mean(state.particle_qd.numpy()[:, 2] * shape)))
    return (np.arange(steps) + 1) * seconds / steps, np.array(amplitude)


def decay(t: np.ndarray, amplitude: np.ndarray) -> float:
    """Rate [1/s] between the rms of the second and of the last quarter."""
    quarter = len(t) // 4
    early, late = slice(quarter, 2 * quarter), slice(3 * quarter, 4 * quarter)
    return math.log(amplitude[early].std() / amplitude[late].std()) / (t[late].mean() - t[early].mean())


@pytest.mark.parametrize("diffusion", [0.05, 0.1])
def test_the_slowest_tone_dies_at_the_rate_of_the_density_diffusion(diffusion):
    # d p/dt = delta h c lap p damps a wave of wave number k by delta h c k^2 / 2.
    expected = 0.5 * diffusion * 2.0 * SPACING * SOUND * WAVENUMBER**2
    assert decay(*tone_of(diffusion)) == pytest.approx(expected, rel=0.15)


def test_without_diffusion_and_viscosity_the_tone_keeps_its_strength_and_pitch():
    t, amplitude = tone_of(0.0)
    # In a period: the surface, which takes nothing back from the walls, costs 1.3 %; the tone does not grow.
    assert 0.0 <= decay(t, amplitude) * 2.0 * math.pi / (SOUND * WAVENUMBER) < 0.015
    crossings = t[:-1][np.diff(np.signbit(amplitude))]
    pitch = math.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    assert pitch == pytest.approx(SOUND * WAVENUMBER, rel=0.03)
