"""Many builds in one process are the builds one by one."""

from __future__ import annotations

import json
import os
import resource
from pathlib import Path
from typing import Any

import pytest

from wsim.program.inside.builds_task import parts
from wsim.program.sandbox import BuildResult, Limits, available, build, build_many, many
from wsim.program.sandbox.builder import look
from wsim.scene.reading import Reading, read

ISOLATION = [name for name in ("bubblewrap", "landlock") if name in available()] or ["none"]
BOX = """
made = []

def build(scene):
    made.append(1)
    edge = scene.param("edge", 0.2, low=0.1, high=2.0) * len(made)
    scene.box("box", size=(edge, edge, edge), position=(0.0, 0.0, edge))
"""
WEAK = (
    BOX
    + """
    if edge == 0.5:
        raise ValueError("not this one")
    if edge == 0.7:
        import os
        os._exit(0)
    if edge == 0.9:
        while True:
            pass
"""
)


@pytest.mark.parametrize("isolation", ISOLATION)
def test_each_stage_is_what_it_is_alone(tmp_path: Path, isolation: str) -> None:
    program = tmp_path / "program.py"
    program.write_text(BOX)
    stages = [tmp_path / f"{k}.usda" for k in range(4)]
    params = [{}, {"edge": 0.3}, {"edge": -1.0}, {"edge": 1.5}]
    built = list(build_many(program, stages, params, isolation=isolation))
    assert [result.ok for result in built] == [True, True, False, True]
    assert "size" in built[2].message
    assert built[2].line == "program.py:7"
    assert not stages[2].exists()
    for stage, values in zip(stages, params, strict=True):
        alone = tmp_path / "alone.usda"
        if build(program, alone, values, isolation=isolation).ok:
            assert stage.read_text() == alone.read_text()


@pytest.mark.parametrize("isolation", ISOLATION)
def test_what_is_told_of_each_is_what_its_stage_says(tmp_path: Path, isolation: str) -> None:
    program = tmp_path / "program.py"
    program.write_text(BOX)
    stages = [tmp_path / f"{k}.usda" for k in range(4)]
    params = [{}, {"edge": 0.3}, {"edge": -1.0}, {"edge": 1.5}]
    built = list(build_many(program, stages, params, isolation=isolation, tell=True))
    assert [bool(result.told) for result in built] == [True, True, False, True]
    for stage, result in zip(stages, built, strict=True):
        if result.ok:
            assert repr(Reading.model_validate_json(result.told)) == repr(read(stage))
        assert json.dumps(result.facts())
    assert not any(result.told for result in build_many(program, stages, params, isolation=isolation))


def test_a_number_that_is_unsound_is_seen_beside_sound_ones(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        BOX + "    scene.stage.GetPrimAtPath('/World/box').GetAttribute('physics:mass').Set(edge - 0.4)\n"
    )
    stages = [tmp_path / f"{k}.usda" for k in range(4)]
    edges = [0.5, 0.6, 0.3, 0.7]
    built = list(build_many(program, stages, [{"edge": edge} for edge in edges], tell=True))
    assert [result.kind for result in built] == ["ok", "ok", "stage", "ok"]


def test_one_that_ends_or_holds_up_its_process_costs_the_others_nothing(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(WEAK)
    edges = [0.2, 0.5, 0.7, 0.3, 0.9, 0.4]
    stages = [tmp_path / f"{k}.usda" for k in range(len(edges))]
    limits = Limits(wall_seconds=5.0)
    built = list(build_many(program, stages, [{"edge": edge} for edge in edges], limits))
    assert [result.kind for result in built] == ["ok", "exception", "crash", "ok", "timeout", "ok"]
    assert [stage.exists() for stage in stages] == [result.ok for result in built]
    assert "ended its process" in built[2].message


def test_more_than_a_process_takes(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(BOX)
    count = 70
    stages = [tmp_path / f"{k}.usda" for k in range(count)]
    built = list(build_many(program, stages, [{"edge": 0.1 + 0.01 * k} for k in range(count)]))
    assert all(result.ok for result in built)
    assert len({stage.read_text() for stage in stages}) == count


@pytest.fixture
def many_open_files():
    """As a sweep of hundreds of candidates has: what is opened next has a number above 1,023."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 4096:
        pytest.skip(f"at most {hard} open files here")
    resource.setrlimit(resource.RLIMIT_NOFILE, (4096, hard))
    opened = [os.open(os.devnull, os.O_RDONLY) for _ in range(1030)]
    yield
    for descriptor in opened:
        os.close(descriptor)
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.mark.usefixtures("many_open_files")
def test_builds_beside_a_thousand_open_files(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(BOX)
    built = list(build_many(program, [tmp_path / f"{k}.usda" for k in range(2)], [{}, {}], isolation=ISOLATION[0]))
    assert [result.message for result in built if not result.ok] == []


def test_what_a_process_did_not_come_to_is_made_in_another_and_not_one_by_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "program.py"
    program.write_text(WEAK)
    alone: list[Path] = []
    one = many.build

    def counted(program: Path, stage: Path, *given: Any, **named: Any) -> BuildResult:
        alone.append(stage)
        return one(program, stage, *given, **named)

    monkeypatch.setattr(many, "build", counted)
    edges = [0.2, 0.7, *(0.2 + 0.001 * k for k in range(20))]
    stages = [tmp_path / f"{k}.usda" for k in range(len(edges))]
    built = list(build_many(program, stages, [{"edge": edge} for edge in edges]))
    assert [result.ok for result in built] == [True, False, *[True] * 20]
    assert alone == [stages[1]]


def test_stages_that_a_program_writes_itself_are_cut_where_they_end(tmp_path: Path) -> None:
    target = os.open(tmp_path / "stages", os.O_RDWR | os.O_CREAT)
    limits = Limits()
    for text, want in (
        (b"", []),
        (b"rubbish" * 9, []),
        (b"%016d#usda 1.0\n" % 10 + b"%016d" % 0, [True, False]),
        (b"%016dnonsense" % 8 + b"%016d#usda 1.0" % 9 + b"%016d#usda 1.0" % 11, [False, True]),
        (b"%016d" % -1, []),
    ):
        os.ftruncate(target, 0)
        os.pwrite(target, text, 0)
        assert [look(target, *place, limits)[0] == "ok" for place in parts(target, 6)] == want
    os.close(target)
