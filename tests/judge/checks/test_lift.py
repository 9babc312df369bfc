"""The lift of a body, from the particles about it: still water, and a hole in it where a box is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.judge.theory import G, ask, box, only, slab, with_world
from wsim.judge.books.lift import Surroundings, rising
from wsim.judge.checks.lift import CheckLift
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.recording.recording import FluidTrack, Recording
from wsim.scene import Scene
from wsim.scene.world import Container, Fluid, World
from wsim.sim import Simulation

SPACING, LEVEL, INNER, SOUND = 0.02, 0.3, (0.6, 0.4, 0.5), 30.0
EDGES = (0.12, 0.08, 0.1)
WATER = "/World/water"


def immersed(height=0.14, at=(0.04, 0.0), up=0.0, said=1.0, frames=8, others=()):
    """A box that hangs with its lower face at a height, in water that is all thrown upwards at `up` [m/s^2].

    The water stands at LEVEL; what is under it gets rho (g + up) V, and the recording says `said` times as much.
    """
    t = np.arange(frames) / 60.0
    starts = (-INNER[0] / 2, -INNER[1] / 2, 0.0)
    lines = [low + np.arange(SPACING / 2, size, SPACING) for low, size in zip(starts, (*INNER[:2], LEVEL), strict=True)]
    points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    middles = [np.array([*at, height + EDGES[2] / 2]), *others]
    inside = [(np.abs(points - middle) < np.array(EDGES) / 2).all(axis=1) for middle in middles]
    points = points[~np.any(inside, axis=0)]
    raised, speed = up * t**2 / 2, up * t
    position = (points + raised[:, None, None] * [0.0, 0.0, 1.0]).astype(np.float32)
    velocity = np.zeros_like(position)
    velocity[..., 2] = speed[:, None]
    pressure = 1000.0 * (G + up) * (LEVEL - points[:, 2])
    density = np.broadcast_to(1000.0 + pressure / SOUND**2, position.shape[:2]).astype(np.float32)
    size = (*INNER[:2], LEVEL)
    bodies = [box(f"box{n}", size=EDGES) for n in range(len(middles))]
    world = World(
        duration=float(t[-1]), frame_rate=60.0, bodies=bodies, statics=[],
        containers=[Container(prim="/World/tank", inner_size=INNER, inner_center=(0.0, 0.0, INNER[2] / 2))],
        fluids=[Fluid(prim=WATER, density=1000.0, viscosity=1e-3, spacing=SPACING, size=size,
                      center=(0.0, 0.0, LEVEL / 2), container="/World/tank", speed_of_sound=SOUND)],
    )  # fmt: skip
    q = np.zeros((frames, len(bodies), 7), np.float32)
    q[..., :3], q[..., 6] = np.array(middles) + raised[:, None, None] * [0.0, 0.0, 1.0], 1.0
    qd = np.zeros((frames, len(bodies), 6), np.float32)
    qd[..., 2] = speed[:, None]
    lift = said * lifted(height, up)
    impulse = np.zeros((frames, len(bodies), 3), np.float32)
    impulse[1:, :, 2] = lift / 60.0
    return Recording(
        Path("immersed"), world, {"time_step": 1e-3}, t, q, qd, np.zeros_like(impulse),
        {WATER: FluidTrack(t, position, velocity, density)}, {}, [], {}, applied_impulse=impulse,
    )  # fmt: skip


def lifted(height, up=0.0):
    """What the water gives, by Archimedes [N]."""
    return 1000.0 * (G + up) * EDGES[0] * EDGES[1] * min(EDGES[2], LEVEL - height)


@pytest.mark.parametrize("height", [0.24, 0.14, 0.08])
@pytest.mark.parametrize("at", [(0.04, 0.0), (-0.2, 0.1)])
@pytest.mark.parametrize("up", [0.0, 1.0, -2.0])
def test_the_fluid_tells_what_archimedes_says(height, at, up):
    """Afloat, wholly under water, beside a wall, and heavier or lighter by what the pool is thrown with.

    B-splines leave nothing of a lattice's layers: what is left is how they are cut off at walls, which the column
    and the rest of the pool share.
    """
    evidence = Evidence(immersed(height, at, up))
    fluid = evidence.world.fluids[0]
    about = Surroundings(evidence, fluid, evidence.container_of(fluid), np.arange(len(evidence.time)))
    assert about.lift(0, 3) == pytest.approx(lifted(height, up), rel=0.03)


def test_ramps_sum_a_lattice_without_its_layers():
    """A quadratic B-spline over three spacings: on a lattice anywhere its sum is 1, and its mean in the middle."""
    for shift in np.linspace(0.0, 1.0, 7):
        t = (np.arange(-3, 7) + shift) / 3.0
        value, slope = rising(t)
        assert slope.sum() / 3.0 == pytest.approx(1.0, abs=1e-12)
        assert (slope * t).sum() / 3.0 == pytest.approx(0.5, abs=1e-12)
        assert value[0] == 0.0 and value[-1] == 1.0
        assert np.gradient(rising(np.linspace(0, 1, 2001))[0], 1 / 2000)[1:-1] == pytest.approx(
            rising(np.linspace(0, 1, 2001))[1][1:-1], abs=1e-3
        )


@pytest.mark.parametrize("said", [0.7, 0.8, 1.2, 1.3])
def test_a_lift_that_no_particle_feels(said):
    """A fifth of what lifts a box of five spacings is one spacing of water over it: 0.6 more, 0.4 less may be."""
    finding = only(ask(CheckLift(), immersed(said=said)))
    layer, exact = SPACING * 1000.0 * G * EDGES[0] * EDGES[1], lifted(0.14)
    assert not finding.passed and finding.value == pytest.approx(said * exact, rel=1e-4)
    assert finding.expected == pytest.approx(exact, rel=0.03)
    assert finding.limit - finding.expected == pytest.approx((0.6 if said > 1.0 else -0.4) * layer, rel=0.02)


@pytest.mark.parametrize(("viscosity", "sound"), [(1e-3, False), (100.0, True), (1e6, True)])
@pytest.mark.parametrize("falls", [True, False])
def test_drag_holds_back_what_moves_in_honey(viscosity, sound, falls):
    """The particles' momentum and pressure tell nothing of it; what it pushes along is told as before."""
    recording = immersed(said=1.3)
    qd = recording.body_qd.copy()
    qd[..., 2] = -0.27 if falls else 0.27
    fluid = recording.world.fluids[0].model_copy(update={"viscosity": viscosity})
    thick = with_world(replace(recording, body_qd=qd), fluids=[fluid])
    assert only(ask(CheckLift(), thick)).passed is (sound and falls)


