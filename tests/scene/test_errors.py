import math
import re
from collections.abc import Callable

import numpy as np
import pytest

from wsim.scene import Drive, Part, Scene, SceneError
from wsim.scene.check_joints import joint_problems

NAN, INF = math.nan, math.inf
UNIT = (1.0, 1.0, 1.0)

CASES: list[tuple[Callable[[Scene], object], str]] = [
    (lambda s: s.box("block_0", size=(0.1, -0.3, 0.2)), 'box("block_0"): size[1] = -0.3 must be > 0 m'),
    (lambda s: s.box("b", size=(0.1, 0.0, 0.2)), 'box("b"): size[1] = 0 must be > 0 m'),
    (lambda s: s.box("b", size=(0.1, 0.2)), "has 2 numbers; it must be 3"),
    (lambda s: s.box("b", size=0.1), "must be 3 numbers"),
    (lambda s: s.box("b", size=(1e5, 1, 1)), "size[0] = 100000 must be <= 1000 m"),
    (lambda s: s.box("b", size=(1e-9, 1, 1)), "size[0] = 1e-09 must be >= 0.0001 m"),
    (lambda s: s.box("b", size=("wide", 1, 1)), 'size[0] = "wide" must be a number in m'),
    (lambda s: s.box("b", size=UNIT, position=(0, NAN, 0)), "position[1] = nan must be finite"),
    (lambda s: s.box("b", size=UNIT, position=(0, 0, INF)), "position[2] = inf must be finite"),
    (lambda s: s.box("b", size=UNIT, position=(0, 0, 1e6)), "position[2] = 1e+06 must be <= 10000 m"),
    (lambda s: s.box("b", size=UNIT, density=0), "density = 0 must be > 0 kg/m^3"),
    (lambda s: s.box("b", size=UNIT, density=1e9), "density = 1e+09 must be <= 100000 kg/m^3"),
    (lambda s: s.box("b", size=UNIT, mass=-1), "mass = -1 must be > 0 kg"),
    (lambda s: s.box("b", size=UNIT, mass=1, density=1), "both given; give one"),
    (lambda s: s.box("b", size=UNIT, friction=-0.1), "friction = -0.1 must be >= 0"),
    (lambda s: s.box("b", size=UNIT, restitution=2), "restitution = 2 must be <= 1"),
    (lambda s: s.box("b", size=UNIT, color=(255, 0, 0)), "color[0] = 255 must be <= 1"),
    (lambda s: s.box("b", size=UNIT, velocity=(0, 0, 1e6)), "velocity[2] = 1e+06"),
    (lambda s: s.box("b", size=UNIT, static=True, velocity=(1, 0, 0)), "static object"),
    (lambda s: s.box("b", size=UNIT, static=True, kinematic=True), "static = True and kinematic = True"),
    (lambda s: s.box("b", size=UNIT, material="wod"), 'did you mean "wood"?'),
    (lambda s: s.box("b", size=UNIT, material="block"), 'material = "block" is not in the scene; known: wood; make it'),
    (lambda s: s.box("block", size=UNIT), 'name "block" is already used'.replace('"', "'")),
    (lambda s: s.box("2fast", size=UNIT), 'name "2fast" is not a prim name'),
    (lambda s: s.box("a b", size=UNIT), "is not a prim name"),
    (lambda s: s.box("../x", size=UNIT), "is not a prim name"),
    (lambda s: s.box("", size=UNIT), "is not a prim name"),
    (lambda s: s.box(7, size=UNIT), "name 7 is not a prim name"),  # type: ignore[arg-type]
    (lambda s: s.box("Looks", size=UNIT), "is reserved"),
    (lambda s: s.sphere("b", radius=True), "radius = True must be a number"),
    (lambda s: s.cylinder("b", radius=1, height=-1), "height = -1 must be > 0 m"),
    (lambda s: s.capsule("b", radius=1, height=1, axis="W"), 'axis = "W" must be "X", "Y" or "Z"'),
    (lambda s: s.mesh("b", file="missing.obj"), 'file = "missing.obj" is not there'),
    (lambda s: s.mesh("b", file="model.docx"), "must end in one of .obj"),
    (lambda s: s.tank("t", inner_size=(1, 1, 0)), 'tank("t"): inner_size[2] = 0 must be > 0 m'),
    (lambda s: s.tank("t", inner_size=UNIT, wall=-0.1), "wall = -0.1 must be > 0 m"),
    (lambda s: s.fluid("w", fills="tank", level=1.5, spacing=0.1), 'level = 1.5 m is above the rim of tank "tank"'),
    (lambda s: s.fluid("w", fills="tank", level=0.5, spacing=2), "spacing = 2 m is too coarse for tank"),
    (lambda s: s.fluid("w", fills="tank", level=0.05, spacing=0.1), "must hold at least one particle"),
    (lambda s: s.fluid("w", fills="tank", level=0.5, spacing=0.001), "5e+08 particles"),
    (lambda s: s.fluid("w", fills="tank", spacing=0.1), "fills is given without level"),
    (lambda s: s.fluid("w", fills="block", level=0.5, spacing=0.1), 'fills = "block" holds no fluid'),
    (lambda s: s.fluid("w", fills="tnk", level=0.5, spacing=0.1), 'did you mean "tank"?'),
    (lambda s: s.fluid("w", spacing=0.1), "give fills= and level="),
    (lambda s: s.fluid("w", size=UNIT, position=(0, 0, 9), spacing=NAN), "spacing = nan must be finite"),
    (lambda s: s.fluid("w", size=UNIT, position=(0, 0, 9), spacing=0.1, density=0), "density = 0 must be > 0"),
    (lambda s: s.fluid("w", size=UNIT, position=(0, 0, 9), spacing=0.1, viscosity=-1), "viscosity = -1 must be >= 0"),
    (
        lambda s: s.fluid("w", size=UNIT, position=(0.5, 0, 0.52), spacing=0.1, container="tank"),
        "outside the hollow of",
    ),
    (lambda s: s.compound("n", parts=[Part("sphere", radius=1)], mass=-1.0), "mass = -1 must be > 0 kg"),
    (lambda s: s.compound("n", parts=[Part("sphere", radius=1)], mass=NAN), "mass = nan must be finite"),
    (lambda s: s.compound("n", parts=[Part("sphere", radius=1)], mass=True), "mass = True must be a number"),
    (lambda s: s.compound("n", parts=[Part("sphere", radius=1)], mass="x"), 'mass = "x" must be a number'),  # type: ignore[arg-type]
    (lambda s: s.compound("n", parts=[Part("sphere", radius=1, density=1e-30)]), "density = 1e-30 must be >= 0.001"),
    (lambda s: s.box("b", size=UNIT, mass=10**400), "mass must be finite in kg"),
    (lambda s: s.box("b", size={0.1, 0.2, 0.3}), "is a set, which has no order; give a list of 3 numbers"),  # type: ignore[arg-type]
    (lambda s: s.box("b", size=UNIT, position={0, 1, 2}), "position = {0, 1, 2} is a set"),  # type: ignore[arg-type]
    (lambda s: s.box("b", size=UNIT, color=frozenset((0, 1, 0.5))), "is a set, which has no order"),  # type: ignore[arg-type]
    (lambda s: s.camera("c", eye={1, 2, 3}, target=(0, 0, 0)), "eye = {1, 2, 3} is a set"),  # type: ignore[arg-type]
    (lambda s: s.simulation(gravity={0, 1, -9}), "is a set, which has no order"),  # type: ignore[arg-type]
    (lambda s: s.box("b", size=UNIT, mass=1e-30), "mass = 1e-30 must be >= 1e-12 kg"),
    (lambda s: s.box("b", size=UNIT, static="no"), 'static = "no" must be True or False'),  # type: ignore[arg-type]
    (lambda s: s.rope("r", "block", None, anchor_b=UNIT, around=None), "around = None must be a list"),  # type: ignore[arg-type]
    (lambda s: s.rope("r", "block", None, anchor_b=UNIT, around="w"), 'around = "w" must be a list'),  # type: ignore[arg-type]
    (lambda s: s.cable("c", "block", None, anchor_b=UNIT, through=1.0), "through = 1.0 must be points"),  # type: ignore[arg-type]
    (lambda s: s.cable("c", "block", None, anchor_b=UNIT, loose="no"), 'loose = "no" must be True'),  # type: ignore[arg-type]
    (lambda s: s.cable("c", "block", None, anchor_b=UNIT, loose=np.ones(2)), "loose = array([1., 1.]) must be True"),  # type: ignore[arg-type]
    (lambda s: s.cable("c", "block", None, anchor_b=UNIT, mass_per_length=1e-300), "must be >= 1e-09 kg/m"),
    (lambda s: s.track("t", pieces=[("line", 1.0)], wall=1e-300), "wall = 1e-300 must be >= 0.0001 m"),
    (lambda s: s.track("t", pieces=[("line", 1.0)], profile=np.ones(2)), "profile = array([1., 1.]) must be one of"),  # type: ignore[arg-type]
    (
        lambda s: s.height_field("f", heights=[[0, 0], [0, 1]], size=(1, 1), cells=(2, 2)),
        "cells = (2, 2) beside heights",
    ),
    (lambda s: s.joint_revolute("j", None, "block", axis=None), 'axis = None must be "X", "Y", "Z"'),  # type: ignore[arg-type]
    (lambda s: s.material("m", density=0), "density = 0 must be > 0"),
    (lambda s: s.material("wood"), "already used"),
    (lambda s: s.material("m", opacity=1.5), "opacity = 1.5 must be <= 1"),
    (lambda s: s.joint_fixed("j", "nobody", "block"), 'parent = "nobody" is not in the scene'),
    (lambda s: s.joint_fixed("j", "block", "block"), "a joint needs two bodies"),
    (lambda s: s.joint_fixed("j", None, "tank"), 'child = "tank" is static'),
    (lambda s: s.joint_fixed("j", None, "cam"), 'child = "cam" is not a body'),
    (lambda s: s.joint_fixed("j", None, None), "child = None must be what a call returned"),  # type: ignore[arg-type]
    (lambda s: s.joint_revolute("j", None, "block", axis=(0, 0, 0)), "has no length"),
    (lambda s: s.joint_revolute("j", None, "block", limits_deg=(30, -30)), "low limit must not lie above"),
    (lambda s: s.joint_revolute("j", None, "block", limits_deg=(10, 30)), "must hold 0"),
    (
        lambda s: s.joint_revolute("j", None, "block", limits=(-1, 1)),  # type: ignore[arg-type]
        "limits = (-1, 1) are a slider's, in m; a hinge takes limits_deg = (low, high) in deg",
    ),
    (
        lambda s: s.joint_prismatic("j", None, "block", limits_deg=(-90, 0)),  # type: ignore[arg-type]
        "limits_deg = (-90, 0) are a hinge's, in deg; a slider takes limits = (low, high) in m",
    ),
    (lambda s: s.joint_revolute("j", None, "block", drive=Drive()), "would do nothing"),
    (
        lambda s: s.joint_revolute("j", None, "block", drive=Drive(damping=1.0, saturates=True)),
        "drive.saturates = True needs a max_force: that is where a drive saturates",
    ),
    (lambda s: s.joint_fixed("j", None, "block", break_force=1e-30), "break_force = 1e-30 must be >= 1e-12 N"),
    (lambda s: s.joint_fixed("j", None, "block", break_torque=1e-30), "break_torque = 1e-30 must be >= 1e-16 N m"),
    (
        lambda s: s.track("t", pieces=[("loop", 0.2, 0.02)], width=0.1),
        "pieces[0] aside = 0.02 m: the loop runs through itself, for the track is 0.1 m wide with its walls",
    ),
    (lambda s: s.track("t", pieces=[("loop", 0.2, 0.1)], width=0.1, wall=0.05), "the track is 0.12 m wide"),
    (lambda s: s.track("t", pieces=[("up", 1.0, 400.0)]), "pieces[0] angle = 400 deg must be <= 360: the bend runs"),
    (lambda s: s.track("t", pieces=[("left", 1.0, 400.0)]), "pieces[0] angle = 400 deg: the bend runs into itself"),
    (lambda s: s.joint_revolute("j", None, "block", drive=Drive(stiffness=NAN)), "drive.stiffness = nan"),
    (lambda s: s.joint_prismatic("j", None, "block", drive=Drive(velocity=1, stiffness=1)), "needs drive.damping > 0"),
    (lambda s: s.joint_prismatic("j", None, "block", anchor=(0, NAN, 0)), "anchor[1] = nan"),
    (lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 1)), "the camera looks at itself"),
    (lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 0), fov=180), "fov = 180 must be <= 170 deg"),
    (
        lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 0), follows="tank"),
        'follows = "tank" is nothing that moves; name a body, or of a robot or a vehicle one of its links',
    ),
    (
        lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 0), turns=True),
        "turns = True needs follows, the body that it turns with",
    ),
    (lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 0), width=0), "width = 0 must be >= 16 pixel"),
    (lambda s: s.camera("c", eye=(0, 0, 1), target=(0, 0, 0), width=99.5), "width = 99.5 must be a whole number"),
    (lambda s: s.light("l", "laser"), 'kind = "laser" must be one of distant, dome, sphere'),
    (lambda s: s.light("l", direction=(0, 0, 0)), "has no length"),
    (lambda s: s.param("p", NAN), "default = nan must be finite"),
    (lambda s: s.param("p", 5, low=10), "default = 5 lies outside"),
    (lambda s: s.param("p", 5, low=10, high=1), "low = 10 is above high = 1"),
    (lambda s: s.simulation(duration=0), "duration = 0 must be > 0 s"),
    (lambda s: s.simulation(time_step=-1), "time_step = -1 must be >= 0 s"),
    (lambda s: s.simulation(time_step=1e-12), "time_step = 1e-12 must be >= 1e-05 s, or 0 for the simulator's choice"),
    (lambda s: s.simulation(seed=-1), "seed = -1 must be >= 0"),
    (lambda s: Scene(params={"p": INF}), "inf must be finite"),
    (lambda s: s.save("world.txt"), "must end in .usda"),
]


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.material("wood", density=600)
    scene.box("block", size=(0.1, 0.1, 0.1), position=(0, 0, 5), material="wood")
    scene.tank("tank", inner_size=(1, 1, 1))
    scene.camera("cam", eye=(0, -3, 1), target=(0, 0, 0))
    return scene


