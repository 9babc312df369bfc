"""Worlds with fluid that differ in numbers, simulated as one batch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.judge.decide import judge
from wsim.judge.worlds import verdicts_of
from wsim.recording import read
from wsim.recording.recording import Recording
from wsim.scene import Drive, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.alike import alike
from wsim.sim.collect import collect

SPACING, DURATION = 0.03, 0.2
APPLIED = ("applied_impulse", "applied_work", "applied_turn", "wall_impulse")


def wet(folder: Path, k: int, bodies: bool = True, **of_fluid: float) -> Path:
    """A tank with a column of water, a block that falls in, and a paddle that is driven; each with its own numbers."""
    draw = np.random.default_rng(k)
    scene = Scene()
    scene.simulation(duration=DURATION, frame_rate=30.0, gravity=(0.0, 0.0, -float(draw.uniform(3.0, 12.0))))
    width = SPACING * (8 + k % 3)
    scene.tank("tank", inner_size=(width, 8 * SPACING, 0.4), position=(0, 0, 0))
    level = SPACING * (4 + k % 4)
    told = {"density": 800.0 + 50.0 * k, "viscosity": 0.001 * k} | of_fluid
    scene.fluid(
        "water", size=(width / 2, 8 * SPACING, level), position=(-width / 4, 0, level / 2), spacing=SPACING, **told
    )
    edge = float(draw.uniform(0.06, 0.09))
    if not bodies:
        return _saved(scene, folder / f"dam_{k}.usda")
    scene.box("block", size=(edge,) * 3, density=float(draw.uniform(200, 3000)), position=(0, 0, level + edge))
    scene.box("paddle", size=(0.04, 0.04, 0.04), density=900.0, position=(0.5, 0, 1.0))
    drive = Drive(velocity=float(draw.uniform(1.0, 4.0)) * 57.3, damping=1.0)
    scene.joint_revolute("axle", None, "paddle", anchor=(0.5, 0, 1.0), axis="Z", drive=drive)
    return _saved(scene, folder / f"wet_{k}.usda")


def _saved(scene: Scene, stage: Path) -> Path:
    scene.save(stage)
    return stage


def same_bits(one: Recording, other: Recording) -> None:
    """All that two recordings hold."""
    for name in ("time", "body_q", "body_qd", "contact_force", *APPLIED):
        assert np.array(getattr(one, name)).tobytes() == np.array(getattr(other, name)).tobytes(), name
    for prim, track in one.fluids.items():
        for name in ("position", "velocity", "density"):
            assert getattr(track, name).tobytes() == getattr(other.fluids[prim], name).tobytes(), name
    for name in ("position", "volume"):
        assert getattr(one.solids.walls, name).tobytes() == getattr(other.solids.walls, name).tobytes(), name
        for prim, own in one.solids.bodies.items():
            assert getattr(own, name).tobytes() == getattr(other.solids.bodies[prim], name).tobytes(), (prim, name)
    assert one.scalars.keys() == other.scalars.keys()
    for name, values in one.scalars.items():
        assert values.tobytes() == other.scalars[name].tobytes(), name


@pytest.fixture(scope="module")
def stages(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return [wet(tmp_path_factory.mktemp("wet"), k, speed_of_sound=20.0) for k in range(3)]


def test_each_is_bit_for_bit_what_it_is_alone(tmp_path: Path) -> None:
    """Columns of water that collapse: places, velocities, densities, what they give to the walls, energies."""
    stages = [wet(tmp_path, k, bodies=False, speed_of_sound=20.0) for k in range(3)]
    batch = collect(Simulation(stages, "cpu"))
    assert batch.problems == [[], [], []]
    assert len({track["/World/water"].position.shape for track in batch.fluids}) == 3
    for k, stage in enumerate(stages):
        alone = collect(Simulation(stage, "cpu", time_step=batch.metadata["time_step"]))
        same_bits(batch.recording(k), alone.recording(0))
        moved = batch.fluids[k]["/World/water"].position
        assert np.abs(moved[-1] - moved[0]).max() > SPACING


def test_each_is_what_it_is_among_copies_of_itself(stages: list[Path]) -> None:
    """With bodies, whose solver goes on in each world until all have converged: to its rounding."""
    assert alike([describe(stage) for stage in stages]) == [[0, 1, 2]]
    batch = collect(Simulation(stages, "cpu"))
    assert batch.problems == [[], [], []]
    for k, stage in enumerate(stages):
        copies = collect(Simulation(stage, "cpu", world_count=2, time_step=batch.metadata["time_step"]))
        one, other = batch.recording(k), copies.recording(0)
        same_bits(other, copies.recording(1))
        for name in ("body_q", *APPLIED):
            assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-5), name
        for name, values in one.scalars.items():
            assert values == pytest.approx(other.scalars[name], rel=1e-4, abs=1e-5), name
        assert one.fluids["/World/water"].position == pytest.approx(other.fluids["/World/water"].position, abs=1e-5)
        assert np.abs(one.applied_impulse).max() > 1e-3  # [N s]: the water does push
        assert one.world == copies.world
        assert one.metadata["sph"] == other.metadata["sph"]


def test_each_is_what_its_own_run_records(stages: list[Path], tmp_path: Path) -> None:
    """MuJoCo's two codes do not round alike; the fluid beside them hardly notices."""
    batch = collect(Simulation(stages, "cpu"))
    verdicts = verdicts_of(batch)
    for k, stage in enumerate(stages):
        Simulation(stage, "cpu", time_step=batch.metadata["time_step"]).run(tmp_path / f"{k}.rrd")
        own, found = read(tmp_path / f"{k}.rrd"), batch.recording(k)
        assert found.fluids["/World/water"].position == pytest.approx(own.fluids["/World/water"].position, abs=2e-4)
        assert found.body_q == pytest.approx(own.body_q, abs=2e-4)
        weight = 9.81 * sum(body.mass for body in own.world.bodies) / 30.0
        for name in ("applied_impulse", "wall_impulse"):
            assert getattr(found, name) == pytest.approx(getattr(own, name), abs=0.02 * weight), name
        for name in ("energy/kinetic_fluid", "energy/potential_fluid", "work/drives", "drive/axle"):
            assert found.scalars[name] == pytest.approx(own.scalars[name], rel=0.01, abs=1e-3), name
        assert verdicts[k].status == judge(own).status


