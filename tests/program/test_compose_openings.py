"""Taps and drains of a plan become calls, and the judge holds a world's against the plan's."""

import pytest
from pydantic import ValidationError

from wsim.plan.layout.lay_out import layout
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.program.sandbox import build
from wsim.program.validator import validate
from wsim.scene.describe import describe

WATER = {"name": "water", "density": 1000, "friction": 0, "color": [0.1, 0.3, 0.6]}


def plan(*openings, level=0.0, tank=(0.4, 0.4, 0.3)):
    objects = [
        {"name": "ground", "role": "terrain", "state": "static",
         "construction": {"kind": "proxy", "primitive": "ground", "size": []}},
        {"name": "bucket", "role": "container", "state": "static",
         "construction": {"kind": "proxy", "primitive": "tank", "size": tank},
         "topology": {"relation": [{"predicate": "PLACE-ON", "ref": "ground"}]}},
        {"name": "water", "role": "fluid", "state": "fluid", "material": WATER,
         "construction": {"kind": "proxy", "primitive": "fluid", "size": []},
         "topology": {"relation": [{"predicate": "PLACE-IN", "ref": "bucket"},
                                   {"predicate": "FREE-SURFACE-AT", "value": level}]}},
    ]  # fmt: skip
    return {"title": "t", "prompt": "A tap fills a bucket.", "objects": objects, "openings": list(openings),
            "simulation": {"duration": 2}}  # fmt: skip


def tap(**fields):
    return {"name": "tap", "kind": "tap", "fluid": "water", "at": "bucket", "offset": [0, 0, 0.05], "radius": 0.05,
            "rate": 0.004, "stop": 1.5} | fields  # fmt: skip


DRAIN = {"name": "hole", "kind": "drain", "fluid": "water", "at": "bucket", "radius": 0.06, "offset": [0.1, 0, 0]}


def test_a_tap_over_a_bucket_and_a_hole_in_its_floor_are_composed_where_they_are(tmp_path):
    laid = layout(Plan.model_validate(plan(tap(), DRAIN)))
    text = compose(laid)
    assert [str(problem) for problem in validate(text)] == []
    (tmp_path / "program.py").write_text(text)
    made = build(tmp_path / "program.py", tmp_path / "stage.usda")
    assert made.ok, made
    world = describe(tmp_path / "stage.usda")
    bucket = world.containers[0]
    floor = bucket.inner_center[2] - bucket.inner_size[2] / 2
    assert world.taps[0].position == pytest.approx((0.0, 0.0, floor + 0.3 + 0.05))
    assert (world.taps[0].rate, world.taps[0].stop, world.taps[0].radius) == (0.004, 1.5, 0.05)
    assert world.drains[0].position == pytest.approx((0.1, 0.0, floor))
    assert world.fluids[0].size[2] == 0.0
    assert world.fluids[0].spacing <= 0.1 / 4  # four particles across the narrowest mouth


@pytest.mark.parametrize(
    ("opening", "said"),
    [
        (tap(fluid="oil"), "openings.0.fluid: 'oil' is no fluid of the plan; it has water"),
        (tap(at="pail"), "openings.0.at: no object 'pail'"),
        (tap(at="ground"), "has no rim, top or floor of its own"),
        (tap(rate=None), "a tap needs a \"rate\""),
        (tap(size=[0.1, 0.1]), "give \"radius\""),
        (tap(stop=1.0, start=1.5), "must be after start"),
        (DRAIN | {"rate": 0.1}, "is of a tap"),
        (tap(name="bucket"), "'bucket' is taken by objects.1"),
        (DRAIN, "stands 0 m high and no tap pours it"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_said_with_its_path(opening, said):
    with pytest.raises(ValidationError, match=said):
        Plan.model_validate(plan(opening))


def test_a_plan_without_openings_is_written_as_it_always_was():
    assert "openings" not in Plan.model_validate(plan(level=0.1)).model_dump()
