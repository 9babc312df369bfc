"""What is written is read back whole."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from wsim.agents.exchange import Asked, digest
from wsim.agents.transcript import NAME, Transcript, read
from wsim.errors import UserError

TOOLS = [{"name": "search_api", "description": "Search.", "parameters": {"type": "object"}}]


def user(content: Any) -> dict[str, Any]:
    return {"role": "user", "content": content}


def lines(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / NAME).read_text(encoding="utf-8").split("\n")[:-1]]


def test_a_conversation_is_written_once_and_read_whole(tmp_path: Path) -> None:
    transcript = Transcript(tmp_path)
    first = [{"role": "system", "text": "long " * 1000}, user("repair")]
    second = [*first, {"role": "model", "text": "no"}, user("why?")]
    other = [{"role": "system", "text": "judge"}, user("look")]
    again = [first[0], user("repair this")]
    asked = [("coder", first), ("coder", second), ("judge", other), ("coder", again), ("judge", other), ("coder", [])]
    for role, messages in asked:
        transcript.add(role, f"{role}@x", Asked(messages, [], {}), reply={"text": "yes"})
    assert [(exchange.role, exchange.messages) for exchange in read(tmp_path)] == asked
    assert [exchange.number for exchange in read(tmp_path)] == [1, 2, 3, 4, 5, 6]
    assert [line["shared"] for line in lines(tmp_path)] == [0, 2, 0, 1, 2, 0]
    assert (tmp_path / NAME).stat().st_size < 2 * 5000


def test_all_of_an_exchange_comes_back(tmp_path: Path) -> None:
    transcript = Transcript(tmp_path)
    reply = {
        "text": "",
        "calls": [{"name": "search_api", "arguments": '{"words": "x"}', "id": "1"}],
        "finish": "length",
    }
    usage = {"input_tokens": 7, "output_tokens": 3}
    transcript.add("coder", "m", Asked([user("a")], TOOLS, {}), reply=reply, usage=usage, seconds=1.234)
    transcript.add(
        "coder", "m", Asked([user("b")], TOOLS, {}), error={"kind": "timeout", "message": "late"}, seconds=9.0
    )
    transcript.add("coder", "m", Asked([user("b")], [], {}), reply={"text": "ok"}, cached=True)
    one, two, three = read(tmp_path)
    assert (one.model, one.reply, one.error, one.usage, one.seconds, one.cached) == (
        "m",
        reply,
        None,
        usage,
        1.23,
        False,
    )
    assert (two.reply, two.error, two.seconds) == (None, {"kind": "timeout", "message": "late"}, 9.0)
    assert (three.reply, three.usage, three.cached) == ({"text": "ok"}, {}, True)


def test_tools_are_written_once_and_named_by_their_digest(tmp_path: Path) -> None:
    transcript = Transcript(tmp_path)
    for tools in (TOOLS, TOOLS, [], [*TOOLS, {**TOOLS[0], "name": "show_api"}]):
        transcript.add("coder", "m", Asked([user("a")], tools, {}), reply={"text": ""})
    one, two, three, four = read(tmp_path)
    assert one.tools == two.tools == digest(json.dumps(TOOLS, sort_keys=True).encode())
    assert three.tools == ""
    assert four.tools not in ("", one.tools)
    assert [line.get("tool_definitions") is not None for line in lines(tmp_path)] == [True, False, False, True]


def test_pictures_lie_beside_it_under_their_digest(tmp_path: Path) -> None:
    transcript = Transcript(tmp_path)
    picture = b"a picture"
    name = digest(picture)
    content = ["Look.", {"picture": name, "type": "image/jpeg"}]
    for _ in range(2):
        transcript.add("reviewer", "m", Asked([user(content)], [], {name: picture}), reply={"text": ""})
    assert [path.name for path in (tmp_path / "pictures").iterdir()] == [f"{name}.jpg"]
    assert (tmp_path / "pictures" / f"{name}.jpg").read_bytes() == picture
    assert read(tmp_path)[1].messages == [user(content)]


def test_what_the_builtin_roles_made_is_there_and_is_no_exchange(tmp_path: Path) -> None:
    transcript = Transcript(tmp_path)
    transcript.builtin("planner", "A ball falls.", {"title": "A ball"})
    transcript.add("coder", "m", Asked([user("a")], [], {}), reply={"text": ""})
    assert lines(tmp_path)[0] == {
        "role": "planner", "model": "builtin", "request": "A ball falls.", "reply": {"title": "A ball"},
    }  # fmt: skip
    assert [(exchange.number, exchange.role) for exchange in read(tmp_path)] == [(1, "coder")]


@pytest.mark.parametrize(
    "mark", ["\u2028", "\u2029", "\x85", "\x0b", "\x0c", "\x1c", "\r", "\r\n", "\\n", "\x00", "é", "🙂"]
)
def test_any_text_comes_back(tmp_path: Path, mark: str) -> None:
    words = f"one{mark}two\nthree"
    Transcript(tmp_path).add("coder", "m", Asked([user(words)], [], {}), reply={"text": words})
    (exchange,) = read(tmp_path)
    assert (exchange.messages, exchange.reply) == ([user(words)], {"text": words})


@pytest.mark.parametrize("cut", [1, 2, 3, 20, 100])
def test_half_a_last_line_is_left_out(tmp_path: Path, cut: int) -> None:
    transcript = Transcript(tmp_path)
    for words in ("one", "two 🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂🙂"):
        transcript.add("coder", "m", Asked([user(words)], [], {}), reply={"text": words})
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-cut])
    assert [exchange.reply for exchange in read(tmp_path)] == [{"text": "one"}]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{\n", "transcript.jsonl:1: not JSON"),
        ("[" * 100_000 + "\n", "transcript.jsonl:1: not JSON"),
        ("[1]\n", "transcript.jsonl:1: a line holds one exchange"),
        ('{"role": "coder", "model": "m"}\n', "transcript.jsonl:1: not an exchange: 'shared' is missing"),
        ('{"role": "coder", "model": "m", "shared": "x", "messages": []}\n', "transcript.jsonl:1: not an exchange"),
        ('{"model": "builtin"}\n{"role": "coder"}\n', "transcript.jsonl:2: not an exchange"),
        ("\xff\n", "transcript.jsonl:1: not JSON"),
    ],
)
def test_what_is_no_transcript_is_said_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / NAME).write_bytes(text.encode("latin-1"))
    with pytest.raises(UserError) as caught:
        read(tmp_path)
    assert message in str(caught.value)


def test_a_folder_without_one_is_said(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"has no transcript\.jsonl; give the folder of a run that wsim generate made"):
        read(tmp_path)
