"""A fluid as a whole, from particles put where they should not be."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.judge.theory import ask, only, with_world
from wsim.judge.checks.fluid_height import CheckFluidHeight
from wsim.judge.checks.water import CheckDraft, CheckLeak, CheckLevelSurface
from wsim.recording.recording import FluidTrack, Recording
from wsim.scene.world import Container, Fluid, Shape, Static, World

SPACING, LEVEL, INNER, WALL = 0.02, 0.2, (0.6, 0.4, 0.5), 0.02
WATER = "/World/water"


def still(points, speed=0.0, frames=31):
    """A tank of water without bodies, whose particles stay at points (N, 3)."""
    time = np.linspace(0.0, 1.0, frames)
    position = np.broadcast_to(points, (frames, *points.shape)).astype(np.float32)
    velocity = np.full_like(position, speed / np.sqrt(3.0))
    plane = Shape(prim="/World/ground/plane", kind="plane", size=())
    size = (INNER[0], INNER[1], LEVEL)
    world = World(
        duration=1.0, frame_rate=30.0, bodies=[], statics=[Static(prim="/World/ground", shapes=[plane])],
        containers=[Container(prim="/World/tank", inner_size=INNER, inner_center=(0.0, 0.0, WALL + INNER[2] / 2))],
        fluids=[Fluid(prim=WATER, density=1000.0, viscosity=1e-3, spacing=SPACING, size=size,
                      center=(0.0, 0.0, WALL + LEVEL / 2), container="/World/tank")],
    )  # fmt: skip
    track = FluidTrack(time, position, velocity, np.full(position.shape[:2], 1000.0, dtype=np.float32))
    none = np.zeros((frames, 0, 7), np.float32), np.zeros((frames, 0, 6), np.float32), np.zeros((frames, 0, 3))
    return Recording(Path("still"), world, {"time_step": 1e-3}, time, *none, {WATER: track}, {}, [], {})


def lattice():
    """Water that fills its box."""
    start = (-INNER[0] / 2, -INNER[1] / 2, WALL)
    axes = [low + np.arange(SPACING / 2, size, SPACING) for low, size in zip(start, (*INNER[:2], LEVEL), strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def test_water_that_lies_in_its_tank_is_sound():
    recording = still(lattice())
    assert only(ask(CheckLeak(), recording)).passed
    assert only(ask(CheckLevelSurface(), recording)).passed and only(ask(CheckFluidHeight(), recording)).passed


@pytest.mark.parametrize("height", [-0.005, -0.3, -11.0])
def test_one_particle_under_the_floor_is_a_leak(height):
    """Of six thousand, under the tank and in the ground; a wall that is 2 cm thick holds none of it."""
    points = lattice()
    points[17] = (0.1, 0.1, height)
    finding = only(ask(CheckLeak(), still(points)))
    assert not finding.passed and finding.value == 1


def test_a_splash_beside_the_tank_is_no_leak():
    points = lattice()
    points[17] = (1.0, 0.0, 0.005)
    assert only(ask(CheckLeak(), still(points))).passed


def test_water_in_what_stands_beside_the_tank_is_a_leak():
    """A block a spacing and more over a particle holds nothing back; one that it lies on does."""
    points = lattice()
    points[17] = (1.0, 0.0, 0.1)
    recording = still(points)
    for height, sound in ((0.14, False), (0.1, True)):
        block = Shape(prim="/World/b/s", kind="box", size=(0.3, 0.3, height), position=(1.0, 0.0, height / 2))
        statics = [*recording.world.statics, Static(prim="/World/b", shapes=[block])]
        world = recording.world.model_copy(update={"statics": statics})
        assert only(ask(CheckLeak(), replace(recording, world=world))).passed is sound


@pytest.mark.parametrize(("height", "sound"), [(-0.05, True), (-11.0, False)])
def test_water_that_falls_past_all_that_is_solid_is_a_leak(height, sound):
    """Off the edge of a shelf, with no ground: it may still land on the shelf's side, but not from under it."""
    points = lattice()
    points[17] = (1.0, 0.0, height)
    recording = still(points)
    shelf = Shape(prim="/World/s/s", kind="box", size=(1.0, 1.0, 0.1), position=(0.0, 0.0, -0.05))
    world = recording.world.model_copy(update={"statics": [Static(prim="/World/s", shapes=[shelf])]})
    assert only(ask(CheckLeak(), replace(recording, world=world))).passed is sound