@pytest.mark.parametrize("said", [0.93, 1.0, 1.07])
def test_what_particles_do_not_resolve_is_let_pass(said):
    assert only(ask(CheckLift(), immersed(said=said))).passed


@pytest.mark.parametrize("density", [600.0, 700.0])
def test_half_a_second_of_bobbing_is_too_short_to_be_sure(tmp_path, density):
    """A block let go two centimetres too deep: by sound in the water some frames in a row say half as much again."""
    scene = Scene()
    scene.simulation(duration=0.5)
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.4), position=(0, 0, 0))
    scene.fluid("water", fills=tank, level=0.13, spacing=0.025)
    scene.box("block", size=(0.12,) * 3, density=density, position=(0, 0, 0.19 - 0.12 * density / 1000.0))
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    assert only(ask(CheckLift(), read(tmp_path / "r.rrd"))).passed


def test_a_body_on_or_near_the_floor_is_not_asked():
    """The ramp under it takes two layers of particles, and what SPH gives a body on the floor is too little anyway."""
    assert ask(CheckLift(), immersed(height=0.02, said=0.0)) == []
    assert not only(ask(CheckLift(), immersed(height=0.06, said=0.0))).passed


def test_bodies_apart_are_asked_each_and_near_each_other_neither():
    apart = immersed(at=(-0.2, 0.0), said=1.3, others=[np.array([0.16, 0.0, 0.19])])
    assert [finding.passed for finding in ask(CheckLift(), apart)] == [False, False]
    assert ask(CheckLift(), immersed(at=(-0.2, 0.0), said=1.3, others=[np.array([0.0, 0.0, 0.19])])) == []


def test_not_asked_where_it_cannot_be_told():
    """Without the fluid's impulses, with what stands in the tank, and where the pool is spilled."""
    recording = immersed(said=2.0)
    assert ask(CheckLift(), replace(recording, applied_impulse=None)) == []
    stands = with_world(recording, statics=[slab("post", (0.04, 0.04, 0.4), (0.2, 0.0, 0.2))])
    assert ask(CheckLift(), stands) == []
    water = recording.fluids[WATER]
    position = water.position.copy()
    position[:, :100, 0] += 1.0
    assert ask(CheckLift(), replace(recording, fluids={WATER: replace(water, position=position)})) == []
