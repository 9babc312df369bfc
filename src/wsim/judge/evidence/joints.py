"""How well joints hold, from the recorded poses of the bodies at their ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.evidence import compound

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.recorded import Recorded
    from wsim.scene.world import Joint, Quat, Vec3

    Floats = NDArray[np.float64]

AXES = {"X": 0, "Y": 1, "Z": 2}
HELD = 0.02  # of the child's smallest extent, that anchors of a joint that holds may be apart
LEANS = 0.02  # [rad] that its ends may be turned against what it allows


@dataclass(frozen=True)
class JointTrack:
    """One joint through time, (T,) each; of one that breaks, `apart` and `turned` are 0 from then on."""

    apart: Floats  # how far its anchors are from where it holds them [m]
    turned: Floats  # angle by which its ends are turned against what it allows [rad]
    position: Floats  # its own motion: of a hinge [rad], of a slider [m]; 0 for the others


def track_of(evidence: Recorded, joint: Joint) -> JointTrack | None:
    """A joint's track; None where the recording does not say where its anchors are."""
    track, gone = unbroken_track_of(evidence, joint), broken(evidence, joint)
    if track is None or not gone.any():
        return track
    return replace(track, apart=np.where(gone, 0.0, track.apart), turned=np.where(gone, 0.0, track.turned))


def unbroken_track_of(evidence: Recorded, joint: Joint) -> JointTrack | None:
    """A joint's track as of one that never breaks."""
    if joint.parent_anchor is None or joint.child_anchor is None:
        return None
    above, above_turn = _anchor(evidence, joint.parent, joint.parent_anchor, joint.parent_turn)
    below, below_turn = _anchor(evidence, joint.child, joint.child_anchor, joint.child_turn)
    offset = rotate(conjugate(above_turn), below - above)  # in the parent's anchor
    turn = multiply(conjugate(above_turn), below_turn)
    turn = np.where(turn[:, 3:] < 0.0, -turn, turn)
    axis = AXES[joint.axis]
    angle = 2.0 * np.arctan2(np.linalg.norm(turn[:, :3], axis=1), turn[:, 3])
    position = np.zeros(len(offset))
    if joint.kind == "prismatic":
        position = offset[:, axis].copy()
        offset[:, axis] = 0.0
    elif joint.kind == "revolute":
        position = np.unwrap(2.0 * np.arctan2(turn[:, axis], turn[:, 3]))
        # How far the hinge's axis, seen from its parent, leans.
        along = np.zeros(3)
        along[axis] = 1.0
        leaning = np.linalg.norm(np.cross(rotate(turn, along[None]), along), axis=1)
        angle = np.arcsin(np.clip(leaning, 0.0, 1.0))
    elif joint.kind == "spherical":
        angle = np.zeros(len(offset))
    apart = np.linalg.norm(offset, axis=1)
    if joint.kind == "compound":
        anchors = compound.Anchors(above, above_turn, below, below_turn)
        apart, angle = compound.errors(joint, anchors, offset, turn)
    return JointTrack(apart, angle, position)


def anchors_of(evidence: Recorded, joint: Joint) -> compound.Anchors:
    """Both ends of a joint whose anchors are known."""
    none = (0.0, 0.0, 0.0)
    above = _anchor(evidence, joint.parent, joint.parent_anchor or none, joint.parent_turn)
    return compound.Anchors(*above, *_anchor(evidence, joint.child, joint.child_anchor or none, joint.child_turn))


def broken(evidence: Recorded, joint: Joint) -> NDArray[np.bool_]:
    """In which frames a joint is broken, (T,), as the recording says.

    Where it does not say, one that may break is broken once it does not hold.
    """
    said = said_broken(evidence, joint)
    if said is not None:
        return np.asarray(np.nan_to_num(said) > 0.0)
    track = unbroken_track_of(evidence, joint) if joint.may_break else None
    if track is None:
        return np.zeros(len(evidence.time), dtype=bool)
    far = track.apart > HELD * evidence.solid(evidence.index(joint.child)).smallest
    return np.asarray(np.logical_or.accumulate(far | (track.turned > LEANS)))


def said_broken(evidence: Recorded, joint: Joint) -> Floats | None:
    """Whether a joint is broken, (T,), 1 or 0; None where nobody recorded it."""
    return evidence.recording.scalars.get("broken" + joint.prim.removeprefix("/World"))


def _anchor(evidence: Recorded, prim: str | None, position: Vec3, turn: Quat) -> tuple[Floats, Floats]:
    """Where an anchor is in the world, (T, 3) and (T, 4)."""
    own = np.array(turn, dtype=np.float64)
    if prim is None:
        frames = len(evidence.time)
        return np.tile(np.array(position, dtype=np.float64), (frames, 1)), np.tile(own, (frames, 1))
    q = evidence.body_q[:, evidence.index(prim)]
    return q[:, :3] + rotate(q[:, 3:], np.array(position)[None]), multiply(
        q[:, 3:], np.broadcast_to(own, q[:, 3:].shape)
    )