@pytest.mark.parametrize(("degrees", "sound"), [(0.5, True), (2.0, False), (5.0, False), (20.0, False)])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_surface_that_is_not_level_at_rest(degrees, sound, axis):
    points = lattice()
    points[:, 2] += (points[:, 2] - WALL) / LEVEL * np.tan(np.radians(degrees)) * points[:, axis]
    tilt = only(ask(CheckLevelSurface(), still(points)))
    assert tilt.passed is sound and tilt.value == pytest.approx(degrees, rel=0.02)


@pytest.mark.parametrize(("stretched", "sound"), [(1.005, True), (1.05, False), (0.95, False)])
def test_water_that_stands_higher_than_its_volume(stretched, sound):
    points = lattice()
    points[:, 2] = WALL + stretched * (points[:, 2] - WALL)
    weight = only(ask(CheckFluidHeight(), still(points)))
    assert weight.passed is sound and weight.value == pytest.approx(abs(stretched - 1.0) * LEVEL, abs=1e-6)


@pytest.mark.parametrize("poured", [True, False])
@pytest.mark.parametrize(("off", "sound"), [(0.35, True), (1.2, False), (-0.35, False)])
def test_water_that_was_poured_stands_off_the_floor(off, sound, poured):
    """As many spacings, which lift the level by twice as many; what filled its tank stands off nothing."""
    recording = still(lattice() + np.array([0.0, 0.0, off * SPACING]))
    if poured:
        fluid = recording.world.fluids[0].model_copy(update={"center": (0.0, 0.0, WALL + LEVEL)})
        recording = with_world(recording, fluids=[fluid])
    finding = only(ask(CheckFluidHeight(), recording))
    assert finding.passed is (sound and poured) and finding.value == pytest.approx(2.0 * abs(off) * SPACING, abs=1e-6)


def test_what_still_sloshes_may_be_tilted():
    """At 0.3 m/s waves are v sqrt(H / g) = 4 cm high."""
    points = lattice()
    points[:, 2] += (points[:, 2] - WALL) / LEVEL * np.tan(np.radians(5.0)) * points[:, 0]
    assert only(ask(CheckLevelSurface(), still(points, speed=0.3))).passed


@pytest.mark.parametrize(("share", "sound"), [(0.8, True), (5.0, False)])
def test_waves_lift_the_weight_by_their_own_energy(share, sound):
    """v^2 / 2 g of the centre of mass, twice that of what the check calls the level: 9.2 mm at 0.3 m/s."""
    points = lattice()
    points[:, 2] += share * 0.5 * 0.3**2 / 9.81
    assert only(ask(CheckFluidHeight(), still(points, speed=0.3))).passed is sound


def test_a_pool_with_bodies_in_it_is_weighed_without_what_they_displace(pool):
    """Water that is 8 % higher than its volume and its three bodies say."""
    case = pool()
    assert only(ask(CheckFluidHeight(), case.recording)).passed
    track = case.recording.fluids[(prim := case.recording.world.fluids[0].prim)]
    box = case.recording.world.containers[0]
    floor = box.inner_center[2] - box.inner_size[2] / 2
    higher = track.position.copy()
    higher[..., 2] = floor + 1.08 * (higher[..., 2] - floor)
    wrong = replace(case.recording, fluids={prim: replace(track, position=higher)})
    assert not only(ask(CheckFluidHeight(), wrong)).passed


@pytest.mark.parametrize(("raised", "sound"), [(0.0, True), (0.05, False), (-0.05, False)])
def test_a_block_floats_by_its_own_weight(pool, raised, sound):
    """600 kg/m^3 in water: two spacings and more too high or too low is no equilibrium, whoever asks."""
    case = pool()
    q = case.recording.body_q.copy()
    q[:, 0, 2] += raised
    found = [finding for finding in ask(CheckDraft(), replace(case.recording, body_q=q)) if "block" in finding.prim]
    assert only(found).passed is sound
