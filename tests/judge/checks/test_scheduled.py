"""What happens by time is judged: as it is scheduled it is accepted, weaker or later it is not."""

from dataclasses import replace
from pathlib import Path

import pytest

from wsim.judge import judge
from wsim.judge.books.recorded import RecordedContacts
from wsim.recording import read
from wsim.scene import Drive, Event, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

LATE = 0.3  # [s]


def pushed(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    """A block on the floor, a rotor on its axle and a motor."""
    scene.box("block", size=(0.2,) * 3, mass=10.0, position=(0, 0, 0.1), friction=0.2)
    scene.schedule("push", "block", "force", times=[0.1 + late, 0.5 + late], values=[(40 * share, 0, 0), (0, 0, 0)])


def spun(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    scene.cylinder("rotor", radius=0.2, height=0.05, mass=2.0, position=(0, 2, 1))
    axle = scene.joint_revolute("axle", None, "rotor", axis="Z")
    scene.schedule("spin", axle, "effort", times=[0.1 + late, 0.6 + late], values=[0.1 * share, 0])


def driven(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    scene.cylinder("wheel", radius=0.2, height=0.05, mass=2.0, position=(0, 4, 1))
    motor = scene.joint_revolute("motor", None, "wheel", axis="Z", drive=Drive(velocity=90, damping=5))
    scene.schedule("turn", motor, "velocity", times=[0.2 + late], values=[180 * share])


def lifted(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    scene.box("gate", size=(0.1, 1, 1), position=(0, -3, 0.6), kinematic=True)
    scene.schedule("lift", "gate", "velocity", times=[0.1 + late, 0.6 + late], values=[(0, 0, 0.5 * share), (0, 0, 0)])


def carried(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    belt = scene.box("belt", size=(6, 0.5, 0.2), position=(0, 3, 0.5), static=True, friction=0.3)
    scene.surface_velocity(belt, velocity=(1, 0, 0))
    scene.box("parcel", size=(0.2,) * 3, mass=2, position=(-1, 3, 0.7), friction=0.3, velocity=(1, 0, 0))
    scene.schedule("slow", belt, "surface_velocity", times=[0.2 + late], values=[(0.5 * share, 0, 0)])


def dropped(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    scene.sphere("weight", radius=0.1, mass=1, position=(-3, -3, 5))
    hook = scene.joint_fixed("hook", None, "weight")
    scene.schedule("drop", hook, "release", times=[0.2 + late])


def thawed(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    scene.box("sled", size=(0.3, 0.2, 0.1), mass=3, position=(-4, 0, 0.05), velocity=(2, 0, 0))
    scene.contact("sled", "ground", friction=0.3)
    scene.schedule("thaw", ("sled", "ground"), "friction", times=[0.1 + late], values=[0.05 * share])


def told(scene: Scene, share: float = 1.0, late: float = 0.0) -> None:
    """A ball's touch starts a push."""
    scene.sphere("ball", radius=0.05, mass=0.5, position=(0, -6, 0.25), restitution=0.3)
    scene.box("cube", size=(0.2,) * 3, mass=1.0, position=(2, -6, 3))
    touch = Event(touch=("ball", "ground"), delay=0.1 + late)
    scene.schedule("blow", "cube", "force", times=[0.0, 0.2], values=[(5 * share, 0, 0), (0, 0, 0)], after=touch)


ALL = (pushed, spun, driven, lifted, carried, dropped, thawed, told)


def recorded(folder: Path, *parts, **fault):
    """The stage of some parts, and the recording of a run of it."""
    scene = Scene()
    scene.ground(friction=0.3)
    for part in parts:
        part(scene, **fault)
    scene.simulation(duration=1.0, frame_rate=24)
    stage = scene.save(folder / "stage.usda")
    assert Simulation(stage, "cpu").run(folder / "run.rrd").problems == []
    return describe(stage), read(folder / "run.rrd")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """All of them, as scheduled."""
    return recorded(tmp_path_factory.mktemp("sound"), *ALL)


def test_what_happens_as_it_is_scheduled_is_accepted(sound):
    verdict = judge(sound[1])
    assert verdict.status == "accepted", [(f.check, f.message) for f in verdict.failures]
    asked = {finding.check for finding in verdict.findings}
    assert {"CheckSchedules", "CheckPath", "CheckForces", "CheckRecordedTies"} <= asked


FAULTS = [(part, {"share": 0.8}) for part in ALL if part is not dropped] + [(part, {"late": LATE}) for part in ALL]


@pytest.mark.parametrize(("part", "fault"), FAULTS, ids=lambda each: getattr(each, "__name__", str(each)))
def test_what_is_a_fifth_weaker_or_late_is_rejected(part, fault, tmp_path):
    """The recording is of a world in which it was so, and says that it was another's."""
    scene = Scene()
    scene.ground(friction=0.3)
    part(scene)
    scene.simulation(duration=1.0, frame_rate=24)
    world = describe(scene.save(tmp_path / "true.usda"))
    verdict = judge(replace(recorded(tmp_path, part, **fault)[1], world=world))
    assert verdict.status == "rejected" and not verdict.crashes


def test_a_push_that_is_recorded_as_scheduled_and_was_none_is_missing_in_the_books(sound, tmp_path):
    """Whoever writes the impulses that were due still has a block that moves by others."""
    world, right = sound
    wrong = recorded(tmp_path, *ALL, share=0.8)[1]
    told_ = replace(wrong, world=world, scheduled=right.scheduled, applied_impulse=right.applied_impulse)
    failed = {finding.check for finding in judge(told_).failures}
    assert failed & {"CheckForces", "CheckRecordedForces"} and "CheckSchedules" in failed  # of its motor


def test_a_schedule_whose_event_does_not_come_is_told_of(tmp_path):
    def waits(scene):
        scene.box("cart", size=(0.2,) * 3, mass=1, position=(0, 9, 0.5), kinematic=True)
        scene.sphere("ball", radius=0.05, mass=0.5, position=(0, 0, 0.05))
        far = Event(body="ball", axis="X", above=1.0)
        scene.schedule("go", "cart", "velocity", times=[0.0], values=[(1, 0, 0)], after=far)

    failed = [f for f in judge(recorded(tmp_path, waits)[1]).failures if f.check == "CheckSchedules"]
    assert [f.message for f in failed] == ["go never begins: that ball is above 1 m along X does not come in 1 s"]


@pytest.mark.parametrize(
    ("rate", "times", "linear"), [(60, (0.2,), False), (100, (0.2, 0.21), False), (60, (0.2, 0.25), True)]
)
def test_an_effort_that_jumps_between_steps_of_the_fourth_order_is_not_missed(tmp_path, rate, times, linear):
    """Its mean over a step is its value in it: half a step of the jump was missing in the frame of the jump."""
    scene = Scene()
    scene.box("cart", size=(0.2,) * 3, mass=2.0, position=(0, 0, 1))
    rail = scene.joint_prismatic("rail", None, "cart", axis="X")
    values = [10.0 * (k + 1 - linear) for k in range(len(times))]
    scene.schedule("pull", rail, "effort", times=times, values=values, linear=linear)
    scene.simulation(duration=0.5, frame_rate=rate)
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu").run(tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    verdict = judge(recording)
    assert verdict.status == "accepted", [(f.check, f.message) for f in verdict.failures]
    if times == (0.2,):
        assert recording.body_qd[-1, 0, 0] == pytest.approx(10.0 / 2.0 * 0.3, rel=1e-5)


@pytest.mark.parametrize("spread", [True, False])
def test_a_landing_within_a_frame_has_the_friction_of_its_instant(spread, tmp_path, monkeypatch):
    """What presses while friction runs from 0.5 to nought rubs with that of then: the frame's mean is another."""

    def lands(scene):
        for k in range(6):
            at = (-4, 2 * k, 0.06 + 0.04 * k)
            scene.box(
                f"sled_{k}", size=(0.3, 0.2, 0.1), mass=3, position=at, velocity=(3, 0, 0), rotation_deg=(0, 4, 0)
            )
            scene.contact(f"sled_{k}", "ground", friction=0.5)
            scene.schedule(f"thaw_{k}", (f"sled_{k}", "ground"), "friction", times=[0.0, 0.4], values=[0.5, 0.02],
                           linear=True)  # fmt: skip

    if not spread:
        monkeypatch.setattr(RecordedContacts, "spread", 0.0)
    verdict = judge(recorded(tmp_path, lands)[1])
    assert (verdict.status == "accepted") == spread, [(f.check, f.message) for f in verdict.failures]
