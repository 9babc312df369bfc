"""A model's plan: its shorthand, its sentences, and what is sent back."""

from __future__ import annotations

import json
import re
from hashlib import sha256
from typing import Any, get_args

import pytest

from tests.agents.flies import BALL, CAMERA, CLAUSES, GROUND, MOVES, PROMPT, answer
from tests.agents.scripted import Server, text
from wsim.agents.ask import RETRIES, Desk
from wsim.agents.chapters import planner_prompt
from wsim.agents.failures import ModelError
from wsim.agents.planner import HINTS, plan_with, read_plan
from wsim.agents.shorthand import written_out
from wsim.errors import UserError
from wsim.plan.asked.covered import gaps, not_checked
from wsim.plan.schema import Plan
from wsim.plan.schema.constructions import Construction
from wsim.plan.schema.examples import EXAMPLES
from wsim.plan.schema.objects import ROLE_PRIMITIVES
from wsim.program.compose import compose
from wsim.scene.vehicle_spec import preset, presets
from wsim.tools.plan import plan_lines

PICTURE = b"\xff\xd8\xff\xe0 a picture"
SENTENCE = "finally (reaches(ball, (0, 0, 1.2), within 10 cm))"


def with_ball(**change: Any) -> dict[str, Any]:
    ball = {key: value for key, value in {**BALL, **change}.items() if value is not None}
    return answer(objects=[GROUND, ball])


def ball_of(plan: Plan) -> Any:
    return next(item for item in plan.objects if item.name == "ball")


def test_shorthand_is_written_out() -> None:
    plan = read_plan(answer(), PROMPT)
    ball = ball_of(plan)
    assert (ball.construction.kind, ball.primitive, ball.size) == ("proxy", "sphere", (0.1,))
    assert ball.pose.position == (0.0, 0.0, 2.0)
    assert plan.prompt == PROMPT
    turned = ball_of(read_plan(with_ball(rotation_deg=[0, 0, 30]), PROMPT))
    assert turned.pose.rotation_deg == (0.0, 0.0, 30.0)


def test_all_written_out_is_the_same_plan() -> None:
    full = with_ball(
        primitive=None, size=None, position=None,
        construction={"kind": "proxy", "primitive": "sphere", "size": [0.1]}, pose={"position": [0, 0, 2]},
    )  # fmt: skip
    half = with_ball(primitive=None, size=None, construction={"primitive": "sphere", "size": [0.1]})
    assert read_plan(full, PROMPT) == read_plan(half, PROMPT) == read_plan(answer(), PROMPT)


def test_relations_become_places() -> None:
    plan = read_plan(with_ball(position=None, relations=[{"predicate": "SPAWNED-ABOVE", "value": 1.0}]), PROMPT)
    assert ball_of(plan).pose.position[2] > 1.0
    assert "scene.sphere(" in compose(plan)


def test_an_asset_is_taken_by_its_id() -> None:
    from wsim.assets import search

    (hit, *_) = search("wooden crate", 1)
    item = {"name": "box", "role": "rigid_body", "asset": hit.asset.id, "state": "dynamic", "position": [0, 0, 2]}
    plan = read_plan(
        answer(objects=[GROUND, item], objectives=[{"kind": "moves", "object": "box", "value": 0.5}], clauses=None),
        PROMPT,
    )
    assert plan.objects[1].construction.kind == "asset"


