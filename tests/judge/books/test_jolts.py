"""What a spring and a damper give in an interval with a blow, by closed form, and in runs of wsim's own."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books import jolts
from wsim.judge.books.laws import Laws
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded_ties import SAYS, CheckRecordedTies
from wsim.judge.evidence.cords import track_of_spring
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

H, STIFFNESS, DAMPING = 1.0 / 60.0, 200.0, 4.0


def knocked(when, jump, speeding=0.0, speed=-1.5, frames=6):
    """Length, rate and the true means of both in each interval: one jump after the share `when` of the third."""
    t = np.arange(frames) * H
    hit = (2.0 + when) * H
    later = np.maximum(t - hit, 0.0)
    place = 1.0 + speed * t + 0.5 * speeding * t**2 + jump * later
    rate = speed + speeding * t + jump * (t > hit)
    whole = t + 0.5 * speed * t**2 + speeding * t**3 / 6.0 + 0.5 * jump * later**2
    return place, rate, np.diff(whole) / H, np.diff(place) / H


@pytest.mark.parametrize("when", [0.05, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("speeding", [0.0, 40.0])
def test_a_blow_leaves_the_mean_force_to_what_the_length_tells(when, speeding):
    """k times the mean length and c times how far it went over the time, to the spread of one jump or several."""
    place, rate, length, faster = knocked(when, 2.5, speeding)
    h = np.full(len(length), H)
    low, high = jolts.mean_place(place, rate, h)
    assert np.all(low <= length + 1e-12)
    assert np.all(length <= high + 1e-12)
    widest = 2.5 * H / 8.0 + 2.0 * (2.5 + speeding * H) * H / 12.0
    assert np.all(high - low <= widest)
    mean, may = jolts.mean_force((STIFFNESS, DAMPING), place, rate, h, 0.0)
    assert np.all(np.abs(mean - STIFFNESS * length - DAMPING * faster) <= may + 1e-9)


def test_away_from_blows_it_is_sure():
    """A rate that changes evenly leaves nothing open: less by d h / 12 than both ends' mean."""
    place, rate, length, faster = knocked(10.0, 0.0, 40.0)
    mean, may = jolts.mean_force((STIFFNESS, DAMPING), place, rate, np.full(len(length), H), 0.0)
    assert mean == pytest.approx(STIFFNESS * length + DAMPING * faster, abs=1e-9)
    assert may == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("steps", [4, 14])
def test_steps_take_the_force_at_their_start(steps):
    """Speeds first, places by the new speeds: the sum over steps is within what is allowed, at its edge."""
    dt, place, rate, pulls, places, rates = H / steps, 1.0, -1.5, [], [1.0], [-1.5]
    for n in range(6 * steps):
        pulls.append(STIFFNESS * place + DAMPING * rate)
        rate += 2.5 if n == 2 * steps + steps // 2 else 0.0
        place += rate * dt
        if n % steps == steps - 1:
            places.append(place)
            rates.append(rate)
    h = np.full(6, H)
    mean, may = jolts.mean_force((STIFFNESS, DAMPING), np.array(places), np.array(rates), h, dt)
    given = np.mean(np.reshape(pulls, (6, steps)), axis=1)
    ripple = STIFFNESS * 2.5 * dt**2 / H  # of where in a step the blow is
    assert np.all(np.abs(given - mean) <= may + ripple)
    assert np.all(may <= 0.5 * dt / H * (STIFFNESS * 2.5 * H + DAMPING * 2.5) + STIFFNESS * 2.5 * H / 6.0)


def test_how_long_a_joint_may_have_gone_back():
    """One that goes on as it went was never back; one that a blow brings back was for as long as its course says."""
    h, dt = np.full(5, H), H / 20.0
    even = np.arange(6) * H
    assert jolts.reversed_share(even, np.ones(6), h, dt) == pytest.approx(0.0)
    # It slows by 3 in an interval and starts the third at 1: back after a third, until a blow of 4 at three quarters.
    place, rate, _, _ = knocked(0.75, 4.0, speeding=-3.0 / H, speed=7.0)
    assert (rate[2], rate[3]) == pytest.approx((1.0, 2.0))
    share = jolts.reversed_share(place, rate, h, dt)
    assert share[2] == pytest.approx(0.75 - 1.0 / 3.0 + 1.0 / 20.0)
    assert share[[0, 1]] == pytest.approx(0.0)


