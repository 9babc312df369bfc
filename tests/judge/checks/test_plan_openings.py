"""A world's taps and drains are the plan's: where, how wide, how much and how long."""

from dataclasses import replace

import pytest

from tests.program.test_compose_openings import DRAIN, plan, tap
from wsim.judge.checks.plan_openings import CheckPlanOpenings
from wsim.judge.evidence.evidence import Evidence
from wsim.plan.layout import layout
from wsim.plan.schema import Plan
from wsim.scene.world_openings import Drain, Tap

FLOOR = 0.02
POURS = Tap(prim="/World/tap", fluid="/World/water", position=(0.0, 0.0, 0.37), radius=0.05, rate=0.004, stop=1.5)
HOLE = Drain(prim="/World/hole", fluid="/World/water", position=(0.1, 0.0, FLOOR), radius=0.06)


@pytest.fixture
def said(pool):
    def of(taps, drains):
        recorded = pool().recording
        world = recorded.world.model_copy(update={"taps": taps, "drains": drains})
        planned = layout(Plan.model_validate(plan(tap(), DRAIN)))
        return CheckPlanOpenings().evaluate(Evidence(replace(recorded, world=world), planned))

    return of


def test_a_world_with_the_plans_openings_passes(said):
    assert [finding.passed for finding in said([POURS], [HOLE])] == [True]


@pytest.mark.parametrize(
    ("taps", "drains", "message"),
    [
        ([POURS.model_copy(update={"rate": 0.006})], [HOLE], "has rate 0.006 m^3/s; the plan has 0.004"),
        ([POURS.model_copy(update={"position": (0.1, 0.0, 0.37)})], [HOLE], "is 0.1 m from its place"),
        ([POURS.model_copy(update={"stop": None})], [HOLE], "has stop 2 s; the plan has 1.5"),
        ([POURS], [], "The plan has a drain /World/hole; the world does not"),
        ([POURS, POURS.model_copy(update={"prim": "/World/leak"})], [HOLE], "the plan has no such opening"),
        ([POURS], [HOLE.model_copy(update={"radius": 0.09})], "has area"),
    ],
)
def test_what_differs_from_the_plan_is_found(said, taps, drains, message):
    found = said(taps, drains)
    assert len(found) == 1
    assert not found[0].passed
    assert message in found[0].message
    assert found[0].target is not None
