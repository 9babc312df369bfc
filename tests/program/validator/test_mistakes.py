"""Mistakes that people and models make, each in a program that is otherwise right: each is found, at its line."""

from __future__ import annotations

import numpy as np
import pytest

from wsim.program.validator import validate

HEAD = """\
import math

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics, Vt

from wsim.scene import Drive, Scene


def build(scene: Scene) -> None:
    scene.ground()
    tank = scene.tank("tank", inner_size=(1.0, 1.0, 1.0))
    water = scene.fluid("water", fills=tank, level=0.5, spacing=0.05)
    wood = scene.material("wood", density=600.0)
    arm = scene.box("arm", size=(0.5, 0.05, 0.05), position=(3.0, 0.0, 1.0), material=wood)
    fore = scene.box("fore", size=(0.5, 0.05, 0.05), position=(3.5, 0.0, 1.0), material=wood)
    prim = scene.stage.GetPrimAtPath("/World/arm") if {stage} else None
"""
LINE = HEAD.count("\n") + 1

# statement: (code, part of what is said, part of what is nearest)
SCENE = {
    'scene.cube("a", size=(1, 1, 1))': ("attribute", 'no "cube"', "Scene.box("),
    'scene.add_box("a", size=(1, 1, 1))': ("attribute", 'no "add_box"', "Scene.box("),
    'scene.joint_hinge("j", arm, fore)': ("attribute", 'no "joint_hinge"', "Scene.joint_revolute("),
    'scene.joint_revolute("j", None, arm, friction=-1.0)': ("value", "friction = -1", "Scene.joint_revolute("),
    'scene.joint_fixed("j", None, arm, break_force=0.0)': ("value", "break_force = 0", "Scene.joint_fixed("),
    "scene.gravity((0, 0, -1))": ("attribute", 'no "gravity"', "Scene.simulation("),
    'scene.box("a", size=(1, 1, 1), pos=(0, 0, 0))': ("argument", '"pos"', "Scene.box("),
    'scene.box("a", size=(1, 1, 1), rotation=(0, 0, 30))': ("argument", 'did you mean "rotation_deg"', "Scene.box("),
    'scene.box("a", (1, 1, 1))': ("argument", "takes 1 positional argument", "Scene.box("),
    'scene.sphere("a")': ("argument", 'lacks "radius"', "Scene.sphere("),
    'scene.box("a", size=1.0)': ("argument", '"size"', "Scene.box("),
    'scene.box("a", size=(1, 1))': ("value", "2 numbers", "Scene.box("),
    'scene.box("a", size=(1, 1, -1))': ("value", "size[2] = -1", "Scene.box("),
    'scene.box("a", size=(1, 1, 1), density=0)': ("value", "density = 0", "Scene.box("),
    'scene.box("a", size=(1, 1, 1), mass=1, density=5)': ("value", "both given", "Scene.box("),
    'scene.box("a", size=(1, 1, 1), color="red")': ("argument", '"color"', "Scene.box("),
    'scene.box("a", size=(1, 1, 1), static=True, velocity=(1, 0, 0))': ("value", "static", "Scene.box("),
    'scene.box("a", size=(1, 1, 1), material="steel")': ("value", '"steel" is not in the scene', "Scene.box("),
    'scene.box("arm", size=(1, 1, 1))': ("prim", "already used", ""),
    'scene.box("my box", size=(1, 1, 1))': ("value", "not a prim name", "Scene.box("),
    'scene.box("a", size=(1, 1, 1), rotation_deg=(0, 0, math.radians(30)))': ("unit", "given radians", "Scene.box("),
    'scene.joint_revolute("j", arm, fore, limits_deg=(-1.57, 1.57))': ("unit", "given radians", "joint_revolute("),
    'scene.joint_revolute("j", arm, fore, limits=(-30, 30))': ("argument", '"limits_deg"', "joint_revolute("),
    'scene.joint_prismatic("j", arm, fore, limits_deg=(-30, 30))': ("argument", 'mean "limits"', "joint_prismatic("),
    'scene.joint_revolute("j", "arm", "foree")': ("prim", "not in the scene", '"fore"'),
    'scene.joint_revolute("j", arm, arm)': ("value", "two bodies", "joint_revolute("),
    'scene.joint_revolute("j", arm, fore, drive=45)': ("argument", '"drive"', "joint_revolute("),
    'scene.joint_revolute("j", None, "pin"); scene.box("pin", size=(1, 1, 1))': ("order", "only later", ""),
    'scene.joint_revolute("j", arm, fore, drive=Drive(position=30))': ("value", "would do nothing", "joint_revolute("),
    "Drive(stiffnes=3)": ("argument", 'did you mean "stiffness"', "Drive("),
    'scene.fluid("b", fills=tank, level=0.3)': ("argument", 'lacks "spacing"', "Scene.fluid("),
    'scene.fluid("b", fills=tank, spacing=0.05)': ("value", "without level", "Scene.fluid("),
    'scene.camera("c", eye=(1, 1, 1), target=(1, 1, 1))': ("value", "looks at itself", "Scene.camera("),
    'scene.light("l", "spot")': ("value", '"spot"', "Scene.light("),
    "scene.simulation(gravity=(0, 0, 9.81))": ("value", "points up", ""),
    'scene.param("p", 5, low=6)': ("value", "outside", "Scene.param("),
    'scene.mesh("m", file="x.obj", collision="hull")': ("value", '"hull"', "Scene.mesh("),
    'scene.asset("a", "no_such_thing")': ("value", "no asset", "Scene.asset("),
    "x = water.surface_height": ("attribute", "surface_height", "Fluid.surface"),
    "x = tank.size": ("attribute", '"size"', "Tank.inner_size"),
    "x = scene.random.randint(3)": ("attribute", "randint", "integers"),
    "tank.wall = 3": ("attribute", 'no "wall"', ""),
}
# NumPy warned of it until 2.4, and has it no longer from 2.5 on.
ROW_STACK = ("deprecated", "vstack", "") if hasattr(np, "row_stack") else ("attribute", '"row_stack"', "vstack(")
OTHERS = {
    "x = np.float(3)": ("deprecated", "was removed", ""),
    "x = np.product([1, 2])": ("attribute", "product", "numpy.prod("),
    "x = np.linspce(0, 1)": ("attribute", "linspce", "numpy.linspace("),
    "x = np.linspace(0, 1, count=5)": ("argument", '"count"', "numpy.linspace("),
    "x = np.zeros(3).push(2)": ("attribute", "push", ""),
    "x = math.clamp(1, 0, 2)": ("attribute", "clamp", ""),
    "angle_deg = 30; x = math.sin(angle_deg)": ("unit", "radians", ""),
    'x = scene.stage.GetPrim("/World/arm")': ("attribute", "GetPrim", "Usd.Stage.GetPrimAtPath("),
    "x = scene.stage.GetPrimAtPath(arm)": ("argument", '"path"', "GetPrimAtPath("),
    'x = scene.stage.GetPrimAtPath("/World/amr")': ("prim", "has been made", '"/World/arm"'),
    'x = scene.stage.GetPrimAtPath("/World/arm").GetAttribute("physics:densty")': (
        "attribute", "physics:densty", '"physics:density"',
    ),
    "UsdPhysics.MassAPI.Apply(arm)": ("argument", '"prim"', "MassAPI.Apply("),
    'UsdPhysics.MassAPI(scene.stage.GetPrimAtPath("/World/arm")).CreateMass(3)': (
        "attribute", "CreateMass", "CreateMassAttr(",
    ),
    'UsdPhysics.MassAPI(scene.stage.GetPrimAtPath("/World/arm")).CreateMassAttr(-3)': ("value", "below 0", ""),
    "UsdPhysics.RigidBody": ("attribute", "RigidBody", "RigidBodyAPI("),
    'UsdGeom.Box.Define(scene.stage, "/World/x")': ("attribute", '"Box"', "UsdGeom.Cube("),
    'UsdGeom.Cube.Define(scene, "/World/x")': ("argument", '"stage"', "Cube.Define("),
    "v = Gf.Vec3d(1, 2)": ("argument", "lacks", "Gf.Vec3d("),
    "v = Gf.Vector3d(1, 2, 3)": ("attribute", "Vector3d", "Gf.Vec3d("),
    "v = Gf.Rotation(Gf.Vec3d(0, 0, 1))": ("argument", "Rotation()", "Gf.Rotation("),
    "from pxr import UsdPhysic": ("attribute", "UsdPhysic", "UsdPhysics"),
    "from wsim import Scene": ("attribute", "Scene", "wsim.scene"),
    "import wsim.scenes": ("import", "cannot be imported", "from wsim.scene import Scene"),
    "import newton": ("import", "cannot be imported", ""),
    "import socket": ("import", "no network", ""),
    "import subprocess": ("import", "no processes", ""),
    "import os; os.system('ls')": ("import", "no processes", ""),
    "open('/etc/x', 'w')": ("import", "outside its run folder", ""),
    "x = tnak": ("name", '"tnak"', '"tank"'),
    "y = later + 1; later = 3": ("order", '"later"', ""),
    "x = len(3, 4)": ("argument", "len()", "len("),
    "x = [1, 2].push(3)": ("attribute", "push", ""),
    "a, b = (1, 2, 3)": ("value", "2 names are given 3", ""),
    "x = np.row_stack(([1], [2]))": ROW_STACK,
    "x = np.zeros(3, dtype='flaot')": ("value", "flaot", ""),
    "x = tank.inner_size / 2": ("value", "fails", ""),
    "x = water.surface()": ("attribute", "no function", ""),
    "for i in range(scene.param('n', 3)): pass": ("value", "fails", ""),
    "scene.box('a', **dict(size=(1, 1, 1), frictions=0.5))": ("argument", '"friction"', "Scene.box("),
    "UsdPhysics.MassAPI.CreateMassAttr(3.0)": ("argument", "on the class", ""),
    "UsdPhysics.RevoluteJoint.Define(scene.stage, '/World/j').CreateAxisAttr('W')": ("value", '"axis" = "W"', ""),
    "UsdPhysics.RevoluteJoint.Define(scene.stage, '/World/j').CreateLocalPos0Attr([0, 0, 1])": (
        "argument", "point3f", "",
    ),
    "UsdPhysics.DriveAPI.Apply(scene.stage.GetPrimAtPath('/World/arm'), 'rotary')": ("value", "rotary", ""),
    "for i in range(3): scene.box('b', size=(1, 1, 1))": ("prim", "already used", ""),
    "for i in range(3): scene.box(f'b{i}', size=(i, 1, 1))": ("value", "size[0] = 0", "Scene.box("),
}  # fmt: skip


