"""What assets are made of.

Densities and coefficients of friction are the round values of engineering handbooks (air-dry wood, dry clean
surfaces); a coefficient is that of the substance on wood or on itself. Where a part is not solid, such as electronics
in a case, its function says what density it takes.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Substance:
    """density [kg/m^3]; coefficient of friction; restitution, 0 (dead) to 1 (elastic)."""

    density: float
    friction: float
    restitution: float


PINE = Substance(500.0, 0.4, 0.1)
BEECH = Substance(700.0, 0.4, 0.1)
OAK = Substance(700.0, 0.4, 0.1)
PLYWOOD = Substance(600.0, 0.4, 0.1)
FIBREBOARD = Substance(750.0, 0.35, 0.1)
STEEL = Substance(7850.0, 0.4, 0.1)
CAST_IRON = Substance(7200.0, 0.4, 0.1)
ALUMINIUM = Substance(2700.0, 0.35, 0.1)
STONEWARE = Substance(2300.0, 0.45, 0.1)
TERRACOTTA = Substance(1900.0, 0.5, 0.1)
ABS = Substance(1050.0, 0.35, 0.1)
HDPE = Substance(950.0, 0.3, 0.1)
ACRYLIC = Substance(1180.0, 0.4, 0.1)
RUBBER = Substance(1200.0, 0.8, 0.1)
SOIL = Substance(1300.0, 0.6, 0.0)
LEAF = Substance(700.0, 0.5, 0.0)  # fresh, with the air in it
FOAM = Substance(60.0, 0.6, 0.0)  # under cloth
PAPER = Substance(800.0, 0.4, 0.0)
CARDBOARD = Substance(150.0, 0.4, 0.1)  # corrugated
CONCRETE = Substance(2400.0, 0.6, 0.1)
STONE = Substance(2600.0, 0.6, 0.1)
GLASS = Substance(2500.0, 0.35, 0.1)
PORCELAIN = Substance(2400.0, 0.35, 0.1)
BRASS = Substance(8500.0, 0.35, 0.1)
GREENWOOD = Substance(800.0, 0.5, 0.1)  # as it grows
SAND = Substance(1600.0, 0.6, 0.0)
LINEN = Substance(300.0, 0.5, 0.0)  # cloth on a stiff lining


@dataclass(frozen=True)
class Paint:
    """A substance with a look: `color` is linear RGB, `opacity` what it hides; all in 0..1."""

    name: str
    substance: Substance
    color: tuple[float, float, float]
    roughness: float = 0.6
    metallic: float = 0.0
    opacity: float = 1.0
