"""A block that floats with a vehicle on it: how deep it draws, how far it leans, and the basin that it floats in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wsim.defaults import FLUID_DENSITY, GRAVITY, WALL
from wsim.errors import UserError
from wsim.plan.schema import Material, Vec3
from wsim.rules.scenes.part import tidy

if TYPE_CHECKING:
    from wsim.scene.vehicle_spec import VehicleSpec

THINNEST, THICKEST, STEP = 0.4, 2.0, 0.1  # of the block [m]
FREE = 0.2  # of the block that stays above the water with an axle over its end, at least [m]
GAP, OVER, BESIDE = 0.1, 0.3, 0.8  # between block and apron; of that over the water; beside it to the walls [m]
SPACING, LAYERS = 0.1, 1  # of the water [m], and in the block's draft at least
MOST_PARTICLES, TOO_MANY = 24_000, 4  # of which finer water is none, and how many times that is refused
LEVEL, UNDER = 1.0, 0.4  # of the water at least, and under the leaning block [m]
RIM, LEAST_RIM = 0.3, 0.15  # of the walls above the water, usually and at least [m]
APRON = 0.1  # thickness of what of the docks is over the water [m]
BELOW = 0.1  # that the docks are lower than the empty block, which the load takes down [m]
STANDS_BACK = 0.75  # of its length on its dock, behind the vehicle's middle [m]
ADDED_MASS = 1.3  # of what heaves: of its own and the load's mass, what water goes along with a wide block


@dataclass(frozen=True)
class Block:
    """What floats, and the vehicle on it.

    Attributes:
        size: (X, Y, Z) [m].
        material: Its own.
        spec: Of the vehicle.
    """

    size: Vec3
    material: Material
    spec: VehicleSpec

    @property
    def area(self) -> float:
        """Seen from above [m^2]."""
        return self.size[0] * self.size[1]

    @property
    def mass(self) -> float:
        """Without the load [kg]."""
        return self.material.density * self.area * self.size[2]

    @property
    def draft(self) -> float:
        """Without the load [m]."""
        return self.mass / (FLUID_DENSITY * self.area)

    @property
    def loaded(self) -> float:
        """Draft with the load in the middle [m]."""
        return self.draft + self.spec.mass / (FLUID_DENSITY * self.area)

    @property
    def lean(self) -> float:
        """At rest with the rear axle over an end [rad], by the metacentric height; a right angle where that is none."""
        arm, whole = self.size[0] / 2 - self.spec.front_share * self.spec.wheelbase, self.mass + self.spec.mass
        above = self.metacentric(self.size[0])
        return math.atan(self.spec.mass * max(arm, 0.0) / (whole * above)) if above > 0.0 else math.pi / 2

    def metacentric(self, breadth: float) -> float:
        """Height of the metacentre over the centre of mass of both [m], leaning along one of the edges [m]."""
        whole, height = self.mass + self.spec.mass, self.size[2]
        centre = (self.mass * height / 2 + self.spec.mass * (height + self.spec.com_height)) / whole
        return self.loaded / 2 + breadth**2 / (12.0 * self.loaded) - centre

    @property
    def free(self) -> float:
        """How far the end under the axle is above the water then [m]."""
        return self.size[2] - self.loaded - self.size[0] / 2 * math.tan(min(self.lean, 1.5))

    @property
    def period(self) -> float:
        """Of its heave with the load [s]."""
        stiffness = FLUID_DENSITY * GRAVITY * self.area
        return 2.0 * math.pi * math.sqrt((1.0 + ADDED_MASS) * (self.mass + self.spec.mass) / stiffness)


@dataclass(frozen=True)
class Site:
    """The basin, and the docks at its ends; the block's middle is at x = y = 0. All in metres."""

    block: Block
    level: float
    spacing: float
    dock: float  # length of one

    @property
    def inner(self) -> Vec3:
        """The basin's hollow."""
        length, width, height = self.block.size
        rim = max(LEAST_RIM, height - self.block.draft - BELOW - APRON)
        x, y = (edge + 2 * up(room, self.spacing) for edge, room in ((length, GAP + OVER), (width, BESIDE)))
        return tidy(x), tidy(y), tidy(self.level + rim)

    @property
    def edge(self) -> float:
        """Where the docks' aprons end, on both sides."""
        return self.block.size[0] / 2 + GAP

    @property
    def wall(self) -> float:
        """Where the basin's walls end, on both sides."""
        return self.inner[0] / 2 + WALL

    @property
    def top(self) -> float:
        """Of the docks."""
        return tidy(WALL + self.inner[2] + APRON)

    @property
    def bottom(self) -> float:
        """Of the empty block."""
        return WALL + self.level - self.block.draft

    @property
    def stands(self) -> float:
        """How far from the block's middle the vehicle starts and ends."""
        return round(self.wall + self.dock - STANDS_BACK * self.block.spec.length, 1)

    @property
    def sinks(self) -> float:
        """How far the load takes the block down over the basin's floor: what sinks in lifts the water."""
        basin = self.inner[0] * self.inner[1]
        return self.block.spec.mass / FLUID_DENSITY * (1.0 / self.block.area - 1.0 / basin)


def carries(block: Block, words: str, other: Material) -> Block:
    """As thick as is needed to carry the load.

    Args:
        block: Its own thickness does not matter.
        words: The prompt's for it.
        other: The material that is taken if its own carries nothing.

    Raises:
        UserError: None does.
    """
    (length, width, _), steps = block.size, round((THICKEST - THINNEST) / STEP)
    for material in (block.material, other):
        for k in range(steps + 1):
            found = Block((length, width, round(THINNEST + k * STEP, 3)), material, block.spec)
            free = found.free >= FREE and found.size[2] - found.draft >= RIM + BELOW + APRON - 1e-9
            if free and found.metacentric(width) > 0.0 and found.draft >= LAYERS * SPACING - 1e-9:
                return found
    raise UserError(
        f"{words!r}: no block of {block.material.density:g} kg/m^3, {length:g} x {width:g} m, that is up to "
        f"{THICKEST:g} m thick carries {block.spec.mass:g} kg; give a lower density, or none"
    )


def site_of(block: Block, words: str, sized: bool) -> Site:
    """The basin, in which particles fill what the block leaves: all of its edges are whole spacings.

    Else the water would stand higher or lower than is said, by up to half a layer under the block.

    Args:
        block: In the basin's middle.
        words: The prompt's for it.
        sized: Whether the prompt gives its length and width.

    Raises:
        UserError: It is too large.
    """
    down = block.loaded + block.size[0] / 2 * math.tan(min(block.lean, 0.3))
    level = max(LEVEL, math.ceil(10.0 * (min(down, block.size[2]) + UNDER)) / 10.0)
    volume = (block.size[0] + 2 * (GAP + OVER)) * (block.size[1] + 2 * BESIDE) * level - block.area * block.draft
    usual = max(SPACING, (volume / MOST_PARTICLES) ** (1 / 3))
    spacing = block.draft / max(LAYERS, round(block.draft / usual))
    if volume > TOO_MANY * MOST_PARTICLES * spacing**3:
        raise UserError(f"{words!r}: {volume / spacing**3:.0f} particles would be around it; give a smaller one")
    if not sized:
        length, width = (tidy(up(edge, spacing)) for edge in block.size[:2])
        block = replace(block, size=(length, width, block.size[2]))
    return Site(block, tidy(up(level, spacing)), tidy(spacing), round(block.spec.length + 1.5, 1))


def up(length: float, spacing: float) -> float:
    """A length of whole spacings, no shorter [m]."""
    return math.ceil(round(length / spacing, 6)) * spacing
