"""Statements: the program's flow, followed as far as it is known."""

from __future__ import annotations

import ast

from wsim.program.validator import assignments, functions, importing, objects, operators
from wsim.program.validator.expressions import Expressions, guards
from wsim.program.validator.state import Flow, assigned
from wsim.program.validator.values import UNKNOWN, Const, Value, blur, each_of, elements, merged


class Statements(Expressions):
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

    bind = assignments.bind
    _do_assign = assignments.assign
    _do_annassign = assignments.annotated
    _do_augassign = assignments.augmented
    _do_delete = assignments.delete
    _do_import = importing.modules
    _do_importfrom = importing.names
    _do_functiondef = _do_asyncfunctiondef = functions.define
    _do_classdef = objects.define

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
        known = operators.truth(self.value(node.test))
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
