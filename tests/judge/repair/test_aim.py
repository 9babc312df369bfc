"""Repair targets: what to change, in which direction, and how far where physics gives a number."""

import math

import numpy as np
import pytest

from wsim.judge import judge
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import parse
from wsim.judge.language.measure import MENDERS
from wsim.judge.repair.aim import STAGES, aim
from wsim.judge.repair.rule import tried
from wsim.judge.verdict import Finding, RepairTarget, Verdict
from wsim.plan.schema import Objective, Registration
from wsim.plan.schema.formula import VOCABULARY, Ordered
from wsim.scene.world import Joint, Shape, Static

BLOCK, BALL, TANK, WATER = "/World/wooden_block", "/World/steel_ball", "/World/tank", "/World/water"
STEP = 1e-3


def target(verdict: Verdict, check: str, prim: str | None = None) -> RepairTarget:
    finding = next(f for f in verdict.failures if f.check == check and prim in (None, f.prim))
    assert finding.target is not None
    return finding.target


def aimed(case, finding: Finding) -> RepairTarget:
    aim([finding], Evidence(case.recording, case.plan))
    assert finding.target is not None
    return finding.target


def failed(check: str, prim: str | None = None, **numbers) -> Finding:
    return Finding(check=check, passed=False, message="", prim=prim, **numbers)


@pytest.fixture
def water(pool):
    """A recording that tells its time step and its speed of sound."""
    return pool().changed(metadata={"time_step": STEP, "speed_of_sound": 20.0})


def mended(case, said: str, prim: str, **numbers) -> RepairTarget:
    """The target of a finding that a predicate decides."""
    predicate = parse(said)
    finding = Finding(check="ObjectiveFormula", passed=False, message="", prim=prim, **numbers)
    return tried(MENDERS[type(predicate)](predicate, finding, Evidence(case.recording, case.plan)))


def test_every_predicate_has_a_rule():
    assert set(VOCABULARY.values()) - {*MENDERS} == {Ordered}


def test_passed_findings_have_no_target_and_failed_ones_all_do(pool):
    verdict = judge(pool().recording, pool().plan)
    assert all(finding.target is None for finding in verdict.findings)
    case = pool(density=2500.0, settle=False).edit("body_q", (slice(60, None), 1, 2), 0.05).log("ERROR", "diverged")
    verdict = judge(case.recording, case.plan)
    assert len(verdict.failures) > 3
    assert all((finding.target is None) == finding.passed for finding in verdict.findings)
    assert Verdict.model_validate_json(verdict.model_dump_json()) == verdict


def test_dense_wood_is_to_be_as_light_as_planned(pool):
    case = pool(density=2500.0)
    found = target(judge(case.recording, case.plan), "ObjectiveFloats")
    assert (found.kind, found.prim, found.parameter, found.direction) == (
        "physical parameter", BLOCK, "density", "lower",
    )  # fmt: skip
    assert found.current == pytest.approx(2500.0) and found.suggested == 600.0 and found.unit == "kg/m^3"
    assert found.sentence == f"lower density of {BLOCK} from 2500 to 600 kg/m^3"


@pytest.mark.parametrize("own", [{"density": 500.0}, {"mass": 500.0 * 0.2 * 0.2 * 0.14}])
def test_a_density_of_its_own_comes_before_the_materials(pool, own):
    case = pool(density=2500.0)
    case.plan.object(BLOCK.rsplit("/", 1)[-1]).registration = Registration(**own)
    found = target(judge(case.recording, case.plan), "ObjectiveFloats")
    assert found.suggested == pytest.approx(500.0)


