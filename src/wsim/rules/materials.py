"""The materials and colours of the lexicon, by every word for them, and water."""

from __future__ import annotations

from wsim.defaults import FLUID_DENSITY
from wsim.plan.schema import Material
from wsim.rules.lexicon import lexicon

WATER = Material(name="water", density=FLUID_DENSITY, friction=0.0, color=(0.15, 0.4, 0.6), opacity=0.6)
GLASS_LOOK = Material(name="tank_glass", density=2500.0, friction=0.3, color=(0.75, 0.88, 0.9), opacity=0.25)
GROUND_LOOK = Material(name="ground", density=2000.0, friction=0.7, color=(0.32, 0.32, 0.32))


def material_named(word: str) -> Material:
    """A material by a word of the lexicon."""
    return lexicon().materials[word]