def test_where_no_single_blow_tells_the_way_was_not_all_one():
    """It got nowhere: as long back as forth, or longer."""
    assert np.all(jolts.reversed_share(np.zeros(6), np.ones(6), np.full(5, H), H / 20.0) == 1.0)


# ---- runs
def plate(scene):
    """A ball falls on a plate that hangs on a spring with a damper."""
    scene.simulation(duration=0.5, frame_rate=60)
    scene.box("plate", size=(0.4, 0.4, 0.04), position=(0, 0, 1), mass=1, restitution=0.5)
    scene.joint_prismatic("rail", None, "plate", axis="Z")
    scene.spring("spring", None, "plate", anchor_a=(0, 0, 2), stiffness=STIFFNESS, damping=DAMPING,
                 rest_length=1 - 9.81 / STIFFNESS)  # fmt: skip
    scene.sphere("ball", radius=0.05, position=(0, 0, 1.5), mass=0.5, restitution=0.5)


def cart(scene):
    """A cart on a spring with a damper runs into the stop of its rail."""
    scene.simulation(duration=0.3, frame_rate=120)
    scene.box("cart", size=(0.1, 0.1, 0.1), position=(1, 0, 1), mass=1)
    scene.joint_prismatic("rail", None, "cart", axis="X", limits=(-0.2, 0.5))
    scene.spring("spring", None, "cart", anchor_a=(0, 0, 1), stiffness=300.0, damping=2.0, rest_length=0.7)


def adrift(scene):
    """Three turning boxes, each tied to the next by a spring that pushes and pulls in turn."""
    scene.simulation(duration=1.5, frame_rate=60, gravity=(0, 0, 0))
    places = [(0, 0, 0), (1, 0, 0), (0.4, 0.8, 0.1)]
    for i, (place, mass) in enumerate(zip(places, (1.0, 0.5, 1.0), strict=True)):
        scene.box(f"m{i}", size=(0.1, 0.15, 0.2), position=place, mass=mass, velocity=(0, (1, -1, 0.3)[i], 0.1 * i))
    for i, (x, y, z) in enumerate(places):
        scene.spring(f"k{i}", f"m{i}", f"m{(i + 1) % 3}", stiffness=50.0, rest_length=0.7,
                     anchor_a=(x + 0.05, y + 0.02, z + 0.02))  # fmt: skip


def seesaw(scene):
    """A board on a hinge with dry friction, that a ball and a stay make rattle."""
    scene.simulation(duration=0.9, frame_rate=60)
    scene.ground(friction=0.2)
    scene.box("foot", size=(0.1, 0.3, 0.2), position=(0, 0, 0.1), static=True)
    scene.box("board", size=(2, 0.3, 0.04), position=(0, 0, 0.25), mass=2, friction=0.4, restitution=0.3)
    scene.joint_revolute("pivot", None, "board", anchor=(0, 0, 0.25), axis="Y", friction=0.1)
    scene.box("crate", size=(0.15, 0.15, 0.15), position=(0.8, 0, 0.345), mass=0.5, friction=0.4)
    scene.sphere("ball", radius=0.12, position=(-0.7, 0, 1.2), mass=4, friction=0.4, restitution=0.3)
    scene.box("stay", size=(0.1, 0.3, 0.23), position=(0.9, 0, 0.115), static=True)
    scene.box("stay2", size=(0.1, 0.3, 0.1), position=(-0.9, 0, 0.05), static=True)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    made = {}
    for build in (plate, cart, adrift, seesaw):
        folder, scene = tmp_path_factory.mktemp(build.__name__), Scene()
        build(scene)
        Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
        made[build.__name__] = read(folder / "r.rrd")
    return made


def wrong(recording):
    fine = set(SAYS.values())
    found = ask(CheckRecordedTies(), recording)
    assert found
    return {finding.prim or finding.message for finding in found if not finding.passed} - fine


def stated(recording, **scaled):
    """In a world that states its first spring's numbers that much larger."""
    springs = list(recording.world.springs)
    springs[0] = springs[0].model_copy(update={name: by * getattr(springs[0], name) for name, by in scaled.items()})
    return replace(recording, world=recording.world.model_copy(update={"springs": springs}))


@pytest.mark.parametrize("name", ["plate", "cart", "adrift", "seesaw"])
def test_what_blows_do_to_ties_is_as_it_should_be(runs, name):
    assert not wrong(runs[name])


