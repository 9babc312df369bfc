"""Faults of how bodies move: gravity, friction, bounces, energy, time, and places that no motion leads to."""

from __future__ import annotations

from benchmarks.judge_worlds import differences as by
from benchmarks.judge_worlds import in_program as program
from benchmarks.judge_worlds import in_recording as recording
from benchmarks.judge_worlds import in_solver as solver
from benchmarks.judge_worlds.fault import Fault

G = 9.81


def _stated_gravity(world: str, variant: int, factor: float) -> Fault:
    change = program.weak_gravity(round(factor * G, 3))
    return Fault("gravity 20 % off", world, variant, f"{factor:g} g", by.gravity(), 0.19, "of g", program=change)


def _gravity(world: str, variant: int, factor: float, name: str, least: float) -> Fault:
    size = f"{factor:g} g in the solver alone"
    tamper = solver.Gravity(factor)
    return Fault("gravity 20 % off", world, variant, size, by.way(name), least, "m", tamper=tamper)


def _slippery(world: str, variant: int, name: str, least: float) -> Fault:
    tamper = solver.Friction(0.02)
    return Fault("friction lost", world, variant, "a fiftieth in the solver", by.way(name), least, "m", tamper=tamper)


def _bounce(world: str, variant: int, name: str, factor: float, least: float) -> Fault:
    tamper = solver.Bounce(name, factor)
    return Fault("restitution > 1", world, variant, f"{factor:g}", by.speed(name), least, "m/s", tamper=tamper)


def _teleport(world: str, variant: int, name: str, offset: tuple[float, float, float], at: float) -> Fault:
    length = sum(x * x for x in offset) ** 0.5
    return Fault(
        "teleport for one frame", world, variant, f"{name} by {length:g} m", by.way(name), 0.99 * length, "m",
        tamper=recording.Teleport(name, offset, at),
    )  # fmt: skip


def _drift(world: str, variant: int, name: str, velocity: tuple[float, float, float], least: float) -> Fault:
    pace = sum(x * x for x in velocity) ** 0.5
    return Fault(
        "slow drift", world, variant, f"{name} at {pace:g} m/s", by.end(name), least, "m",
        tamper=recording.Drift(name, velocity),
    )  # fmt: skip


def _jitter(world: str, variant: int, name: str, amplitude: float) -> Fault:
    return Fault(
        "jitter", world, variant, f"{name} by {1e3 * amplitude:g} mm", by.trembling(name), 0.9 * amplitude, "m",
        tamper=recording.Jitter(name, amplitude),
    )  # fmt: skip


def _energy(world: str, variant: int, rate: float) -> Fault:
    return Fault(
        "energy gain of 2 %", world, variant, "over the run", by.energy(), 0.018, "of the energy",
        tamper=solver.GainEnergy(rate),
    )  # fmt: skip


def _late(world: str, variant: int, name: str, least: float, seconds: float = 1.0) -> Fault:
    tamper = recording.Late(seconds)
    return Fault("late by 1 s", world, variant, f"by {seconds:g} s", by.way(name), least, "m", tamper=tamper)


def _order(world: str, variant: int, first: str, second: str, least: float) -> Fault:
    size = f"{first} as {second}"
    tamper = recording.Swap(first, second)
    return Fault("wrong order of events", world, variant, size, by.way(first), least, "m", tamper=tamper)


def _short(world: str, variant: int, name: str, deceleration: float, least: float = 0.4) -> Fault:
    tamper = solver.Brake(name, deceleration)
    return Fault("stops short by 0.5 m", world, variant, name, by.end(name), least, "m", tamper=tamper)


def _tips(world: str, variant: int, name: str, start: float, spin: tuple[float, float, float]) -> Fault:
    tamper = solver.Kick(name, start, angular=spin, linear=(spin[1] * 0.1, 0.0, 0.1))
    return Fault("tips over at the very end", world, variant, name, by.turn(name), 30.0, "deg", tamper=tamper)


def _hovers(world: str, variant: int, name: str, gap: float) -> Fault:
    return Fault(
        "hovers", world, variant, f"{name} {1e3 * gap:g} mm above what carries it", by.way(name), 0.99 * gap, "m",
        tamper=recording.Displaced(name, (0.0, 0.0, gap)),
    )  # fmt: skip


def _sunk(world: str, variant: int, name: str, depth: float) -> Fault:
    return Fault(
        "sunk in", world, variant, f"{name} by {1e3 * depth:g} mm", by.way(name), 0.99 * depth, "m",
        tamper=recording.Displaced(name, (0.0, 0.0, -depth)),
    )  # fmt: skip