def test_a_sentence_becomes_a_formula() -> None:
    plan = read_plan(answer(objectives=[{"kind": "formula", "object": "ball", "sentence": SENTENCE}]), PROMPT)
    (objective,) = plan.objectives
    assert objective.formula is not None
    assert objective.sentence == SENTENCE


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no objects": (answer(objects=None), "objects"),
    "objects that are none": (answer(objects=[3]), r"objects\.0"),
    "an unknown field": (with_ball(colour="red"), r"objects\.1\.colour"),
    "a size that is none": (with_ball(size=[-0.1]), r"objects\.1\.construction"),
    "a number that is none": (with_ball(position=[0, 0, float("nan")]), r"objects\.1\.pose\.position"),
    "an unknown primitive": (with_ball(primitive="teapot"), r"objects\.1\.construction"),
    "an unknown asset": (
        with_ball(primitive=None, size=None, material=None, velocity=None, asset="unicorn_12"), "unicorn_12",
    ),
    "an unknown object": (answer(objectives=[{**MOVES, "object": "bal"}]), "bal"),
    "no objective": (answer(objectives=[]), "objectives: none"),
    "a sentence that is none": (
        answer(objectives=[{"kind": "formula", "object": "ball", "sentence": "the ball is happy"}]),
        r"objectives\.0\.sentence",
    ),
    "a formula without a sentence": (answer(objectives=[{"kind": "formula", "object": "ball"}]), r"objectives\.0"),
    "objectives that are none": (answer(objectives={"kind": "moves"}), "objectives"),
    "a place that is none": (
        with_ball(position=None, relations=[{"predicate": "PLACE-ON", "ref": "table"}]), "table",
    ),
    "places that go in a circle": (
        with_ball(position=None, relations=[{"predicate": "PLACE-ON", "ref": "ball"}]), "ball",
    ),
    "one name twice": (answer(objects=[GROUND, BALL, BALL]), "ball"),
    "what no program can build": (answer(cameras=[{"name": "ball", "eye": [0, -4, 1], "target": [0, 0, 1]}]), "ball"),
    "no time": (answer(simulation={"duration": 0}), r"simulation\.duration"),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_said_with_its_place(what: str) -> None:
    given, message = WRONG[what]
    with pytest.raises(UserError, match=message) as caught:
        read_plan(given, PROMPT)
    assert len(str(caught.value)) < 1000


def test_what_is_wrong_goes_back_then_there_is_a_plan(server: Server, desk: Desk) -> None:
    given = [WRONG[what][0] for what in ("a size that is none", "a place that is none", "a sentence that is none")]
    server.script["planner"] = [text("Gladly!"), *[text(json.dumps(one)) for one in given]]
    server.script["planner"].append(text(f"```json\n{json.dumps(answer())}\n```"))
    assert plan_with(desk, PROMPT) == read_plan(answer(), PROMPT)
    asked = server.asked("planner")
    assert len(asked) == 5
    for request, part in zip(
        asked, (PROMPT, "no JSON object", "objects.1.construction", "table", "objectives.0.sentence"), strict=True
    ):
        assert part in request
    assert desk.ledger.account("planner").requests == 5


SLID = "A ball slides gently at 1.5 m/s and hits a wall."


@pytest.mark.parametrize(
    ("clauses", "told"),
    [
        (None, "clauses: none; tie the words of the prompt to what shows them: 'slides', '1.5 m/s', 'hits'"),
        ([{"words": "slides gently at 1.5 m/s", "by": [0]}], "'1.5 m/s': no objective that is named for it has this"),
        ([{"words": "slides at 1.5 m/s", "by": [0, "ball"]}], "'slides at 1.5 m/s' is not in the prompt as it stands"),
        ([{"words": "slides gently at 1.5 m/s", "by": [0, "ball"]}], "'hits': no clause has it"),
    ],
)
def test_what_no_clause_ties_goes_back_once(server: Server, desk: Desk, clauses: Any, told: str) -> None:
    server.forever["planner"] = text(json.dumps(answer(clauses=clauses)))
    plan = plan_with(desk, SLID)
    first, second = server.asked("planner")
    assert told not in first
    assert told in second
    assert [gap.demand.text for gap in gaps(plan) if gap.demand.text == "hits"] == ["hits"]  # and is shown


def test_a_sound_plan_is_kept_where_clauses_are_all_that_it_lacks(server: Server, desk: Desk) -> None:
    server.script["planner"] = [text(json.dumps(answer(clauses=None)))]
    server.forever["planner"] = text("What clauses?")
    plan = plan_with(desk, PROMPT)
    assert [(clause.words, clause.by) for clause in plan.clauses] == [("flies", [0]), ("half a metre", [0])]


HIT = {"kind": "formula", "object": "ball", "sentence": "collides_with(ball, ground)"}


