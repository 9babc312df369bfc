"""Liquids that yield, thin or thicken, against Herschel and Bulkley's law and its flow down a slope."""

import math

import newton
import numpy as np
import pytest
import warp as wp

from wsim.kernels.sph.yielding import apparent_viscosity
from wsim.solvers.solver_sph import SolverSPH

RHO, DEPTH = 1500.0, 0.1
ALONG, ACROSS = 3.0, -9.3  # gravity down the slope and into it [m/s^2]


@wp.kernel(enable_backward=False)
def _apparent(law: wp.array(dtype=wp.vec4), rate: wp.array(dtype=float), out: wp.array(dtype=float)):
    i = wp.tid()
    out[i] = apparent_viscosity(law[i], rate[i])


def test_the_stress_is_that_of_the_law_and_at_rest_the_largest_viscosity_holds():
    rng = np.random.default_rng(5)
    n = 400
    consistency, stress, index = 10.0 ** rng.uniform(-2, 1.5, n), 10.0 ** rng.uniform(0, 3, n), rng.uniform(0.3, 1.5, n)
    rate, largest = 10.0 ** rng.uniform(-6, 3, n), np.full(n, 1e5)
    stress[::4] = 0.0
    law = wp.array(np.stack([consistency, stress, index, largest], axis=1).astype(np.float32), dtype=wp.vec4)
    found = wp.zeros(n, dtype=float)
    wp.launch(_apparent, n, [law, wp.array(rate, dtype=float)], [found])
    plastic = np.where(stress > 0.0, stress * -np.expm1(-largest / np.maximum(stress, 1e-9) * rate), 0.0)
    expected = np.minimum(consistency * rate ** (index - 1.0) + plastic / rate, largest)
    assert found.numpy() == pytest.approx(expected, rel=2e-3)


def film(stress: float, consistency: float, index: float, speed_at, seconds: float, largest: float, layers: int = 20):
    """A film down a slope in a plane, endless along it, that starts with a speed at each height.

    Returns:
        Heights of its layers, their speeds, and the viscosity at rest.
    """
    dp, long = DEPTH / layers, 16
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(ALONG, 0.0, ACROSS))
    SolverSPH.register_custom_attributes(builder, several_liquids=True)
    x, z = (grid.ravel() for grid in np.meshgrid((np.arange(long) + 0.5) * dp, (np.arange(layers) + 0.5) * dp))
    told = {"liquid_density": RHO, "liquid_viscosity": consistency, "yield_stress": stress, "flow_index": index}
    builder.add_particles(
        pos=np.stack([x, 0.0 * x, z], axis=1).tolist(),
        vel=np.stack([speed_at(z), 0.0 * z, 0.0 * z], axis=1).tolist(),
        mass=[RHO * dp * dp] * len(x),
        custom_attributes={"sph:pressure": (-RHO * ACROSS * (DEPTH - z)).tolist()}
        | {f"sph:{name}": [value] * len(x) for name, value in told.items()},
    )
    builder.add_shape_plane(body=-1, width=0.0, length=0.0)
    config = SolverSPH.Config(
        spacing=dp, speed_of_sound=10.0, rest_density=RHO, artificial_viscosity=0.0, dimensions=2,
        periodic=((0.0, long * dp), None, None), largest_viscosity=largest,
    )  # fmt: skip
    solver = SolverSPH(builder.finalize(device="cpu"), config)
    thick = float(config.largest_viscosity_of(np.array([RHO]), np.array([consistency]))[0])
    state, steps = solver.model.state(), math.ceil(seconds / config.yielding_time_step(thick / RHO))
    for _ in range(steps):
        solver.step(state, state, None, None, seconds / steps)
    z, speed = state.particle_q.numpy()[:, 2], state.particle_qd.numpy()[:, 0]
    layer = np.clip((z / dp).astype(int), 0, layers - 1)
    return (np.arange(layers) + 0.5) * dp, np.array([speed[layer == k].mean() for k in range(layers)]), thick


