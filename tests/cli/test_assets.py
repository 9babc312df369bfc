"""`wsim assets`, as a person at a terminal meets it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.intake import models
from wsim.assets.folders import VARIABLE
from wsim.intake import Wanted, add


@pytest.fixture
def keepsake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with one asset."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    add(models.write(models.box(), tmp_path / "keepsake.stl"), Wanted("blue keepsake", density=500.0, picture=False))
    return tmp_path / "own" / "blue_keepsake"


def test_own_ones_are_listed_beside_the_shipped(told, keepsake: Path) -> None:
    ended = told("assets", "list", "--json")
    rows = {row["id"]: row["own"] for row in json.loads(ended.out)}
    assert (ended.code, rows["blue_keepsake"], rows["mug"]) == (0, True, False)
    listed = told("assets", "list", "--own")
    assert "blue_keepsake" in listed.out and "mug" not in listed.out


def test_one_is_shown_with_what_collides(told, keepsake: Path) -> None:
    ended = told("assets", "show", "blue_keepsake")
    assert ended.code == 0
    assert "collides as a box, 1 of its volume" in ended.out
    assert "taken: the file says no unit; m" in ended.out
    assert json.loads(told("assets", "show", "mug", "--json").out)["own"] is False


def test_one_is_found_by_its_name(told, keepsake: Path) -> None:
    assert told("assets", "search", "a", "blue", "keepsake").out.startswith("1.00  blue_keepsake")
    nothing = told("assets", "search", "xylophone")
    assert (nothing.code, "nothing in the catalogue" in nothing.out) == (1, True)


def test_own_ones_are_removed_and_shipped_ones_stay(told, keepsake: Path) -> None:
    assert told("assets", "remove", "mug").err == (
        "wsim: 'mug' is shipped with wsim and stays; `wsim assets list` marks your own\n"
    )
    assert told("assets", "remove", "blue_keepsake").code == 0
    assert not keepsake.exists()
    again = told("assets", "remove", "blue_keepsake")
    assert (again.code, again.err.count("\n")) == (2, 1)
    assert "no asset 'blue_keepsake'" in again.err


@pytest.mark.parametrize("id", ["..", ".", "", "../own"])
def test_nothing_else_is_removed(told, keepsake: Path, id: str) -> None:
    assert told("assets", "remove", id).code == 2
    assert keepsake.is_dir()


def test_one_that_cannot_be_read_takes_nothing_with_it(told, keepsake: Path) -> None:
    metadata = keepsake / "asset.json"
    metadata.write_text(metadata.read_text().replace('"mass": ', '"mass": -', 1))
    keepsake.parent.touch()
    assert "blue_keepsake/asset.json: mass = -12" in " ".join(told("assets", "list").out.split())
    assert told("assets", "show", "mug").code == 0
    assert "mass = -12" in told("assets", "show", "blue_keepsake").err


def test_adding_tells_what_was_taken(told, keepsake: Path, tmp_path: Path) -> None:
    ended = told("assets", "add", tmp_path / "keepsake.stl", "--name", "red keepsake", "--mass", 2, "--json")
    row = json.loads(ended.out)
    assert (ended.code, row["id"], row["mass"], row["own"]) == (0, "red_keepsake", 2.0, True)
    wrong = told("assets", "add", tmp_path / "keepsake.stl", "--name", "mug")
    assert (wrong.code, wrong.err.count("\n")) == (2, 1)


def test_a_robot_is_taken_in_and_listed(told, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    file = tmp_path / "flap.xml"
    body = '<body name="flap"><joint name="hinge"/><geom size="0.1"/></body>'
    file.write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    ended = told("assets", "robot", str(file), "--name", "Flap")
    assert ended.code == 0 and "flap: 1 links, 4.189 kg, 1 joints, 0 with a motor" in ended.out
    assert set(json.loads(told("assets", "robots", "--json").out)) == {"desk_arm", "flap"}
    again = told("assets", "robot", str(file), "--name", "Flap")
    assert (again.code, "--replace takes its place" in again.err + again.out) == (2, True)
