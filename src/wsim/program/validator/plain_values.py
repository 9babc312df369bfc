"""Methods of plain values: `names.append(x)`, `"a".upper()`."""

from __future__ import annotations

from wsim.program.validator import pure
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.state import State
from wsim.program.validator.values import UNKNOWN, Const, Dict, Items, Named, Value, blur, elements


def method(reader: State, called: Named, arguments: Arguments) -> Value:
    """What a method of a plain value gives, and what it does to a list or dictionary."""
    owner, name = called.owner, called.name.rpartition(".")[2]
    if isinstance(owner, Items) and owner.kind is list:
        if name == "append" and len(arguments.given) == 1 and reader.certain and owner.exact:
            owner.items.append(arguments.values[0])
            return Const(None)
        if name == "extend" and len(arguments.given) == 1 and reader.certain and owner.exact:
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
    return reader.tried(arguments.call, lambda: pure.method(owner, name, arguments.values))