@pytest.mark.parametrize(
    ("more", "by"),
    [
        ({"clauses": [{"words": "hits", "by": [1]}], "objectives": [HIT]}, [1]),
        ({"clauses": [{"words": "hits", "by": [7]}]}, None),  # of no objective there is: asked again, in vain
        (answer(clauses=[*CLAUSES, {"words": "hits", "by": [1]}], objectives=[MOVES, HIT]), [1]),  # all of it again
    ],
)
def test_clauses_that_lack_are_asked_for_by_themselves(
    server: Server, desk: Desk, more: Any, by: list[int] | None
) -> None:
    prompt = f"{PROMPT.rstrip('.')} and hits the ground."
    server.script["planner"] = [text(json.dumps(answer(clauses=CLAUSES)))]
    server.forever["planner"] = text(json.dumps(more))
    plan = plan_with(desk, prompt)
    assert [clause.by for clause in plan.clauses if clause.words == "hits"] == ([] if by is None else [by])
    assert [clause.words for clause in plan.clauses[: len(CLAUSES)]] == ["A thrown ball", "flies half a metre"]
    first, second = server.asked("planner")[:2]
    assert "'hits': no clause has it" in second and "0 moves ball" in second and "objects: ground, ball" in second
    assert len(second) < 0.25 * len(first)


SHATTERS = "A thrown ball flies half a metre and shatters."
WHY = "a ball that shatters: bodies are rigid"
CANNOT = json.dumps({"cannot": WHY, "nearest": answer()})


def test_what_cannot_be_simulated_has_the_nearest_world(server: Server, desk: Desk) -> None:
    """A plan that passes it over is sent back with the way out."""
    tied = [*CLAUSES[:1], {"words": "flies half a metre and shatters", "by": [0]}]
    server.script["planner"] = [text(json.dumps(answer(clauses=tied))), text(CANNOT)]
    plan = plan_with(desk, SHATTERS)
    assert plan.stands_in_for == WHY
    assert not_checked(plan) == ["'shatters': the world stands in for it"]
    told = server.asked("planner")[1]
    assert "'shatters': wsim has rigid bodies and water, and nothing in it can shatter" in told
    assert 'where that is the point, answer {"cannot": what and why, "nearest"' in told


def test_where_nothing_comes_near_there_is_no_plan(server: Server, desk: Desk) -> None:
    server.script["planner"] = [text(json.dumps({"cannot": WHY, "nearest": None}))]
    with pytest.raises(ModelError, match="the planner's model: cannot: a ball that shatters"):
        plan_with(desk, SHATTERS)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"cannot": "", "nearest": None}, "say what cannot be simulated"),
        ({"cannot": WHY, "nearest": "a cube"}, "nearest: it is a whole plan, or null"),
        ({"cannot": WHY, "nearest": answer(objectives=[])}, "objectives: none"),
    ],
)
def test_a_refusal_says_what_and_why(server: Server, desk: Desk, given: Any, message: str) -> None:
    server.script["planner"] = [text(json.dumps(given)), text(CANNOT)]
    plan_with(desk, SHATTERS)
    assert message in server.asked("planner")[1]


def test_the_catalogue_and_the_picture_go_with_the_prompt(server: Server, desk: Desk) -> None:
    server.script["planner"] = [text(json.dumps(answer(clauses=[{"words": "falls", "by": [0]}])))]
    plan_with(desk, "A wooden crate falls.", [PICTURE], "reference.jpg")
    (request,) = server.asked("planner")
    assert "Assets of the catalogue that may fit:" in request
    assert "A reference picture is attached (reference.jpg)" in request
    parts = server.requests[0]["messages"][1]["content"]
    assert [part["type"] for part in parts] == ["text", "image_url"]
    assert parts[1]["image_url"]["url"].startswith("data:image/jpeg;base64,")


