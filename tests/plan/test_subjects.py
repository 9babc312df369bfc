"""What a plan asks something of."""

from tests.agents.flies import BALL, GROUND, flies
from wsim.plan.subjects import asked_about
from wsim.program.compose import compose


def test_the_objects_of_objectives_in_their_order_and_not_the_ground() -> None:
    other = {**BALL, "name": "other", "position": [3.0, 0.0, 2.0]}
    plan = flies(objects=[GROUND, other, BALL])
    assert asked_about(plan) == ["ball"]
    objectives = [
        {"kind": "rests_on", "object": "other", "ref": "ground"},
        {"kind": "collides_with", "object": "ball", "ref": "other"},
    ]
    assert asked_about(flies(objects=[GROUND, other, BALL], objectives=objectives)) == ["other", "ball"]


def test_a_camera_with_the_prompts_words_is_fixed_in_the_program() -> None:
    camera = {"name": "side", "eye": [0, -4, 1.5], "target": [0, 0, 1.2]}
    assert "fixed" not in compose(flies(cameras=[camera]))
    asked = flies(cameras=[{**camera, "words": "seen from the side"}])
    assert "fixed=True" in compose(asked)
    assert "words" not in flies(cameras=[camera]).model_dump()["cameras"][0]
