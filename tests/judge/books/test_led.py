"""What is led does work through springs, ropes, joints and contacts: no gain, as far as it pays for it, and no more."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books.led import Led, works
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

FLOATS = {"gravity": (0, 0, 0)}


def belt(scene, stiffness=15.0, damping=0.0):
    """A block on a belt, held by a spring: 0.5 m/s, μ g = 2.9 m/s²."""
    scene.box("belt", size=(3, 0.5, 0.1), position=(0, 0, -0.05), static=True, friction=0.3)
    scene.surface_velocity("belt", velocity=(0.5, 0, 0))
    scene.box("block", size=(0.2, 0.2, 0.1), mass=2.0, position=(0, 0, 0.05))
    held(scene, stiffness, damping)


def held(scene, stiffness, damping=0.0):
    scene.spring("coil", None, "block", anchor_a=(-1, 0, 0.05), anchor_b=(-0.1, 0, 0.05), stiffness=stiffness,
                 damping=damping)  # fmt: skip


def plate(scene):
    """One on a plate that a path leads to and fro, on which it slips and sticks."""
    scene.box("plate", size=(2, 1, 0.1), position=(0, 0, -0.05), kinematic=True, friction=0.4)
    scene.path("plate", times=[0, 0.25, 0.5], positions=[(0, 0, -0.05), (0.1, 0, -0.05), (0, 0, -0.05)], repeat=True)
    scene.box("block", size=(0.2, 0.2, 0.1), mass=2.0, position=(0, 0, 0.05))
    held(scene, 150.0)


def tow(scene, damping=0.0):
    """A body in free space that another tows by a spring."""
    scene.simulation(**FLOATS)
    scene.box("tug", size=(0.1, 0.1, 0.1), position=(0, 0, 1), kinematic=True, velocity=(1, 0, 0))
    scene.sphere("load", radius=0.1, mass=1.0, position=(-0.6, 0, 1))
    scene.spring("coil", "tug", "load", stiffness=100.0, damping=damping)


def series(scene):
    """Two springs in series with a body between."""
    tow(scene)
    scene.sphere("last", radius=0.1, mass=2.0, position=(-1.2, 0, 1))
    scene.spring("second", "load", "last", stiffness=100.0, damping=1.0)


def shaken(scene, tie="spring"):
    """A weight that hangs on what a path leads to and fro."""
    scene.box("tug", size=(0.1, 0.1, 0.1), position=(0, 0, 1.5), kinematic=True)
    scene.path("tug", times=[0, 0.4, 0.8], positions=[(0, 0, 1.5), (0.2, 0, 1.5), (0, 0, 1.5)], repeat=True)
    scene.sphere("load", radius=0.1, mass=1.0, position=(0, 0, 1))
    scene.rope("tie", "tug", "load") if tie == "rope" else scene.spring("tie", "tug", "load", stiffness=100.0)


def shaken_rope(scene):
    shaken(scene, "rope")


def hoist(scene):
    """A weight on a rope over a post, which a kinematic body hoists."""
    scene.cylinder("post", radius=0.1, height=0.4, axis="Y", position=(0, 0, 2), static=True)
    scene.sphere("load", radius=0.1, mass=5.0, position=(0.1, 0, 0.5))
    scene.box("tug", size=(0.1, 0.1, 0.1), position=(-0.1, 0, 1), kinematic=True, velocity=(0, 0, -0.5))
    scene.rope("rope", "tug", "load", around=["post"])


def lift(scene):
    """A lift, on which stands what a spring holds up as well."""
    scene.box("lift", size=(0.5, 0.5, 0.1), position=(0, 0, 0.5), kinematic=True, velocity=(0, 0, 0.5))
    scene.box("load", size=(0.2, 0.2, 0.1), mass=2.0, position=(0, 0, 0.6))
    scene.spring("coil", None, "load", anchor_a=(0, 0, 2), anchor_b=(0, 0, 0.65), stiffness=40.0)


def pushed(scene):
    """A block that is pushed over the ground against a spring."""
    scene.ground(friction=0.3)
    scene.box("pusher", size=(0.1, 0.3, 0.1), position=(-0.2, 0, 0.06), kinematic=True, velocity=(0.3, 0, 0))
    scene.box("block", size=(0.2, 0.2, 0.1), mass=2.0, position=(0, 0, 0.05))
    scene.spring("coil", None, "block", anchor_a=(1, 0, 0.05), anchor_b=(0.1, 0, 0.05), stiffness=100.0)


def trailer(scene):
    """A block that is pushed and tows another over the ground by a rope beside its middle."""
    scene.ground(friction=0.3)
    scene.box("pusher", size=(0.1, 0.3, 0.1), position=(-0.2, 0, 0.06), kinematic=True, velocity=(0.3, 0, 0))
    scene.box("block", size=(0.2, 0.2, 0.1), mass=2.0, position=(0, 0, 0.05))
    scene.box("cart", size=(0.2, 0.2, 0.1), mass=2.0, position=(-0.8, 0, 0.05))
    scene.rope("rope", "block", "cart", anchor_a=(0, 0.1, 0.05), anchor_b=(-0.8, 0.1, 0.05))


def hinged(scene):
    """A pendulum on a body that goes evenly."""
    scene.box("tug", size=(0.1, 0.1, 0.1), mass=1.0, position=(0, 0, 1.5), kinematic=True, velocity=(0.7, 0, 0))
    scene.sphere("bob", radius=0.1, mass=1.0, position=(0.3, 0, 1.1))
    scene.joint_revolute("pivot", "tug", "bob", axis="Y", anchor=(0, 0, 1.5))


WORLDS = [belt, plate, tow, series, shaken, shaken_rope, hoist, lift, pushed, trailer, hinged]


def stage(folder, build, seconds=0.8):
    scene = Scene()
    scene.simulation(duration=seconds, frame_rate=60.0)
    build(scene)
    return scene.save(folder / "stage.usda")


def record(folder, build, seconds=0.8):
    Simulation(stage(folder, build, seconds), device="cpu").run(folder / "run.rrd")
    return read(folder / "run.rrd")


def alone(recording):
    """Without what contacts and ties gave."""
    return replace(recording, contacts=None, ties=None)


def faster(recording, share):
    """From halfway on bodies go their way faster, or slower, by what nothing gives or takes: places, too."""
    q, qd = np.array(recording.body_q, dtype=np.float64), np.array(recording.body_qd, dtype=np.float64)
    ours = [i for i, body in enumerate(recording.world.bodies) if not body.kinematic]
    ramp = np.clip((np.arange(len(q)) - len(q) // 2) / 6.0, 0.0, 1.0)
    more = (np.sqrt(1.0 + share) - 1.0) * ramp**2 * (3.0 - 2.0 * ramp)
    qd[:, ours, :3] *= 1.0 + more[:, None, None]
    way = np.diff(q[:, ours, :3], axis=0) * 0.5 * (more[1:] + more[:-1])[:, None, None]
    q[1:, ours, :3] += np.cumsum(way, axis=0)
    return replace(recording, body_q=q, body_qd=qd)


def wrong(recording):
    """What the energy budget finds: "gains", "loses"."""
    found = [finding.message for finding in ask(CheckEnergy(), recording) if not finding.passed]
    return {word for word in ("gains", "loses") for message in found if word in message}


@pytest.mark.parametrize("build", WORLDS)
def test_what_is_led_pays_for_what_it_moves_and_for_nothing_else(tmp_path, build):
    """Of a tenth of what moves, which nothing gives or takes, all is found."""
    run = record(tmp_path, build)
    assert wrong(run) == wrong(alone(run)) == set()
    assert wrong(faster(run, 0.1)) != set()
    assert wrong(faster(run, -0.1)) != set()


@pytest.mark.parametrize(("by", "found"), [(1.15, {"loses"}), (0.85, {"gains"})], ids=["more", "less"])
@pytest.mark.parametrize("build", [tow, belt])
def test_damping_that_is_another(tmp_path, build, by, found):
    """Of a spring between a led body and a loose one, and of one that holds what a belt moves."""
    run = record(tmp_path, lambda scene: build(scene, damping=3.0 * by))
    stated = describe(stage(tmp_path, lambda scene: build(scene, damping=3.0)))
    assert wrong(replace(run, world=stated)) == found


@pytest.mark.parametrize("build", [shaken, shaken_rope])
def test_half_a_step_of_what_a_path_leads_adds_up_to_nothing(tmp_path, build):
    """Its velocity is that of the step before: with it springs' work would be 0.8 % of the energy a second too much."""
    run = record(tmp_path, build, seconds=3.0)
    evidence = Evidence(run)
    motion, led = evidence.motion, Led.of(evidence)
    energy = (motion.kinetic + motion.potential + motion.elastic - led.work)[:, 1]
    assert motion.kinetic.max() > 0.3
    # Steps of the first order show up to half a step's fall less.
    swing = motion.kinetic[:, 1].max() * 1e-3 + 0.5 * motion.dt * 9.81 * np.abs(motion.v[:, 1, 2]).max()
    assert np.abs(energy - energy[0]).max() < swing


