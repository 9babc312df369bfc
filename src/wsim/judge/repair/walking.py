"""What is wrong with a robot that goes otherwise than asked: its policy, or that it has none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import within

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence

LEGS = 2  # servos that hang on a base, at least, of what walks
DEEP = 2  # slashes in the path of a robot: /World/robot


def by_policy(evidence: Evidence, prim: str) -> RepairTarget | None:
    """The target of a finding about a robot's base; None where it is no base that a policy walks or could walk."""
    world = evidence.world
    for policy in world.policies:
        if policy.base == prim:
            return RepairTarget(
                kind="controller", prim=policy.prim, parameter="route" if policy.route else "commands",
                direction="change", why="its policy takes it there: send it another way, or make room on this one",
            )  # fmt: skip
    robot = prim.rpartition("/")[0]
    own = [joint for joint in world.joints if within(joint.prim, robot)]
    legs = [joint for joint in own if joint.parent == prim and joint.kind == "revolute" and joint.drive is not None]
    servos = [joint for joint in legs if joint.drive is not None and joint.drive.stiffness > 0.0]
    if robot.count("/") < DEEP or len(servos) < LEGS or any(joint.child == prim for joint in world.joints):
        return None
    why = "its servos hold the pose that it starts in, and nothing walks it"
    return RepairTarget(kind="controller", prim=robot, parameter="policy", direction="add", why=why)
