"""What particles give a body by the method's own sum: still water, and a hole in it where a box is."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.checks.test_lift import EDGES, INNER, SOUND, SPACING, WATER, immersed, lifted
from tests.judge.theory import G, ask, ball, box, only, with_world
from wsim.geometry.filled import box_lattice
from wsim.judge.books.filling import filled
from wsim.judge.books.fluid_push import FluidPush
from wsim.judge.books.gaps import FAR_ACROSS
from wsim.judge.books.sph import Method
from wsim.judge.checks.fluid_push import CheckFluidPush
from wsim.judge.evidence.evidence import Evidence
from wsim.recording.solids import SolidParticles, Solids
from wsim.scene.world import Shape

COUNT = 6 * 4 * 5  # particles that fill a box of EDGES
H = 1.3 * SPACING


def told(recording, **method):
    """A recording that says what SPH it was made with, as wsim's do."""
    facts = {"smoothing_length": H, "artificial_viscosity": 0.01, "laminar_factor": 10.0, "background_pressure": 0.0}
    counts = {body.prim: COUNT for body in recording.world.bodies}
    return replace(recording, metadata={**recording.metadata, "sph": {**facts, "body_particles": counts, **method}})


def floored(recording, depth=3):
    """A recording that says of what particles the tank's floor is: layers, half a spacing deep and more."""
    layers = box_lattice(np.array([*INNER[:2], depth * SPACING]), SPACING)
    place = layers.position - np.array([0.0, 0.0, 0.5 * depth * SPACING])
    floor = SolidParticles(place.astype(np.float32), layers.volume.astype(np.float32))
    return replace(recording, solids=Solids(floor))


def pushes(recording, frames):
    """Forces (frames, B, 3) [N]."""
    evidence = Evidence(recording)
    push = FluidPush(evidence, Method.of(evidence))
    return np.array([push.at(k, k, list(range(len(recording.world.bodies)))) for k in frames])


def push_on(recording):
    return pushes(recording, [3])[0]


def agreeing(recording, by=(0.0, 0.0, 0.0)):
    """A recording of still water that says what its particles give, and `by` more [of the lift]."""
    impulse = np.zeros_like(recording.applied_impulse)
    still = pushes(recording, [0])
    impulse[1:] = (still + np.array(by) * np.abs(still[..., 2:])) / 60.0
    return replace(recording, applied_impulse=impulse)


@pytest.mark.parametrize("height", [0.14, 0.06, 0.04])
def test_the_sum_over_particles_is_the_lift_of_archimedes(height):
    """Wholly under water and in step with its lattice: what the sum and its integral differ by is some percent.

    Near the floor, too, where the particles under the box are two layers.
    """
    force = push_on(told(immersed(height, at=(0.0, 0.0))))[0]
    assert force[2] == pytest.approx(lifted(height), rel=0.03)
    assert np.abs(force[:2]).max() < 1e-3 * force[2]


def test_the_force_of_one_particle_is_the_pairs():
    """One particle of fluid over a box of one cell, by hand: Wendland's slope, both pressures, no velocities."""
    recording = told(immersed(), body_particles={"/World/box0": 1})
    small = with_world(recording, bodies=[box("box0", size=(SPACING,) * 3)])
    water = small.fluids[WATER]
    at = small.body_q[:, 0, :3] + [0.0, 0.0, 1.2 * SPACING]
    rho = np.full((len(water.time), 1), 1002.0, dtype=np.float32)
    one = replace(water, position=at[:, None].astype(np.float32), velocity=0.0 * at[:, None], density=rho)
    force = push_on(replace(small, fluids={WATER: one}))[0]
    p = SOUND**2 * 2.0
    under = p + 1000.0 * G * 1.2 * SPACING  # the box's particle is deeper
    q = 1.2 * SPACING / H
    slope = 21.0 / (16.0 * np.pi * H**3) * 5.0 * q * (1.0 - q / 2.0) ** 3 / H  # -dW/dr
    cell = SPACING**3
    assert force == pytest.approx([0.0, 0.0, -cell * (1000.0 * cell / 1002.0) * (p + under) * slope], rel=1e-4)


