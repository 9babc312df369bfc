"""Fluids of a stage, held against what the simulator needs of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from pxr import Gf, Usd

from wsim.limits import LEAST_ACROSS
from wsim.scene import schema
from wsim.scene.usd_values import value_of

_ROUNDED = 1e-6  # of a length: a stage holds single precision


def fluid_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the fluids among a stage's prims: of how fine their particles are."""
    prims = list(prims)
    for fluid in (prim for prim in prims if schema.has(prim, schema.FLUID)):
        spacing = float(value_of(fluid, "spacing", 0.0))
        for tank in (prim for prim in prims if schema.has(prim, schema.CONTAINER)):
            size = [float(length) for length in value_of(tank, "innerSize", Gf.Vec3f(0.0))]
            if min(size) < LEAST_ACROSS * spacing * (1.0 - _ROUNDED):
                yield (
                    f"{fluid.GetPath()}.wsim:spacing: {spacing:g} m is too coarse for {tank.GetPath()}, whose least "
                    f"inner edge is {min(size):g} m: it must hold {LEAST_ACROSS} particles; take spacing <= "
                    f"{min(size) / LEAST_ACROSS:.3g} m, or a larger tank"
                )
