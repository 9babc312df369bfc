"""A tap and a drain, from a stage through a run and its recording to the verdict."""

from dataclasses import replace

import numpy as np
import pytest

from wsim import recording
from wsim.errors import UserError
from wsim.judge.decide import judge
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.openings import seen_particles

RATE, SPACING = 0.004, 0.025


def stage_of(folder, level=0.1, rate=RATE):
    scene = Scene()
    scene.ground("ground")
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.3), position=(0.0, 0.0, 0.1))
    water = scene.fluid("water", fills=tank, level=level, spacing=SPACING)
    scene.tap("tap", water, rate=rate, position=(-0.1, 0.0, 0.35), radius=0.05, stop=0.8)
    scene.drain("drain", water, position=(0.1, 0.1, tank.floor), radius=0.06)
    scene.simulation(duration=1.2)
    return scene.save(folder / f"{level}_{rate}.usda")


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    folder = tmp_path_factory.mktemp("taps")
    simulation = Simulation(stage_of(folder), device="cpu")
    result = simulation.run(folder / "run.rrd")
    assert result.problems == []
    shown = np.isfinite(seen_particles(simulation.model, simulation.state)).all(axis=1)
    return recording.read(folder / "run.rrd"), int(shown.sum())


def test_what_came_is_held_or_went_to_the_particle(told):
    recorded, shown = told
    track, scalars = recorded.fluids["/World/water"], recorded.scalars
    mass = 1000.0 * SPACING**3
    held = track.count * mass
    assert track.count[-1] == shown  # what is drawn is what is recorded
    assert held[0] == pytest.approx(16.0)
    assert scalars["fluid/mass_in"][-1] == pytest.approx(1000.0 * RATE * 0.8, abs=14 * mass)  # a layer in the mouth
    assert scalars["fluid/mass_out"][-1] > 3.0
    off = held[0] + scalars["fluid/mass_in"] - scalars["fluid/mass_out"] - held
    assert np.abs(off).max() < 1e-4 * (held[0] + 3.2)
    assert np.isnan(track.position[~track.present]).all()
    assert np.isfinite(track.position[track.present]).all()
    assert (track.position[track.present][:, 2] > 0.1 - SPACING).all()  # nothing that waits or went is there


def test_the_judge_accepts_it_and_says_what_came_and_went(told):
    verdict = judge(told[0])
    assert [f.message for f in verdict.findings if not f.passed] == []
    said = {f.check: f.message for f in verdict.findings}
    assert "16 kg at the start and " in said["CheckPassedMass"]
    assert "CheckPoured" in said
    assert "CheckFluidMomentum" in said


def test_the_judge_finds_particles_that_came_by_no_tap(told):
    recorded, _ = told
    track = recorded.fluids["/World/water"]
    extra = np.flatnonzero(~track.present[30:].any(axis=0) | ~track.present.any(axis=0))[:5]
    assert len(extra) == 5
    arrays = [each.copy() for each in (track.position, track.velocity, track.density, track.present)]
    for each in arrays:  # as the first particle is that stays
        each[30:, extra] = each[30:, [np.flatnonzero(track.present.all(axis=0))[0]]]
    position, velocity, density, present = arrays
    fluids = {"/World/water": replace(track, position=position, velocity=velocity, density=density, present=present)}
    assert "CheckPassedMass" in failed(replace(recorded, fluids=fluids))


def test_the_judge_finds_a_tap_that_does_not_keep_to_its_rate(told):
    recorded, _ = told
    more = recorded.scalars | {"fluid/mass_in": 1.3 * recorded.scalars["fluid/mass_in"]}
    assert "CheckPoured" in failed(replace(recorded, scalars=more))


def test_the_judge_finds_a_push_that_no_opening_gave(told):
    recorded, _ = told
    less = recorded.scalars | {"fluid/opening_impulse_z": recorded.scalars["fluid/opening_impulse_z"] + 0.2}
    assert "CheckFluidMomentum" in failed(replace(recorded, scalars=less))


def failed(recorded) -> set[str]:
    return {finding.check for finding in judge(recorded).findings if not finding.passed}


def test_worlds_of_a_batch_have_taps_of_their_own(tmp_path):
    stages = [stage_of(tmp_path, rate=rate) for rate in (RATE, 2.0 * RATE)]
    simulation = Simulation(stages, device="cpu")
    while simulation.time < 0.3:
        simulation.step()
    come = simulation.fluid.openings.come()
    assert come == pytest.approx(np.array([1.0, 2.0]) * 1000.0 * RATE * 0.3, abs=14 * 1000.0 * SPACING**3)


def test_a_world_that_the_solver_has_no_room_for_is_refused_in_a_line(tmp_path):
    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.3))
    water = scene.fluid("water", fills=tank, level=0.1, spacing=SPACING)
    scene.tap("tap", water, rate=RATE, position=(9e3, 9e3, 9e3), radius=0.05)
    with pytest.raises(UserError, match="grid cells; use a coarser spacing or a smaller domain"):
        Simulation(scene.save(tmp_path / "far.usda"), device="cpu")


def test_a_tank_that_starts_empty_is_filled(tmp_path):
    simulation = Simulation(stage_of(tmp_path, level=0.0), device="cpu")
    assert not np.isfinite(seen_particles(simulation.model, simulation.state)).any()
    while simulation.time < 0.2:
        simulation.step()
    assert simulation.fluid.openings.free().sum() == pytest.approx(RATE * 0.2 / SPACING**3, abs=14)
