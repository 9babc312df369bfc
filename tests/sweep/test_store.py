"""A sweep's copy in memory, in a folder and in an object store, and a sweep that goes on from it elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fsspec
import pytest
from fsspec.implementations.memory import MemoryFileSystem

from wsim.errors import UserError
from wsim.sweep import Axis, Spec, SweepFolder, sweep
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.store import Store

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.1)
    scene.ground()
    scene.sphere("ball", radius=scene.param("radius", 0.1, low=0.05, high=0.2), position=(0, 0, 1), density=500.0)
"""


class Bucket(MemoryFileSystem):
    """As an object store is: whole objects under keys, no folders, nothing appended to, nothing renamed."""

    protocol = "bucket"
    store: dict[str, Any] = {}  # noqa: RUF012 - as its parent has it
    pseudo_dirs = [""]  # noqa: RUF012
    refuses = False

    def pipe_file(self, path: str, value: bytes, mode: str = "overwrite", **more: Any) -> None:
        if Bucket.refuses:
            raise ConnectionError("503 Slow Down")
        super().pipe_file(path, value, mode, **more)

    def _open(self, path: str, mode: str = "rb", **more: Any) -> Any:
        if mode not in ("rb", "wb", "xb"):
            raise NotImplementedError(f"an object cannot be opened with {mode}")
        return super()._open(path, mode, **more)

    def mv(self, *arguments: Any, **more: Any) -> None:
        raise NotImplementedError("an object has no other name")

    def makedirs(self, *arguments: Any, **more: Any) -> None:
        raise NotImplementedError("there are no folders")

    mkdir = makedirs


fsspec.register_implementation("bucket", Bucket, clobber=True)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[SweepFolder]:
    (tmp_path / "program.py").write_text(PROGRAM)
    spec = Spec(axes=[Axis.parse("radius=0.06:0.19")], samples=4)
    yield SweepFolder.create(tmp_path / "runs", "balls", spec, [tmp_path / "program.py"])
    Bucket.store.clear()
    Bucket.refuses = False
    MemoryFileSystem.store.clear()


def _outcome(number: int) -> Outcome:
    return Outcome(candidate=Candidate(number=number), status="accepted")


@pytest.fixture(params=["memory://sweeps/balls", "bucket://sweeps/balls", "{}/far/away/balls"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    return str(request.param).format(tmp_path)


def test_a_sweep_goes_on_elsewhere(folder: SweepFolder, url: str, tmp_path: Path) -> None:
    store = Store(url, every=0.0)
    store.rest(folder)
    for number in range(3):  # the machine is lost after these
        folder.add(_outcome(number))
        store.part(folder)
    there = Store(url)
    again = there.fetch(tmp_path / "another machine")
    assert again.path.name == "balls"
    assert again.spec == folder.spec
    assert again.outcomes() == folder.outcomes()
    found = sweep(again, workers=1, store=there)
    there.rest(again)
    assert sorted(outcome.candidate.number for outcome in found) == list(range(5))
    last = Store(url).fetch(tmp_path / "third")
    assert last.outcomes() == again.outcomes()
    for name in ("table.parquet", "summary.json", "program.py"):
        assert (last.path / name).read_bytes() == (again.path / name).read_bytes()


def test_what_is_cut_off_while_it_is_fetched_is_no_folder_to_go_on_with(folder: SweepFolder, tmp_path: Path) -> None:
    store, there = Store("bucket://sweeps/balls"), tmp_path / "there"
    store.rest(folder)
    MemoryFileSystem.pipe_file(Bucket(), "/sweeps/balls/" + "x" * 300, b"no file may be called so")
    with pytest.raises(UserError, match=r"bucket://sweeps/balls cannot be fetched: .*File name too long"):
        Store("bucket://sweeps/balls").fetch(there)
    assert not (there / "balls").exists()
    Bucket().rm_file("/sweeps/balls/" + "x" * 300)
    assert Store("bucket://sweeps/balls").fetch(there).spec == folder.spec
    assert [each.name for each in there.iterdir()] == ["balls"]


def test_parts_are_sent_no_more_often_than_asked(folder: SweepFolder) -> None:
    store = Store("bucket://often", every=10.0)
    for second in range(25):
        folder.add(_outcome(second))
        store.part(folder, now=1000.0 + second)
    assert len(Bucket.store) == 3
    store.rest(folder)
    assert len([name for name in Bucket.store if "/outcomes/" in name]) == 4


def test_a_store_that_does_not_answer_stops_no_sweep_and_is_said_at_the_end(
    folder: SweepFolder, tmp_path: Path
) -> None:
    store, Bucket.refuses = Store("bucket://down", every=0.0), True
    folder.add(_outcome(0))
    store.part(folder)
    with pytest.raises(UserError, match=r"bucket://down does not take the sweep \(503 Slow Down\); it is whole in"):
        store.rest(folder)
    Bucket.refuses = False
    folder.add(_outcome(1))
    store.rest(folder)
    assert sorted(Store("bucket://down").fetch(tmp_path / "new").outcomes()) == [0, 1]


def test_a_line_that_was_cut_off_is_sent_when_it_is_whole(folder: SweepFolder, tmp_path: Path) -> None:
    store = Store("memory://cut", every=0.0)
    store.rest(folder)
    folder.add(_outcome(0))
    with (folder.path / "outcomes.jsonl").open("a") as file:
        file.write('{"candidate": {"num')
    store.part(folder)
    folder.add(_outcome(1))
    store.part(folder)
    assert sorted(Store("memory://cut").fetch(tmp_path / "new").outcomes()) == [0, 1]


def test_a_part_of_which_only_the_beginning_came_costs_its_last_line_alone(folder: SweepFolder, tmp_path: Path) -> None:
    store = Store("memory://half", every=0.0)
    store.rest(folder)
    for number in range(3):
        folder.add(_outcome(number))
        store.part(folder)
    files = fsspec.filesystem("memory")
    second = sorted(files.find("/half/outcomes"))[1]
    files.pipe_file(second, files.cat_file(second)[:30])
    assert sorted(Store("memory://half").fetch(tmp_path / "new").outcomes()) == [0, 2]


@pytest.mark.parametrize(
    ("url", "said"),
    [("nowhere://x", "nowhere://x cannot be reached: "), ("memory://nothing/there", "is no sweep's folder")],
)
def test_what_cannot_be_reached_is_said(url: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=said):
        Store(url).fetch(tmp_path)


def test_what_lies_outside_of_the_folder_is_refused(folder: SweepFolder, tmp_path: Path) -> None:
    Store("memory://bad").rest(folder)
    MemoryFileSystem.store["/bad/../../escaped.txt"] = MemoryFileSystem.store["/bad/program.py"]
    with pytest.raises(UserError, match="outside of the sweep's folder"):
        Store("memory://bad").fetch(tmp_path / "new")
    assert not list(tmp_path.rglob("escaped.txt"))
