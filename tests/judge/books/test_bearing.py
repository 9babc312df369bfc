"""What a joint that may break bore, where nobody recorded it: by the motion of what it holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from tests.judge.theory import RADIUS, UPRIGHT, G, ask, ball, box, only, record, slab, times
from wsim.importers.trajectory import from_arrays
from wsim.judge import judge
from wsim.judge.checks.joint import CheckBreakage, CheckJoints
from wsim.recording import read
from wsim.scene import Scene
from wsim.scene.world import Joint
from wsim.sim import Simulation

if TYPE_CHECKING:
    from pathlib import Path

    from wsim.recording.recording import Recording


def torn(folder: Path, strength: float, judged_as: float) -> Recording:
    """A weight of 2 kg at the end of an arm, let go level, whose weld breaks as it swings down: what poses and
    velocities say of it, in a world that states another strength."""
    scene = Scene()
    scene.simulation(duration=0.6, frame_rate=60.0)
    scene.box("arm", size=(0.4, 0.04, 0.04), position=(0.2, 0.0, 1.5), mass=1.0)
    scene.joint_revolute("hinge", None, "arm", anchor=(0.0, 0.0, 1.5), axis="Y")
    scene.sphere("weight", radius=0.05, position=(0.45, 0.0, 1.5), mass=2.0)
    scene.joint_fixed("weld", "arm", "weight", break_force=strength)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    found = read(folder / "r.rrd")
    joints = [
        joint.model_copy(update={"break_force": judged_as}) if joint.may_break else joint
        for joint in found.world.joints
    ]
    names = np.array([body.prim for body in found.world.bodies])
    arrays = {"time": found.time, "body_names": names, "body_q": found.body_q, "body_qd": found.body_qd}
    return from_arrays(arrays, found.world.model_copy(update={"joints": joints}))


def test_a_weld_that_breaks_at_its_strength_is_accepted(tmp_path: Path) -> None:
    recording = torn(tmp_path, 50.0, 50.0)
    verdict = judge(recording)
    assert verdict.status == "accepted", verdict.summary
    assert ask(CheckJoints(), recording)[0].passed
    (finding,) = ask(CheckBreakage(), recording)
    assert finding.passed


@pytest.mark.parametrize("strength", [40.0, 44.0, 56.0, 300.0])
def test_one_that_breaks_sooner_or_later_is_found(tmp_path: Path, strength: float) -> None:
    (finding,) = ask(CheckBreakage(), torn(tmp_path, strength, 50.0))
    assert not finding.passed


def test_a_joint_that_cannot_break_still_has_to_hold(tmp_path: Path) -> None:
    recording = torn(tmp_path, 50.0, 50.0)
    for joint in recording.world.joints:
        joint.break_force = None
    assert not ask(CheckJoints(), recording)[0].passed


@pytest.mark.parametrize("untold", ["velocities", "beside", "held twice", "at once"])
def test_a_break_whose_load_cannot_be_told_excuses_nothing(untold: str) -> None:
    """A ball of 39 N drops off what would hold a million."""
    time = times(1.0, 60.0)
    since = np.maximum(time - (0.0 if untold == "at once" else 0.5), 0.0)
    zero = np.zeros_like(time)
    place = np.stack([zero, zero, 2.0 - G * since**2 / 2], axis=1)
    joints = [
        Joint(
            prim=f"/World/glue{k}", kind="fixed", parent=None, child="/World/ball", parent_anchor=(0.0, 0.0, 2.0),
            child_anchor=(0.0, 0.0, 0.0), parent_turn=UPRIGHT, child_turn=UPRIGHT, break_force=1e6,
        )
        for k in range(2 if untold == "held twice" else 1)
    ]  # fmt: skip
    recording = record(
        [ball()], place, np.stack([zero, zero, -G * since], axis=1), time, joints=joints,
        statics=[slab("post", (0.1, 0.1, 0.1), (RADIUS + 0.051, 0.0, 2.0))] if untold == "beside" else [],
        metadata={"velocities": "differences"} if untold == "velocities" else {},
    )  # fmt: skip
    finding = ask(CheckJoints(), recording)[0]
    assert not finding.passed and "cannot be told" in finding.message
    assert judge(recording).status == "rejected"


@pytest.mark.parametrize("gap", [0.0, 1.0])
def test_what_stands_on_a_joints_parent_is_not_borne_by_the_joint(gap: float) -> None:
    """A box of 4 kg, welded to what the joint holds, stands on the joint's parent, or hangs high above that."""
    time = times(0.5, 60.0)
    place = np.tile([[0.0, 0.0, 0.0], [0.5, 0.0, 0.1], [0.5, 0.0, 0.25 + gap]], (len(time), 1, 1))
    ends = (("weak", "base", "ball", 10.0), ("weld", "ball", "box", None))
    rows = {"base": 0, "ball": 1, "box": 2}
    joints = [
        Joint(
            prim=f"/World/{name}", kind="fixed", parent=f"/World/{parent}", child=f"/World/{child}",
            parent_anchor=tuple(place[0, rows[child]] - place[0, rows[parent]]), child_anchor=(0.0, 0.0, 0.0),
            break_force=strength,
        )
        for name, parent, child, strength in ends
    ]  # fmt: skip
    base = box("base", (2.0, 1.0, 0.3), kinematic=True)
    recording = record([base, ball(mass=0.5), box()], place, 0.0 * place, time, joints=joints)
    assert only(ask(CheckBreakage(), recording)).passed == (gap == 0.0)
