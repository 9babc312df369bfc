"""Heaps that a ball strikes: what the simulator does is accepted, and a friction that is not theirs is found."""

from dataclasses import replace

import pytest

from benchmarks.judge_families import heaps  # noqa: F401 - registers its worlds
from benchmarks.judge_families.drawn import MECHANISMS, Sound
from wsim.judge import judge
from wsim.recording import read
from wsim.sim import Simulation

# A card that a ball bounces off slips on as it is knocked; the lowest box of a stack slips and stands again between two
# frames; a box on a roller across a dome; cards that lie on each other's faces; a card whose edge a blow presses on the
# ground; a drum that rolls over the edge of a box; a capsule across a drum's rim; a
# drum that wobbles on its rim; a capsule whose slip turns as it lands; a ball that comes over a box's edge; a ball to
# and fro between two others.
WORLDS = [
    ("struck row", 3), ("struck stack", 10), ("struck pile", 46), ("struck row", 41), ("struck row", 4),
    ("struck pile", 30), ("struck pile", 26129), ("struck pile", 26148),
    ("struck pile", 26111), ("struck stack", 26150), ("struck row", 26115), ("struck pile", 6),
]  # fmt: skip


@pytest.fixture(scope="module", params=WORLDS, ids=[f"{name} {k}" for name, k in WORLDS])
def recording(request, tmp_path_factory):
    return simulated(*request.param, tmp_path_factory.mktemp("heap"))


def simulated(name, k, folder):
    Simulation(Sound(MECHANISMS[name], k).scene().save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def failed(recording):
    return [f"{finding.check}: {finding.message}" for finding in judge(recording).failures]


def test_what_is_struck_is_accepted(recording):
    assert failed(recording) == []


def test_it_is_accepted_without_the_contacts_recorded(recording):
    assert failed(replace(recording, contacts=None, ties=None)) == []


def slippery(recording):
    """The same motion, of a world whose bodies are said to rub by half."""
    bodies = [
        body.model_copy(
            update={"shapes": [each.model_copy(update={"friction": 0.5 * each.friction}) for each in body.shapes]}
        )
        for body in recording.world.bodies
    ]
    return replace(recording, world=recording.world.model_copy(update={"bodies": bodies}))


def test_half_of_its_friction_is_found(recording):
    assert failed(slippery(recording))


def test_a_stack_that_sways_faster_than_frames_follow_is_accepted(tmp_path):
    """Its lower boxes go 26 um and come to rest again between frames; no slip lasts that would tell its friction."""
    recording = simulated("struck stack", 6, tmp_path)
    assert failed(recording) == []
    assert failed(replace(recording, contacts=None, ties=None)) == []


def test_half_the_friction_of_such_a_stack_is_found_where_frames_show_its_slip(tmp_path):
    """The box that is hit goes at J / m = 0.062 m/s and is stopped within 5 ms by mu (N + N') / m = 12 m/s^2: by what
    it bears at the most 0.36 of half of that, summed over a frame of 42 ms, which the blow may have had all at once.
    """
    scene = Sound(MECHANISMS["struck stack"], 6).scene()
    scene.simulation(duration=0.15, frame_rate=600.0)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    assert failed(recording) == []
    assert failed(slippery(recording))
