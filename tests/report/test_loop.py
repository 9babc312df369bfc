"""What the page tells of a run with several iterations, and of the models that were asked in it."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from wsim.loop.generate import generate
from wsim.loop.options import Options
from wsim.plan.store import load
from wsim.program.bare import bare
from wsim.report import write
from wsim.report.diff import MOST_LINES, difference, make_diff
from wsim.runs.attempt import Attempt, attempt
from wsim.runs.folder import RunFolder, write_json
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

_spec = importlib.util.spec_from_file_location("report_probe", Path(__file__).parent / "probe.py")
assert _spec is not None and _spec.loader is not None
browser = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(browser)

Elements = browser.Elements
PROMPT = "A wooden box slides down a ramp"
SETTINGS = Settings(device="cpu", pictures=False)
CODER, REVIEWER = "coder-7b@http://127.0.0.1:8000/v1", "looker-2b@http://127.0.0.1:8000/v1"
HOSTILE = "</p></li><script>document.title = 'owned'</script><img src=x onerror=alert(1)>\u202e"
USAGE = {
    "tokens": 1_031_234,
    "by_role": {
        "planner": {"requests": 2, "cached": 0, "failed": 0, "input_tokens": 5210, "output_tokens": 824,
                    "seconds": 14.2, "dollars": 0.02},
        "coder": {"requests": 4, "cached": 1, "failed": 3, "input_tokens": 1_021_000, "output_tokens": 4200,
                  "seconds": 141.7},
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run without models, accepted at once, as the loop leaves it; do not write to it."""
    return generate(PROMPT, tmp_path_factory.mktemp("made"), Options(SETTINGS)).run.path


@pytest.fixture(scope="module")
def tried(made: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Attempt]]:
    """Four programs tried: stuck; one with a mistake; sliding, but too slowly; another with a mistake."""
    run = RunFolder(tmp_path_factory.mktemp("tried"))
    shutil.copy(made / "plan.json", run.path)
    right = (made / "iterations" / "01" / "program.py").read_text(encoding="utf-8")
    assert right.count("friction=0.4,") == 1 and right.count("rotation_deg=(0.0, 30.0, 0.0)") == 2
    stuck, slow = right.replace("friction=0.4,", "friction=1.4,"), right.replace("friction=0.4,", "friction=0.55,")
    patches = [(stuck, None), (stuck.replace("rotation_deg", "rotation_degrees"), stuck), (slow, stuck)]
    patches.append((slow.replace("static=True", "fixed=True"), slow))
    plan = load(run.path / "plan.json")
    return run.path, [attempt(Iteration(run.add(text, before), plan, SETTINGS)) for text, before in patches]


@pytest.fixture
def blocked(tried: tuple[Path, list[Attempt]], tmp_path: Path) -> Callable[..., Path]:
    """The run of `tried` with what the loop writes into run.json, changed as given."""
    source, attempts = tried
    ranks = [one.rank for one in attempts]
    kept = [all(rank > before for before in ranks[:k]) for k, rank in enumerate(ranks)]
    assert kept == [True, False, True, False]
    rows = [
        {
            "number": one.number, "reached": one.reached.name.lower(), "status": one.verdict.status,
            "summary": one.verdict.summary, "failed": list(dict.fromkeys(f.check for f in one.verdict.failures)),
            "kept": keep,
        }
        for one, keep in zip(attempts, kept, strict=True)
    ]  # fmt: skip
    rows[2]["repair"] = "physical parameter (friction): 0.55 is nearly the slope's tangent"
    facts: dict[str, Any] = {
        "prompt": PROMPT, "title": PROMPT, "iterations": rows, "best": 3, "usage": USAGE, "status": "blocked",
        "models": {"planner": CODER, "coder": CODER, "reviewer": "builtin", "judge": CODER},
        "settings": {"device": "cpu"}, "budget": {"iterations": 4, "tokens": 2_000_000, "seconds": 3600.0},
        "confirm": True, "skills": {"03": ["materials", "repairing-from-a-verdict"]},
        "notes": ["iteration 3 was judged by the checks alone: the request timed out"],
        "cause": "iteration limit: 4 programs were tried", "summary": "iteration limit",
    }  # fmt: skip

    def make(**changes: Any) -> Path:
        run = tmp_path / "run"
        shutil.copytree(source, run)
        write_json(run / "run.json", {key: value for key, value in {**facts, **changes}.items() if value is not None})
        return run

    return make


@pytest.fixture
def accepted(made: Path, tmp_path: Path) -> Path:
    """A copy of `made` that may be written to."""
    return Path(shutil.copytree(made, tmp_path / "accepted"))


