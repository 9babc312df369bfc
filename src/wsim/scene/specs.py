"""Prims and attributes written straight into a layer.

A stage composes a prim anew after each change of it that it is told of. What takes many is written within one
`Sdf.ChangeBlock`, which asks that nothing between them goes by way of the stage.
"""

from __future__ import annotations

from pxr import Sdf, Usd


def define(layer: Sdf.Layer, path: str, kind: str) -> Sdf.PrimSpec:
    """The prim of that path in a layer, made of that type if it is not there; its parent must be."""
    found = layer.GetPrimAtPath(path)
    if found is None:
        parent, name = path.rsplit("/", 1)
        found = Sdf.PrimSpec(layer.GetPrimAtPath(parent), name, Sdf.SpecifierDef, kind)
    return found


def spec_of(prim: Usd.Prim) -> Sdf.PrimSpec:
    """What the layer that a stage edits states of a prim; nothing so far if another one makes it."""
    return Sdf.CreatePrimInLayer(prim.GetStage().GetEditTarget().GetLayer(), prim.GetPath())


def put(
    prim: Sdf.PrimSpec,
    name: str,
    kind: Sdf.ValueTypeName,
    value: object = None,
    variability: Sdf.Variability = Sdf.VariabilityVarying,
) -> Sdf.AttributeSpec:
    """An attribute of a prim, made if it is not there, with its default value if one is given."""
    attribute = prim.attributes.get(name) or Sdf.AttributeSpec(prim, name, kind, variability)
    if value is not None:
        attribute.default = value
    return attribute


def apply(prim: Sdf.PrimSpec, *schemas: str) -> None:
    """Apply API schemas to a prim, after those that are."""
    listed = prim.GetInfo("apiSchemas") if prim.HasInfo("apiSchemas") else Sdf.TokenListOp()
    if listed.isExplicit:
        listed.explicitItems = [*(name for name in listed.explicitItems if name not in schemas), *schemas]
    else:
        listed.prependedItems = [*(name for name in listed.prependedItems if name not in schemas), *schemas]
    prim.SetInfo("apiSchemas", listed)