@pytest.mark.parametrize(("edges", "others"), [(EDGES, 0), ((0.2, 0.2, 0.1), 0), (EDGES, 1)])
def test_water_lifts_what_lies_flush_on_the_floor(edges, others, monkeypatch):
    """With the floor's particles it is the lift of Archimedes, of a box of ten particles a side, too, whose middle no
    fluid is near, and of boxes on each other; without, as in recordings of before, the water presses it down."""
    for name in ("tests.judge.checks.test_lift", __name__):
        monkeypatch.setattr(f"{name}.EDGES", edges)
    on_top = [np.array([0.0, 0.0, 1.5 * edges[2]])] * others
    low = told(immersed(0.0, at=(0.0, 0.0), others=on_top), body_particles={
        f"/World/box{n}": round(np.prod(edges) / SPACING**3) for n in range(others + 1)
    })  # fmt: skip
    force = push_on(floored(low))
    assert force[:, 2] == pytest.approx(1000.0 * G * np.prod(edges), rel=0.03)
    assert push_on(low)[0, 2] < 0.0


def test_the_force_in_a_gap_is_the_pairs():
    """Two particles of a box, one of a wall under them, one of fluid beside the lower, by hand.

    Nothing but the wall holds the lower one up against the upper one: what it lacks is made up for.
    """
    recording = told(immersed(), body_particles={"/World/box0": 2})
    small = with_world(recording, bodies=[box("box0", size=(SPACING, SPACING, 2.0 * SPACING))])
    lower = small.body_q[:, 0, :3] - np.array([0.0, 0.0, 0.5 * SPACING])
    water, thick = small.fluids[WATER], 2e-6  # [m^3]
    rho = np.full((len(water.time), 1), 1002.0, dtype=np.float32)
    aside = (lower + np.array([1.1 * SPACING, 0.0, 0.0]))[:, None].astype(np.float32)
    wet = replace(small, fluids={WATER: replace(water, position=aside, velocity=0.0 * aside, density=rho)})

    def with_wall(way):
        wall = SolidParticles((lower[:1] + np.array(way) * SPACING).astype(np.float32), np.full(1, thick, np.float32))
        return push_on(replace(wet, solids=Solids(wall)))[0] - push_on(wet)[0]

    def slope(spacings):  # -dW/dr
        q = spacings * SPACING / H
        return 21.0 / (16.0 * np.pi * H**3) * 5.0 * q * (1.0 - q / 2.0) ** 3 / H

    p, cell = SOUND**2 * 2.0, SPACING**3
    own, other = cell * slope(1.0), thick * slope(1.7)
    longer = own * other / (other**2 + FAR_ACROSS**2 * own**2)
    up = longer * cell * other * (2.0 * p + 1000.0 * G * 1.7 * SPACING)
    assert longer > 5.0
    assert with_wall((0.0, 0.0, -1.7)) == pytest.approx([0.0, 0.0, up], rel=1e-3, abs=1e-6 * up)
    # Of one with its fluid behind the other, of one out of reach of all fluid, and of one out of the body's reach.
    for way in ((1.05, 0.0, 0.0), (-1.6, 0.0, 0.0), (2.7, 0.0, 0.0)):
        assert np.abs(with_wall(way)).max() < 1e-6 * up


@pytest.mark.parametrize("by", [(0, 0, 0.0), (0, 0, 0.2), (0, 0, -0.2), (0.1, 0, 0)])
def test_what_is_off_near_the_floor_is_found(by):
    recording = floored(told(immersed(0.008, at=(0.0, 0.0), frames=14)))
    assert only(ask(CheckFluidPush(), agreeing(recording, by))).passed == (not any(by))


def test_what_the_floor_is_said_to_push_without_water_is_found():
    """The gap's push of a recording whose floor is out of reach: nothing explains it."""
    near, far = (floored(told(immersed(height, at=(0.0, 0.0), frames=14))) for height in (0.008, 0.14))
    gap = pushes(near, [0])[0, 0, 2] - pushes(replace(near, solids=None), [0])[0, 0, 2]
    wrong = agreeing(far, (0, 0, gap / pushes(far, [0])[0, 0, 2]))
    assert not only(ask(CheckFluidPush(), wrong)).passed


def test_a_mesh_is_filled_as_the_recording_says():
    recording = told(immersed(frames=14))
    lattice = box_lattice(np.array(EDGES), SPACING)
    own = SolidParticles(lattice.position.astype(np.float32), lattice.volume.astype(np.float32))
    walls = SolidParticles(np.zeros((0, 3), np.float32), np.zeros(0, np.float32))
    mesh = Shape(prim="/World/box0/g", kind="mesh", size=EDGES)
    body = recording.world.bodies[0].model_copy(update={"shapes": [mesh]})
    bent = replace(with_world(recording, bodies=[body]), solids=Solids(walls, {body.prim: own}))
    assert push_on(bent) == pytest.approx(push_on(recording), rel=1e-5, abs=1e-4)
    assert only(ask(CheckFluidPush(), agreeing(bent))).passed
    assert not only(ask(CheckFluidPush(), agreeing(bent, (0, 0, 0.1)))).passed


