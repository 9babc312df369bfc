"""The plan's kinds of objective: what carries a body, and how it falls, rolls, flies and swings, by theory."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import G, box, ground, record, slab, times, with_world
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import ObjectiveCheck
from wsim.plan.schema import Objective
from wsim.recording.contacts import ContactTrack
from wsim.scene.world import Joint


def asked(kind, recording, name="box", **fields):
    """An objective's findings on a recording."""
    return ObjectiveCheck(Objective(kind=kind, object=name, **fields)).run(Evidence(recording))


def about_y(angle):
    zero = np.zeros_like(angle)
    return np.stack([zero, np.sin(angle / 2), zero, np.cos(angle / 2)], axis=-1)


def riding(most, slips=0.0):
    """A box of 0.2 m on a plank of 2 m that tilts about its middle by as much [rad], 0.5 m from there."""
    t = times(2.0)
    angle = most * np.minimum(t, 1.0)
    plank, load = box("plank", (2.0, 0.4, 0.04)), box("box")
    along = np.stack([np.cos(angle), 0.0 * t, -np.sin(angle)], axis=1)
    up = np.stack([np.sin(angle), 0.0 * t, np.cos(angle)], axis=1)
    middle = np.tile([0.0, 0.0, 1.0], (len(t), 1))
    off = slips * np.clip(t - 1.0, 0.0, 1.0)[:, None]
    place = np.stack([middle, middle + 0.5 * along + (0.12 + off) * up], axis=1)
    turn = np.stack([about_y(angle)] * 2, axis=1)
    return record([plank, load], place, np.gradient(place, t, axis=0), t, rotation=turn, statics=[ground()])


@pytest.mark.parametrize("most", [0.0, 0.2, -0.35])
def test_what_sits_on_what_tilts_stays_on_it(most):
    """A seesaw that goes down by 20 degrees takes its load with it: their gap is none, wherever the other end is."""
    (finding,) = asked("stays_on", riding(most), ref="plank")
    assert finding.passed and finding.value < 1e-6
    (finding,) = asked("stays_on", riding(most, slips=0.05), ref="plank")
    assert not finding.passed and finding.value == pytest.approx(0.05, abs=1e-3)
    assert finding.time == pytest.approx(2.0) and finding.span[0] == pytest.approx(
        1.4, abs=0.1
    )  # 0.02 m of 0.05 a second


def test_what_stands_on_a_slope_rests_on_it():
    angle = math.radians(20.0)
    t = times(2.0)
    ramp = slab("ramp", (2.0, 1.0, 0.1), (0.0, 0.0, 0.5))
    q = about_y(np.array(angle))
    shape = ramp.shapes[0].model_copy(update={"rotation": tuple(q.tolist())})
    ramp = ramp.model_copy(update={"shapes": [shape]})
    normal = np.array([math.sin(angle), 0.0, math.cos(angle)])
    place = np.tile(np.array([0.0, 0.0, 0.5]) + 0.15 * normal, (len(t), 1))
    force = np.tile([0.0, 0.0, 4.0 * G], (len(t), 1))
    still = record([box()], place, 0.0 * place, t, rotation=np.tile(q, (len(t), 1)), force=force, statics=[ramp])
    assert all(f.passed for f in asked("stays_on", still, ref="ramp"))
    assert all(f.passed for f in asked("rests_on", still, ref="ramp"))


def welded_pair(carried):
    """Two boxes of 4 kg side by side, fixed together, of which the first alone is over the slab and carries both."""
    t = times(2.0)
    place = np.tile([[0.0, 0.0, 0.2], [0.2, 0.0, 0.2]], (len(t), 1, 1))
    force = np.zeros((len(t), 2, 3))
    force[:, 0, 2] = carried
    base = slab("base", (0.3, 0.3, 0.1), (-0.05, 0.0, 0.05))
    pair = record([box("box"), box("other")], place, 0.0 * place, t, force=force, statics=[base])
    weld = Joint(prim="/World/weld", kind="fixed", parent="/World/box", child="/World/other")
    return with_world(pair, joints=[weld])


@pytest.mark.parametrize(("share", "passes"), [(2.0, True), (1.0, False), (3.0, False)])
def test_what_is_welded_is_carried_as_one(share, passes):
    found = asked("rests_on", welded_pair(share * 4.0 * G), ref="base")
    assert [f.passed for f in found] == [True, passes]
    assert found[1].expected == pytest.approx(8.0 * G)


