"""What makes taps and drains wrong in a plan. Each problem names its path, and what would fix it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.limits import MAX_DURATION

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft


def opening_problems(plan: Draft) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    fluids = [item.name for item in plan.objects if item.primitive == "fluid"]
    for i, opening in enumerate(plan.openings):
        where = f"openings.{i}"
        if opening.fluid not in fluids:
            yield f"{where}.fluid: {opening.fluid!r} is no fluid of the plan; it has {', '.join(fluids) or 'none'}"
        elif opening.kind == "tap" and len(fluids) > 1:
            yield f"{where}: a tap is for a world with one fluid; this plan has {', '.join(fluids)}"
        if opening.at is not None and opening.at not in items:
            yield f"{where}.at: no object {opening.at!r}; the plan has {', '.join(list(items)[:12])}"
        elif opening.at is not None and items[opening.at].primitive in ("fluid", "ground", "terrain", "scatter"):
            yield f"{where}.at: {opening.at} has no rim, top or floor of its own; leave it out and give the place"
        for field in ("start", "stop"):
            if (getattr(opening, field) or 0.0) > MAX_DURATION:
                yield f"{where}.{field}: {getattr(opening, field):g} must be <= {MAX_DURATION:g} s"
    poured = {opening.fluid for opening in plan.openings if opening.kind == "tap"}
    for i, item in enumerate(plan.objects):
        level = item.relation("FREE-SURFACE-AT")
        if item.primitive == "fluid" and level is not None and level.value == 0.0 and item.name not in poured:
            yield f"objects.{i}: {item.name} stands 0 m high and no tap pours it; raise its level, or add to openings"
