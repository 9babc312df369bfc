from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import jinja2
import numpy as np
import pytest

from tests.crashing import CRASH
from wsim import recording
from wsim.errors import UserError
from wsim.judge.verdict import Finding, RepairTarget, Verdict
from wsim.recording import Frame, RecordingWriter, kept
from wsim.report import make_ready, templates, write
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import judge_recording
from wsim.scene.world import Body, Shape, World

_spec = importlib.util.spec_from_file_location("report_probe", Path(__file__).parent / "probe.py")
assert _spec is not None and _spec.loader is not None
browser = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(browser)

Elements = browser.Elements
needs_chromium = pytest.mark.skipif(browser.CHROMIUM is None, reason=browser.MISSING)
BLOCK_LINE, BALL_LINE = 11, 12
HOSTILE = "</blockquote><script>document.title = 'owned'</script><img src=x onerror=alert(1)>"


def test_the_reason_comes_first(rejected: Path) -> None:
    page = Elements(write(rejected))
    text = page.words
    reason = text.index("The ball lies 31 mm above the tank's floor")
    for word in ("Rejected", "1 of 2 findings failed"):
        assert text.index(word, text.index("wsim · run")) < reason
    card = text[reason : text.index("What must happen")]
    for words in (
        "measured 0.031 m", "at most 0.01 m", "margin −0.021 m", "time 2.5 s", "twice the contact margin",
        "Change the collision of ball", "it looks smaller than it is", "side at 2.5 s",
    ):  # fmt: skip
        assert words in card, card
    assert "scene.sphere(" in card and "--finding 2" in card
    rows = page.all("tbody", class_="finding")
    assert [("fail" in (row["class"] or "").split()) for row in rows] == [True, False]
    assert "wsim view " in text and "--finding 2" in text and "--finding 1" not in text


def test_a_check_that_crashed_is_shown_with_its_traceback(make_run, floats: Finding) -> None:
    summary = f"Blocked: {CRASH.message}; all 1 findings of the others pass."
    page = Elements(write(make_run(Verdict(status="blocked", summary=summary, findings=[floats], crashes=[CRASH]))))
    assert page.words.index("Blocked") < page.words.index("What could not be evaluated")
    crashed = page.words[page.words.index("What could not be evaluated") : page.words.index("What must happen")]
    assert CRASH.message in crashed and CRASH.traceback in crashed and "a fault of wsim's" in crashed
    assert "Why it failed" not in page.words


def test_the_summary_says_nothing_twice(make_run) -> None:
    findings = [
        Finding(check="CheckComplete", passed=False, message="It ends early."),
        Finding(check="ObjectiveFloats", passed=False, message="It sinks.", objective="It floats.", value=2.0),
    ]
    verdict = Verdict(status="rejected", summary="Rejected: 2 of 2 findings fail; It sinks.", findings=findings)
    words = Elements(write(make_run(verdict))).words
    assert "2 of 2 findings fail. " in words
    first, second = words.index("It sinks."), words.index("It ends early.")
    assert words.index("2 of 2") < first < second


def test_only_the_first_card_is_open_and_what_passed_is_folded(make_run, sinks, floats) -> None:
    findings = [sinks, sinks.model_copy(update={"prim": "/World/block"}), floats]
    page = Elements(write(make_run(Verdict(status="rejected", summary="Rejected: 2 of 3.", findings=findings))))
    cards = page.all("details", class_="card")
    assert [card["id"] for card in cards] == ["failed-1", "failed-2"]
    assert ["open" in card for card in cards] == [True, False]
    assert ["open" in folded for folded in page.all("details", class_="passed")] == [False]
    assert "✓ 1 passed ; the closest to its limit: #3 ObjectiveFloats of block" in page.words


def test_what_to_change_is_listed_once_where_several_findings_ask(make_run, sinks) -> None:
    block = sinks.target.model_copy(update={"prim": "/World/block"})
    step = RepairTarget(kind="time step", parameter="time_step", direction="lower", suggested=2e-4, unit="s")
    targets = [sinks.target, block, step]
    findings = [sinks.model_copy(update={"target": target}) for target in targets]
    run = make_run(Verdict(status="rejected", summary="Rejected: 3 of 3.", findings=findings))
    page = Elements(write(run))
    assert len(page.all("section", id="fixes")) == 1
    words = page.words[page.words.index("What to change") :]
    assert "Change the collision of ball and block" in words and "Lower the time step to 0.0002 s" in words
    assert f"wsim run {run} --time-step 0.0002" in words


