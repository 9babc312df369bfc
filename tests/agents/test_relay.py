"""The way to a model: what is tried again, what ends it, what it costs, and what is asked only once."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.agents.conftest import make_desk
from tests.agents.scripted import TOKENS, Entry, Server, call, cut, hang, raw, reply, status, text, wire
from wsim.agents.ask import RETRIES, Desk, UnusableError
from wsim.agents.budget import BudgetError
from wsim.agents.exchange import LONGEST
from wsim.agents.failures import ModelError
from wsim.agents.transcript import Exchange, read
from wsim.runs.folder import RunFolder
from wsim.tools import TOOLS, Workspace

NOT_JSON = raw(b"<html>503 Service Unavailable</html>", "text/html")
BROKEN_JSON = raw(b'{"id": "1", "choices": [{"mess')
NO_CHOICES = raw(json.dumps({**reply(""), "choices": []}).encode())
NO_MESSAGE = raw(json.dumps({**reply(""), "choices": [{"index": 0}]}).encode())
AGAIN: dict[str, tuple[Entry, str]] = {
    "too many requests": (status(429), "rate limit"),
    "an error of the server": (status(500), "server"),
    "overloaded": (status(529), "server"),
    "a time-out of the server": (status(408), "server"),
    "cut": (cut, "connection"),
    "not JSON": (NOT_JSON, "server"),
    "half of JSON": (BROKEN_JSON, "connection"),
    "no choices": (NO_CHOICES, "server"),
    "no message": (NO_MESSAGE, "server"),
    "a list": (raw(b"[1, 2]"), "server"),
    "nothing": (raw(b""), "connection"),
}


def word(answer: str) -> str:
    """Takes one word, and nothing else."""
    if " " in answer or not answer:
        raise UnusableError(f"one word, not {answer[:20]!r}")
    return answer


def written(desk: Desk) -> list[Exchange]:
    return read(desk.transcript.folder)


def failing(desk: Desk, accept: Callable[[str], str] = word, **more: object) -> ModelError:
    with pytest.raises(ModelError) as caught:
        desk.ask("coder", "Say a word.", accept, **more)  # type: ignore[arg-type]
    assert caught.value.role == "coder"
    assert "\n" not in str(caught.value)
    assert f"the coder's model: {caught.value.kind}: " in str(caught.value)
    return caught.value


def test_an_answer_is_asked_for_written_down_and_charged(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    (body,) = server.requests
    assert [message["role"] for message in body["messages"]] == ["system", "user"]
    assert body["messages"][1]["content"] == "Say a word."
    (exchange,) = written(desk)
    assert exchange.model == server.model("coder")
    assert exchange.messages[0]["text"] == body["messages"][0]["content"]
    assert exchange.messages[1] == {"role": "user", "content": "Say a word."}
    assert exchange.reply == {"text": "yes"}
    account = desk.ledger.facts()["by_role"]["coder"]
    assert (account["requests"], account["failed"], account["cached"]) == (1, 0, 0)
    assert (account["input_tokens"], account["output_tokens"]) == (1000, 100)
    assert desk.ledger.tokens == 1100


@pytest.mark.parametrize("what", AGAIN)
def test_what_may_pass_is_tried_again_as_often_as_the_budget_says(server: Server, desk: Desk, what: str) -> None:
    entry, kind = AGAIN[what]
    server.script["coder"] = [entry, entry, text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    assert [exchange.error and exchange.error["kind"] for exchange in written(desk)] == [kind, kind, None]
    assert desk.ledger.account("coder").failed == 2

    server.script["coder"] = [entry] * 3 + [text("late")]
    assert failing(desk, lambda text: text + "!" if text != "yes" else word("")).kind in (kind, "unusable")


@pytest.mark.parametrize("what", AGAIN)
def test_what_does_not_pass_is_a_model_error(server: Server, desk: Desk, what: str) -> None:
    entry, kind = AGAIN[what]
    server.script["coder"] = [entry] * 3 + [text("late")]
    assert failing(desk).kind == kind
    assert len(server.requests) == len(written(desk)) == 3
    assert all(exchange.reply is None and exchange.error["message"] for exchange in written(desk))


def test_silence_is_a_time_out(server: Server, tmp_path: Path) -> None:
    desk = make_desk(server, tmp_path / "run", request_seconds=0.1, attempts=2)
    server.forever["coder"] = hang
    error = failing(desk)
    assert error.kind == "timeout"
    assert "--model-timeout" in str(error)
    assert [exchange.error["kind"] for exchange in written(desk)] == ["timeout"] * 2
    assert len(server.requests) <= 2  # one that had not left when its time was up is not there
    assert desk.ledger.account("coder").seconds >= 0.2


def test_a_server_that_is_not_there_is_tried_again_then_given_up(server: Server, desk: Desk) -> None:
    server.close()
    assert failing(desk).kind == "connection"
    assert [exchange.error["kind"] for exchange in written(desk)] == ["connection"] * 3


@pytest.mark.parametrize("code", [400, 401, 403, 404, 422])
def test_a_refusal_is_not_tried_again(server: Server, desk: Desk, code: int) -> None:
    server.script["coder"] = [status(code, "that model is not yours"), text("late")]
    error = failing(desk)
    assert error.kind == "refused"
    assert "that model is not yours" in str(error)
    assert len(server.requests) == len(written(desk)) == 1


def test_the_pauses_grow_and_end_with_the_time(server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from wsim.agents import relay

    slept: list[float] = []

    async def sleep(seconds: float) -> None:
        slept.append(seconds)

    monkeypatch.setattr(relay, "LONGEST_PAUSE", 10.0)
    monkeypatch.setattr(relay.Relay.__init__, "__defaults__", (None, sleep))
    server.forever["coder"] = status(500)
    failing(make_desk(server, tmp_path / "run", attempts=6))
    assert slept == [2.0, 4.0, 8.0, 10.0, 10.0]
    slept.clear()
    failing(make_desk(server, tmp_path / "again", attempts=4, seconds=3.0))
    assert slept[0] == 2.0
    assert all(seconds <= 3.0 for seconds in slept)


# --- answers that cannot be used


def test_what_is_wrong_goes_back_until_an_answer_can_be_used(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("two words"), text("three words more"), text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    first, second, third = server.asked("coder")
    assert "one word, not" not in first
    assert "one word, not 'two words'" in second
    assert "one word, not 'three words more'" in third
    told = [exchange.messages[-1] for exchange in written(desk)]
    assert [message["content"] in wire for message, wire in zip(told, (first, second, third), strict=True)] == [
        True
    ] * 3
    assert "one word, not 'two words'" in told[1]["content"]


def test_answers_that_never_can_be_used_end_it(server: Server, desk: Desk) -> None:
    server.forever["coder"] = text("two words")
    error = failing(desk)
    assert error.kind == "unusable"
    assert f"{RETRIES + 1} answers could not be used; the last: one word, not 'two words'" in str(error)
    assert len(server.requests) == RETRIES + 1


RUBBISH: dict[str, Entry] = {
    "nothing": text(""),
    "null": raw(json.dumps(reply(None)).encode()),
    "cut before a word": text("", "length"),
    "cut": text("two wo", "length"),
    "half a character": raw(json.dumps(reply("@@ @@")).replace("@@", "\\ud83d").encode()),
    "a tool that is none": call("sing"),
    "a tool's arguments that are none": call("query_recording", '{"signal": '),
    "a tool's arguments that are a list": call("query_recording", "[1]"),
    "a tool's arguments that are a word": call("query_recording", '"speed"'),
    "a tool's arguments without end": call("query_recording", '{"signal":' * 20_000),
    "a tool's arguments that are null": call("query_recording", "null"),
    "thoughts alone": text("<think>yes</think>"),
}


@pytest.mark.parametrize("what", RUBBISH)
def test_rubbish_ends_it_and_can_be_read_back(server: Server, desk: Desk, tmp_path: Path, what: str) -> None:
    server.forever["coder"] = RUBBISH[what]
    workspace = Workspace(RunFolder(desk.transcript.folder))
    error = failing(desk, tools=[TOOLS["query_recording"]], workspace=workspace)
    assert error.kind in ("unusable", "server")
    assert 1 <= len(server.requests) < 20
    assert len(written(desk)) == len(server.requests)
    assert all(len(exchange.reply["text"]) <= LONGEST for exchange in written(desk) if exchange.reply)
    assert (desk.transcript.folder / "transcript.jsonl").stat().st_size < 20 * LONGEST


def test_ten_megabytes_are_cut(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("no " * 3_500_000), text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    first, second = written(desk)
    assert (len(first.reply["text"]), first.reply["finish"]) == (LONGEST, "length")
    assert len(wire(server.requests[1])) < 2 * LONGEST
    assert second.reply == {"text": "yes"}


def test_an_answer_that_was_withheld_is_a_refusal(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("", "content_filter"), text("yes")]
    assert failing(desk).kind == "refused"
    (exchange,) = written(desk)
    assert exchange.reply == {"text": "", "finish": "content_filter"}
    assert desk.ask("coder", "Say a word.", word) == "yes"  # it was not kept


def test_a_model_that_only_calls_tools_is_ended(server: Server, desk: Desk) -> None:
    server.forever["coder"] = call("search_api", {"words": "hinge"})
    error = failing(desk, tools=[TOOLS["search_api"]], workspace=Workspace(RunFolder(desk.transcript.folder)))
    assert error.kind == "unusable"
    assert len(server.requests) < 20


def test_what_a_tool_answers_goes_to_the_model_and_into_the_transcript(server: Server, desk: Desk) -> None:
    server.script["coder"] = [
        call("search_api", {"words": "hinge"}),
        call("search_api", {"wrds": "hinge"}),
        text("yes"),
    ]
    tools = [TOOLS["search_api"]]
    assert desk.ask("coder", "Hi.", word, tools=tools, workspace=Workspace(RunFolder(desk.transcript.folder))) == "yes"
    assert "joint_revolute" in wire(server.requests[1])
    last = written(desk)[-1].messages
    assert last[2]["call"] == "search_api"
    assert last[2]["arguments"] == {"words": "hinge"}
    assert last[3]["role"] == "tool"
    assert last[3]["text"] in wire(server.requests[1])
    assert "it takes words" in last[5]["text"]  # a mistake in the arguments is told


def test_what_a_model_thinks_is_no_part_of_what_follows(server: Server, desk: Desk) -> None:
    more = {"reasoning_content": "Let me think."}
    server.script["coder"] = [text("<think>hm</think>two words", **more), text("<think>so</think>yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    assert [exchange.reply for exchange in written(desk)] == [{"text": "two words"}, {"text": "yes"}]
    said = [message["text"] for message in written(desk)[1].messages if message["role"] == "model"]
    assert said == ["two words"]
    assert "hm" not in server.asked("coder")[1].split()


# --- limits


def test_tokens_that_are_used_up_end_it(server: Server, tmp_path: Path) -> None:
    desk = make_desk(server, tmp_path / "run", tokens=2000)
    server.forever["coder"] = text("two words")
    with pytest.raises(BudgetError, match="token limit: 2200 of 2000 tokens are used"):
        desk.ask("coder", "Say a word.", word)
    assert len(server.requests) == 2
    with pytest.raises(BudgetError):
        desk.ask("judge", "Say a word.", word)
    assert len(server.requests) == 2


def test_a_server_that_counts_no_tokens_is_counted(server: Server, tmp_path: Path) -> None:
    desk = make_desk(server, tmp_path / "run", tokens=1500)
    server.forever["coder"] = text("no " * 2000, usage=None)
    with pytest.raises(BudgetError, match="token limit"):
        desk.ask("coder", "Say a word.", word)
    assert 1500 <= desk.ledger.tokens < 8000


def test_time_that_is_over_ends_it(server: Server, tmp_path: Path) -> None:
    desk = make_desk(server, tmp_path / "run", seconds=0.3, request_seconds=3600.0)
    server.forever["coder"] = hang
    with pytest.raises(BudgetError, match=r"time limit: 0\.3 s are over"):
        desk.ask("coder", "Say a word.", word)
    assert len(server.requests) <= 1  # however long one request may take


# --- the cache


def test_what_was_asked_before_is_not_asked_again(server: Server, desk: Desk, tmp_path: Path) -> None:
    server.script["coder"] = [text("two words"), call("search_api", {"words": "hinge"}), text("yes")]
    tools = [TOOLS["search_api"]]

    def ask(to: Desk) -> str:
        return to.ask("coder", "Hi.", word, tools=tools, workspace=Workspace(RunFolder(to.transcript.folder)))

    assert ask(desk) == "yes"
    other = make_desk(server, tmp_path / "other")
    assert ask(other) == "yes"
    assert len(server.requests) == 3
    assert [exchange.cached for exchange in written(other)] == [True, True, True]
    assert [exchange.reply for exchange in written(other)] == [exchange.reply for exchange in written(desk)]
    account = other.ledger.account("coder")
    assert (account.requests, account.cached, other.ledger.tokens) == (0, 3, 0)

    assert failing(other, word).kind == "refused"  # another request: the script has none left
    assert other.models["judge"] != other.models["coder"]
    with pytest.raises(ModelError):
        other.ask("judge", "Hi.", word)  # another model


def test_answers_that_came_to_nothing_are_asked_for_again(server: Server, desk: Desk) -> None:
    server.script["coder"] = [text("two words")] * (RETRIES + 1)
    assert failing(desk).kind == "unusable"
    server.script["coder"] = [text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "yes"


def test_an_answer_that_was_cut_is_not_kept(server: Server, desk: Desk, tmp_path: Path) -> None:
    server.script["coder"] = [text("ye", "length"), text("yes")]
    assert desk.ask("coder", "Say a word.", word) == "ye"
    assert make_desk(server, tmp_path / "other").ask("coder", "Say a word.", word) == "yes"


def test_a_broken_cache_is_no_cache(server: Server, desk: Desk, tmp_path: Path) -> None:
    server.script["coder"] = [text("yes"), text("no")]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    (kept,) = (tmp_path / "cache" / "wsim" / "replies").iterdir()
    kept.write_text("{")
    assert desk.ask("coder", "Say a word.", word) == "no"
    assert json.loads(kept.read_text()) == {"text": "no"}


def test_what_a_provider_had_kept_of_a_request_is_written_down(server: Server, desk: Desk) -> None:
    usage = {**TOKENS, "prompt_tokens_details": {"cached_tokens": 900}}
    server.script["coder"] = [lambda handler, body: handler.send(200, reply("yes", usage=usage))]
    assert desk.ask("coder", "Say a word.", word) == "yes"
    account = desk.ledger.facts()["by_role"]["coder"]
    assert (account["input_tokens"], account["cache_read_tokens"]) == (1000, 900)
    assert written(desk)[-1].usage["cache_read_tokens"] == 900
