"""Whole verdicts: what theory gives is accepted; each planted fault is rejected by the check that is there for it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.crashing import crashing
from wsim.judge import judge
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.physics import CheckDensity
from wsim.judge.checks.run import CheckPlanControl
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import ObjectiveCheck, Signals, evaluate, parse
from wsim.judge.language.objective import name_of
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Objective, Step
from wsim.scene.world import Joint

BLOCK, BALL, TANK, WATER = "/World/wooden_block", "/World/steel_ball", "/World/tank", "/World/water"


def failed(verdict: Verdict) -> set[str]:
    return {finding.check for finding in verdict.failures}


def only(verdict: Verdict, check: str, prim: str | None = None):
    return next(f for f in verdict.findings if f.check == check and prim in (None, f.prim))


def test_theory_is_accepted_and_every_check_speaks(pool):
    case = pool()
    verdict = judge(case.recording, case.plan)
    assert verdict.failures == []
    assert verdict.status == "accepted"
    assert {f.check for f in verdict.findings} >= {
        "CheckFinite", "CheckComplete", "CheckLog", "CheckPlanObjects", "CheckExplosion", "CheckPenetration",
        "CheckFluidContained", "CheckDensity", "CheckWaterLevel", "CheckSettled", "ObjectiveFloats", "ObjectiveRestsOn",
        "ObjectiveStaysInside",
    }  # fmt: skip
    for finding in verdict.findings:
        assert finding.margin is None or finding.margin >= 0
        if finding.value is not None:
            assert finding.limit_from and finding.unit


def test_theory_is_accepted_without_a_plan(pool):
    verdict = judge(pool().recording)
    assert verdict.status == "accepted"
    assert not any(f.objective for f in verdict.findings)


def test_draft_is_archimedes(pool):
    case = pool()
    finding = only(judge(case.recording, case.plan), "ObjectiveFloats")
    assert finding.expected == pytest.approx(0.084, abs=1e-4)  # 600 / 1000 of 0.14 m
    assert finding.value == pytest.approx(0.084, abs=0.001)
    assert finding.unit == "m" and finding.line and finding.prim == BLOCK


def test_a_block_that_rides_a_fifth_of_its_height_too_high_is_rejected(pool):
    case = pool(lift=0.2 * 0.14)
    verdict = judge(case.recording, case.plan)
    finding = only(verdict, "ObjectiveFloats")
    assert failed(verdict) == {"ObjectiveFloats", "CheckDraft", "CheckFluidHeight"}
    # Lifted out, it displaces less, so that the surface falls a little besides.
    assert finding.value == pytest.approx(0.084 - 0.028 - 0.028 * 0.04 / (0.66 * 0.51), abs=0.001)
    assert finding.value < finding.limit < finding.expected
    assert finding.margin == pytest.approx(finding.value - finding.limit)


def test_a_block_that_rides_too_low_is_rejected(pool):
    case = pool(lift=-0.028)
    finding = only(judge(case.recording, case.plan), "ObjectiveFloats")
    assert not finding.passed and finding.value > finding.limit > finding.expected


def test_dense_wood_is_rejected_with_prim_time_and_depths(pool):
    case = pool(density=2500.0)
    verdict = judge(case.recording, case.plan)
    assert verdict.status == "rejected"
    finding = only(verdict, "ObjectiveFloats")
    level = 0.3 + (0.0056 + 4 / 3 * math.pi * 0.06**3) / (0.66 * 0.51)
    assert finding.prim == BLOCK and finding.line == case.recording.world.body(BLOCK).line
    assert finding.value == pytest.approx(level, abs=1e-3)
    assert finding.expected == pytest.approx(level, abs=1e-3)
    assert finding.limit == pytest.approx(0.14)
    assert finding.margin < 0
    # It starts 0.1 m (to its centre) above the surface, and its top passes it 0.17 m farther down.
    entry = math.sqrt(2 * 0.1 / 9.81)
    assert finding.time == pytest.approx(entry + 0.07 / (9.81 * entry), abs=0.05)
    for words in (BLOCK, "2500", "0.084", f"{finding.time:.3f}"):
        assert words in finding.message
    assert finding.message.rstrip(".") in verdict.summary


def test_heavy_block_that_floats_all_the_same_is_rejected(pool):
    case = pool()
    case = case.body(BLOCK, mass=2500.0 * 0.0056)
    assert "ObjectiveFloats" in failed(judge(case.recording, case.plan))


def test_a_block_beside_the_tank_does_not_float_in_it(pool):
    case = pool().edit("body_q", (slice(60, None), 0, 0), 0.6)
    finding = only(judge(case.recording, case.plan), "ObjectiveFloats")
    assert not finding.passed and finding.time == pytest.approx(2.0)
    assert finding.value == pytest.approx(0.6 - 0.33, abs=1e-6)


def test_nan_is_rejected_at_its_first_time_and_prim(pool):
    case = pool().edit("body_q", (slice(45, None), 1, 2), np.nan)
    verdict = judge(case.recording, case.plan)
    finding = only(verdict, "CheckFinite")
    assert not finding.passed and finding.prim == BALL and finding.time == pytest.approx(1.5)
    assert sum(f.objective is not None for f in verdict.failures) == len(case.plan.objectives)
    Verdict.model_validate_json(verdict.model_dump_json())


def test_nan_in_one_particle_is_rejected(pool):
    case = pool()
    density = case.recording.fluids[WATER].density.copy()
    density[30, 17] = np.inf
    finding = only(judge(case.water(density=density).recording), "CheckFinite")
    assert not finding.passed and finding.prim == WATER and finding.time == pytest.approx(1.0)


def test_a_rotation_of_length_two_is_rejected(pool):
    case = pool().edit("body_q", (9, 0, 6), 2.0)
    finding = only(judge(case.recording), "CheckFinite")
    assert not finding.passed and finding.prim == BLOCK and finding.time == pytest.approx(0.3)


def test_a_teleport_is_rejected(pool):
    case = pool().edit("body_q", (slice(50, 51), 0, 1), 0.4)
    finding = only(judge(case.recording), "CheckExplosion", BLOCK)
    assert not finding.passed and finding.time == pytest.approx(50 / 30)
    assert "jumps" in finding.message


def test_a_speed_beyond_energy_is_rejected(pool):
    case = pool()
    verdict = judge(case.recording)
    # From the ball's top at the start to the bottom of the ground plane; two loose bodies that bounce may add up.
    top = case.recording.body_q[0, 1, 2] + 0.06
    assert only(verdict, "CheckExplosion").limit == pytest.approx(3 * math.sqrt(2 * 9.81 * top), rel=1e-5)
    case = case.edit("body_qd", (40, 1, 0), 12.0)
    finding = only(judge(case.recording), "CheckExplosion", BALL)
    assert not finding.passed and finding.value == pytest.approx(12.0, rel=0.01)


def test_a_particle_beyond_energy_is_rejected(pool):
    case = pool()
    velocity = case.recording.fluids[WATER].velocity.copy()
    velocity[20, 5] = (0.0, 0.0, 30.0)
    finding = only(judge(case.water(velocity=velocity).recording), "CheckExplosion", WATER)
    assert not finding.passed and finding.time == pytest.approx(20 / 30)


def test_the_speed_of_sound_bounds_the_fluid(pool):
    case = pool()
    velocity = case.recording.fluids[WATER].velocity.copy()
    velocity[20, 5] = (0.0, 0.0, 2.0)
    case = case.water(velocity=velocity)
    assert only(judge(case.recording), "CheckExplosion", WATER).passed
    case = case.changed(metadata={"speed_of_sound": 1.5})
    assert not only(judge(case.recording), "CheckExplosion", WATER).passed


def test_a_ball_in_the_tank_floor_is_rejected(pool):
    case = pool()
    case = case.edit("body_q", (slice(60, None), 1, 2), 0.02 + 0.06 - 0.01)
    finding = only(judge(case.recording), "CheckPenetration", BALL)
    assert not finding.passed and finding.value == pytest.approx(0.01, rel=1e-3)
    assert finding.limit == pytest.approx(0.05 * 0.12)


def test_a_deep_but_brief_penetration_is_rejected_and_a_slight_one_is_not(pool):
    deep = pool().edit("body_q", (60, 1, 2), 0.02 + 0.06 - 0.03)
    assert not only(judge(deep.recording), "CheckPenetration", BALL).passed
    slight = pool().edit("body_q", (60, 1, 2), 0.02 + 0.06 - 0.01)
    assert only(judge(slight.recording), "CheckPenetration", BALL).passed


def test_two_bodies_in_each_other_are_rejected(pool):
    case = pool()
    case = case.edit("body_q", (slice(100, None), 1, slice(0, 3)), case.recording.body_q[110, 0, :3] + [0.0, 0.0, 0.1])
    finding = only(judge(case.recording), "CheckPenetration")
    assert not finding.passed and {BLOCK, BALL} <= set(finding.message.replace(":", " ").split())
    assert finding.value == pytest.approx(0.07 + 0.06 - 0.1, abs=2e-3)


def test_the_solvers_own_penetration_is_heard(pool):
    case = pool()
    case = case.changed(scalars={"contact/penetration": np.full(len(case.recording.time), 0.02)})
    assert "CheckPenetration" in failed(judge(case.recording))


def test_leaking_particles_are_rejected(pool):
    case = pool()
    position = case.recording.fluids[WATER].position.copy()
    position[50:, : position.shape[1] // 20, 2] = -0.2
    verdict = judge(case.water(position=position).recording, case.plan)
    finding = only(verdict, "CheckFluidContained")
    assert {"CheckFluidContained", "ObjectiveStaysInside"} <= failed(verdict)
    assert finding.value == pytest.approx(0.05, abs=0.001) and finding.time == pytest.approx(50 / 30)


def test_a_splash_above_the_rim_is_no_leak(pool):
    case = pool()
    position = case.recording.fluids[WATER].position.copy()
    position[20, : position.shape[1] // 20, 2] = 0.8
    assert only(judge(case.water(position=position).recording), "CheckFluidContained").passed


def test_wrong_density_is_rejected_in_mean_and_in_the_tail(pool):
    case = pool()
    density = case.recording.fluids[WATER].density
    mean = judge(case.water(density=density * 1.04).recording)
    assert failed(mean) == {"CheckDensity"} and len(mean.failures) == 1
    tail = density.copy()
    tail[:, : tail.shape[1] // 50] = 1100.0
    assert [f.value for f in judge(case.water(density=tail).recording).failures] == [pytest.approx(0.1)]


def test_a_surface_above_its_volume_is_rejected(pool):
    case = pool()
    position = case.recording.fluids[WATER].position.copy()
    position[:, :, 2] = 0.02 + (position[:, :, 2] - 0.02) * 1.2
    finding = only(judge(case.water(position=position).recording), "CheckWaterLevel")
    assert not finding.passed and finding.value == pytest.approx(0.2 * 0.304, abs=0.01)


def test_a_block_that_still_bobs_is_not_settled(pool):
    case = pool(settle=False)
    verdict = judge(case.recording, case.plan)
    assert failed(verdict) == {"CheckSettled", "CheckPlanPlaces"}  # it bobs about its draft from the start
    assert only(verdict, "CheckSettled", BLOCK).value == pytest.approx(0.108 / math.sqrt(2), rel=0.1)


def test_log_errors_and_overflows_are_rejected_and_warnings_are_not(pool):
    case = pool()
    assert failed(judge(case.log("ERROR", "solver diverged").recording)) == {"CheckLog"}
    assert failed(judge(case.log("WARN", "nconmax Overflow: 40 > 32").recording)) == {"CheckLog"}
    assert judge(case.log("WARN", "slow").recording).status == "accepted"


def test_a_run_that_ended_early_is_rejected(pool):
    case = pool()
    full = case.recording
    case = case.changed(
        time=full.time[:60], body_q=full.body_q[:60], body_qd=full.body_qd[:60], contact_force=full.contact_force[:60],
        scalars={}, metadata={"error": "stopped by signal 9"},
    )  # fmt: skip
    finding = only(judge(case.recording), "CheckComplete")
    assert not finding.passed and "stopped by signal 9" in finding.message
    assert finding.value == pytest.approx(59 / 30) and finding.expected == 4.0


def test_time_that_goes_back_and_frames_that_are_few_are_rejected(pool):
    case = pool()
    assert "CheckComplete" in failed(judge(case.edit("time", 50, 0.1).recording))
    r = case.recording
    thin = case.changed(
        time=r.time[::8], body_q=r.body_q[::8], body_qd=r.body_qd[::8], contact_force=r.contact_force[::8], scalars={}
    )
    assert "CheckComplete" in failed(judge(thin.recording))


def test_missing_particles_are_rejected(pool):
    verdict = judge(pool().changed(fluids={}).recording)
    assert any(f.check == "CheckComplete" and f.prim == WATER for f in verdict.failures)


def test_no_frames_is_blocked(pool):
    case = pool()
    r = case.recording
    empty = case.changed(time=r.time[:0], body_q=r.body_q[:0], body_qd=r.body_qd[:0], contact_force=r.contact_force[:0])
    assert judge(empty.recording, case.plan).status == "blocked"


def test_objects_that_are_missing_extra_or_of_another_kind_are_rejected(pool):
    case = pool()
    r = case.recording
    missing = case.changed(
        world=r.world.model_copy(update={"bodies": r.world.bodies[:1]}),
        body_q=r.body_q[:, :1], body_qd=r.body_qd[:, :1], contact_force=r.contact_force[:, :1],
    )  # fmt: skip
    verdict = judge(missing.recording, case.plan)
    assert {"CheckPlanObjects", "ObjectiveRestsOn"} <= failed(verdict)
    assert BALL in only(verdict, "CheckPlanObjects").message
    extra = case.world(statics=[*r.world.statics, r.world.statics[0].model_copy(update={"prim": "/World/shelf"})])
    assert "/World/shelf" in only(judge(extra.recording, case.plan), "CheckPlanObjects").message
    no_tank = case.world(containers=[], fluids=[f.model_copy(update={"container": None}) for f in r.world.fluids])
    assert "CheckPlanObjects" in failed(judge(no_tank.recording, case.plan))


def test_a_ball_that_hovers_above_the_floor_is_rejected(pool):
    case = pool().edit("body_q", (slice(45, None), 1, 2), 0.02 + 0.06 + 0.02)
    finding = only(judge(case.recording, case.plan), "ObjectiveRestsOn", BALL)
    assert not finding.passed and finding.value == pytest.approx(0.02, abs=1e-4) and finding.time == pytest.approx(1.5)


def test_a_ball_that_is_carried_with_the_wrong_force_is_rejected(pool):
    case = pool()
    force = case.recording.contact_force
    finding = only(judge(case.recording, case.plan), "ObjectiveRestsOn", BALL)
    assert finding.passed
    carried = next(f for f in judge(case.recording, case.plan).findings if f.unit == "N")
    assert carried.expected == pytest.approx(6850 * 4 / 3 * math.pi * 0.06**3 * 9.81, rel=1e-3)
    assert "ObjectiveRestsOn" in failed(judge(case.changed(contact_force=force * 0.5).recording, case.plan))
    assert "ObjectiveRestsOn" in failed(judge(case.changed(contact_force=force * 2.0).recording, case.plan))
    # No particle fits under the ball where it is within a spacing of the floor: the pressure there may be missing.
    patch = math.pi * (2 * 0.06 * 0.03 - 0.03**2)
    heavier = judge(case.changed(contact_force=force * 1.4).recording, case.plan)
    [loaded] = [f for f in heavier.findings if f.unit == "N"]
    level = 0.3 + (0.6 * 0.0056 + 4 / 3 * math.pi * 0.06**3) / (0.66 * 0.51)
    weight = 7850 * 4 / 3 * math.pi * 0.06**3 * 9.81
    assert loaded.passed
    assert loaded.limit == pytest.approx(carried.expected + 0.25 * weight + 9810 * level * patch, rel=0.01)


def test_a_box_on_the_ground_must_be_carried_with_its_weight(stack):
    case = stack()
    force = case.recording.contact_force
    wrong = {"ObjectiveRestsOn", "CheckRestForce"}
    assert failed(judge(case.changed(contact_force=force * 1.3).recording, case.plan)) == wrong
    assert failed(judge(case.changed(contact_force=force * 0.7).recording, case.plan)) == wrong
    assert judge(case.changed(contact_force=force * 0.0).recording, case.plan).status == "accepted"  # not recorded


def test_a_crash_in_a_check_is_neither_a_pass_nor_a_fail(pool, monkeypatch):
    case = pool()
    whole = judge(case.recording, case.plan)
    crashing(monkeypatch, CheckEnergy)
    verdict = judge(case.recording, case.plan)
    assert verdict.status == "blocked"
    said = "CheckEnergy could not be evaluated: ZeroDivisionError: float division by zero"
    assert verdict.summary == f"Blocked: {said}; all {len(verdict.findings)} findings of the others pass."
    assert [f for f in whole.findings if f.check != "CheckEnergy"] == verdict.findings
    [crash] = verdict.crashes
    assert crash.message == said
    assert "1.0 / len(evidence.world.bodies[:0])" in crash.traceback
    assert Verdict.model_validate_json(verdict.model_dump_json()) == verdict
    assert "crashes" not in whole.model_dump_json()  # a verdict without any is written as ever


def test_a_crash_beside_what_fails_is_told_and_the_world_rejected(pool, monkeypatch):
    case = pool(lift=0.2 * 0.14)
    crashing(monkeypatch, CheckDensity)
    verdict = judge(case.recording, case.plan)
    assert verdict.status == "rejected"
    assert "ObjectiveFloats" in failed(verdict)
    assert [crash.check for crash in verdict.crashes] == ["CheckDensity"]
    assert verdict.summary.endswith("CheckDensity could not be evaluated: ZeroDivisionError: float division by zero.")


def test_an_objective_that_crashes_is_named_in_its_own_words(pool, monkeypatch):
    case = pool()
    crashing(monkeypatch, ObjectiveCheck)
    verdict = judge(case.recording, case.plan)
    assert verdict.status == "blocked"
    assert [(crash.check, crash.objective) for crash in verdict.crashes] == [
        (name_of(each.kind), ObjectiveCheck(each).asks) for each in case.plan.objectives
    ]
    assert "ObjectiveFloats could not be evaluated" in verdict.summary
    assert f", nor {len(verdict.crashes) - 1} more;" in verdict.summary


def test_what_the_recording_lacks_is_no_crash(pool):
    case = pool()
    fluids = [fluid.model_copy(update={"container": "/World/cup"}) for fluid in case.recording.world.fluids]
    world = case.recording.world.model_copy(update={"fluids": fluids})
    verdict = judge(replace(case.recording, world=world), case.plan)
    assert verdict.status == "rejected"
    assert verdict.crashes == []
    contained = only(verdict, "CheckFluidContained")
    assert not contained.passed and "no container in the world: /World/cup" in contained.message


def with_objective(case, **objective):
    case.plan = case.plan.model_copy(update={"objectives": [Objective(**objective)]})
    return case


def test_submerged_tells_a_sunken_body_from_a_floating_one(pool):
    sunken = with_objective(pool(), kind="submerged", object="steel_ball", ref="water")
    assert only(judge(sunken.recording, sunken.plan), "ObjectiveSubmerged").passed
    floating = with_objective(pool(), kind="submerged", object="wooden_block", ref="water")
    finding = only(judge(floating.recording, floating.plan), "ObjectiveSubmerged")
    assert not finding.passed and finding.value == pytest.approx(-0.056, abs=0.005)


def test_a_body_stays_inside_or_does_not(pool):
    case = with_objective(pool(), kind="stays_inside", object="steel_ball", ref="tank")
    assert only(judge(case.recording, case.plan), "ObjectiveStaysInside").passed
    out = case.edit("body_q", (slice(80, 83), 1, 1), 0.3)
    finding = only(judge(out.recording, case.plan), "ObjectiveStaysInside")
    assert not finding.passed and finding.time == pytest.approx(80 / 30)


def test_settles_tells_rest_from_motion(pool):
    case = with_objective(pool(), kind="settles", object="steel_ball")
    assert only(judge(case.recording, case.plan), "ObjectiveSettles").passed
    spinning = case.edit("body_qd", (slice(90, None), 1, 5), 2.0)
    finding = only(judge(spinning.recording, case.plan), "ObjectiveSettles")
    assert not finding.passed and finding.value == pytest.approx(2.0 * 0.06) and finding.time == pytest.approx(3.0)


def test_a_stack_that_stands_is_accepted_and_one_that_falls_is_not(stack):
    case = stack()
    assert judge(case.recording, case.plan).failures == []
    fallen = stack(fallen=True)
    verdict = judge(fallen.recording, fallen.plan)
    finding = only(verdict, "ObjectiveStaysOn", "/World/box_3")
    assert failed(verdict) == {"ObjectiveStaysOn", "CheckEnergy", "CheckForces"}  # what pushes it is not recorded
    assert 1.0 < finding.span[0] < 1.2 and finding.span[0] < finding.time


def test_topples_wants_the_stack_to_fall(stack):
    prompt = "A tower of three boxes stands on the ground and topples"
    standing = stack(prompt=prompt)
    finding = only(judge(standing.recording, standing.plan), "ObjectiveTopples", "/World/box_3")
    assert not finding.passed and finding.value == 0.0
    fallen = stack(fallen=True, prompt=prompt)
    finding = only(judge(fallen.recording, fallen.plan), "ObjectiveTopples", "/World/box_3")
    assert finding.passed and 1.0 < finding.span[0] < 1.5
    assert finding.value == pytest.approx(0.4) or finding.value == pytest.approx(90.0)


def test_a_box_that_slides_at_the_end_has_not_settled(stack):
    case = stack().edit("body_qd", (slice(70, None), 0, 0), 0.2)
    assert failed(judge(case.recording, case.plan)) == {"CheckSettled", "CheckForces"}


def test_bodies_that_a_fixed_joint_makes_one_float_as_one(pool):
    """The block's lower half of 900 kg/m^3 and its upper half of 300 float as the whole of 600 does."""
    case = pool()
    block, ball = case.recording.world.bodies
    half = (*block.shapes[0].size[:2], block.shapes[0].size[2] / 2)
    shape = block.shapes[0].model_copy(update={"size": half})
    lower, upper = (
        block.model_copy(update={"prim": prim, "shapes": [shape], "mass": block.mass * share})
        for prim, share in ((BLOCK, 0.75), ("/World/upper", 0.25))
    )
    q, qd, force = (
        np.concatenate([a, a[:, :1]], axis=1)
        for a in (case.recording.body_q, case.recording.body_qd, case.recording.contact_force)
    )
    q[:, 0, 2] -= half[2] / 2
    q[:, 2, 2] += half[2] / 2
    glue = Joint(prim="/World/glue", kind="fixed", parent=BLOCK, child="/World/upper")
    apart = case.changed(body_q=q, body_qd=qd, contact_force=force).world(bodies=[lower, ball, upper])
    joined = apart.world(joints=[glue])
    assert only(judge(joined.recording, joined.plan), "ObjectiveFloats").passed
    assert not only(judge(apart.recording, apart.plan), "ObjectiveFloats").passed
    # By the language likewise.
    for case, floats in ((joined, True), (apart, False)):
        said = evaluate(parse("floats(wooden_block, water)"), Signals.of_recording(case.recording))
        assert said.satisfied[0] == floats


@pytest.mark.parametrize(
    ("controlled", "shows", "controls", "outcome"),
    [
        (False, "it floats", None, None),
        (True, "it floats", None, False),
        (True, "control holds the ball up", None, True),
        (False, "control holds the ball up", None, False),
        (True, "it floats", True, True),
        (False, "it floats", True, False),
        (True, "it floats out of control", False, False),
        (False, "it floats out of control", False, None),
    ],
)
def test_control_acts_only_where_the_plan_asks_for_it(pool, controlled, shows, controls, outcome):
    case = pool().changed(metadata={"controlled": controlled})
    plan = case.plan.model_copy(update={"steps": [Step(title="motion", shows=shows, controls=controls)]})
    found = [finding.passed for finding in CheckPlanControl().evaluate(Evidence(case.recording, plan))]
    assert found == ([] if outcome is None else [outcome])