def test_findings_link_to_their_lines(rejected: Path) -> None:
    page = Elements(write(rejected))
    assert [line["id"] for line in page.all("span", class_="failed")] == [f"L{BALL_LINE}"]
    targets = {attrs["id"] for _, attrs in page.found if "id" in attrs}
    anchors = [link for link in page.links() if link.startswith("#")]
    assert {f"#L{BALL_LINE}", f"#L{BLOCK_LINE}", "#failed-2"} <= set(anchors)
    assert {anchor[1:] for anchor in anchors} <= targets


def test_one_file_that_needs_no_other(rejected: Path) -> None:
    path = write(rejected)
    assert path == rejected / "report.html" and 20_000 < path.stat().st_size < 2_000_000
    page = Elements(path)
    assert all(link.startswith(("#", "data:")) for link in page.links())
    assert not re.search(r"https?://|url\(|@import", page.html)
    assert not page.all("script") and not page.all("link")
    assert not list(rejected.glob("*.partial"))


def test_all_that_the_run_left_is_there(accepted: Path) -> None:
    page = Elements(write(accepted))
    text = page.words
    assert len(page.all("video")) == 1 and len(page.all("img")) == 6  # no failed finding, so the stills alone
    for title in ("Depth of the lowest point", "Energy of the fluid", "Density error of the fluid", "Deepest contact"):
        assert title in text
    assert "0.09 m expected" in text
    for words in ("wooden_block", "7850 kg/m³", "the prompt gives no size", "at the surface of water, gap 0.005 m"):
        assert words in text, words
    for words in ("device cpu", "time step 0.417 ms (the fluid's sound)", "fluid particles 1200", "newton 1.8.0"):
        assert words in text, words
    for words in ("simulate 61.8 s", "whole run 64.2 s", "wood_density 600 kg/m³ 300 … 900"):
        assert words in text, words


def test_markup_in_texts_is_text(make_run) -> None:
    finding = Finding(check="CheckLog", passed=False, message=HOSTILE, prim="/World/<b>", line=f'"><i>:{BALL_LINE}')
    verdict = Verdict(status="rejected", summary=HOSTILE, findings=[finding])
    program = f'"""{HOSTILE}"""\nx = "{HOSTILE}"  # {HOSTILE}\n'
    page = Elements(write(make_run(verdict, program=program, prompt=HOSTILE)))
    assert page.text.count(HOSTILE) == 8  # title, heading, summary, card, table, and three in the program
    assert not page.all("script") and not page.all("i", onerror="") and not page.all("b", onerror="alert(1)")
    assert all(attrs["src"].startswith("data:") for attrs in page.all("img"))


def test_code_that_would_read_otherwise_than_it_runs_is_marked(make_run) -> None:
    verdict = Verdict(status="accepted", summary="fine")
    page = Elements(write(make_run(verdict, program='x = "a\u202eb"\n')))
    assert "\u202e" not in page.html and "U+202E" in page.text


def test_a_failed_build_shows_its_error_and_its_line(failed_build: Path) -> None:
    page = Elements(write(failed_build))
    assert "SceneError: param 'wood density': a name is letters, digits and _" in page.text
    assert [line["id"] for line in page.all("span", class_="failed")] == ["L10"]
    assert "building …" in page.text
    assert not page.all("video") and not page.all("svg") and "wsim view" not in page.text