def test_a_draft_off_by_the_density_or_by_the_spacing(pool):
    other = pool(density=800.0, lift=-0.028)
    found = target(judge(other.recording, other.plan), "ObjectiveFloats")
    assert (found.parameter, found.direction, found.suggested) == ("density", "lower", 600.0)
    # As dense as planned, and yet 20 % of its height too high: the error shrinks with the spacing.
    case = pool(lift=0.028)
    verdict = judge(case.recording, case.plan)
    finding = next(f for f in verdict.failures if f.check == "ObjectiveFloats")
    found = target(verdict, "ObjectiveFloats")
    share = abs(finding.limit - finding.expected) / abs(finding.value - finding.expected)
    assert (found.kind, found.parameter, found.direction) == ("resolution", "spacing", "lower")
    assert found.current == 0.03 and found.suggested == pytest.approx(0.03 * share) and share < 0.6


def test_a_light_ball_is_to_be_heavier(pool):
    case = pool().body(BALL, mass=0.5 * 1000.0 * 4 / 3 * math.pi * 0.06**3)
    case.plan = case.plan.model_copy(
        update={"objectives": [Objective(kind="submerged", object="steel_ball", ref="water")]}
    )
    case = case.edit("body_q", (slice(None), 1, 2), 0.35)  # it floats up
    found = target(judge(case.recording, case.plan), "ObjectiveSubmerged", BALL)
    assert (found.parameter, found.direction, found.suggested) == ("density", "raise", 7850.0)


def test_numbers_that_are_not_finite_ask_for_half_the_step(water):
    case = water.edit("body_q", (slice(45, None), 1, 2), np.nan)
    verdict = judge(case.recording, case.plan)
    for finding in verdict.failures:
        if finding.objective or finding.check == "CheckFinite":
            assert (finding.target.kind, finding.target.suggested) == ("time step", pytest.approx(STEP / 2))


def test_a_contact_that_gives_way_asks_for_a_step_that_is_as_much_shorter(water):
    case = water.edit("body_q", (slice(60, None), 1, 2), 0.02 + 0.06 - 0.01)
    found = target(judge(case.recording, case.plan), "CheckPenetration", BALL)
    assert (found.kind, found.direction) == ("time step", "lower")
    assert found.suggested == pytest.approx(STEP * 0.05 * 0.12 / 0.01, rel=1e-3)


def test_what_starts_inside_another_is_to_be_moved(water):
    case = water.edit("body_q", (slice(None), 1, 2), 0.02 + 0.06 - 0.03)
    found = target(judge(case.recording, case.plan), "CheckPenetration", BALL)
    assert (found.kind, found.prim, found.parameter) == ("settlement", BALL, "position")
    assert "0.03 m inside" in found.why


def test_what_falls_through_lacks_a_collision_shape_or_a_shorter_step(water):
    case = water.edit("body_q", (slice(60, None), 1, 2), -0.3)
    found = target(judge(case.recording, case.plan), "ObjectiveRestsOn", BALL)
    # It may cross half of the thinnest thing, the tank's floor, in a step.
    fastest = np.abs(case.recording.body_qd[:, 1, 2]).max()
    assert (found.kind, found.direction) == ("time step", "lower")
    assert found.suggested == pytest.approx(min(STEP / 2, 0.5 * 0.02 / fastest))
    ghost = [
        s.model_copy(update={"shapes": [x.model_copy(update={"collides": False}) for x in s.shapes]})
        for s in case.recording.world.statics
    ]
    case = case.world(statics=ghost)
    found = target(judge(case.recording, case.plan), "ObjectiveRestsOn", BALL)
    assert (found.kind, found.prim, found.parameter, found.direction) == ("geometry", TANK, "collision", "add")