@pytest.mark.parametrize(("call", "message"), CASES, ids=[message for _, message in CASES])
def test_bad_input_is_named(scene: Scene, call: Callable[[Scene], object], message: str) -> None:
    before = {str(prim.GetPath()) for prim in scene.stage.Traverse()}
    with pytest.raises(SceneError, match=re.escape(message)) as error:
        call(scene)
    assert "\n" not in str(error.value)
    after = {str(prim.GetPath()) for prim in scene.stage.Traverse()}
    assert after == before


def test_overlapping_fluids_are_refused(scene: Scene) -> None:
    scene.fluid("w", fills="tank", level=0.5, spacing=0.1)
    with pytest.raises(SceneError, match='overlaps "w"'):
        scene.fluid("v", size=(0.5, 0.5, 0.5), position=(0, 0, 0.3), spacing=0.1)
    scene.fluid("above", size=(0.5, 0.5, 0.3), position=(0, 0, 0.67), spacing=0.1)


def test_what_fills_a_tank_after_another_fluid_lies_on_it(scene: Scene) -> None:
    water = scene.fluid("water", fills="tank", level=0.3, spacing=0.1)
    with pytest.raises(SceneError, match=re.escape('level = 0.3 m is not above "water", which fills tank "tank"')):
        scene.fluid("oil", fills="tank", level=0.3, spacing=0.1, density=900.0)
    oil = scene.fluid("oil", fills="tank", level=0.5, spacing=0.1, density=900.0)
    foam = scene.fluid("foam", fills="tank", volume=0.2 * oil.size[0] * oil.size[1], spacing=0.1, density=300.0)
    assert oil.size[2] == pytest.approx(0.2)
    assert oil.surface == pytest.approx(water.surface + 0.2)
    assert foam.surface == pytest.approx(oil.surface + 0.2)