def _frozen(world: str, variant: int, name: str, start: float, seconds: float, least: float) -> Fault:
    return Fault(
        "frozen in the air", world, variant, f"for {seconds:g} s", by.way(name), least, "m",
        tamper=recording.Freeze(name, start, seconds),
    )  # fmt: skip


def _launched(world: str, variant: int, name: str, factor: float, least: float) -> Fault:
    change = program.launched(name, factor)
    size = f"{factor:g} times the speed"
    return Fault("wrong start", world, variant, size, by.way(name), least, "m", plan=change)


def _momentum(world: str, variant: int, name: str, factor: float, start: float) -> Fault:
    return Fault(
        "momentum lost in a collision", world, variant, f"{name} goes on at {factor:g} of its speed", by.end(name),
        0.04, "m", tamper=recording.Scaled(name, factor, start),
    )  # fmt: skip


OF_MOTION = (
    _stated_gravity("drop", 0, 0.8),
    _stated_gravity("pendulum", 3, 1.2),
    _stated_gravity("floating ball", 0, 0.8),
    _gravity("throw", 0, 0.8, "ball", 0.05),
    _gravity("pendulum", 0, 1.2, "pendulum", 0.05),
    _gravity("ball on table", 1, 0.8, "steel_ball", 0.05),
    _gravity("chain", 0, 1.2, "lower", 0.1),
    _gravity("ramp roll", 1, 0.8, "ball", 0.05),
    _gravity("bucket", 0, 1.2, "ball", 0.02),
    _slippery("slide", 0, "box", 0.5),
    _slippery("slide", 2, "steel_box", 0.5),
    _slippery("ramp rest", 0, "block", 0.1),
    _slippery("ramp roll", 0, "steel_ball", 0.1),
    _slippery("push", 1, "crate", 0.5),
    Fault(
        "friction lost", "slide", 1, "0.02 in the program", by.friction("box"), 0.2, "1",
        plan=lambda plan: program.material("ground", friction=0.02)(program.material("box", friction=0.02)(plan)),
    ),
    _bounce("drop", 1, "steel_cube", 1.1, 0.3),
    _bounce("ball on table", 0, "copper_ball", 1.1, 0.3),
    _bounce("ball on table", 2, "rubber_ball", 1.05, 0.3),
    _bounce("bucket", 2, "steel_ball", 1.1, 0.3),
    Fault(
        "thin wall tunnelled", "thin sheet", 0, "the ball passes", by.way("ball"), 0.3, "m",
        tamper=solver.NoContact("ball"),
    ),
    Fault(
        "thin wall tunnelled", "thin sheet", 1, "the sheet holds nothing", by.way("ball"), 0.3, "m",
        tamper=solver.NoContact("sheet"),
    ),
    Fault(
        "thin wall tunnelled", "thin sheet", 2, "it holds nothing for 0.2 s", by.way("ball"), 0.2, "m",
        tamper=solver.NoContact("sheet", 0.25, 0.45),
    ),
    Fault(
        "thin wall tunnelled", "bucket", 0, "the ball falls out at the bottom", by.way("ball"), 0.005, "m",
        tamper=solver.NoContact("bucket", 0.5),
    ),
    _teleport("tower", 0, "box_3", (0.3, 0.0, 0.0), 1.5),
    _teleport("throw", 1, "ball", (0.0, 0.2, 0.0), 0.3),
    _teleport("pendulum", 2, "steel_ball", (0.0, 0.0, 0.1), 2.0),
    _teleport("rest", 0, "box", (0.0, 0.0, 0.05), 2.0),
    _teleport("floating block", 0, "wooden_block", (0.05, 0.0, 0.0), 2.5),
    _drift("rest", 0, "box", (0.02, 0.0, 0.0), 0.05),
    _drift("tower", 2, "box_2", (0.01, 0.0, 0.0), 0.025),
    _drift("ramp rest", 2, "block", (0.03, 0.0, 0.0), 0.03),
    _drift("desk", 1, "mug", (0.0, 0.02, 0.0), 0.05),
    _jitter("rest", 1, "cylinder", 0.003),
    _jitter("tower", 1, "oak_cube_4", 0.005),
    _jitter("bridge", 0, "cube", 0.002),
    Fault(
        "jitter", "drop", 2, "15 Hz in the solver", by.speed("pine_cube"), 0.2, "m/s",
        tamper=solver.Shake("pine_cube", 0.3, 7.0),
    ),
    Fault(
        "jitter", "desk", 2, "7 Hz in the solver", by.speed("lamp"), 0.05, "m/s",
        tamper=solver.Shake("lamp", 0.1, 7.0),
    ),
    _energy("pendulum", 0, 0.0033),
    _energy("pendulum", 1, 0.005),
    _energy("chain", 1, 0.007),
    _energy("spring", 0, 0.006),
    _energy("ball joint", 0, 0.009),
    _energy("throw", 3, 0.022),
    _energy("cradle", 0, 0.022),
    _late("drop", 0, "oak_cube", 0.3),
    _late("throw", 2, "red_ball", 1.0),
    _late("door", 0, "door", 0.1),
    _late("lift", 0, "deck", 0.1),
    _late("ramp slide", 0, "oak_cube", 0.3),
    _late("slide", 3, "ice_cube", 0.2),
    _order("dominoes", 0, "domino_1", "domino_4", 0.02),
    _order("dominoes", 2, "domino_2", "domino_6", 0.02),
    _order("cradle", 1, "ball_0", "ball_2", 0.05),
    _order("knock over", 0, "wooden_block_4", "steel_ball", 0.1),
    _short("push", 1, "crate", 15.0),
    _short("ramp slide", 3, "ice_block", 6.0),
    _short("throw", 1, "ball", 2.0),
    Fault(
        "stops short by 0.5 m", "slide", 2, "at 0.7 of its speed in the program", by.end("steel_box"), 0.45, "m",
        plan=program.launched("steel_box", 0.7),
    ),
    _tips("rest", 1, "cylinder", 2.4, (0.0, 12.0, 0.0)),
    _tips("tower", 0, "box_3", 2.5, (0.0, 9.0, 0.0)),
    _tips("bridge", 1, "cube", 1.5, (0.0, 14.0, 0.0)),
    _tips("desk", 2, "lamp", 2.4, (0.0, 10.0, 0.0)),
    _hovers("rest", 3, "steel_box", 0.02),
    _hovers("drop", 1, "steel_cube", 0.02),
    _hovers("tower", 2, "box_2", 0.03),
    _hovers("ramp rest", 3, "steel_block", 0.03),
    _sunk("rest", 0, "box", 0.02),
    _sunk("desk", 3, "cube", 0.02),
    _sunk("ramp roll", 2, "rubber_ball", 0.02),
    Fault(
        "sunk in", "drop", 3, "soft contacts in the solver", by.height("ice_cube"), 0.01, "m",
        tamper=solver.SoftContacts(0.0025),
    ),
    _frozen("throw", 3, "steel_ball", 0.4, 0.5, 0.5),
    _frozen("ball on table", 0, "copper_ball", 0.2, 0.3, 0.1),
    _frozen("off the table", 0, "ball", 1.0, 0.4, 0.0),
    _launched("throw", 0, "ball", 0.8, 0.3),
    _launched("wall", 1, "steel_ball", -1.0, 0.5),
    _launched("two balls", 2, "red_ball", 0.5, 0.3),
    _momentum("strike", 2, "target", 0.6, 0.1),
    _momentum("strike", 3, "target", 0.7, 0.05),
    Fault(
        "turns without cause", "throw", 0, "kicked in flight", by.turn("ball"), 20.0, "deg",
        tamper=solver.Kick("ball", 0.25, angular=(0.0, 0.0, 5.0)),
    ),
    Fault(
        "turns without cause", "drop", 2, "kicked as it falls", by.turn("pine_cube"), 5.0, "deg",
        tamper=solver.Kick("pine_cube", 0.1, angular=(0.0, 0.0, 3.0)),
    ),
    Fault(
        "slips instead of rolling", "ramp roll", 3, "without turning", by.turn("brass_ball"), 90.0, "deg",
        tamper=recording.NotTurning("brass_ball"),
    ),
    Fault(
        "slips instead of rolling", "two balls", 2, "without turning", by.turn("red_ball"), 90.0, "deg",
        tamper=recording.NotTurning("red_ball"),
    ),
    Fault(
        "contact force off by half", "rest", 3, "1.5 times the weight", by.pressed("steel_box"), 1.45, "times",
        tamper=recording.Pressed("steel_box", 1.5),
    ),
    Fault(
        "contact force off by half", "tower", 0, "half the weight", by.pressed("box_1"), 1.9, "times",
        tamper=recording.Pressed("box_1", 0.5),
    ),
    Fault("run cut short", "drop", 0, "by 1 s", by.lasting(), 0.95, "s", plan=program.shorter(1.0)),
    Fault("run cut short", "pendulum", 0, "by 0.5 s", by.lasting(), 0.45, "s", plan=program.shorter(0.5)),
)  # fmt: skip