@pytest.mark.parametrize("recorded", [False, True])
def test_what_hangs_just_above_does_not_rest_where_contacts_are_recorded(recorded):
    """Of a world in which nothing touches all forces are 0, as they are where none is recorded."""
    t = times(2.0)
    place = np.tile([0.0, 0.0, 0.1 + 0.005], (len(t), 1))
    hung = record([box()], place, 0.0 * place, t, force=0.0 * place, statics=[slab("base", (1, 1, 0.1), (0, 0, -0.05))])
    none = ContactTrack(np.zeros(0, np.int32), np.zeros((0, 2), np.int32), np.zeros((0, 16), np.float32))
    hung = replace(hung, contacts=none if recorded else None)
    assert all(f.passed for f in asked("rests_on", hung, ref="base")) != recorded


def tipping(tilt, drop):
    """A box that turns by an angle [rad] and comes down by a way [m] in a second."""
    t = times(3.0)
    share = np.clip(t - 0.5, 0.0, 1.0)
    place = np.stack([0.0 * t, 0.0 * t, 1.0 - drop * share], axis=1)
    return record([box()], place, np.gradient(place, t, axis=0), t, rotation=about_y(tilt * share), statics=[ground()])


@pytest.mark.parametrize(
    ("tilt", "drop", "passes"),
    [(math.pi / 2, 0.0, True), (math.pi, 0.3, True), (2 * math.pi, 0.3, True), (0.0, 0.5, False), (0.7, 0.5, False)],
)
def test_what_topples_tilts(tilt, drop, passes):
    """What is carried down upright, or lifted off, has not toppled; what tumbles may end as it stood, but lower."""
    assert all(f.passed for f in asked("topples", tipping(tilt, drop))) == passes


@pytest.mark.parametrize(("rolls_from", "passes"), [(2.0, True), (0.3, False)])
def test_a_slide_is_one_over_all_of_its_way(rolls_from, passes):
    """It slides for 0.3 m, which the plan asks for, and may roll the rest of 2 m."""
    t = times(2.0)
    place = np.stack([t, 0.0 * t, 0.1 + 0.0 * t], axis=1)
    spin = np.zeros((len(t), 3))
    spin[place[:, 0] > rolls_from, 1] = 10.0  # v / r
    recording = record([box()], place, np.tile([1.0, 0.0, 0.0], (len(t), 1)), t, spin=spin, statics=[ground()])
    way, turning = asked("slides", recording, value=0.3)
    assert way.passed and turning.passed == passes
    assert turning.value == pytest.approx(max(0.0, 1.0 - rolls_from / 2.0), abs=0.03)


def test_a_flight_ends_in_the_water(pool_of_rest):
    """A box falls 0.5 m to a pool and is slowed in it: it flies for sqrt(2 h / g), and keeps to its parabola."""
    recording, lands = pool_of_rest
    flight, off = asked("flies", recording)
    assert flight.value == pytest.approx(lands, abs=2.0 / 30.0) and off.passed


@pytest.fixture
def pool_of_rest():
    from wsim.recording.recording import FluidTrack
    from wsim.scene.world import Fluid

    t = times(1.0)
    surface, start, spacing = 0.3, 0.9, 0.05
    lands = math.sqrt(2 * (start - 0.1 - surface) / G)
    ticks = [(np.arange(n) + 0.5) * spacing for n in (20, 20, 6)]
    grid = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3) - [0.5, 0.5, 0.0]
    points = np.broadcast_to(grid.astype(np.float32), (len(t), *grid.shape))
    water = FluidTrack(t, points, np.zeros_like(points), np.full(points.shape[:2], 1000.0, np.float32))
    entry = G * lands
    # In the water it goes on at a third of its speed: far off the parabola, by no jolt that a frame shows at once.
    z = np.where(t < lands, start - G * t**2 / 2, surface + 0.1 - entry * (t - lands) / 3)
    v = np.where(t < lands, -G * t, -np.maximum(entry / 3, entry - 14.0 * (t - lands)))
    zero = 0.0 * t
    fluid = Fluid(
        prim="/World/water", density=1000.0, viscosity=0.001, spacing=spacing, size=(1.0, 1.0, 0.3),
        center=(0.0, 0.0, 0.15),
    )  # fmt: skip
    recording = record(
        [box()], np.stack([zero, zero, z], axis=1), np.stack([zero, zero, v], axis=1), t,
        fluids={"/World/water": water},
    )  # fmt: skip
    return with_world(recording, fluids=[fluid]), lands