def test_a_loop_without_a_plain_joint_is_refused() -> None:
    scene = Scene()
    bodies = [scene.box(f"b{i}", size=(0.1, 0.1, 0.1), position=(i, 0.0, 0.0)) for i in range(2)]
    scene.joint_prismatic("a", None, bodies[0], axis="X")
    scene.joint_revolute("b", bodies[0], bodies[1], axis="Y", friction=1.0)
    before = [str(prim.GetPath()) for prim in scene.stage.Traverse()]
    with pytest.raises(SceneError, match=r'joint_revolute\("c"\): the joints a, b, c make a loop in which each slides'):
        scene.joint_revolute("c", None, bodies[1], axis="Y", limits_deg=(-10.0, 10.0))
    assert [str(prim.GetPath()) for prim in scene.stage.Traverse()] == before
    scene.joint_revolute("c", None, bodies[1], axis="Y")
    with pytest.raises(SceneError, match=r'gear\("g"\): the joints a, b, c make a loop'):
        scene.gear("g", "a", "c", ratio=1.0)


def test_joints_that_hold_nothing_are_refused() -> None:
    scene = Scene()
    crank = scene.box("crank", size=(0.1, 0.1, 0.1), position=(0.0, 0.0, 0.0), kinematic=True)
    for parent in (None, scene.box("rotor", size=(0.1, 0.1, 0.1), position=(1.0, 0.0, 0.0), kinematic=True)):
        with pytest.raises(SceneError, match=r'"crank" is kinematic and goes its own way'):
            scene.joint_revolute("pin", parent, crank)
    with pytest.raises(SceneError, match=r"child = None must be what a call returned"):
        scene.joint_fixed("nothing", crank, None)  # type: ignore[arg-type]


