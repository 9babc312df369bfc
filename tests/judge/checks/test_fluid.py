"""A fluid at rest: all of it is there, and its pressure grows with depth."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.conftest import WALL, WATER, G
from wsim.judge.checks.fluid import CheckFluidMass, CheckHydrostatic, CheckPlanFluid
from wsim.judge.evidence.evidence import Evidence
from wsim.scene.world import Parameter, Shape, Static

SOUND = 20.0  # [m/s]


def only(findings):
    assert len(findings) == 1, findings
    return findings[0]


def pressed(case, factor=1.0):
    """The case with the density that a pressure of `factor` rho g depth gives, p = c^2 (rho - rho0)."""
    track = case.recording.fluids[WATER]
    level = WALL + Evidence(case.recording).level(case.recording.world.fluids[0]).height - WALL
    depth = np.maximum(level - track.position[:, :, 2], 0.0)
    density = 1000.0 * (1.0 + factor * G * depth / SOUND**2)
    return case.water(density=density.astype(np.float32)).changed(metadata={"speed_of_sound": SOUND})


@pytest.mark.parametrize(
    ("factor", "passes"), [(1.0, True), (0.85, True), (1.15, True), (0.75, False), (1.25, False), (0.0, False)]
)
def test_pressure_grows_with_depth_as_rho_g(pool, factor, passes):
    finding = only(CheckHydrostatic().evaluate(Evidence(pressed(pool(), factor).recording)))
    assert finding.passed == passes
    assert finding.value == pytest.approx(factor * 1000.0 * G, rel=0.01, abs=20.0)
    assert finding.expected == pytest.approx(1000.0 * G)
    assert passes or finding.target.kind == "fluid"


def test_a_fluid_that_moves_or_has_no_known_sound_is_not_asked(pool):
    case = pressed(pool(), 0.0)
    assert CheckHydrostatic().evaluate(Evidence(case.changed(metadata={}).recording)) == []
    moving = np.full_like(case.recording.fluids[WATER].velocity, 0.2)
    assert CheckHydrostatic().evaluate(Evidence(case.water(velocity=moving).recording)) == []


@pytest.mark.parametrize(("kept", "passes"), [(1.0, True), (0.96, True), (0.9, False), (0.5, False)])
def test_a_fluid_has_the_mass_of_its_box(pool, kept, passes):
    case = pool()
    track = case.recording.fluids[WATER]
    count = round(kept * track.position.shape[1])
    fewer = replace(
        track, position=track.position[:, :count], velocity=track.velocity[:, :count], density=track.density[:, :count]
    )
    recording = replace(case.recording, fluids={WATER: fewer})
    finding = only(CheckFluidMass().evaluate(Evidence(recording)))
    assert finding.passed == passes == (finding.target is None) and finding.unit == "kg"
    assert finding.value == pytest.approx(kept * 0.66 * 0.51 * 0.3 * 1000.0, rel=1e-3)


@pytest.mark.parametrize(("removed", "passes"), [(True, True), (False, False)])
def test_what_stands_still_in_a_fluid_takes_its_place(pool, removed, passes):
    """A block of 18 litres in 101: without the particles that were in it the fluid is whole, with them too much."""
    case, size, at = pool(), (0.3, 0.2, 0.3), (0.1, 0.0, 0.17)
    bare = only(CheckFluidMass().evaluate(Evidence(case.recording))).expected
    block = Shape(prim="/World/block/s", kind="box", size=size, position=at)
    world = case.recording.world
    case = case.world(statics=[*world.statics, Static(prim="/World/block", shapes=[block])])
    track = case.recording.fluids[WATER]
    inside = (np.abs(track.position[0] - at) < np.array(size) / 2).all(axis=1) & removed
    kept = replace(
        track,
        position=track.position[:, ~inside],
        velocity=track.velocity[:, ~inside],
        density=track.density[:, ~inside],
    )
    finding = only(CheckFluidMass().evaluate(Evidence(replace(case.recording, fluids={WATER: kept}))))
    assert finding.passed is passes and finding.expected == pytest.approx(bare - 18.0, abs=1.0)


# ---- against the plan
def altered(case, density=1000.0, lower=0.0):
    """The case with a fluid of another density, or whose surface is lower [m]."""
    fluid = case.recording.world.fluids[0]
    size, center = list(fluid.size), list(fluid.center)
    size[2], center[2] = size[2] - lower, center[2] - lower / 2
    other = fluid.model_copy(update={"density": density, "size": tuple(size), "center": tuple(center)})
    return case.world(fluids=[other])


@pytest.mark.parametrize(("density", "passes"), [(1000.0, True), (1040.0, True), (940.0, False), (800.0, False)])
def test_a_fluid_is_of_the_plans_density(pool, density, passes):
    case = altered(pool(), density=density)
    finding = only(CheckPlanFluid().evaluate(Evidence(case.recording, case.plan)))
    assert finding.passed == passes and (passes or finding.target.suggested == pytest.approx(1000.0))
    assert CheckPlanFluid().evaluate(Evidence(case.recording)) == []
    varied = case.world(parameters=[Parameter(name="density", value=density, default=1000.0)])
    assert density == 1000.0 or CheckPlanFluid().evaluate(Evidence(varied.recording, case.plan)) == []


@pytest.mark.parametrize(("speed", "passes"), [(2.0, True), (2.09, True), (0.0, False), (-2.0, False)])
def test_a_fluid_starts_at_the_plans_velocity(pool, speed, passes):
    case = pool()
    case = case.world(fluids=[case.recording.world.fluids[0].model_copy(update={"velocity": (speed, 0.0, 0.0)})])
    water = next(item for item in case.plan.objects if item.primitive == "fluid")
    others = [item for item in case.plan.objects if item is not water]
    thrown = water.model_copy(update={"velocity": (2.0, 0.0, 0.0)})
    plan = case.plan.model_copy(update={"objects": [thrown, *others]})
    finding = only(CheckPlanFluid().evaluate(Evidence(case.recording, plan)))
    assert finding.passed == passes and (passes or finding.target.vector == (2.0, 0.0, 0.0))


@pytest.mark.parametrize(("spacings", "passes"), [(0.0, True), (0.4, True), (0.6, False), (-0.6, False), (2.0, False)])
def test_a_fluid_is_filled_to_the_plans_level(pool, spacings, passes):
    right = pool()
    case = altered(right, lower=spacings * right.recording.world.fluids[0].spacing)
    finding = only(CheckPlanFluid().evaluate(Evidence(case.recording, case.plan)))
    assert finding.passed == passes and (passes or finding.target.parameter == "level")
    assert passes or finding.target.direction == ("raise" if spacings > 0.0 else "lower")
