"""A recorded run made again with nobody to ask: the same to the byte, or where it is not."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from tests.agents.flies import PROMPT, answer, edit, flies, lasts
from tests.agents.scripted import Server, apart, call, cut, raw, status, text
from wsim.agents import relay
from wsim.agents.budget import Budget
from wsim.agents.models import Models
from wsim.cli import app
from wsim.errors import UserError
from wsim.loop.generate import generate
from wsim.loop.options import Options
from wsim.loop.replay import replay
from wsim.runs.settings import Settings

NO_WORLD = Settings(device="cpu", pictures=False, params={"mass": 1.0})  # no program has it: each fails in a second


@pytest.fixture(autouse=True)
def alone(own_cache: None) -> None:
    """No reply is kept; pauses are as long as they are."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A run that ended blocked, after every sort of error; its models are gone."""
    folder = tmp_path_factory.mktemp("recorded")
    server = Server()
    errors = [status(500), cut, text("Hm."), status(429), raw(b"<html>"), text(lasts(0.3)[:-20], "length")]
    reads = call("show_skill", {"name": "cameras-and-light"})
    server.script["coder"] = [*errors, reads, text(lasts(0.3))]
    options = Options(NO_WORLD, Models(coder=server.model("coder")), Budget(iterations=2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", apart(folder / "cache"))
        patch.setattr(relay, "LONGEST_PAUSE", 0.0)
        done = generate(PROMPT, folder / "runs", options, plan=flies())
    server.close()
    assert done.verdict is not None
    assert done.verdict.status == "blocked"
    assert len(server.requests) == 8
    yield done.run.path


@pytest.fixture
def copy(recorded: Path, tmp_path: Path) -> Path:
    """The recorded run, to be changed."""
    shutil.copytree(recorded, tmp_path / "recorded")
    return tmp_path / "recorded"


def test_a_run_with_errors_is_the_same_again_and_waits_for_nothing(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def sleep(seconds: float) -> None:
        raise AssertionError("a replay has nothing to wait for")

    monkeypatch.setattr(relay.Relay.__init__, "__defaults__", (None, sleep))
    again = replay(recorded, tmp_path / "runs")
    assert (again.divergences, again.differing) == ([], [])
    assert again.same == 2 + 2 * 2 + 1  # the plan and the transcript; programs and verdicts; one patch
    facts = [json.loads((run / "run.json").read_text()) for run in (recorded, again.generated.run.path)]
    assert facts[0]["usage"] == facts[1]["usage"]
    assert facts[0]["cause"] == facts[1]["cause"] == "iteration limit: 2 programs were tried"
    assert facts[0]["iterations"] == facts[1]["iterations"]


def test_a_replay_can_be_replayed(recorded: Path, tmp_path: Path) -> None:
    first = replay(recorded, tmp_path / "first").generated.run.path
    again = replay(first / "iterations", tmp_path / "second")  # anything inside the run will do
    assert (again.divergences, again.differing, again.same) == ([], [], 7)


def test_a_changed_program_is_named_with_its_line(copy: Path, tmp_path: Path) -> None:
    path = copy / "iterations" / "02" / "program.py"
    path.write_text(path.read_text().replace("duration=0.3", "duration=0.7"))
    again = replay(copy, tmp_path / "runs")
    assert again.divergences == []
    (line,) = again.differing
    assert line.startswith("iterations/02/program.py: line 34: ")
    assert "duration=0.3" in line.partition(", where it was ")[0]
    assert "duration=0.7" in line.partition(", where it was ")[2]


def test_a_changed_reply_is_followed_and_its_consequences_are_named(copy: Path, tmp_path: Path) -> None:
    path = copy / "transcript.jsonl"
    told = path.read_text().replace('"reply": {"text": "Hm."}', '"reply": {"text": "Oh."}')
    path.write_text(told.replace("duration=0.3\\n>>>>>>> REPLACE", "duration=0.35\\n>>>>>>> REPLACE"))
    again = replay(copy, tmp_path / "runs")
    assert again.divergences[0] == "exchange 4, coder: message 3: 'Oh.', where it was 'Hm.'"
    assert any(line.startswith("iterations/02/program.py: line 34: ") for line in again.differing)
    assert any(line.startswith("transcript.jsonl: line ") for line in again.differing)


def test_a_transcript_that_ends_early_ends_the_run(copy: Path, tmp_path: Path) -> None:
    path = copy / "transcript.jsonl"
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:-2]) + lines[-2][:30])  # the tool was called, and nothing came after it
    again = replay(copy, tmp_path / "runs")
    assert again.generated.verdict is not None
    assert again.generated.verdict.status == "blocked"
    assert "the recorded run asked nothing more" in again.generated.verdict.summary
    assert "iterations/02/program.py: was not made" in again.differing


def test_what_was_not_asked_for_again_is_counted(copy: Path, tmp_path: Path) -> None:
    facts = json.loads((copy / "run.json").read_text())
    facts["budget"]["iterations"] = 1
    (copy / "run.json").write_text(json.dumps(facts))
    assert replay(copy, tmp_path / "runs").divergences[0].startswith("8 recorded exchanges were not asked for")


def test_another_role_than_the_recorded_one_is_said(copy: Path, tmp_path: Path) -> None:
    path = copy / "transcript.jsonl"
    path.write_text(path.read_text().replace('"n": 8, "role": "coder"', '"n": 8, "role": "judge"'))
    again = replay(copy, tmp_path / "runs")
    assert "exchange 8: the coder asks, where the judge did" in again.divergences


