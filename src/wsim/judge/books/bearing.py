"""What a joint bore, told by the motion of all that it holds, where nobody recorded it.

Of the bodies on the child's side, if nothing else holds, pulls or may touch them, the joint gave all that gravity did
not: sum m (a - g), and its moment about the anchor (Newton and Euler).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.differences import by_differences
from wsim.judge.evidence.joints import anchors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]


BEFORE = 4  # intervals in which what came apart broke: g t^2 / 2 is 2 % of a body of 25 cm after 2 frames of 1/60 s


@dataclass(frozen=True)
class Load:
    """What a joint passed on as the mean of each interval."""

    force: Floats  # (T - 1,) [N]
    torque: Floats  # (T - 1,) about the child's anchor [N m]
    known: Bools  # (T - 1,), where nothing else may have touched what it holds

    def share(self, joint: Joint) -> Floats:
        """Of the joint's strength, (T - 1,)."""
        limits = [np.inf if limit is None else limit for limit in (joint.break_force, joint.break_torque)]
        return np.asarray(np.maximum(self.force / limits[0], self.torque / limits[1]))

    def before(self, gone: Bools) -> slice | None:
        """The intervals in which a joint broke that is seen `gone` (T,); None if it never is, or bore unknown loads."""
        end = int(np.argmax(gone))
        last = slice(end - BEFORE, end)
        return last if gone.any() and end >= BEFORE and self.known[last].all() else None


def load_of(evidence: Evidence, joint: Joint) -> Load | None:
    """What a joint bore; None where more holds its child than the joint, or velocities are differences of poses."""
    held = _held(evidence, joint)
    if held is None or joint.child_anchor is None or by_differences(evidence):
        return None
    motion = evidence.motion
    pull = motion.mass[held, None] * (motion.acceleration[:, held] - motion.gravity)
    anchor = anchors_of(evidence, joint).below[:, None]
    arm = motion.com[:, held] - anchor
    turn = motion.torque[:, held] + np.cross(0.5 * (arm[1:] + arm[:-1]), pull)
    force, torque = (np.linalg.norm(each.sum(axis=1), axis=1) for each in (pull, turn))
    every, near = np.arange(len(motion.h)), np.zeros(len(motion.h), dtype=bool)
    child, holder = evidence.index(joint.child), joint.parent or joint.fixture
    for shape in evidence.placed:
        if shape.body not in held:  # the joint's own two ends never touch
            others = [i for i in held if not (i == child and shape.owner == holder)]
            near |= np.any([motion.approaches(shape, i, every) for i in others], axis=0)
    return Load(force, torque, ~near)


def _held(evidence: Evidence, joint: Joint) -> list[int] | None:
    """The rows of bodies that hang on a joint; None where they hang on something else, too."""
    world, found, asked = evidence.world, {joint.child}, [joint.child]
    while asked:
        one = asked.pop()
        for other in world.joints:
            if other is not joint and one in (other.parent, other.child):
                new = {other.parent, other.child} - found
                asked += [each for each in new if each is not None]
                found |= {each for each in new if each is not None}
                if None in new:
                    return None
    cords = {guide.body for cord in (*world.springs, *world.ropes) for guide in cord.path}
    fixed = {body.prim for body in world.bodies if body.kinematic} | {joint.parent}
    inside = {each.prim for each in world.joints if each.child in found and each is not joint}
    geared = any((gear.first in inside) != (gear.second in inside) for gear in world.gears)
    if found & (cords | fixed) or geared or world.fluids:
        return None
    return sorted(evidence.index(prim) for prim in found)
