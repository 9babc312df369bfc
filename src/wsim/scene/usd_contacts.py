"""Read what a stage states of pairs of objects."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from pxr import Sdf, Usd, UsdPhysics

from wsim.scene import schema
from wsim.scene.articulation import WORLD_END, body_above, is_kinematic, joint_ends, may_break

if TYPE_CHECKING:
    from wsim.scene.world import Contact

COEFFICIENTS = ("friction", "restitution", "rolling")


def read_contacts(prims: Iterable[Usd.Prim]) -> list[Contact]:
    """The pairs of a stage that passed its check."""
    return [_contact(prim) for prim in prims if schema.has(prim, schema.CONTACT)]


def _contact(prim: Usd.Prim) -> Contact:
    from wsim.scene.world import Contact  # it brings pydantic, and what programs call needs the rest of this file alone

    first, second = (str(end) for end in ends(prim))
    line = prim.GetCustomDataByKey("wsim:line")
    return Contact(
        prim=str(prim.GetPath()),
        first=first,
        second=second,
        **{name: value for name, value in stated(prim).items() if isinstance(value, (int, float))},
        line=line if isinstance(line, str) else None,
    )


def stated(prim: Usd.Prim) -> dict[str, object]:
    """The coefficients that a pair states, by name."""
    attributes = {name: prim.GetAttribute(f"wsim:{name}") for name in COEFFICIENTS}
    return {name: each.Get() for name, each in attributes.items() if each and each.HasAuthoredValue()}


def ends(prim: Usd.Prim) -> list[Sdf.Path]:
    """The objects that a pair's relationships mean, `wsim:first` before `wsim:second`."""
    relations = (prim.GetRelationship(f"wsim:{name}") for name in ("first", "second"))
    targets = [path for relation in relations if relation for path in relation.GetTargets()]
    return [owner(prim.GetStage().GetPrimAtPath(path)).GetPath() for path in targets]


def owner(prim: Usd.Prim) -> Usd.Prim:
    """The object that a part belongs to: its body, or of what never moves the child of the default prim above it."""
    body = body_above(prim)
    if body != WORLD_END:
        return prim.GetStage().GetPrimAtPath(body)
    default = prim.GetStage().GetDefaultPrim()
    while prim.GetParent() and not prim.GetParent().IsPseudoRoot() and prim.GetParent() != default:
        prim = prim.GetParent()
    return prim


def yields(prim: Usd.Prim) -> bool:
    """Whether an object is a body that contacts move, or holds one."""
    parts = Usd.PrimRange(prim, Usd.TraverseInstanceProxies())
    return any(part.HasAPI(UsdPhysics.RigidBodyAPI) and not is_kinematic(part) for part in parts)


def tied(prims: Iterable[Usd.Prim]) -> dict[frozenset[Sdf.Path], str]:
    """The pairs that never touch, and what says so: a joint ties them, also once it broke, or a gear meshes them."""
    found: dict[frozenset[Sdf.Path], str] = {}
    for prim in prims:
        if prim.IsA(UsdPhysics.Joint):
            names = ("physics:body0", "physics:body1", "wsim:fixture")
            why = f"the joint <{prim.GetPath()}> ties them"
            why += ", and they pass each other once it broke" if may_break(UsdPhysics.Joint(prim)) else ""
            found.setdefault(_owners(prim.GetStage(), _targets(prim, names)), why)
        if meshed := _meshed(prim):
            held = [joint_ends(UsdPhysics.Joint(joint))[1] for joint in meshed]
            found.setdefault(_owners(prim.GetStage(), held), f"the gear <{prim.GetPath()}> meshes them")
    return found


def _meshed(prim: Usd.Prim) -> list[Usd.Prim]:
    """The joints that a gear or a mimic couples; none of any other prim."""
    joints = [prim.GetStage().GetPrimAtPath(path) for path in _targets(prim, ("wsim:joint0", "wsim:joint1"))]
    if prim.HasRelationship("newton:mimicJoint"):
        joints = [prim, *(prim.GetStage().GetPrimAtPath(path) for path in _targets(prim, ("newton:mimicJoint",)))]
    return joints if all(joint and joint.IsA(UsdPhysics.Joint) for joint in joints) else []


def _targets(prim: Usd.Prim, names: Iterable[str]) -> list[Sdf.Path]:
    return [path for name in names if (to := prim.GetRelationship(name)) for path in to.GetTargets()]


def _owners(stage: Usd.Stage, paths: Iterable[Sdf.Path]) -> frozenset[Sdf.Path]:
    return frozenset(owner(prim).GetPath() for path in paths if (prim := stage.GetPrimAtPath(path)))
