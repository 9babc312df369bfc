"""Which chapters of its prompt the planner's model is sent, and that it can have the others."""

import json

import pytest

from tests.agents.scripted import Server, text
from wsim.agents.ask import Desk
from wsim.agents.chapters import CHAPTERS, chapter, chapters_for, planner_prompt
from wsim.agents.planner import plan_with
from wsim.plan.schema import Plan


@pytest.mark.parametrize(
    ("prompt", "wanted"),
    [
        ("A ball rolls off a table onto the floor.", ()), ("A seesaw tilts when a crate drops onto its end.", ()),
        ("A cardboard box is carried by a conveyor; a pendulum with a damper swings.", ()),
        ("A wooden armchair stands beside a handle.", ()), ("Three corks float in an aquarium.", ("fluids",)),
        ("Water pours from a dam.", ("fluids",)), ("A ship sinks.", ("fluids",)),
        ("A jeep drives over hills.", ("vehicles",)), ("Two cars brake.", ("vehicles",)),
        ("An HMMWV stops.", ("vehicles",)),
        ("A robot arm picks up a cube.", ("robots",)), ("A Go2 walks round a crate.", ("robots",)),
        ("A buggy crosses a floating block.", ("fluids", "vehicles")),
    ],
)  # fmt: skip
def test_a_prompt_calls_for_the_chapters_that_it_speaks_of(prompt: str, wanted: tuple[str, ...]) -> None:
    assert chapters_for(prompt) == wanted


def test_what_is_left_out_is_named_and_nothing_is_told_twice() -> None:
    bare, whole = planner_prompt(()), planner_prompt()
    assert len(bare) < 0.8 * len(whole)
    assert f"Left out here: {', '.join(CHAPTERS)}." in bare and "Left out here" not in whole
    for name in CHAPTERS:
        assert chapter(name) in whole and chapter(name) not in bare
    lines = [line for line in whole.splitlines() if line.strip() and not line.startswith("```")]
    assert len(set(lines)) == len(lines)


def test_a_model_that_asks_for_a_chapter_gets_it(server: Server, desk: Desk, slide: Plan) -> None:
    written = json.dumps(slide.model_dump(mode="json", exclude_none=True))
    server.script["planner"] = [text('{"tell": ["robots", "nonsense"]}'), text(f"```json\n{written}\n```")]
    plan = plan_with(desk, slide.prompt)
    assert plan.objects == slide.objects
    first, second = ("\n".join(str(message["content"]) for message in body["messages"]) for body in server.requests)
    assert chapter("robots") not in first and chapter("robots") in second
    assert chapter("vehicles") not in second