def test_what_is_not_told_of_one_mechanism_hides_nothing_of_another(tmp_path):
    """A rope's pull on a led body is not known without a record; of a ball that flies beside it all is."""

    def build(scene):
        scene.simulation(**FLOATS)
        scene.box("tug", size=(0.1, 0.1, 0.1), position=(0, 0, 1), kinematic=True, velocity=(1, 0, 0))
        scene.sphere("load", radius=0.1, mass=1.0, position=(-0.6, 0, 1))
        scene.rope("rope", "tug", "load", length=0.65)
        scene.sphere("ball", radius=0.1, mass=1.0, position=(0, 3, 1), velocity=(0, 1, 0))

    run = alone(record(tmp_path, build))
    assert wrong(run) == set()
    assert wrong(faster(run, 0.1)) == {"gains"}


def test_the_work_of_a_force_that_changes_as_what_it_moves_does(tmp_path):
    """∫ sin(w t) (1 + cos(w t)) dt by the impulses of intervals of 0.25 rad: to 1e-3 of 1 / w, and as it says."""
    run = record(tmp_path, tow)
    t, w = run.time, 15.0
    force = np.diff(-np.cos(w * t) / w)[:, None]
    speed = 1.0 + np.cos(w * t)
    mean = (np.diff(t + np.sin(w * t) / w) / np.diff(t))[:, None]
    work, unsure = works(Evidence(run), force, mean, np.diff(speed)[:, None])
    exact = np.diff(-np.cos(w * t) / w - np.cos(2.0 * w * t) / (4.0 * w))
    off = np.abs(np.cumsum(work - exact))
    assert off.max() < 1e-3 / w
    assert np.all(off <= np.cumsum(unsure))
