"""Speeds that joints start with: what a stage leaves out follows from constraints and gears as well."""

import math

import pytest

from wsim.errors import UserError
from wsim.scene import Scene
from wsim.sim import Simulation

SPIN = math.degrees(20.0)


def started(tmp_path, build):
    """Velocity and spin of each body by name, (6,) each."""
    scene = Scene()
    build(scene)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
    names = [body.prim.rsplit("/", 1)[1] for body in simulation.world.bodies]
    return dict(zip(names, simulation.state.body_qd.numpy()[simulation.built.bodies].astype(float), strict=True))


def on_a_bracket(scene):
    bracket = scene.box("bracket", size=(0.1,) * 3, position=(0, 0, 1))
    scene.joint_fixed("glue", None, bracket, break_force=1e4)
    arm = scene.box("arm", size=(0.4, 0.05, 0.05), position=(0.2, 0.2, 1), angular_velocity_deg=(0, SPIN, 0))
    scene.joint_revolute("axle", bracket, arm, anchor=(0, 0.2, 1), axis="Y", friction=0.1)


def test_what_may_break_holds_still_what_another_turns_on(tmp_path):
    """The arm's middle, 0.2 m off the axle, goes down by 20 rad/s of that; the bracket stays."""
    found = started(tmp_path, on_a_bracket)
    assert found["bracket"] == pytest.approx(0.0, abs=1e-5)
    assert found["arm"] == pytest.approx([0, 0, -4, 0, 20, 0], abs=1e-5)


def test_what_does_not_start_together_is_told_with_its_speeds(tmp_path):
    def build(scene):
        scene.box("lever", size=(0.1,) * 3, position=(0, 0, 1), velocity=(0, 0, 2e-5))
        scene.joint_fixed("glue", None, "lever", break_force=1e4)

    with pytest.raises(
        UserError, match=r"/World/glue: .* apart, at \(0.0, 0.0, 2e-05\) m/s and \(0.0, 0.0, 0.0\) rad/s"
    ):
        started(tmp_path, build)


def test_a_crank_turns_the_linkage_that_it_closes(tmp_path):
    """A parallelogram: both cranks turn alike, and the coupler not at all."""

    def build(scene):
        for name, x, spin in (("crank", 0.0, 5.0), ("rocker", 0.5, 0.0)):
            turns = (0, 0, math.degrees(spin))
            scene.box(name, size=(0.02, 0.2, 0.02), position=(x, 0.1, 1), angular_velocity_deg=turns)
            scene.joint_revolute(f"foot_of_{name}", None, name, anchor=(x, 0, 1), axis="Z")
        scene.box("coupler", size=(0.5, 0.02, 0.02), position=(0.25, 0.2, 1.03))
        for name, x in (("crank", 0.0), ("rocker", 0.5)):
            scene.joint_revolute(f"pin_of_{name}", name, "coupler", anchor=(x, 0.2, 1.015), axis="Z")

    found = started(tmp_path, build)
    for name, speed, spin in (("crank", -0.5, 5.0), ("rocker", -0.5, 5.0), ("coupler", -1.0, 0.0)):
        assert found[name] == pytest.approx([speed, 0, 0, 0, 0, spin], abs=1e-5)


def meshed(scene, first=0.0, second=0.0):
    scene.cylinder("wheel", radius=0.1, height=0.05, position=(0, 0, 1), angular_velocity_deg=(0, 0, first))
    scene.box("rack", size=(0.5, 0.05, 0.05), position=(0, -0.125, 1), velocity=(second, 0, 0))
    scene.joint_revolute("axle", None, "wheel", axis="Z")
    scene.joint_prismatic("rail", None, "rack", axis="X")
    scene.gear("mesh", "axle", "rail", ratio=0.1)


@pytest.mark.parametrize("given", [{"first": SPIN}, {"second": 2.0}, {"first": SPIN, "second": 2.0}])
def test_what_a_gear_couples_starts_together(tmp_path, given):
    found = started(tmp_path, lambda scene: meshed(scene, **given))
    assert found["wheel"] == pytest.approx([0, 0, 0, 0, 0, 20], abs=1e-5)
    assert found["rack"] == pytest.approx([2, 0, 0, 0, 0, 0], abs=1e-5)


def test_what_a_gear_couples_may_not_start_otherwise(tmp_path):
    with pytest.raises(UserError, match=r"/World/mesh: </World/rail> starts with -2 .* the gear has 2 for the 20 of"):
        started(tmp_path, lambda scene: meshed(scene, first=SPIN, second=-2.0))
