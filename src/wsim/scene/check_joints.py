"""Joints that the simulator can take: in trees, one articulation root to each, and a loop closed by a joint left out.

`mark_articulations` makes a stage so. One that was written by other means says so itself, or is refused.
"""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Sdf, Usd, UsdPhysics

from wsim.scene.articulation import WORLD_END, Forest, joint_ends, joints_of

_CLOSING = (UsdPhysics.FixedJoint, UsdPhysics.RevoluteJoint, UsdPhysics.SphericalJoint)
_ROOT = UsdPhysics.ArticulationRootAPI


def joint_problems(stage: Usd.Stage) -> Iterator[str]:
    """Problems of the joints of a stage, taken together."""
    tree, closing = Forest(), []
    holders: dict[Sdf.Path, Sdf.Path] = {}  # body → the joint that it hangs by
    for joint in joints_of(stage):
        if joint.GetPrim().IsA(UsdPhysics.DistanceJoint):
            yield f"{joint.GetPath()}: a distance joint is not supported; use a spherical joint, or a prismatic one"
        elif joint.GetExcludeFromArticulationAttr().Get():
            closing.append(joint)
        else:
            yield from _grown(tree, joint, holders)
    for joint in closing:
        yield from _closing(tree, joint)
    yield from _roots(tree, stage)


def _grown(tree: Forest, joint: UsdPhysics.Joint, holders: dict[Sdf.Path, Sdf.Path]) -> Iterator[str]:
    """Hang a joint's child on its parent, or say why that cannot be."""
    parent, child = joint_ends(joint)
    if tree.add(parent, child, joint.GetPath()):
        holders[child] = joint.GetPath()
    elif tree.root(parent) == tree.root(child):
        yield f"{joint.GetPath()}: closes a loop of joints; give it physics:excludeFromArticulation = 1"
    else:
        yield (
            f"{joint.GetPath()}.physics:body1: <{child}> is the body1 of <{holders[child]}>, too; swap body0 and body1 "
            "in one of the two, so that each body hangs on one"
        )


def _closing(tree: Forest, joint: UsdPhysics.Joint) -> Iterator[str]:
    """A joint that is left out must close a loop: what hangs on it alone reaches no solver."""
    parent, child = joint_ends(joint)
    if child not in tree.bodies():
        if parent != WORLD_END:
            yield f"{joint.GetPath()}.physics:excludeFromArticulation: 1 must be 0: the joint closes no loop"
    elif tree.root(parent) != tree.root(child):
        yield (
            f"{joint.GetPath()}.physics:excludeFromArticulation: it joins two chains and closes no loop; "
            "make it 0, and let no body be the body1 of two joints"
        )
    elif parent != WORLD_END and tree.top(parent) != tree.top(child):
        yield (
            f"{joint.GetPath()}: its bodies both hang on the world; a loop is one chain from the world round to its "
            "last body, closed by a joint of that body and the world"
        )
    elif not any(joint.GetPrim().IsA(kind) for kind in _CLOSING):
        kind = joint.GetPrim().GetTypeName()
        yield f"{joint.GetPath()}: a {kind} cannot close a loop; close it with a fixed, revolute or spherical joint"


def _roots(tree: Forest, stage: Usd.Stage) -> Iterator[str]:
    """Trees without a root of their own. One body that is tied to the world needs none."""
    trees: dict[Sdf.Path, list[Sdf.Path]] = {}
    for body in tree.bodies():
        trees.setdefault(tree.top(body), []).append(body)
    taken: set[Sdf.Path] = set()
    for top, bodies in trees.items():
        anchor = tree.anchor(top)
        found = sorted({root for path in [*bodies, anchor] if path for root in _at_or_above(stage.GetPrimAtPath(path))})
        if len(found) > 1 or taken.intersection(found):
            yield f"{found[-1]}: its joints have another articulation root, or it has two chains; give each chain one"
        elif not found and len(bodies) > 1:
            yield f"{anchor or top}: its joints have no articulation root; apply PhysicsArticulationRootAPI here"
        taken.update(found)


def _at_or_above(prim: Usd.Prim) -> Iterator[Sdf.Path]:
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(_ROOT):
            yield prim.GetPath()
        prim = prim.GetParent()
