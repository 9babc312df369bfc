"""What the reading of a program shares: the index, the problems, the scene, and how sure what is read now is."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from difflib import SequenceMatcher
from typing import Any, Literal

from wsim.program.api.entry import Entry
from wsim.program.api.lookup import Index, rank
from wsim.program.api.vocabulary import vocabulary
from wsim.program.validator.operators import FailsError
from wsim.program.validator.problem import Problems
from wsim.program.validator.scratch import World
from wsim.program.validator.values import UNKNOWN, Function, Scope, Value
from wsim.search.words import split, stem

Flow = Literal["on", "break", "continue", "return", "raise"]  # how statements end

_NEAR = 0.55
# Names of older versions whose new ones are spelt otherwise.
_RENAMED = {
    "math.deg2rad": "math.radians", "math.rad2deg": "math.degrees", "math.arctan2": "math.atan2",
    "math.arctan": "math.atan", "math.arcsin": "math.asin", "math.arccos": "math.acos",
    "numpy.in1d": "numpy.isin", "numpy.trapz": "numpy.trapezoid", "numpy.product": "numpy.prod",
    "numpy.cumproduct": "numpy.cumprod", "numpy.sometrue": "numpy.any", "numpy.alltrue": "numpy.all",
    "numpy.row_stack": "numpy.vstack", "numpy.random.Generator.rand": "numpy.random.Generator.random",
    "numpy.random.Generator.randint": "numpy.random.Generator.integers",
    "numpy.random.Generator.randn": "numpy.random.Generator.standard_normal",
    "numpy.random.Generator.random_sample": "numpy.random.Generator.random",
}  # fmt: skip
_VERBS = {stem(word) for word in ("add", "create", "make", "new", "attr", "set", "get")}
_MOST_STEPS = 6000  # statements that are read, those of loops each time round


class State:
    """Of one reading of one program.

    Attributes:
        index: What programs may use.
        problems: What was found.
        module: The scope of the program's top level.
        scope: The one that is read now.
        world: The scene that `build` is given.
        certain: Whether what is read now runs for sure, whenever the program does.
        own: Whether it runs only when a person runs the program themselves.
        written: All strings in the program.
    """

    def __init__(self, index: Index, tree: ast.Module) -> None:
        self.index, self.tree = index, tree
        self.problems = Problems()
        self.module = self.scope = Scope(assigned(tree.body))
        self.world = World()
        self.aside = World()  # stands for scenes that are not the one that `build` is given
        self.aside.touched()
        self.certain, self.own = True, False
        self.steps = _MOST_STEPS
        self.module_read = False  # whether the top level has been read to its end
        self.depth = 0
        self.branches = 0  # how many tests that are not known stand around what is read now
        self.functions: list[Function] = []
        self.called: set[ast.AST] = set()
        self.returned: list[list[Value]] = []
        # What functions assign for others: at any time it may hold anything.
        told = [n.names for n in ast.walk(tree) if isinstance(n, (ast.Global, ast.Nonlocal))]
        self.shared = frozenset(name for names in told for name in names)
        # Attributes that are set: of a program's own object they may be there, and may change from round to round.
        self.stored = frozenset(
            n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)
        )
        self.rounds = 0  # how many loops of unknown length stand around what is read now
        self.written = [n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)]

    def value(self, node: ast.expr | None) -> Value:
        """What an expression gives; see `Expressions`."""
        raise NotImplementedError

    def block(self, body: list[ast.stmt]) -> Flow:
        """Read statements in order, until one leaves; see `Statements`."""
        raise NotImplementedError

    def bind(self, target: ast.expr, value: Value) -> None:
        """Assign a value to a name, to several, or to a part of something; see `Statements`."""
        raise NotImplementedError

    def tried(self, node: ast.AST, compute: Callable[[], Value]) -> Value:
        """A value that is computed from known ones; a problem where that fails, as it will when the program runs."""
        try:
            return compute()
        except FailsError as error:
            if self.certain:
                self.problems.add(node, "value", f"this fails: {error}")
            return UNKNOWN

    def unit_of(self, name: str) -> str:
        """The unit of what was assigned to a name."""
        holder = self.scope.holder(name)
        return holder.units.get(name, "") if holder is not None else ""

    @contextmanager
    def unsure(self) -> Iterator[None]:
        """Inside, what is read may run or not."""
        before, self.certain = self.certain, False
        try:
            yield
        finally:
            self.certain = before

    def entry(self, name: str) -> Entry | None:
        """What the index has under a whole name."""
        return self.index.programs.find(name)

    def member(self, kind: str, name: str) -> Entry | None:
        """A member of a class, its own or inherited."""
        found = self.entry(f"{kind}.{name}")
        if found is not None:
            return found
        entry = self.entry(kind)
        for base in entry.bases if entry is not None else ():
            found = self.entry(f"{base}.{name}")
            if found is not None:
                return found
        return None

    def members(self, kind: str) -> list[str]:
        """Names of all members of a class or module."""
        entry = self.entry(kind)
        kinds = [kind, *(entry.bases if entry is not None else ())]
        return sorted({name for each in kinds for name in self.index.programs.children(each)})

    def nearest(self, name: str, holder: str) -> str:
        """The member of a class or module that a wrong name means, with its signature; "" if none is near."""
        renamed = _RENAMED.get(f"{holder}.{name}", "")
        if renamed:
            entry = self.entry(renamed)
            return entry.signature if entry is not None else renamed
        names = [each for each in self.members(holder) if not each.startswith("_")]
        best = max(names, key=lambda each: (_nearness(name, each), -len(each)), default="")
        if not best or _nearness(name, best) < _NEAR:
            best = self._taking(name, holder, names)
        entry = self.member(holder, best) if best else None
        if entry is not None:
            return entry.signature
        return "" if holder.startswith("builtins.") else self.elsewhere(name, holder)

    def _taking(self, name: str, holder: str, names: list[str]) -> str:
        """The member of one of wsim's classes that has a parameter of this name."""
        if holder.startswith("wsim."):
            for each in names:
                entry = self.member(holder, each)
                if entry is not None and any(stem(p.name) in _parts(name) for p in entry.parameters):
                    return each
        return ""

    def elsewhere(self, name: str, holder: str = "") -> str:
        """An entry of that very name in another place, within the holder before the rest; "" if there is none."""
        found = [each for each in self.index.programs.ending(name) if each.rpartition(".")[2] == name]
        entry = self.entry(min(found, key=lambda n: (not n.startswith(f"{holder}."), rank(n)))) if found else None
        return entry.signature if entry is not None and entry.kind != "attribute" else ""


