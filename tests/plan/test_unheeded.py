"""What a plan asks for in vain is said."""

from pathlib import Path

from wsim.plan import load
from wsim.plan.schema import Outputs
from wsim.plan.unheeded import unheeded
from wsim.rules.planner import plan
from wsim.tools.plan import plan_lines

VEHICLE = Path(__file__).parents[2] / "examples" / "plans" / "offroad_vehicle.json"


def test_a_plan_that_asks_for_no_more_than_is_done_is_told_nothing() -> None:
    assert unheeded(plan("A ball falls on the ground.")) == []


def test_each_thing_that_nothing_does_is_named() -> None:
    made = load(VEHICLE)
    quiet = made.model_copy(
        update={
            "outputs": Outputs(video=False, stills=["side"]),
            "simulation": made.simulation.model_copy(update={"device": "cuda:1"}),
        }
    )
    found = unheeded(quiet)
    assert [line.split(":")[0] for line in found] == [
        "sensor imu", "sensor gps", "outputs.video", "outputs.stills", "simulation.device",
    ]  # fmt: skip
    assert [line for line in plan_lines(quiet) if line.startswith("not done: ")] == [f"not done: {x}" for x in found]
