"""Faults of joints and motors."""

from __future__ import annotations

from benchmarks.judge_worlds import differences as by
from benchmarks.judge_worlds import in_program as program
from benchmarks.judge_worlds import in_recording as recording
from benchmarks.judge_worlds.fault import Fault


def _broken(world: str, variant: int, name: str, start: float, radius: float) -> Fault:
    return Fault(
        "joint broken mid-run", world, variant, f"{name} at {start:g} s", by.end(name), 0.1, "m",
        tamper=recording.Fallen(name, start, radius),
    )  # fmt: skip


def _missing(world: str, variant: int, joint: str, name: str) -> Fault:
    change = program.without_joint(joint)
    return Fault("joint missing", world, variant, joint, by.way(name), 0.05, "m", plan=change)


def _sign(world: str, variant: int, old: str, new: str, name: str) -> Fault:
    size = f"{old} is {new}"
    change = program.replaced(old, new)
    return Fault("sign error in a motor", world, variant, size, by.way(name), 0.1, "m", program=change)


def _weak(world: str, variant: int, old: str, new: str, name: str, least: float) -> Fault:
    size = f"{old} is {new}"
    change = program.replaced(old, new)
    return Fault("motor too weak", world, variant, size, by.way(name), least, "m", program=change)


OF_JOINTS = (
    _broken("pendulum", 0, "pendulum", 2.0, 0.08),
    _broken("cradle", 2, "ball_1", 0.6, 0.05),
    _broken("chain", 2, "lower", 1.0, 0.02),
    _broken("wheel", 0, "pin", 1.0, 0.025),
    _missing("pendulum", 3, "pivot", "brass_ball"),
    _missing("chain", 3, "elbow", "lower"),
    _missing("door", 1, "hinge", "door"),
    _sign("door", 0, "position=60.0", "position=-60.0", "door"),
    _sign("wheel", 1, "velocity=180.0", "velocity=-180.0", "pin"),
    _sign("lift", 2, "position=0.4,", "position=-0.4,", "deck"),
    _sign("spring", 1, "position=0.3,", "position=-0.3,", "block"),
    _weak("door", 2, "stiffness=60.0, damping=30.0", "stiffness=6.0, damping=30.0", "door", 0.05),
    _weak("lift", 3, "max_force=1000.0", "max_force=100.0", "deck", 0.1),
    _weak("wheel", 2, "damping=20.0", "damping=0.5", "pin", 0.1),
    Fault(
        "joint about the wrong axis", "door", 3, "X for Z", by.turn("door"), 20.0, "deg",
        plan=program.hinged_elsewhere("hinge", "X"),
    ),
    Fault(
        "joint about the wrong axis", "lift", 0, "X for Z", by.way("deck"), 0.2, "m",
        plan=program.hinged_elsewhere("rail", "X"),
    ),
    Fault(
        "joint drifts apart", "chain", 0, "0.05 m/s", by.end("lower"), 0.1, "m",
        tamper=recording.Drift("lower", (0.0, 0.05, 0.0)),
    ),
    Fault(
        "joint drifts apart", "lift", 1, "0.02 m/s aside", by.end("deck"), 0.05, "m",
        tamper=recording.Drift("deck", (0.02, 0.0, 0.0)),
    ),
    Fault(
        "joint beyond its limit", "door", 0, "opens by 120 degrees", by.turn("door"), 50.0, "deg",
        program=lambda text: program.replaced("position=60.0", "position=120.0")(
            text.replace("limits_deg=(-80.0, 90.0)", "limits_deg=(-80.0, 150.0)")
        ),
    ),
    Fault(
        "joint beyond its limit", "lift", 1, "rises by 1.4 m", by.way("deck"), 0.9, "m",
        program=lambda text: program.replaced("position=0.4,", "position=1.4,")(
            text.replace("limits=(-0.5, 1.0)", "limits=(-0.5, 2.0)")
        ),
    ),
)  # fmt: skip