def test_forks_read_what_this_process_reads(stages: list[Path]) -> None:
    one, several = (collect(Simulation(stages, "cpu", processes=processes)) for processes in (1, 3))
    for k in range(3):
        same_bits(one.recording(k), several.recording(k))


def test_a_world_that_goes_wrong_is_told_of_and_leaves_the_others_as_they_are(stages: list[Path]) -> None:
    sound, spoiled = Simulation(stages, "cpu"), Simulation(stages, "cpu")
    velocity = spoiled.state.particle_qd.numpy()
    velocity[spoiled.built.fluids[1]["/World/water"].start] = np.nan
    spoiled.state.particle_qd.assign(velocity)
    expected, found = collect(sound), collect(spoiled)
    assert [len(told) for told in found.problems] == [0, len(found.problems[1]), 0]
    assert any("of world 1 is not finite" in told for told in found.problems[1])
    assert [verdict.status for verdict in verdicts_of(found)][1] == "rejected"
    for k in (0, 2):
        same_bits(found.recording(k), expected.recording(k))


def test_a_fast_particle_is_its_own_worlds(stages: list[Path]) -> None:
    simulation = Simulation(stages, "cpu")
    velocity = simulation.state.particle_qd.numpy()
    velocity[simulation.built.fluids[2]["/World/water"].start, 2] = 40.0
    simulation.state.particle_qd.assign(velocity)
    assert simulation.fluid is not None
    faults = simulation.fluid.faults(simulation.state)
    assert faults[:2] == ["", ""]
    assert "faster than sound" in faults[2]
    with pytest.raises(RuntimeError, match="faster than sound"):
        simulation.fluid.check(simulation.state)


def test_sound_is_as_fast_as_the_world_that_needs_it_fastest_has_it(tmp_path: Path) -> None:
    stages = [wet(tmp_path, k) for k in range(3)]
    batch = Simulation(stages, "cpu")
    own = [Simulation(stage, "cpu") for stage in stages]
    assert batch.built.sph.speed_of_sound == max(each.built.sph.speed_of_sound for each in own)
    assert batch.dt == pytest.approx(min(each.dt for each in own), rel=1e-6)
    assert batch.fluid is not None
    assert batch.fluid.viscosity.numpy() == pytest.approx([0.0, 0.001, 0.002])
    assert batch.fluid.rest_density.numpy() == pytest.approx([800.0, 850.0, 900.0])


def test_another_spacing_is_another_batch(tmp_path: Path) -> None:
    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.24, 0.24, 0.4), position=(0, 0, 0))
    scene.fluid("water", fills=tank, level=0.12, spacing=0.03)
    scene.save(tmp_path / "fine.usda")
    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.24, 0.24, 0.4), position=(0, 0, 0))
    scene.fluid("water", fills=tank, level=0.12, spacing=0.04)
    scene.save(tmp_path / "coarse.usda")
    stages = [tmp_path / "fine.usda", tmp_path / "coarse.usda"]
    with pytest.raises((ValueError, UserError), match="another world"):
        Simulation(stages, "cpu")


@pytest.mark.cuda
def test_on_cuda_each_is_what_it_is_among_copies_of_itself(stages: list[Path]) -> None:
    batch = collect(Simulation(stages, "cuda:0"))
    for k, stage in enumerate(stages):
        copies = collect(Simulation(stage, "cuda:0", world_count=2, time_step=batch.metadata["time_step"]))
        one, other = batch.recording(k), copies.recording(0)
        assert one.fluids["/World/water"].position == pytest.approx(other.fluids["/World/water"].position, abs=2e-4)
        assert one.body_q == pytest.approx(other.body_q, abs=2e-4)
