"""Which model each role has, and what is said of a name that is none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from wsim.agents.models import BUILTIN, ROLES, Models, choose, connect, reach
from wsim.errors import UserError

ENVIRONMENT = ("WSIM_MODEL", *(f"WSIM_{role.upper()}_MODEL" for role in ROLES), "OPENAI_API_KEY", "OPENAI_BASE_URL")
A, B, C, D = "openai:a", "openai:b", "c@http://127.0.0.1:8000/v1", "d@https://example.org/v1"


@pytest.fixture(autouse=True)
def nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No configuration but what the test makes."""
    monkeypatch.chdir(tmp_path)
    for name in ENVIRONMENT:
        monkeypatch.delenv(name, raising=False)


def wrong(*words: str, default: str | None = None, **by_role: str) -> None:
    with pytest.raises(UserError) as caught:
        choose(default, **by_role)
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_without_a_word_nothing_is_asked() -> None:
    assert choose() == Models(BUILTIN, BUILTIN, BUILTIN, BUILTIN)
    assert choose(coder="") == Models()
    assert not choose().any
    assert choose(coder=A).any


def test_options_name_all_roles_or_one() -> None:
    assert choose(A) == Models(A, A, A, A)
    assert choose(A, judge=B, planner=BUILTIN) == Models(BUILTIN, A, A, B)
    assert choose(None, coder=C)["coder"] == C


def test_the_environment_names_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WSIM_MODEL", A)
    monkeypatch.setenv("WSIM_REVIEWER_MODEL", B)
    assert choose() == Models(A, A, B, A)
    monkeypatch.setenv("WSIM_MODEL", "")
    assert choose() == Models(BUILTIN, BUILTIN, B, BUILTIN)


def test_a_file_names_them() -> None:
    Path("wsim.toml").write_text(f'[models]\nmodel = "{A}"\ncoder = "{C}"\n')
    assert choose() == Models(A, C, A, A)
    Path("wsim.toml").write_text("")
    assert choose() == Models()


def test_options_come_before_the_environment_and_that_before_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("wsim.toml").write_text(f'[models]\nplanner = "{A}"\ncoder = "{A}"\njudge = "{A}"\n')
    monkeypatch.setenv("WSIM_CODER_MODEL", B)
    monkeypatch.setenv("WSIM_JUDGE_MODEL", B)
    assert choose(judge=C) == Models(A, B, BUILTIN, C)
    assert choose(D) == Models(D, D, D, D)  # one for all, nearer by, is for all
    monkeypatch.setenv("WSIM_MODEL", D)
    assert choose() == Models(D, B, D, B)
    assert choose(judge=BUILTIN).judge == BUILTIN


@pytest.mark.parametrize("name", ["gpt", ":", "m@", "@http://127.0.0.1/v1", "m@ftp://127.0.0.1/v1", "m@127.0.0.1:80"])
def test_a_name_that_is_none_is_said_with_what_is_one(name: str) -> None:
    with pytest.raises(UserError, match='give "builtin", a provider and a model such as') as caught:
        reach(choose(coder=name))
    assert "model of the coder" in str(caught.value)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_model_may_have_an_at_sign_of_its_own() -> None:
    model = connect("claude@2026@http://127.0.0.1:8000/v1", "coder")
    assert model.model_name == "claude@2026"
    assert str(model.base_url).rstrip("/") == "http://127.0.0.1:8000/v1"
    assert choose("google-cloud:claude@2026").coder == "google-cloud:claude@2026"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[models", ["wsim.toml: "]),
        ("[models]\nartist = 'openai:a'\n", ["[models] knows model, planner, coder, reviewer, judge; not 'artist'"]),
        ("model = 'openai:a'\n", ["wsim.toml: it has one table, [models]; not 'model'"]),
        ("[model]\ncoder = 'openai:a'\n", ["it has one table, [models]; not 'model'"]),
        ("models = 3\n", ["it has one table, [models]"]),
        ("[models]\ncoder = 3\n", ["model of the coder: '3' is none"]),
        ("[models]\ncoder = 'gpt'\n", ["model of the coder: 'gpt' is none"]),
    ],
)
def test_a_file_that_is_wrong_is_said(text: str, words: list[str]) -> None:
    Path("wsim.toml").write_text(text)
    wrong(*words)


def test_a_file_that_is_no_text_is_said() -> None:
    Path("wsim.toml").write_bytes(b"\xff\xfe[models]")
    wrong("wsim.toml: ")
    Path("wsim.toml").unlink()
    Path("wsim.toml").mkdir()
    assert choose() == Models()


def test_a_provider_is_looked_for_before_anything_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    reach(Models())
    install = 'pip install "pydantic-ai-slim[anthropic]"'
    for name, word in (("nobody:m", "nobody"), ("openai:m", "OPENAI_API_KEY"), ("anthropic:m", install)):
        with pytest.raises(UserError, match=f"model of the judge: {name}: .*{re.escape(word)}.*; give ") as caught:
            reach(Models(judge=name))
        assert "\n" not in str(caught.value)
    monkeypatch.setenv("OPENAI_API_KEY", "key")
    reach(Models(judge="openai:m", coder=C))


def test_the_usual_address_of_a_server_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_BASE_URL", "http://127.0.0.1:8399/v1")
    model = connect("openai:anything", "coder")
    assert (model.model_name, str(model.base_url).rstrip("/")) == ("anything", "http://127.0.0.1:8399/v1")