def test_a_plan_from_a_file_is_taken_from_the_run(server: Server, tmp_path: Path) -> None:
    """Though a planner's model was named, nobody asked it."""
    models = Models(server.model("planner"), server.model("coder"))
    options = Options(NO_WORLD, models, Budget(iterations=1))
    done = generate(PROMPT, tmp_path / "runs", options, plan=flies())
    again = replay(done.run.path, tmp_path / "again")
    assert (again.divergences, again.differing) == ([], [])
    assert again.same == 4


def test_a_plan_made_from_a_picture_is_made_again(server: Server, tmp_path: Path) -> None:
    Image.effect_noise((900, 600), 80.0).convert("RGB").save(tmp_path / "photo.png")
    server.script["planner"] = [text("What a picture!"), text(json.dumps(answer()))]
    options = Options(NO_WORLD, Models(server.model("planner")), image=tmp_path / "photo.png")
    done = generate(PROMPT, tmp_path / "runs", options)
    (picture,) = (done.run.path / "pictures").iterdir()
    with Image.open(picture) as seen:
        assert seen.size == (640, 427)
    server.close()
    (tmp_path / "photo.png").unlink()
    again = replay(done.run.path, tmp_path / "again")
    assert (again.divergences, again.differing) == ([], [])


def test_a_planner_that_failed_fails_again(server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relay, "LONGEST_PAUSE", 0.0)
    server.forever["planner"] = status(500)
    done = generate(PROMPT, tmp_path / "runs", Options(NO_WORLD, Models(server.model("planner"))))
    again = replay(done.run.path, tmp_path / "again")
    assert (again.divergences, again.differing, again.same) == ([], [], 1)
    assert again.generated.verdict == done.verdict


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("run.json", '{"prompt": "x"}', "run.json lacks models, budget; give a run that wsim generate made"),
        ("run.json", "{", "run.json: not JSON"),
        ("transcript.jsonl", "[]\n", "transcript.jsonl:1: a line holds one exchange"),
        ("transcript.jsonl", None, "has no transcript.jsonl"),
    ],
)
def test_what_is_no_recorded_run_is_said(
    copy: Path, tmp_path: Path, name: str, content: str | None, message: str
) -> None:
    (copy / name).unlink()
    if content is not None:
        (copy / name).write_text(content)
    with pytest.raises(UserError, match=message) as caught:
        replay(copy, tmp_path / "runs")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "runs").exists()


# --- on the command line


def run(*arguments: object) -> tuple[int, str]:
    ended = CliRunner().invoke(app, [str(argument) for argument in arguments])
    if ended.exception is not None and not isinstance(ended.exception, SystemExit):
        raise ended.exception
    return ended.exit_code, " ".join(ended.output.split())


def test_replay_on_the_command_line(copy: Path, tmp_path: Path) -> None:
    code, out = run("generate", "--replay", copy, "--runs", tmp_path / "runs")
    assert code == 3  # blocked, as it was
    assert "replayed: 7 files are byte for byte as recorded, 0 are not" in out
    path = copy / "iterations" / "02" / "program.py"
    path.write_text(path.read_text().replace("duration=0.3", "duration=0.6"))
    code, out = run("generate", "--replay", copy, "--runs", tmp_path / "runs")
    assert code == 1
    assert "otherwise: iterations/02/program.py: line 34: " in out
    assert "replayed: 6 files are byte for byte as recorded, 1 are not" in out


def test_models_on_the_command_line(server: Server, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text(flies().model_dump_json())
    server.forever["coder"] = text(edit("no such line", "x"))
    code, out = run(
        "generate", "--plan", tmp_path / "plan.json", "--yes", "--coder-model", server.model("coder"),
        "--set", "mass=1", "--no-pictures", "--device", "cpu", "--runs", tmp_path / "runs",
    )  # fmt: skip
    assert code == 3, out
    assert "blocked the coder's model: unusable: 5 answers could not be used" in out
    assert "coder: 5 requests, 0 from the cache, 0 failed; 5000 + 500 tokens" in out
    assert "tokens: 5500 in all, in 1 iterations" in out


def test_one_model_for_every_role(server: Server, tmp_path: Path) -> None:
    server.script["m"] = [text(json.dumps(answer()))]
    code, out = run(
        "generate", PROMPT, "--yes", "--model", server.model("m"), "--max-iterations", 1, "--set", "mass=1",
        "--no-pictures", "--device", "cpu", "--runs", tmp_path / "runs",
    )  # fmt: skip
    assert code == 3
    assert "A ball flies" in out
    assert "iteration limit: 1 programs were tried" in out
    assert "planner: 1 requests" in out


@pytest.mark.parametrize("name", ["gpt", "nobody:m", "m@localhost:8000"])
def test_a_model_that_is_none_is_a_mistake(tmp_path: Path, name: str) -> None:
    (tmp_path / "plan.json").write_text(flies().model_dump_json())
    with pytest.raises(UserError, match=f"model of the coder: .*{name}"):
        run("generate", "--plan", tmp_path / "plan.json", "--yes", "--coder-model", name, "--runs", tmp_path / "runs")
    assert not (tmp_path / "runs").exists()


def test_the_help_names_what_a_model_may_do() -> None:
    code, out = run("generate", "--help")
    assert code == 0
    for word in (
        "--model",
        "--coder-model",
        "--max-iterations",
        "--max-tokens",
        "--max-seconds",
        "--replay",
        "3 blocked",
    ):
        assert word in out
