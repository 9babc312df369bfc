"""What a stage states of its surfaces and of pairs of objects: coefficients in range, two objects, stated once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pxr import Sdf, Usd

from wsim.limits import MAX_FRICTION
from wsim.scene import schema
from wsim.scene.usd_contacts import COEFFICIENTS, ends, stated, tied, yields

_MOST = {"friction": MAX_FRICTION, "restitution": 1.0, "rolling": 1.0}


def surface_problems(prim: Usd.Prim) -> Iterator[str]:
    """Coefficients of one prim, a material or a pair, that are out of range."""
    if {schema.MATERIAL, schema.CONTACT}.intersection(schema.applied(prim)):
        for name, value in stated(prim).items():
            # What is no number, or not finite, is told elsewhere.
            if isinstance(value, float) and math.isfinite(value) and not 0.0 <= value <= _MOST[name]:
                limit = ">= 0" if value < 0.0 else f"<= {_MOST[name]:g}"
                yield f"{prim.GetPath()}.wsim:{name}: {value:g} must be {limit}"


def contact_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Pairs that are none, never meet, state nothing, or are stated twice."""
    seen: dict[frozenset[Sdf.Path], Sdf.Path] = {}
    listed = list(prims)
    pairs = [prim for prim in listed if schema.has(prim, schema.CONTACT)]
    ties = tied(listed) if pairs else {}
    for prim in pairs:
        yield from _pair(prim, seen, ties)


def _pair(
    prim: Usd.Prim, seen: dict[frozenset[Sdf.Path], Sdf.Path], ties: dict[frozenset[Sdf.Path], str]
) -> Iterator[str]:
    for name in ("first", "second"):
        relation = prim.GetRelationship(f"wsim:{name}")
        count = len(relation.GetTargets()) if relation else 0
        if count != 1:
            yield f"{prim.GetPath()}.wsim:{name}: names {count} objects; it must name one"
            return
    paths = ends(prim)
    found = [prim.GetStage().GetPrimAtPath(path) for path in paths]
    pair = frozenset(paths)
    if paths[0].HasPrefix(paths[1]) or paths[1].HasPrefix(paths[0]):
        yield f"{prim.GetPath()}.wsim:second: <{paths[1]}> is wsim:first, or a part of it; a pair is two objects"
    elif not any(yields(each) for each in found):
        yield (
            f"{prim.GetPath()}.wsim:second: <{paths[1]}> is static or kinematic, as wsim:first is; no contact moves "
            "either"
        )
    elif pair in ties:
        yield f"{prim.GetPath()}: <{paths[0]}> and <{paths[1]}> never touch: {ties[pair]}; leave the pair out"
    elif not stated(prim):
        yield f"{prim.GetPath()}: states nothing; give {', '.join(f'wsim:{name}' for name in COEFFICIENTS)}"
    elif pair in seen:
        yield f"{prim.GetPath()}: the pair is stated in <{seen[pair]}>, too; state it once"
    seen.setdefault(pair, prim.GetPath())
