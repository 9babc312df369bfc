import runpy
from itertools import pairwise
from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import World

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py"))


def build(name: str, folder: Path) -> World:
    scene = Scene()
    runpy.run_path(str(EXAMPLES / f"{name}.py"))["build"](scene)
    path = scene.save(folder / "stage.usda")
    assert check_stage(path, [folder]) == []
    return describe(path)


@pytest.mark.parametrize("name", NAMES)
def test_example_builds_a_sound_stage(name: str, tmp_path: Path) -> None:
    world = build(name, tmp_path)
    assert world.bodies or world.fluids
    assert world.cameras
    lines = [body.line for body in world.bodies] + [fluid.line for fluid in world.fluids]
    assert all(line is not None and line.startswith(f"{name}.py:") for line in lines)


@pytest.mark.parametrize("name", ["floating_blocks", "dam_break"])
def test_fluid_is_small_enough_for_a_laptop(name: str, tmp_path: Path) -> None:
    (fluid,) = build(name, tmp_path).fluids
    x, y, z = fluid.size
    assert x * y * z / fluid.spacing**3 < 7000
    assert fluid.container == "/World/tank"


def test_floating_bodies_start_dry_and_apart(tmp_path: Path) -> None:
    world = build("floating_blocks", tmp_path)
    (water,) = world.fluids
    surface = water.center[2] + water.size[2] / 2
    spans = []
    for body in world.bodies:
        (shape,) = body.shapes
        half = [size / 2 for size in shape.size] if shape.kind == "box" else [shape.size[0]] * 3
        assert 0.0 < body.position[2] - half[2] - surface < water.spacing
        spans.append((body.position[0] - half[0], body.position[0] + half[0]))
    spans.sort()
    gaps = [right[0] - left[1] for left, right in pairwise(spans)]
    assert min(gaps) > 2 * water.spacing
    assert {round(body.mass / body.volume) for body in world.bodies} == {600, 7850}


def test_every_example_is_tested() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(NAMES)
