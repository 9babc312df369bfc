"""What is sent again of a conversation: no answer twice, every reason, all that tools said."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.agents.scripted import Server, call, text
from tests.agents.test_relay import word
from wsim.agents.ask import RETRIES, Desk
from wsim.agents.failures import ModelError
from wsim.agents.history import EARLIER
from wsim.runs.folder import RunFolder
from wsim.tools import TOOLS, Workspace

TOLD = EARLIER.strip()


def _sent(server: Server) -> list[str]:
    """The bodies of all requests, as text."""
    return [json.dumps(body["messages"]) for body in server.requests]


def test_of_refused_answers_the_last_alone_is_sent_again(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("first answer"), text("second answer"), text("third answer"), text("done")]
    assert desk.ask("coder", "Say a word.", word) == "done"
    sent = _sent(server)
    assert "first answer" in sent[1] and TOLD not in sent[1]
    assert "second answer" in sent[2] and '"first answer"' not in sent[2]
    assert "third answer" in sent[3] and '"second answer"' not in sent[3]
    for start in ("first", "second", "third"):  # what was wrong is said of each
        assert f"one word, not '{start}" in sent[3]
    assert sent[3].count(TOLD) == 2
    assert len(sent[3]) - len(sent[2]) < 150  # a line more, not an answer


def test_the_same_mistake_makes_another_request(server: Server, desk: Desk) -> None:
    """What is asked again as it was asked before gets the answer that was kept."""
    server.script["coder"] = [text("a b")] * (RETRIES + 1)
    with pytest.raises(ModelError, match="5 answers could not be used"):
        desk.ask("coder", "Say a word.", word)
    sent = _sent(server)
    assert len(set(sent)) == len(sent) == RETRIES + 1
    assert sent[-1].count("one word, not 'a b'") == RETRIES


@pytest.mark.parametrize("before", [0, 1])
def test_what_tools_said_stays(server: Server, desk: Desk, tmp_path: Path, before: int) -> None:
    refused = [text("first answer"), text("second answer")]
    script = [*refused[:before], call("search_skills", {"query": "pendulum"}), *refused[before:], text("done")]
    server.script["coder"] = script
    tools = [TOOLS["search_skills"]]
    assert (
        desk.ask("coder", "Say a word.", word, tools=tools, workspace=Workspace(RunFolder(tmp_path / "run"))) == "done"
    )
    last = server.requests[-1]["messages"]
    assert [message for message in last if message["role"] == "tool"]
    assert len([message for message in last if message.get("tool_calls")]) == 1
