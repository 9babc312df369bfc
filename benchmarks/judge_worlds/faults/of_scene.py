"""Faults of what is there: wrong masses, sizes, places, looks and views."""

from __future__ import annotations

from benchmarks.judge_worlds import differences as by
from benchmarks.judge_worlds import in_program as program
from benchmarks.judge_worlds import in_solver as solver
from benchmarks.judge_worlds.fault import Fault


def _mass(world: str, variant: int, name: str, factor: float) -> Fault:
    size = f"{name} {factor:.2g} times as heavy"
    change = program.heavier(name, factor)
    return Fault("mass off by 3", world, variant, size, by.mass(name), 2.95, "times", plan=change)


def _missing(world: str, variant: int, name: str) -> Fault:
    return Fault(
        "object missing", world, variant, name, by.gone(name), 1.0, "object", plan=program.without(name)
    )  # fmt: skip


def _extra(world: str, variant: int, of: str, offset: tuple[float, float, float]) -> Fault:
    name = f"{of}_again"
    return Fault(
        "object too many", world, variant, name, by.gone(name), 1.0, "object", plan=program.extra(of, name, offset)
    )  # fmt: skip


def _swapped(world: str, variant: int, first: str, second: str, least: float) -> Fault:
    size = f"{first} and {second}"
    change = program.swapped(first, second)
    return Fault("objects swapped", world, variant, size, by.way(first), least, "m", plan=change)


def _scaled(world: str, variant: int, name: str, factor: float) -> Fault:
    size = f"{name} {factor:g} times as large"
    change = program.scaled(name, factor)
    return Fault("object mis-scaled", world, variant, size, by.extent(name), 1.24, "times", plan=change)


def _colour(world: str, variant: int, name: str, color: tuple[float, float, float]) -> Fault:
    change = program.material(name, color=color)
    return Fault("wrong colour", world, variant, name, by.colour(name), 0.25, "of a channel", plan=change)


def _place(world: str, variant: int, name: str, offset: tuple[float, float, float], static: bool = False) -> Fault:
    measure = by.static_way(name) if static else by.way(name)
    length = sum(x * x for x in offset) ** 0.5
    return Fault(
        "object misplaced", world, variant, f"{name} by {length:g} m", measure, 0.9 * length, "m",
        plan=program.moved(name, offset),
    )  # fmt: skip


def _turned(world: str, variant: int, name: str, rotation: tuple[float, float, float], least: float) -> Fault:
    change = program.turned(name, rotation)
    return Fault("object turned", world, variant, name, by.turn(name), least, "deg", plan=change)


def _away(world: str, variant: int, direction: tuple[float, float, float]) -> Fault:
    change = program.looking(direction)
    return Fault(
        "camera looking away", world, variant, "every camera", by.view(), 60.0, "deg", plan=change, pictures=True
    )


def _hidden(world: str, variant: int, name: str) -> Fault:
    change = program.invisible(name)
    return Fault(
        "object not drawn", world, variant, name, by.unseen(name), 0.95, "of its pixels", program=change, pictures=True
    )


def _behind(world: str, variant: int, name: str, what: str, eye: tuple[float, float, float], far: float) -> Fault:
    change = program.seen_from(eye, (0.0, 0.0, far))
    return Fault(
        "object hidden", world, variant, f"{name}, by {what}", by.unseen(name), 0.9, "of its pixels", plan=change,
        pictures=True,
    )  # fmt: skip


def _no_collision(world: str, variant: int, name: str, falls: str) -> Fault:
    change = program.no_collision(name)
    return Fault("collision shape missing", world, variant, name, by.way(falls), 0.1, "m", program=change)


OF_SCENE = (
    _mass("drop", 0, "oak_cube", 3.0),
    _mass("strike", 0, "target", 3.0),
    _mass("strike", 1, "striker", 1 / 3),
    _mass("pendulum", 1, "pendulum", 1 / 3),
    _mass("tower", 0, "box_3", 3.0),
    _mass("lift", 1, "cargo", 3.0),
    _missing("tower", 1, "oak_cube_4"),
    _missing("desk", 0, "mug"),
    _missing("floating block", 0, "wooden_block"),
    _missing("wall", 1, "wall"),
    _extra("drop", 1, "steel_cube", (0.5, 0.0, 0.0)),
    _extra("dominoes", 1, "domino_1", (0.0, 0.6, 0.0)),
    _swapped("desk", 0, "laptop", "mug", 0.05),
    _swapped("two balls", 1, "red_ball", "blue_ball", 0.1),
    _swapped("strike", 2, "striker", "target", 0.3),
    _scaled("drop", 2, "pine_cube", 1.25),
    _scaled("pendulum", 0, "pendulum", 1.25),
    _scaled("throw", 0, "ball", 1.5),
    _scaled("floating block", 1, "pine_block", 1.25),
    _colour("two balls", 2, "red_ball", (0.1, 0.1, 0.8)),
    _colour("wall", 3, "blue_ball", (0.1, 0.6, 0.1)),
    _colour("throw", 2, "red_ball", (0.9, 0.9, 0.1)),
    _colour("rest", 3, "steel_box", (0.8, 0.2, 0.1)),
    _place("drop", 3, "ice_cube", (0.3, 0.0, 0.0)),
    _place("wall", 0, "wall", (0.4, 0.0, 0.0), static=True),
    _place("rest", 2, "plank", (0.0, 0.25, 0.0)),
    _turned("rest", 2, "plank", (0.0, 0.0, 90.0), 85.0),
    _turned("rest", 1, "cylinder", (90.0, 0.0, 0.0), 85.0),
    _away("tower", 2, (0.0, -1.0, 0.0)),
    _away("drop", 0, (0.0, -1.0, 0.2)),
    _away("pendulum", 2, (0.0, -1.0, 0.5)),
    _away("ramp roll", 0, (-0.2, -1.0, 0.3)),
    _hidden("two balls", 0, "steel_ball_2"),
    _hidden("tower", 3, "block_3"),
    _behind("wall", 0, "red_ball", "the wall", (4.0, 0.0, 0.15), 0.15),
    _behind("tower", 0, "box_3", "the ground", (0.0, -2.0, -1.0), 0.3),
    _no_collision("drop", 0, "ground", "oak_cube"),
    _no_collision("desk", 1, "table", "mug"),
    Fault(
        "collision shape missing", "tower", 0, "box_2", by.way("box_3"), 0.1, "m", tamper=solver.NoContact("box_2"),
    ),
    _no_collision("wall", 2, "wall", "rubber_ball"),
    Fault(
        "collision shape missing", "seesaw", 1, "steel_cube", by.way("steel_cube"), 0.1, "m",
        tamper=solver.NoContact("steel_cube"),
    ),
    Fault(
        "mass off by 3", "two balls", 0, "steel_ball_1 3 times as heavy in the solver", by.speed("steel_ball_2"), 0.2,
        "m/s", tamper=solver.Mass("steel_ball_1", 3.0),
    ),
    Fault(
        "mass off by 3", "seesaw", 0, "box 3 times as heavy in the solver", by.turn("seesaw"), 1.0, "deg",
        tamper=solver.Mass("box", 3.0),
    ),
)  # fmt: skip
