"""The cache: whole or absent, by what is installed, and not needed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from wsim.program.api.entry import Entry, Parameter
from wsim.program.api.lookup import _folder, _forget, _read
from wsim.program.api.sources import all as sources
from wsim.program.api.sources import pxr_results
from wsim.program.api.store import Store

ENTRIES = [
    Entry(
        "a.hinge", "function", "wsim", ((Parameter("axis", "keyword", "str", "'Z'", "", "of it"),),), doc="Joins two."
    ),
    Entry("a.Thing", "class", "wsim", bases=("a.Base",), summary="A thing.", extra={"partial": True}),
    Entry("a.b.water", "function", "pxr", doc="Fills a tank.", programs=False),
    Entry("a.hinge", "function", "numpy", doc="Of the same name, and later."),
]


@pytest.fixture
def store() -> Store:
    return Store.of(ENTRIES)


def test_what_is_saved_is_what_is_opened(store: Store, tmp_path: Path) -> None:
    file = tmp_path / "deep" / "index.sqlite"
    assert store.save(file)
    opened = Store.open(file)
    assert opened is not None
    for name in ("a.hinge", "a.Thing", "a.b.water"):
        assert opened.find(name) == store.find(name) == next(e for e in ENTRIES if e.name == name)
    assert opened.find("a.none") is None
    assert opened.children("a") == {"hinge", "Thing"}
    assert opened.ranking.having("join") == store.ranking.having("join") != {}
    assert [path.name for path in file.parent.iterdir()] == ["index.sqlite"], "a side file was left"


def test_a_broken_file_counts_as_none(tmp_path: Path) -> None:
    file = tmp_path / "index.sqlite"
    assert Store.open(file) is None
    file.write_bytes(b"SQLite format 3\0" + b"\0" * 5000)
    assert Store.open(file) is None


def test_a_folder_that_cannot_be_written_is_no_error(store: Store, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert not store.save(tmp_path / "file" / "index.sqlite")


def test_key_follows_the_versions(monkeypatch: pytest.MonkeyPatch) -> None:
    before = {part: sources.key(part) for part in sources.PACKAGES}
    assert before == {part: sources.key(part) for part in sources.PACKAGES}
    real = sources.metadata.version
    monkeypatch.setattr(sources.metadata, "version", lambda name: "0" if name == "newton" else real(name))
    assert sources.key("lower") != before["lower"]
    assert sources.key("programs") == before["programs"]


def test_key_follows_what_is_stemmed_and_how() -> None:
    home = Path(sources.__file__).parents[3]
    for part in sources.PACKAGES:
        assert {
            home / "search" / "words.py", home / "search" / "english.toml", home / "search" / "ranking.py",
            home / "program" / "api" / "vocabulary.toml", home / "program" / "api" / "store.py",
        } <= set(sources.files(part))  # fmt: skip


def test_files_of_older_installations_are_removed(tmp_path: Path) -> None:
    for i in range(7):
        (tmp_path / f"lower-{i}.sqlite").write_text("")
        os.utime(tmp_path / f"lower-{i}.sqlite", (i, i))
    (tmp_path / "programs-0.sqlite").write_text("")
    _forget("lower", tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {
        "programs-0.sqlite", *(f"lower-{i}.sqlite" for i in range(3, 7)),
    }  # fmt: skip


def test_cache_lies_where_the_environment_says(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _folder() == tmp_path / "wsim" / "api"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert _folder() == Path("~/.cache/wsim/api").expanduser()


def test_an_index_that_lacks_what_could_not_be_looked_at_is_not_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A process that ends too late is killed: who asks next finds no index without it, but makes one with it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(sources, "_SOURCES", {"programs": {"pxr": sources._pxr}})
    told: list[str] = []
    with monkeypatch.context() as hurried:
        hurried.setattr(pxr_results, "_SECONDS", 1e-3)
        hasty = _read("programs", told.append).find("pxr.UsdGeom.Cube.Define")
    assert hasty is not None
    assert hasty.returns == ""
    assert "TimeoutExpired" in told[-1]
    assert not (tmp_path / "wsim" / "api").exists()
    whole = _read("programs", told.append).find("pxr.UsdGeom.Cube.Define")
    assert whole is not None
    assert whole.returns == "pxr.UsdGeom.Cube"
    assert len(list((tmp_path / "wsim" / "api").iterdir())) == 1
