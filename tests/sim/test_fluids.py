"""Where fluid stands at the start: not where bodies are, and everywhere else."""

import math

import numpy as np
import pytest
import trimesh

from wsim.geometry.shapes import into, kind_of
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import Body, Fluid, Shape, World
from wsim.sim.fluids import expected_speed
from wsim.sim.model import build_model
from wsim.sim.simulation import Simulation

SPACING = 0.025
CLEAR = 0.4 * SPACING  # [m], that fluid keeps from a body


@pytest.fixture
def filled(tmp_path):
    """Particles of a tank of 1 x 1 x 0.5 m of water about a body, their positions (n, 3) [m]."""

    def make(place) -> np.ndarray:
        scene = Scene()
        tank = scene.tank("tank", inner_size=(1.0, 1.0, 0.6))
        scene.fluid("water", fills=tank, level=0.5, spacing=SPACING)
        place(scene)
        scene.save(stage := tmp_path / "stage.usda")
        return build_model(stage, describe(stage), "cpu").model.particle_q.numpy()

    return make


def left_out(position: np.ndarray) -> float:
    return 0.5 - len(position) * SPACING**3


def test_water_stands_around_a_mesh_and_not_its_bounding_box(filled, tmp_path) -> None:
    """A cone fills a third of a cylinder, and a quarter of its box: water comes up to its slope."""
    radius, height = 0.15, 0.3
    trimesh.creation.cone(radius, height).export(tmp_path / "cone.obj")
    position = filled(lambda scene: scene.mesh("cone", file=tmp_path / "cone.obj", position=(0.0, 0.0, 0.1)))
    # Grown by what fluid keeps clear of: Steiner's formula, without the edges' share.
    skin = math.pi * radius * (radius + math.hypot(radius, height))
    assert left_out(position) == pytest.approx(math.pi * radius**2 * height / 3 + skin * CLEAR, rel=0.1)
    beside = (np.hypot(position[:, 0], position[:, 1]) < 0.75 * radius) & (np.abs(position[:, 2] - 0.3) < 0.05)
    assert beside.any()


def test_water_stands_around_what_is_fixed(filled, tmp_path) -> None:
    """A post and a cone that are screwed to the floor are no fuller of water than those that float."""
    trimesh.creation.cone(0.15, 0.3).export(tmp_path / "cone.obj")

    def place(static: bool):
        def fill(scene: Scene) -> None:
            scene.mesh("cone", file=tmp_path / "cone.obj", position=(0.2, 0.0, 0.1), static=static)
            scene.box("post", size=(0.2, 0.2, 0.4), position=(-0.2, 0.0, 0.25), rotation_deg=(0, 0, 30), static=static)

        return fill

    fixed, loose = filled(place(static=True)), filled(place(static=False))
    assert len(fixed) == pytest.approx(len(loose), abs=0.002 * len(loose))
    assert left_out(fixed) > 0.2 * 0.2 * 0.4 + math.pi * 0.15**2 * 0.3 / 3


def test_water_stands_around_a_cylinder(filled) -> None:
    position = filled(lambda scene: scene.cylinder("can", radius=0.15, height=0.3, position=(0.0, 0.0, 0.25)))
    grown = math.pi * (0.15 + CLEAR) ** 2 * (0.3 + 2 * CLEAR)
    assert left_out(position) == pytest.approx(grown, rel=0.05)


def test_a_lying_can_falls_from_its_lower_side() -> None:
    """A can of radius 0.3 m and height 2 m reaches 0.3 m down at least; half its radius was taken before."""
    shape = Shape(prim="/World/can/geometry", kind="cylinder", size=(0.3, 2.0))
    can = Body(
        prim="/World/can",
        mass=1.0,
        volume=1.0,
        inertia=(1.0,) * 9,
        position=(0.0, 0.0, 3.3),
        rotation=(0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)),
        shapes=[shape],
    )
    water = Fluid(
        prim="/World/water", density=1000.0, viscosity=1e-3, spacing=0.05, size=(1.0, 1.0, 0.5), center=(0, 0, 0.25)
    )
    assert expected_speed(World(bodies=[can], fluids=[water])) == pytest.approx(math.sqrt(2 * 9.81 * (3.0 - 0.5)))


def test_thrown_water_flies_on(tmp_path) -> None:
    """Nothing but gravity acts on a block as a whole: its centre goes by v t and g t (t + dt) / 2, in one world as in
    worlds that differ by the throw."""
    stages = []
    for k, velocity in enumerate([(1.0, 0.0, 0.0), (0.0, -1.0, 2.0)]):
        scene = Scene()
        scene.fluid("water", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 1.0), spacing=SPACING, velocity=velocity)
        scene.save(tmp_path / f"{k}.usda")
        stages.append((tmp_path / f"{k}.usda", velocity))
    worlds = [describe(stage) for stage, _ in stages]
    assert [world.fluids[0].velocity for world in worlds] == [velocity for _, velocity in stages]
    for flying in (stages[:1], stages):
        simulation = Simulation([stage for stage, _ in flying], "cpu")
        start = simulation.state.particle_q.numpy().reshape(len(flying), -1, 3).mean(axis=1)
        for _ in range(6):
            simulation.advance_frame()
        at = simulation.state.particle_q.numpy().reshape(len(flying), -1, 3).mean(axis=1)
        flown, thrown = simulation.time, [velocity for _, velocity in flying]
        assert flown == pytest.approx(0.2)
        fallen = 0.5 * 9.81 * flown * (flown + simulation.dt)
        assert at - start == pytest.approx(flown * np.array(thrown) - [0.0, 0.0, fallen], abs=1e-4)


@pytest.mark.parametrize(("middle", "count"), [(0.1, 640), (-0.02, 272), (0.0, 320)])
def test_a_block_that_reaches_into_the_ground_is_cut_by_it(tmp_path, middle, count) -> None:
    """8 x 8 x 10 particles; what would be under the ground had pressures of no meaning."""
    scene = Scene()
    scene.ground()
    scene.fluid("water", size=(0.2, 0.2, 0.25), position=(0.0, 0.0, middle + 0.025), spacing=SPACING)
    scene.save(stage := tmp_path / "stage.usda")
    position = build_model(stage, describe(stage), "cpu").model.particle_q.numpy()
    assert len(position) == pytest.approx(count, abs=64) and position[:, 2].min() > 0.3 * SPACING


def test_a_block_over_the_wall_of_a_tank_is_not_in_the_glass(tmp_path) -> None:
    scene = Scene()
    scene.tank("tank", inner_size=(0.4, 0.4, 0.3))
    scene.fluid("water", size=(0.2, 0.2, 0.1), position=(0.2, 0.0, 0.15), spacing=SPACING)
    scene.save(stage := tmp_path / "stage.usda")
    world = describe(stage)
    position = build_model(stage, world, "cpu").model.particle_q.numpy()
    walls = [shape for static in world.statics for shape in static.shapes]
    assert len(position) < 256
    assert max(kind_of(shape).depth(into(shape, position.astype(float))).max() for shape in walls) < 0.0
