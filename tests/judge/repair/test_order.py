"""What to try first: the plan before physics, a wrong start before what it does, a value before a direction."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.judge.theory import camera
from wsim.judge.evidence.framing import framed, in_frame
from wsim.judge.repair.order import suggestions
from wsim.judge.verdict import Finding, RepairTarget, Verdict


def failed(check, objective=None, **target):
    said = RepairTarget(kind="program", **target) if target else None
    return Finding(check=check, passed=False, message="", objective=objective, target=said)


def order(*findings):
    return [finding.check for finding in suggestions(Verdict(status="rejected", summary="", findings=list(findings)))]


def test_causes_come_before_what_they_do_and_cameras_last():
    findings = [
        failed("CheckInFrame", parameter="target", vector=(0, 0, 1)),
        failed("CheckForces", parameter="time_step", suggested=1e-3),
        failed("ObjectiveMoves", "it moves", parameter="velocity", suggested=2.0),
        failed("CheckPenetration", parameter="position", vector=(0, 0, 1)),
        failed("CheckPlanPlaces", parameter="position", vector=(0, 0, 2)),
        failed("CheckPlanObjects", direction="add"),
        failed("CheckSettled", parameter="friction"),
        failed("CheckLog"),
    ]
    assert order(*findings) == [
        "CheckPlanObjects", "CheckPlanPlaces", "CheckPenetration", "ObjectiveMoves", "CheckForces", "CheckSettled",
        "CheckInFrame",
    ]  # fmt: skip


def test_one_change_is_said_once_and_what_passed_asks_for_none():
    same = {"parameter": "density", "suggested": 600.0}
    passed = Finding(check="CheckMass", passed=True, message="")
    assert order(failed("CheckMass", **same), failed("ObjectiveFloats", "it floats", **same), passed) == ["CheckMass"]
    assert order() == []


@given(
    st.lists(st.tuples(*[st.floats(-5.0, 5.0)] * 3), min_size=1, max_size=6),
    st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(0.1, 9.0)), st.floats(0.05, 1.0),
)  # fmt: skip
def test_a_camera_that_is_told_where_to_stand_sees_it_all(points, eye, radius):
    points = np.array(points)
    one = camera(eye, target=(eye[0], eye[1] + 1.0, eye[2] + 5.0))
    found = framed(one, points, radius)
    assert found is not None
    told = one.model_copy(update={"eye": tuple(found[0]), "target": tuple(found[1])})
    assert in_frame(told, points).all()
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    assert np.allclose(found[1], middle, atol=1e-3)
