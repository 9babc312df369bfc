"""Programs that are right: nothing is said of them."""

from __future__ import annotations

import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.rules.planner import plan

ROOT = Path(__file__).parents[3]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SKILLS = sorted((ROOT / "skills").glob("*/SKILL.md"))
PROMPTS = (
    "Three wooden blocks float on the water in a glass tank. A steel ball sinks.",
    "There is a tank of water. Two oak logs float in it, and a large lead ball sinks to the bottom.",
    "A tower of 2 boxes stands on the ground",
    "A pendulum swings",
    "A ball is thrown into a stack of five boxes.",
    "Twelve cork balls float in a tank of water.",
)
RIGHT = {
    "names in loops and comprehensions": """
        sizes = [0.1 * (i + 1) for i in range(4)]
        boxes = [scene.box(f"box_{i}", size=(s, s, s), position=(i, 0, s)) for i, s in enumerate(sizes)]
        for i, (a, b) in enumerate(zip(boxes, boxes[1:])):
            scene.joint_spherical(f"link_{i}", a, b)
        """,
    "numbers that are not known": """
        for i in range(int(scene.random.integers(2, 5))):
            x, y = scene.random.uniform(-1, 1, size=2)
            scene.sphere(f"ball_{i}", radius=0.05 + 0.01 * i, position=(x, y, 1.0))
        """,
    "a branch that is not known": """
        if scene.random.random() > 0.5:
            top = scene.box("top", size=(1, 1, 1))
        else:
            top = scene.sphere("top", radius=0.5)
        scene.joint_fixed("hold", None, top)
        scene.joint_fixed("other", None, "top2") if scene.stage.GetPrimAtPath("/World/top2") else None
        """,
    "USD beside the scene": """
        from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics
        box = scene.box("box", size=(1, 1, 1))
        prim = scene.stage.GetPrimAtPath(box.path)
        UsdPhysics.MassAPI(prim).CreateCenterOfMassAttr(Gf.Vec3f(0, 0, 0.1))
        for child in prim.GetChildren():
            child.GetAttribute("primvars:mine")
        rock = UsdGeom.Cube.Define(scene.stage, "/World/rock")
        rock.CreateSizeAttr(1.0)
        UsdPhysics.RigidBodyAPI.Apply(rock.GetPrim()).CreateVelocityAttr((1, 0, 0))
        UsdGeom.XformCommonAPI(rock).SetTranslate((0, 0, 3))
        prim.CreateAttribute("newton:mine", Sdf.ValueTypeNames.Float).Set(1.0)
        scene.joint_fixed("joint", None, "rock")
        rock.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
        Gf.Rotation(Gf.Vec3d.ZAxis(), 30.0).GetQuat()
        """,
    "degrees that are degrees": """
        import math
        import numpy as np
        half = math.pi / 2
        scene.box("a", size=(1, 1, 1), rotation_deg=(0, math.degrees(half), 90 * 2 / math.pi))
        b = scene.box("b", size=(1, 1, 1), rotation_deg=(np.rad2deg(half), 180 / math.pi * half, 3.0))
        angle_deg = 30.0
        x = math.cos(math.radians(angle_deg))
        scene.joint_revolute("j", None, b, limits_deg=(-x, 90.0))
        """,
    "what may not be there": """
        try:
            import tomllib_that_is_not
        except ImportError:
            tomllib_that_is_not = None
        if hasattr(scene, "terrain"):
            scene.terrain("hills")
        scene.ground()
        """,
    "classes": """
        from dataclasses import dataclass, field
        from enum import Enum
        class Wood(Enum):
            PINE = 500.0
            OAK = 720.0
        @dataclass
        class Leg:
            name: str
            x: float = 0.0
            parts: list = field(default_factory=list)
            def build(self, height):
                self.parts.append(scene.box(self.name, size=(0.1, 0.1, height), position=(self.x, 0, height / 2)))
                return self
        class Table:
            count = 0
            def __init__(self, width):
                self.width, self.legs = width, []
            @property
            def half(self):
                return self.width / 2
            def stand(self):
                for i, side in enumerate((-1, 1)):
                    self.legs.append(Leg(f"leg_{i}", x=side * self.half).build(0.7))
                    self.count += 1
                return self.legs[0].parts[0]
        first = Table(1.2).stand()
        scene.sphere("ball", radius=0.1, position=(3, 0, 1), density=Wood.OAK.value, velocity=(0, 0, 1))
        scene.joint_fixed("hold", None, first)
        """,
    "helpers, keywords and stars": """
        common = dict(static=True, friction=0.5)
        more = {"color": (0.1, 0.2, 0.3)}
        def wall(name, x, *, height=1.0, **rest):
            return scene.box(name, size=(0.1, 2.0, height), position=(x, 0, height / 2), **common, **rest)
        left, right = (wall(name, x, **more) for name, x in (("left", -1), ("right", 1)))
        low, *others = sorted([3, 1, 2])
        wall("third", 3, height=others[0])
        """,
}


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples(path: Path) -> None:
    assert validate(path.read_text()) == []


