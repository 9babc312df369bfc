"""Joints that hold, and those that drift, lean, overrun their limits or strain at the end of their strength."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import UPRIGHT, ask, box, edited, only, record, swinging, times, with_world
from wsim.judge.checks.joint import CheckBreakage, CheckDrives, CheckGears, CheckJointLimits, CheckJoints
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.joints import track_of
from wsim.judge.repair.aim import aim
from wsim.scene.world import Gear, Joint, Motor


def with_joint(recording, **fields):
    joint = recording.world.joints[0].model_copy(update=fields)
    return with_world(recording, joints=[joint])


def held(kind, position, rotation=None, seconds=1.0, **fields):
    """A box held by the world at the origin, moved as given."""
    t = times(seconds)
    joint = Joint(
        prim="/World/joint", kind=kind, parent=None, child="/World/box", parent_anchor=(0.0, 0.0, 0.0),
        child_anchor=(0.0, 0.0, 0.0), line="program.py:9", **fields,
    )  # fmt: skip
    place = np.broadcast_to(position(t) if callable(position) else position, (len(t), 3))
    turn = np.broadcast_to(UPRIGHT if rotation is None else rotation(t), (len(t), 4))
    return record([box()], place, np.zeros((len(t), 3)), t, rotation=turn, joints=[joint])


def about(axis, angle):
    def rotation(t):
        q = np.zeros((len(t), 4))
        q[:, axis], q[:, 3] = np.sin(angle(t) / 2), np.cos(angle(t) / 2)
        return q

    return rotation


def along(axis, way):
    def position(t):
        return way(t)[:, None] * np.eye(3)[axis]

    return position


# ---- holding
def test_a_pendulum_holds_and_one_that_breaks_mid_run_does_not():
    right = swinging()
    assert only(ask(CheckJoints(), right)).passed
    t = right.time
    fall = 9.81 * np.maximum(t - 2.0, 0.0) ** 2 / 2
    finding = only(ask(CheckJoints(), edited(right, "body_q", (slice(None), 0, 2), -fall)))
    assert not finding.passed and finding.prim == "/World/hinge" and finding.line == "program.py:9"
    assert finding.value == pytest.approx(fall[-1], rel=1e-3)
    assert 2.0 < finding.time < 2.1 and finding.span[1] == pytest.approx(4.0)
    assert finding.target.kind == "joint"


@pytest.mark.parametrize(("apart", "passes"), [(0.9, True), (1.1, False)])
def test_anchors_may_be_a_fiftieth_of_the_body_apart(apart, passes):
    limit = 0.02 * 0.04
    wrong = edited(swinging(), "body_q", (slice(100, None), 0, 1), apart * limit)
    finding = only(ask(CheckJoints(), wrong))
    assert finding.passed == passes and finding.limit == pytest.approx(limit)


@pytest.mark.parametrize(
    ("kind", "position", "rotation", "passes"),
    [
        ("fixed", (0.0, 0.0, 0.0), None, True),
        ("fixed", (0.0, 0.0, 0.0), about(2, lambda t: 0.1 * t), False),
        ("fixed", along(1, lambda t: 0.1 * t), None, False),
        ("spherical", (0.0, 0.0, 0.0), about(0, lambda t: 3.0 * t), True),
        ("spherical", along(2, lambda t: 0.1 * t), None, False),
        ("revolute", (0.0, 0.0, 0.0), about(2, lambda t: 5.0 * t), True),
        ("revolute", (0.0, 0.0, 0.0), about(0, lambda t: 0.1 * t), False),
        ("prismatic", along(2, lambda t: 0.5 * t), None, True),
        ("prismatic", along(0, lambda t: 0.1 * t), None, False),
        ("prismatic", (0.0, 0.0, 0.0), about(2, lambda t: 0.1 * t), False),
    ],
)
def test_each_kind_lets_its_own_motion_and_no_other(kind, position, rotation, passes):
    assert only(ask(CheckJoints(), held(kind, position, rotation, axis="Z"))).passed == passes


def test_a_joint_without_anchors_is_not_judged():
    assert ask(CheckJoints(), with_joint(swinging(), parent_anchor=None)) == []


def test_a_hinge_knows_its_angle_beyond_a_turn_and_a_slider_its_way():
    wheel = held("revolute", (0.0, 0.0, 0.0), about(2, lambda t: 9.0 * t), axis="Z")
    track = track_of(Evidence(wheel), wheel.world.joints[0])
    assert track.position == pytest.approx(9.0 * wheel.time, abs=1e-5)
    cart = held("prismatic", along(2, lambda t: -0.5 * t), axis="Z")
    assert track_of(Evidence(cart), cart.world.joints[0]).position == pytest.approx(-0.5 * cart.time, abs=1e-6)


# ---- limits
@pytest.mark.parametrize(
    ("low", "high", "passes"), [(-0.9, 0.9, True), (-0.75, 0.9, True), (-0.7, 0.9, False), (-0.9, 0.5, False)]
)
def test_a_hinge_keeps_to_its_limits(low, high, passes):
    """It swings between -0.8 and 0.8 rad; a stop may give by a twentieth of the range."""
    finding = only(ask(CheckJointLimits(), with_joint(swinging(), low=low, high=high)))
    assert finding.passed == passes and finding.limit == pytest.approx(0.05 * (high - low))
    assert finding.value == pytest.approx(max(0.0, low + 0.8, 0.8 - high), abs=5e-3)


def test_a_slider_keeps_to_its_limits_and_a_free_joint_has_none():
    cart = held("prismatic", along(2, lambda t: 0.5 * t), axis="Z", low=-1.0, high=0.3)
    finding = only(ask(CheckJointLimits(), cart))
    assert not finding.passed and finding.value == pytest.approx(0.2, abs=1e-6) and finding.unit == "m"
    assert finding.time == pytest.approx((0.3 + 0.065) / 0.5, abs=1 / 30)
    assert ask(CheckJointLimits(), swinging()) == []


# ---- drives
@pytest.mark.parametrize(("strained", "passes"), [(0.0, True), (0.45, True), (0.55, False), (1.0, False)])
def test_a_drive_must_not_strain_at_the_end(strained, passes):
    right = with_joint(swinging(), drive=Motor(stiffness=1.0, max_effort=5.0))
    effort = np.full(len(right.time), 1.0)
    end = np.flatnonzero(Evidence(right).window)
    effort[end[: round(strained * len(end))]] = -5.0
    effort[:20] = 5.0  # at the start it may
    right.scalars["drive/hinge"] = effort
    finding = only(ask(CheckDrives(), right))
    assert finding.passed == passes and finding.value == pytest.approx(strained, abs=0.02)
    aim([finding], Evidence(right))
    assert passes or (finding.target.parameter, finding.target.direction) == ("drive.max_force", "raise")


def test_a_drive_without_a_bound_cannot_strain():
    right = with_joint(swinging(), drive=Motor(stiffness=1.0))
    right.scalars["drive/hinge"] = np.full(len(right.time), math.inf)
    assert ask(CheckDrives(), right) == []


# ---- breaking
def breaking(borne, at=0.5, strength=100.0):
    """A box that bears `borne` [N] and is let go `at` a time [s]; at 0 it never is."""
    t = times(1.0)
    gone = (t >= at) & (at > 0.0)
    right = held("fixed", along(2, lambda t: -9.81 * np.maximum(t - at, 0.0) ** 2 / 2 * gone), break_force=strength)
    scalars = {"broken/joint": gone.astype(float), "force/joint": np.where(gone, 0.0, 9.81), "torque/joint": 0.0 * t}
    scalars["force/joint"][np.argmax(gone) if at else 10] = borne
    return replace(right, scalars=right.scalars | scalars)


def test_a_joint_holds_until_it_breaks():
    assert only(ask(CheckJoints(), breaking(101.0))).passed
    loose = breaking(101.0)
    assert not only(ask(CheckJoints(), replace(loose, scalars={"broken/joint": 0.0 * loose.time}))).passed


@pytest.mark.parametrize(
    ("borne", "at", "passed", "says"),
    [
        (101.0, 0.5, True, "breaks at 1.01"),
        (80.0, 0.5, False, "/World/joint breaks at 0.8 of its strength"),
        (99.0, 0.0, True, "bears at most 0.99"),
        (150.0, 0.0, False, "/World/joint bears 1.5 of its strength"),
    ],
)
def test_a_joint_breaks_at_its_strength(borne, at, passed, says):
    finding = only(ask(CheckBreakage(), breaking(borne, at)))
    assert finding.passed == passed and says in finding.message
    assert (finding.target is None) == passed


# ---- gears
@pytest.mark.parametrize(
    ("ratio", "turned", "passed"),
    [(-0.5, 2.0, True), (-0.52, 2.0, False), (-0.5, 0.1, True), (-0.505, 0.1, True), (-0.55, 0.1, False)],
)
def test_a_gear_keeps_its_ratio_however_little_it_turns(ratio, turned, passed):
    t = times(1.0)
    turns = [about(1, lambda t, share=share: share * turned * t)(t) for share in (1.0, -0.5)]
    joints = [
        Joint(
            prim=f"/World/j{k}", kind="revolute", axis="Y", parent=None, child=f"/World/{name}",
            parent_anchor=(0.0, 0.0, 0.0), child_anchor=(0.0, 0.0, 0.0),
        )
        for k, name in enumerate(("a", "b"))
    ]  # fmt: skip
    bodies = [box("a"), box("b")]
    place, still = np.zeros((len(t), 2, 3)), np.zeros((len(t), 2, 3))
    gears = [Gear(prim="/World/mesh", first="/World/j0", second="/World/j1", ratio=ratio, line="program.py:7")]
    made = record(bodies, place, still, t, rotation=np.stack(turns, axis=1), joints=joints)
    finding = only(ask(CheckGears(), with_world(made, gears=gears)))
    assert finding.passed == passed
    assert finding.value == pytest.approx(abs(ratio + 0.5) * turned, abs=1e-6)
