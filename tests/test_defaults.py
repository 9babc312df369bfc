"""What the plan, the program and the stage take where nothing is said is the same, wherever it is written."""

from pathlib import Path

import pytest

from wsim import defaults
from wsim.plan.schema import Material, SimulationPlan
from wsim.scene import Scene
from wsim.scene.contact import pair_law
from wsim.scene.describe import describe
from wsim.scene.world import World


def test_a_stage_that_says_nothing_has_the_defaults(tmp_path: Path) -> None:
    scene = Scene()
    tank = scene.tank("tank", inner_size=(1.0, 1.0, 1.0))
    scene.fluid("water", fills=tank, level=0.5, spacing=0.1)
    scene.box("box", size=(0.1, 0.1, 0.1), position=(0.0, 0.0, 2.0))
    scene.camera("side", eye=(0.0, -4.0, 1.0), target=(0.0, 0.0, 0.5))
    scene.sensor_imu("imu", "box")
    scene.save(tmp_path / "stage.usda")
    world = describe(tmp_path / "stage.usda")
    assert world.gravity == pytest.approx((0.0, 0.0, -defaults.GRAVITY), rel=1e-6)  # USD keeps 32 bits of them
    assert (world.duration, world.frame_rate) == (defaults.DURATION, defaults.FRAME_RATE)
    assert tank.floor == pytest.approx(defaults.WALL)
    assert world.fluids[0].density == defaults.FLUID_DENSITY
    assert world.bodies[0].mass / world.bodies[0].volume == pytest.approx(defaults.BODY_DENSITY, rel=1e-6)
    shape = world.bodies[0].shapes[0]
    assert pair_law(world, shape, shape).friction == defaults.FRICTION
    assert world.sensors[0].rate == defaults.SENSOR_RATE
    assert world.cameras[0].fov == pytest.approx(defaults.FIELD_OF_VIEW, rel=1e-6)


def test_a_plan_and_a_world_that_say_nothing_have_them_too() -> None:
    plan, world = SimulationPlan(), World()
    assert (plan.duration, plan.frame_rate) == (world.duration, world.frame_rate)
    assert world.gravity == (0.0, 0.0, -defaults.GRAVITY)
    assert Material(name="wood", density=600.0).friction == defaults.FRICTION
