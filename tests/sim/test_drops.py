"""Thin sheets, threads and single drops of a fluid's surface, against the volume of their particles."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.scene.world import Camera, Fluid, World
from wsim.sim.cameras import CameraRenderer
from wsim.sim.render_surface import FluidMesh

_spec = importlib.util.spec_from_file_location("camera_stages", Path(__file__).parent / "camera_stages.py")
assert _spec is not None
assert _spec.loader is not None
stages = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stages)

H = 0.02  # [m], spacing
MILK = Fluid(
    prim="/World/milk", density=1000.0, viscosity=1e-3, spacing=H, size=(0.2, 0.2, 0.2), center=(0.0, 0.0, 0.1),
    color=(0.9, 0.88, 0.82), attenuation_length=0.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def fluid_mesh() -> FluidMesh:
    world = World(fluids=[MILK])
    return FluidMesh(stages.model_of(world), world)


def mesh_about(fluid_mesh: FluidMesh, points: np.ndarray) -> trimesh.Trimesh:
    fluid_mesh.update({MILK.prim: np.asarray(points, dtype=np.float32)})
    return trimesh.Trimesh(fluid_mesh.points(), fluid_mesh.triangles())


def sheet(apart: float, noise: float, seed: int = 0) -> np.ndarray:
    """12 by 12 particles of a sheet in the plane y = 0, so many spacings apart."""
    x = (np.arange(12) - 5.5) * apart * H
    points = np.stack(np.meshgrid(x, [0.0], x), axis=-1).reshape(-1, 3)
    return points + np.random.default_rng(seed).normal(0.0, noise * H, points.shape)


@settings(max_examples=20, deadline=None)
@given(
    places=st.lists(st.tuples(*[st.integers(-6, 6)] * 3), min_size=1, max_size=8, unique=True), shift=st.floats(0, 1)
)
def test_each_drop_is_a_ball_of_its_particles_volume(places: list, shift: float, fluid_mesh: FluidMesh) -> None:
    """Wherever on the grid of the surface it is: particles 1.6 spacings apart, or more."""
    points = (np.array(places) * 1.6 + shift) * H
    drops = mesh_about(fluid_mesh, points).split()
    assert len(drops) == len(points)
    assert [drop.volume for drop in drops] == pytest.approx([H**3] * len(points), rel=1e-3)
    middles = np.array([drop.center_mass for drop in drops])
    assert np.linalg.norm(middles[:, None] - points[None], axis=2).min(axis=0) == pytest.approx(0.0, abs=0.01 * H)


@pytest.mark.parametrize("seed", range(4))
def test_a_sheet_one_particle_thick_has_no_holes(fluid_mesh: FluidMesh, seed: int) -> None:
    """Of particles a spacing apart, a tenth of it uneven: a closed body without a handle, of their volume."""
    mesh = mesh_about(fluid_mesh, sheet(1.0, noise=0.1, seed=seed))
    assert mesh.body_count == 1
    assert mesh.is_watertight
    assert mesh.euler_number == 2
    assert mesh.volume / (144 * H**3) == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize("apart", [1.2, 1.4])
def test_a_sheet_that_is_drawn_out_holds_together(fluid_mesh: FluidMesh, apart: float) -> None:
    mesh = mesh_about(fluid_mesh, sheet(apart, noise=0.02))
    assert (mesh.body_count, mesh.euler_number) == (1, 2)


def test_a_jet_is_one_stream(fluid_mesh: FluidMesh) -> None:
    """Water that falls from a nozzle 2 spacings wide narrows as v^(-1/2) to less than one, and stays in one piece."""
    points, z, speed = [], 0.0, 0.3
    while z > -0.2:
        across = H * np.sqrt(0.3 / speed)
        count = max(1, round(np.pi * across**2 / H**2))
        turn = 2.0 * np.pi * np.arange(count) / count + 40.0 * z
        radius = 0.0 if count == 1 else 0.6 * across
        points += [(radius * np.cos(a), radius * np.sin(a), z) for a in turn]
        z -= H / max(1.0, count * 0.5) if count > 1 else H
        speed = np.sqrt(0.09 - 2.0 * 9.81 * z)
    mesh = mesh_about(fluid_mesh, np.array(points))
    assert mesh.body_count == 1
    assert np.ptp(mesh.vertices[:, 2]) > 0.2


def test_calm_water_has_the_surface_that_it_had(fluid_mesh: FluidMesh) -> None:
    """Where particles are many, neither drops nor thin places: the lattice's volume, and flat faces."""
    points = stages.particles(MILK)
    mesh = mesh_about(fluid_mesh, points)
    assert mesh.body_count == 1
    assert mesh.volume / (len(points) * H**3) == pytest.approx(1.0, abs=0.06)
    top = mesh.vertices[(mesh.vertices[:, 2] > 0.15) & (np.abs(mesh.vertices[:, :2]) < 0.05).all(axis=1)]
    assert top[:, 2].mean() == pytest.approx(0.2, abs=0.1 * H)


def test_a_drop_is_seen_as_large_as_it_is() -> None:
    """Its disc, of 0.62 spacings, in pixels."""
    size, distance, fov = 64, 1.0, 4.0
    camera = Camera(prim="/World/c", eye=(0, -distance, 0), target=(0, 0, 0), fov=fov, width=size, height=size)
    world = World(fluids=[MILK], cameras=[camera])
    model = stages.model_of(world)
    renderer = CameraRenderer(model, world)
    drop = renderer.render(model.state(), {MILK.prim: np.zeros((1, 3))})["/World/c"].depth > 0.0
    focal = 0.5 * size / np.tan(np.radians(0.5 * fov))
    radius = focal * H * (3.0 / (4.0 * np.pi)) ** (1.0 / 3.0) / distance
    assert drop.sum() == pytest.approx(np.pi * radius**2, rel=0.08)
