"""The user's own assets: the planners, programs in the sandbox and searches know them at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.intake import models
from wsim.assets import asset_folders, get, load_catalogue, user_folder
from wsim.assets.folders import VARIABLE
from wsim.intake import Wanted, add, remove
from wsim.program import sandbox
from wsim.rules.lexicon import lexicon
from wsim.rules.planner import plan
from wsim.scene.describe import describe

PROGRAM = """\
def build(scene):
    scene.ground()
    scene.asset("one", "blue_keepsake", position=(0.0, 0.0, 0.1))
"""


@pytest.fixture
def keepsake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    path = models.write(models.box(), tmp_path / "keepsake.stl")
    assert "keepsake" not in lexicon().vocabulary
    add(path, Wanted("blue keepsake", synonyms=["keepsake"], density=500.0, picture=False))
    return path


def test_folder_is_where_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert user_folder() == tmp_path / "wsim" / "assets"
    assert len(asset_folders()) == 1
    user_folder().mkdir(parents=True)
    assert asset_folders()[1] == user_folder()


def test_the_catalogue_is_read_again_only_when_it_changed(keepsake: Path) -> None:
    assert load_catalogue() is load_catalogue()
    known = load_catalogue()
    remove("blue_keepsake")
    assert "blue_keepsake" in known and "blue_keepsake" not in load_catalogue()


def test_the_builtin_planner_knows_its_names(keepsake: Path) -> None:
    (thing,) = [item for item in plan("A keepsake falls on the ground.").objects if "keepsake" in item.name]
    assert thing.construction.asset == "blue_keepsake"
    assert lexicon().nouns["blue_keepsake"].size == pytest.approx(models.BOX, abs=1e-4)
    remove("blue_keepsake")
    assert "keepsake" not in lexicon().vocabulary


def test_a_program_in_the_sandbox_places_it(keepsake: Path, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    built = sandbox.build(tmp_path / "program.py", tmp_path / "stage.usda", readable=asset_folders())
    assert built.ok, built.message
    (body,) = describe(tmp_path / "stage.usda").bodies
    assert body.mass == pytest.approx(get("blue_keepsake").mass)
