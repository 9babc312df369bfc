"""Degrees and radians: what an expression says that it is, by the functions it calls and the names in it."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable

_RADIANS = {"radians", "deg2rad"}
_DEGREES = {"degrees", "rad2deg"}
_ARCS = {"atan2", "atan", "asin", "acos", "arctan2", "arctan", "arcsin", "arccos"}
# A half turn, a whole one, and a radian, in degrees: a product with one of these converts.
_CONVERTS = (180.0, 360.0, 90.0, 57.29577951308232, math.pi / 180.0)
_TURNS = tuple(math.pi * share for share in (0.25, 0.5, 1.0, 2.0))

Lookup = Callable[[str], str]


def said(node: ast.expr, of_name: Lookup) -> str:
    """ "deg" or "rad" where an expression says it outright: by a conversion, or by a name with _deg or _rad at its end.

    Args:
        node: The expression.
        of_name: The unit of what was assigned to a name, or "".
    """
    if isinstance(node, ast.Call):
        short = _short(node.func)
        return "rad" if short in _RADIANS or short in _ARCS else "deg" if short in _DEGREES else ""
    if isinstance(node, (ast.Name, ast.Attribute)):
        short = _short(node).lower()
        if short.endswith(("_deg", "_degrees", "_degree")):
            return "deg"
        if short.endswith(("_rad", "_radians", "_radian")):
            return "rad"
        return of_name(node.id) if isinstance(node, ast.Name) else ""
    if isinstance(node, ast.UnaryOp):
        return said(node.operand, of_name)
    if isinstance(node, ast.BinOp):
        left, right = said(node.left, of_name), said(node.right, of_name)
        if isinstance(node.op, (ast.Add, ast.Sub)):
            return left if left == right or not right else right if not left else ""
        if isinstance(node.op, ast.Mult) and bool(left) != bool(right):
            other = node.right if left else node.left
            return (left or right) if _factor(other) else ""
        if isinstance(node.op, ast.Div) and left and not right:
            return left if _factor(node.right) else ""
    return ""


def of_pi(node: ast.expr) -> bool:
    """Whether an expression is a number times pi: radians, where nothing in it converts."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, float) and any(abs(abs(node.value) - t) < 0.002 * t for t in _TURNS)
    if isinstance(node, ast.UnaryOp):
        return of_pi(node.operand)
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Mult, ast.Div)):
        parts = [each for each in ast.walk(node) if isinstance(each, ast.expr)]
        if any(isinstance(each, ast.Call) for each in parts) or not _multiplied(node):
            return False
        converts = any(isinstance(p, ast.Constant) and _converts(p.value) for p in parts)
        named = any("deg" in _short(p).lower() for p in parts if isinstance(p, (ast.Name, ast.Attribute)))
        return not converts and not named
    return isinstance(node, ast.Attribute) and node.attr in ("pi", "tau")


def _multiplied(node: ast.expr) -> bool:
    """Whether pi is a factor of a product, and no divisor."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return _multiplied(node.left) != _multiplied(node.right)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        return _multiplied(node.left) and not _multiplied(node.right)
    if isinstance(node, ast.UnaryOp):
        return _multiplied(node.operand)
    return isinstance(node, ast.Attribute) and node.attr in ("pi", "tau")


def _factor(node: ast.expr) -> bool:
    """Whether a product with this stays in its unit: a number that does not convert."""
    if isinstance(node, ast.UnaryOp):
        return _factor(node.operand)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, (int, float)) and not _converts(node.value)
    return False


def _converts(value: object) -> bool:
    return isinstance(value, (int, float)) and any(abs(value - each) < 0.01 * each for each in _CONVERTS)


def _short(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