@pytest.mark.parametrize("stage", [True, False], ids=["after raw USD", "scene alone"])
@pytest.mark.parametrize("statement", [*SCENE, *OTHERS])
def test_is_found_at_its_line(statement: str, stage: bool) -> None:
    if stage and any(
        word in statement for word in ("steel", "foree", "pin", "arm, arm", "no_such", "without", "GetPrimAtPath(")
    ):
        pytest.skip("what else is on the stage is then no longer known")
    code, said, nearest = {**SCENE, **OTHERS}[statement]
    head = HEAD.replace(" if {stage} else None", "") if stage else HEAD.rsplit("\n    prim", 1)[0] + "\n\n"
    (problem, *_) = found = validate(f"{head}    {statement}\n")
    assert (problem.line, problem.code) == (LINE, code), [p.sentence for p in found]
    assert said in problem.message
    assert nearest in problem.nearest
    assert "\n" not in problem.sentence


@pytest.mark.parametrize(
    ("text", "line", "code"),
    [
        ("def build(scene):\n    scene.ground(\n", 2, "syntax"),
        ("def make(scene):\n    pass\n", 1, "build"),
        ("def build():\n    pass\n", 1, "build"),
        ("def build(scene, extra):\n    scene.ground()\n", 1, "build"),
        ("async def build(scene):\n    scene.ground()\n", 1, "build"),
        ("def build(scene):\n    x = 1\n", 1, "build"),
        ("def build(scene):\n    scene.ground()\n\n\ndef control(world):\n    pass\n", 5, "control"),
        ("def build(scene):\n    scene.ground()\nreturn 3\n", 3, "syntax"),
        ("def build(scene):\n    helper(scene)\ndef helper(s):\n    s.boxx('a')\n", 4, "attribute"),
        ("def build(scene):\n    helper(scene, 3)\ndef helper(s):\n    s.ground()\n", 2, "argument"),
        ("def build(scene):\n    scene.ground()\ndef unused(x):\n    return undefined\n", 4, "name"),
    ],
)
def test_what_is_wrong_with_a_whole_program(text: str, line: int, code: str) -> None:
    assert (line, code) in [(p.line, p.code) for p in validate(text)]


