"""What a call is given and cannot honour is refused in one line that names it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pxr import UsdPhysics

from wsim.errors import UserError
from wsim.scene import Drive, Part, Scene, SceneError
from wsim.scene.check import check_stage
from wsim.sim import Simulation

Build = Callable[[Scene], object]
BALL = {"radius": 0.1, "position": (0, 0, 1)}
LIFT = {"size": (1, 1, 0.1), "position": (0, 0, 0.5), "kinematic": True}


def crate(scene: Scene, **given: object) -> object:
    return scene.box("crate", **({"size": (1, 1, 1), "position": (0, 0, 2)} | given))


def tight(scene: Scene, **given: object) -> object:
    return scene.track("way", **({"width": 0.4} | given))


def carried(scene: Scene, **keys: object) -> None:
    scene.path(scene.box("lift", **LIFT), **keys)


REFUSED: dict[str, tuple[Build, str]] = {
    "start of points": (
        lambda s: s.track("way", points=[(0, 0, 0), (1, 0, 0)], start=(0, 0, 1)),
        "start = (0, 0, 1) beside points",
    ),
    "heading of points": (
        lambda s: s.track("way", points=[(0, 0, 0), (1, 0, 0)], heading_deg=90),
        "heading_deg = 90 beside points",
    ),
    "slope of points": (
        lambda s: s.track("way", points=[(0, 0, 0), (1, 0, 0)], slope_deg=-5.0),
        "slope_deg = -5.0 beside points",
    ),
    "tight piece": (
        lambda s: tight(s, pieces=[("line", 1.0), ("left", 0.1, 90.0)]),
        "pieces[1] = ('left', 0.1, 90.0): a bend",
    ),
    "tight points": (lambda s: tight(s, points=[(0, 0, 0), (1, 0, 0), (1, 0.2, 0), (0, 0.2, 0)]), "points["),
    "mass of a static": (lambda s: crate(s, static=True, mass=3.0), "mass = 3 kg on a static object"),
    "speed of a static": (
        lambda s: crate(s, static=True, velocity=(1, 0, 0)),
        "velocity = (1.0, 0.0, 0.0) on a static object; leave it out, or give static=False",
    ),
    "density of a static": (
        lambda s: crate(s, static=True, density=300.0),
        "density = 300 kg/m^3 on a static object, which nothing moves; leave it out, or give static=False",
    ),
    "two belts": (
        lambda s: [
            s.surface_velocity(crate(s, static=True), velocity=(1, 0, 0)),
            s.surface_velocity("crate", velocity=(2, 0, 0)),
        ],
        "has a surface velocity already, (1.0, 0.0, 0.0)",
    ),
    "path from elsewhere": (
        lambda s: carried(s, times=(0, 1), positions=((0, 0, 1), (0, 0, 2))),
        "positions[0] = (0.0, 0.0, 1.0) is not where",
    ),
    "path turned": (
        lambda s: carried(s, times=(0, 1), rotations_deg=((0, 0, 30), (0, 0, 60))),
        'rotations_deg[0] turns "lift" by 30',
    ),
    "torque of a ball joint": (
        lambda s: s.joint_spherical("tie", None, s.sphere("ball", **BALL), break_torque=3.0),
        "break_torque = 3.0: a ball",
    ),
    "velocity without damping": (
        lambda s: s.joint_revolute("axle", None, s.sphere("ball", **BALL), drive=Drive(velocity=3.0, stiffness=2.0)),
        "without damping nothing follows",
    ),
    "part's size": (
        lambda s: s.compound("tool", parts=[Part("sphere", radius=0.1, height=0.3)]),
        "parts[0].height = 0.3: a sphere",
    ),
    "part's mass twice": (
        lambda s: s.compound("tool", parts=[Part("sphere", radius=0.1, mass=1.0, density=2.0)]),
        "parts[0].mass = 1.0 and density = 2.0",
    ),
    "part's weight": (
        lambda s: s.compound("tool", parts=[Part("sphere", radius=0.1, mass=-1.0)]),
        "parts[0].mass = -1 must be > 0",
    ),
    "lost file": (lambda s: s.mesh("thing", file="nowhere.obj"), 'file = "nowhere.obj" is not there; looked at'),
    "static asset that flies": (
        lambda s: s.asset("mug", "mug", static=True, velocity=(1, 0, 0)),
        "velocity = (1.0, 0.0, 0.0) on a static",
    ),
    "kinematic pair": (
        lambda s: s.contact(s.box("lift", **LIFT), crate(s, static=True), friction=0.3),
        "both are static or kinematic",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_one_line_that_names_the_value(case: str) -> None:
    build, says = REFUSED[case]
    with pytest.raises(SceneError) as error:
        build(Scene())
    assert says in str(error.value)
    assert "\n" not in str(error.value)


TIES: dict[str, tuple[Build, str]] = {
    "hinge": (lambda s: s.joint_revolute("tie", "one", "two"), "never .*: the joint </World/tie> ties them; leave"),
    "glue": (
        lambda s: s.joint_fixed("tie", "one", "two", break_force=9.0),
        "never .*: the joint </World/tie> ties them, and they pass each other once it broke; leave",
    ),
    "static": (lambda s: s.joint_fixed("tie", "post", "two"), "never .*: the joint </World/tie> ties them; leave"),
    "gear": (lambda s: s.gear("tie", "axle", "bearing", ratio=-1.0), "never .*: the gear </World/tie> meshes them"),
}


def of_a_pair(tie: str) -> tuple[Scene, tuple[str, str]]:
    scene = Scene()
    scene.box("post", size=(0.1, 0.1, 1), position=(0, 0, 0.5), static=True)
    scene.box("one", size=(0.1,) * 3, position=(0, 0, 2))
    scene.box("two", size=(0.1,) * 3, position=(0.1, 0, 2))
    if tie == "gear":
        scene.joint_revolute("axle", None, "one")
        scene.joint_revolute("bearing", None, "two")
    return scene, ("post" if tie == "static" else "one", "two")


@pytest.mark.parametrize("tie", TIES)
def test_a_pair_that_is_tied_never_touches(tie: str) -> None:
    """In either order, and the call that comes last leaves nothing behind."""
    made, says = TIES[tie]
    scene, pair = of_a_pair(tie)
    made(scene)
    with pytest.raises(SceneError, match=says):
        scene.contact(*pair, friction=0.3)
    scene, pair = of_a_pair(tie)
    scene.contact(*pair, friction=0.3)
    with pytest.raises(SceneError, match=says):
        made(scene)
    assert not scene.stage.GetPrimAtPath("/World/tie")


def test_a_stage_may_state_no_pair_that_is_tied(tmp_path) -> None:
    scene, pair = of_a_pair("glue")
    scene.contact(*pair, friction=0.3)
    joint = UsdPhysics.FixedJoint.Define(scene.stage, "/World/tie")
    joint.CreateBody0Rel().SetTargets(["/World/one"])
    joint.CreateBody1Rel().SetTargets(["/World/two"])
    problems = check_stage(scene.save(tmp_path / "tied.usda"), [tmp_path])
    assert any("never touch: the joint </World/tie> ties them; leave" in problem for problem in problems)


def test_an_asset_starts_as_it_is_told(tmp_path) -> None:
    scene = Scene()
    scene.asset(
        "mug", "mug", position=(0, 0, 1), rotation_deg=(0, 0, 90), velocity=(1, 2, 3), angular_velocity_deg=(0, 0, 90)
    )
    simulation = Simulation(scene.save(tmp_path / "mug.usda"), "cpu")
    assert simulation.state.body_qd.numpy()[0] == pytest.approx([1, 2, 3, 0, 0, np.pi / 2], abs=1e-5)


@pytest.mark.parametrize(("velocity", "held"), [((1.0, 0, 0), True), ((0, 0, 0), False)])
def test_a_weld_that_may_break_holds_from_the_start(tmp_path, velocity, held) -> None:
    scene = Scene()
    scene.box("sign", size=(0.1, 0.1, 0.1), position=(0, 0, 1), velocity=velocity)
    scene.joint_fixed("glue", None, "sign", break_force=50.0)
    stage = scene.save(tmp_path / "sign.usda")
    if not held:
        Simulation(stage, "cpu")
        return
    with pytest.raises(UserError, match=r"/World/glue: what it holds together starts apart, at \(1.0, 0.0, 0.0\) m/s"):
        Simulation(stage, "cpu")


def test_two_that_fly_together_may_be_glued(tmp_path) -> None:
    """About a common axis, too: each has the velocity of its own place."""
    scene = Scene()
    scene.box(
        "a", size=(0.2,) * 3, position=(0.5, 0, 1), velocity=(0, 1.0, 0), angular_velocity_deg=(0, 0, np.degrees(2.0))
    )
    scene.box(
        "b", size=(0.2,) * 3, position=(0.7, 0, 1), velocity=(0, 1.4, 0), angular_velocity_deg=(0, 0, np.degrees(2.0))
    )
    scene.joint_fixed("glue", "a", "b", anchor=(0.6, 0, 1), break_force=50.0)
    Simulation(scene.save(tmp_path / "pair.usda"), "cpu")
