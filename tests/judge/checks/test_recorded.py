"""Recorded contacts of real runs: as they are, and with one number of the recording changed."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.recording.contacts import shapes_of
from wsim.scene import Drive, Part, Scene
from wsim.sim import Simulation

G, FRICTION = 9.81, 0.3


def run(folder, **options):
    """A box that slides and stops, two that stand on each other, a ball that bounces, and a hammer that lands."""
    scene = Scene()
    scene.simulation(duration=0.5, frame_rate=60.0)
    scene.ground(friction=FRICTION)
    scene.box(
        "slider", size=(0.3, 0.2, 0.1), mass=2.0, position=(0, 0, 0.05), velocity=(1.2, 0.4, 0), friction=FRICTION
    )
    scene.box("lower", size=(0.2, 0.2, 0.2), mass=4.0, position=(0, 2, 0.1))
    scene.box("upper", size=(0.2, 0.2, 0.2), mass=1.0, position=(0.05, 2, 0.3))
    scene.sphere("ball", radius=0.1, mass=1.5, position=(0, -2, 0.25), restitution=0.6, friction=0.5)
    wood, steel = scene.material("wood", density=700.0), scene.material("steel", density=7800.0)
    rod = Part("cylinder", radius=0.02, height=0.3, material=wood)
    head = Part("box", size=(0.1, 0.05, 0.05), position=(0, 0, 0.15), material=steel)
    scene.compound("hammer", parts=[rod, head], position=(0, 4, 0.25), angular_velocity_deg=(0, 500, 0))
    Simulation(scene.save(folder / "stage.usda"), device="cpu", **options).run(folder / "r.rrd")
    return read(folder / "r.rrd")


@pytest.fixture(scope="module", params=[1, 2], ids=["C", "Warp"])
def recording(request, tmp_path_factory):
    """In C, and by the kernels that batches of worlds and CUDA devices take."""
    return run(tmp_path_factory.mktemp("recorded"), world_count=request.param)


def failed(recording):
    return {finding.unit for finding in ask(CheckRecordedForces(), recording) if not finding.passed}


def moved(recording, name, row, by):
    """A recording with something added to one body's numbers, (T, …)."""
    array = np.array(getattr(recording, name))
    array[:, row] += by
    return replace(recording, **{name: array})


def test_what_is_recorded_adds_up(recording):
    found = ask(CheckRecordedForces(), recording)
    assert [finding.unit for finding in found] == ["N", "N m", "1", "1", "m"]
    assert all(finding.passed for finding in found)


def test_contacts_carry_weights_and_rub_as_coulomb_has_it(recording):
    track, shapes, h = recording.contacts, shapes_of(recording.world), 1.0 / 60.0
    prims = [(shapes[a].prim.split("/")[2], shapes[b].prim.split("/")[2]) for a, b in track.pair.tolist()]
    pressed = {pair: np.median([track.pressed[k] for k, each in enumerate(prims) if set(each) == set(pair)]) / h
               for pair in (("upper", "lower"), ("lower", "ground"), ("slider", "ground"))}  # fmt: skip
    assert pressed[("upper", "lower")] == pytest.approx(1.0 * G, rel=0.02)
    assert pressed[("lower", "ground")] == pytest.approx(5.0 * G, rel=0.02)
    early = [k for k, each in enumerate(prims) if "slider" in each and 2 < track.frame[k] < 15]
    rubbed = np.linalg.norm((track.impulse - track.along)[early], axis=1) / h
    assert rubbed.mean() == pytest.approx(FRICTION * 2.0 * G, rel=0.01)
    blow = max(track.pressed[k] for k, each in enumerate(prims) if "ball" in each)
    fallen = np.sqrt(2.0 * G * 0.15)
    assert blow == pytest.approx(1.5 * 1.6 * fallen, rel=0.02)  # m (1 + e) v


def test_poses_that_were_changed_do_not_fit_what_was_recorded(recording):
    """A hundredth of a metre a second, put in from one frame to the next, of which poses know."""
    t = recording.time
    kick = np.where(t[:, None] > 0.3, [[0.01, 0.0, 0.0]], 0.0)
    qd = moved(recording, "body_qd", 1, np.c_[kick, np.zeros((len(t), 3))])
    both = moved(qd, "body_q", 1, np.c_[kick * np.maximum(t - 0.3, 0.0)[:, None], np.zeros((len(t), 4))])
    assert "N" in failed(both)


@pytest.mark.parametrize("off", [1.05, 0.95])
def test_a_body_of_another_mass_needs_other_contacts(recording, off):
    """The ball's blow is of its own mass: the world says another."""
    bodies = list(recording.world.bodies)
    bodies[3] = bodies[3].model_copy(update={"mass": off * bodies[3].mass})
    assert "N" in failed(replace(recording, world=recording.world.model_copy(update={"bodies": bodies})))


