"""What is made of several bodies: its name means its base, and what presses on any part of it presses on it."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ball, box, ground, record, slab, times, with_world
from wsim.assets.policies import Observation, PolicySpec
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import Signals, evaluate, parse
from wsim.judge.repair.walking import by_policy
from wsim.recording.contacts import ContactTrack
from wsim.scene.world import Joint, Motor, Policy

T = times(1.0, 10.0)
# Shapes as a recording counts them: of the leg, the base and a ball, then of the ground and a wall.
LEG, BASE, BALL, GROUND, WALL = range(5)


def robot(pushes, contacts=True):
    """A robot of a leg and a base that goes along x at 1 m/s; pushes: frame, one shape, the other, N s."""
    bodies = [ball("dog/leg"), box("dog/base"), ball("ball")]
    place = np.zeros((len(T), 3, 3))
    place[:, :2, 0] = T[:, None]
    place[:, 2] = [0.0, 2.0, 0.1]
    velocity = np.broadcast_to([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]], place.shape)
    made = record(bodies, place, velocity, T, statics=[ground(), slab("wall", (0.1, 2.0, 2.0), (3.0, 0.0, 1.0))])
    hip = Joint(prim="/World/dog/joints/hip", kind="revolute", parent="/World/dog/base", child="/World/dog/leg")
    made = with_world(made, joints=[hip])
    sums = np.zeros((len(pushes), 16), np.float32)
    sums[:, 3] = [each[3] for each in pushes]
    track = ContactTrack(
        np.array([each[0] for each in pushes], np.int32),
        np.array([each[1:3] for each in pushes], np.int32).reshape(-1, 2), sums,
    )  # fmt: skip
    return Signals.of(Evidence(replace(made, contacts=track if contacts else None)))


def asked(text, signals):
    return evaluate(parse(text), signals)


def test_its_name_means_the_body_that_hangs_on_no_other_of_it():
    signals = robot([])
    assert signals.prim("dog") == "/World/dog/base"
    assert asked("reaches(dog, (0.5, 0, 0), within 1 cm)", signals).satisfied[0]
    assert signals.prim("/World/dog/leg") == "/World/dog/leg"
    assert signals.parts("dog") == {"/World/dog/base", "/World/dog/leg"}
    with pytest.raises(MissingError, match="the world has no 'cat'"):
        signals.prim("cat")


def test_what_it_stands_on_is_a_part_of_it():
    """A robot whose base is static has the base's prim for its own: what presses on that presses on the robot."""
    bodies = [ball("arm/link"), ball("brick")]
    place = np.zeros((len(T), 2, 3))
    made = record(bodies, place, place, T, statics=[ground(), slab("arm", (0.1, 0.1, 0.5), (3.0, 0.0, 0.25))])
    signals = Signals.of(Evidence(made))
    assert signals.prim("arm") == "/World/arm"
    assert signals.parts("arm") == {"/World/arm", "/World/arm/link"}


def test_what_presses_on_any_part_of_it_is_told_by_its_force():
    """Its leg stands on the ground with 4 N s a frame and presses its own base; 0.3 N s of the wall are 3 N."""
    stands = [(k, GROUND, LEG, 4.0) for k in range(1, len(T))] + [(3, LEG, BASE, 1.0), (4, GROUND, BALL, 9.0)]
    fine = asked("touches_only(dog, ground)", robot(stands))
    assert fine.satisfied[0] and fine.margin[0] == 0.0
    hit = robot([*stands, (6, WALL, BASE, 0.3), (6, LEG, WALL, 0.2)])
    found = asked("touches_only(dog, ground)", hit)
    assert not found.satisfied[0]
    assert found.margin[0] == pytest.approx(-5.0)  # sizes are added: they push it to and fro
    assert found.moment[0] == pytest.approx(0.6)
    assert found.measures[int(found.measure[0])].what == "force by which /World/wall presses on it"
    assert asked("touches_only(dog, ground, wall)", hit).satisfied[0]
    assert asked("always[0.7, 1] (touches_only(dog, ground))", hit).satisfied[0]


def test_without_contacts_nothing_is_said():
    with pytest.raises(MissingError, match="has no contacts"):
        asked("touches_only(dog, ground)", robot([], contacts=False))


def test_what_to_change_is_its_policy_or_that_it_has_none():
    """A base with two servos on it walks by a policy alone; what has none is told to have one."""
    servos = [
        Joint(prim=f"/World/dog/joints/{side}", kind="revolute", parent="/World/dog/base", child="/World/dog/leg",
              drive=Motor(stiffness=20.0, damping=0.5))
        for side in ("left", "right")
    ]  # fmt: skip
    evidence = robot([]).evidence
    none = Evidence(with_world(evidence.recording, joints=servos))
    walks = Policy(
        prim="/World/walk", base="/World/dog/base", joints=[], network="", sha256="", route=[(1.0, 0.0, 0.0)],
        spec=PolicySpec(joints=["hip"], rate=50.0, observations=[Observation(of="command")]),
    )  # fmt: skip
    walked = Evidence(with_world(evidence.recording, joints=servos, policies=[walks]))
    found = [by_policy(each, "/World/dog/base") for each in (none, walked)]
    assert [each.sentence for each in found] == ["add policy of /World/dog", "change route of /World/walk"]
    assert by_policy(walked, "/World/ball") is None and by_policy(evidence, "/World/dog/base") is None
