"""Stages with several liquids: what the solver gets of each, alone and in a batch, and what the judge makes of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.layers import mass_displaced, needed_of
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.collect import collect
from wsim.sim.fluids import several_liquids
from wsim.sim.model import build_model

SPACING, G = 0.03, 9.81


def stage_of(folder: Path, oil: float, name: str = "stage", block: bool = True, **told: object) -> Path:
    """Water, oil on it, and a block that is let go over them, if any."""
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=30.0)
    tank = scene.tank("tank", inner_size=(0.24, 0.24, 0.4))
    scene.fluid("water", fills=tank, level=0.12, spacing=SPACING)
    given = {"density": oil, "viscosity": 0.05, "spacing": SPACING} | told
    scene.fluid("oil", fills=tank, level=0.24, speed_of_sound=20.0, **given)
    if block:
        scene.box("block", size=(0.09, 0.09, 0.09), density=950.0, position=(0.0, 0.0, 0.32))
    scene.save(stage := folder / f"{name}.usda")
    return stage


def test_each_particle_is_of_its_own_liquid_and_under_what_lies_on_it(tmp_path: Path) -> None:
    built = build_model(stage := stage_of(tmp_path, 800.0), describe(stage), "cpu")
    water, oil = (built.fluids[0][f"/World/{name}"] for name in ("water", "oil"))
    density, viscosity = built.model.sph.liquid_density.numpy(), built.model.sph.liquid_viscosity.numpy()
    assert set(density[water]) == {1000.0} and set(density[oil]) == {800.0}
    assert viscosity[oil] == pytest.approx(0.05) and viscosity[water] == pytest.approx(0.001)
    mass, z = built.model.particle_mass.numpy(), built.model.particle_q.numpy()[:, 2]
    assert mass[oil].sum() == pytest.approx(800.0 * 0.24 * 0.24 * 0.12, rel=1e-5)
    pressure, floor = built.model.sph.pressure.numpy(), 0.02
    expected = G * (800.0 * 0.12 + 1000.0 * (0.12 + floor - z[water]))
    assert pressure[water] == pytest.approx(expected, rel=1e-4)
    assert built.sph.speed_of_sound == 20.0


def test_one_liquid_takes_nothing_for_several(tmp_path: Path) -> None:
    world = describe(stage := stage_of(tmp_path, 1000.0, viscosity=0.001))
    assert len(world.fluids) == 2 and not several_liquids([world])
    assert getattr(build_model(stage, world, "cpu").model.sph, "liquid_density", None) is None


def test_what_yields_has_its_law_and_a_step_that_holds_it(tmp_path: Path) -> None:
    steps = {}
    for name, told in (("plain", {}), ("mud", {"yield_stress": 60.0, "flow_index": 0.8})):
        world = describe(stage := stage_of(tmp_path, 1000.0, name, viscosity=0.5, **told))
        built = build_model(stage, world, "cpu")
        steps[name] = built.time_step.dt
        if name == "mud":
            water, mud = (built.fluids[0][f"/World/{each}"] for each in ("water", "oil"))
            stress, index = built.model.sph.yield_stress.numpy(), built.model.sph.flow_index.numpy()
            assert (stress[mud] == 60.0).all() and (stress[water] == 0.0).all()
            assert index[mud] == pytest.approx(0.8) and (index[water] == 1.0).all()
    assert steps["mud"] == pytest.approx(steps["plain"], rel=0.02)  # in stages; forward it would be a thirtieth


def test_liquids_of_different_spacing_are_refused(tmp_path: Path) -> None:
    world = describe(stage := stage_of(tmp_path, 900.0, spacing=0.02))
    with pytest.raises(UserError, match=r"/World/oil: spacing = 0.02 differs from the 0.03 of /World/water"):
        build_model(stage, world, "cpu")


def test_a_world_with_two_liquids_goes_in_a_batch_as_alone(tmp_path: Path) -> None:
    """Without bodies, whose solvers do not round alike; the oil starts to one side."""
    stages = [stage_of(tmp_path, 700.0 + 100.0 * k, f"{k}", False, velocity=(0.3, 0.0, 0.0)) for k in range(3)]
    batch = collect(Simulation(stages, "cpu"))
    assert batch.problems == [[], [], []]
    for k in (0, 2):
        alone = collect(Simulation(stages[k], "cpu", time_step=batch.metadata["time_step"])).recording(0)
        for prim, track in batch.recording(k).fluids.items():
            other = alone.fluids[prim]
            for name in ("position", "velocity", "density"):
                assert getattr(track, name).tobytes() == getattr(other, name).tobytes(), (k, prim, name)
        moved = batch.fluids[k]["/World/oil"].position
        assert np.abs(moved[-1] - moved[0]).max() > 0.3 * SPACING


def test_the_judge_reads_each_liquids_density(tmp_path: Path) -> None:
    """Levels on each other, and a block in both: Archimedes in layers."""
    evidence = Evidence(collect(Simulation(stage_of(tmp_path, 900.0), "cpu")).recording(0))
    water, oil = evidence.world.fluids
    over, under = evidence.level(oil), evidence.level(water)
    assert over.bottom == pytest.approx(under.height) and under.bottom == under.floor
    assert over.height - over.bottom == pytest.approx(0.12, abs=0.02)
    edge, low = 0.09, under.height - 0.04  # 4 cm in the water, 5 cm in the oil

    def block(z: float) -> float:
        return edge**2 * float(np.clip(z - low, 0.0, edge))

    assert mass_displaced(evidence, oil, block) == pytest.approx(edge**2 * (40.0 + 0.05 * 900.0))
    # 950 kg/m^3 between 900 and 1000: half of it in each.
    assert needed_of(evidence, water, 950.0 * edge**3, edge**3) == pytest.approx(0.5 * edge**3)
    assert needed_of(evidence, oil, 450.0 * edge**3, edge**3) == pytest.approx(0.5 * edge**3)
