"""Springs, drives, dry friction and stops: simulated as one world has them, judged as another states them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import ask, with_world
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded_ties import CheckRecordedTies
from wsim.scene import Drive


def hung(scene):
    scene.sphere("bob", radius=0.08, density=900, position=(0, 0, 1.2))
    scene.spring("coil", None, "bob", stiffness=120, damping=0.5, rest_length=0.6, anchor_a=(0, 0, 2))


def arm(scene):
    scene.box("arm", size=(0.6, 0.06, 0.06), density=400, position=(0.3, 0, 1))
    scene.joint_revolute(
        "elbow", None, "arm", axis="Y", anchor=(0, 0, 1), drive=Drive(position=20, stiffness=14, damping=1)
    )


def wheel(scene):
    scene.cylinder("wheel", radius=0.2, height=0.05, density=800, position=(0, 0, 1), angular_velocity_deg=(0, 0, 900))
    scene.joint_revolute("axle", None, "wheel", axis="Z", anchor=(0, 0, 1), friction=0.4)


def door(scene):
    scene.box("door", size=(0.8, 0.04, 0.3), density=200, position=(0.4, 0, 1), velocity=(0, 0.6, 0),
              angular_velocity_deg=(0, 0, math.degrees(1.5)))  # fmt: skip
    scene.joint_revolute("hinge", None, "door", axis="Z", anchor=(0, 0, 1), limits_deg=(-90, 40))


def off(findings):
    return [finding.message for finding in findings if not finding.passed]


def changed(recording, folder, name, **fields):
    """The same motion in a world that states something else of one thing."""
    things = [
        thing.model_copy(update=fields) if thing.prim.endswith("/" + name) else thing
        for thing in getattr(recording.world, folder)
    ]
    return with_world(recording, **{folder: things})


def driven(recording, **fields):
    drive = recording.world.joints[0].drive.model_copy(update=fields)
    return changed(recording, "joints", "elbow", drive=drive)


@pytest.mark.parametrize(("build", "wrong"), [
    (hung, lambda r: changed(r, "springs", "coil", stiffness=132.0)),
    (hung, lambda r: changed(r, "springs", "coil", rest_length=0.63)),
    (arm, lambda r: driven(r, stiffness=15.4)),
    (arm, lambda r: driven(r, damping=1.3)),
    (arm, lambda r: driven(r, max_effort=2.0)),
    (wheel, lambda r: changed(r, "joints", "axle", friction=0.44)),
    (wheel, lambda r: changed(r, "joints", "axle", friction=0.0)),
    (door, lambda r: changed(r, "joints", "hinge", low=None, high=None)),
])  # fmt: skip
def test_what_is_a_tenth_off_is_found(tmp_path, build, wrong):
    """By a tenth of stiffness, friction, rest length, by three tenths of damping; a stop that nothing states.

    Where it is recorded what ties gave, that explains the motion, and is held against the laws by itself.
    """
    recording = simulated(tmp_path, build, 1.0)
    for check in (CheckForces(), CheckRecordedTies()):
        assert off(ask(check, recording)) == []
    assert off(ask(CheckForces(), replace(wrong(recording), ties=None))) != []
    assert off(ask(CheckRecordedTies(), wrong(recording))) != []


def net(scene):
    """A light ball between heavier ones, under the ceiling: it swings by 1.1 rad a frame, at 40 of them a second."""
    for name, mass, place in (
        ("heavy", 1.0, (0.1, 0, 1.4)), ("light", 0.05, (0.5, 0.2, 1.1)), ("low", 0.3, (0.2, 0.1, 0.7)),
    ):  # fmt: skip
        scene.sphere(name, radius=0.04, mass=mass, position=place, velocity=(0.5, -1.0, 0.2 / mass**0.5))
    scene.spring("a", None, "heavy", stiffness=60, rest_length=0.5, anchor_a=(0, 0, 2))
    scene.spring("b", "heavy", "light", stiffness=80, rest_length=0.35)
    scene.spring("c", "light", "low", stiffness=25, rest_length=0.4)


def grid(scene):
    """A plate on sixteen springs: it bounces by 0.8 rad a frame, at 40 of them a second, each spring alone by 0.2."""
    scene.box("plate", size=(0.6, 0.6, 0.06), mass=4.0, position=(0, 0, 1), velocity=(0, 0, 0.6))
    for k, x in enumerate(np.linspace(-0.28, 0.28, 4)):
        for j, y in enumerate(np.linspace(-0.28, 0.28, 4)):
            ends = {"anchor_a": (x, y, 0.4), "anchor_b": (x, y, -0.03)}
            scene.spring(f"s{k}{j}", None, "plate", stiffness=256.0, rest_length=0.5, **ends)


def test_one_of_many_springs_is_held_to_its_law(tmp_path):
    """Together they turn and lift the plate by a mode each, and none of these is as fast as their sum."""
    recording = simulated(tmp_path, grid, 0.6, 40)

    def wrong(found):
        return off(ask(CheckForces(), found)) + off(ask(CheckRecordedTies(), found))

    assert wrong(recording) == []
    for factor in (0.9, 1.1):
        assert wrong(changed(recording, "springs", "s00", stiffness=factor * 256.0)) != []


@pytest.mark.parametrize("bare", [True, False])
def test_light_balls_between_springs_swing_by_a_radian_a_frame(tmp_path, bare):
    """They are right, and a spring that is a tenth stiffer is not: by its energy, if not by its force."""
    recording = simulated(tmp_path, net, 1.5, 40)
    recording = replace(recording, ties=None) if bare else recording
    checks = (CheckForces(), CheckRecordedTies(), CheckEnergy())

    def wrong(found):
        return [message for check in checks for message in off(ask(check, found))]

    assert wrong(recording) == []
    for name, spring in (("a", 60), ("b", 80), ("c", 25)):
        assert wrong(changed(recording, "springs", name, stiffness=1.1 * spring)) != []


def test_a_stop_pushes_and_does_not_pull(tmp_path):
    """Turned back in time the door leaves its stop as it came; mirrored it is held where no stop is."""
    recording = simulated(tmp_path, door, 1.0)
    assert off(ask(CheckForces(), changed(recording, "joints", "hinge", low=math.radians(40.0), high=None))) != []
