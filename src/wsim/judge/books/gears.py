"""What gears pass on: one impulse along both joints at once.

A gear without play holds q2 - ratio q1, and does no work: along its second joint it gives what it likes, and along its
first one -ratio times that. So a pair has one inertia, I1 + ratio^2 I2 as the first joint feels it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.books.forces import shared
from wsim.judge.evidence.joints import AXES, anchors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Columns
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Gear, Joint

    Floats = NDArray[np.float64]


AXIAL = ("revolute", "prismatic")


class Gears:
    """The impulses of all gears of a world in any interval between frames."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence, self._motion = evidence, evidence.motion
        self._row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
        self._gears: list[tuple[NDArray[np.intp], Floats]] = []
        self.untold: set[str] = set()  # prims of joints whose gears act along a motion that is not told
        for gear in evidence.world.gears:
            each = self._gear(gear)
            if each is None:
                self.untold |= {gear.first, gear.second}
            else:
                self._gears.append(each)

    def columns(self, k: int) -> list[Columns]:
        """What may act between frames k and k + 1."""
        return [shared(rows, on[k], both=True) for rows, on in self._gears if len(rows)]

    def _gear(self, gear: Gear) -> tuple[NDArray[np.intp], Floats] | None:
        """The bodies of a gear, and what it gives each of them about its centre of mass, (n,) and (T - 1, n, 6)."""
        joints = {joint.prim: joint for joint in self._evidence.world.joints}
        ends = [joints.get(gear.first), joints.get(gear.second)]
        on = np.zeros((len(self._evidence.time), len(self._row), 6))
        for joint, share in zip(ends, (-gear.ratio, 1.0), strict=True):
            if joint is None or joint.kind not in AXIAL or joint.child_anchor is None:
                return None
            self._along(on, joint, share)
        on = 0.5 * (on[1:] + on[:-1])
        rows = np.flatnonzero(np.any(on != 0.0, axis=(0, 2)) & ~self._motion.kinematic)
        return rows, on[:, rows]

    def _along(self, on: Floats, joint: Joint, share: float) -> None:
        """Add an effort of `share` along a joint, at each frame."""
        anchors = anchors_of(self._evidence, joint)
        axis = share * rotate(anchors.above_turn, np.eye(3)[AXES[joint.axis]][None])
        for prim, way in ((joint.parent, -1.0), (joint.child, 1.0)):
            if prim is None or prim not in self._row:
                continue
            i = self._row[prim]
            if joint.kind == "revolute":
                on[:, i, 3:] += way * axis
            else:
                on[:, i, :3] += way * axis
                on[:, i, 3:] += way * np.cross(anchors.below - self._motion.com[:, i], axis)