def change(path: Path, **facts: Any) -> None:
    known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    write_json(path, {**known, **facts})


def section(page: Any, start: str, end: str) -> str:
    words: str = page.words
    return words[words.index(start) : words.index(end, words.index(start))]


def test_the_best_iteration_is_shown_where_the_newest_was_undone(blocked: Callable[..., Path]) -> None:
    run = blocked()
    page = Elements(write(run))
    assert "Shown is iteration 03, the best of 4; the newest, 04, was no better and was undone." in page.words
    assert "friction= 0.55 ," in section(page, "Program ", "Parameters ")
    assert f"wsim view {run / 'iterations' / '03'}" in page.words and f"wsim view {run} " not in page.words
    assert page.all("svg")  # the recording of the third, for the fourth has none
    assert not (run / "iterations" / "04" / "recording.rrd").exists()


def test_each_iteration_has_a_row_with_its_patch(blocked: Callable[..., Path]) -> None:
    run = blocked()
    page = Elements(write(run))
    assert [row["id"] for row in page.all("tbody", class_="attempt")] == [f"iteration-0{k}" for k in (1, 2, 3, 4)]
    words = section(page, "Iterations ", "Verdict ")
    starts = [words.index(f" 0{k} ") for k in (1, 2, 3, 4)]
    first, second, third, fourth = (words[a:b] for a, b in zip(starts, [*starts[1:], len(words)], strict=True))
    assert "failed at its full recording CheckPlanLooks ObjectiveSlides" in first and "kept" in first
    assert "failed at the check of its text program" in second and 'no argument "rotation_degrees"' in second
    assert "(shown)" in third[:20] and "nearly the slope's tangent kept" in third
    assert "Patch of 01: +1 −1 lines" in third and "friction=1.4, friction=0.55," in third
    assert "Written with the skills materials, repairing-from-a-verdict" in third
    assert "Patch of 03: +1 −1 lines" in fourth and "static=True, fixed=True," in fourth and "undone" in fourth
    assert "undone" in second and "skills" not in first + second + fourth and "(shown)" not in first + second + fourth
    links = [link for link in page.links() if not link.startswith(("#", "data:"))]
    assert "iterations/03/patch.diff" in links and "iterations/01/patch.diff" not in links
    assert all((run / link).exists() for link in links)
    assert len(page.all("span", class_="added")) == len(page.all("span", class_="removed")) == 4


@pytest.mark.parametrize(
    ("cause", "words"),
    [
        ("iteration limit: 4 programs were tried",
         "No program was accepted, and it may try no more : 4 programs were tried. wsim generate --max-iterations"),
        ("token limit: 9 of 8 tokens are used", "and its tokens are used up : 9 of 8 tokens are used."),
        ("time limit: 60 s are over", "and its time is over : 60 s are over. wsim generate --max-seconds"),
        ("Connection error.", "the coder's model gave no patch that could be used : Connection error. "),
    ],
)  # fmt: skip
def test_why_it_is_blocked_stands_at_the_top(blocked: Callable[..., Path], cause: str, words: str) -> None:
    page = Elements(write(blocked(cause=cause)))
    assert words in section(page, "Blocked", "Why it failed")
    assert re.search(r"3 of \d+ findings fail", section(page, "Blocked", "Why it failed"))
    assert "nearly the slope's tangent" in section(page, "What to change", "What must happen")


def test_a_planner_that_failed(tmp_path: Path) -> None:
    RunFolder(tmp_path).record(
        prompt=PROMPT, models={"planner": CODER}, budget={"tokens": 9}, status="blocked", usage=USAGE,
        cause="5 answers could not be used; the last: not JSON",
    )  # fmt: skip
    page = Elements(write(tmp_path))
    top = section(page, "wsim ·", "Models and cost")
    assert "the planner's model gave no plan that could be used : 5 answers could not be used" in top
    assert PROMPT in top and "before its program was written" in top


def test_models_and_what_they_cost(blocked: Callable[..., Path]) -> None:
    words = section(Elements(write(blocked())), "Models and cost", "Facts").replace("\u202f", " ")
    assert f"planner {CODER} 2 0 0 5 210 824 14.2 s 0.02 $" in words
    assert f"coder {CODER} 4 1 3 1 021 000 4 200 2 min 22 s not known" in words
    assert f"reviewer built in, no model judge {CODER} all 6 1 3 1 026 210 5 024" in words
    assert "at least 0.02 $" in words
    assert "1 031 234 tokens in all, and no world was accepted; 2 000 000 were allowed." in words
    assert "iteration 3 was judged by the checks alone: the request timed out" in words


