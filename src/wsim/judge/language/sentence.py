"""Formulas as sentences: `always[2, 5](upright(tower, 10 deg)) and floats(block, water)`, printed and read back."""

from __future__ import annotations

import functools
import re
from typing import Any

from lark import Lark, Token, Transformer, UnexpectedInput, v_args
from lark.exceptions import VisitError
from pydantic import TypeAdapter, ValidationError

from wsim.plan.schema import formula_fluid
from wsim.plan.schema.formula import (
    VOCABULARY,
    Always,
    And,
    Eventually,
    Finally,
    Formula,
    Mean,
    Not,
    Or,
    Ordered,
    Predicate,
    Then,
    Until,
)

LONGEST = 20_000  # characters of a sentence
# How many of its base unit each unit is.
UNITS = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3},
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "deg": {"deg": 1.0, "rad": 57.29577951308232},
    "m/s": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3, "km/h": 1 / 3.6},
    "deg/s": {"deg/s": 1.0, "rad/s": 57.29577951308232, "rev/s": 360.0},
    "1": {"": 1.0, "%": 1e-2},
}

GRAMMAR = r"""
?start: formula
?formula: either
    | either "until" window? either -> until
    | either ("then" window? either)+ -> then
?either: both ("or" both)*
?both: simple ("and" simple)*
?simple: "not" simple -> negated
    | "(" formula ")"
    | "always" window? "(" formula ")" -> always
    | "eventually" window? "(" formula ")" -> eventually
    | "finally" ["[" number "]"] "(" formula ")" -> at_the_end
    | "mean" ("[" number "]" | window)? "(" formula ")" -> mean
    | "ordered" "(" formula ("," formula)+ ")" -> ordered
    | NAME "(" argument ("," argument)* ")" -> predicate
window: "[" number "," (number | "end") "]"
argument: value | NAME "="? value -> keyword
?value: number | name | point | "[" point ("," point)* "]" -> path | "[" name ("," name)* "]" -> names
point: "(" number "," number "," number ")"
name: NAME | QUOTED
number: NUMBER UNIT?
NAME: /[A-Za-z_][A-Za-z0-9_]*/
QUOTED: /"[^"\n]*"/
NUMBER: /[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?/
UNIT: /%|[a-z]+(\/[a-z]+)?/
%ignore /\s+/
"""
RESERVED = frozenset(("and", "or", "not", "until", "then", "always", "eventually", "finally", "mean", "ordered", "end"))


def parse(text: str) -> Formula:
    """Read a sentence.

    Raises:
        ValueError: It is not one, with the place and what could stand there; or a predicate, field or unit is unknown.
    """
    if len(text) > LONGEST:
        raise ValueError(f"an objective of {len(text)} characters; the longest has {LONGEST}. Split it in several")
    try:
        return _grammar().parse(text)  # type: ignore[return-value]
    except VisitError as error:
        raise _plain(error.orig_exc) from error
    except ValidationError as error:
        raise _plain(error) from error
    except UnexpectedInput as error:
        where = text[max(0, error.pos_in_stream - 20) : error.pos_in_stream] if error.pos_in_stream else ""
        shown = f"after {where!r}" if where else "at its start"
        raise ValueError(f"{text[:80]!r} is no objective: {shown}, character {error.column}, {_said(error)}") from error


_TOKENS = {"$END": "its end", "LPAR": "(", "RPAR": ")", "LSQB": "[", "RSQB": "]", "COMMA": "a comma", "EQUAL": "="}


def _said(error: UnexpectedInput) -> str:
    found = getattr(error, "token", None)
    what = "it ends" if found is not None and found.type == "$END" else "this does not go on"
    wanted = sorted(getattr(error, "accepts", None) or getattr(error, "allowed", None) or ())
    words = [_TOKENS.get(name, name.lower()) for name in wanted]
    return f"{what}; here may stand {', '.join(words)}" if words else what


def _plain(error: Exception) -> Exception:
    if isinstance(error, ValidationError):
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        return ValueError(f"{where}: {first['msg']}" if where else first["msg"])
    return error


@functools.cache
def _grammar() -> Lark:
    # Built bottom-up while it is read, so that no nesting, however deep, exhausts the stack.
    return Lark(GRAMMAR, parser="lalr", transformer=_Build(), maybe_placeholders=True)