def assigned(body: list[Any]) -> frozenset[str]:
    """All names that some statements bind, those in functions and classes within them left out."""
    found: set[str] = set()
    outer: set[str] = set()
    todo: list[ast.AST] = list(body)
    while todo:
        node = todo.pop()
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            found.add(node.name)
            todo += [*node.decorator_list]
            continue
        if isinstance(node, (ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)):
            found |= {n.target.id for n in ast.walk(node) if isinstance(n, ast.NamedExpr)}
            continue
        if isinstance(node, ast.Name) and isinstance(node.ctx, (ast.Store, ast.Del)):
            found.add(node.id)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            found |= {(alias.asname or alias.name.partition(".")[0]) for alias in node.names if alias.name != "*"}
        elif isinstance(node, ast.ExceptHandler) and node.name:
            found.add(node.name)
        elif isinstance(node, (ast.Global, ast.Nonlocal)):
            outer |= set(node.names)
        elif isinstance(node, (ast.MatchAs, ast.MatchStar)) and node.name:
            found.add(node.name)
        elif isinstance(node, ast.MatchMapping) and node.rest:
            found.add(node.rest)
        todo += ast.iter_child_nodes(node)
    return frozenset(found - outer)


def _parts(name: str) -> set[str]:
    """The stemmed words of a name that say what it is about."""
    return {stem(part) for part in split(name)} - _VERBS


def _nearness(name: str, other: str) -> float:
    """How likely one name is meant by another: by its spelling, its words, and words of the same meaning."""
    spelling = SequenceMatcher(None, name.lower(), other.lower()).ratio()
    one, two = _parts(name), _parts(other)
    if not one or not two:
        return spelling
    alike = {word for word in one if word in two or vocabulary().related(word) & two}
    start = 0.15 if other.lower().startswith(name.lower()) else 0.0
    return start + max(spelling, 0.5 * spelling + 0.6 * len(alike) / max(len(one), len(two)))
