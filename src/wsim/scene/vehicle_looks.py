"""What a vehicle's body is made of: boxes that leave its wheels room, and by its looks a bonnet, a cab, a load.

Lengths count from the point of the ground between the axles. What is `trim` shows and does not collide.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from wsim.scene.compounds import Part
from wsim.scene.vehicle_spec import LARGEST_STEER, VehicleSpec

_GLASS, _DARK = (0.05, 0.07, 0.09), (0.04, 0.04, 0.045)
_LAMP, _TAIL_LAMP, _STEEL = (0.95, 0.92, 0.75), (0.6, 0.02, 0.02), (0.45, 0.46, 0.48)
_GAP = 0.03  # [m], between a wheel and what is around it
_DECK = 0.05  # [m], thickness of what is over the wheels
_SKIN = 0.012  # [m], by which trim stands out of what it is on


@dataclass(frozen=True)
class Piece:
    """A part of the body, and whether it is trim."""

    part: Part
    trim: bool = False


def body_pieces(spec: VehicleSpec) -> list[Piece]:
    """All that a vehicle's body is made of."""
    body = _Body(spec)
    return [*body.lower(), *getattr(body, spec.looks)(), *body.lamps()]


def wheel_pieces(spec: VehicleSpec) -> list[Piece]:
    """A tyre, which rolls; a rim and its nuts, by which one sees it turn."""
    r, w = spec.wheel_radius, spec.wheel_width
    pieces = [Piece(Part("cylinder", radius=r, height=w, axis="Y", color=_DARK))]
    pieces.append(Piece(Part("cylinder", radius=0.6 * r, height=w + _SKIN, axis="Y", color=_STEEL), True))
    for k in range(5):
        angle = 2.0 * math.pi * k / 5
        place = (0.36 * r * math.cos(angle), 0.0, 0.36 * r * math.sin(angle))
        nut = Part("cylinder", radius=0.12 * r, height=w + 2 * _SKIN, axis="Y", position=place, color=_DARK)
        pieces.append(Piece(nut, True))
    return pieces