def test_hints_written_as_the_request_asks_are_taken(server: Server, desk: Desk) -> None:
    """The form that the request shows, filled in as it stands there."""
    server.script["planner"] = [text(json.dumps(answer(**json.loads(re.sub(r"\bstr\b", '"a ball"', HINTS)))))]
    plan = plan_with(desk, PROMPT, [PICTURE], "reference.jpg")
    assert plan.image is not None
    assert set(plan.image.hints.model_dump()) == plan.image.hints.model_fields_set  # the form leaves none out
    assert plan.image.hints.visible_objects == ["a ball"]
    assert (plan.image.path, plan.image.sha256) == ("reference.jpg", sha256(PICTURE).hexdigest())
    assert f"fill image.hints from it: {HINTS}" in server.asked("planner")[0]
    assert "picture reference.jpg: " in "\n".join(plan_lines(plan))


def test_a_picture_that_nobody_gave_is_refused() -> None:
    with pytest.raises(UserError, match=r"image\.path"):
        read_plan(answer(image={"hints": {}}), PROMPT)
    with pytest.raises(UserError, match=r"image\.hints\.colour"):
        read_plan(answer(image={"hints": {"colour": "red"}}), PROMPT, {"path": "reference.jpg"})


def test_a_planner_that_gives_none_is_a_model_error(server: Server, desk: Desk) -> None:
    server.forever["planner"] = text(json.dumps(WRONG["no objective"][0]))
    with pytest.raises(ModelError) as caught:
        plan_with(desk, PROMPT)
    assert caught.value.kind == "unusable"
    assert "objectives: none" in str(caught.value)
    assert len(server.requests) == RETRIES + 1


def constructions() -> list[Any]:
    """Every model that a construction may be, as the schema has it."""

    def models(annotation: Any) -> list[Any]:
        return [annotation] if isinstance(annotation, type) else [m for a in get_args(annotation) for m in models(a)]

    return [model for model in models(Construction) if hasattr(model, "model_fields")]


def test_the_prompt_names_every_construction_and_role_with_their_fields() -> None:
    told = planner_prompt()
    assert {model.model_fields["kind"].default for model in constructions()} == {*EXAMPLES}
    assert all(f'"{role}"' in told for role in ROLE_PRIMITIVES)
    assert not re.search(r"\{[A-Z]+\}", told)
    for model in constructions():
        kind = model.model_fields["kind"].default
        (line,) = [line for line in told.splitlines() if line.startswith(f"- {kind}: ")]
        assert all(name in line for name in model.model_fields if name != "kind")
        assert json.dumps(EXAMPLES[kind], separators=(",", ":")) in told
    assert all(f"{kind} {preset(kind).length:g} x " in told for kind in presets())


def test_the_examples_of_the_prompt_are_a_plan_that_a_program_builds() -> None:
    goal = "finally (reaches(truck, (20, 0, 0), within 3 m))"
    told = {"title": "all", "objects": list(EXAMPLES.values()), "cameras": [CAMERA],
            "objectives": [{"kind": "formula", "object": "truck", "sentence": goal}],
            "simulation": {"duration": 14}}  # fmt: skip
    plan = read_plan(json.loads(json.dumps(told)), "A truck drives over a hill.")
    assert [item.construction.kind for item in plan.objects] == [*EXAMPLES]
    text = compose(plan)
    assert all(call in text for call in ("scene.vehicle(", "scene.terrain(", "scene.scatter(", "scene.robot("))


def test_a_model_is_told_of_the_robots_that_there_are(server: Server, desk: Desk) -> None:
    server.script["planner"] = [text(json.dumps(answer()))]
    plan_with(desk, PROMPT)
    assert re.search(r"Robots: .*desk_arm; .*go2, [\d. x]+ m, policies go2_walk", server.asked("planner")[0])


def test_a_clause_may_name_a_joint_by_the_body_that_it_moves() -> None:
    joints = [{"name": "axle", "kind": "hinge", "child": "drum"}]
    clauses = [{"words": "turns", "by": ["drum.drive", "drum.mass", 0, "post.drive"]}]
    assert written_out({"joints": joints, "clauses": clauses})["clauses"] == [
        {"words": "turns", "by": ["axle.drive", "drum.mass", 0, "post.drive"]}
    ]
