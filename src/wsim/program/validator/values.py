"""What the validator knows of a value: the value itself, its parts, its type, or nothing."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import Any, TypeAlias


class Unknown:
    """Anything."""


UNKNOWN = Unknown()


@dataclass(frozen=True)
class Const:
    """A value that is known: a number, a string, None, a small array, or what a scene's call returned."""

    value: Any


@dataclass
class Items:
    """A tuple, list or set whose items are known, each as far as it is.

    Attributes:
        kind: tuple, list or set.
        items: The items, where `exact`.
        exact: Whether these are all of them.
        each: What any item is, where not `exact`.
    """

    kind: type
    items: list[Value]
    exact: bool = True
    each: Value = UNKNOWN

    def blur(self) -> None:
        """From now on it may hold anything."""
        self.exact, self.items, self.each = False, [], UNKNOWN


@dataclass
class Dict:
    """A dictionary with known keys, where `exact`."""

    pairs: dict[Any, Value]
    exact: bool = True

    def blur(self) -> None:
        """From now on it may hold anything."""
        self.exact, self.pairs = False, {}


@dataclass(frozen=True)
class Instance:
    """Some object of a class of the index.

    Attributes:
        type: Whole name of the class.
        world: What a scene, or what stands for it in `control`, belongs to.
        loose: It may be of a class that inherits from that one: all that is known is an annotation.
        path: Of a prim, or of a schema on one: where it is; "" if that is not known.
    """

    type: str
    world: Any = None
    loose: bool = False
    path: str = ""


@dataclass(frozen=True)
class Named:
    """A module, class or function of the index, or a method of `owner`."""

    name: str
    owner: Value | None = None


@dataclass(eq=False)
class Function:
    """A function of the program itself."""

    node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
    scope: Scope
    defaults: dict[str, Value] = field(default_factory=dict)
    plain: bool = True  # no decorator, no yield: what it returns is what its body says
    owner: Object | None = None  # of a method that is bound


@dataclass(eq=False)
class Class:
    """A class of the program itself.

    Attributes:
        node: Its text.
        members: What its body binds, that of its bases too.
        fields: Of a dataclass: its fields in order, with their defaults.
        whole: It inherits from nothing that is not read, and nothing but `dataclass` changes it.
    """

    node: ast.ClassDef
    members: dict[str, Value]
    fields: dict[str, Value | None] | None = None
    whole: bool = True


@dataclass(eq=False)
class Object:
    """An object of a class of the program."""

    kind: Class
    fields: dict[str, Value] = field(default_factory=dict)


Value: TypeAlias = "Unknown | Const | Items | Dict | Instance | Named | Function | Class | Object"


class Scope:
    """Names of a module or of one call of a function.

    Args:
        local: All names that are assigned somewhere in it.
        outer: What it is written in; None for a module.
        of_class: Its names are a class's, which the functions in it do not see.
    """

    def __init__(self, local: frozenset[str], outer: Scope | None = None, *, of_class: bool = False) -> None:
        self.local, self.outer, self.of_class = local, outer, of_class
        self.values: dict[str, Value] = {}
        self.units: dict[str, str] = {}  # "deg" or "rad", of what was assigned
        self.open = False  # any name may be in it: after a star import of something unknown

    def holder(self, name: str) -> Scope | None:
        """The scope that a name belongs to."""
        scope: Scope | None = self
        while scope is not None and not scope._has(name, asked_by=self):
            scope = scope.outer
        return scope

    def _has(self, name: str, asked_by: Scope) -> bool:
        if self.of_class:
            return self is asked_by and name in self.values
        return name in self.local or name in self.values


def merged(one: Value, other: Value) -> Value:
    """What is known of a value that is one of two."""
    if one is other:
        return one
    if isinstance(one, Const) and isinstance(other, Const) and _same(one.value, other.value):
        return one
    if isinstance(one, (Instance, Named)) and one == other:
        return one
    if isinstance(one, Instance) and isinstance(other, Instance) and one.type == other.type:
        return Instance(one.type, one.world if one.world is other.world else None, one.loose or other.loose)
    return UNKNOWN


def _same(one: Any, other: Any) -> bool:
    if type(one) is not type(other):
        return False
    try:
        return bool(one == other)
    except (ValueError, TypeError):
        return False


def blur(value: Value) -> None:
    """What was handed to code that is not read may have been changed by it."""
    if isinstance(value, Object):
        value.fields = dict.fromkeys(value.fields, UNKNOWN)
    elif isinstance(value, (Items, Dict)) and not (isinstance(value, Items) and value.kind is tuple):
        value.blur()


class NotKnownError(Exception):
    """A value is not known in full."""


def plain(value: Value) -> Any:
    """The Python value.

    Raises:
        NotKnownError: If it is not known in full.
    """
    if isinstance(value, Const):
        return value.value
    if isinstance(value, Items) and value.exact:
        return value.kind(plain(item) for item in value.items)
    if isinstance(value, Dict) and value.exact:
        return {key: plain(item) for key, item in value.pairs.items()}
    raise NotKnownError


def wrapped(value: Any) -> Value:
    """A Python value as the validator keeps it."""
    if isinstance(value, (tuple, list)):
        return Items(type(value), [wrapped(item) for item in value])
    return Const(value)


def elements(value: Value, most: int = 400) -> list[Value] | None:
    """The items that a loop over a value goes through; None if they are not known, or too many."""
    if isinstance(value, Items):
        return list(value.items) if value.exact and value.kind is not set else None
    if isinstance(value, Dict):
        return [Const(key) for key in value.pairs] if value.exact else None
    if isinstance(value, Const):
        try:
            if len(value.value) <= most:
                return [wrapped(item) for item in value.value]
        except TypeError:
            return None
    return None


def each_of(value: Value) -> Value:
    """What any item is that a loop over a value goes through."""
    if isinstance(value, Items) and not value.exact:
        return value.each
    if isinstance(value, Instance) and value.type == "pxr.Usd.PrimRange":
        return Instance("pxr.Usd.Prim")
    return UNKNOWN