BREAKS = {"break_force": 5.0}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda s: s.joint_revolute("j", None, "b", friction=-1.0), "friction = -1 must be >= 0 N m"),
        (lambda s: s.joint_prismatic("j", None, "b", friction=float("nan")), "friction = nan must be finite in N"),
        (lambda s: s.joint_fixed("j", None, "b", break_force=0.0), "break_force = 0 must be > 0 N"),
        (lambda s: s.joint_prismatic("j", None, "b", **BREAKS), "a slider cannot break: let a small carriage body"),
        (lambda s: s.joint_prismatic("j", None, "b", break_torque=1.0), "a slider cannot break: let a small carriage"),
        (lambda s: s.joint_revolute("j", None, "b", limits_deg=(-1, 1), **BREAKS), "may break can have no limits_deg"),
        (
            lambda s: s.joint_revolute("j", None, "b", friction=1.0, break_torque=1.0),
            "may break can have no limits_deg",
        ),
        (lambda s: s.gear("g", "hinge", "hinge", ratio=1.0), 'joint_a = joint_b = "hinge": a gear couples two joints'),
        (lambda s: s.gear("g", "hinge", "weld", ratio=1.0), 'joint_b = "weld" is no hinge and no slider'),
        (lambda s: s.gear("g", "hinge", "loose", ratio=1.0), 'joint_b = "loose" may break; a gear needs joints that'),
        (lambda s: s.gear("g", "hinge", "slide", ratio=0.0), "ratio = 0 must be 1e-06 or more, or -1e-06 or less"),
        (lambda s: s.gear("g", "hinge", "b", ratio=1.0), 'joint_b = "b" is no hinge and no slider'),
    ],
)
def test_bad_joints_are_named(make: Callable[[Scene], object], message: str) -> None:
    scene = Scene()
    for name in "abcde":
        scene.box(name, size=(0.1, 0.1, 0.1), position=(ord(name), 0.0, 0.0))
    scene.joint_revolute("hinge", None, "a")
    scene.joint_prismatic("slide", None, "c")
    scene.joint_fixed("weld", None, "d")
    scene.joint_revolute("loose", None, "e", break_force=1.0)
    with pytest.raises(SceneError, match=re.escape(message)):
        make(scene)


