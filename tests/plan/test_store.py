"""Plans on disk: what is written comes back, and what is no plan is refused in a line."""

import json
from pathlib import Path

import pytest

from wsim.agents.shorthand import written_out
from wsim.errors import UserError
from wsim.plan import load, save
from wsim.plan.store import made
from wsim.rules.planner import plan

PROMPT = "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks."


@pytest.fixture
def data() -> dict:
    return plan(PROMPT).model_dump(mode="json")


def of(data: dict, name: str) -> dict:
    return next(item for item in data["objects"] if item["name"] == name)


def test_a_plan_survives_its_file(tmp_path):
    floats = plan(PROMPT)
    save(floats, tmp_path / "plan.json")
    assert load(tmp_path / "plan.json") == floats
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]


def test_a_plan_without_poses_is_laid_out(tmp_path, data):
    for item in data["objects"]:
        item["pose"] = None
    (tmp_path / "plan.json").write_text(json.dumps(data))
    assert load(tmp_path / "plan.json") == plan(PROMPT)
    of(data, "steel_ball")["topology"]["relation"].append({"predicate": "BACK-OF", "ref": "wooden_block_2", "gap": 0.1})
    (tmp_path / "plan.json").write_text(json.dumps(data))
    with pytest.raises(UserError, match=r"plan.json: .*steel_ball BACK-OF"):
        load(tmp_path / "plan.json")


def test_a_plan_with_poses_keeps_them_and_its_views_are_worked_out(tmp_path, data):
    of(data, "steel_ball")["pose"]["position"][0] += 0.01
    data["cameras"] = [{"name": "side", "view": "side_minus_y"}]
    (tmp_path / "plan.json").write_text(json.dumps(data))
    loaded = load(tmp_path / "plan.json")
    assert loaded.object("steel_ball").pose.position == tuple(of(data, "steel_ball")["pose"]["position"])
    assert loaded.cameras[0].eye[1] < -1.0


def test_files_that_are_no_plans_are_refused(tmp_path):
    with pytest.raises(UserError, match="cannot be read"):
        load(tmp_path / "none.json")
    (tmp_path / "a.json").write_text('{"title": ')
    with pytest.raises(UserError, match=r"not JSON: .* line 1"):
        load(tmp_path / "a.json")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[" * 100_000, "nested too deep"),
        ('{"title": 1, "title": 2}', "'title' is given twice"),
        ("1" * 5000, "a number of 5000 digits"),
        ('{"title": NaN}', "NaN is no number"),
        ("[]", "it must be an object, {...}"),
    ],
)
def test_json_that_is_no_plan_is_refused(tmp_path, text, words):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(UserError) as caught:
        load(tmp_path / "a.json")
    assert words in str(caught.value)


def test_a_file_beyond_the_limit_or_in_another_encoding_is_refused(tmp_path, data):
    (tmp_path / "a.json").write_text(" " * 20_000_001)
    with pytest.raises(UserError, match=r"larger than 20 MB"):
        load(tmp_path / "a.json")
    (tmp_path / "a.json").write_text(json.dumps(data), encoding="utf-16")
    with pytest.raises(UserError, match="not UTF-8"):
        load(tmp_path / "a.json")
    (tmp_path / "a.json").write_text(json.dumps(data), encoding="utf-8-sig")
    assert load(tmp_path / "a.json") == plan(PROMPT)


def test_a_message_is_one_short_line_whatever_the_file_holds(tmp_path, data):
    data |= {"a\nb" * 100_000: 1} | {f"field_{k}": 1 for k in range(100)}
    (tmp_path / "a.json").write_text(json.dumps(data))
    with pytest.raises(UserError) as caught:
        load(tmp_path / "a.json")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 3000
    assert "and 81 more" in str(caught.value)


def test_places_that_add_up_beyond_the_world_are_refused(tmp_path):
    box = {
        "role": "background",
        "state": "static",
        "construction": {"kind": "proxy", "primitive": "box", "size": [1, 1, 1]},
    }
    rows = [[], *([{"predicate": "FRONT-OF", "ref": f"b{k}", "gap": 9e5}] for k in range(5))]
    objects = [{**box, "name": f"b{k}", "topology": {"relation": row}} for k, row in enumerate(rows)]
    (tmp_path / "a.json").write_text(json.dumps({"title": "far", "prompt": "", "objects": objects}))
    with pytest.raises(UserError, match=r"a\.json: laid out, it is no plan: position"):
        load(tmp_path / "a.json")


def test_a_block_of_water_behind_a_gate_that_has_its_place_is_laid_out() -> None:
    """The tank and the gate say where they are, and the water only what it is beside."""
    tank = {"name": "tank", "role": "container", "primitive": "tank", "size": [1.6, 0.24, 0.6], "state": "static"}
    gate = {"name": "gate", "role": "mechanism", "primitive": "box", "size": [0.04, 0.236, 0.44], "state": "kinematic"}
    inside = [{"predicate": "PLACE-IN", "ref": "tank"}, {"predicate": "BACK-OF", "ref": "gate", "gap": 0.01}]
    water = {
        "name": "water", "role": "fluid", "primitive": "fluid", "size": [0.4, 0.24, 0.3], "state": "fluid",
        "relations": inside,
    }  # fmt: skip
    objects = [tank | {"position": [0, 0, 0]}, gate | {"position": [-0.37, 0, 0.242]}, water]
    dam = made(written_out({"title": "A dam", "prompt": "Water behind a gate.", "objects": objects}), Path("plan"))
    pose = dam.objects[-1].pose
    assert pose is not None and pose.position == pytest.approx((-0.6, 0.0, 0.17), abs=1e-6)


def test_a_level_may_name_the_container_once_more() -> None:
    rows = [{"predicate": "PLACE-IN", "ref": "tank"}, {"predicate": "FREE-SURFACE-AT", "ref": "tank", "value": 0.3}]
    full = written_out({"objects": [{"name": "water", "primitive": "fluid", "relations": rows}]})
    assert full["objects"][0]["topology"]["relation"] == [rows[0], {"predicate": "FREE-SURFACE-AT", "value": 0.3}]
    other = written_out({"objects": [{"name": "water", "primitive": "fluid", "relations": rows[1:]}]})
    assert other["objects"][0]["topology"]["relation"] == rows[1:]  # of a container that it is not in: not ours to mend