class _Body:
    """Makes the pieces of one body; (x, y, z) are its forward, left and up."""

    def __init__(self, spec: VehicleSpec) -> None:
        self.spec = spec
        self.front, self.back = 0.5 * spec.length, -0.5 * spec.length
        self.deck = 2.0 * spec.wheel_radius + spec.travel_up + _GAP  # of its underside
        self.floor = spec.clearance
        self.half = 0.5 * spec.width

    def box(
        self, x: tuple[float, float], z: tuple[float, float], half: float, color: tuple[float, ...] | None = None,
        *, trim: bool = False, y: float = 0.0, lean: float = 0.0,
    ) -> Piece:  # fmt: skip
        """A box from x[0] to x[1] and z[0] to z[1], `half` a width to each side of y [m], leaning back [deg]."""
        size = (x[1] - x[0], 2.0 * half, z[1] - z[0])
        place = (0.5 * (x[0] + x[1]), y, 0.5 * (z[0] + z[1]))
        part = Part("box", size=size, position=place, rotation_deg=(0.0, -lean, 0.0), color=color or self.spec.color)
        return Piece(part, trim)

    def lower(self) -> Iterator[Piece]:
        """A tub between the wheels, sills between the axles, a nose, a tail, and a deck over all."""
        spec, turn = self.spec, math.radians(LARGEST_STEER)
        reach = spec.wheel_radius * math.sin(turn) + 0.5 * spec.wheel_width * math.cos(turn)
        inner = max(0.5 * spec.track - reach - _GAP, 0.2 * spec.track)
        clear = spec.wheel_radius + 0.5 * spec.wheel_width * math.sin(turn) + _GAP
        axle, top = 0.5 * spec.wheelbase, self.deck
        yield self.box((self.back + 0.03, self.front - 0.03), (self.floor, top - 0.01), inner, _DARK)
        yield self.box((clear - axle, axle - clear), (self.floor, top), self.half)
        for ends in ((axle + clear, self.front), (self.back, -axle - clear)):
            if ends[1] - ends[0] > 0.02:
                yield self.box(ends, (self.floor + 0.25 * (top - self.floor), top), self.half)
        yield self.box((self.back, self.front), (top, top + _DECK), self.half)

    def lamps(self) -> Iterator[Piece]:
        """Two in front, two behind, and bumpers under them."""
        z = self.deck - 0.10
        for side in (-1.0, 1.0):
            y = side * 0.72 * self.half
            yield self.box((self.front - 0.04, self.front + _SKIN), (z, z + 0.11), 0.09, _LAMP, trim=True, y=y)
            yield self.box((self.back - _SKIN, self.back + 0.04), (z, z + 0.09), 0.07, _TAIL_LAMP, trim=True, y=y)
        for x in ((self.front - 0.02, self.front + 0.06), (self.back - 0.06, self.back + 0.02)):
            yield self.box(x, (z - 0.22, z - 0.10), 0.95 * self.half, _DARK, trim=True)

    def cab(self, x: tuple[float, float], half: float, top: float, rake: float = 25.0) -> Iterator[Piece]:
        """A cab from the deck to `top`, with glass in front, behind and at its sides, and a wind screen that leans."""
        low, tall = self.deck + _DECK, top - self.deck - _DECK
        slant = tall * math.tan(math.radians(rake))
        yield self.box((x[0], x[1] - slant), (low, top), half)
        length = tall / math.cos(math.radians(rake))
        middle = 0.5 * (low + top)
        for width, color, thick, back in ((half, self.spec.color, 0.06, 0.03), (0.92 * half, _GLASS, 0.06, 0.0)):
            screen = (x[1] - 0.5 * slant - back - 0.5 * thick, x[1] - 0.5 * slant - back + 0.5 * thick)
            span = (middle - 0.5 * length, middle + 0.5 * length) if color != _GLASS else (
                middle - 0.40 * length, middle + 0.40 * length)  # fmt: skip
            yield self.box(screen, span, width, color, trim=True, lean=rake)
        steps = 8 if slant > 0.1 else 0  # cheeks between the screen and the cab
        for k in range(steps):
            cheek = (x[1] - slant - 0.01, x[1] - slant * (k + 1) / steps - 0.04)
            if cheek[1] > cheek[0]:
                rise = (low + tall * k / steps, low + tall * (k + 1) / steps)
                yield self.box(cheek, rise, 0.985 * half, _GLASS, trim=True)
        window = (low + 0.38 * tall, top - 0.12 * tall)
        back, ahead = x[0] + 0.08, x[1] - slant - 0.04
        pillar = 0.5 * (back + ahead)
        for pane in ((back, pillar - 0.04), (pillar + 0.04, ahead)):
            yield self.box(pane, window, half + _SKIN, _GLASS, trim=True)
        yield self.box((x[0] - _SKIN, x[0] + 0.02), window, 0.85 * half, _GLASS, trim=True)

    def offroad(self) -> Iterator[Piece]:
        """A flat bonnet, an upright cab, a low load bed with a cover."""
        low, tall = self.deck + _DECK, self.spec.height - self.deck - _DECK
        nose = self.front - 0.30 * self.spec.length
        yield self.box((nose - 0.15, self.front - 0.06), (low, low + 0.16 * tall), 0.80 * self.half)
        for k in range(4):
            x = self.front - 0.35 - 0.16 * k
            yield self.box((x, x + 0.07), (low + 0.16 * tall, low + 0.16 * tall + _SKIN), 0.4 * self.half, _DARK,
                           trim=True)  # fmt: skip
        back = self.back + 0.24 * self.spec.length
        yield from self.cab((back, nose), 0.92 * self.half, self.spec.height, 18.0)
        yield self.box((self.back + 0.05, back - 0.02), (low, low + 0.45 * tall), 0.92 * self.half)

    def buggy(self) -> Iterator[Piece]:
        """A sloping nose, seats, and a cage of bars with a roof."""
        low, top = self.deck + _DECK, self.spec.height
        nose = self.front - 0.24 * self.spec.length
        back = self.back + 0.22 * self.spec.length
        yield self.box((nose, self.front - 0.15), (low, low + 0.10), 0.75 * self.half)
        yield self.box((nose - 0.12, nose), (low, low + 0.22), 0.85 * self.half, _DARK)
        for x in (back + 0.35, nose - 0.75):
            for y in (-0.40 * self.half, 0.40 * self.half):
                yield self.box((x - 0.22, x + 0.22), (low, low + 0.14), 0.28 * self.half, _DARK, y=y)
                yield self.box((x - 0.30, x - 0.20), (low, low + 0.60), 0.28 * self.half, _DARK, trim=True, y=y)
        for x in (back, 0.5 * (back + nose) - 0.1, nose - 0.30):
            for y in (-0.9 * self.half, 0.9 * self.half):
                yield self.box((x - 0.025, x + 0.025), (low, top - 0.04), 0.025, _DARK, trim=True, y=y)
        yield self.box((back - 0.05, nose - 0.25), (top - 0.05, top), 0.92 * self.half)
        yield self.box((self.back + 0.04, back - 0.1), (low, low + 0.16), 0.85 * self.half)

    def car(self) -> Iterator[Piece]:
        """A bonnet, and a glazed cab with a sloping screen."""
        low, tall = self.deck + _DECK, self.spec.height - self.deck - _DECK
        nose = self.front - 0.27 * self.spec.length
        yield self.box((nose - 0.25, self.front - 0.12), (low, low + 0.14 * tall), 0.86 * self.half)
        yield from self.cab((self.back + 0.10 * self.spec.length, nose), 0.86 * self.half, self.spec.height, 42.0)

    def truck(self) -> Iterator[Piece]:
        """A cab over the front axle, and a box body behind."""
        low, split = self.deck + _DECK, self.front - 0.27 * self.spec.length
        yield from self.cab((split, self.front), 0.94 * self.half, self.spec.height - 0.35, 6.0)
        yield self.box((self.back + 0.02, split - 0.12), (low, self.spec.height), self.half, (0.82, 0.82, 0.80))
        rib = (self.spec.height - low) / 3.0
        for k in (1, 2):
            z = low + k * rib
            yield self.box((self.back + 0.02, split - 0.12), (z, z + 0.04), self.half + _SKIN, _STEEL, trim=True)

    def cart(self) -> Iterator[Piece]:
        """A short nose, a bench, and a roof on four posts."""
        low, top = self.deck + _DECK, self.spec.height
        yield self.box((self.front - 0.45, self.front - 0.04), (low, low + 0.22), 0.85 * self.half)
        yield self.box((self.front - 0.47, self.front - 0.44), (low, low + 0.50), 0.80 * self.half, _GLASS, trim=True)
        seat = -0.15
        yield self.box((seat - 0.25, seat + 0.25), (low, low + 0.22), 0.80 * self.half, _DARK)
        yield self.box((seat - 0.34, seat - 0.24), (low, low + 0.62), 0.80 * self.half, _DARK, trim=True)
        for x in (self.front - 0.45, self.back + 0.15):
            for y in (-0.85 * self.half, 0.85 * self.half):
                yield self.box((x - 0.02, x + 0.02), (low, top - 0.04), 0.02, _STEEL, trim=True, y=y)
        yield self.box((self.back + 0.05, self.front - 0.35), (top - 0.05, top), 0.95 * self.half)
        yield self.box((self.back + 0.04, seat - 0.45), (low, low + 0.18), 0.80 * self.half)