def test_the_tokens_of_an_accepted_world(accepted: Path) -> None:
    change(accepted / "run.json", usage=USAGE, models={"planner": CODER, "coder": CODER})
    words = Elements(write(accepted)).words.replace("\u202f", " ")
    assert "1 031 234 tokens in all for this accepted world" in words


def test_a_run_without_models_says_so_in_a_line(made: Path) -> None:
    page = Elements(write(made))
    assert "Models and cost No language model was asked. Facts" in page.words
    assert not page.all("section", id="iterations") and not page.all("section", id="review")
    assert "Shown is" not in page.words and "budget" not in page.words


def test_what_acceptance_did(accepted: Path) -> None:
    words = section(Elements(write(accepted)), "Acceptance", "What happened")
    assert "the same place at every frame, to the last bit" in words and "nothing was stripped" in words
    for name in ("program.py", "stage.usda"):
        digest = hashlib.sha256((accepted / "accepted" / name).read_bytes()).hexdigest()
        assert f"accepted/{name} {digest}" in words


def test_what_acceptance_stripped(accepted: Path) -> None:
    program = accepted / "iterations" / "01" / "program.py"
    looking = '    scene.camera("review_near", eye=(0.0, -1.0, 0.9), target=(0.0, 0.0, 0.4))\n    print("looked")\n'
    text = program.read_text(encoding="utf-8").replace("    scene.simulation(", looking + "    scene.simulation(")
    program.write_text(text, encoding="utf-8")
    (accepted / "accepted" / "program.py").write_text(bare(text), encoding="utf-8")
    change(accepted / "accepted" / "acceptance.json", stripped=True, largest_distance_m=2.5e-3)
    page = Elements(write(accepted))
    words = section(page, "Acceptance", "SHA-256")
    assert "0.0025 m apart at most" in words and "2 lines that only served the review were stripped" in words
    assert "review_near" in words and len(page.all("span", class_="removed")) == 2
    assert not page.all("span", class_="added")


def test_a_review_by_a_model(accepted: Path) -> None:
    seen = {
        "summary": "The box slides.", "motion": "It speeds up, then stops.", "layout": "", "contacts": "",
        "differences": [{"object": "ramp", "what": "nothing holds it", "severity": "major"}],
    }  # fmt: skip
    path = accepted / "iterations" / "01" / "review.json"
    change(path, share_of_picture=[], by=REVIEWER, review=seen)
    page = Elements(write(accepted))
    words = section(page, "Review", "Acceptance")
    assert f"by {REVIEWER}, from pictures The box slides. Not as planned major ramp : nothing holds it" in words
    assert "motion It speeds up, then stops." in words and "layout" not in words
    change(path, review=seen | {"differences": []})
    assert "names no difference from the plan" in Elements(write(accepted)).words


def test_a_review_by_facts(accepted: Path) -> None:
    path = accepted / "iterations" / "01" / "review.json"
    change(path, share_of_picture=[], by="builtin", review={"facts": ["side: box 4/3/4"]})
    assert "Review no model looked: what the shape-index images say of each object side: box 4/3/4" in (
        Elements(write(accepted)).words
    )
    write_json(path, {"share_of_picture": []})  # nobody was asked
    page = Elements(write(accepted))
    assert not page.all("section", id="review") and "cannot be read" not in page.words


def test_the_picture_it_was_to_look_like(accepted: Path) -> None:
    before = len(Elements(write(accepted)).all("img"))
    Image.new("RGB", (160, 90), (200, 200, 200)).save(accepted / "reference.jpg")
    page = Elements(write(accepted))
    assert len(page.all("img")) == before + 1 and "the reference picture" in page.words