@pytest.mark.parametrize("name", ["plate", "cart", "adrift"])
def test_the_books_of_forces_and_of_energy_close(runs, name):
    assert all(finding.passed for check in (CheckForces(), CheckEnergy()) for finding in ask(check, runs[name]))


def test_where_the_time_step_is_not_known_none_is_taken_off_the_damper(runs):
    """Poses and velocities alone: half a frame's c dv would be 5 N of what the damper gives at the blow."""
    told = runs["plate"]
    world = told.world.model_copy(update={"time_step": 0.0})
    bare = replace(told, world=world, metadata={"complete": True}, contacts=None, ties=None)
    assert Evidence(bare).motion.step == 0.0
    assert all(finding.passed for finding in ask(CheckForces(), bare))


def test_forces_tell_how_a_push_changes_while_its_way_turns(runs):
    """Where a spring goes from push to pull that is nearly all that the mean of both ends leaves of a torque."""
    evidence = Evidence(runs["adrift"])
    laws, motion = Laws(evidence), evidence.motion
    first, third = laws.springs[0], laws.springs[2]  # at its first end, and at its second, the centre of mass
    plain = 0.5 * (first.back[1:, 3:] + first.back[:-1, 3:] + third.wrench[1:, 3:] + third.wrench[:-1, 3:])
    pull = track_of_spring(evidence, evidence.world.springs[0]).pull
    turns = pull[1:] * pull[:-1] < 0.0
    off, was = (np.linalg.norm(motion.torque[:, 0] - each, axis=1) for each in (laws.given()[0][:, 0, 3:], plain))
    assert turns.sum() >= 4
    assert off[turns].mean() < 0.4 * was[turns].mean()


@pytest.mark.parametrize("by", [0.85, 1.15])
def test_energy_tells_another_damping(runs, by):
    assert not all(finding.passed for finding in ask(CheckEnergy(), stated(runs["plate"], damping=by)))


@pytest.mark.parametrize("name", ["plate", "cart", "adrift"])
@pytest.mark.parametrize("by", [0.9, 1.1])
def test_a_spring_a_tenth_stiffer_or_softer_is_found(runs, name, by):
    assert wrong(stated(runs[name], stiffness=by))


@pytest.mark.parametrize("by", [0.85, 1.15])
def test_another_damping_is_found(runs, by):
    assert wrong(stated(runs["plate"], damping=by))


def pulled(recording, k, by):
    """With what the first cord gave in the interval after frame k scaled."""
    cords = recording.ties.cords.copy()
    cords[k + 1, 0] *= by
    return replace(recording, ties=replace(recording.ties, cords=cords))


@pytest.mark.parametrize("name", ["plate", "cart"])
@pytest.mark.parametrize("by", [0.9, 1.1])
def test_a_pull_that_is_a_tenth_off_at_the_blow_alone_is_found(runs, name, by):
    run = runs[name]
    speed = np.linalg.norm(run.body_qd[:, 0, :3], axis=1)
    assert wrong(pulled(run, int(np.argmax(np.abs(np.diff(speed)))), by))


def test_another_dry_friction_is_found_beside_blows(runs):
    """What is asked knows a thousandth of weight x radius, 0.02 N m here: a fifth of the friction."""
    run = runs["seesaw"]
    for by in (0.75, 1.25):
        pivot = run.world.joints[0].model_copy(update={"friction": by * 0.1})
        assert wrong(replace(run, world=run.world.model_copy(update={"joints": [pivot]})))


def test_a_length_that_went_faster_than_at_either_end_is_told_from_one_that_did_not():
    """A jump of the rate halfway leaves the way between those of both rates; there and back at 10 m/s does not."""
    h, rate = np.full(3, H), np.array([1.0, 1.0, 0.0, 0.0])
    assert jolts.between(np.array([0.0, H, 1.5 * H, 1.5 * H]), rate, h).tolist() == [True, True, True]
    assert jolts.between(np.array([0.0, H, 5.0 * H, 5.0 * H]), rate, h).tolist() == [True, False, True]


def test_what_a_length_strays_shows_in_the_intervals_beside():
    """A rate that went up and down again between two frames, by 0.2 of the way."""
    place = np.array([0.0, 1.0, 2.2, 3.2, 4.2, 5.2]) * H
    found = jolts.strayed(place, np.ones(6), np.full(5, H))
    assert found == pytest.approx(np.array([0.2, 0.2, 0.2, 0.0, 0.0]) * H)