@pytest.mark.parametrize("index", [1.0, 0.5])
def test_a_film_down_a_slope_has_the_speed_and_the_plug_of_the_law(index):
    """v = n / (n + 1) (rho g sin a / k)^(1/n) (h^(1+1/n) - (h - z)^(1+1/n)) up to h, where the stress is tau_y.

    With a viscosity of 300 Pa s at rest, and not an infinite one, it is 7 % faster on top. It starts so; what the
    method has otherwise would grow in the time that shear takes to cross it, H^2 rho / k.
    """
    stress, consistency, largest = 0.5 * RHO * ALONG * DEPTH, 10.0 if index == 1.0 else 40.0, 300.0
    sheared, power = DEPTH - stress / (RHO * ALONG), 1.0 + 1.0 / index
    ideal = (RHO * ALONG / consistency) ** (1.0 / index) / power * sheared**power
    heights = np.linspace(0.0, DEPTH, 201)
    rates = 10.0 ** np.linspace(-4, 3, 4000)
    stresses = consistency * rates**index - stress * np.expm1(-largest / stress * rates)
    rate = np.interp(RHO * ALONG * (DEPTH - heights), np.minimum(stresses, largest * rates), rates)
    steady = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(heights)))
    assert steady[-1] == pytest.approx(1.07 * ideal, rel=0.01)
    z, speed, _ = film(stress, consistency, index, lambda at: np.interp(at, heights, steady), 0.75, largest)
    assert speed[-2:].mean() == pytest.approx(
        steady[-1], rel=0.08
    )  # in the end 6 %: the yield surface is a third of a spacing high
    # Where 0.9 of the speed is reached tells how deep it is sheared; the rest is the plug.
    at = float(np.interp(0.9 * ideal, speed, z)) / (1.0 - 0.1 ** (1.0 / power))
    assert at == pytest.approx(sheared, abs=0.06 * DEPTH)


def test_a_heap_below_its_yield_stress_stands_but_for_the_creep_of_the_largest_viscosity():
    """tau = rho g h sin a is half the yield stress: it creeps at tau H / 2 mu_max; water would run at g sin a t."""
    stress = 2.0 * RHO * ALONG * DEPTH
    _, speed, thick = film(stress, 1.0, 1.0, np.zeros_like, 0.25, 3000.0, 10)
    x = 0.5  # tau / tau_y at the foot; rate = -tau_y / mu_max ln(1 - tau / tau_y), summed over the depth
    creep = stress / thick * DEPTH * (1.0 + (1.0 - x) / x * math.log(1.0 - x))
    assert speed[-1] == pytest.approx(creep, rel=0.1)
    assert speed[-1] < 0.02 * ALONG * 0.25


def lumps(stresses: list[float]) -> list[dict[str, np.ndarray]]:
    """Worlds in which a lump that yields at such a stress flies into water, and what they hold after a while."""
    builder, dp = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, 0.0)), 0.02
    SolverSPH.register_custom_attributes(builder, several_liquids=True)
    cube = (np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) - 1.5) * dp
    for stress in stresses:
        one = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, 0.0))
        SolverSPH.register_custom_attributes(one, several_liquids=True)
        for x, speed, density, own in ((-0.045, 1.5, RHO, stress), (0.045, 0.0, 1000.0, 0.0)):
            told = {"liquid_density": density, "liquid_viscosity": 0.1, "yield_stress": own}
            one.add_particles(
                pos=(cube + np.array([x, 0.003, 0.0])).tolist(),
                vel=[(speed, 0.0, 0.1 * speed)] * len(cube),
                mass=[density * dp**3] * len(cube),
                custom_attributes={f"sph:{name}": [value] * len(cube) for name, value in told.items()},
            )
        builder.add_world(one)
    config = SolverSPH.Config(spacing=dp, speed_of_sound=15.0)
    solver = SolverSPH(builder.finalize(device="cpu"), config)
    state, mass = solver.model.state(), solver.model.particle_mass.numpy().astype(np.float64)
    start = state.particle_qd.numpy().astype(np.float64)
    for _ in range(60):
        solver.step(state, state, None, None, 6e-4)
    world, end = solver.model.particle_world.numpy(), state.particle_qd.numpy()
    return [
        {
            "q": state.particle_q.numpy()[world == k],
            "v": end[world == k],
            "gained": mass[world == k] @ (end[world == k] - start[world == k]),
            "exchanged": mass[world == k] @ np.abs(end[world == k] - start[world == k]),
        }
        for k in range(len(stresses))
    ]


def test_what_yields_keeps_its_momentum_and_goes_alone_as_in_a_batch():
    """Though its viscosity is in no step exact: the stages give velocities, and the force of each pair is opposite."""
    batch = lumps([50.0, 500.0])
    for one in batch:
        assert one["exchanged"].max() > 0.05  # [N s]: they did meet
        assert np.abs(one["gained"]).max() < 1e-6 * one["exchanged"].max()
    alone = lumps([500.0])[0]
    for name in ("q", "v"):
        assert alone[name].tobytes() == batch[1][name].tobytes(), name
    assert not np.array_equal(batch[0]["q"], batch[1]["q"])
