"""Several patches of an iteration, tried side by side: the best goes on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.agents.flies import PROMPT, lasts
from tests.agents.kept import Kept, models
from tests.agents.scripted import Server, apart, text
from tests.loop.test_loop import GOOD_PLAN, SETTINGS
from wsim.agents.models import Models
from wsim.judge.repair.steps import steps
from wsim.judge.verdict import RepairTarget
from wsim.loop.generate import generate
from wsim.loop.options import Generated, Options
from wsim.loop.replay import replay
from wsim.loop.side_by_side import side_by_side
from wsim.runs.iteration import Iteration


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Generated, Server]]:
    """Three edits of the first draft: worse, better, right."""
    folder, server = tmp_path_factory.mktemp("three"), Server()
    server.script["coder"] = [text(lasts(0.1)), text(lasts(0.3)), text(lasts(0.4))]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", apart(folder / "cache"))
        server.script["planner"] = [text(GOOD_PLAN)]
        options = Options(settings=SETTINGS, models=alone(server), candidates=3)
        done = generate(PROMPT, folder / "runs", options)
    server.close()
    yield done, server


def alone(server: Server) -> Models:
    """A planner and a coder, and nobody to judge or look."""
    return replace(models(server), judge="builtin", reviewer="builtin")


def test_the_best_of_three_goes_on(three: tuple[Generated, Server]) -> None:
    kept = Kept(three[0].run.path)
    assert three[0].verdict is not None
    assert three[0].verdict.status == "accepted", three[0].verdict.summary
    assert kept.rows == [
        ("recording", "rejected", True),
        ("physics", "rejected", False),
        ("physics", "rejected", False),
        ("all", "accepted", True),
    ]
    assert kept.facts["best"] == 4
    assert kept.facts["candidates"] == 3


def test_each_is_asked_for_other_edits(three: tuple[Generated, Server]) -> None:
    first, second, third = three[1].asked("coder")
    assert "is tried beside yours" not in first
    assert second.count("is tried beside yours; give other edits") == 1
    assert third.count("is tried beside yours; give other edits") == 2


def test_it_is_replayed(three: tuple[Generated, Server], tmp_path: Path) -> None:
    again = replay(three[0].run.path, tmp_path / "runs")
    assert again.divergences == again.differing == []


def test_no_more_are_tried_than_the_budget_leaves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server = Server()
    server.script |= {"planner": [text(GOOD_PLAN)], "coder": [text(lasts(0.1)), text(lasts(0.15))]}
    budget = replace(Options().budget, iterations=3)
    monkeypatch.setenv("XDG_CACHE_HOME", apart(tmp_path / "cache"))
    done = generate(
        PROMPT, tmp_path / "runs", Options(settings=SETTINGS, models=alone(server), candidates=5, budget=budget)
    )
    server.close()
    assert done.verdict is not None
    assert done.verdict.status == "blocked"
    assert len(done.run.iterations()) == 3


def test_a_coder_that_gives_up_leaves_what_it_gave_and_a_note(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server = Server()
    server.script |= {"planner": [text(GOOD_PLAN)], "coder": [text(lasts(0.4)), text("CANNOT: nothing else would do.")]}
    monkeypatch.setenv("XDG_CACHE_HOME", apart(tmp_path / "cache"))
    done = generate(PROMPT, tmp_path / "runs", Options(settings=SETTINGS, models=alone(server), candidates=3))
    server.close()
    assert done.verdict is not None
    assert done.verdict.status == "accepted", done.verdict.summary
    (note,) = done.run.facts()["notes"]
    assert note.startswith("1 patches were tried side by side and not 3")
    assert "nothing else would do" in note


def test_what_is_not_done_in_time_is_blocked_and_the_others_go_on(tmp_path: Path) -> None:
    made = []
    for name, seconds in (("01", 0.05), ("02", 600.0)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "program.py").write_text(
            "def build(scene):\n"
            f"    scene.simulation(duration={seconds})\n"
            "    scene.ground()\n"
            "    scene.box('crate', size=(1, 1, 1), position=(0, 0, 0.5), density=500.0)\n"
        )
        made.append(Iteration(tmp_path / name, None, SETTINGS))
    quick, slow = side_by_side(made, 25.0)
    assert quick.verdict.status == "accepted", quick.verdict.summary
    assert slow.verdict.status == "blocked"
    assert "took more than 25 s" in slow.verdict.summary


def test_steps_go_the_way_of_the_suggestion() -> None:
    known = RepairTarget(kind="program", parameter="friction", direction="lower", current=0.5, suggested=0.3)
    assert [step.suggested for step in steps(known)] == pytest.approx([0.4, 0.2, 0.1, 0.45])  # and none below 0
    way = RepairTarget(kind="program", parameter="density", direction="raise", current=100.0)
    assert [step.suggested for step in steps(way)] == pytest.approx([125.0, 160.0, 200.0, 110.0, 300.0])
    for none in (
        RepairTarget(kind="program", parameter="density", direction="raise"),
        RepairTarget(kind="program", parameter="position", vector=(0.0, 0.0, 1.0), current=1.0),
        RepairTarget(kind="program", direction="raise", current=1.0),
    ):
        assert steps(none) == []
