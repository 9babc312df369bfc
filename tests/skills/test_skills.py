"""Every skill: its front matter is in order, and each program in it builds a sound stage."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import World

SKILLS = Path(__file__).parents[2] / "skills"
FILES = sorted(SKILLS.glob("*/SKILL.md"))
PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def front_matter(path: Path) -> dict[str, str]:
    """The `key: value` lines between the first two lines of dashes."""
    first, *lines = path.read_text(encoding="utf-8").splitlines()
    assert first == "---"
    pairs = [line.partition(": ") for line in lines[: lines.index("---")]]
    assert all(colon and value.strip() for _, colon, value in pairs)
    return {key: value for key, _, value in pairs}


def programs() -> list[tuple[str, str]]:
    """(name, source) of each block of Python in a skill."""
    found = []
    for path in FILES:
        for k, source in enumerate(PROGRAM.findall(path.read_text(encoding="utf-8"))):
            found.append((f"{path.parent.name}-{k}", source))
    return found


def world_of(name: str, source: str, folder: Path) -> World:
    namespace: dict = {"__name__": "program"}
    exec(compile(source, f"{name}.py", "exec"), namespace)
    scene = Scene()
    namespace["build"](scene)
    stage = scene.save(folder / "stage.usda")
    assert check_stage(stage, [folder]) == []
    return describe(stage)


def test_every_folder_is_a_skill_with_a_program() -> None:
    assert FILES
    assert [path.parent for path in FILES] == sorted(path for path in SKILLS.iterdir() if path.is_dir())
    assert {name.rpartition("-")[0] for name, _ in programs()} == {path.parent.name for path in FILES}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_front_matter(path: Path) -> None:
    """As the Agent Skills format asks: a name that is the folder's, and a description that says when to use it."""
    fields = front_matter(path)
    assert fields["name"] == path.parent.name
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", fields["name"]) and len(fields["name"]) <= 64
    assert len(fields["description"]) <= 1024
    assert "Use it when" in fields["description"]
    assert not re.search(r": |\s#|^[\"'>|&*!%@`\[{]", fields["description"]), "not a plain YAML scalar"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_skill_is_short(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) < 150


@pytest.mark.parametrize(("name", "source"), programs(), ids=[name for name, _ in programs()])
def test_program_builds_a_sound_stage(name: str, source: str, tmp_path: Path) -> None:
    world = world_of(name, source, tmp_path)
    assert world.bodies and world.cameras
    assert all(body.line is not None for body in world.bodies)


def test_program_of_floating_bodies_keeps_the_skills_own_rules(tmp_path: Path) -> None:
    ((name, source),) = [each for each in programs() if each[0].startswith("floating-bodies")]
    world = world_of(name, source, tmp_path)
    (water,) = world.fluids
    (tank,) = world.containers
    surface = water.center[2] + water.size[2] / 2
    tallest = rise = 0.0
    spans = [(-tank.inner_size[0] / 2, -tank.inner_size[0] / 2), (tank.inner_size[0] / 2, tank.inner_size[0] / 2)]
    for body in world.bodies:
        (shape,) = body.shapes
        extents = shape.size if shape.kind == "box" else [2 * shape.size[0]] * 3
        tallest = max(tallest, extents[2])
        rise += min(body.mass / water.density, body.volume) / (tank.inner_size[0] * tank.inner_size[1])
        assert water.spacing <= min(extents) / 5 + 1e-9, body.prim
        gap = body.position[2] - extents[2] / 2 - surface
        assert gap == pytest.approx(0.005 if body.mass / body.volume < water.density else 0.15, abs=1e-6), body.prim
        spans.append((body.position[0] - extents[0] / 2, body.position[0] + extents[0] / 2))
    spans.sort()
    assert min(right[0] - left[1] for left, right in pairwise(spans)) >= 3.2 * water.spacing
    cells = [edge / water.spacing for edge in water.size]
    assert cells == pytest.approx([round(cell) for cell in cells], abs=1e-5)
    assert water.size[2] >= max(2 * tallest, 10 * water.spacing)
    assert tank.inner_size[2] >= water.size[2] + rise + 4 * water.spacing
    assert world.duration >= 3.5 * (tallest / 0.14) ** 0.5
