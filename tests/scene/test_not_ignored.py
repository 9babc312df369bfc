"""What a call is given and cannot honour is refused in one line that names it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

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
    "density of a static": (lambda s: crate(s, static=True, density=300.0), "density = 300 kg/m^3 on a static object"),
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


def test_a_pair_that_a_joint_ties_never_touches(tmp_path) -> None:
    scene = Scene()
    scene.ground()
    scene.box("post", size=(0.1, 0.1, 1), position=(0, 0, 0.5), static=True)
    scene.box("arm", size=(1, 0.1, 0.1), position=(0.5, 0, 0.9))
    scene.joint_revolute("hinge", "post", "arm", anchor=(0, 0, 0.9), axis="Y")
    scene.contact("post", "arm", friction=0.3)
    with pytest.raises(UserError, match="never touch: the joint </World/hinge> ties them"):
        scene.save(tmp_path / "tied.usda")
        problems = list(check_stage(tmp_path / "tied.usda", [tmp_path]))
        raise UserError("; ".join(problems))


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
