"""A program without what only served its review."""

from __future__ import annotations

import ast
from collections import Counter

REVIEW = "review_"  # how cameras and lights are called that only served the review
_LOOKING = ("camera", "light")


def bare(program: str) -> str:
    """A program without its prints, and without cameras and lights named review_...; the text itself if it has none."""
    tree = ast.parse(program)
    used = Counter(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
    lines = program.encode().splitlines(keepends=True)  # ast counts columns in bytes
    blocks = [block for parent in ast.walk(tree) for block in _blocks(parent)]
    going = [(node, block) for block in blocks for node in block if _serves_review(node, used)]
    for node, block in sorted(going, key=lambda pair: (pair[0].lineno, pair[0].col_offset), reverse=True):
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        alone = not before.strip() and after.strip()[:1] in (b"", b"#")
        if alone and any(not _serves_review(other, used) for other in block):
            lines[first : last + 1] = []
        else:
            lines[first : last + 1] = [before + b"pass" + after]
    return b"".join(lines).decode()


def _blocks(parent: ast.AST) -> list[list[ast.stmt]]:
    found = [getattr(parent, field, None) for field in ("body", "orelse", "finalbody")]
    return [block for block in found if isinstance(block, list)]


def _serves_review(node: ast.stmt, used: Counter[str]) -> bool:
    call = node.value if isinstance(node, ast.Expr | ast.Assign) else None
    if not isinstance(call, ast.Call):
        return False
    if isinstance(node, ast.Expr) and isinstance(call.func, ast.Name) and call.func.id == "print":
        return True
    if isinstance(node, ast.Assign) and not all(isinstance(to, ast.Name) and used[to.id] == 1 for to in node.targets):
        return False  # what it is kept in is used
    named = [*call.args[:1], *(word.value for word in call.keywords if word.arg == "name")]
    return (
        isinstance(call.func, ast.Attribute)
        and call.func.attr in _LOOKING
        and any(isinstance(name, ast.Constant) and str(name.value).startswith(REVIEW) for name in named)
    )