@pytest.mark.parametrize("path", SKILLS, ids=lambda path: path.parent.name)
def test_skills(path: Path) -> None:
    for block in re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL):
        if "def build(" in block:
            assert validate(block) == []


@pytest.mark.parametrize("prompt", PROMPTS)
def test_programs_that_a_plan_composes(prompt: str) -> None:
    made = plan(prompt)
    assert validate(compose(made), made) == []


@pytest.mark.parametrize("name", RIGHT)
def test_programs_of_which_not_all_can_be_known(name: str) -> None:
    text = "def build(scene):\n" + textwrap.indent(textwrap.dedent(RIGHT[name]).strip("\n"), "    ") + "\n"
    assert validate(text) == []


@pytest.mark.parametrize("path", sorted((ROOT / "src" / "wsim" / "scene").glob("*.py")), ids=lambda path: path.stem)
def test_our_own_code_uses_what_is_there(path: Path) -> None:
    """The scene's own modules call USD and NumPy in many ways, and all of them work."""
    found = [p for p in validate(path.read_text()) if p.code not in ("build", "import")]
    assert found == []


def _tank() -> Plan:
    return plan(PROMPTS[0])


def test_an_object_of_the_plan_with_no_prim() -> None:
    made = _tank()
    name = made.objects[-1].name
    text = compose(made).replace(f'"{name}"', '"other_thing"')
    said = [p.message for p in validate(text, made)]
    assert any(f'"{name}"' in message and "no prim" in message for message in said)
    assert any('"other_thing"' in message and "the plan has no object" in message for message in said)
    assert validate(text) == []


def test_names_that_cannot_be_read_are_not_missed() -> None:
    made = _tank()
    text = "import os\n\n\ndef build(scene):\n    scene.ground()\n    for name in os.listdir():\n"
    text += "        scene.sphere(name, radius=0.1)\n"
    assert [p for p in validate(text, made) if "no prim" in p.message] == []


@pytest.mark.parametrize(
    "text", ["", "\0", "(" * 5000, "x = " + "-" * 3000 + "1\n", "def build(scene):\n" + " x=1\n" * 3, "é" * 700_000]
)
def test_nothing_makes_it_fail(text: str) -> None:
    assert validate(text)


@pytest.mark.parametrize(
    "body",
    ["x = 10 ** 10 ** 10", "x = 'a' * 10 ** 12", "x = [0] * 10 ** 12", "while True: pass", "x = f'{1:999999999}'",
     "x = list(range(10 ** 12))", "for i in range(10 ** 9): scene.box(f'b{i}', size=(1, 1, 1))", "build(scene)",
     "import numpy as np; x = np.zeros((10 ** 6, 10 ** 6))", "x = '%999999999d' % 3", "x = 1 << 10 ** 10"],
)  # fmt: skip
def test_nothing_of_the_program_is_run_that_takes_long(body: str) -> None:
    validate(f"def build(scene):\n    scene.ground()\n    {body}\n")


def test_importing_it_is_light() -> None:
    heavy = "('numpy', 'pxr', 'griffe', 'scipy', 'pydantic')"
    code = f"import sys, wsim.program.validator; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
