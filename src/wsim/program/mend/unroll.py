"""Loops written out, so that every object has a call of its own that can be changed."""

from __future__ import annotations

import ast
import copy
from typing import Any

from wsim.program.mend.text import Source, makes

KNOWN = {"enumerate": enumerate, "range": range, "zip": zip}
MOST = 200  # turns: more are no list that a person would write


class _Put(ast.NodeTransformer):
    """Puts values in place of names, and joins the strings that are then whole."""

    def __init__(self, values: dict[str, Any]) -> None:
        self.values = values

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and node.id in self.values:
            return ast.parse(repr(self.values[node.id]), mode="eval").body
        return node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.AST:
        self.generic_visit(node)
        parts = [part.value if isinstance(part, ast.FormattedValue) else part for part in node.values]
        if all(isinstance(part, ast.Constant) for part in parts):
            return ast.Constant("".join(str(part.value) for part in parts if isinstance(part, ast.Constant)))
        return node


def unrolled(program: str, name: str = "") -> str:
    """The program with loops of `build` over written values written out.

    Args:
        program: Its text.
        name: Only the loop that makes this object; without one, all.
    """
    source = Source(program)
    for statement in source.build.body:
        turns = _turns(statement) if isinstance(statement, ast.For) else None
        if turns is None or not isinstance(statement, ast.For):
            continue
        body = [_Put(values).visit(copy.deepcopy(inner)) for values in turns for inner in statement.body]
        if name and name not in map(makes, body):
            continue
        lines = "\n".join(ast.unparse(ast.fix_missing_locations(each)) for each in body)
        source.insert(statement, lines)
        source.remove(statement)
    return source.text


def _turns(loop: ast.For) -> list[dict[str, Any]] | None:
    """The values of the loop's names, turn by turn; None if they are not written out."""
    values = _values(loop.iter)
    if values is None or len(values) > MOST:
        return None
    try:
        return [_bound(loop.target, value) for value in values]
    except (TypeError, ValueError):
        return None


def _values(node: ast.expr) -> list[Any] | None:
    """What a loop goes over, read and not run: lists of literals, and range, zip and enumerate of them."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in KNOWN:
        given = {str(each.arg): _literal(each.value) for each in node.keywords}
        if given.keys() - ({"start"} if node.func.id == "enumerate" else set()) or None in given.values():
            return None
        over = [_literal(each) if node.func.id == "range" else _values(each) for each in node.args]
        if any(each is None for each in over):
            return None
        if node.func.id == "range" and not all(isinstance(each, int) and abs(each) <= MOST for each in over):
            return None
        try:
            return list(KNOWN[node.func.id](*over, **given))
        except (TypeError, ValueError):
            return None
    found = _literal(node)
    return list(found) if isinstance(found, list | tuple) else None


def _literal(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError):
        return None


def _bound(target: ast.expr, value: Any) -> dict[str, Any]:
    if isinstance(target, ast.Name):
        return {target.id: value}
    if not isinstance(target, ast.Tuple):
        raise TypeError("a loop's target is a name or names")
    found: dict[str, Any] = {}
    for part, each in zip(target.elts, value, strict=True):
        found |= _bound(part, each)
    return found
