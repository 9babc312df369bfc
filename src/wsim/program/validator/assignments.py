"""Assignments: of names, of parts of a value, of attributes."""

from __future__ import annotations

import ast

from wsim.program.validator import argument_units, attributes, objects, operators, units
from wsim.program.validator.state import State
from wsim.program.validator.values import (
    UNKNOWN,
    Const,
    Dict,
    Items,
    NotKnownError,
    Object,
    Value,
    blur,
    each_of,
    elements,
    plain,
)


def assign(reader: State, node: ast.Assign) -> None:
    """`name = value`."""
    value = reader.value(node.value)
    told = units.said(node.value, reader.unit_of)
    for target in node.targets:
        argument_units.check_target(reader, target, node.value, told)
        reader.bind(target, value)
        if isinstance(target, ast.Name):
            reader.scope.units[target.id] = told


def annotated(reader: State, node: ast.AnnAssign) -> None:
    """`name: kind = value`."""
    if node.value is not None:
        reader.bind(node.target, reader.value(node.value))


def augmented(reader: State, node: ast.AugAssign) -> None:
    """`name += value`."""
    right = reader.value(node.value)
    if isinstance(node.target, ast.Name):
        left = reader.value(ast.copy_location(ast.Name(node.target.id, ast.Load()), node.target))
        if isinstance(left, Items) and left.kind is list:
            more = elements(right)
            if reader.certain and left.exact and more is not None and isinstance(node.op, ast.Add):
                left.items.extend(more)
            else:
                blur(left)
            return
        reader.bind(node.target, reader.tried(node, lambda: operators.binary(node.op, left, right)))
    elif isinstance(node.target, ast.Attribute):
        owner = reader.value(node.target.value)
        held = attributes.attribute(reader, owner, node.target.attr, node.target)
        if isinstance(owner, Object):
            blur(held)
            kept: Value = held if isinstance(held, (Items, Dict)) else UNKNOWN
            if isinstance(held, Const):
                kept = reader.tried(node, lambda: operators.binary(node.op, held, right))
            objects.store(reader, owner, node.target.attr, kept)
        argument_units.check_target(reader, node.target, node.value, units.said(node.value, reader.unit_of))
    elif isinstance(node.target, ast.Subscript):
        blur(reader.value(node.target.value))


def bind(reader: State, target: ast.expr, value: Value) -> None:
    """Assign a value to a name, to several, or to a part of something."""
    if isinstance(target, ast.Name):
        holder = reader.scope if reader.scope.of_class else reader.scope.holder(target.id) or reader.scope
        holder.values[target.id] = UNKNOWN if target.id in reader.shared else value
    elif isinstance(target, (ast.Tuple, ast.List)):
        _unpack(reader, target, value)
    elif isinstance(target, ast.Starred):
        reader.bind(target.value, UNKNOWN)
    elif isinstance(target, ast.Attribute):
        owner = reader.value(target.value)
        if isinstance(owner, Object):
            objects.store(reader, owner, target.attr, value)
        else:
            attributes.store(reader, owner, target.attr, target)
    elif isinstance(target, ast.Subscript):
        _put(reader, reader.value(target.value), reader.value(target.slice), value)


def _unpack(reader: State, target: ast.Tuple | ast.List, value: Value) -> None:
    items = elements(value)
    starred = any(isinstance(each, ast.Starred) for each in target.elts)
    if items is not None and not starred and len(items) != len(target.elts):
        counts = f"{len(target.elts)} names are given {len(items)} values"
        reader.problems.add(target, "value", counts)
    if items is None or starred or len(items) != len(target.elts):
        items = [each_of(value)] * len(target.elts)
    for part, item in zip(target.elts, items, strict=True):
        reader.bind(part, item)


def _put(reader: State, holder: Value, index: Value, value: Value) -> None:
    try:
        if isinstance(holder, Dict) and reader.certain and holder.exact:
            holder.pairs[plain(index)] = value
            return
        if isinstance(holder, Items) and reader.certain and holder.exact and holder.kind is list:
            holder.items[plain(index)] = value
            return
    except (NotKnownError, TypeError, IndexError):
        pass
    blur(holder)


def delete(reader: State, node: ast.Delete) -> None:
    """`del name`."""
    for target in node.targets:
        if isinstance(target, ast.Name):
            reader.scope.values[target.id] = UNKNOWN
        else:
            blur(reader.value(getattr(target, "value", None)))
