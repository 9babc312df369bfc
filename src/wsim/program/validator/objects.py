"""Classes of the program itself: their objects, and what these hold."""

from __future__ import annotations

import ast
from dataclasses import replace
from difflib import get_close_matches

from wsim.program.validator.arguments import Arguments
from wsim.program.validator.calls import Calls
from wsim.program.validator.values import UNKNOWN, Class, Function, Named, Object, Value

_PLAIN_BASES = ("builtins.object",)
_DATACLASS = "dataclasses.dataclass"


class Objects(Calls):
    """Reads what a program does with classes of its own."""

    def made_class(self, node: ast.ClassDef, members: dict[str, Value], bases: list[Value]) -> Value:
        """The class that a `class` statement makes."""
        decorators = [self.decorator(each) for each in node.decorator_list]
        whole = not node.keywords and all(each == _DATACLASS for each in decorators)
        inherited: dict[str, Value] = {}
        fields: dict[str, Value | None] = {}
        for base in bases:
            if isinstance(base, Class):
                inherited, fields = inherited | base.members, fields | (base.fields or {})
            whole = whole and (
                (isinstance(base, Class) and base.whole) or (isinstance(base, Named) and base.name in _PLAIN_BASES)
            )
        if _DATACLASS in decorators:
            for each in node.body:
                if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name) and not _shared(each):
                    # A default that is `field(...)` says only that there is one.
                    given = members.get(each.target.id, UNKNOWN) if each.value is not None else None
                    fields[each.target.id] = UNKNOWN if isinstance(each.value, ast.Call) else given
        dataclass = _DATACLASS in decorators or any(isinstance(b, Class) and b.fields is not None for b in bases)
        return Class(node, inherited | members, fields if dataclass else None, whole)

    def decorator(self, node: ast.expr) -> str:
        """The whole name of a decorator; "" if it is not one of the index."""
        with self.problems.quiet():  # it was read where it stands; here its names may not be in scope
            value = self.value(node.func if isinstance(node, ast.Call) else node)
        return value.name if isinstance(value, Named) else ""

    def construct(self, kind: Class, arguments: Arguments) -> Value:
        """The object that a call of a class makes."""
        made = Object(kind)
        start = kind.members.get("__init__")
        if not kind.whole or "__new__" in kind.members:
            self.hand_over(arguments)
            return UNKNOWN
        if isinstance(start, Function):
            self.run(replace(start, owner=made), arguments)
            return made
        if kind.fields is not None:
            self._fill(made, kind.fields, arguments)
            after = kind.members.get("__post_init__")
            if isinstance(after, Function):
                self.run(replace(after, owner=made), Arguments(arguments.call))
            return made
        if arguments.given or arguments.named:
            name = kind.node.name
            self.problems.add(arguments.call, "argument", f"{name}() takes no arguments")
        return made

    def _fill(self, made: Object, fields: dict[str, Value | None], arguments: Arguments) -> None:
        """Give a dataclass's fields their values."""
        name = made.kind.node.name
        given = dict(zip(fields, arguments.values, strict=False))
        if len(arguments.given) > len(fields):
            text = f"{name}() takes {len(fields)} arguments, and is given {len(arguments.given)}"
            self.problems.add(arguments.given[len(fields)][1], "argument", text)
        for key, (value, node) in arguments.named.items():
            if key not in fields:
                self.problems.add(node, "argument", f'{name}() has no argument "{key}"; it takes {", ".join(fields)}')
            given[key] = value
        missing = [key for key, default in fields.items() if key not in given and default is None]
        if missing and not arguments.open:
            names = ", ".join(f'"{key}"' for key in missing)
            self.problems.add(arguments.call, "argument", f"{name}() lacks {names}")
        made.fields = {key: given.get(key) or default or UNKNOWN for key, default in fields.items()}

    def of_object(self, value: Object | Class, name: str, node: ast.Attribute) -> Value:
        """What an attribute of a program's own object or class is."""
        kind = value if isinstance(value, Class) else value.kind
        if not kind.whole:
            return UNKNOWN
        if isinstance(value, Object) and name in value.fields:
            return UNKNOWN if self.rounds and name in self.stored else value.fields[name]
        found = kind.members.get(name)
        if found is None:
            dynamic = "__getattr__" in kind.members or name in self.stored or name.startswith("_")
            if kind.whole and not dynamic and not isinstance(value, Class) and name not in (kind.fields or {}):
                text = f'{kind.node.name} has no "{name}"'
                self.problems.add(node, "attribute", text, self.spelt(name, [*kind.members, *value.fields]))
            return UNKNOWN
        if not isinstance(found, Function) or isinstance(value, Class):
            return UNKNOWN if isinstance(found, Function) or name in self.stored else found
        decorators = (
            [] if isinstance(found.node, ast.Lambda) else [self.decorator(d) for d in found.node.decorator_list]
        )
        bound = replace(found, owner=value, plain=not self.yields(found.node))
        if not decorators:
            return bound
        if decorators == ["builtins.property"] or decorators == ["functools.cached_property"]:
            return self.run(bound, Arguments(ast.copy_location(ast.Call(node, [], []), node)))
        if decorators == ["builtins.staticmethod"]:
            return replace(bound, owner=None)
        return UNKNOWN

    def store_in(self, value: Object, name: str, given: Value) -> None:
        """`self.name = ...`"""
        value.fields[name] = given if self.certain and not self.rounds else UNKNOWN

    def hand_over(self, arguments: Arguments) -> None:
        """What is handed to code that is not read here may be changed by it."""
        self._hand_over(arguments)

    @staticmethod
    def spelt(name: str, known: list[str]) -> str:
        """The name that is spelt most like this one."""
        close = get_close_matches(name, known, n=1, cutoff=0.6)
        return f'"{close[0]}"' if close else ""

    @staticmethod
    def yields(node: ast.AST) -> bool:
        """Whether a function is a generator or a coroutine."""
        return any(isinstance(each, (ast.Yield, ast.YieldFrom, ast.Await)) for each in ast.walk(node))


def _shared(node: ast.AnnAssign) -> bool:
    """Whether a dataclass takes an annotated name for the class's own, and not for a field."""
    return "ClassVar" in ast.dump(node.annotation)
