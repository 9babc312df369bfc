"""A fluid's spacing: the same in what a plan is said to cost, and in the program that is written from it."""

import re

import pytest

from wsim.plan.cost import cost_of
from wsim.plan.schema import Material, Plan, PlanObject, Pose, Registration, SimulationPlan
from wsim.plan.spacing import ACROSS, spacing_of
from wsim.program.compose import compose


def puddle(*edges: float, own: float | None = None, common: float = 0.0) -> Plan:
    water = PlanObject.proxy(
        name="water", role="fluid", primitive="fluid", size=edges, state="fluid",
        material=Material(name="water", density=1000.0), pose=Pose(position=(0.0, 0.0, 1.0)),
        registration=Registration(spacing=own),
    )  # fmt: skip
    return Plan(title="A puddle", prompt="", objects=[water], simulation=SimulationPlan(spacing=common))


@pytest.mark.parametrize(
    ("plan", "spacing"),
    [
        (puddle(1.0, 0.5, 0.4, own=0.02, common=0.05), 0.02),  # its own comes before the plan's
        (puddle(1.0, 0.5, 0.4, common=0.05), 0.05),
        (puddle(1.0, 1.0, 1.0), 0.05),
        (puddle(2.0, 2.0, 0.1), 0.1 / ACROSS),  # flat: a few across, though there are then more than 8000
    ],
    ids=["its own", "the plan's", "left open", "flat"],
)
def test_cost_counts_the_particles_that_the_program_has(plan: Plan, spacing: float) -> None:
    (water,) = plan.objects
    assert spacing_of(plan, water, water.size) == pytest.approx(spacing)
    assert re.findall(r"spacing=([\d.]+)", compose(plan)) == [f"{spacing:g}"]
    x, y, z = water.size
    assert cost_of(plan).fluid == round(x * y * z / spacing**3)