def test_gears_in_a_ring_that_contradict_are_refused() -> None:
    scene = Scene()
    for i in range(3):
        scene.box(f"b{i}", size=(0.1, 0.1, 0.1), position=(i, 0.0, 0.0))
        scene.joint_revolute(f"j{i}", None, f"b{i}")
    scene.gear("first", "j0", "j1", ratio=-2.0)
    scene.gear("second", "j1", "j2", ratio=-0.5)
    with pytest.raises(SceneError, match=r'gear\("third"\): ratio = -1, and other gears couple the two by 1'):
        scene.gear("third", "j2", "j0", ratio=-1.0)
    scene.gear("third", "j2", "j0", ratio=1.0)
    assert list(joint_problems(scene.stage)) == []
    scene.stage.GetPrimAtPath("/World/third").GetAttribute("wsim:ratio").Set(-1.0)
    problems = list(joint_problems(scene.stage))
    assert [problem for problem in problems if "all would lock" in problem]


def test_a_path_repeats_or_does_not() -> None:
    scene = Scene()
    scene.box("lift", size=(1, 1, 0.1), kinematic=True)
    with pytest.raises(SceneError, match=r"repeat = array\(\[1, 2\]\) must be True or False"):
        scene.path("lift", times=[0, 1], positions=[(0, 0, 0), (0, 0, 1)], repeat=np.array([1, 2]))  # type: ignore[arg-type]