CLASSES = """\
class Chain:
    length = 0.2

    def __init__(self, scene, name):
        self.scene, self.name, self.links = scene, name, []

    def grow(self, count):
        for i in range(count):
            self.links.append(self.scene.capsule(f"{self.name}_{i}", radius=0.02, height=self.length))
        return self


def build(scene):
    chain = Chain(scene, "chain").grow(3)
    scene.joint_fixed("end", None, chain.links[-1])
"""


@pytest.mark.parametrize(
    ("right", "wrong", "line", "code"),
    [
        ("height=self.length", "length=self.length", 9, "argument"),
        ("{self.name}_{i}", "{self.name}", 9, "prim"),
        ("height=self.length", "height=-self.length", 9, "value"),
        ("height=self.length", "height=self.lenght", 9, "attribute"),
        (".grow(3)", ".grow()", 14, "argument"),
        ('Chain(scene, "chain")', "Chain(scene)", 14, "argument"),
        (".grow(3)", ".extend(3)", 14, "attribute"),
        ("links[-1]", "links[3]", 15, "value"),
    ],
)
def test_mistakes_in_classes(right: str, wrong: str, line: int, code: str) -> None:
    assert validate(CLASSES) == []
    assert CLASSES.count(right) == 1
    assert (line, code) in [(p.line, p.code) for p in validate(CLASSES.replace(right, wrong))]


