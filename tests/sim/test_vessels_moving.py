"""Vessels that move: swung over, poured from, pushed along; nothing gets through their walls."""

import math
from pathlib import Path

import numpy as np
import pytest

from wsim.geometry.rotations import conjugate, rotate
from wsim.scene import Handle, Part, Scene
from wsim.sim.simulation import Simulation

G, DP = 9.81, 0.02
HALF, HIGH, WALL = 0.06, 0.18, 0.006  # half the hollow's width, its height, and its walls' thickness [m]
FRAMES = 20


def bucket(scene: Scene, **given: object) -> Handle:
    """A square bucket of five plates, its hollow centred on its origin, from z = 0 up."""
    side, out = HALF + WALL / 2, 2 * (HALF + WALL)
    plates = [Part("box", size=(out, out, WALL), position=(0.0, 0.0, -WALL / 2))]
    for s in (-1.0, 1.0):
        plates.append(Part("box", size=(WALL, 2 * HALF, HIGH), position=(s * side, 0.0, HIGH / 2)))
        plates.append(Part("box", size=(out, WALL, HIGH), position=(0.0, s * side, HIGH / 2)))
    return scene.compound("bucket", parts=plates, **given)


def seen_from(simulation: Simulation) -> np.ndarray:
    """The particles in the bucket's frame (n, 3) [m]."""
    pose = simulation.state.body_q.numpy()[0].astype(float)
    return rotate(conjugate(pose[3:]), simulation.state.particle_q.numpy().astype(float) - pose[:3])


def in_walls_or_under(place: np.ndarray) -> int:
    """How many are in a wall, beyond the way of a step, or right under the floor or beside the walls."""
    beside = np.abs(place[:, :2]).max(axis=1) - HALF
    held = (beside < 0.1 * DP) & (place[:, 2] > -0.1 * DP)
    near = (beside < WALL + DP) & (place[:, 2] > -WALL - DP) & (place[:, 2] < HIGH - DP)
    return int((near & ~held).sum())


def test_a_bucket_that_is_swung_over_spills_when_it_is_held_there(tmp_path: Path) -> None:
    """It is swung about a point over it, from rest, until it is over, at w^2 r = 2.5 g there; then it is stopped."""
    spin, radius, ramp = 7.0, 0.5, 0.4
    over = 0.5 * ramp + math.pi / spin  # [s]
    times = np.linspace(0.0, over, 25)
    angle = np.where(times < ramp, 0.5 * spin / ramp * times**2, spin * (times - 0.5 * ramp))
    times, angle = np.append(times, over + np.array([0.1, 1.0])), np.append(angle, angle[-1] + np.array([0.2, 0.2]))
    places = np.column_stack([radius * np.sin(angle), 0.0 * angle, radius - radius * np.cos(angle)])
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=FRAMES)
    held = bucket(scene, kinematic=True)
    turns = np.column_stack([0.0 * angle, -np.degrees(angle), 0.0 * angle])
    scene.path(held, times=times.tolist(), positions=places.tolist(), rotations_deg=turns.tolist())
    scene.fluid("water", fills=held, level=0.08, spacing=DP)
    simulation, share = Simulation(scene.save(tmp_path / "swung.usda"), "cpu"), []
    for _ in range(18):
        simulation.advance_frame()
        place = seen_from(simulation)
        assert in_walls_or_under(place) == 0
        inside = np.abs(place[:, :2]).max(axis=1) < HALF
        share.append(float((inside & (place[:, 2] > -0.1 * DP) & (place[:, 2] < HIGH)).mean()))
    assert share[: int(over * FRAMES)] == [1.0] * int(over * FRAMES)
    assert share[-1] < 0.3  # it falls by 0.5 m since, of 0.18 m


def test_water_in_a_cart_that_gains_speed_leans_back(tmp_path: Path) -> None:
    """Pressure falls forward by rho a, and its levels lie at a / g to the ground."""
    gain = 3.0
    times = np.linspace(0.0, 0.7, 15)
    scene = Scene()
    scene.simulation(duration=0.7, frame_rate=FRAMES)
    cart = bucket(scene, kinematic=True)
    scene.path(
        cart, times=times.tolist(), positions=np.column_stack([gain / 2 * times**2, 0 * times, 0 * times]).tolist()
    )
    scene.fluid("water", fills=cart, level=0.1, spacing=DP, viscosity=1.0)
    simulation, seen = Simulation(scene.save(tmp_path / "cart.usda"), "cpu"), []
    for frame in range(12):
        simulation.advance_frame()
        place = seen_from(simulation)
        assert in_walls_or_under(place) == 0
        if frame >= 6:
            seen.append(np.column_stack([place, simulation.state.sph.pressure.numpy()]))
    x, _, z, pressure = np.concatenate(seen).T
    slope = np.linalg.lstsq(np.column_stack([x, z, np.ones(len(x))]), pressure, rcond=None)[0]
    assert slope[0] / slope[1] == pytest.approx(gain / G, rel=0.25)


def test_what_is_poured_leaves_over_the_rim(tmp_path: Path) -> None:
    times = np.linspace(0.0, 0.7, 8)
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=FRAMES)
    held = bucket(scene, kinematic=True, position=(0.0, 0.0, 0.5))
    scene.path(held, times=times.tolist(), rotations_deg=[(0.0, 170.0 * t, 0.0) for t in times])
    scene.fluid("water", fills=held, level=0.1, spacing=DP)
    simulation = Simulation(scene.save(tmp_path / "poured.usda"), "cpu")
    count = []
    for _ in range(18):
        simulation.advance_frame()
        place = seen_from(simulation)
        assert in_walls_or_under(place[place[:, 0] < HALF]) == 0  # it runs down outside, where it is poured to
        count.append(int((np.abs(place[:, :2]).max(axis=1) < HALF).sum()))
    assert count[3] == len(place)
    assert count[-1] < 0.3 * len(place)


def test_the_ground_bears_a_bucket_and_its_water(tmp_path: Path) -> None:
    scene = Scene()
    scene.simulation(duration=0.6, frame_rate=FRAMES)
    scene.ground()
    held = bucket(scene, mass=2.0, position=(0.0, 0.0, WALL))
    scene.fluid("water", fills=held, level=0.1, spacing=DP)
    simulation, wrenches = Simulation(scene.save(tmp_path / "stands.usda"), "cpu"), []
    for _ in range(12):
        simulation.advance_frame()
        wrenches.append(simulation.fluid.body_wrench.numpy()[0, :3].copy())
    weight = G * float(simulation.model.particle_mass.numpy().sum())
    assert np.mean(wrenches[6:], axis=0) == pytest.approx([0.0, 0.0, -weight], abs=0.05 * weight)
    assert in_walls_or_under(seen_from(simulation)) == 0
    assert simulation.state.body_q.numpy()[0, :3] == pytest.approx([0.0, 0.0, WALL], abs=1e-3)