class _Number(float):
    """A number with the unit that was written behind it."""

    unit = ""

    @classmethod
    def of(cls, text: str, unit: str) -> _Number:
        number = cls(text)
        number.unit = str(unit)
        return number

    def into(self, unit: str, field: str) -> float:
        """The number in a base unit; ValueError."""
        known = UNITS[unit]
        if self.unit and self.unit not in known:
            raise ValueError(f"{field} is in {' or '.join(filter(None, known))}, not {str(self.unit)!r}")
        return float(self) * known[self.unit] if self.unit else float(self)


@v_args(inline=True)
class _Build(Transformer[Token, Any]):
    """Turns what was read into nodes, from the leaves up."""

    def number(self, digits: Token, unit: Token | None = None) -> _Number:
        return _Number.of(digits, unit or "")

    def name(self, text: Token) -> str:
        return text[1:-1] if text.type == "QUOTED" else str(text)

    def point(self, *numbers: _Number) -> tuple[float, ...]:
        return tuple(number.into("m", "a point") for number in numbers)

    def path(self, *points: tuple[float, ...]) -> list[tuple[float, ...]]:
        return list(points)

    def names(self, *names: str) -> tuple[str, ...]:
        return names

    def window(self, start: _Number, end: _Number | None = None) -> tuple[float, float | None]:
        return start.into("s", "a window"), None if end is None else end.into("s", "a window")

    def argument(self, value: Any) -> tuple[None, Any]:
        return None, value

    def keyword(self, key: Token, value: Any) -> tuple[str, Any]:
        return str(key), value

    def predicate(self, op: Token, *arguments: tuple[str | None, Any]) -> Predicate:
        kind = VOCABULARY.get(op)
        if kind is None:
            raise ValueError(f"no predicate {str(op)!r}; there are {', '.join(VOCABULARY)}")
        each = [
            (key, one)
            for key, value in arguments
            for one in (value if key is None and _listed(value) and "objects" in kind.model_fields else [value])
        ]
        return kind.model_validate(bind(kind, tuple(each)))

    def ordered(self, *events: Formula) -> Ordered:
        return Ordered(events=events)

    def both(self, *parts: Formula) -> And:
        return And(of=parts)

    def either(self, *parts: Formula) -> Or:
        return Or(of=parts)

    def negated(self, part: Formula) -> Not:
        return Not(of=part)

    def always(self, *parts: Any) -> Always:
        return Always(window=parts[0] if len(parts) > 1 else None, of=parts[-1])

    def eventually(self, *parts: Any) -> Eventually:
        return Eventually(window=parts[0] if len(parts) > 1 else None, of=parts[-1])

    def at_the_end(self, seconds: _Number | None, part: Formula) -> Finally:
        return Finally(seconds=None if seconds is None else seconds.into("s", "finally"), of=part)

    def mean(self, *parts: Any) -> Mean:
        over = parts[0] if len(parts) > 1 else None
        if isinstance(over, tuple):
            return Mean(window=over, of=parts[-1])
        return Mean(seconds=None if over is None else over.into("s", "mean"), of=parts[-1])

    def until(self, hold: Formula, *rest: Any) -> Until:
        return Until(hold=hold, window=rest[0] if len(rest) > 1 else None, goal=rest[-1])

    def then(self, first: Formula, *rest: Any) -> Then:
        events, windows = [first], []
        window = None
        for part in rest:
            if isinstance(part, tuple):
                window = part
            elif part is not None:
                events.append(part)
                windows.append(window)
                window = None
        return Then(events=tuple(events), windows=tuple(windows))


def _listed(value: Any) -> bool:
    return isinstance(value, tuple) and isinstance(value[0], str)


def bind(kind: type[Predicate], arguments: tuple[tuple[str | None, Any], ...]) -> dict[str, Any]:
    """Fields of a predicate from arguments (name or None, value): numbers fill its numbers in order, the rest the rest.

    Raises:
        ValueError: There is no such field, it is given twice, there are too many, or a unit does not fit.
    """
    fields = [name for name in kind.model_fields if name != "op"]
    numbers = {name: unit for name in fields if (unit := unit_of(kind, name))}
    others = [name for name in fields if name not in numbers]
    bound: dict[str, Any] = {}
    for key, value in arguments:
        numeric = isinstance(value, (int, float))
        free = [name for name in (numbers if numeric else others) if name not in bound]
        if key is None and not numeric and "objects" in others and not set(others) - {"objects"} - set(bound):
            bound["objects"] = (*bound.get("objects", ()), value)
            continue
        field = key or (free[0] if free else None)
        op = kind.model_fields["op"].default
        if field is None or field not in fields:
            named = f"no {field!r}" if field else "no place for another " + ("number" if numeric else "name")
            raise ValueError(f"{op} has {named}; it has {', '.join(fields)}")
        if field in bound:
            raise ValueError(f"{op}: {field} is given twice")
        if field == "axis" and isinstance(value, str):
            value = value.lower()  # a joint's is written X, Y or Z
        bound[field] = value.into(numbers[field], field) if isinstance(value, _Number) and field in numbers else value
    return bound


