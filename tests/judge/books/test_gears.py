"""A pair of gears has one inertia, I1 + ratio^2 I2 as its first wheel feels it, and nothing slows it."""

import numpy as np
import pytest

from tests.judge.theory import ask, ball, record, times, with_world
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.physics import CheckPenetration
from wsim.judge.checks.recorded_state import CheckRecordedDepth
from wsim.judge.evidence.evidence import Evidence
from wsim.scene import Scene
from wsim.scene.world import Gear, Joint, Motor
from wsim.sim import Simulation
from wsim.sim.collect import collect

EFFORT = 0.3  # [N m]


def pair(ratio, speed_up, effort=0.0, start=0.0, frictions=(0.0, 0.0)):
    """Two balls on axles, of which the first comes to turn by `speed_up` [rad/s^2] and the second goes with it."""
    t = times(1.0, 60.0)
    first = np.stack([start * t + speed_up * t**2 / 2, start + speed_up * t])
    angle, rate = np.stack([first, ratio * first], axis=2)
    none = np.zeros((*angle.shape, 2))
    motor = Motor(damping=100.0, velocity=1e3, max_effort=effort) if effort else None
    axles = [
        Joint(
            prim=f"/World/axle_{n}", kind="revolute", parent=None, child=f"/World/{name}", axis="Z",
            parent_anchor=(n, 0, 1), child_anchor=(0, 0, 0), drive=None if n else motor, friction=frictions[n],
        )
        for n, name in enumerate(("small", "large"))
    ]  # fmt: skip
    place = np.tile([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0]], (len(t), 1, 1))
    made = record(
        [ball("small", 2.0), ball("large", 8.0)], place, 0.0 * place, t, joints=axles,
        rotation=np.concatenate([none, np.sin(angle / 2)[..., None], np.cos(angle / 2)[..., None]], axis=2),
        spin=np.concatenate([none, rate[..., None]], axis=2),
    )  # fmt: skip
    return with_world(
        made, gears=[Gear(prim="/World/gear", first="/World/axle_0", second="/World/axle_1", ratio=ratio)]
    )


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


@pytest.mark.parametrize("ratio", [-2.0, 0.5])
def test_a_pair_shares_its_inertia(ratio):
    moments = [0.4 * mass * 0.1**2 for mass in (2.0, 8.0)]
    right = EFFORT / (moments[0] + ratio**2 * moments[1])
    assert accepted(pair(ratio, right, EFFORT))
    for share in (EFFORT / moments[0] / right, 0.5, 0.9, 1.1):
        assert not accepted(pair(ratio, share * right, EFFORT))


@pytest.mark.parametrize("frictions", [(0.5, 0.5), (0.3, 1.0), (1.0, 0.3), (0.0, 1.0)])
def test_a_pair_that_rubs_on_both_axles_starts_from_rest(frictions):
    """In the first interval nobody knows how much each rubs: it was held against what is least in all, of which one
    drives on, and left up to half of what it gives."""
    ratio, moments = -0.5, [0.4 * mass * 0.1**2 for mass in (2.0, 8.0)]
    effort = 10.0 * EFFORT
    right = (effort - frictions[0] + ratio * frictions[1]) / (moments[0] + ratio**2 * moments[1])
    assert accepted(pair(ratio, right, effort, frictions=frictions))
    for share in (0.9, 1.1):
        assert not accepted(pair(ratio, share * right, effort, frictions=frictions))


def test_a_free_pair_goes_on():
    assert accepted(pair(-2.0, 0.0, start=5.0))
    assert not accepted(pair(-2.0, -0.5, start=5.0))


def test_wheels_may_reach_into_each_other_by_their_teeth(tmp_path):
    """What is in mesh does not touch: the simulator finds no contact there, and the judge no overlap."""
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=100.0, gravity=(0, 0, 0))
    for name, radius, x in (("small", 0.1, 0.0), ("large", 0.2, 0.28)):
        scene.cylinder(name, radius=radius, height=0.05, axis="Y", position=(x, 0, 1), mass=2.0)
        scene.joint_revolute(f"axle_of_{name}", None, name, axis="Y")
    scene.gear("mesh", "axle_of_small", "axle_of_large", ratio=-0.5)
    evidence = Evidence(collect(Simulation(scene.save(tmp_path / "wheels.usda"), "cpu")).recording(0))
    found = [*CheckPenetration().run(evidence), *CheckRecordedDepth().run(evidence)]
    assert found and all(finding.passed for finding in found)
