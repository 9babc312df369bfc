"""The USD schemas that are installed: their attributes, types, defaults and documentation, from USD's own registry.

USD reads its schemas once, when a process first opens a stage: who registers some later is not heard. So they are read
in a process of their own.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

from pxr import Plug, Tf, Usd

import wsim.scene  # noqa: F401 - registers wsim's schema, before USD reads its schemas
from wsim.program.api.docstring import summary, unit
from wsim.program.api.entry import Entry

INSTANCE = "__INSTANCE_NAME__"


def entries() -> Iterator[Entry]:
    """Each schema by its name, `PhysicsMassAPI`, and its own attributes by theirs, `PhysicsMassAPI.physics:mass`."""
    command = [sys.executable, "-P", "-c", "from wsim.program.api.sources.usd_schemas import _main; _main()"]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    yield from (Entry.from_data(each) for each in json.loads(done.stdout.splitlines()[-1]))


def _main() -> None:
    sys.stdout.write("\n" + json.dumps([entry.as_data() for entry in _read()]) + "\n")


def _read() -> Iterator[Entry]:
    with contextlib.suppress(ImportError):
        importlib.import_module("newton_usd_schemas")  # registers Newton's
    registry = Usd.SchemaRegistry()
    for name, bases in sorted(_names().items()):
        definition = registry.FindConcretePrimDefinition(name) or registry.FindAppliedAPIPrimDefinition(name)
        if not definition:
            definition = registry.FindAbstractPrimDefinition(name)
        if not definition:
            continue
        doc = _plain(definition.GetDocumentation())
        kind = str(registry.GetSchemaKind(name)).rpartition(".")[2]
        yield Entry(name, "schema", "schema", bases=bases, summary=summary(doc), doc=doc, extra={"kind": kind})
        for attribute in definition.GetPropertyNames():
            yield _attribute(name, attribute, definition)


def _names() -> dict[str, tuple[str, ...]]:
    """Schema names, with those of the schemas they inherit from."""
    registry = Usd.SchemaRegistry
    found = {}
    for kind in Plug.Registry().GetAllDerivedTypes(Tf.Type.FindByName("UsdSchemaBase")):
        name = registry.GetSchemaTypeName(kind)
        above = [registry.GetSchemaTypeName(base) for base in kind.GetAllAncestorTypes()[1:]]
        if name:
            found[name] = tuple(base for base in above if base)
    return found


def _attribute(schema: str, name: str, definition: Any) -> Entry:
    doc = _plain(definition.GetPropertyDocumentation(name))
    found = definition.GetAttributeDefinition(name)
    kind, default = "rel", None
    if found:
        kind, default = str(found.GetTypeName()), found.GetFallbackValue()
    extra: dict[str, Any] = {"default": str(default)} if default is not None else {}
    allowed = found.GetMetadata("allowedTokens") if found else None
    if allowed:
        extra["allowed"] = [str(token) for token in allowed]
    return Entry(
        f"{schema}.{name.replace(INSTANCE, '*')}", "schema attribute", "schema", returns=kind,
        summary=summary(doc), doc=doc, extra=extra | ({"unit": unit(doc)} if unit(doc) else {}),
    )  # fmt: skip


def _plain(doc: str) -> str:
    return "\n".join(line.strip() for line in (doc or "").splitlines()).strip()
