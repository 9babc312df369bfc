"""The momentum of a fluid as a whole, in closed form: a block that falls, and pushes what it is told to."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import ball, times
from wsim.judge.checks.fluid_books import CheckFluidMomentum
from wsim.judge.evidence.evidence import Evidence
from wsim.recording.recording import FluidTrack, Recording
from wsim.scene.world import Fluid, World

G, N, MASS = 9.81, 1000, 8.0  # of 1000 kg/m^3 in 0.2 x 0.2 x 0.2 m
WATER = "/World/water"


def pushing(on_body, on_walls, spread=0.0, seed=0):
    """Fluid whose mean velocity follows from gravity and what it gives [N], its particles scattered about it [m/s]."""
    t = times(0.5)
    on_body, on_walls = np.array(on_body), np.array(on_walls)
    mean = t[:, None] * (np.array([0.0, 0.0, -G]) - (on_body + on_walls) / MASS)
    scatter = np.random.default_rng(seed).normal(scale=spread or 1e-12, size=(len(t), N, 3))
    scatter -= scatter.mean(axis=1, keepdims=True)
    velocity = (mean[:, None] + scatter).astype(np.float32)
    fluid = Fluid(prim=WATER, density=1000.0, viscosity=1e-3, spacing=0.02, size=(0.2, 0.2, 0.2), center=(0, 0, 1))
    world = World(duration=0.5, frame_rate=30.0, bodies=[ball()], statics=[], fluids=[fluid])
    track = FluidTrack(t, np.zeros_like(velocity), velocity, np.full((len(t), N), 1000.0, dtype=np.float32))
    h = np.diff(t, prepend=t[0])[:, None]
    still = np.zeros((len(t), 1, 7), np.float32), np.zeros((len(t), 1, 6), np.float32), np.zeros((len(t), 1, 3))
    return Recording(
        Path("pushing"), world, {"time_step": 1e-3}, t, *still, {WATER: track}, {}, [], {},
        applied_impulse=(h * on_body)[:, None].astype(np.float32), applied_work=np.zeros((len(t), 1), np.float32),
        wall_impulse=(h * on_walls).astype(np.float32),
    )  # fmt: skip


def asked(recording):
    found = CheckFluidMomentum().run(Evidence(recording))
    return found[0] if found else None


vectors = st.tuples(*[st.floats(-200.0, 200.0)] * 3)


@settings(max_examples=15, deadline=None)
@given(on_body=vectors, on_walls=vectors, spread=st.floats(0.0, 3.0), seed=st.integers(0, 99))
def test_what_a_fluid_gives_is_what_it_loses(on_body, on_walls, spread, seed):
    assert asked(pushing(on_body, on_walls, spread, seed)).passed


@pytest.mark.parametrize("row", ["applied_impulse", "wall_impulse"])
@pytest.mark.parametrize("off", [0.01, -0.01])
def test_a_push_that_no_particle_feels(row, off):
    """A hundredth of a tenth of the weight: 8 mN of 78 N."""
    recording = pushing((0.0, 0.0, 0.1 * MASS * G), (0.0, 0.0, 0.9 * MASS * G), 0.5)
    wrong = getattr(recording, row).copy()
    wrong[..., 2] += off * recording.applied_impulse[:, 0, 2].reshape(-1, *[1] * (wrong.ndim - 2))
    finding = asked(replace(recording, **{row: wrong}))
    assert not finding.passed
    assert finding.value == pytest.approx(abs(off) * 0.1 * MASS * G, rel=0.01)


def test_what_control_pushes_is_not_the_fluids():
    recording = pushing((1.0, 0.0, 5.0), (0.0, 0.0, 70.0))
    control = np.full((len(recording.time), 1, 3), 0.1, dtype=np.float32)
    both = replace(recording, applied_impulse=recording.applied_impulse + control, control_impulse=control)
    assert asked(both).passed
    assert not asked(replace(both, control_impulse=0.9 * control)).passed
    assert asked(replace(both, control_impulse=None, metadata={"controlled": True})) is None


def test_a_recording_without_the_walls_share_is_not_asked():
    assert asked(replace(pushing((0, 0, 1), (0, 0, 1)), wall_impulse=None)) is None


@pytest.mark.parametrize(("share", "sound"), [(1e-8, True), (1e-5, False)])
def test_what_no_longer_pushes_has_the_rounding_of_all_that_it_did(share, sound):
    """As of the last drops of a tank that drains: sums of single precision went through all of it."""
    recording = pushing((0.0, 0.0, 70.0), (0.0, 0.0, -70.0))
    late, track = recording.time > 0.25, recording.fluids[WATER]
    body, walls = recording.applied_impulse.copy(), recording.wall_impulse.copy()
    body[late], walls[late] = 0.0, 0.0
    walls[-1, 2] = share * 140.0 / 30.0
    still = {WATER: replace(track, velocity=np.zeros_like(track.velocity))}
    world = recording.world.model_copy(update={"gravity": (0.0, 0.0, 0.0)})
    assert (
        asked(replace(recording, world=world, fluids=still, applied_impulse=body, wall_impulse=walls)).passed is sound
    )