def hostile(run: Path) -> Path:
    """A run whose models and program say what would break a page that believes them."""
    facts = json.loads((run / "run.json").read_text(encoding="utf-8"))
    for row in facts["iterations"]:
        row |= {"summary": HOSTILE, "repair": HOSTILE, "failed": [HOSTILE], "reached": HOSTILE}
    names = dict.fromkeys(("planner", "coder"), HOSTILE)
    change(run / "run.json", **{**facts, "notes": [HOSTILE], "cause": HOSTILE, "models": names})
    change(run / "run.json", skills={"03": [HOSTILE]}, title=HOSTILE, prompt=HOSTILE)
    seen = dict.fromkeys(("summary", "objects", "layout", "motion", "contacts"), HOSTILE)
    seen |= {"differences": [{"object": HOSTILE, "what": HOSTILE, "severity": HOSTILE}], "facts": [HOSTILE]}
    change(run / "iterations" / "03" / "review.json", by=HOSTILE, review=seen)
    patch = f"--- a\n+++ b\n@@ -1 +1 @@\n-{HOSTILE}\n+{HOSTILE}\n"
    (run / "iterations" / "03" / "patch.diff").write_text(patch, encoding="utf-8")
    (run / "accepted").mkdir()
    write_json(run / "accepted" / "acceptance.json", {"stripped": True, "largest_distance_m": 0.0})
    (run / "accepted" / "program.py").write_text(HOSTILE, encoding="utf-8")
    (run / "accepted" / "SHA256SUMS").write_text(f"{HOSTILE}  {HOSTILE}\n", encoding="utf-8")
    return write(run)


def test_what_models_say_is_text(blocked: Callable[..., Path]) -> None:
    page = Elements(hostile(blocked()))
    assert not page.all("script") and not page.all("img", onerror="alert(1)")
    assert page.text.count("<script>document.title = 'owned'</script>") > 25
    program = page.html[page.html.index('class="diff"') :]
    assert "U+202E" in program


def test_a_run_of_before_has_none_of_it(rejected: Path) -> None:
    page = Elements(write(rejected))
    ids = {attrs.get("id") for _, attrs in page.found}
    assert not ids & {"iterations", "models", "review", "acceptance", "ending"}
    assert "planner builtin" in page.words  # of run.json, as ever


def test_a_run_that_was_killed(blocked: Callable[..., Path]) -> None:
    run = blocked(status=None, cause=None, usage=None, summary=None, skills=None, notes=None)
    facts = json.loads((run / "run.json").read_text(encoding="utf-8"))
    change(run / "run.json", iterations=facts["iterations"][:3])
    words = Elements(write(run)).words
    assert "Unfinished" in words and "the best of 4; the newest, 04, was not finished." in words
    change(run / "run.json", iterations=facts["iterations"][:3], status="stopped", summary="interrupted")
    words = Elements(write(run)).words
    assert "The run was stopped : interrupted." in words and "Stopped" in words


def test_a_run_json_that_is_not_as_it_should_be(blocked: Callable[..., Path]) -> None:
    words = Elements(write(blocked(iterations=[{"number": "first"}]))).words
    assert "run.json of run cannot be read" in words and "iterations.0.number" in words
    assert "(shown)" in words  # the newest, then


def test_a_diff_in_lines() -> None:
    diff = make_diff("--- program.py\n+++ program.py\n@@ -3,2 +4,2 @@\n a\n---x\n+++\ty\n")
    kinds = [(line.kind, str(line.html)) for line in diff.lines]
    assert kinds == [("at", "line 4"), ("same", "a"), ("removed", "--x"), ("added", "++  y")]
    assert (diff.added, diff.removed) == (1, 1)
    same = difference("a\nb\n", "a\nb\n")
    assert same.lines == [] and same.added == same.removed == 0


def test_a_long_diff_is_cut() -> None:
    diff = make_diff("@@ -1 +1 @@\n" + "+x\n" * 2000)
    assert diff.added == 2000 and len(diff.lines) == MOST_LINES + 1
    assert str(diff.lines[-1].html) == f"… {2001 - MOST_LINES} more lines"


@pytest.mark.skipif(browser.CHROMIUM is None, reason=browser.MISSING)
@pytest.mark.parametrize("width", [1280, 500])
def test_a_browser_shows_it(blocked: Callable[..., Path], tmp_path: Path, width: int) -> None:
    page = write(blocked())
    page.write_text(page.read_text(encoding="utf-8").replace('<details class="patch">', '<details open class="patch">'))
    shown = browser.probe(page, tmp_path / "profile", width)
    assert shown["scrollWidth"] <= shown["width"] == width
    assert shown["ending"]["bottom"] < shown["why"]["top"] < 320  # px: the cause and what failed, before anything else
    assert len(shown["attempts"]) == 4 and "friction=0.55," in shown["attempts"][2]
    assert len(set(shown["shades"])) == 3  # added, removed, neither


@pytest.mark.skipif(browser.CHROMIUM is None, reason=browser.MISSING)
def test_what_models_say_does_not_run(blocked: Callable[..., Path], tmp_path: Path) -> None:
    shown = browser.probe(hostile(blocked()), tmp_path / "profile")
    assert shown["title"].startswith("Blocked: </p>") and shown["broken"] == 0
