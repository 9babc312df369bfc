"""A fluid of a plan that fills something of the catalogue: composed, built, and held to the plan by the judge."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from pydantic import ValidationError

from wsim.judge.checks.fluid import CheckPlanFluid
from wsim.judge.evidence.evidence import Evidence
from wsim.plan.cost import cost_of
from wsim.plan.drawing.silhouettes import scene_of
from wsim.plan.layout.lay_out import layout
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.scene import Scene
from wsim.scene.describe import describe


def plan(level=None, state="static", **registration):
    rows = [{"predicate": "PLACE-IN", "ref": "mug"}]
    rows += [{"predicate": "FREE-SURFACE-AT", "value": level}] if level is not None else []
    objects = [
        {"name": "ground", "role": "terrain", "state": "static",
         "construction": {"kind": "proxy", "primitive": "ground", "size": []}},
        {"name": "table", "role": "background", "state": "static",
         "construction": {"kind": "asset", "asset": "table"},
         "topology": {"relation": [{"predicate": "PLACE-ON-BASE"}]}},
        {"name": "mug", "role": "background" if state == "static" else "rigid_body", "state": state,
         "construction": {"kind": "asset", "asset": "mug"},
         "topology": {"relation": [{"predicate": "PLACE-ON", "ref": "table"}]}},
        {"name": "coffee", "role": "fluid", "state": "fluid", "material": {"name": "coffee", "density": 1003},
         "construction": {"kind": "proxy", "primitive": "fluid", "size": []}, "topology": {"relation": rows},
         "registration": {"viscosity": 0.001, **registration}},
    ]  # fmt: skip
    return {"title": "t", "prompt": "A mug of coffee.", "objects": objects, "simulation": {"duration": 1}}


@lru_cache
def built(**amount):
    laid = layout(Plan.model_validate(plan(**amount)))
    text = compose(laid)
    assert [str(problem) for problem in validate(text)] == []
    scene, program = Scene(), {}
    exec(text, program)  # our own text
    program["build"](scene)
    with TemporaryDirectory() as folder:
        scene.save(f"{folder}/stage.usda")
        return laid, describe(Path(folder) / "stage.usda")


def test_a_mug_on_a_table_is_filled_as_high_as_the_plan_says():
    laid, world = built(level=0.045)
    [fluid] = world.fluids
    assert fluid.container == "/World/mug"
    assert fluid.size[2] == pytest.approx(0.045)
    assert fluid.center[2] - fluid.size[2] / 2 == pytest.approx(
        0.75 + 0.006, abs=1e-3
    )  # the table, and the mug's floor
    assert 1000 < cost_of(laid).fluid < 30_000
    assert "coffee" in [one.name for one in scene_of(laid).views["side"]]


def test_a_mug_is_filled_with_as_much_as_the_plan_says():
    _, world = built(volume=2e-4)
    assert world.fluids[0].amount == pytest.approx(2e-4, rel=0.01)


@pytest.mark.parametrize(
    ("made", "planned", "said"),
    [
        ({"level": 0.045}, {"level": 0.045}, None),
        ({"volume": 2e-4}, {"volume": 2e-4}, None),
        ({"level": 0.03}, {"level": 0.06}, "is filled to 0.03 m above the floor of /World/mug; the plan has 0.06 m"),
        ({"volume": 1e-4}, {"volume": 2e-4}, "m^3; the plan has 0.0002 m^3"),
    ],
)
def test_the_judge_holds_what_is_in_a_vessel_to_the_plan(pool, made, planned, said):
    world = built(**made)[1]
    laid = layout(Plan.model_validate(plan(**planned)))
    found = CheckPlanFluid().evaluate(Evidence(replace(pool().recording, world=world), laid))
    assert [each.passed for each in found] == [said is None]
    assert said is None or said in found[0].message


def test_the_judge_finds_a_fluid_in_another_vessel(pool):
    laid, world = built(level=0.045)
    moved = world.model_copy(update={"fluids": [world.fluids[0].model_copy(update={"container": "/World/table"})]})
    found = CheckPlanFluid().evaluate(Evidence(replace(pool().recording, world=moved), laid))
    assert "is in /World/table; the plan has it in /World/mug" in found[0].message


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "needs FREE-SURFACE-AT"),
        ({"level": 0.04, "volume": 1e-4}, "registration.volume: of a fluid that is PLACE-IN something, in place of"),
        ({"level": 0.0}, "only a tank can start empty"),
    ],
)
def test_what_cannot_be_is_said_with_its_path(given, said):
    with pytest.raises(ValidationError, match=said):
        Plan.model_validate(plan(**given))


def test_a_plan_without_a_volume_is_written_as_it_always_was():
    assert "volume" not in str(Plan.model_validate(plan(level=0.04)).model_dump())
