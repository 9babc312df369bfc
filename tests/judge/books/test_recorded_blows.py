"""Blows whose impulses are recorded: on a door, on a rod's end, of what spins, of billiard balls, each by itself.

What is run is as stated; then one number of one body is told otherwise, and the check must say so.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask, with_world
from wsim.judge.books.recorded_blows import recorded_blows
from wsim.judge.checks.impacts import CheckBlowFriction, CheckRestitution
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

E, MU = 0.6, 0.2


@pytest.fixture(scope="module", params=[24.0, 60.0], ids=["24/s", "60/s"])
def recording(request, tmp_path_factory):
    """Each thing meets one other in 0.5 s; what is hit states nothing that counts."""
    folder, scene = tmp_path_factory.mktemp("blows"), Scene()
    scene.simulation(duration=0.5, frame_rate=request.param)
    scene.ground(friction=1.0, restitution=1.0)
    hit, own = {"friction": 1.0, "restitution": 1.0, "mass": 2.0}, {"friction": MU, "restitution": E, "mass": 0.8}
    door = scene.box("door", size=(0.8, 0.05, 1.0), position=(0.4, 0, 2.0), **hit)
    scene.joint_revolute("hinge", None, door, anchor=(-0.4, 0, 0), axis="Z")
    scene.sphere("at_door", radius=0.06, position=(0.6, -0.68, 2.2), velocity=(-0.5, 3, 0), **own)
    link = scene.cylinder("link", radius=0.02, height=0.8, position=(5, 0, 2.6), **hit)
    scene.joint_revolute("pivot", None, link, anchor=(0, 0, 0.4), axis="X")
    scene.sphere("at_link", radius=0.06, position=(5, -0.68, 2.6), velocity=(0, 3, 0), **own)
    scene.cylinder("rod", radius=0.03, height=0.6, axis="X", position=(10, 0, 3), **hit)
    scene.sphere("at_rod", radius=0.06, position=(10.25, -0.69, 3.01), velocity=(0, 3, 0), **own)
    scene.box(
        "spinner", size=(0.2, 0.2, 0.2), position=(15, 0, 0.6), rotation_deg=(30, 20, 0), velocity=(2, 0, -2),
        angular_velocity_deg=(200, -400, 300), **own,
    )  # fmt: skip
    scene.capsule(
        "stick", radius=0.04, height=0.4, position=(20, 0, 0.7), rotation_deg=(0, 50, 0), velocity=(3, 0, -2), **own
    )
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def told(recording, name, **numbers):
    """A body's surfaces as another world states them."""
    bodies = [
        body.model_copy(update={"shapes": [shape.model_copy(update=numbers) for shape in body.shapes]})
        if body.prim == f"/World/{name}"
        else body
        for body in recording.world.bodies
    ]
    return with_world(recording, bodies=bodies)


def test_what_is_stated_is_found_in_each(recording):
    found = recorded_blows(Evidence(recording))
    met = {prim.split("/")[-1] for blow in found for prim in blow.prims}
    assert {"at_door", "at_link", "at_rod", "spinner", "stick"} <= met
    for blow in found:
        least, most = (E * blow.approach - spent for spent in reversed(blow.spent))
        unsure = 0.005 * blow.approach + blow.unsure
        assert least - unsure <= blow.parting <= most + unsure
    for check in (CheckRestitution(), CheckBlowFriction()):
        assert all(finding.passed for finding in ask(check, recording))


@pytest.mark.parametrize("name", ["at_door", "at_link", "at_rod", "spinner", "stick"])
@pytest.mark.parametrize("share", [0.9, 0.95, 1.05, 1.1])
def test_a_restitution_that_is_told_otherwise_is_found(recording, name, share):
    finding = ask(CheckRestitution(), told(recording, name, restitution=share * E))[0]
    assert not finding.passed
    assert name in finding.message


@pytest.mark.parametrize("share", [0.9, 0.95, 1.05, 1.1])
def test_a_friction_that_is_told_otherwise_is_found_where_slips_last(recording, share):
    """Of the stick: it glances off the ground, and slips on."""
    finding = ask(CheckBlowFriction(), told(recording, "stick", friction=share * MU))[0]
    assert not finding.passed
    assert "stick" in finding.message


def test_what_a_recorded_impulse_rubs_is_what_coulomb_has(recording):
    rubs = [blow.rub for blow in recorded_blows(Evidence(recording)) if blow.rub is not None]
    assert rubs
    assert np.allclose([rub.impulse / rub.most for rub in rubs], 1.0, atol=5e-3)


def test_what_hits_without_friction(tmp_path):
    """It slips on as fast as it came; a friction of 0.001 that is told would have slowed it by 6 mm/s."""
    scene = Scene()
    scene.simulation(duration=0.4, frame_rate=60.0)
    scene.ground(friction=1.0)
    scene.sphere("ice", radius=0.1, position=(0, 0, 0.5), velocity=(2, 0, -2), friction=0.0, restitution=0.5)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    assert ask(CheckBlowFriction(), recording)[0].passed
    assert not ask(CheckBlowFriction(), told(recording, "ice", friction=0.001))[0].passed


@pytest.fixture(scope="module")
def rods(tmp_path_factory):
    """Rods that land nearly level: both ends of one lean meet the ground at once, of another one after the other."""
    folder, scene = tmp_path_factory.mktemp("rods"), Scene()
    scene.simulation(duration=0.16, frame_rate=60.0)
    scene.ground(friction=0.3, restitution=1.0)
    for k, lean in enumerate((0.0, 0.2, 0.5, 0.8)):
        scene.capsule(
            f"rod_{k}", radius=0.02, height=0.2, axis="X", mass=0.3, position=(0, 0.5 * k, 0.2), friction=0.3,
            restitution=0.5, rotation_deg=(0, lean, 0), velocity=(0.3, 0, -1.2),
        )  # fmt: skip
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def test_ends_that_land_one_after_the_other_are_no_single_blow(rods):
    """Of the last rod the second end is met as the first blow leaves it: their mean parts at 0.37 of its approach."""
    found = {blow.prims[1].split("/")[-1]: blow for blow in recorded_blows(Evidence(rods))}
    assert "rod_3" not in found
    assert all(finding.passed for finding in ask(CheckRestitution(), rods))
    for name in ("rod_0", "rod_1"):
        assert found[name].parting == pytest.approx(0.5 * found[name].approach, rel=0.005)
        for share in (0.9, 1.1):
            assert not ask(CheckRestitution(), told(rods, name, restitution=share * 0.5))[0].passed


@pytest.mark.parametrize("start", [-2.0, -1.995, -1.985])
def test_what_goes_farther_in_a_step_than_contacts_reach_is_pushed_out(tmp_path, start):
    """At 20 m/s and 1.25 ms a ball goes 25 mm: it may be 15 mm in the wall, and fades out of it by 0.5 m/s at most."""
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=60.0, gravity=(0.0, 0.0, 0.0))
    scene.sphere("ball", radius=0.03, position=(start, 0, 0), mass=0.1, velocity=(20, 0, 0), friction=0, restitution=0)
    scene.box("wall", size=(0.004, 1, 1), position=(0, 0, 0), static=True)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    (finding,) = ask(CheckRestitution(), recording)
    assert finding.passed, finding.message
    after = recording.body_qd[:, 0, 0] <= 0.0
    assert after.any()
    faster = recording.body_qd.copy()
    faster[after, 0, 0] = -1.0  # 5 % of the approach
    assert not ask(CheckRestitution(), replace(recording, body_qd=faster, contacts=None))[0].passed
