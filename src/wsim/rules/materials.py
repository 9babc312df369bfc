"""The materials and colours of the lexicon, by every word for them."""

from __future__ import annotations

from wsim.plan.schema import Material
from wsim.rules.lexicon import lexicon

GLASS_LOOK = Material(name="tank_glass", density=2500.0, friction=0.3, color=(0.75, 0.88, 0.9), opacity=0.25)
GROUND_LOOK = Material(name="ground", density=2000.0, friction=0.7, color=(0.32, 0.32, 0.32))


def material_named(word: str) -> Material:
    """A material by a word of the lexicon."""
    return lexicon().materials[word]
