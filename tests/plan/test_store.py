"""Plans on disk: what is written comes back, and what is no plan is refused in a line."""

import json

import pytest

from wsim.errors import UserError
from wsim.plan import load, save
from wsim.rules.planner import plan

PROMPT = "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks."


@pytest.fixture
def data() -> dict:
    return plan(PROMPT).model_dump(mode="json")


def of(data: dict, name: str) -> dict:
    return next(item for item in data["objects"] if item["name"] == name)


def test_a_plan_survives_its_file(tmp_path):
    made = plan(PROMPT)
    save(made, tmp_path / "plan.json")
    assert load(tmp_path / "plan.json") == made
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
