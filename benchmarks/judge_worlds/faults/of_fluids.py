"""Faults of tanks, and of what floats in them."""

from __future__ import annotations

from benchmarks.judge_worlds import differences as by
from benchmarks.judge_worlds import in_program as program
from benchmarks.judge_worlds import in_recording as recording
from benchmarks.judge_worlds import in_solver as solver
from benchmarks.judge_worlds.fault import Fault


def _leak(world: str, variant: int, share: float) -> Fault:
    return Fault(
        "leaking tank", world, variant, f"{share:.0%} of the water", by.fluid_moved("water", 0.05), 0.9 * share,
        "of the particles", tamper=recording.Leak("water", share, 1.0, 3.0),
    )  # fmt: skip


def _rides(world: str, variant: int, name: str, offset: float) -> Fault:
    kind = "floats 20 % too high" if offset > 0 else "floats 20 % too low"
    return Fault(
        kind, world, variant, f"{name} by {1e3 * abs(offset):g} mm", by.height(name), 0.9 * abs(offset), "m",
        tamper=recording.Displaced(name, (0.0, 0.0, offset), 0.5),
    )  # fmt: skip


OF_FLUIDS = (
    _leak("floating block", 0, 0.05),
    _leak("sinking", 0, 0.03),
    _leak("submerged", 0, 0.1),
    _rides("floating block", 0, "wooden_block", 0.028),
    _rides("floating block", 1, "pine_block", 0.028),
    _rides("floating ball", 0, "cork_ball", 0.04),
    _rides("floating block", 2, "oak_block", -0.028),
    Fault(
        "buoyancy wrong in the solver", "floating block", 0, "0.7 of the force", by.height("wooden_block"), 0.02, "m",
        tamper=solver.NoFluidForce("wooden_block", 0.7),
    ),
    Fault(
        "buoyancy wrong in the solver", "floating ball", 1, "1.5 times the force", by.height("wooden_ball"), 0.02, "m",
        tamper=solver.NoFluidForce("wooden_ball", 1.5),
    ),
    Fault(
        "buoyancy wrong in the solver", "sinking", 0, "20 times the force", by.height("steel_ball"), 0.02, "m",
        tamper=solver.NoFluidForce("steel_ball", 20.0),
    ),
    Fault(
        "wrong fluid", "floating block", 2, "of 800 kg/m^3", by.fluid_density("water"), 1.24, "times",
        plan=program.material("water", density=800.0),
    ),
    Fault(
        "wrong fluid", "submerged", 1, "of 1300 kg/m^3", by.fluid_density("water"), 1.29, "times",
        plan=program.material("water", density=1300.0),
    ),
    Fault(
        "tank filled wrongly", "floating block", 1, "to 0.8 of the level", by.fluid_level("water"), 0.05, "m",
        plan=program.filled("water", 0.8),
    ),
    Fault(
        "tank filled wrongly", "sinking", 1, "to 0.8 of the level", by.fluid_level("water"), 0.03, "m",
        plan=program.filled("water", 0.8),
    ),
    Fault(
        "water compressed", "submerged", 0, "by 10 %", by.compression("water"), 0.08, "of the density",
        tamper=recording.Squeezed("water", 0.9),
    ),
    Fault(
        "water compressed", "floating block", 0, "sound at 4 m/s", by.compression("water"), 0.02, "of the density",
        program=program.replaced("density=1000.0,", "density=1000.0, speed_of_sound=4.0,"),
    ),
    Fault(
        "spray from nowhere", "floating ball", 0, "a particle at 12 m/s", by.fluid_way("water"), 0.5, "m",
        tamper=recording.Spray("water", 12.0, 3.0),
    ),
    Fault(
        "spray from nowhere", "sinking", 2, "a particle at 12 m/s", by.fluid_way("water"), 0.5, "m",
        tamper=recording.Spray("water", 12.0, 3.0),
    ),
    Fault(
        "pours beside", "pour", 0, "the bowl 0.3 m aside", lambda a, b: by.static_way("bowl")(a, b), 0.29, "m",
        plan=program.moved("bowl", (0.3, 0.0, 0.0)),
    ),
)  # fmt: skip
