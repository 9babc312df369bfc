"""Plans and programs that are written through the tools."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.tools.conftest import RIGID, call_tool, done, refused
from wsim.plan.store import load
from wsim.rules.planner import plan as make_plan
from wsim.tools import TOOLS, Workspace
from wsim.tools.plan import plan_lines
from wsim.tools.text import LIMIT

PLANS = Path(__file__).parents[2] / "examples" / "plans"

BLOCKS = "Three wooden blocks float on the water in a glass tank."


def data_of(prompt: str) -> dict:
    return make_plan(prompt).model_dump(mode="json")


def test_a_plan_is_laid_out_and_kept(empty: Workspace) -> None:
    data = data_of(BLOCKS)
    for item in data["objects"]:
        item["pose"] = None
    text = done(empty, "write_plan", plan=json.dumps(data))
    kept = load(empty.run.path / "plan.json")
    assert [item.pose is not None for item in kept.objects if item.primitive == "box"] == [True] * 3
    x, y, z = kept.object("wooden_block_1").pose.position
    assert f"{x:.4g}, {y:.4g}, {z:.4g}" in text
    assert done(empty, "read_plan") == "\n".join(text.splitlines()[1:])
    assert done(empty, "write_plan", plan=data) == text  # a tree is as good as its text
    assert [path.name for path in empty.run.path.glob("plan*")] == ["plan.json"]


def test_parts_of_a_plan(empty: Workspace) -> None:
    done(empty, "write_plan", plan=data_of(BLOCKS))
    for part, word in (
        ("objects", "wooden_block_2  box"),
        ("relations", "where: water: in tank"),
        ("objectives", "wooden_block_3 floats on the water."),
        ("cameras", "side"),
        ("assumptions", "wood of 600 kg/m^3"),
        ("steps", "step 1:"),
    ):
        assert word in done(empty, "read_plan", part=part)
    assert done(empty, "read_plan", part="joints") == "no joints"
    assert "wooden_block_2" not in done(empty, "read_plan", part="objects", object="wooden_block_1")
    assert "the plan has ground, tank, water" in refused(empty, "read_plan", object="lid")


def test_a_long_plan_is_cut_and_says_so(empty: Workspace) -> None:
    done(empty, "write_plan", plan=data_of("Twelve wooden boxes stand in a row."))
    text = done(empty, "read_plan")
    assert LIMIT - 200 < len(text) <= LIMIT
    assert text.splitlines()[-1].endswith("more lines left out; ask for one part, or one object")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.pop("title"), "title: it is missing"),
        (lambda data: data["objects"][0].update(role="gizmo"), "objects.0.role"),
        (lambda data: data["objects"][3]["topology"]["relation"][0].update(ref="sea"), "no object 'sea'"),
        (
            lambda data: data["objects"][3]["topology"]["relation"].append({"predicate": "PLACE-ON", "ref": "tank"}),
            "tank",
        ),
    ],
)
def test_what_is_wrong_with_a_plan_is_the_answer(empty: Workspace, change: object, said: str) -> None:
    data = data_of(BLOCKS)
    for item in data["objects"]:
        item["pose"] = None
    change(data)  # type: ignore[operator]
    text = refused(empty, "write_plan", plan=data)
    assert text.startswith("not written: ")
    assert said in text
    assert list(empty.run.path.iterdir()) == [empty.run.path / "iterations"]


def test_no_json_no_plan(empty: Workspace) -> None:
    assert "not written: not JSON" in refused(empty, "write_plan", plan="{title")
    assert "not UTF-8" in refused(empty, "write_plan", plan="\ud800")
    assert "unicode" in refused(empty, "write_program", text="\ud800")
    assert "write one with write_plan" in refused(empty, "read_plan")


def test_a_plan_by_which_an_iteration_was_judged_stays(empty: Workspace) -> None:
    done(empty, "write_plan", plan=data_of(BLOCKS))
    folder = empty.run.add(RIGID)
    (folder / "verdict.json").write_text("{}")
    before = (empty.run.path / "plan.json").read_text()
    assert "iteration 01 was judged by the plan" in refused(empty, "write_plan", plan=data_of("A ball falls."))
    assert (empty.run.path / "plan.json").read_text() == before


def test_each_text_is_a_new_iteration_and_a_patch_leaves_its_difference(empty: Workspace) -> None:
    assert "iterations/01/program.py" in done(empty, "write_program", text=RIGID)
    text = done(
        empty,
        "patch_program",
        edits=[
            {"search": "density=1000.0", "replace": "density=500.0"},
            {"search": "duration=1.0", "replace": "duration=2.0"},
        ],
    )
    assert text.startswith("iterations/02/program.py written")
    assert "+    scene.simulation(duration=2.0, frame_rate=20.0)" in text
    folders = sorted(path.name for path in (empty.run.path / "iterations").iterdir())
    assert folders == ["01", "02"]
    second = empty.run.path / "iterations" / "02"
    assert (empty.run.path / "iterations" / "01" / "program.py").read_text() == RIGID
    patched = RIGID.replace("density=1000.0", "density=500.0").replace("duration=1.0", "duration=2.0")
    assert (second / "program.py").read_text() == patched
    changed = (second / "patch.diff").read_text().splitlines()
    assert changed[:2] == ["--- program.py", "+++ program.py"]
    assert sum(line.startswith("-") for line in changed) == sum(line.startswith("+") for line in changed) == 3


@pytest.mark.parametrize(
    ("edits", "said"),
    [
        ([{"search": 'scene.spere("ball", radius=0.1', "replace": "scene.box("}], "scene.sphere("),
        ([{"search": "0.0", "replace": "0.1"}], "edit"),
        ([{"search": "density=600.0", "replace": "density=600.0"}], ""),
        ([], "edits"),
        ([{"search": "", "replace": "x"}], "edits.0.search"),
        ([{"search": "scene.ground()", "replace": "scene.grund()"}], "ground"),
    ],
)
def test_a_patch_that_does_not_fit_changes_nothing(empty: Workspace, edits: list, said: str) -> None:
    done(empty, "write_program", text=RIGID)
    assert said in refused(empty, "patch_program", edits=edits)
    assert [path.name for path in (empty.run.path / "iterations").iterdir()] == ["01"]


def test_a_program_with_mistakes_is_kept_only_if_told_to(empty: Workspace) -> None:
    program = "def build(scene):\n    scene.grund()\n"
    text = refused(empty, "write_program", text=program)
    assert text.startswith("not written:\n1 problem:\n")
    assert "ground" in text
    assert not list((empty.run.path / "iterations").iterdir())
    assert "1 problem:" in done(empty, "write_program", text=program, anyway=True)
    assert refused(empty, "validate_program") == "\n".join(text.splitlines()[1:])
    assert done(empty, "validate_program", text=RIGID) == "no problems found"


def test_reading_a_program_by_pages(empty: Workspace) -> None:
    lines = ["def build(scene):", *(f"    scene.ground()  # {k}, and words to fill the line up" for k in range(200))]
    empty.run.add("\n".join(lines) + "\n")
    seen: list[str] = []
    first = 1
    while True:
        page = done(empty, "read_program", from_line=first).splitlines()
        more = page[-1].startswith("…")
        seen += [line[5:] for line in (page[:-1] if more else page)]
        if not more:
            break
        first = int(page[-1].rsplit("=", 1)[1])
    assert seen == lines
    assert done(empty, "read_program", from_line=3, to_line=4).splitlines() == [
        f"3  {lines[2]}",
        f"4  {lines[3]}",
    ]
    assert "beyond 201" in refused(empty, "read_program", from_line=900)


def test_the_catalogue(empty: Workspace) -> None:
    assert done(empty, "search_catalogue", words="coffee cup").splitlines()[1].startswith("mug  ")
    text = done(empty, "show_asset", id="mug")
    for word in ("0.3334 kg", "licence Apache-2.0", "handle", "hollow"):
        assert word in text
    assert "did you mean 'mug'?" in refused(empty, "show_asset", id="mugg")


def test_the_api_and_the_skills(empty: Workspace) -> None:
    assert "wsim.scene.Scene.joint_revolute" in done(empty, "search_api", words="hinge joint revolute")
    text = done(empty, "show_api", name="wsim.scene.Scene.box")
    assert text.startswith("wsim.scene.Scene.box(")
    assert "density" in text
    assert "Scene.cylinder" in refused(empty, "show_api", name="wsim.scene.Scene.cylnder")
    assert "floating-bodies" in done(empty, "search_skills")
    assert done(empty, "search_skills", words="a block floats in water").splitlines()[1].startswith("floating-bodies")
    section = done(empty, "show_skill", name="floating-bodies", section="Rules")
    assert section.startswith("## Rules")
    whole = done(empty, "show_skill", name="floating-bodies")
    assert "one section of: Rules" in whole.splitlines()[-1]
    assert "floating-bodies" in refused(empty, "show_skill", name="floating-body")
    assert "it has Rules" in refused(empty, "show_skill", name="floating-bodies", section="Sums")


def test_every_tool_describes_itself_and_what_it_takes() -> None:
    for name, tool in TOOLS.items():
        assert tool.name == name
        assert 20 < len(tool.description) < 200
        for field, about in tool.arguments.model_json_schema()["properties"].items():
            assert about.get("description"), f"{name}.{field}"


def test_answers_begin_at_the_runs_folder(empty: Workspace) -> None:
    (empty.run.path / "plan.json").write_text("{")
    text = refused(empty, "read_plan")
    assert "plan.json: not JSON" in text
    assert str(empty.run.path) not in text
    assert call_tool(empty, "read_plan").text == text


def test_side_folders_of_an_interrupted_write_are_no_iterations(empty: Workspace) -> None:
    left = empty.run.path / "iterations" / ".01.partial"
    left.mkdir()
    (left / "program.py").write_text("half")
    assert "write_program" in refused(empty, "read_program")
    done(empty, "write_program", text=RIGID)
    assert not left.exists()


def test_what_moves_an_arm_and_how_a_belt_runs_stand_in_the_plans_lines() -> None:
    arm = plan_lines(load(PLANS / "pick_and_place.json"))
    moved = 'arm is moved by schedule: joint "left_finger", target [0.03, 0.0, 0.0, 0.03], times [2.05, 2.45, 5.4, 5.8]'
    assert moved in arm
    belt = plan_lines(make_plan("A crate rides on a conveyor belt at 0.5 m/s."))
    assert any("surface m/s" in line for line in belt) and any("0.5, 0, 0" in line for line in belt)
