"""Paths of a stage that name other prims for physics: each must be there, and of the kind that is read there."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pxr import Usd, UsdGeom, UsdPhysics

from wsim.scene import schema

_SPACES = ("physics", "newton", "mjc", "wsim")


def check_targets(prim: Usd.Prim) -> Iterator[str]:
    """Problems of one prim."""
    yield from _soft(prim)
    for relation in prim.GetAuthoredRelationships():
        parts = relation.GetName().split(":")
        collection = parts[0] == "collection" and parts[-1] in ("includes", "excludes")
        if parts[0] not in _SPACES and not collection:
            continue
        fits, kind = _KINDS.get(relation.GetName(), (None, ""))
        for path in relation.GetTargets():
            target = prim.GetStage().GetPrimAtPath(path.GetPrimPath())
            if not target or (path.IsPropertyPath() and not target.GetPropertyAtPath(path)):
                yield f"{relation.GetPath()}: <{path}> is not there"
            elif fits is not None and (path.IsPropertyPath() or not fits(target)):
                yield f"{relation.GetPath()}: <{path}> is a {target.GetTypeName() or 'prim'}; it must be {kind}"
            elif parts[0] == "wsim" and not Usd.PrimDefaultPredicate(target):
                yield f"{relation.GetPath()}: <{path}> is not in the world: inactive, a class or an over; name another"
    if prim.IsA(UsdPhysics.Joint):
        yield from _joint(UsdPhysics.Joint(prim))
    if prim.IsA(UsdGeom.PointInstancer):
        yield from _prototypes(UsdGeom.PointInstancer(prim))
    if prim.IsA(UsdGeom.Xformable):
        yield from _order(UsdGeom.Xformable(prim))
    for attribute in prim.GetAuthoredAttributes():
        yield from _connections(attribute)


def _prototypes(instancer: UsdGeom.PointInstancer) -> Iterator[str]:
    """What is copied must be there, and not hold the copies."""
    own = instancer.GetPath()
    for path in instancer.GetPrototypesRel().GetTargets():
        if not instancer.GetPrim().GetStage().GetPrimAtPath(path):
            yield f"{own}.prototypes: <{path}> is not there"
        elif own.HasPrefix(path):
            yield f"{own}.prototypes: <{path}> is or holds the instancer; name what is to be copied"


def _order(xformable: UsdGeom.Xformable) -> Iterator[str]:
    """An order of transforms that names one that is not there."""
    order = xformable.GetXformOpOrderAttr()
    for name in order.Get() or ():
        if name != "!resetXformStack!" and not xformable.GetPrim().GetAttribute(name.removeprefix("!invert!")):
            yield f"{order.GetPath()}: {name!r} is not there"


def _connections(attribute: Usd.Attribute) -> Iterator[str]:
    """A connection to nothing, or one that comes back to where it starts."""
    if not attribute.HasAuthoredConnections():
        return
    stage = attribute.GetPrim().GetStage()
    seen, waiting = {attribute.GetPath()}, list(attribute.GetConnections())
    for path in waiting:
        if not stage.GetPropertyAtPath(path):
            yield f"{attribute.GetPath()}.connect: <{path}> is not there"
            return
    while waiting:
        path = waiting.pop()
        if path == attribute.GetPath():
            yield f"{attribute.GetPath()}.connect: comes back to itself"
            return
        source = stage.GetAttributeAtPath(path) if path not in seen else None
        seen.add(path)
        waiting += source.GetConnections() if source else []


def _joint(joint: UsdPhysics.Joint) -> Iterator[str]:
    """A joint whose ends are one body: nothing can move, and Newton does not take it."""
    prim = joint.GetPrim()
    bodies = []
    for relation in (joint.GetBody0Rel(), joint.GetBody1Rel()):
        body = prim.GetStage().GetPrimAtPath((relation.GetTargets() or ["/"])[0])
        while body and not body.IsPseudoRoot() and not body.HasAPI(UsdPhysics.RigidBodyAPI):
            body = body.GetParent()
        bodies.append(body)
    if bodies[0] and not bodies[0].IsPseudoRoot() and bodies[0] == bodies[1]:
        yield f"{prim.GetPath()}.physics:body1: <{bodies[1].GetPath()}> is at the joint's other end, too"


def _soft(prim: Usd.Prim) -> Iterator[str]:
    """What bends and tears is not simulated, and its many indices are not checked."""
    names = [*prim.GetPrimTypeInfo().GetAppliedAPISchemas(), *prim.GetAppliedSchemas(), str(prim.GetTypeName())]
    for name in names:
        if "Deformable" in name or name in ("PhysicsAttachment", "PhysicsElementCollisionFilter"):
            yield f"{prim.GetPath()}: {name} is not supported; bodies are rigid, and fluids are made with scene.fluid"
            return


def _collides(prim: Usd.Prim) -> bool:
    return any(prim.HasAPI(api) for api in _FILTERED)


def _solid(prim: Usd.Prim) -> bool:
    return any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()))


def _holds(prim: Usd.Prim) -> bool:
    return schema.has(prim, schema.CONTAINER) or _solid(prim)


_FILTERED = (UsdPhysics.RigidBodyAPI, UsdPhysics.CollisionAPI, UsdPhysics.ArticulationRootAPI)
_KINDS: dict[str, tuple[Callable[[Usd.Prim], bool], str]] = {
    "physics:filteredPairs": (_collides, "a rigid body, a collider or an articulation"),
    "physics:filteredGroups": (lambda prim: prim.IsA(UsdPhysics.CollisionGroup), "a PhysicsCollisionGroup"),
    "physics:simulationOwner": (lambda prim: prim.IsA(UsdPhysics.Scene), "a PhysicsScene"),
    "wsim:container": (_holds, "a container, or a vessel that collides"),
    "wsim:body": (lambda prim: bool(prim.HasAPI(UsdPhysics.RigidBodyAPI)), "a rigid body"),
    "wsim:follows": (lambda prim: bool(prim.HasAPI(UsdPhysics.RigidBodyAPI)), "a rigid body"),
    "wsim:joints": (lambda prim: prim.IsA(UsdPhysics.Joint), "a joint"),
    "wsim:first": (_solid, "something that collides"),
    "wsim:second": (_solid, "something that collides"),
}
