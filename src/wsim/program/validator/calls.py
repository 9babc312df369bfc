"""Calls: whether their arguments fit, and what they return."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

import numpy as np

from wsim.program.api.entry import Entry
from wsim.program.validator import constants, imports, units, usd
from wsim.program.validator.arguments import Arguments, Misfit, misfit
from wsim.program.validator.attributes import Attributes
from wsim.program.validator.scratch import BODIES, JOINTS
from wsim.program.validator.types import fits, type_of
from wsim.program.validator.values import (
    UNKNOWN,
    Class,
    Const,
    Dict,
    Function,
    Instance,
    Items,
    Named,
    NotKnownError,
    Value,
    blur,
    elements,
    plain,
)
from wsim.scene import Drive

_SCENE = "wsim.scene.Scene."
_TURNS = {f"{module}.{name}" for module in ("math", "numpy") for name in ("sin", "cos", "tan")}
_WRITES = {"w", "a", "x", "+"}


class Calls(Attributes):
    """Reads `function(arguments)`."""

    def call(self, called: Value, arguments: Arguments) -> Value:
        """What a call returns."""
        if isinstance(called, Function):
            return self.run(called, arguments)
        if isinstance(called, Class):
            return self.construct(called, arguments)
        if not isinstance(called, Named):
            self._hand_over(arguments)
            plain_value = isinstance(called, Instance) and called.type.startswith("builtins.")
            if (plain_value or isinstance(called, (Const, Items, Dict))) and self.certain and not _callable(called):
                self.problems.add(arguments.call, "attribute", "this is no function; it cannot be called")
            return UNKNOWN
        entry = self.entry(called.name)
        if entry is None or entry.kind not in ("class", "function", "method"):
            return self._unlisted(called, arguments)
        self._check_program(entry, arguments)
        wrong = self._misfit(entry, called, arguments)
        if wrong is not None:
            self.problems.add(wrong.node, "argument", wrong.message, entry.signature)
        elif entry.deprecated:
            self.problems.add(arguments.call, "deprecated", f"{entry.short} is deprecated: {entry.deprecated}")
        return self._result(entry, called, arguments, fitting=wrong is None)

    def construct(self, kind: Class, arguments: Arguments) -> Value:
        """The object that a call of a program's own class makes; see `Objects`."""
        raise NotImplementedError

    def _misfit(self, entry: Entry, called: Named, arguments: Arguments) -> Misfit | None:
        def may_be(value: Value, annotation: str) -> bool:
            return fits(value, annotation, self.index)

        if entry.kind != "method" or called.owner is not None or entry.extra.get("static"):
            return misfit(arguments, entry, may_be)
        if entry.source not in ("wsim", "pxr") or arguments.open:
            return None
        # Called on its class: what it is a method of is the first argument.
        kind = entry.parent.rpartition(".")[2]
        first = type_of(arguments.values[0]) if arguments.given else "builtins.NoneType"
        base = self.entry(first)
        if first.startswith(("builtins.", "wsim.")) and first != entry.parent and not _inherits(base, entry.parent):
            text = f"{entry.short}() is called on the class {kind}; call it on an object: {kind}(...).{entry.short}()"
            return Misfit(arguments.call, text)
        rest = Arguments(arguments.call, arguments.given[1:], arguments.named)
        return misfit(rest, entry, may_be)

    def tried(self, node: ast.AST, compute: Callable[[], Value]) -> Value:
        """A value that is computed from known ones; a problem where that fails, as it will when the program runs."""
        try:
            return compute()
        except constants.FailsError as error:
            if self.certain:
                self.problems.add(node, "value", f"this fails: {error}")
            return UNKNOWN

    def run(self, function: Function, arguments: Arguments) -> Value:
        """What a function of the program returns; see `Functions`."""
        raise NotImplementedError

    def _result(self, entry: Entry, called: Named, arguments: Arguments, *, fitting: bool) -> Value:
        bound = arguments.bound(entry.parameters) if entry.overloads else dict(arguments.named)
        self._check_units(entry, bound)
        if entry.name.startswith(_SCENE):
            return self._on_scene(entry, called.owner, bound, arguments, fitting=fitting)
        if entry.source == "pxr" and fitting:
            usd.check(self, entry, called.owner, bound, arguments)
            path = usd.path_of(self, entry, called.owner, bound, arguments)
            if path and entry.returns == "pxr.Sdf.Path":
                return constants.pure("pxr.Sdf.Path", [Const(path)], {})
            if path:
                made = self._returned(entry, called)
                return replace(made, path=path) if isinstance(made, Instance) else made
        if entry.name.startswith("wsim.program.control_world.ControlWorld.") and fitting:
            self._on_control(entry, called.owner, bound)
        if entry.source == "numpy" and "dtype" in bound:
            self._dtype(*bound["dtype"])
        if called.owner is not None and isinstance(called.owner, (Const, Items, Dict)):
            return self._on_value(called, arguments)
        if entry.name == "wsim.scene.Drive" and fitting:
            return _drive(bound) if not arguments.open else Instance(entry.name)
        if entry.name == "builtins.open":
            self._opens(arguments)
        if not arguments.open and fitting:
            named = {key: value for key, (value, _) in arguments.named.items()}
            found = self.tried(arguments.call, lambda: constants.pure(entry.name, arguments.values, named))
            if found is not UNKNOWN:
                return found
        self._hand_over(arguments)
        several = bound.get("size", (Const(None), None))[0] not in (Const(None), UNKNOWN)
        if entry.parent == "numpy.random.Generator" and several and entry.short not in ("choice", "integers"):
            return Instance("numpy.ndarray")
        return self._returned(entry, called)

    def _returned(self, entry: Entry, called: Named) -> Value:
        world = called.owner.world if isinstance(called.owner, Instance) else None
        if entry.kind == "class":
            return Instance(entry.name) if entry.source in ("wsim", "pxr") else UNKNOWN
        returns = entry.returns
        if returns.startswith("list["):
            return Items(list, [], exact=False, each=Instance(returns[5:-1]))
        if entry.name == "pxr.Usd.Stage.Traverse":
            return Items(list, [], exact=False, each=Instance("pxr.Usd.Prim"))
        found = self.entry(returns) if returns else None
        if found is None or found.kind != "class" or found.source not in ("wsim", "pxr", "numpy"):
            return UNKNOWN
        return Instance(returns, world if returns.startswith("wsim.program.") else None)

    # -- wsim's own ----------------------------------------------------------------------------------------------

    def _on_scene(
        self, entry: Entry, owner: Value | None, bound: dict[str, Any], arguments: Arguments, *, fitting: bool
    ) -> Value:
        """A call that authors the scene."""
        method = entry.short
        world = owner.world if isinstance(owner, Instance) else None
        values: dict[str, Value] = {name: value for name, (value, _) in bound.items()}
        typed = self._returned(entry, Named(entry.name))
        mine = world if world is not None else self.aside
        certain = self.certain and world is not None and not arguments.open
        name = values.get("name", UNKNOWN)
        if not entry.overloads or not fitting or method == "save":
            mine.note(method, getattr(name, "value", None), certain=certain and method != "save")
            mine.touched()
            return typed
        if method == "ground" and "name" not in values:
            values["name"] = name = Const("ground")
        text = name.value if isinstance(name, Const) and isinstance(name.value, str) else None
        if text is not None and certain and mine.taken(method, text):
            node = bound["name"][1] if "name" in bound else arguments.call
            self.problems.add(node, "prim", f'the name "{text}" is already used; give each prim a name of its own')
            mine.touched()
            return typed
        if certain and world is not None and world.trusted and self._refers_wrongly(world, bound):
            mine.note(method, text, certain=True)
            mine.touched()
            return typed
        if text is not None:
            mine.places.setdefault(text, bound["name"][1] if "name" in bound else arguments.call)
        if world is not None and not world.trusted:
            self._lacks_material(world, bound)
        made, refusal, field = mine.call(method, values, certain=certain)
        if refusal:
            node = bound[field][1] if field in bound else arguments.call
            self.problems.add(node, "value", f"{method}(): {refusal.partition(': ')[2]}", entry.signature)
        if method == "param" and made is None:
            default = values.get("default", UNKNOWN)
            number = isinstance(default, Const) and isinstance(default.value, (int, float))
            return Const(float(default.value)) if number and isinstance(default, Const) else Instance("builtins.float")
        if method == "simulation":
            self._gravity(bound)
            return Const(None)
        return made if made is not None else typed

    def _refers_wrongly(self, world: Any, bound: dict[str, Any]) -> bool:
        """Whether an argument names a prim that is not there yet."""
        if world.open or world.others:
            return False
        for field in ("parent", "child", "fills", "container"):
            value, node = bound.get(field, (UNKNOWN, None))
            text = value.value if isinstance(value, Const) else None
            if not isinstance(text, str):
                continue
            name = text.removeprefix("/World/")
            if "/" in name or name in world.names:
                continue
            later = self.written.count(name) > 1
            why = "is made only later" if later else "is not in the scene"
            self.problems.add(
                node, "order" if later else "prim", f'{field} = "{text}" {why}', _spelt(name, world.names)
            )
            return True
        return False

    def _lacks_material(self, world: Any, bound: dict[str, Any]) -> None:
        """Whether a material is asked for that nothing makes; each object has one of its own name, too."""
        value, node = bound.get("material", (UNKNOWN, None))
        text = value.value if isinstance(value, Const) else None
        if not isinstance(text, str) or world.looks_open or text in world.names or text in world.others:
            return
        known = [name.partition(" ")[2] for name in world.looks if name.startswith("material ")]
        if text not in known:
            self.problems.add(node, "prim", f'material = "{text}" is not in the scene', _spelt(text, known))

    def _gravity(self, bound: dict[str, Any]) -> None:
        value, node = bound.get("gravity", (UNKNOWN, None))
        if isinstance(value, Items) and value.exact and len(value.items) == 3:
            up = value.items[2]
            if isinstance(up, Const) and isinstance(up.value, (int, float)) and up.value > 0:
                self.problems.add(
                    node, "value", f"gravity points up: z = {up.value:g} m/s^2; down is (0.0, 0.0, -9.81)"
                )

    def _on_control(self, entry: Entry, owner: Value | None, bound: dict[str, Any]) -> None:
        """A name that `control` asks for, and the vectors that it gives."""
        for field in ("force", "torque"):
            vector, place = bound.get(field, (UNKNOWN, None))
            if isinstance(vector, Items) and vector.exact and len(vector.items) != 3 and _are_numbers(vector):
                text = f'"{field}" has {len(vector.items)} numbers; it must be 3: (x, y, z)'
                self.problems.add(place, "value", text, entry.signature)
        world = owner.world if isinstance(owner, Instance) else None
        value, node = bound.get("name", (UNKNOWN, None))
        if world is None or world.open or world.others or not isinstance(value, Const):
            return
        if not isinstance(value.value, str) or "asset" in world.names.values():
            return
        wanted = JOINTS if entry.short == "joint" else BODIES
        known = {name for name, method in world.names.items() if method in wanted}
        name = value.value.removeprefix("/World/")
        if name not in known:
            what = "joint" if entry.short == "joint" else "body"
            self.problems.add(node, "prim", f'no {what} "{value.value}" is built', _spelt(name, known))

    # -- the rest ------------------------------------------------------------------------------------------------

    def _check_program(self, entry: Entry, arguments: Arguments) -> None:
        why = imports.refused_call(entry.name)
        if why and not self.own:
            self.problems.add(arguments.call, "import", f"{entry.name}(): {why}")

    def _check_units(self, entry: Entry, bound: dict[str, Any]) -> None:
        if entry.name in _TURNS and bound:
            _, node = next(iter(bound.values()))
            if units.said(node, self.unit_of) == "deg":
                self.problems.add(
                    node, "unit", f"{entry.name}() takes radians, and is given degrees; convert with math.radians"
                )
            return
        if not entry.name.startswith("wsim."):
            return
        for parameter in entry.parameters:
            if parameter.name not in bound or not parameter.unit:
                continue
            _, node = bound[parameter.name]
            degrees = parameter.unit in ("deg", "deg/s")
            for part in node.elts if isinstance(node, (ast.Tuple, ast.List)) else [node]:
                told = units.said(part, self.unit_of)
                strict = parameter.name.endswith("_deg") or parameter.name == "fov"
                if degrees and (told == "rad" or (strict and not told and units.of_pi(part))):
                    text = f'"{parameter.name}" of {entry.short}() is in {parameter.unit}, and is given radians'
                    self.problems.add(part, "unit", f"{text}; convert with math.degrees", entry.signature)
                elif parameter.unit in ("rad", "rad/s") and told == "deg":
                    text = f'"{parameter.name}" of {entry.short}() is in {parameter.unit}, and is given degrees'
                    self.problems.add(part, "unit", f"{text}; convert with math.radians", entry.signature)

    def unit_of(self, name: str) -> str:
        """The unit of what was assigned to a name."""
        holder = self.scope.holder(name)
        return holder.units.get(name, "") if holder is not None else ""

    def _dtype(self, value: Value, node: ast.AST) -> None:
        """The name of a type of numbers."""
        if isinstance(value, Const) and isinstance(value.value, str):
            try:
                np.dtype(value.value)
            except TypeError:
                self.problems.add(node, "value", f'NumPy has no type "{value.value}"')

    def _opens(self, arguments: Arguments) -> None:
        """`open(path, "w")` on a path that is not the program's own."""
        mode = arguments.values[1] if len(arguments.given) > 1 else arguments.named.get("mode", (UNKNOWN, None))[0]
        path = arguments.values[0] if arguments.given else arguments.named.get("file", (UNKNOWN, None))[0]
        if not (isinstance(mode, Const) and isinstance(path, Const) and isinstance(path.value, str)):
            return
        if isinstance(mode.value, str) and _WRITES & set(mode.value):
            self.outside(path.value, arguments.call)

    def outside(self, path: str, node: ast.AST) -> None:
        """Note a file that would be written outside the run's folder."""
        if (path.startswith(("/", "~")) or ".." in path.split("/")) and not self.own:
            self.problems.add(node, "import", f'writes "{path}": a program writes no files outside its run folder')

    def _on_value(self, called: Named, arguments: Arguments) -> Value:
        """A method of a plain value: `names.append(x)`, `"a".upper()`."""
        owner, name = called.owner, called.name.rpartition(".")[2]
        if isinstance(owner, Items) and owner.kind is list:
            if name == "append" and len(arguments.given) == 1 and self.certain and owner.exact:
                owner.items.append(arguments.values[0])
                return Const(None)
            if name == "extend" and len(arguments.given) == 1 and self.certain and owner.exact:
                more = elements(arguments.values[0])
                if more is not None:
                    owner.items.extend(more)
                    return Const(None)
            if name not in ("index", "count", "copy"):
                blur(owner)
            return UNKNOWN
        if isinstance(owner, Dict):
            if name == "items" and owner.exact:
                return Items(list, [Items(tuple, [Const(key), value]) for key, value in owner.pairs.items()])
            if name == "values" and owner.exact:
                return Items(list, list(owner.pairs.values()))
            if name == "keys" and owner.exact:
                return Items(list, [Const(key) for key in owner.pairs])
            if name == "get" and owner.exact and arguments.given and isinstance(arguments.values[0], Const):
                default = arguments.values[1] if len(arguments.given) > 1 else Const(None)
                return owner.pairs.get(arguments.values[0].value, default)
            if name not in ("get", "copy"):
                blur(owner)
            return UNKNOWN
        if owner is None or arguments.named or arguments.open:
            return UNKNOWN
        return self.tried(arguments.call, lambda: constants.method(owner, name, arguments.values))

    def _unlisted(self, called: Named, arguments: Arguments) -> Value:
        if isinstance(called.owner, (Const, Items, Dict)):
            return self._on_value(called, arguments)
        self._hand_over(arguments)
        return UNKNOWN

    def _hand_over(self, arguments: Arguments) -> None:
        """What is handed to code that is not read here may be changed by it."""
        for value in (*arguments.values, *(value for value, _ in arguments.named.values())):
            blur(value)
            if isinstance(value, Instance) and value.world is not None:
                value.world.touched()
                value.world.open = True


def _inherits(entry: Entry | None, base: str) -> bool:
    return entry is not None and base in entry.bases


def _callable(value: Value) -> bool:
    return isinstance(value, Const) and callable(value.value)


def _drive(bound: dict[str, Any]) -> Value:
    """A motor of the validator's own, if all is known of it."""
    try:
        return Const(Drive(**{name: plain(value) for name, (value, _) in bound.items()}))
    except (NotKnownError, TypeError):
        return Instance("wsim.scene.Drive")


def _are_numbers(items: Items) -> bool:
    return all(isinstance(each, Const) and isinstance(each.value, (int, float)) for each in items.items)


def _spelt(name: str, known: Any) -> str:
    close = get_close_matches(name, list(known), n=1, cutoff=0.5)
    return f'"{close[0]}"' if close else ""