def test_a_run_that_has_only_begun(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    assert "The run ended before its program was written." in Elements(write(tmp_path)).text
    run.record(prompt="a tank", status="not approved")
    assert "The plan was not approved" in Elements(write(tmp_path)).text
    (run.iteration(1) / "program.py").write_text("def build(scene):\n    pass\n", encoding="utf-8")
    assert "def build(scene)" in Elements(write(tmp_path)).text


def test_files_that_cannot_be_read_are_named(make_run) -> None:
    run = make_run(Verdict(status="accepted", summary="fine"))
    iteration = run / "iterations" / "01"
    (iteration / "recording.rrd").unlink()
    for path in (iteration / "recording.rrd", iteration / "verdict.json", run / "plan.json"):
        path.write_text("[1, 2", encoding="utf-8")
    (iteration / "program.py").write_bytes(b"x = '\xff\xfe'\n  y = (\n")
    text = Elements(write(run)).text
    for name in ("recording.rrd", "verdict.json", "plan.json"):
        assert f"{name} of" in text and "cannot be read" in text
    assert "y = (" in text


def test_no_folder_is_a_users_mistake(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="give the folder of a run"):
        write(tmp_path / "missing")


def test_a_run_that_blew_up_is_still_drawn(tmp_path: Path) -> None:
    """A recording that ends early in NaN, without fluid, scalars or pictures."""
    box = Shape(prim="/World/box/geometry", kind="box", size=(0.2, 0.2, 0.2))
    start = {"position": (0.0, 0.0, 1.0), "rotation": (0.0, 0.0, 0.0, 1.0)}
    body = Body(prim="/World/box", mass=1.0, volume=0.008, inertia=(1, 0, 0, 0, 1, 0, 0, 0, 1), shapes=[box], **start)
    folder = RunFolder(tmp_path).iteration(1)
    with RecordingWriter(folder / "recording.rrd", World(bodies=[body])) as writer:
        for k, z in enumerate((1.0, 0.9, np.nan, np.nan)):
            q = np.array([[0, 0, z, 0, 0, 0, 1]], np.float32)
            writer.frame(k / 30, Frame(q, np.zeros((1, 6), np.float32), np.zeros((1, 3), np.float32)))
        writer.log(0.1, "ERROR", "body_q is not finite")
        writer.close(complete=False, error="body_q is not finite")
    page = Elements(write(tmp_path))
    assert "The recording is incomplete: body_q is not finite" in page.text
    lines = [attrs for attrs in page.all("polyline") if "line" in (attrs["class"] or "")]
    assert len(lines) == 1 and len((lines[0]["points"] or "").split()) == 2 and "nan" not in (lines[0]["points"] or "")


def test_the_newest_iteration_is_the_one_that_is_shown(make_run) -> None:
    run = make_run(Verdict(status="rejected", summary="the first try"))
    second = RunFolder(run).iteration(2)
    (second / "program.py").write_text("# the second try\n", encoding="utf-8")
    verdict = Verdict(status="blocked", summary="no evidence")
    (second / "verdict.json").write_text(verdict.model_dump_json(), encoding="utf-8")
    page = Elements(write(run))
    assert "Blocked" in page.text and "# the second try" in page.text
    assert "the first try" in page.text and "02 (shown)" in page.text


@needs_chromium
@pytest.mark.parametrize("width", [1280, 500])
def test_a_browser_shows_it(rejected: Path, tmp_path: Path, width: int) -> None:
    shown = browser.probe(write(rejected), tmp_path / "profile", width)
    assert shown["scrollWidth"] <= shown["width"] == width
    assert len(shown["rows"]) == 2 and "The ball lies 31 mm above" in shown["rows"][0]
    assert shown["fix"]["bottom"] < 900  # the reason and what to change are on the first screen
    assert width < 800 or shown["moment"]["bottom"] < 900  # and so is the picture, where there is room beside them
    assert shown["images"] == 7 and shown["broken"] == 0 and shown["charts"] == 7
    assert shown["video"]["error"] is None and shown["video"]["state"] >= 2 and shown["video"]["width"] == 320
    assert shown["video"]["duration"] == pytest.approx(91 / 30, abs=0.05)
    assert shown["video"]["muted"] and shown["video"]["loop"]


@needs_chromium
def test_a_large_video_is_linked_and_plays(accepted: Path, tmp_path: Path) -> None:
    path = write(accepted, most_video_bytes=1000)
    page = Elements(path)
    assert [video["src"] for video in page.all("video")] == ["iterations/01/video.mp4"]
    shown = browser.probe(path, tmp_path / "profile")
    assert shown["video"]["error"] is None and shown["video"]["state"] >= 1 and shown["video"]["duration"] > 3.0


@needs_chromium
def test_hostile_text_does_not_run(make_run, tmp_path: Path) -> None:
    finding = Finding(check="CheckLog", passed=False, message=HOSTILE, line=f"program.py:{1}")
    verdict = Verdict(status="rejected", summary="bad", findings=[finding])
    shown = browser.probe(write(make_run(verdict, program=f"# {HOSTILE}\n", prompt=HOSTILE)), tmp_path / "profile")
    assert shown["title"].startswith("Rejected: ") and shown["broken"] == 0
    assert shown["page"].count(HOSTILE) == 5  # heading, card, its line of code, table, program


def test_a_page_that_was_made_ready_compiles_nothing(accepted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And is the same."""
    before = write(accepted).read_bytes()
    templates._environment.cache_clear()
    make_ready()
    monkeypatch.setattr(jinja2.Environment, "compile", lambda *_, **__: pytest.fail("a template is compiled"))
    assert write(accepted).read_bytes() == before


def test_a_recording_that_was_judged_is_reported_unread(accepted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And what is shown of it is what its file holds."""
    before = write(accepted).read_bytes()
    with recording.keeping():
        judge_recording(next(accepted.glob("iterations/*/recording.rrd")), None)
        monkeypatch.setattr(kept, "read", lambda path: pytest.fail(f"{path} is read"))
        assert write(accepted).read_bytes() == before
