"""How what a world has differs from its counterpart that the scene's own call made of the plan: shapes and numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.checks.check import Check, listed, share_about
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import friction_of, restitution_of, rolling_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import ArrayLike, NDArray

    from wsim.judge.verdict import Finding, RepairKind
    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]


def between_deg(one: ArrayLike, other: ArrayLike) -> float:
    """The angle from one rotation to another [deg]."""
    turn = multiply(conjugate(np.array(one)), np.array(other))
    return math.degrees(2.0 * math.atan2(float(np.linalg.norm(turn[:3])), abs(float(turn[3]))))


def paired(made: Sequence[Shape], wanted: Sequence[Shape]) -> Iterator[tuple[Shape | None, Shape | None]]:
    """Each shape that is wanted, and the one of its kind that is nearest to it in size and place; then all others."""
    free = list(made)
    for one in wanted:
        alike = [each for each in free if (each.kind, len(each.size)) == (one.kind, len(one.size))]
        found = min(alike, key=lambda each: _far(each, one), default=None)
        if found is not None:
            free.remove(found)
        yield found, one
    yield from ((each, None) for each in free)


def _collision(shape: Shape) -> str:
    """What collides for a shape, of a mesh."""
    return f"collides as its {'triangles' if shape.exact else 'convex hull' if shape.convex else 'convex parts'}"


def _far(one: Shape, other: Shape) -> float:
    place, size = (np.subtract(getattr(one, field), getattr(other, field)) for field in ("position", "size"))
    return float(np.abs(place).sum() + np.abs(size).sum()) + (one.collides != other.collides)


@dataclass
class Comparing(Check):
    """A check that holds what the world has against what the scene's own call makes of the plan."""

    share: float = 0.05  # of a number
    turn: float = 1.0  # [deg]: of a part, a shape or an axis
    grip: float = 0.08  # of friction
    bounce: float = 0.01  # of restitution
    rolling: float = 0.002  # of rolling resistance
    belt: float = 0.01  # [m/s]: of a surface's own speed

    def shapes(
        self, prim: str, made: Sequence[Shape], wanted: Sequence[Shape], near: float, source: str
    ) -> Iterator[Finding]:
        """What is wrong with an object's shapes: their number, kinds, sizes, places `near` [m], and surfaces."""
        for has, one in paired(made, wanted):
            if one is None:
                assert has is not None
                found = [self.differs(has.prim, f"is a shape that {source} has not", source, "shape", "remove")]
            elif has is None:
                found = [
                    self.differs(prim, f"lacks the {one.kind} of {listed(one.size)} m of {source}", source, "shape")
                ]
            else:
                found = list(self._shape(has, one, near, source))
            yield from (each.model_copy(update={"prim": prim}) for each in found)  # whose line in the program is known

    def _shape(self, has: Shape, one: Shape, near: float, source: str) -> Iterator[Finding]:
        if has.collides != one.collides:
            says = "collides; that of {} does not" if has.collides else "takes part in no collision; that of {} does"
            yield self.differs(has.prim, says.format(source), source, "collides")
        if any(abs(a - b) > self.share * b for a, b in zip(has.size, one.size, strict=True)):
            yield self.vector(has.prim, "a size", has.size, one.size, self.share * max(one.size), "m", source, "size")
        if math.dist(has.position, one.position) > near:
            yield self.vector(has.prim, "a place", has.position, one.position, near, "m", source, "position")
        if (off := between_deg(has.rotation, one.rotation)) > self.turn:
            yield self.turned(has.prim, "is turned", off, source, "rotation_deg")
        if one.collides:
            if (has.exact, has.convex) != (one.exact, one.convex):
                yield self.differs(has.prim, f"{_collision(has)}; that of {source} {_collision(one)}", source, "shape")
            yield from self.surface(has, one, source)

    def surface(self, has: Shape, one: Shape, source: str) -> Iterator[Finding]:
        """How a surface that touches others differs: its friction, restitution, rolling resistance, and speed."""
        friction = friction_of(one)
        yield from self.number(
            has.prim, "a friction", friction_of(has), friction, self.grip * friction, "1", source, "friction"
        )
        for what, of, limit in (("restitution", restitution_of, self.bounce), ("rolling", rolling_of, self.rolling)):
            yield from self.number(has.prim, f"a {what}", of(has), of(one), limit, "1", source, what)
        if math.dist(has.surface_velocity, one.surface_velocity) > self.belt:
            yield self.vector(has.prim, "a surface velocity", has.surface_velocity, one.surface_velocity, self.belt,
                              "m/s", source, "surface_velocity")  # fmt: skip

    def number(
        self, prim: str, what: str, has: float, wanted: float, limit: float, unit: str, source: str, parameter: str,
        kind: RepairKind = "physical parameter",
    ) -> Iterator[Finding]:  # fmt: skip
        """A number that is further off than `limit`."""
        if abs(has - wanted) > limit:
            target = RepairTarget(kind=kind, prim=prim, parameter=parameter, current=has, suggested=wanted, unit=unit)
            told = "" if unit == "1" else f" {unit}"
            yield self.between(
                f"{prim} has {what} of {has:.4g}{told}; {source} has {wanted:.4g}{told}", has,
                (wanted - limit, wanted + limit), unit, expected=wanted, prim=prim, time=0.0, limit_from=source,
                target=target,
            )  # fmt: skip

    def shared(
        self, prim: str, what: str, has: float, wanted: float, unit: str, source: str, parameter: str,
        kind: RepairKind = "physical parameter",
    ) -> Iterator[Finding]:  # fmt: skip
        """A number that is further off than a share of it."""
        low, high = share_about(abs(wanted), self.share)
        yield from self.number(prim, what, has, wanted, 0.5 * (high - low), unit, source, parameter, kind)

    def vector(
        self, prim: str, what: str, has: Sequence[float], wanted: Sequence[float], limit: float, unit: str, source: str,
        parameter: str, kind: RepairKind = "geometry",
    ) -> Finding:  # fmt: skip
        """Several numbers that are further off than `limit`."""
        target = RepairTarget(
            kind=kind, prim=prim, parameter=parameter, direction="change", vector=tuple(wanted), unit=unit
        )
        off = max(math.dist(has, wanted), limit * (1.0 + 1e-9))
        return self.measured(
            f"{prim} has {what} of {listed(tuple(has))} {unit}; {source} has {listed(tuple(wanted))} {unit}",
            off, limit, unit, expected=0.0, prim=prim, time=0.0, limit_from=source, target=target,
        )  # fmt: skip

    def turned(self, prim: str, says: str, off: float, source: str, parameter: str, limit: float = 0.0) -> Finding:
        """Something that points elsewhere [deg]."""
        return self.measured(
            f"{prim} {says} {off:.3g} degrees off that of {source}", off, limit or self.turn, "deg", expected=0.0,
            prim=prim, time=0.0, limit_from=source,
            target=RepairTarget(kind="geometry", prim=prim, parameter=parameter, direction="change"),
        )  # fmt: skip

    def differs(self, prim: str, says: str, source: str, parameter: str, direction: str = "change") -> Finding:
        """Something that no number tells."""
        target = RepairTarget.model_validate(
            {"kind": "drive" if parameter == "drive" else "geometry", "prim": prim, "parameter": parameter,
             "direction": direction}
        )  # fmt: skip
        return self.failed(f"{prim} {says}", prim=prim, time=0.0, limit_from=source, target=target)


def in_frame(rotation: ArrayLike, vector: ArrayLike) -> Floats:
    """A world's vector in the axes of a body that is turned so."""
    return rotate(conjugate(np.array(rotation)), np.array(vector, dtype=np.float64))
