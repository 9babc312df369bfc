"""Vehicles and terrain of a plan: what is composed of it is it, and what is built otherwise is found out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from tests.judge.checks.test_plan_closed import scene_of, still
from tests.judge.theory import ask
from wsim.judge import judge
from wsim.judge.checks.plan import CheckPlanLooks, CheckPlanPlaces, CheckPlanSizes
from wsim.judge.checks.plan_closed import CheckPlanClosed
from wsim.judge.checks.plan_contacts import CheckPlanContacts
from wsim.judge.checks.plan_joints import CheckPlanJoints
from wsim.judge.checks.plan_land import CheckPlanTerrain
from wsim.judge.checks.plan_motion import CheckPlanMotion
from wsim.judge.checks.plan_vehicles import CheckPlanVehicles
from wsim.judge.checks.run import CheckPlanObjects
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.control_world import OUTPUTS, ControlLayout
from wsim.recording import read
from wsim.rules.planner import plan as make_plan
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.control import ArrayController, driven_joints

if TYPE_CHECKING:
    from pathlib import Path

CHECKS = (
    CheckPlanObjects, CheckPlanClosed, CheckPlanSizes, CheckPlanPlaces, CheckPlanLooks, CheckPlanJoints,
    CheckPlanContacts, CheckPlanMotion, CheckPlanVehicles, CheckPlanTerrain,
)  # fmt: skip
ROUGH = "A Polaris drives 10 m over rough ground with 3 rocks and a tree."
BUGGY, GROUND = "/World/polaris", "/World/ground"


@pytest.fixture(scope="module")
def rough() -> Plan:
    return make_plan(ROUGH)


def wrong(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> set[tuple[str, str | None]]:
    """Check and prim of what is found."""
    recording = still(describe(scene_of(plan, more, change).stage))
    return {(f.check, f.prim) for check in CHECKS for f in ask(check(), recording, plan) if not f.passed}


@pytest.mark.parametrize("says", ["A car drives 50 m along a road and stops.", "A golf cart drives 10 m at 2 m/s."])
def test_what_is_composed_is_the_plans(says: str) -> None:
    assert wrong(make_plan(says)) == set()


def test_rough_ground_that_is_composed_is_the_plans(rough: Plan) -> None:
    assert wrong(rough) == set()


SET = 'p("{}").GetAttribute("{}").Set({})'


@pytest.mark.parametrize(
    ("more", "change", "check", "prim"),
    [
        ("", ('"polaris", position', '"car", position'), "CheckPlanVehicles", f"{BUGGY}_wheel_rear_left"),
        (SET.format(BUGGY, "physics:mass", 300.0), ("", ""), "CheckPlanVehicles", BUGGY),
        ("", ("place(-", "place(4.0 - "), "CheckPlanVehicles", BUGGY),
        ("", ("    scene.simulation", "    polaris.brake(0.1)\n    scene.simulation"), "CheckPlanVehicles",
         f"{BUGGY}_axle_front_left"),
        ("", ("    scene.simulation", "    polaris.drive(5.0)\n    scene.simulation"), "CheckPlanVehicles",
         f"{BUGGY}_axle_rear_right"),
        (SET.format(f"{BUGGY}_spring_rear_left", "drive:linear:physics:stiffness", 1e5), ("", ""), "CheckPlanVehicles",
         f"{BUGGY}_spring_rear_left"),
        (SET.format("/World/Looks/polaris_wheel_front_left", "physics:dynamicFriction", 0.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_wheel_front_left"),
        (SET.format(f"{BUGGY}_steer_front_left", "drive:angular:physics:targetPosition", 20.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_steer_front_left"),
        (SET.format(f"{BUGGY}_steer_front_right", "drive:angular:physics:stiffness", 0.0), ("", ""),
         "CheckPlanVehicles", f"{BUGGY}_steer_front_right"),
        (f'p("{BUGGY}_wheel_rear_left").GetAttribute("physics:kinematicEnabled").Set(True)', ("", ""),
         "CheckPlanObjects", f"{BUGGY}_wheel_rear_left"),
        ("", ("friction=0.85", "friction=0.0"), "CheckPlanLooks", GROUND),
        ("", ("Noise(0.6", "Noise(0.4"), "CheckPlanTerrain", GROUND),
        ("", ("seed=4", "seed=7"), "CheckPlanTerrain", GROUND),
        ("", ("size=(53.0, 40.0)", "size=(53.0, 44.0)"), "CheckPlanTerrain", GROUND),
        ("", ("size=(0.3, 1.2)", "size=(2.0, 3.0)"), "CheckPlanTerrain", "/World/rock_0"),
        ("", ("count=3", "count=2"), "CheckPlanObjects", "/World/rock_2"),
        ('scene.box("wall", size=(1, 1, 1), static=True)', ("", ""), "CheckPlanObjects", "/World/wall"),
        ('scene.contact("polaris_wheel_front_left", "ground", friction=0.1)', ("", ""), "CheckPlanContacts",
         "/World/Contacts/polaris_wheel_front_left_ground"),
        ('scene.joint_fixed("weld", None, "polaris")', ("", ""), "CheckPlanJoints", "/World/weld"),
        ('a = p("/World/ground/geometry").GetAttribute("points"); '
         "a.Set([(x, y, -3.0 if 0.0 < x < 4.0 else z) for x, y, z in a.Get()])", ("", ""), "CheckPlanTerrain", GROUND),
    ],
)  # fmt: skip
def test_what_is_built_otherwise_is_found(
    rough: Plan, more: str, change: tuple[str, str], check: str, prim: str
) -> None:
    assert (check, prim) in wrong(rough, more, change)


def test_how_thick_ground_is_says_nothing_of_its_height(rough: Plan) -> None:
    assert wrong(rough, change=("areas=ground_areas", "thickness=0.04, areas=ground_areas")) == set()


def test_ground_without_the_plans_hill_or_its_road_is_found() -> None:
    """A mesh of a few corners is right at each of them; what an area is made of has nothing to say where it is not."""
    over, along = make_plan("A car drives 60 m over a hill."), make_plan("A car drives 50 m along a road and stops.")
    assert wrong(over) == set()
    assert ("CheckPlanTerrain", GROUND) in wrong(over, change=("areas=ground", "cell=9.0,\n        areas=ground"))
    assert ("CheckPlanTerrain", GROUND) in wrong(along, change=("areas=ground_areas", "areas=()"))


# ---- in the simulator
@pytest.fixture(scope="module")
def short() -> Plan:
    return make_plan("A golf cart drives 10 m.")


def failed(plan: Plan, path: Path, change: tuple[str, str] = ("", ""), drives: bool = True) -> set[str]:
    """The checks that fail of a plan's program, as it runs; `drives`: its control does what it says."""
    text, space = compose(plan).replace(*change), {}
    exec(compile(text, "program.py", "exec"), space)
    scene = Scene()
    space["build"](scene)
    arrays: dict[str, np.ndarray] = {}

    def exchange(t, state):
        for name, values in state.items():
            arrays[name][...] = values
        arrays["joint_force"][...] = 0.0
        if drives:
            space["control"](world, t)
        return {name: arrays[name].copy() for name in OUTPUTS}

    simulation = Simulation(scene.save(path / "v.usda"), device="cpu", controller=ArrayController(exchange))
    layout = ControlLayout([body.prim for body in simulation.world.bodies], driven_joints(simulation.world))
    arrays |= {name: np.zeros(shape, np.float32) for name, shape in layout.shapes().items() if name != "t"}
    (world,) = layout.worlds(arrays)
    simulation.run(path / "r.rrd")
    verdict = judge(read(path / "r.rrd"), plan)
    assert verdict.crashes == []
    return {finding.check for finding in verdict.failures} - {"CheckSeen", "CheckInFrame"}  # no pictures are taken


def test_a_drive_is_accepted(short: Plan, tmp_path: Path) -> None:
    assert failed(short, tmp_path) == set()


def test_on_ice_it_is_rejected_for_its_friction_and_for_what_comes_of_that(short: Plan, tmp_path: Path) -> None:
    friction = next(item.material.friction for item in short.objects if item.name == "ground")
    assert failed(short, tmp_path, (f"friction={friction}", "friction=0.0")) == {
        "CheckPlanVehicles",
        "ObjectiveFormula",
    }


def test_with_its_motor_off_it_is_rejected_for_not_coming_there(short: Plan, tmp_path: Path) -> None:
    assert failed(short, tmp_path, drives=False) == {"ObjectiveFormula"}
