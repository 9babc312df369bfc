"""The materials that the builtin planner knows, by every word for them.

Densities are handbook values at room temperature (CRC Handbook of Chemistry and Physics; woods:
USDA Wood Handbook, air-dry). Frictions are those of the material on itself or on a dry floor, rounded; colours are
linear RGB.
"""

from __future__ import annotations

from wsim.plan.schema import Material, Vec3

WATER_DENSITY = 1000.0  # [kg/m^3]

_MATERIALS: tuple[tuple[Material, tuple[str, ...]], ...] = (
    (Material(name="wood", density=600, friction=0.4, restitution=0.1, color=(0.50, 0.27, 0.11)), ("wood", "wooden")),
    (Material(name="pine", density=500, friction=0.4, restitution=0.1, color=(0.65, 0.42, 0.19)), ("pine",)),
    (Material(name="oak", density=720, friction=0.4, restitution=0.1, color=(0.38, 0.20, 0.08)), ("oak",)),
    (Material(name="cork", density=240, friction=0.5, restitution=0.2, color=(0.60, 0.38, 0.20)), ("cork",)),
    (Material(name="ice", density=917, friction=0.05, color=(0.65, 0.82, 0.92), opacity=0.6), ("ice",)),
    (Material(name="plastic", density=950, friction=0.3, restitution=0.2, color=(0.80, 0.16, 0.10)), ("plastic",)),
    (Material(name="rubber", density=1100, friction=0.9, restitution=0.6, color=(0.04, 0.04, 0.04)), ("rubber",)),
    (Material(name="steel", density=7850, friction=0.4, restitution=0.2, color=(0.45, 0.47, 0.50)), ("steel", "metal")),
    (Material(name="iron", density=7870, friction=0.4, restitution=0.2, color=(0.28, 0.28, 0.30)), ("iron",)),
    (
        Material(name="aluminium", density=2700, friction=0.4, restitution=0.2, color=(0.65, 0.67, 0.70)),
        ("aluminium", "aluminum"),
    ),
    (Material(name="copper", density=8960, friction=0.4, restitution=0.2, color=(0.60, 0.25, 0.12)), ("copper",)),
    (Material(name="gold", density=19300, friction=0.4, restitution=0.1, color=(0.80, 0.56, 0.12)), ("gold", "golden")),
    (Material(name="lead", density=11340, friction=0.4, restitution=0.05, color=(0.18, 0.19, 0.22)), ("lead",)),
    (Material(name="concrete", density=2400, friction=0.7, restitution=0.1, color=(0.45, 0.44, 0.42)), ("concrete",)),
    (Material(name="stone", density=2600, friction=0.6, restitution=0.1, color=(0.35, 0.34, 0.32)), ("stone",)),
    (
        Material(name="glass", density=2500, friction=0.3, restitution=0.1, color=(0.75, 0.88, 0.90), opacity=0.3),
        ("glass",),
    ),
)
MATERIALS: dict[str, Material] = {word: material for material, words in _MATERIALS for word in words}

COLORS: dict[str, Vec3] = {
    "red": (0.70, 0.04, 0.03),
    "green": (0.06, 0.42, 0.08),
    "blue": (0.04, 0.14, 0.65),
    "yellow": (0.85, 0.62, 0.03),
    "orange": (0.85, 0.26, 0.02),
    "purple": (0.28, 0.05, 0.45),
    "pink": (0.85, 0.30, 0.42),
    "brown": (0.24, 0.10, 0.03),
    "white": (0.85, 0.85, 0.85),
    "black": (0.02, 0.02, 0.02),
    "grey": (0.30, 0.30, 0.30),
    "gray": (0.30, 0.30, 0.30),
}