def test_a_leak_through_a_thin_wall_and_a_splash_over_the_rim(water):
    track = water.recording.fluids[WATER]
    some = slice(None, track.position.shape[1] // 20)
    position = track.position.copy()
    position[50:, some, 2] = -0.2
    found = target(judge(water.water(position=position).recording, water.plan), "CheckFluidContained")
    assert (found.parameter, found.prim, found.current, found.suggested) == ("wall", TANK, 0.02, 0.03)
    position = track.position.copy()
    position[49, some, 2] = 0.02 + 0.7
    position[50:, some, 0] = 1.0
    found = target(judge(water.water(position=position).recording, water.plan), "CheckFluidContained")
    assert (found.parameter, found.prim, found.current) == ("inner_size.z", TANK, 0.45)
    assert found.suggested == pytest.approx(0.7 + 0.03, rel=1e-4)


def test_density_errors_go_as_the_square_of_the_speed_of_sound(water):
    density = water.recording.fluids[WATER].density * 1.08
    verdict = judge(water.water(density=density).recording, water.plan)
    value = next(f for f in verdict.failures if f.check == "CheckDensity").value
    found = target(verdict, "CheckDensity")
    assert (found.kind, found.parameter, found.direction, found.current) == ("fluid", "speed_of_sound", "raise", 20.0)
    assert found.suggested == pytest.approx(20.0 * math.sqrt(value / 0.02))


def test_what_dies_down_is_given_the_time_that_it_needs(water):
    """A speed of exp(-2 t) is at a limit after ln(1 / limit) / 2 seconds."""
    time = np.asarray(water.recording.time)
    case = water.edit("body_qd", (slice(None), 0, 2), np.exp(-2.0 * time))
    value = math.sqrt(np.mean(np.exp(-4.0 * time[time >= 3.5])))
    limit = 1e-5
    found = aimed(case, failed("CheckSettled", BLOCK, value=value, limit=limit, unit="m/s"))
    assert (found.kind, found.parameter, found.direction, found.current) == ("settlement", "duration", "raise", 4.0)
    needed = math.log(1.0 / limit) / 2.0
    assert needed <= found.suggested < needed + 1.5
    steady = water.edit("body_qd", (slice(None), 0, 2), 0.3)
    found = aimed(steady, failed("CheckSettled", BLOCK, value=0.3, limit=limit, unit="m/s"))
    assert found.kind == "time step"


def test_objects_that_are_missing_or_extra(pool):
    case = pool()
    statics = case.recording.world.statics
    extra = case.world(statics=[*statics, statics[0].model_copy(update={"prim": "/World/shelf"})])
    found = target(judge(extra.recording, case.plan), "CheckPlanObjects")
    assert (found.kind, found.prim, found.direction) == ("extra object", "/World/shelf", "remove")
    fluid = case.world(fluids=[])
    found = target(judge(fluid.recording, case.plan), "CheckPlanObjects", WATER)
    assert (found.kind, found.direction) == ("missing object", "add")


def test_what_slides_off_a_slope_needs_friction_above_its_tangent(stack):
    case = stack()
    half = math.radians(30.0) / 2
    ramp = Shape(prim="/World/ramp/g", kind="box", size=(2, 1, 0.1), rotation=(0, math.sin(half), 0, math.cos(half)))
    bodies = case.recording.world.bodies
    slick = bodies[0].model_copy(update={"shapes": [bodies[0].shapes[0].model_copy(update={"friction": 0.2})]})
    case = case.world(bodies=[slick, *bodies[1:]], statics=[Static(prim="/World/ramp", shapes=[ramp])])
    found = mended(case, "stays_on(box_1, ramp)", slick.prim, unit="m")
    assert (found.parameter, found.direction, found.current) == ("friction", "raise", 0.2)
    assert found.suggested == pytest.approx(1.1 * math.tan(math.radians(30.0)))  # at the tangent itself it may slip


@pytest.mark.parametrize(
    ("given", "stands"),
    [
        ({"parameter": "duration", "direction": "raise", "current": 3.0, "suggested": 12.0}, True),
        ({"parameter": "duration", "direction": "raise", "current": 3.0, "suggested": 25_590.0}, False),
        ({"parameter": "time_step", "direction": "lower", "current": 1e-3, "suggested": 5e-4}, True),
        ({"parameter": "time_step", "direction": "lower", "current": 1e-3, "suggested": 2e-3}, False),
        ({"parameter": "time_step", "direction": "lower", "current": 1e-3, "suggested": 1e-9}, False),
        ({"parameter": "friction", "direction": "raise", "current": 0.5, "suggested": 4.0}, False),
        ({"parameter": "density", "direction": "lower", "current": 700.0, "suggested": 0.01}, False),
        ({"parameter": "velocity", "direction": "raise", "current": 2.0, "suggested": 1.0}, False),
    ],
)
def test_a_number_that_cannot_be_one_is_not_offered(given, stands):
    target = RepairTarget(kind="physical parameter", prim=BLOCK, **given)
    kept = tried(target)
    assert kept.suggested == (given["suggested"] if stands else None)
    assert kept.direction == given["direction"]


def test_what_rolls_on_for_ever_is_told_no_run_that_long(stack):
    """A speed that falls by a thousandth a second is below a hundredth of itself after 4,600 s."""
    case = stack()
    fades = 0.5 * np.exp(-1e-3 * case.recording.time)
    case = case.edit("body_qd", (slice(None), 0, 0), fades)
    round_ = Shape(prim="/World/box_1/g", kind="sphere", size=(0.1,))
    found = aimed(
        case.body("/World/box_1", shapes=[round_]), failed("CheckSettled", "/World/box_1", value=0.5, limit=0.005)
    )
    assert (found.parameter, found.direction, found.suggested) == ("rolling_friction", "raise", None)


def test_a_way_goes_as_the_square_of_the_speed(stack):
    case = stack()
    case = case.body("/World/box_1", velocity=(2.0, 0.0, 0.0))
    found = mended(case, "moves(box_1, 2 m)", "/World/box_1", value=0.5, limit=2.0, unit="m")
    assert (found.parameter, found.direction, found.current) == ("velocity", "raise", 2.0)
    assert found.suggested == pytest.approx(1.05 * 4.0)
    joint = Joint(prim="/World/rail", kind="prismatic", parent=None, child="/World/box_2")
    driven = case.world(joints=[joint])
    assert mended(driven, "moves(box_2, 2 m)", "/World/box_2", value=0.5, limit=2.0, unit="m").kind == "drive"


def test_a_formula_has_the_target_of_the_predicate_that_decides(pool):
    case = pool(density=2500.0)
    objective = Objective.model_validate(
        {"kind": "formula", "object": "wooden_block", "sentence": "it floats and is fast",
         "formula": {"op": "and", "of": [
             {"op": "floats", "object": "wooden_block", "fluid": "water"},
             {"op": "finally", "of": {"op": "speed_between", "object": "steel_ball", "low": 3.0, "high": 4.0}},
         ]}}
    )  # fmt: skip
    case.plan = case.plan.model_copy(update={"objectives": [objective]})
    verdict = judge(case.recording, case.plan)
    found = target(verdict, "ObjectiveFormula", BLOCK)
    assert (found.parameter, found.direction, found.suggested) == ("density", "lower", 600.0)
    found = target(verdict, "ObjectiveFormula", BALL)
    assert (found.parameter, found.direction, found.suggested) == ("velocity", "raise", pytest.approx(3.0))


def test_an_event_that_comes_too_late_is_to_start_nearer(pool):
    case = pool()
    objective = Objective.model_validate(
        {"kind": "formula", "object": "steel_ball",
         "formula": {"op": "eventually", "window": [0.0, 0.1],
                     "of": {"op": "touches", "object": "steel_ball", "ref": "tank"}}}
    )  # fmt: skip
    case.plan = case.plan.model_copy(update={"objectives": [objective]})
    found = target(judge(case.recording, case.plan), "ObjectiveFormula")
    assert (found.kind, found.parameter) == ("settlement", "position")
    assert "s after the moment" in found.why


@pytest.mark.parametrize("stage", [*STAGES, "control"])
def test_a_program_that_fails_is_to_be_mended(stage):
    finding = failed(stage)
    aim([finding])
    assert finding.target.kind == ("controller" if stage == "control" else "program") and finding.target.why


def test_a_check_may_know_better_and_what_nobody_knows_is_said(pool):
    own = RepairTarget(kind="camera", parameter="eye", direction="change")
    known = failed("CheckFinite")
    known.target = own
    assert aimed(pool(), known) == own
    unknown = aimed(pool(), failed("CheckOfTomorrow", BLOCK))
    assert (unknown.kind, unknown.prim) == ("program", BLOCK) and "no formula" in unknown.why
    # A rule that cannot be worked out is one that is not known.
    assert "no formula" in aimed(pool(), failed("CheckSettled", "/World/nobody")).why
    passed = Finding(check="CheckFinite", passed=True, message="", target=own)
    aim([passed])
    assert passed.target is None


def test_where_the_plan_has_no_material_what_floats_is_to_be_as_light_as_wood(pool):
    case = pool(density=2500.0)
    item = case.plan.object("wooden_block")
    item.material = None
    found = target(judge(case.recording, case.plan), "ObjectiveFloats")
    assert (found.parameter, found.direction, found.suggested) == ("density", "lower", 500.0)


def going(stack, speed, slowed):
    """The first box goes along x from the start on, slowed evenly until it stands."""
    case = stack()
    t = case.recording.time
    stop = speed / slowed if slowed else np.inf
    now = np.minimum(t, stop)
    case = case.edit("body_q", (slice(None), 0, 0), speed * now - slowed * now**2 / 2)
    return case.edit("body_qd", (slice(None), 0, 0), np.maximum(speed - slowed * t, 0.0)).body(
        "/World/box_1", velocity=(speed, 0.0, 0.0)
    )


@pytest.mark.parametrize(
    ("speed", "slowed", "asked", "parameter"),
    [
        (1.0, 0.0, 4.0, "duration"), (2.0, 0.2, 6.0, "duration"), (2.0, 0.6, 4.0, "velocity"),
        (1e-3, 0.0, 1.0, "velocity"),
    ],
)  # fmt: skip
def test_what_is_on_its_way_is_given_time_and_what_stops_short_speed(stack, speed, slowed, asked, parameter):
    case = going(stack, speed, slowed)
    end = float(case.recording.time[-1])
    value = speed * end - slowed * end**2 / 2
    found = mended(case, f"moves(box_1, {asked} m)", "/World/box_1", value=value, limit=asked, unit="m")
    assert found.parameter == parameter
    if parameter == "duration":  # it gets there by then, and not long before
        t = found.suggested
        assert asked < speed * t - slowed * t**2 / 2 < 1.2 * asked


def test_a_window_that_ends_after_the_run_asks_for_as_long_a_run(stack):
    case = stack()
    formula = {"op": "eventually", "window": [0.0, 2.0], "of": {
        "op": "always", "window": [0.0, 2.5], "of": {"op": "settles", "object": "box_1"}}}  # fmt: skip
    objective = Objective.model_validate({"kind": "formula", "object": "box_1", "formula": formula})
    case.plan = case.plan.model_copy(update={"objectives": [objective]})
    found = target(judge(case.recording, case.plan), "ObjectiveFormula")
    assert (found.parameter, found.suggested) == ("duration", pytest.approx(4.5))


def test_a_wrong_start_explains_what_it_does(stack):
    """What energy a push out of the ground gives is not mended by a shorter step."""
    case = stack().edit("body_q", (slice(None), slice(None), 2), np.array([0.06, 0.26, 0.46]))
    found = aimed(case, failed("CheckEnergy", "/World/box_1"))
    assert (found.parameter, found.prim) == ("position", "/World/box_1")
    sound = aimed(stack(), failed("CheckEnergy", "/World/box_1"))
    assert sound.parameter != "position"


def test_friction_is_raised_on_the_smoother_of_two_surfaces(stack):
    case = stack()
    half = math.radians(30.0) / 2
    ramp = Shape(prim="/World/ramp/g", kind="box", size=(2, 1, 0.1), rotation=(0, math.sin(half), 0, math.cos(half)),
                 friction=0.1)  # fmt: skip
    case = case.world(statics=[Static(prim="/World/ramp", shapes=[ramp])])
    found = mended(case, "stays_on(box_1, ramp)", "/World/box_1", unit="m")
    assert (found.prim, found.parameter, found.current) == ("/World/ramp", "friction", 0.1)
