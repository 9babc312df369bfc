"""At which body a tree of joints had best begin that nothing holds.

In joint coordinates all that hangs beyond a joint moves with it. A light link with much beyond it makes a mass matrix
that single precision can hardly factor, and where the tree begins says which side of a joint is beyond it. The burden
of a body is how many times its own moment about the joint that it hangs by that of all beyond it is, stretched out.
The condition of the matrix, its diagonal scaled to one, follows the largest: it was 70 to 900 times that of chains.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
from pxr import Gf, Sdf, Usd, UsdPhysics

from wsim.scene.articulation import is_kinematic, joint_ends, joints_of, may_break
from wsim.scene.spanning import WORLD_END
from wsim.scene.usd_mass import mass_at
from wsim.scene.usd_prims import rigid_frame

Array = np.ndarray
Joints = dict[Sdf.Path, tuple[Sdf.Path, Array]]  # of each body but the first its parent, and where they meet [m]

HEAVY = 1e4  # a burden below makes a condition that 24 bits hold, 1.7e7
_END = 0.25  # a rod's moment about its middle over that about its end: the first body of a tree hangs by none


def better_roots(stage: Usd.Stage) -> list[Sdf.Path]:
    """The bodies at which free trees had better begin, of those that bear much where they begin now.

    Args:
        stage: Its joints in trees, as `mark_articulations` leaves them.
    """
    found = []
    for joints in _free_trees(stage):
        walk = _Walk(stage, joints)
        burdens = walk.burdens()
        best = int(np.argmin(burdens))
        if burdens[0] > max(HEAVY, 2.0 * burdens[best]):
            found.append(walk.bodies[best])
    return found


def _free_trees(stage: Usd.Stage) -> list[Joints]:
    """The joints of each tree that hangs on nothing, parents first."""
    hung: dict[Sdf.Path, list[tuple[Sdf.Path, Array]]] = defaultdict(list)
    children = set()
    for joint in joints_of(stage):
        if may_break(joint) or joint.GetExcludeFromArticulationAttr().Get():
            continue
        parent, child = joint_ends(joint)
        hung[parent].append((child, _place(joint)))
        children.add(child)
    trees = []
    for top in hung:
        if top == WORLD_END or top in children or is_kinematic(stage.GetPrimAtPath(top)):
            continue
        joints: Joints = {}
        ahead = [top]
        for body in ahead:
            joints |= {child: (body, place) for child, place in hung.get(body, ())}
            ahead += [child for child, _ in hung.get(body, ())]
        trees.append(joints)
    return trees


def _place(joint: UsdPhysics.Joint) -> Array:
    """Where a joint is [m]."""
    held, place = joint.GetBody1Rel().GetTargets(), joint.GetLocalPos1Attr().Get()
    if not held:
        held, place = joint.GetBody0Rel().GetTargets(), joint.GetLocalPos0Attr().Get()
    return np.array(rigid_frame(joint.GetPrim().GetStage().GetPrimAtPath(held[0])).Transform(Gf.Vec3d(place)))


class _Walk:
    """A tree with its measures, walked from any of its bodies."""

    def __init__(self, stage: Usd.Stage, joints: Joints) -> None:
        first = next(iter(joints.values()))[0]
        self.bodies = [first, *joints]
        row = {body: k for k, body in enumerate(self.bodies)}
        prims = [stage.GetPrimAtPath(body) for body in self.bodies]
        masses = [mass_at(prim) for prim in prims]
        self._mass = np.array([each.mass for each in masses])
        self._own = np.array([0.5 * float(np.trace(each.inertia)) for each in masses])
        self._center = [
            np.array(rigid_frame(prim).Transform(Gf.Vec3d(*each.com.tolist())))
            for prim, each in zip(prims, masses, strict=True)
        ]
        self._near: list[list[tuple[int, Array]]] = [[] for _ in self.bodies]
        self.joints = [(row[parent], row[child], place) for child, (parent, place) in joints.items()]
        for parent, child, place in self.joints:
            self._near[parent].append((child, place))
            self._near[child].append((parent, place))

    def burdens(self) -> list[float]:
        """The largest burden of any body, by the body at which the tree begins."""
        worst = np.zeros(len(self.bodies))
        for k, center in enumerate(self._center):
            moments, _ = self._moments(k, None, center)
            worst[k] = _END * moments.sum() / self._own[k]
        for parent, child, place in self.joints:
            for hangs, holds in ((child, parent), (parent, child)):
                moments, beyond = self._moments(hangs, holds, place)
                worst[~beyond] = np.maximum(worst[~beyond], moments.sum() / moments[hangs])
        return list(worst.tolist())

    def _moments(self, start: int, holds: int | None, place: Array) -> tuple[Array, Array]:
        """Moments about a place of a body and all beyond it, stretched out [kg m^2], and which those are."""
        moments, beyond = np.zeros(len(self.bodies)), np.zeros(len(self.bodies), dtype=bool)
        ahead: list[tuple[int, int | None, Array, float]] = [(start, holds, place, 0.0)]
        for body, came, entry, way in ahead:
            far = way + math.dist(entry, self._center[body])
            moments[body], beyond[body] = self._mass[body] * far * far + self._own[body], True
            ahead += [
                (other, body, there, way + math.dist(entry, there))
                for other, there in self._near[body]
                if other != came
            ]
        return moments, beyond
