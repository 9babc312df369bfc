"""One name that a program may use: what it is, how it is called, what its arguments mean."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Literal

ParameterKind = Literal["positional", "either", "keyword", "*", "**"]
EntryKind = Literal["module", "class", "function", "method", "property", "attribute", "schema", "schema attribute"]


@dataclass(frozen=True)
class Parameter:
    """An argument of a call.

    Attributes:
        name: Its name; "" where the binding gives it none, which it can then not be passed by.
        kind: "positional" only, "either" way, "keyword" only, or the rest of either: "*", "**".
        annotation: Its type as the package writes it; "" if it does not.
        default: As source text; None where it must be given.
        unit: Out of the docstring's brackets, e.g. "kg/m^3"; "" if it states none.
        meaning: Out of the docstring.
    """

    name: str
    kind: ParameterKind = "either"
    annotation: str = ""
    default: str | None = None
    unit: str = ""
    meaning: str = ""

    @property
    def required(self) -> bool:
        """Whether a call without it fails."""
        return self.default is None and self.kind not in ("*", "**")

    def __str__(self) -> str:
        name = self.name or "_"
        if self.kind in ("*", "**"):
            return self.kind + name
        text = f"{name}: {self.annotation}" if self.annotation else name
        if self.default is None:
            return text
        return f"{text} = {self.default}" if self.annotation else f"{text}={self.default}"


@dataclass(frozen=True)
class Entry:
    """What the index knows of one name.

    Attributes:
        name: Its whole name: "wsim.scene.Scene.box".
        kind: What it is.
        source: The package it is of: "wsim", "pxr", "schema", "numpy", "python", "newton", "warp".
        overloads: The parameters of each way to call it; empty where it is not called, or that is not known. A
            method's have no self.
        returns: The whole name of the class that it returns, or that an attribute holds; else its annotation, or "".
        bases: Of a class: the whole names of all it inherits from, nearest first.
        summary: First sentence of its docstring.
        doc: Its docstring.
        deprecated: What to use instead; "" where it is not deprecated.
        programs: Whether programs may use it; newton and warp are listed for people who go lower.
    """

    name: str
    kind: EntryKind
    source: str
    overloads: tuple[tuple[Parameter, ...], ...] = ()
    returns: str = ""
    bases: tuple[str, ...] = ()
    summary: str = ""
    doc: str = ""
    deprecated: str = ""
    programs: bool = True
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def short(self) -> str:
        """The last part of the name."""
        return self.name.rpartition(".")[2]

    @property
    def parent(self) -> str:
        """The name without its last part."""
        return self.name.rpartition(".")[0]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Of the fullest way to call it."""
        return max(self.overloads, key=len, default=())

    @property
    def signature(self) -> str:
        """How it is written, e.g. `Scene.ground(name: str = "ground", *, height: float = 0.0) -> Handle`."""
        name = self._shown()
        if not self.overloads:
            returned = self.returns.rpartition(".")[2]
            return (
                f"{name}: {returned}"
                if self.kind in ("property", "attribute", "schema attribute") and returned
                else name
            )
        arrow = (
            f" -> {self.returns.rpartition('.')[2] if '[' not in self.returns else self.returns}"
            if self.returns
            else ""
        )
        return f"{name}({', '.join(_written(self.parameters))}){arrow}"

    def _shown(self) -> str:
        """The name as a program writes it, with its class and without the package where that says nothing."""
        if self.kind in ("schema", "schema attribute", "module"):
            return self.name
        parts = self.name.split(".")
        if self.source == "wsim":
            return ".".join(part for part in parts[-2:] if not part[0].islower() or part == parts[-1])
        return ".".join(parts[1:]) if self.source == "pxr" else self.name

    def as_data(self) -> dict[str, Any]:
        """Plain data, for the cache; what is empty is left out."""
        data = {key: value for key, value in asdict(self).items() if value not in ("", (), {})}
        data["overloads"] = [[_packed(p) for p in overload] for overload in self.overloads]
        return data

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Entry:
        """The entry that `as_data` was of."""
        overloads = tuple(tuple(Parameter(**p) for p in overload) for overload in data.pop("overloads", ()))
        return cls(**{**data, "overloads": overloads, "bases": tuple(data.get("bases", ()))})


def _packed(parameter: Parameter) -> dict[str, Any]:
    return {key: value for key, value in asdict(parameter).items() if value not in ("", None) or key == "name"}


def _written(parameters: tuple[Parameter, ...]) -> list[str]:
    """The parameters with the marks / and * where a reader needs them."""
    written: list[str] = []
    for i, parameter in enumerate(parameters):
        before = parameters[i - 1].kind if i else None
        if before == "positional" and parameter.kind != "positional" and parameters[i - 1].name:
            written.append("/")
        if parameter.kind == "keyword" and before not in ("keyword", "*"):
            written.append("*")
        written.append(str(parameter))
    return written
