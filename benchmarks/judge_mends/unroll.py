"""A program's loops written out, so that every object has a call of its own that can be changed."""

from __future__ import annotations

import ast
import copy
from typing import Any


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


def unrolled(program: str) -> str:
    """The program with the `for` statements of `build` that go over written values written out."""
    tree = ast.parse(program)
    build = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "build")
    body: list[ast.stmt] = []
    for statement in build.body:
        turns = _turns(statement) if isinstance(statement, ast.For) else None
        if turns is None or not isinstance(statement, ast.For):
            body.append(statement)
            continue
        for values in turns:
            body += [_Put(values).visit(copy.deepcopy(inner)) for inner in statement.body]
    build.body = body
    return ast.unparse(ast.fix_missing_locations(tree)) + "\n"


def _turns(loop: ast.For) -> list[dict[str, Any]] | None:
    """The values of the loop's names, turn by turn; None if they are not written out."""
    try:
        over = eval(compile(ast.Expression(loop.iter), "loop", "eval"), {"__builtins__": {"enumerate": enumerate,
                    "range": range, "zip": zip}})  # fmt: skip
        return [_bound(loop.target, value) for value in over]
    except (NameError, TypeError, ValueError):
        return None


def _bound(target: ast.expr, value: Any) -> dict[str, Any]:
    if isinstance(target, ast.Name):
        return {target.id: value}
    assert isinstance(target, ast.Tuple)
    found: dict[str, Any] = {}
    for part, each in zip(target.elts, value, strict=True):
        found |= _bound(part, each)
    return found
