"""Curves and patches: their vertices, orders and knots must fit one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Usd, UsdGeom

from wsim.scene.check_arrays import as_many, integers, sizes


def curves_problems(curves: UsdGeom.Curves) -> Iterator[str]:
    """Problems of curves."""
    counts = curves.GetCurveVertexCountsAttr()
    yield from sizes(counts, 2, len(curves.GetPointsAttr().Get() or ()), "points")
    if curves.GetPrim().IsA(UsdGeom.NurbsCurves):
        nurbs = UsdGeom.NurbsCurves(curves)
        yield from _splines(counts, nurbs.GetOrderAttr(), nurbs.GetKnotsAttr(), nurbs.GetRangesAttr())


def patch_problems(patch: UsdGeom.NurbsPatch) -> Iterator[str]:
    """Problems of a patch and of the curves that trim it."""
    across, along = (attribute.Get() or 0 for attribute in (patch.GetUVertexCountAttr(), patch.GetVVertexCountAttr()))
    points = len(patch.GetPointsAttr().Get() or ())
    if min(across, along) < 0 or across * along != points:
        yield f"{patch.GetUVertexCountAttr().GetPath()}: {across} by {along} vertices; there are {points} points"
        return
    if points:
        yield from _direction(patch.GetUOrderAttr(), patch.GetUKnotsAttr(), across)
        yield from _direction(patch.GetVOrderAttr(), patch.GetVKnotsAttr(), along)
    yield from _trims(patch)


def _direction(order: Usd.Attribute, knots: Usd.Attribute, vertices: int) -> Iterator[str]:
    """Order and knots of a patch in one of its directions."""
    number = order.Get() or 0
    if not 2 <= number <= vertices:
        yield f"{order.GetPath()}: {number} must be 2 to {vertices}; there are {vertices} vertices"
    else:
        yield from _total(knots, vertices + number, "vertices and order")


def _trims(patch: UsdGeom.NurbsPatch) -> Iterator[str]:
    vertices = patch.GetTrimCurveVertexCountsAttr()
    curves = len(vertices.Get() or ())
    yield from sizes(patch.GetTrimCurveCountsAttr(), 1, curves, "trimCurve:vertexCounts")
    yield from sizes(vertices, 2, len(patch.GetTrimCurvePointsAttr().Get() or ()), "trimCurve:points")
    orders, knots, ranges = (
        patch.GetTrimCurveOrdersAttr(),
        patch.GetTrimCurveKnotsAttr(),
        patch.GetTrimCurveRangesAttr(),
    )
    yield from _splines(vertices, orders, knots, ranges)


def _splines(
    counts: Usd.Attribute, orders: Usd.Attribute, knots: Usd.Attribute, ranges: Usd.Attribute
) -> Iterator[str]:
    """Orders, knots and ranges of curves with so many vertices each."""
    vertices, order = integers(counts), integers(orders)
    if isinstance(vertices, str):
        return  # told where the vertices are counted
    if isinstance(order, str):
        yield order
        return
    if len(order) != len(vertices):
        yield f"{orders.GetPath()}: {len(order)} values; there are {len(vertices)} curves"
        return
    bad = np.flatnonzero((order < 2) | (order > vertices))
    if bad.size:
        most = vertices[bad[0]]
        yield f"{orders.GetPath()}: [{bad[0]}] = {order[bad[0]]} must be 2 to {most}; the curve has {most} vertices"
    else:
        yield from _total(knots, int((vertices + order).sum()), "vertices and orders")
    yield from as_many(ranges, len(vertices), "curves")


def _total(knots: Usd.Attribute, total: int, what: str) -> Iterator[str]:
    given = len(knots.Get() or ())
    if given != total:
        yield f"{knots.GetPath()}: {given} values; {what} ask for {total}"
