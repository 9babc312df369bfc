import json

import pytest
from pydantic import ValidationError

from wsim.errors import UserError
from wsim.plan import load, save
from wsim.plan.planner import plan
from wsim.plan.schema import Plan

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
    of(data, "steel_ball")["relations"][1]["predicate"] = "BACK-OF"
    (tmp_path / "plan.json").write_text(json.dumps(data))
    with pytest.raises(UserError, match=r"plan.json: .* overlap"):
        load(tmp_path / "plan.json")


def break_size(data):
    of(data, "steel_ball")["size"] = [0.1, 0.1]


def break_negative(data):
    of(data, "steel_ball")["size"] = [-0.1]


def break_name(data):
    of(data, "steel_ball")["name"] = "tank"


def break_ref(data):
    of(data, "steel_ball")["relations"][0]["ref"] = "lake"


def break_self(data):
    of(data, "steel_ball")["relations"][0]["ref"] = "steel_ball"


def break_objective(data):
    data["objectives"][0]["object"] = "whale"


def break_objective_ref(data):
    data["objectives"][0]["ref"] = None


def break_fluid(data):
    of(data, "water")["relations"] = []


def break_level(data):
    of(data, "water")["relations"] = [{"predicate": "PLACE-IN", "ref": "tank"}]


def break_predicate(data):
    of(data, "steel_ball")["relations"][0]["predicate"] = "NEAR"


def break_float_on_solid(data):
    of(data, "wooden_block_1")["relations"][0]["ref"] = "tank"


def break_role(data):
    of(data, "tank")["primitive"] = "box"


def break_state(data):
    of(data, "tank")["state"] = "dynamic"


def break_material(data):
    of(data, "steel_ball")["material"] = None


def break_typo(data):
    data["objectves"] = []


def break_value(data):
    of(data, "water")["relations"][1]["value"] = None


def break_camera(data):
    data["cameras"][0]["name"] = "steel_ball"


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (break_size, ["steel_ball", "(radius,)", "it has 2"]),
        (break_negative, ["size.0", "greater than 0"]),
        (break_name, ["'tank' is taken", "another name"]),
        (break_ref, ["relations.0.ref", "'lake'", "the plan has ground, tank"]),
        (break_self, ["cannot be placed by itself"]),
        (break_objective, ["objectives.0.object", "'whale'"]),
        (break_objective_ref, ["objectives.0.ref", '"floats" needs "ref"']),
        (break_fluid, ["water", "PLACE-IN", "or a size"]),
        (break_level, ["FREE-SURFACE-AT"]),
        (break_predicate, ["relations.0.predicate", "FLOATS-AT-SURFACE"]),
        (break_float_on_solid, ["needs a fluid; tank is a container"]),
        (break_role, ["primitive of a container is tank"]),
        (break_state, ["state of a container is static"]),
        (break_material, ['steel_ball: a dynamic body needs "material"']),
        (break_typo, ["objectves", "spelling"]),
        (break_value, ['FREE-SURFACE-AT needs "value"']),
        (break_camera, ["cameras.0.name", "name of an object"]),
    ],
)
def test_each_mistake_is_refused_where_it_is(tmp_path, data, spoil, words):
    spoil(data)
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(data))
    with pytest.raises(UserError) as caught:
        load(path)
    message = str(caught.value)
    assert message.startswith(str(path)) and "\n" not in message
    for word in words:
        assert word in message


def test_files_that_are_no_plans_are_refused(tmp_path):
    with pytest.raises(UserError, match="cannot be read"):
        load(tmp_path / "none.json")
    (tmp_path / "a.json").write_text('{"title": ')
    with pytest.raises(UserError, match=r"not JSON: .* line 1"):
        load(tmp_path / "a.json")


def test_numbers_must_be_finite(data):
    of(data, "steel_ball")["velocity"] = [0.0, 0.0, float("nan")]
    with pytest.raises(ValidationError):
        Plan.model_validate(data)
