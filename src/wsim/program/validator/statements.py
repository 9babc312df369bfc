"""Statements: the program's flow, followed as far as it is known."""

from __future__ import annotations

import ast
from typing import Literal

from wsim.program.validator import constants, units
from wsim.program.validator.expressions import guards
from wsim.program.validator.importing import Importing
from wsim.program.validator.state import assigned
from wsim.program.validator.values import (
    UNKNOWN,
    Const,
    Dict,
    Instance,
    Items,
    NotKnownError,
    Object,
    Scope,
    Value,
    blur,
    each_of,
    elements,
    merged,
    plain,
)

Flow = Literal["on", "break", "continue", "return", "raise"]


class Statements(Importing):
    """Reads statements."""

    def block(self, body: list[ast.stmt]) -> Flow:
        """Read statements in order, until one leaves."""
        for statement in body:
            flow = self.statement(statement)
            if flow != "on":
                return flow
        return "on"

    def statement(self, node: ast.stmt) -> Flow:
        """Read one statement."""
        self.steps -= 1
        read = getattr(self, f"_do_{type(node).__name__.lower()}", None)
        if read is not None:
            return read(node) or "on"
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                self.value(child)
        return "on"

    # -- assignments ---------------------------------------------------------------------------------------------

    def _do_assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        told = units.said(node.value, self.unit_of)
        for target in node.targets:
            self._units_of_target(target, node.value, told)
            self.bind(target, value)
            if isinstance(target, ast.Name):
                self.scope.units[target.id] = told

    def _do_annassign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.bind(node.target, self.value(node.value))

    def _do_augassign(self, node: ast.AugAssign) -> None:
        right = self.value(node.value)
        if isinstance(node.target, ast.Name):
            left = self._name(ast.copy_location(ast.Name(node.target.id, ast.Load()), node.target))
            if isinstance(left, Items) and left.kind is list:
                more = elements(right)
                if self.certain and left.exact and more is not None and isinstance(node.op, ast.Add):
                    left.items.extend(more)
                else:
                    blur(left)
                return
            self.bind(node.target, self.tried(node, lambda: constants.binary(node.op, left, right)))
        elif isinstance(node.target, ast.Attribute):
            owner = self.value(node.target.value)
            held = self.attribute(owner, node.target.attr, node.target)
            if isinstance(owner, Object):
                blur(held)
                kept: Value = held if isinstance(held, (Items, Dict)) else UNKNOWN
                if isinstance(held, Const):
                    kept = self.tried(node, lambda: constants.binary(node.op, held, right))
                self.store_in(owner, node.target.attr, kept)
            self._units_of_target(node.target, node.value, units.said(node.value, self.unit_of))
        elif isinstance(node.target, ast.Subscript):
            blur(self.value(node.target.value))

    def _units_of_target(self, target: ast.expr, value: ast.expr, told: str) -> None:
        """A joint's target is in radians."""
        if isinstance(target, ast.Attribute) and target.attr == "target" and told == "deg":
            owner = self.value(target.value)
            if isinstance(owner, Instance) and owner.type.endswith(".ControlJoint"):
                message = '"target" of a joint is in radians, and is given degrees; convert with math.radians'
                self.problems.add(value, "unit", message)

    def bind(self, target: ast.expr, value: Value) -> None:
        """Assign a value to a name, to several, or to a part of something."""
        if isinstance(target, ast.Name):
            holder = self.scope if self.scope.of_class else self.scope.holder(target.id) or self.scope
            holder.values[target.id] = UNKNOWN if target.id in self.shared else value
        elif isinstance(target, (ast.Tuple, ast.List)):
            self._unpack(target, value)
        elif isinstance(target, ast.Starred):
            self.bind(target.value, UNKNOWN)
        elif isinstance(target, ast.Attribute):
            owner = self.value(target.value)
            if isinstance(owner, Object):
                self.store_in(owner, target.attr, value)
            else:
                self.store(owner, target.attr, target)
        elif isinstance(target, ast.Subscript):
            self._put(self.value(target.value), self.value(target.slice), value)

    def _unpack(self, target: ast.Tuple | ast.List, value: Value) -> None:
        items = elements(value)
        starred = any(isinstance(each, ast.Starred) for each in target.elts)
        if items is not None and not starred and len(items) != len(target.elts):
            counts = f"{len(target.elts)} names are given {len(items)} values"
            self.problems.add(target, "value", counts)
        if items is None or starred or len(items) != len(target.elts):
            items = [each_of(value)] * len(target.elts)
        for part, item in zip(target.elts, items, strict=True):
            self.bind(part, item)

    def _put(self, holder: Value, index: Value, value: Value) -> None:
        try:
            if isinstance(holder, Dict) and self.certain and holder.exact:
                holder.pairs[plain(index)] = value
                return
            if isinstance(holder, Items) and self.certain and holder.exact and holder.kind is list:
                holder.items[plain(index)] = value
                return
        except (NotKnownError, TypeError, IndexError):
            pass
        blur(holder)

    def _do_delete(self, node: ast.Delete) -> None:
        for target in node.targets:
            if isinstance(target, ast.Name):
                self.scope.values[target.id] = UNKNOWN
            else:
                blur(self.value(getattr(target, "value", None)))

    # -- flow ----------------------------------------------------------------------------------------------------

    def _do_expr(self, node: ast.Expr) -> None:
        self.value(node.value)

    def _do_return(self, node: ast.Return) -> Flow:
        value = self.value(node.value) if node.value is not None else Const(None)
        if self.returned:
            self.returned[-1].append(value)
        return "return"

    def _do_raise(self, node: ast.Raise) -> Flow:
        if node.exc is not None:
            self.value(node.exc)
        return "raise"

    def _do_break(self, node: ast.Break) -> Flow:
        return "break"

    def _do_continue(self, node: ast.Continue) -> Flow:
        return "continue"

    def _do_if(self, node: ast.If) -> Flow:
        if _is_main(node.test):
            before, self.own = self.own, True
            with self.unsure():
                self.block(node.body)
            self.own = before
            return "on"
        if guards(node.test):
            with self.problems.quiet():
                self._branches([node.body, node.orelse])
            return "on"
        if "TYPE_CHECKING" in ast.dump(node.test):
            with self.problems.quiet():
                self.block(node.body)
            return "on"
        known = constants.truth(self.value(node.test))
        if known is not None:
            return self.block(node.body if known else node.orelse)
        return self._branches([node.body, node.orelse])

    def _branches(self, bodies: list[list[ast.stmt]]) -> Flow:
        """Read each of some ways that the program may go, from the same start."""
        start = dict(self.scope.values)
        ends: list[dict[str, Value]] = []
        flows: list[Flow] = []
        for body in bodies:
            self.scope.values = dict(start)
            self.branches += 1
            with self.unsure():
                flows.append(self.block(body))
            self.branches -= 1
            if flows[-1] == "on":
                ends.append(self.scope.values)
        self.scope.values = _joined(ends) if ends else start
        leaving = {flow for flow in flows if flow not in ("on", "raise")}
        if leaving:
            # What follows may no longer run; for sure or not is taken up again by what this stands in.
            self.certain = False
        if not ends:
            return next((flow for flow in flows if flow != "raise"), "raise")
        return "on"

    def _do_for(self, node: ast.For) -> Flow:
        source = self.value(node.iter)
        items = elements(source)
        if items is None or self.steps <= 0:
            return self._unknown_rounds(node, node.target, each_of(source))
        before = self.certain
        flow: Flow = "on"
        for item in items:
            if self.steps <= 0:
                self._unknown_rounds(node, node.target, UNKNOWN)
                break
            self.bind(node.target, item)
            flow = self.block(node.body)
            if flow in ("break", "return", "raise"):
                break
        if flow in ("return", "raise"):
            return flow
        if flow != "break":
            after = self.block(node.orelse)
            if after != "on":
                return after
        self.certain = before if not _leaves(node.body) else self.certain and before
        return "on"

    def _do_while(self, node: ast.While) -> Flow:
        self.value(node.test)
        return self._unknown_rounds(node, None, UNKNOWN)

    def _unknown_rounds(self, node: ast.For | ast.AsyncFor | ast.While, target: ast.expr | None, each: Value) -> Flow:
        """A loop of which it is not known how often it runs: its body once, with nothing known that it changes."""
        before = self.certain
        changed = assigned(node.body)
        for name in changed & self.scope.local:
            self.scope.values.setdefault(name, UNKNOWN)  # of an earlier round
        for name in changed:
            holder = self.scope.holder(name)
            if holder is not None and name in holder.values:
                blur(holder.values[name])
                holder.values[name] = UNKNOWN
        self._blur_used(node.body)
        self.rounds += 1
        with self.unsure():
            if target is not None:
                self.bind(target, each)
            start = dict(self.scope.values)
            self.block(node.body)
        self.rounds -= 1
        with self.unsure():
            self.scope.values = _joined([start, self.scope.values])
            self.block(node.orelse)
        for name in changed & self.scope.local:
            self.scope.values[name] = UNKNOWN
        self.certain = before and not any(isinstance(n, ast.Return) for s in node.body for n in ast.walk(s))
        return "on"

    def _blur_used(self, body: list[ast.stmt]) -> None:
        """Lists that a body may fill."""
        for part in (each for statement in body for each in ast.walk(statement)):
            if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
                holder = self.scope.holder(part.value.id)
                if holder is not None and part.value.id in holder.values:
                    blur(holder.values[part.value.id])

    def _do_try(self, node: ast.Try) -> Flow:
        start = dict(self.scope.values)
        with self.unsure():
            if node.handlers:
                with self.problems.quiet():
                    flow = self.block(node.body)
            else:
                flow = self.block(node.body)
        ends = [self.scope.values] if flow == "on" else []
        for handler in node.handlers:
            self.scope.values = _joined([start, *ends])
            if handler.name:
                self.scope.values[handler.name] = UNKNOWN
            with self.unsure():
                if self.block(handler.body) == "on":
                    ends.append(self.scope.values)
        self.scope.values = _joined(ends) if ends else start
        with self.unsure():
            self.block(node.orelse)
            self.block(node.finalbody)
        return "on"

    _do_trystar = _do_try

    def _do_with(self, node: ast.With) -> Flow:
        for item in node.items:
            self.value(item.context_expr)
            if item.optional_vars is not None:
                self.bind(item.optional_vars, UNKNOWN)
        return self.block(node.body)

    _do_asyncwith = _do_with

    def _do_asyncfor(self, node: ast.AsyncFor) -> Flow:
        self.value(node.iter)
        return self._unknown_rounds(node, node.target, UNKNOWN)

    def _do_match(self, node: ast.Match) -> Flow:
        self.value(node.subject)
        for case in node.cases:
            for name in assigned([ast.Expr(case.pattern)]):  # type: ignore[arg-type]
                self.scope.values[name] = UNKNOWN
        return self._branches([*(case.body for case in node.cases), []])

    def _do_global(self, node: ast.Global) -> None:
        for name in node.names:
            self.module.values.setdefault(name, UNKNOWN)

    def _do_classdef(self, node: ast.ClassDef) -> None:
        bases = [self.value(each) for each in node.bases]
        for each in node.decorator_list:
            self.value(each)
        inner = Scope(assigned(node.body), self.scope, of_class=True)
        before, self.scope = self.scope, inner
        self.block(node.body)
        self.scope = before
        self.bind(ast.Name(node.name), self.made_class(node, inner.values, bases))


def _joined(ends: list[dict[str, Value]]) -> dict[str, Value]:
    """What is known of names where several ways meet; one that only some ways bind may be there or not."""
    joined: dict[str, Value] = {}
    for name in dict.fromkeys(name for end in ends for name in end):
        found = [end[name] for end in ends if name in end]
        value = found[0] if len(found) == len(ends) else UNKNOWN
        for other in found[1:]:
            value = merged(value, other)
        joined[name] = value
    return joined


def _is_main(test: ast.expr) -> bool:
    return isinstance(test, ast.Compare) and isinstance(test.left, ast.Name) and test.left.id == "__name__"


def _leaves(body: list[ast.stmt]) -> bool:
    return any(isinstance(each, (ast.Return, ast.Break)) for statement in body for each in ast.walk(statement))
