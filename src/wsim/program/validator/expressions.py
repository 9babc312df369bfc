"""Expressions: each node of the program's text as a value."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any

from wsim.program.validator import constants
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.objects import Objects
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
    Scope,
    Value,
    each_of,
    elements,
    merged,
    plain,
)

_GIVEN = {
    "__name__",
    "__file__",
    "__doc__",
    "__builtins__",
    "__spec__",
    "__package__",
    "__loader__",
    "__annotations__",
    "__path__",
}
_GUARDS = {"hasattr", "isinstance", "issubclass", "callable", "type", "getattr", "platform"}
_MOST = 400  # items of a comprehension that are read one by one


class Expressions(Objects):
    """Reads expressions."""

    def value(self, node: ast.expr | None) -> Value:
        """What an expression gives."""
        if node is None:
            return UNKNOWN
        read: Callable[[Any], Value] | None = getattr(self, f"_{type(node).__name__.lower()}", None)
        if read is not None:
            return read(node)
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                self.value(child)
        return UNKNOWN

    def _constant(self, node: ast.Constant) -> Value:
        return Const(node.value)

    def _name(self, node: ast.Name) -> Value:
        name = node.id
        scope = self.scope.holder(name)
        built = hasattr(builtins, name)
        if scope is not None and (name in scope.values or not (built and scope is self.module)):
            if name in scope.values:
                return scope.values[name]
            if name in _GIVEN:
                return UNKNOWN
            if scope is self.scope or (scope is self.module and self.module_read):
                self._not_yet(node, scope)
            return UNKNOWN
        if built:
            return (
                Const(getattr(builtins, name)) if name in ("NotImplemented", "Ellipsis") else Named(f"builtins.{name}")
            )
        if name not in _GIVEN and not self.module.open:
            self.problems.add(node, "name", f'the name "{name}" is not defined', self._spelt(name))
        return UNKNOWN

    def _not_yet(self, node: ast.Name, scope: Scope) -> None:
        if self.branches:
            return  # the way that leads here may be one on which it has been made
        self.problems.add(node, "order", f'"{node.id}" is used before it is made')
        scope.values[node.id] = UNKNOWN

    def _spelt(self, name: str) -> str:
        """A name of the program that is spelt like this, or an entry of the index of that name."""
        known: set[str] = set()
        scope: Scope | None = self.scope
        while scope is not None:
            known |= scope.local | set(scope.values)
            scope = scope.outer
        close = get_close_matches(name, known, n=1, cutoff=0.75)
        return f'"{close[0]}"' if close else self.elsewhere(name)

    def _attribute(self, node: ast.Attribute) -> Value:
        return self.attribute(self.value(node.value), node.attr, node)

    def _call(self, node: ast.Call) -> Value:
        called = self.value(node.func)
        arguments = Arguments(node)
        for each in node.args:
            if isinstance(each, ast.Starred):
                items = elements(self.value(each.value))
                if items is None:
                    arguments.open = True
                else:
                    arguments.given += [(item, each.value) for item in items]
            elif not arguments.open:
                arguments.given.append((self.value(each), each))
            else:
                self.value(each)
        for keyword in node.keywords:
            value = self.value(keyword.value)
            if keyword.arg is not None:
                arguments.named[keyword.arg] = (value, keyword.value)
            elif isinstance(value, Dict) and value.exact and all(isinstance(key, str) for key in value.pairs):
                arguments.named |= {key: (item, keyword.value) for key, item in value.pairs.items()}
            else:
                arguments.open = True
        return self.call(called, arguments)

    def _tuple(self, node: ast.Tuple) -> Value:
        return self._sequence(tuple, node.elts)

    def _list(self, node: ast.List) -> Value:
        return self._sequence(list, node.elts)

    def _set(self, node: ast.Set) -> Value:
        return self._sequence(set, node.elts)

    def _sequence(self, kind: type, nodes: list[ast.expr]) -> Value:
        items: list[Value] = []
        exact = True
        for each in nodes:
            if isinstance(each, ast.Starred):
                more = elements(self.value(each.value))
                exact = exact and more is not None
                items += more or []
            else:
                items.append(self.value(each))
        return Items(kind, items) if exact else Items(kind, [], exact=False)

    def _dict(self, node: ast.Dict) -> Value:
        pairs: dict[Any, Value] = {}
        exact = True
        for key, each in zip(node.keys, node.values, strict=True):
            value = self.value(each)
            try:
                if key is None:
                    exact = exact and isinstance(value, Dict) and value.exact
                    pairs |= value.pairs if isinstance(value, Dict) else {}
                else:
                    pairs[plain(self.value(key))] = value
            except (NotKnownError, TypeError):
                exact = False
        return Dict(pairs, exact)

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.value(node.left), self.value(node.right)
        found = self.tried(node, lambda: constants.binary(node.op, left, right))
        if found is UNKNOWN and isinstance(left, Instance) and left.type == "numpy.ndarray":
            return left
        return found

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        return constants.unary(node.op, self.value(node.operand))

    def _boolop(self, node: ast.BoolOp) -> Value:
        result = self.value(node.values[0])
        if any(guards(each) for each in node.values):
            with self.problems.quiet(), self.unsure():
                for each in node.values[1:]:
                    self.value(each)
            return UNKNOWN
        for each in node.values[1:]:
            known = constants.truth(result)
            if known is not None and known == isinstance(node.op, ast.Or):
                return result
            if known is None:
                with self.unsure():
                    result = merged(result, self.value(each))
            else:
                result = self.value(each)
        return result

    def _compare(self, node: ast.Compare) -> Value:
        left = self.value(node.left)
        result: Value = Const(True)
        for op, each in zip(node.ops, node.comparators, strict=True):
            right = self.value(each)
            if not isinstance(result, Const) or result.value is not False:
                found = self._compared(op, left, right)
                result = found if isinstance(found, Const) and isinstance(result, Const) else UNKNOWN
            left = right
        return result

    def _compared(self, op: ast.cmpop, left: Value, right: Value) -> Value:
        """The truth of a comparison, where it can be known without all of both values."""
        if isinstance(op, (ast.In, ast.NotIn)) and isinstance(right, Dict) and right.exact and isinstance(left, Const):
            return Const((left.value in right.pairs) == isinstance(op, ast.In))
        if isinstance(left, (Function, Named)) and isinstance(right, (Function, Named)):
            same = left is right or (isinstance(left, Named) and left == right)
            if isinstance(op, (ast.Eq, ast.Is)):
                return Const(same)
            if isinstance(op, (ast.NotEq, ast.IsNot)):
                return Const(not same)
        known = isinstance(left, (Items, Dict, Instance, Named, Function)) and not getattr(left, "loose", False)
        if known and isinstance(right, Const) and right.value is None and isinstance(op, (ast.Is, ast.IsNot)):
            return UNKNOWN if isinstance(left, Instance) else Const(isinstance(op, ast.IsNot))
        return constants.compare(op, left, right)

    def _ifexp(self, node: ast.IfExp) -> Value:
        if guards(node.test):
            with self.problems.quiet(), self.unsure():
                return merged(self.value(node.body), self.value(node.orelse))
        known = constants.truth(self.value(node.test))
        if known is not None:
            return self.value(node.body if known else node.orelse)
        with self.unsure():
            return merged(self.value(node.body), self.value(node.orelse))

    def _subscript(self, node: ast.Subscript) -> Value:
        value = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            bounds = (node.slice.lower, node.slice.upper, node.slice.step)
            parts = [self.value(part) for part in bounds if part is not None]
            return self._sliced(value, node.slice) if all(isinstance(part, Const) for part in parts) else UNKNOWN
        index = self.value(node.slice)
        if isinstance(value, Dict):
            try:
                key = plain(index)
                if value.exact and key not in value.pairs and self.certain:
                    self.problems.add(node, "value", f"this fails: there is no key {key!r}")
                return value.pairs.get(key, UNKNOWN) if value.exact else UNKNOWN
            except (NotKnownError, TypeError):
                return UNKNOWN
        return self.tried(node, lambda: constants.subscript(value, index))

    def _sliced(self, value: Value, node: ast.Slice) -> Value:
        bounds = [None if part is None else self.value(part) for part in (node.lower, node.upper, node.step)]
        cut = slice(*(part.value if isinstance(part, Const) else None for part in bounds))
        if isinstance(value, Items) and value.exact and value.kind is not set:
            try:
                return Items(value.kind, value.items[cut])
            except (TypeError, ValueError):
                return UNKNOWN
        return constants.subscript(value, Const(cut)) if isinstance(value, Const) else UNKNOWN

    def _joinedstr(self, node: ast.JoinedStr) -> Value:
        text = ""
        known = True
        for part in node.values:
            if isinstance(part, ast.Constant):
                text += str(part.value)
                continue
            assert isinstance(part, ast.FormattedValue)
            shown = self._formatted(part)
            known = known and shown is not None
            text += shown or ""
        return Const(text) if known else Instance("builtins.str")

    def _formatted(self, node: ast.FormattedValue) -> str | None:
        value = self.value(node.value)
        form = self.value(node.format_spec) if node.format_spec is not None else Const("")
        if not isinstance(value, Const) or not isinstance(form, Const) or not _is_short(form.value):
            return None
        if not isinstance(value.value, (str, int, float, bool)):
            return None
        shown: dict[int, Callable[[object], str]] = {115: str, 114: repr, 97: ascii}
        try:
            if node.conversion in shown:
                return format(shown[node.conversion](value.value), form.value)
            return format(value.value, form.value)
        except (ValueError, TypeError):
            return None

    def _namedexpr(self, node: ast.NamedExpr) -> Value:
        value = self.value(node.value)
        self.scope.values[node.target.id] = value
        return value

    def _lambda(self, node: ast.Lambda) -> Value:
        for default in (*node.args.defaults, *(each for each in node.args.kw_defaults if each is not None)):
            self.value(default)
        return Function(node, self.scope)

    def _starred(self, node: ast.Starred) -> Value:
        return self.value(node.value)

    # -- comprehensions ------------------------------------------------------------------------------------------

    def _listcomp(self, node: ast.ListComp) -> Value:
        return self._comprehension(node, list)

    def _setcomp(self, node: ast.SetComp) -> Value:
        return self._comprehension(node, set)

    def _generatorexp(self, node: ast.GeneratorExp) -> Value:
        return self._comprehension(node, list)

    def _comprehension(self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp, kind: type) -> Value:
        made: list[Value] = []
        exact = self._each(node.generators, lambda: made.append(self.value(node.elt)))
        if exact:
            return Items(kind, made)
        return Items(kind, [], exact=False, each=made[0] if len(made) == 1 else UNKNOWN)

    def _dictcomp(self, node: ast.DictComp) -> Value:
        pairs: dict[Any, Value] = {}

        def add() -> None:
            key, value = self.value(node.key), self.value(node.value)
            pairs[plain(key)] = value

        try:
            return Dict(pairs) if self._each(node.generators, add) else Dict({}, exact=False)
        except (NotKnownError, TypeError):
            return Dict({}, exact=False)

    def _each(self, generators: list[ast.comprehension], read: Callable[[], None]) -> bool:
        """Read something for each round of a comprehension; False if they are not known, and one stands for all."""
        first = self.value(generators[0].iter)
        before = self.scope
        names = frozenset().union(*(assigned([ast.Expr(g.target)]) for g in generators))
        self.scope = Scope(names, before)
        try:
            return self._round(generators, 0, first, read)
        finally:
            self.scope = before

    def _round(self, generators: list[ast.comprehension], depth: int, source: Value, read: Callable[[], None]) -> bool:
        if depth == len(generators):
            read()
            return True
        items = elements(source, _MOST)
        self.steps -= len(items or ())
        if items is None or self.steps <= 0:
            each = each_of(source)
            self.rounds += 1
            with self.unsure():
                self._one(generators, depth, each, read)
            self.rounds -= 1
            return False
        exact = [self._one(generators, depth, item, read) for item in items]
        return all(exact)

    def _one(self, generators: list[ast.comprehension], depth: int, item: Value, read: Callable[[], None]) -> bool:
        self.bind(generators[depth].target, item)
        exact = True
        for test in generators[depth].ifs:
            known = constants.truth(self.value(test))
            if known is False:
                return exact
            exact = exact and known is True
        if depth + 1 < len(generators):
            source = self.value(generators[depth + 1].iter)
            return self._round(generators, depth + 1, source, read) and exact
        if exact:
            read()
            return True
        with self.unsure():
            read()
        return False

    def bind(self, target: ast.expr, value: Value) -> None:
        """Assign a value to a target; see `Statements`."""
        raise NotImplementedError


def guards(test: ast.expr) -> bool:
    """Whether a test asks what something is: where it holds, more may be known than the validator knows."""
    for each in ast.walk(test):
        name = each.id if isinstance(each, ast.Name) else each.attr if isinstance(each, ast.Attribute) else ""
        if name in _GUARDS or "version" in name.lower():
            return True
    return False


def _is_short(form: object) -> bool:
    """Whether a format asks for no more than a line."""
    digits = "".join(c if c.isdigit() else " " for c in str(form)).split()
    return all(len(number) <= 2 for number in digits)
