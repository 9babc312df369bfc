"""Stages of one skeleton differ in numbers alone that descriptions state."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.skeleton import is_free, skeleton


def saved(path: Path, edge: float, turn: float = 10.0) -> Path:
    """A box on the ground, askew."""
    scene = Scene()
    scene.ground()
    scene.box("box", size=(edge, edge, edge), position=(0, 0, edge), rotation_deg=(0, 0, turn), velocity=(edge, 0, 0))
    return scene.save(path)


def test_known_numbers_are_left_out(tmp_path: Path) -> None:
    stages = [saved(tmp_path / f"{k}.usda", edge) for k, edge in enumerate((0.1, 0.3, 2.0))]
    assert len({skeleton(stage) for stage in stages}) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("float inputs:ior = 1.5", "float inputs:ior = 1.4"),
        ("double3 xformOp:translate = ", "double3 xformOp:translate.timeSamples = "),
        ("double size = 1", "double size = 1; double other = 1"),
        ('def Cube "', 'def Sphere "'),
    ],
)
def test_all_else_is_kept(tmp_path: Path, old: str, new: str) -> None:
    first, second = (saved(tmp_path / f"{k}.usda", 0.1) for k in range(2))
    text = second.read_text()
    assert old in text
    second.write_text(text.replace(old, new, 1))
    assert skeleton(first) != skeleton(second)


def test_what_may_hang_on_other_files_has_none(tmp_path: Path) -> None:
    stage = saved(tmp_path / "stage.usda", 0.1)
    stage.write_text(stage.read_text() + "# @other.usda@\n")
    assert skeleton(stage) == ""
    assert skeleton(Path(__file__)) == ""


def test_attributes_are_free_by_their_whole_name() -> None:
    free = ("xformOp:translate", "wsim:value", "size", "physics:mass", "drive:angular:physics:stiffness")
    assert all(map(is_free, free))
    assert not any(
        map(is_free, ("inputs:ior", "points", "physics:massless", "resize", "drive:angular:physics:maxForce"))
    )
