"""Taps and drains of a stage, read back, and held against what the simulator needs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

from pxr import Gf, Usd

from wsim.limits import MAX_DURATION, MAX_SIZE, MAX_SPEED
from wsim.scene import schema
from wsim.scene.mouths import blocked_by, told
from wsim.scene.openings import MAX_FLOW
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.usd_shapes import to_vec3
from wsim.scene.usd_values import duration_of, line_of, targets_of, value_of
from wsim.scene.world_openings import Drain, Tap

_DOWN = Gf.Vec3d(0.0, 0.0, -1.0)


def read_taps(prims: Iterable[Usd.Prim]) -> Iterator[Tap]:
    """The taps among a stage's prims, which was checked."""
    for prim in prims:
        if schema.has(prim, schema.TAP):
            yield Tap(
                **_mouth(prim),
                rate=value_of(prim, "rate", 0.0),
                start=value_of(prim, "start", 0.0),
                stop=value_of(prim, "stop", None),
                drop_speed=value_of(prim, "dropSpeed", 0.0),
            )


def read_drains(prims: Iterable[Usd.Prim]) -> Iterator[Drain]:
    """The drains among a stage's prims, which was checked."""
    for prim in prims:
        if schema.has(prim, schema.DRAIN):
            yield Drain(**_mouth(prim), falls=value_of(prim, "falls", True))


def _mouth(prim: Usd.Prim) -> dict[str, Any]:
    return {
        "prim": str(prim.GetPath()),
        "fluid": str(targets_of(prim, "fluid")[0].GetPath()),
        "position": to_vec3(rigid_frame(prim).ExtractTranslation()),
        "direction": to_vec3(value_of(prim, "direction", _DOWN).GetNormalized()),
        "radius": value_of(prim, "radius", 0.0),
        "size": tuple(value_of(prim, "size", Gf.Vec2d(0.0))),
        "line": line_of(prim),
    }


def opening_problems(prims: Iterable[Usd.Prim], solids: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the taps and drains among a stage's prims: of those that are read.

    Args:
        prims: With wsim's schemas.
        solids: What a tap may lie in.
    """
    prims = list(prims)
    fluids = [prim for prim in prims if schema.has(prim, schema.FLUID)]
    poured = set()
    for prim in prims:
        taps, drains = schema.has(prim, schema.TAP), schema.has(prim, schema.DRAIN)
        if not taps and not drains:
            continue
        path, fluid = prim.GetPath(), targets_of(prim, "fluid")
        if len(fluid) != 1 or not schema.has(fluid[0], schema.FLUID):
            yield f"{path}: its wsim:fluid must be one prim with {schema.FLUID}"
        elif taps:
            poured.add(fluid[0].GetPath())
            if len(fluids) > 1:
                yield f"{path}: a tap is for a world with one fluid; this one has {len(fluids)}"
        wrong = list(_mouth_problems(prim))
        if taps:
            wrong += _tap_problems(prim)
        if taps and not wrong and len(fluid) == 1:
            wrong += _pour_problems(prim, fluid[0], solids)
        yield from wrong
    for prim in fluids:
        size = value_of(prim, "size", None)
        if size is not None and math.prod(size) == 0.0 and prim.GetPath() not in poured:
            yield f"{prim.GetPath()}.wsim:size: {tuple(size)} m holds nothing, and no tap pours it"


def _mouth_problems(prim: Usd.Prim) -> Iterator[str]:
    path, radius = prim.GetPath(), value_of(prim, "radius", 0.0)
    sides = tuple(value_of(prim, "size", Gf.Vec2d(0.0)))
    if not (0.0 <= radius <= MAX_SIZE and all(0.0 <= side <= MAX_SIZE for side in sides)):
        yield f"{path}: wsim:radius = {radius:g} and wsim:size = {sides} must be within 0..{MAX_SIZE:g} m"
    elif (radius > 0.0) == (min(sides) > 0.0):
        yield f"{path}: wsim:radius = {radius:g} and wsim:size = {sides} m; one of them must be more than 0"
    way = value_of(prim, "direction", _DOWN)
    if not 1e-9 < way.GetLength() < math.inf:
        yield f"{path}.wsim:direction: {tuple(way)} must not be zero"


def _tap_problems(prim: Usd.Prim) -> Iterator[str]:
    path = prim.GetPath()
    for name, high, unit in (
        ("rate", MAX_FLOW, "m^3/s"),
        ("dropSpeed", MAX_SPEED, "m/s"),
        ("start", MAX_DURATION, "s"),
    ):
        value = value_of(prim, name, 0.0)
        if not 0.0 <= value <= high:
            yield f"{path}.wsim:{name}: {value:g} must be within 0..{high:g} {unit}"
    start, stop = value_of(prim, "start", 0.0), value_of(prim, "stop", None)
    if stop is not None and not start < stop <= MAX_DURATION:
        yield f"{path}.wsim:stop: {stop:g} must be after wsim:start, {start:g}, and <= {MAX_DURATION:g} s"


def _pour_problems(prim: Usd.Prim, fluid: Usd.Prim, solids: Iterable[Usd.Prim]) -> Iterator[str]:
    """Of a tap that is sound by itself: that it pours nothing, where it is and as long as the run is."""
    spacing = float(value_of(fluid, "spacing", 0.0))
    blocked = blocked_by(prim, spacing, solids)
    if blocked:
        yield f"{prim.GetPath()}: its position {told(prim, *blocked)}"
    (tap,), duration = read_taps([prim]), duration_of(prim.GetStage())
    poured, first = tap.poured(duration), tap.first(spacing)
    if 0.0 < poured < first:
        open_for = poured / tap.rate
        yield (
            f"{prim.GetPath()}.wsim:rate: {tap.rate:g} m^3/s for {open_for:.3g} s of the run's {duration:g} s is "
            f"{poured:.3g} m^3, and its first particles come with {first:.3g} m^3, half a layer over its mouth; take "
            f"a rate > {first / open_for:.3g} m^3/s, a longer run (scene.simulation), or a smaller mouth or spacing"
        )