CONTROL = """\
import math


def build(scene):
    scene.ground()
    box = scene.box("block", size=(0.2, 0.2, 0.2), position=(0, 0, 1))
    scene.joint_revolute("hinge", None, box)
    scene.sensor_imu("imu", box)


def control(world, t):
    felt = world.sensor("imu").accelerometer
    joint = world.joint("hinge")
    body = world.body("block")
    joint.target = math.radians(30.0)
    joint.force += 2.0 * t
    world.apply_force("block", (0.0, 0.0, 1.0))
"""


@pytest.mark.parametrize(
    ("statement", "code", "said"),
    [
        ("body.pos", "attribute", "pos"),
        ('world.body("blokc")', "prim", "blokc"),
        ('world.joint("block")', "prim", "block"),
        ('world.sensor("block")', "prim", 'no sensor "block"'),
        ('world.sensor("imu").accel', "attribute", "accel"),
        ('world.sensor("imu").gyroscope = 1.0', "attribute", "for reading"),
        ('world.push("block", (0, 0, 1))', "attribute", "push"),
        ('world.apply_force("block", force=(0, 0, 1), point=(0, 0, 0))', "argument", "point"),
        ("joint.target = math.degrees(t)", "unit", "radians"),
        ("joint.torque = 3.0", "attribute", "torque"),
        ("joint.position = 3.0", "attribute", "for reading"),
        ("scene.ground()", "name", "scene"),
    ],
)
def test_mistakes_in_control(statement: str, code: str, said: str) -> None:
    assert validate(CONTROL) == []
    (problem,) = validate(f"{CONTROL}    {statement}\n")
    assert (problem.line, problem.code) == (CONTROL.count("\n") + 1, code)
    assert said in problem.message


CAMERAS = """\
def build(scene):
    for k in range(int(scene.param("count", 2.0))):
        scene.camera(f"aside_{k}", eye=(0, -3 - k, 1), target=(0, 0, 0))
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0, 0, 1))
    scene.camera("chase", eye=(-2, 0, 1), target=(0, 0, 1), follows="block", turns=True)
    scene.sensor_camera("eye", "block", width=64, height=48, channels=["depth"])


def control(world, t):
    eye = world.sensor("eye")
    return eye.depth.min(), eye.color.mean(), eye.segmentation == eye.labels.index("block")
"""


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ('follows="block"', 'follow="block"', "follow"),
        ("width=64", "width=0", "width = 0 must be >= 1 pixel"),
        ('channels=["depth"]', 'channels=["deep"]', 'channels = "deep" must be one of color, depth, segmentation'),
        ("eye.labels", "eye.names", "names"),
    ],
)
def test_mistakes_with_cameras(right: str, wrong: str, said: str) -> None:
    """Of a program whose scene is not known prim for prim: each argument is tried by itself."""
    assert validate(CAMERAS) == []
    (problem,) = validate(CAMERAS.replace(right, wrong))
    assert said in problem.message


def test_a_camera_follows_what_is_there() -> None:
    text = 'def build(scene):\n    scene.box("block", size=(1, 1, 1))\n'
    text += '    scene.camera("c", eye=(0, 0, 3), target=(0, 0, 0), '
    assert validate(text + 'follows="block")\n') == []
    (problem,) = validate(text + 'follows="blok")\n')
    assert (problem.line, problem.code) == (3, "prim") and 'follows = "blok" is not in the scene' in problem.message


def test_problems_come_in_the_order_of_the_lines() -> None:
    found = validate("import socket\n\n\ndef build(scene):\n    scene.boxx()\n    scene.bal()\n    x = nowhere\n")
    assert [p.line for p in found] == [1, 5, 6, 7]
