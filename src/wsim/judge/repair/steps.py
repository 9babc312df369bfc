"""Values along the way that a suggestion points: what a search without a model tries beside the suggestion itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.judge.verdict import RepairTarget

# Of the suggested change: less of it where it overshoots, more where physics beyond its formula takes a part.
SHARES = (0.5, 1.5, 2.0, 0.25, 3.0)
# Of the present value, where only the direction is said.
FACTORS = (1.25, 1.6, 2.0, 1.1, 3.0)


def steps(target: RepairTarget) -> list[RepairTarget]:
    """Suggestions in the same direction with other values, the first to be tried in front; none for what is no number.

    Args:
        target: A suggestion.
    """
    now, wanted = target.current, target.suggested
    if now is None or target.vector is not None or target.text or not target.parameter:
        return []
    if wanted is not None:
        values = [now + share * (wanted - now) for share in SHARES]
        values = [value for value in values if value * wanted > 0.0 or wanted == 0.0]  # none beyond zero
    elif target.direction in ("raise", "lower") and now != 0.0:
        values = [now * factor if target.direction == "raise" else now / factor for factor in FACTORS]
    else:
        values = []
    return [target.model_copy(update={"suggested": float(f"{value:.6g}")}) for value in values]
