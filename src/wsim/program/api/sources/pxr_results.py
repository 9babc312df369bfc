"""What USD's calls return: harmless ones are called on a stage in memory, in a process of their own, and looked at."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from typing import Any

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade

from wsim.program.api.sources.pxr_overloads import is_binding, overloads

_SECONDS = 60.0
# What only looks, or adds to the stage in memory.
_HARMLESS = re.compile(
    r"^(Get|Create|Define|Apply|Add|Compute|Extract|Append|Make|Find|Override|Bind|Transform|Remove(?:Scale)|Project"
    r"|Orthonormalize|Interpolate|Decompose|Load(?:All|None)$)"
)
# What writes files, or returns whatever a field holds.
_LEFT_OUT = re.compile(
    r"New|Export|Save|Open|Metadata|Value|Field|Info|CustomData|ByKey|Reload|Validat|^Get$|^GetProp|^GetObject"
)


class NotLookedError(Exception):
    """The process that looks at the calls did not end well, and nothing is known of what they return."""


def results() -> dict[str, str]:
    """Whole name of a function or method: whole name of the class that it returns.

    Raises:
        NotLookedError: If the process that calls them was killed, took too long, or said nothing.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", "from wsim.program.api.sources.pxr_results import _main; _main()"],
            capture_output=True,
            timeout=_SECONDS,
            check=True,
            text=True,
        )
        found: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    except (OSError, subprocess.SubprocessError, ValueError, IndexError) as error:
        raise NotLookedError(f"{type(error).__name__}: {error}") from error
    return found


def _main() -> None:
    sys.stdout.write("\n" + json.dumps(_Looker().look()) + "\n")


class _Looker:
    """Calls what it can with what it has; what comes out is one more thing to call with."""

    def __init__(self) -> None:
        stage = Usd.Stage.CreateInMemory()
        cube = UsdGeom.Cube.Define(stage, "/World/sample")
        UsdGeom.Xform.Define(stage, "/World/sample/child")
        self.by_cpp: dict[str, Any] = {
            "UsdStage": stage, "UsdPrim": cube.GetPrim(), "SdfPath": Sdf.Path("/World/sample"), "TfToken": "sample",
            "string": "sample", "double": 0.5, "float": 0.5, "int": 1, "unsigned long": 1, "bool": True,
            "UsdTimeCode": Usd.TimeCode.Default(), "SdfValueTypeName": Sdf.ValueTypeNames.Double,
            "SdfLayer": stage.GetRootLayer(), "unsigned int": 1,
        }  # fmt: skip
        for key in dir(Gf):
            kind = getattr(Gf, key)
            if isinstance(kind, type):
                try:
                    self.by_cpp[f"Gf{key}"] = kind(1) if key.startswith(("Matrix", "Quat")) else kind()
                except Exception:  # noqa: BLE001 - what cannot be made plainly is left out
                    continue
        self.cube = cube
        self.made = 0
        self.found: dict[str, set[str]] = {}

    def look(self) -> dict[str, str]:
        schemas = [UsdGeom, UsdPhysics, UsdShade, UsdLux]
        for module in (Usd, Sdf, Gf, *schemas):
            for key, value in sorted(vars(module).items()):
                if isinstance(value, type) and not key.startswith("_"):
                    self._look_at(value)
                elif is_binding(value) and module in (Gf, UsdGeom, UsdShade):
                    self._call(f"{module.__name__}.{key}", value, None)
        return {name: kinds.pop() for name, kinds in self.found.items() if len(kinds) == 1 and kinds != {""}}

    def _look_at(self, kind: type) -> None:
        for key, member in sorted(vars(kind).items()):
            function = member.__func__ if isinstance(member, staticmethod) else member
            if not is_binding(function):
                continue
            pure = kind.__module__ == "pxr.Gf" and not key.startswith(("_", "Set"))
            if not pure and not (_HARMLESS.search(key) and not _LEFT_OUT.search(key)) and not self._makes(kind, key):
                continue
            name = f"{kind.__module__}.{kind.__qualname__}.{key}"
            self._call(name, function, None if isinstance(member, staticmethod) else self._instance(kind))

    def _makes(self, kind: type, key: str) -> bool:
        return key == "Get" and issubclass(kind, Usd.SchemaBase)

    def _instance(self, kind: type) -> Any:
        known: dict[type, Any] = {
            Usd.Stage: self.by_cpp["UsdStage"], Usd.Prim: self.by_cpp["UsdPrim"], Usd.Object: self.by_cpp["UsdPrim"],
            Usd.Attribute: self.cube.GetSizeAttr(), Usd.Property: self.cube.GetSizeAttr(),
            Sdf.Path: self.by_cpp["SdfPath"],
            Usd.Relationship: self.by_cpp["UsdPrim"].CreateRelationship("other"), Sdf.Layer: self.by_cpp["SdfLayer"],
        }  # fmt: skip
        if kind is UsdGeom.XformOp:
            return self.cube.GetOrderedXformOps()[0] if self.cube.GetOrderedXformOps() else self.cube.AddTranslateOp()
        if kind in known:
            return known[kind]
        if kind.__module__ == "pxr.Gf":
            return self.by_cpp.get(f"Gf{kind.__qualname__}")
        if kind is UsdGeom.Xformable:  # each of its operations can be added once
            self.made += 1
            return UsdGeom.Xformable(UsdGeom.Xform.Define(self.by_cpp["UsdStage"], f"/World/xform_{self.made}"))
        if issubclass(kind, Usd.SchemaBase):
            try:
                return kind(self.by_cpp["UsdPrim"])
            except Exception:  # noqa: BLE001 - a schema that several can be applied of needs a name
                return kind(self.by_cpp["UsdPrim"], "sample")
        return None

    def _call(self, name: str, function: Any, instance: Any) -> None:
        for way in overloads(function):
            given: list[Any] = []
            for i, parameter in enumerate(way):
                if i == 0 and instance is not None:
                    given.append(instance)
                elif parameter.default is not None:
                    break
                else:
                    given.append(self.by_cpp.get(parameter.annotation))
            if any(value is None for value in given):
                continue
            try:
                result = function(*given)
            except Exception:  # noqa: BLE001 - a call that fails tells nothing
                continue
            self.found.setdefault(name, set()).add(_kind(result))


def _kind(result: Any) -> str:
    """Whole name of the class of a result, "list[...]" of a list of one class; "" of what says nothing."""
    kind = type(result)
    if kind.__module__.startswith("pxr."):
        return f"{kind.__module__}.{kind.__qualname__}"
    if isinstance(result, list) and len({type(item) for item in result}) == 1:
        inner = _kind(result[0])
        return f"list[{inner}]" if inner else ""
    return ""
