"""Comprehensions: read round by round where what they go through is known."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from wsim.program.validator import operators
from wsim.program.validator.state import State, assigned
from wsim.program.validator.values import UNKNOWN, Dict, Items, NotKnownError, Scope, Value, each_of, elements, plain

_MOST = 400  # items that are read one by one


def items(reader: State, node: ast.ListComp | ast.SetComp | ast.GeneratorExp, kind: type) -> Value:
    """What a comprehension makes; of a generator, the items that it will give."""
    made: list[Value] = []
    exact = _each(reader, node.generators, lambda: made.append(reader.value(node.elt)))
    if exact:
        return Items(kind, made)
    return Items(kind, [], exact=False, each=made[0] if len(made) == 1 else UNKNOWN)


def pairs(reader: State, node: ast.DictComp) -> Value:
    """What a comprehension of a dictionary makes."""
    pairs: dict[Any, Value] = {}

    def add() -> None:
        key, value = reader.value(node.key), reader.value(node.value)
        pairs[plain(key)] = value

    try:
        return Dict(pairs) if _each(reader, node.generators, add) else Dict({}, exact=False)
    except (NotKnownError, TypeError):
        return Dict({}, exact=False)


def _each(reader: State, generators: list[ast.comprehension], read: Callable[[], None]) -> bool:
    """Read something for each round of a comprehension; False if they are not known, and one stands for all."""
    first = reader.value(generators[0].iter)
    before = reader.scope
    names = frozenset().union(*(assigned([ast.Expr(g.target)]) for g in generators))
    reader.scope = Scope(names, before)
    try:
        return _round(reader, generators, 0, first, read)
    finally:
        reader.scope = before


def _round(
    reader: State, generators: list[ast.comprehension], depth: int, source: Value, read: Callable[[], None]
) -> bool:
    if depth == len(generators):
        read()
        return True
    items = elements(source, _MOST)
    reader.steps -= len(items or ())
    if items is None or reader.steps <= 0:
        each = each_of(source)
        reader.rounds += 1
        with reader.unsure():
            _one(reader, generators, depth, each, read)
        reader.rounds -= 1
        return False
    exact = [_one(reader, generators, depth, item, read) for item in items]
    return all(exact)


def _one(reader: State, generators: list[ast.comprehension], depth: int, item: Value, read: Callable[[], None]) -> bool:
    reader.bind(generators[depth].target, item)
    exact = True
    for test in generators[depth].ifs:
        known = operators.truth(reader.value(test))
        if known is False:
            return exact
        exact = exact and known is True
    if depth + 1 < len(generators):
        source = reader.value(generators[depth + 1].iter)
        return _round(reader, generators, depth + 1, source, read) and exact
    if exact:
        read()
        return True
    with reader.unsure():
        read()
    return False
