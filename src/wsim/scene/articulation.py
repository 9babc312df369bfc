"""Mark chains of jointed bodies as articulations, which is how a solver in joint coordinates takes them."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdPhysics

WORLD_END = Sdf.Path.absoluteRootPath


def mark_articulations(stage: Usd.Stage) -> None:
    """Put one articulation root on each tree of joints, and take joints that close a loop out of the tree.

    The root is the joint to the world, or the body that no joint has as its child. Called after each new joint:
    joints made by other means are marked with the rest, and roots set by other means give way.
    """
    tree = Forest()
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.ArticulationRootAPI):
            prim.RemoveAPI(UsdPhysics.ArticulationRootAPI)
    for joint in joints_of(stage):
        parent, child = joint_ends(joint)
        if not tree.add(parent, child, joint.GetPath()) and tree.root(parent) == tree.root(child):
            joint.CreateExcludeFromArticulationAttr(True)
        elif joint.GetExcludeFromArticulationAttr().HasAuthoredValue():
            joint.GetExcludeFromArticulationAttr().Clear()
    for path in tree.roots():
        UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath(path))


def joints_of(stage: Usd.Stage) -> list[UsdPhysics.Joint]:
    """The joints that hold a body and are switched on."""
    joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    return [joint for joint in joints if joint.GetJointEnabledAttr().Get() and joint_ends(joint)[1] != WORLD_END]


def second_parent(stage: Usd.Stage, parent: Sdf.Path, child: Sdf.Path) -> Sdf.Path | None:
    """What `child` already hangs on, where hanging it on `parent` too would join two chains and close no loop.

    Newton's importer cannot take such a joint. A joint that closes a loop it takes as a constraint.
    """
    tree = Forest()
    for joint in joints_of(stage):
        tree.add(*joint_ends(joint), joint.GetPath())
    return tree.holder(child) if tree.root(parent) != tree.root(child) else None


def closes_loop(stage: Usd.Stage, parent: Sdf.Path, child: Sdf.Path) -> str:
    """Whether a joint from `parent` to `child` would close a loop, and where: "", "world" or "bodies".

    Newton's importer reads a loop that is closed at the world, and none that runs through two joints to the world
    otherwise.
    """
    tree = Forest()
    for joint in joints_of(stage):
        tree.add(*joint_ends(joint), joint.GetPath())
    if tree.holder(child) is None or tree.root(parent) != tree.root(child):
        return ""
    return "bodies" if parent != WORLD_END and tree.top(parent) != tree.top(child) else "world"


def joint_ends(joint: UsdPhysics.Joint) -> tuple[Sdf.Path, Sdf.Path]:
    """Bodies that a joint holds, parent and child as authored; `WORLD_END` is what never moves, and never the child."""
    stage = joint.GetPrim().GetStage()
    ends = []
    for relation in (joint.GetBody0Rel(), joint.GetBody1Rel()):
        targets = relation.GetTargets()
        ends.append(body_above(stage.GetPrimAtPath(targets[0])) if targets else WORLD_END)
    parent, child = ends
    return (child, parent) if child == WORLD_END else (parent, child)


def body_above(prim: Usd.Prim) -> Sdf.Path:
    """The rigid body that a prim is or is part of; `WORLD_END` if it is part of none."""
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return prim.GetPath()
        prim = prim.GetParent()
    return WORLD_END


class Forest:
    """Rooted trees of bodies, grown a joint at a time."""

    def __init__(self) -> None:
        self._parent: dict[Sdf.Path, Sdf.Path] = {}
        self._anchor: dict[Sdf.Path, Sdf.Path] = {}  # body → the joint that ties it to the world
        self._bodies: dict[Sdf.Path, None] = {}

    def add(self, parent: Sdf.Path, child: Sdf.Path, joint: Sdf.Path) -> bool:
        """Hang `child` on `parent`; False, and nothing done, where that would give it two parents or close a loop."""
        if child in self._parent or self.top(parent) == child:
            return False
        self._parent[child] = parent
        if parent == WORLD_END:
            self._anchor[child] = joint
        for path in (parent, child):
            if path != WORLD_END:
                self._bodies[path] = None
        return True

    def holder(self, path: Sdf.Path) -> Sdf.Path | None:
        """The parent of a body; None if it has none."""
        return self._parent.get(path)

    def root(self, path: Sdf.Path) -> Sdf.Path:
        """What a body's tree stands on: the world, or the topmost body."""
        top = self.top(path)
        return WORLD_END if top in self._anchor else top

    def roots(self) -> list[Sdf.Path]:
        """The prim that roots each tree: a joint to the world, or the topmost body."""
        tops = dict.fromkeys(self.top(path) for path in self._bodies)
        return [self._anchor.get(top, top) for top in tops]

    def bodies(self) -> list[Sdf.Path]:
        """Every body that a joint holds."""
        return list(self._bodies)

    def anchor(self, path: Sdf.Path) -> Sdf.Path | None:
        """The joint that ties a body to the world; None if none does."""
        return self._anchor.get(path)

    def top(self, path: Sdf.Path) -> Sdf.Path:
        """The topmost body of a body's tree."""
        while self._parent.get(path, WORLD_END) != WORLD_END:
            path = self._parent[path]
        return path
