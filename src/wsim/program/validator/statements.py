"""Statements: the program's flow, followed as far as it is known."""

from __future__ import annotations

import ast
from typing import Literal

from wsim.program.validator import constants, imports, units
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.expressions import Expressions, guards
from wsim.program.validator.state import assigned
from wsim.program.validator.values import (
    UNKNOWN,
    Const,
    Dict,
    Function,
    Instance,
    Items,
    Named,
    NotKnownError,
    Object,
    Scope,
    Value,
    blur,
    elements,
    merged,
    plain,
)

Flow = Literal["on", "break", "continue", "return", "raise"]
_DEEPEST = 12


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
            each = value.each if isinstance(value, Items) and not value.exact else UNKNOWN
            items = [each] * len(target.elts)
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

    # -- imports -------------------------------------------------------------------------------------------------

    def _do_import(self, node: ast.Import) -> None:
        for alias in node.names:
            found = self._import(alias.name, node)
            top = alias.name.partition(".")[0]
            self.bind(ast.Name(alias.asname or top), found if alias.asname else self._listed(top))

    def _do_importfrom(self, node: ast.ImportFrom) -> None:
        module = node.module or ""
        if node.level:
            self.problems.add(node, "import", "a program stands alone; it has no modules beside it to import from")
        known = self._import(module, node) if not node.level else UNKNOWN
        for alias in node.names:
            if alias.name == "*":
                self._import_all(module, known)
                continue
            value: Value = UNKNOWN
            if isinstance(known, Named):
                value = self._from(known.name, alias)
            self.bind(ast.Name(alias.asname or alias.name), value)

    def _import(self, module: str, node: ast.AST) -> Value:
        """A module; a problem if it is not for programs, or not there."""
        why = "" if self.own else imports.refused(module)
        if why:
            self.problems.add(node, "import", f'"{module}" cannot be imported: {why}', self._module_like(module))
            return UNKNOWN
        top = module.partition(".")[0]
        if self.entry(module) is None and top in ("wsim", "pxr", "numpy") and not imports.is_there(module):
            self.problems.add(node, "import", f'there is no module "{module}"', self._module_like(module))
            return UNKNOWN
        return self._listed(module)

    def _listed(self, module: str) -> Value:
        entry = self.entry(module)
        return Named(module) if entry is not None or self.index.programs.children(module) else UNKNOWN

    def _from(self, module: str, alias: ast.alias) -> Value:
        whole = f"{module}.{alias.name}"
        entry = self.entry(whole)
        if entry is not None:
            if entry.kind in ("module", "class", "function"):
                return Named(whole)
            return self.attribute(Named(module), alias.name, _at(alias))
        if self.index.programs.children(whole):
            return Named(whole)
        holder = self.entry(module)
        if holder is None or holder.kind != "module" or alias.name.startswith("_") or imports.is_there(whole):
            return UNKNOWN
        moved = self.index.programs.ending(alias.name)
        shown = [name for name in moved if name == f"wsim.scene.{alias.name}"]
        if shown and module.startswith("wsim.scene"):
            return Named(shown[0])
        before = len(self.problems.sorted())
        self.attribute(Named(module), alias.name, _at(alias))
        if len(self.problems.sorted()) == before:
            self.problems.add(alias, "import", f"{module} has no {alias.name}")
        return UNKNOWN

    def _import_all(self, module: str, known: Value) -> None:
        names = [name for name in self.index.programs.children(module) if not name.startswith("_")]
        if not isinstance(known, Named) or not names:
            self.module.open = True
            return
        self.module.open = self.module.open or not module.startswith("wsim.scene")
        for name in names:
            self.module.values.setdefault(name, self._from(module, ast.alias(name)))

    def _module_like(self, module: str) -> str:
        """What is meant by a module that cannot be imported: one of that name, or what it was asked for, elsewhere."""
        if module.startswith(("wsim", "world")):
            return "from wsim.scene import Scene"
        from difflib import get_close_matches

        known = [f"pxr.{name}" for name in self.index.programs.children("pxr")] or self.index.programs.modules()
        found = get_close_matches(module, known, n=1, cutoff=0.6)
        return f"import {found[0]}" if found else ""

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
            each = source.each if isinstance(source, Items) else UNKNOWN
            return self._unknown_rounds(node, node.target, each)
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

    def _unknown_rounds(self, node: ast.For | ast.While, target: ast.expr | None, each: Value) -> Flow:
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
        inner = Scope(assigned(node.body), self.scope, of_class=True)
        before, self.scope = self.scope, inner
        self.block(node.body)
        self.scope = before
        self.bind(ast.Name(node.name), self.made_class(node, inner.values, bases))

    # -- functions -----------------------------------------------------------------------------------------------

    def _do_functiondef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        for each in node.decorator_list:
            self.value(each)
        defaults = [*node.args.defaults, *(each for each in node.args.kw_defaults if each is not None)]
        values = {id(each): self.value(each) for each in defaults}
        takers = [*node.args.posonlyargs, *node.args.args]
        pairs = [*zip(takers[len(takers) - len(node.args.defaults) :], node.args.defaults, strict=True)]
        pairs += [(a, d) for a, d in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True) if d is not None]
        simple = not node.decorator_list and isinstance(node, ast.FunctionDef) and not self.yields(node)
        made = Function(node, self.scope, {a.arg: values[id(d)] for a, d in pairs}, simple)
        self.functions.append(made)
        self.bind(ast.Name(node.name), made)

    _do_asyncfunctiondef = _do_functiondef

    def run(self, function: Function, arguments: Arguments) -> Value:
        """Read a function of the program as it is called here, and give what it returns."""
        if not function.plain or self.depth >= _DEEPEST or self.steps <= 0:
            self._hand_over(arguments)
            return UNKNOWN
        given = self._given(function, arguments)
        return self.enter(function, given)

    def _given(self, function: Function, arguments: Arguments) -> dict[str, Value]:
        """The function's arguments by name; a problem where they do not fit."""
        a = function.node.args
        places = [each.arg for each in (*a.posonlyargs, *a.args)]
        bound: dict[str, Value] = {}
        if function.owner is not None and places:
            bound, places = {places[0]: function.owner}, places[1:]
        keywords = [each.arg for each in (*a.args, *a.kwonlyargs)]
        name = getattr(function.node, "name", "lambda")
        given = dict(zip(places, arguments.values, strict=False))
        if len(arguments.given) > len(places) and a.vararg is None:
            node = arguments.given[len(places)][1]
            text = f"{name}() takes {len(places)} positional arguments, and is given {len(arguments.given)}"
            self.problems.add(node, "argument", text)
        for key, (value, node) in arguments.named.items():
            if key not in keywords and a.kwarg is None:
                self.problems.add(node, "argument", f'{name}() has no argument "{key}"')
            elif key in keywords:
                given[key] = value
        required = [p for p in (*places, *(each.arg for each in a.kwonlyargs)) if p not in function.defaults]
        if isinstance(function.node, ast.Lambda):
            required = [] if a.defaults or a.kw_defaults else required
        missing = [p for p in required if p not in given]
        if missing and not arguments.open:
            names = ", ".join(f'"{p}"' for p in missing)
            self.problems.add(arguments.call, "argument", f"{name}() lacks {names}")
        return given | bound

    def enter(self, function: Function, given: dict[str, Value], *, called: bool = True) -> Value:
        """Read a function's body with these arguments; where it is not `called` here, the others may be anything."""
        node = function.node
        self.called.add(node)
        body: list[ast.stmt] = [ast.Return(node.body)] if isinstance(node, ast.Lambda) else node.body
        scope = Scope(assigned(body) | frozenset(each.arg for each in ast.walk(node.args) if isinstance(each, ast.arg)))
        scope.outer = function.scope
        for each in ast.walk(node.args):
            if isinstance(each, ast.arg):
                default = function.defaults.get(each.arg) if called else None
                scope.values[each.arg] = given.get(each.arg) or default or self._annotated(each)
        before = self.scope, self.certain
        self.scope = scope
        self.depth += 1
        self.returned.append([])
        try:
            flow = self.block(body)
        finally:
            self.scope, self.certain = before
            self.depth -= 1
            returned = self.returned.pop()
        if flow == "on":
            returned.append(Const(None))
        result = returned[0] if returned else UNKNOWN
        for each_value in returned[1:]:
            result = merged(result, each_value)
        return result

    def _annotated(self, argument: ast.arg) -> Value:
        """What an argument is by its annotation alone."""
        if argument.annotation is None:
            return UNKNOWN
        with self.problems.quiet():
            if isinstance(argument.annotation, ast.Constant) and isinstance(argument.annotation.value, str):
                try:
                    found = self.value(ast.parse(argument.annotation.value, mode="eval").body)
                except SyntaxError:
                    return UNKNOWN
            else:
                found = self.value(argument.annotation)
        entry = self.entry(found.name) if isinstance(found, Named) else None
        if entry is None or entry.kind != "class" or entry.source not in ("wsim", "pxr"):
            return UNKNOWN
        return Instance(entry.name, loose=True)

    functions: list[Function]


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


def _at(alias: ast.alias) -> ast.Attribute:
    """A node to hang a problem on, where an import stands."""
    node = ast.Attribute(ast.Name("", ast.Load()), alias.name, ast.Load())
    return ast.copy_location(node, alias) if hasattr(alias, "lineno") else node