def unit_of(kind: type[Predicate], field: str) -> str:
    """The unit of a predicate's number; empty for what is none."""
    extra = kind.model_fields[field].json_schema_extra
    return str(extra["unit"]) if isinstance(extra, dict) and "unit" in extra else ""


def vocabulary(fluids: bool) -> str:
    """Predicates as they are written, with what may be left out in brackets, and what each says: a line each.

    Args:
        fluids: Those about fluids, or all others.
    """
    lines = []
    for op, kind in VOCABULARY.items():
        if (kind.__module__ == formula_fluid.__name__) != fluids:
            continue
        fields = []
        for name, field in kind.model_fields.items():
            if name != "op":
                unit = unit_of(kind, name)
                said = name if unit in ("", "1") else f"{name} {unit}"
                fields.append(said if field.is_required() else f"[{said}]")
        first = str(kind.__doc__).splitlines()[0]
        lines.append(f"{op}({', '.join(fields)}): {first}")
    return "\n".join(lines)


# ---- printing
def sentence(formula: Formula) -> str:
    """A formula as `parse` reads it; parentheses only where the tree needs them."""
    if isinstance(formula, (Until, Then)):
        return _in_time(formula)
    if isinstance(formula, Or):
        return " or ".join(_within(part, (Until, Then, Or)) for part in formula.of)
    if isinstance(formula, And):
        return " and ".join(_within(part, (Until, Then, Or, And)) for part in formula.of)
    if isinstance(formula, Not):
        return "not " + _within(formula.of, (Until, Then, Or, And))
    if isinstance(formula, (Always, Eventually)):
        return f"{formula.op}{_window(formula.window)}({sentence(formula.of)})"
    if isinstance(formula, Mean) and formula.window is not None:
        return f"mean{_window(formula.window)}({sentence(formula.of)})"
    if isinstance(formula, (Finally, Mean)):
        seconds = "" if formula.seconds is None else f"[{_digits(formula.seconds)}]"
        return f"{formula.op}{seconds}({sentence(formula.of)})"
    if isinstance(formula, Ordered):
        return f"ordered({', '.join(sentence(event) for event in formula.events)})"
    assert isinstance(formula, Predicate)  # the one kind of node that is left
    return f"{formula.op}({', '.join(_arguments(formula))})"


def _within(part: Formula, looser: tuple[type, ...]) -> str:
    return f"({sentence(part)})" if isinstance(part, looser) else sentence(part)


def _in_time(formula: Until | Then) -> str:
    if isinstance(formula, Until):
        hold, goal = (_within(part, (Until, Then)) for part in (formula.hold, formula.goal))
        return f"{hold} until{_window(formula.window)} {goal}"
    said = _within(formula.events[0], (Until, Then))
    for event, window in zip(formula.events[1:], formula.windows, strict=True):
        said += f" then{_window(window)} {_within(event, (Until, Then))}"
    return said


def _arguments(predicate: Predicate) -> list[str]:
    said = []
    for name, field in type(predicate).model_fields.items():
        value = getattr(predicate, name)
        if name == "op" or (value == field.default and not field.is_required()):
            continue
        unit = unit_of(type(predicate), name)
        if unit:
            said.append(f"{name} {_digits(value)}" + ("" if unit == "1" else f" {unit}"))
        elif name == "path":
            said.append(f"[{', '.join(_place(point) for point in value)}]")
        elif name == "objects":
            said += [_place(item) for item in value]
        else:
            said.append(_place(value))
    return said


def _place(value: str | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_digits(number) for number in value)})"
    return value if re.fullmatch(r"[A-Za-z_]\w*", value) and value not in RESERVED else f'"{value}"'


def _window(window: tuple[float, float | None] | None) -> str:
    if window is None:
        return ""
    return f"[{_digits(window[0])}, {'end' if window[1] is None else _digits(window[1])}]"


def _digits(number: float) -> str:
    return str(int(number)) if number == int(number) and abs(number) < 1e15 else repr(float(number))


def from_json(tree: str | dict[str, Any]) -> Formula:
    """A formula from its JSON form; pydantic's ValidationError."""
    adapter: TypeAdapter[Formula] = TypeAdapter(Formula)
    return adapter.validate_json(tree) if isinstance(tree, str) else adapter.validate_python(tree)