@pytest.mark.parametrize(("friction", "said"), [(0.9 * FRICTION, "inside"), (1.1 * FRICTION, "edge")])
def test_contacts_that_rub_more_or_less_than_their_surfaces(recording, friction, said):
    statics = list(recording.world.statics)
    shapes = [shape.model_copy(update={"friction": friction}) for shape in statics[0].shapes]
    bodies = list(recording.world.bodies)
    own = [shape.model_copy(update={"friction": friction}) for shape in bodies[0].shapes]
    world = recording.world.model_copy(
        update={
            "statics": [statics[0].model_copy(update={"shapes": shapes}), *statics[1:]],
            "bodies": [bodies[0].model_copy(update={"shapes": own}), *bodies[1:]],
        }
    )
    found = [finding for finding in ask(CheckRecordedForces(), replace(recording, world=world)) if finding.unit == "1"]
    inside, edge = found
    assert not edge.passed
    assert inside.passed is (said == "edge")


def test_a_slip_that_blows_stop_and_start_again_does_not_last(tmp_path):
    """Two plates under a roof knock each other about: each time the frames show one way, and a stop lies between.

    A friction that is not the stated one is found all the same.
    """
    scene = Scene()
    scene.simulation(duration=0.4, frame_rate=60)
    scene.ground(friction=FRICTION)
    for i in range(2):
        scene.box(
            f"w{i}", size=(0.04, 0.4, 0.5), position=(-0.2 + 0.4 * i, 0, 0.25), mass=1, friction=FRICTION,
            restitution=0.4,
        )  # fmt: skip
    scene.box("roof", size=(0.8, 0.5, 0.04), position=(0, 0, 0.52), mass=2, friction=FRICTION, restitution=0.4)
    scene.sphere(
        "ball", radius=0.08, position=(-1.2, 0, 0.3), velocity=(5, 0, 0.5), mass=1, friction=FRICTION, restitution=0.4
    )
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    found = read(tmp_path / "r.rrd")
    assert not failed(found)
    shapes = [shape.model_copy(update={"friction": 1.1 * FRICTION}) for shape in found.world.statics[0].shapes]
    bodies = [
        body.model_copy(update={"shapes": [s.model_copy(update={"friction": 1.1 * FRICTION}) for s in body.shapes]})
        for body in found.world.bodies
    ]
    ground = found.world.statics[0].model_copy(update={"shapes": shapes})
    other = found.world.model_copy(update={"bodies": bodies, "statics": [ground]})
    assert failed(replace(found, world=other)) == {"1"}


def test_a_contact_that_pulls_or_is_elsewhere(recording):
    track = recording.contacts
    pulling, elsewhere = track.sums.copy(), track.sums.copy()
    pulling[0, :7] *= -1.0
    elsewhere[3, 7:10] += elsewhere[3, 3] * np.array([0.0, 0.0, 0.3])
    assert failed(replace(recording, contacts=replace(track, sums=pulling))) >= {"N", "1"}
    assert failed(replace(recording, contacts=replace(track, sums=elsewhere))) == {"m"}


def test_a_place_to_the_bit_on_a_surface_is_there_and_one_that_is_no_number_is_not(recording):
    """Whichever of a pair's surfaces is asked first, and without a word of what cannot be multiplied."""
    track = recording.contacts
    on_ground = [k for k, pair in enumerate(track.pair.tolist()) if len(shapes_of(recording.world)) - 1 in pair]
    exact = track.sums.copy()
    exact[on_ground, 9] = 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for pair in (track.pair, track.pair[:, ::-1]):
            told = RecordedContacts(Evidence(recording), replace(track, sums=exact, pair=pair))
            gap, limit = told.gap(0.05)
            assert np.all(gap[on_ground] <= limit[on_ground])
    for row in (0, on_ground[0], len(track.pair) - 1):
        for axis in (7, 8, 9):
            nowhere = track.sums.copy()
            nowhere[row, axis] = np.nan
            assert "m" in failed(replace(recording, contacts=replace(track, sums=nowhere)))


def test_a_turn_that_nothing_gives(recording):
    t = recording.time
    spin = np.where(t[:, None] > 0.3, [[0.0, 0.0, 0.3]], 0.0)
    assert "N m" in failed(moved(recording, "body_qd", 1, np.c_[np.zeros((len(t), 3)), spin]))


def test_without_recorded_contacts_nothing_is_asked(recording):
    assert not ask(CheckRecordedForces(), replace(recording, contacts=None))
    assert Evidence(recording).recording.contacts is not None


def spun(scene):
    """A hinge on a cart turns a box where it stands, so that its corners slip all round."""
    scene.simulation(duration=0.3, frame_rate=24)
    scene.ground(friction=0.75)
    scene.sphere("cart", radius=0.04, position=(0.55, 0, 0.85), mass=0.55)
    scene.joint_prismatic("rail", None, "cart", axis="Y", drive=Drive(damping=2.9, velocity=-0.2))
    scene.box("box", size=(0.33, 0.16, 0.33), position=(1.1, -0.05, 0.165), mass=10.6, friction=0.75)
    turning = Drive(stiffness=7400, damping=264, position=-5)
    scene.joint_revolute("hinge", "cart", "box", anchor=(0.825, -0.02, 0.5), axis="Z", drive=turning)


def test_what_spins_on_a_joint_rubs_all_round(tmp_path):
    """Its points slip by several times as much as their mean: of friction little is left, and none of it is asked."""
    scene = Scene()
    spun(scene)
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu").run(tmp_path / "run.rrd")
    found = ask(CheckRecordedForces(), read(tmp_path / "run.rrd"))
    assert [finding.message for finding in found if not finding.passed] == []
