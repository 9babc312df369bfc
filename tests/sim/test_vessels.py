"""Vessels of any shape hold water: none gets out, they bear its weight, and it presses as deep as it is."""

import math
from pathlib import Path

import numpy as np
import pytest

from tests.sim import vessel_shapes as shapes
from wsim.scene import Scene
from wsim.sim.simulation import Simulation

G, DP = 9.81, 0.0125
FRAMES = 20
STILL = 14  # frames of what is at rest


def still(scene: Scene, folder: Path) -> tuple[Simulation, np.ndarray, np.ndarray, float]:
    """Some of it: the simulation, heights and pressures in the last half, and the force on what stands [N]."""
    scene.simulation(duration=STILL / FRAMES, frame_rate=FRAMES)
    simulation = Simulation(scene.save(folder / "still.usda"), "cpu")
    heights, pressures = [], []
    for frame in range(STILL):
        simulation.advance_frame()
        if frame == STILL // 2 - 1:
            simulation.fluid.take_wall_impulse()
            start = simulation.time
        if frame >= STILL // 2:
            heights.append(simulation.state.particle_q.numpy()[:, 2].copy())
            pressures.append(simulation.state.sph.pressure.numpy().copy())
    force = -float(simulation.fluid.take_wall_impulse()[0, 2]) / (simulation.time - start)
    return simulation, np.concatenate(heights), np.concatenate(pressures), force


CASES = {
    "without thickness": (lambda: shapes.sheet_cup(0.05, 0.12), {"level": 0.08}, (0, 0, 0)),
    "bowl": (lambda: shapes.bowl(0.07, 0.005), {"volume": 4e-4}, (0, 0, 0)),
    "bottle": (lambda: shapes.bottle(0.05, 0.02, 0.15, 0.004), {"level": 0.08}, (0, 0, 0)),
    "half-pipe": (lambda: shapes.trough(0.05, 0.15, 0.005), {"level": 0.04}, (0, 0, 30)),
    "tilted cone": (lambda: shapes.cup(0.03, 0.12, 0.004, 0.4), {"level": 0.06}, (15, 0, 20)),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_mesh_holds_water(tmp_path: Path, name: str) -> None:
    mesh, filled, turn = CASES[name]
    mesh().export(tmp_path / "vessel.stl")
    scene = Scene()
    vessel = scene.mesh(
        "vessel", file=tmp_path / "vessel.stl", static=True, position=(0.2, 0.0, 0.5), rotation_deg=turn
    )
    water = scene.fluid("water", fills=vessel, spacing=DP, **filled)
    simulation, height, pressure, force = still(scene, tmp_path)
    place = simulation.state.particle_q.numpy()
    low, high = (np.array(water.center) + side * np.array(water.size) / 2 for side in (-1, 1))
    assert (place > low - 0.1 * DP).all()  # a floor's flat faces lie in the grid that finds it
    assert (place < high + DP * np.array([1.5, 1.5, 0.5])).all()
    weight = float(simulation.model.particle_mass.numpy().sum()) * G
    assert force == pytest.approx(weight, rel=0.01)
    slope, at_zero = np.polyfit(height, pressure, 1)
    # Particles that are not on a lattice sink together, as in a tank where they are stirred, and it is not over yet.
    assert slope * low[2] + at_zero == pytest.approx(1000.0 * G * water.size[2], rel=0.12)


@pytest.mark.parametrize(("name", "level", "spacing"), [("mug", 0.05, 0.006)])
def test_an_asset_on_the_ground_holds_water(tmp_path: Path, name: str, level: float, spacing: float) -> None:
    scene = Scene()
    scene.ground()
    vessel = scene.asset("vessel", name, static=True)
    water = scene.fluid("water", fills=vessel, level=level, spacing=spacing)
    simulation, _, _, force = still(scene, tmp_path)
    place = simulation.state.particle_q.numpy()
    assert (np.abs(place[:, :2] - np.array(water.center[:2])) < 0.5 * np.array(water.size[:2]) + spacing).all()
    assert (place[:, 2] > water.center[2] - 0.5 * water.size[2] - 0.1 * spacing).all()
    assert force == pytest.approx(float(simulation.model.particle_mass.numpy().sum()) * G, rel=0.01)


def test_water_that_runs_against_a_thin_wall_stays_in(tmp_path: Path) -> None:
    """The wall is a third of a spacing thick, and the water runs against it at 3 m/s."""
    shapes.cup(0.05, 0.16, 0.003).export(tmp_path / "vessel.stl")
    scene = Scene()
    vessel = scene.mesh("vessel", file=tmp_path / "vessel.stl", static=True)
    scene.fluid("water", fills=vessel, level=0.06, spacing=DP, speed_of_sound=30.0)
    scene.simulation(duration=1.0, frame_rate=FRAMES)
    simulation = Simulation(scene.save(tmp_path / "jolt.usda"), "cpu")
    push = np.tile([3.0, 1.0, 0.0], (len(simulation.state.particle_q), 1)).astype(np.float32)
    simulation.state.particle_qd.assign(push)  # 3 m/s against a wall 3 mm thick
    for _ in range(2):
        simulation.advance_frame()
        place = simulation.state.particle_q.numpy()
        under = place[:, 2] < 0.163
        assert (np.hypot(place[under, 0], place[under, 1]) < 0.0535).all()
        assert (place[:, 2] > 0.003 - 1e-4).all()
    assert math.isfinite(float(place.sum()))


def test_a_thin_vessel_has_a_tap_and_a_drain(tmp_path: Path) -> None:
    """Water leaves by the hole in the floor alone, and what came, is held and went adds up."""
    shapes.cup(0.05, 0.12, 0.003).export(tmp_path / "vessel.stl")
    scene = Scene()
    vessel = scene.mesh("vessel", file=tmp_path / "vessel.stl", static=True)
    water = scene.fluid("water", fills=vessel, level=0.06, spacing=0.01)
    scene.tap("tap", water, rate=2e-4, position=(0.0, 0.0, 0.11), radius=0.02)
    scene.drain("hole", water, position=(0.0, 0.0, 0.003), radius=0.02)
    scene.simulation(duration=0.4, frame_rate=FRAMES)
    simulation = Simulation(scene.save(tmp_path / "open.usda"), "cpu")
    openings, mass = simulation.fluid.openings, float(simulation.model.particle_mass.numpy()[0])
    at_start = openings.free().sum() * mass
    assert at_start == pytest.approx(1000.0 * math.pi * 0.05**2 * 0.06, rel=0.03)
    for _ in range(8):
        simulation.advance_frame()
        place = simulation.state.particle_q.numpy()[openings.free()]
        assert (np.hypot(place[:, 0], place[:, 1]) < 0.0535).all()
        assert (place[:, 2] > 0.003 - 1e-4).all()
    come, gone = float(openings.come()[0]), float(openings.gone()[0])
    assert come == pytest.approx(1000.0 * 2e-4 * 0.4, abs=14 * mass)  # Q t, to a layer at the mouth
    assert len(place) * mass == pytest.approx(at_start + come - gone, rel=1e-6)
    # Torricelli at the depth that is there at the start, and a third of it: what gets through falls between.
    free_fall = 1000.0 * math.pi * 0.02**2 * math.sqrt(2.0 * G * 0.06) * 0.4
    assert 0.33 * free_fall < gone < free_fall
