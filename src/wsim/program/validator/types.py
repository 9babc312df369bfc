"""Whether a value can be what a parameter asks for, as far as both are known. Where they are not, it can."""

from __future__ import annotations

import numbers
import re

import numpy as np

from wsim.program.api.lookup import Index
from wsim.program.validator.values import Const, Dict, Function, Instance, Items, Named, Value

_NUMBER = {"float", "int", "double", "unsigned int", "unsigned long", "long", "half", "unsigned char", "GfHalf"}
_TEXT = {"str", "string", "TfToken", "token"}
_SEQUENCE = re.compile(r"^(?:collections\.abc\.)?(?:Sequence|Iterable|list|tuple|Collection)\b")
# Classes of USD's C++ that are the same for Python, with the Python classes that a call takes for them.
_CPP = {
    "UsdPrim": "pxr.Usd.Prim",
    "UsdStage": "pxr.Usd.Stage",
    "SdfPath": "pxr.Sdf.Path",
    "UsdAttribute": "pxr.Usd.Attribute",
    "UsdRelationship": "pxr.Usd.Relationship",
    "UsdShadeMaterial": "pxr.UsdShade.Material",
    "UsdTimeCode": "pxr.Usd.TimeCode",
    "SdfValueTypeName": "pxr.Sdf.ValueTypeName",
}
_FAMILY = re.compile(r"^(?:pxr\.Gf\.|Gf)(Vec[234]|Quat|Matrix[234]|Rotation|Range[123])(?:ernion|[dfhi])?$")
_VECTOR = re.compile(r"^GfVec([234])[dfhi]$")


def type_of(value: Value) -> str:
    """The whole name of a value's class; "" if it is not known."""
    if isinstance(value, Const):
        return class_of(value.value)
    if isinstance(value, Instance):
        return value.type
    if isinstance(value, Items):
        return f"builtins.{value.kind.__name__}"
    if isinstance(value, Dict):
        return "builtins.dict"
    return ""


def class_of(value: object) -> str:
    """The whole name, as the index has it, of the class of a Python value."""
    kind = type(value)
    if kind.__module__.startswith("wsim.scene."):
        return f"wsim.scene.{kind.__qualname__}"
    return f"{kind.__module__}.{kind.__qualname__}"


def fits(value: Value, annotation: str, index: Index) -> bool:
    """Whether a value can be given for a parameter of this annotation, Python's or C++'s."""
    parts = [part.strip() for part in _alternatives(annotation)]
    return any(_fits(value, part, index) for part in parts)


def _alternatives(annotation: str) -> list[str]:
    return annotation.split("|") if "[" not in annotation or annotation.count("|") == 0 else _split(annotation)


def _split(annotation: str) -> list[str]:
    parts, depth = [""], 0
    for c in annotation:
        depth += (c == "[") - (c == "]")
        if c == "|" and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return parts


def _fits(value: Value, wanted: str, index: Index) -> bool:
    kind = type_of(value)
    if isinstance(value, (Function, Named)):
        plain = wanted in _NUMBER | _TEXT or wanted in _CPP or bool(_SEQUENCE.match(wanted))
        known = isinstance(value, Function) or (
            value.name.startswith(("wsim.", "pxr.")) and _is_called(value.name, index)
        )
        return not (plain and known)
    if not kind:
        return True
    if wanted in ("None", "NoneType"):
        return isinstance(value, Const) and value.value is None
    if isinstance(value, Const) and value.value is None:
        return wanted not in {"str", "float", "int", "double", "SdfPath", "string", "TfToken"} and not _SEQUENCE.match(
            wanted
        )
    if wanted in _NUMBER:
        return _may_be_number(value, kind)
    if wanted in _TEXT:
        return kind in ("builtins.str", "pxr.Sdf.Path") if _is_told(kind) else True
    if re.fullmatch(r"\w+::\w+", wanted) and kind.startswith(("pxr.Gf.", "wsim.")):
        return False  # a nested class of USD's, an enumeration mostly
    if _SEQUENCE.match(wanted):
        return _may_be_sequence(value, kind)
    if wanted in _CPP:
        return _may_be_cpp(kind, wanted, index)
    mine, theirs = _FAMILY.match(kind), _FAMILY.match(wanted)
    if mine and theirs:
        return mine[1] == theirs[1]
    if vector := _VECTOR.match(wanted):
        return _may_be_vector(value, kind, int(vector[1]))
    if wanted in ("Handle", "Material", "Tank", "Fluid", "Track", "Drive", "Part", "Vehicle", "Terrain"):
        return _may_be_scene(kind, wanted, index)
    return True


def _is_called(name: str, index: Index) -> bool:
    entry = index.programs.find(name)
    return entry is not None and entry.kind in ("class", "function", "method", "module")


def _is_told(kind: str) -> bool:
    """Whether all is known of how objects of a class behave as arguments."""
    return kind.startswith(("builtins.", "wsim.scene.", "pxr."))


def _may_be_number(value: Value, kind: str) -> bool:
    if isinstance(value, Const):
        return isinstance(value.value, (numbers.Number, np.ndarray, np.generic))
    return not (isinstance(value, (Items, Dict)) or kind.startswith(("wsim.", "pxr.Usd")) or kind == "builtins.str")


def _may_be_sequence(value: Value, kind: str) -> bool:
    if isinstance(value, Const):
        return not isinstance(value.value, (numbers.Number, str)) and not kind.startswith("wsim.scene.")
    plain = kind in ("builtins.float", "builtins.int", "builtins.bool", "builtins.str")
    return not (plain or isinstance(value, Dict) or kind.startswith(("wsim.", "pxr.Usd")))


def _may_be_cpp(kind: str, wanted: str, index: Index) -> bool:
    if wanted == "SdfPath" and kind == "builtins.str":
        return True
    if wanted == "UsdTimeCode":
        return kind in ("builtins.int", "builtins.float", "builtins.bool") or not kind.startswith("builtins.")
    if kind.startswith(("builtins.", "wsim.", "numpy.")):
        return False
    if kind.startswith("pxr."):
        return kind == _CPP[wanted] or _inherits(kind, _CPP[wanted], index) or _inherits(_CPP[wanted], kind, index)
    return True


def _may_be_vector(value: Value, kind: str, count: int) -> bool:
    if isinstance(value, Items):
        return not value.exact or len(value.items) == count
    if isinstance(value, Const):
        return not isinstance(value.value, (numbers.Number, str)) and not kind.startswith("wsim.")
    return not kind.startswith(("wsim.", "pxr.Usd"))


def _may_be_scene(kind: str, wanted: str, index: Index) -> bool:
    if wanted == "Handle" and kind in ("pxr.Usd.Prim", "pxr.Sdf.Path"):
        return True
    if not _is_told(kind):
        return True
    # What is typed as a mere handle may be any of them.
    whole = f"wsim.scene.{wanted}"
    return (
        kind == whole
        or _inherits(kind, whole, index)
        or (wanted not in ("Drive", "Part") and kind == "wsim.scene.Handle")
    )


def _inherits(kind: str, base: str, index: Index) -> bool:
    entry = index.programs.find(kind)
    return entry is not None and base in entry.bases