@pytest.mark.parametrize("by", [(0, 0, 0.03), (0, 0, -0.03), (0.03, 0, 0), (0, -0.03, 0)])
@pytest.mark.parametrize("height", [0.24, 0.02])
def test_a_push_that_no_particle_feels(height, by):
    """Three hundredths of the lift, up or sideways, of what floats and of what lies on the floor."""
    finding = only(ask(CheckFluidPush(), agreeing(told(immersed(height, frames=14)), by)))
    assert not finding.passed and finding.prim == "/World/box0"


@pytest.mark.parametrize("by", [(0, 0, 0.0), (0, 0, 0.008), (0.008, 0, 0)])
def test_what_particles_give_is_let_pass(by):
    assert only(ask(CheckFluidPush(), agreeing(told(immersed(frames=14)), by))).passed


def test_bodies_near_each_other_are_asked_each():
    beside = told(immersed(at=(-0.2, 0.0), frames=14, others=[np.array([0.0, 0.0, 0.19])]))
    sound = agreeing(beside)
    assert [finding.passed for finding in ask(CheckFluidPush(), sound)] == [True, True]
    impulse = sound.applied_impulse.copy()
    impulse[:, 0] *= 1.05
    impulse[:, 1] *= 0.95  # in sum nothing is off
    assert [f.passed for f in ask(CheckFluidPush(), replace(sound, applied_impulse=impulse))] == [False, False]


def test_what_lasts_for_a_while_is_found_among_what_scatters():
    """A tenth for a quarter of the time, where the first half splashes: its own stretch is quiet."""
    sound = agreeing(told(immersed(frames=81)))
    impulse = sound.applied_impulse.copy()
    impulse[1:41, 0, 2] *= 1.0 + 0.5 * np.random.default_rng(3).standard_normal(40)
    assert only(ask(CheckFluidPush(), replace(sound, applied_impulse=impulse))).passed
    impulse[61:, 0, 2] *= 1.1
    finding = only(ask(CheckFluidPush(), replace(sound, applied_impulse=impulse)))
    assert not finding.passed and finding.span[0] >= 60.0 / 60.0 - 1e-6


def test_few_of_many_intervals_are_looked_at_and_on_end():
    check = CheckFluidPush(most=120)
    rows = check._rows(2000, 1)
    assert len(rows) == 120 and rows[0] == 0 and rows[-1] == 1999
    assert np.count_nonzero(np.diff(rows) == 1) == 116
    assert len(check._rows(2000, 50)) == 60 and len(check._rows(100, 1)) == 100


def test_what_is_half_a_spacing_more_is_filled_as_the_simulator_did():
    """3.5 spacings: three cells or four, by the last digit; the count says which."""
    odd = box(size=(0.35, 0.35, 0.3))
    for cells in (3, 4):
        samples = filled(odd, 0.1, cells * cells * 3)
        assert len(samples.volume) == cells * cells * 3
        assert samples.volume.sum() == pytest.approx(0.35 * 0.35 * 0.3, rel=1e-4)
    assert filled(odd, 0.1, 50) is None


def test_shapes_of_a_body_are_filled_each_where_it_is():
    def moved(kind, size, x):
        return Shape(prim=f"/World/b/{kind}", kind=kind, size=size, position=(x, 0.0, 0.0))

    shapes = [moved("box", (0.2, 0.2, 0.2), -0.5), moved("cylinder", (0.1, 0.2), 0.5)]
    lattice = len(box_lattice(np.array([0.2, 0.2, 0.2]), 0.05).volume)
    body = ball().model_copy(update={"shapes": shapes})
    samples = next(found for n in range(200) if (found := filled(body, 0.05, n)) is not None)
    assert np.count_nonzero(samples.position[:, 0] < 0.0) == lattice
    assert samples.volume.sum() == pytest.approx(0.2**3 + np.pi * 0.1**2 * 0.2, rel=1e-6)


def test_not_asked_where_it_cannot_be_told():
    """Without the method's settings, without the fluid's impulses, and of a mesh, whose particles are not known."""
    recording = agreeing(told(immersed(frames=14)), (0, 0, 0.5))
    assert ask(CheckFluidPush(), replace(recording, metadata={"time_step": 1e-3})) == []
    assert ask(CheckFluidPush(), replace(recording, applied_impulse=None)) == []
    mesh = Shape(prim="/World/box0/g", kind="mesh", size=EDGES)
    body = recording.world.bodies[0].model_copy(update={"shapes": [mesh]})
    assert ask(CheckFluidPush(), with_world(recording, bodies=[body])) == []
