"""A stage as Newton's USD importer takes it, and the joints that it leaves outside any articulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pxr import Sdf, Usd

from wsim.scene.describe_joints import is_mimic
from wsim.scene.world import World

PER_ARTICULATION = ("articulation_start", "articulation_end", "articulation_label", "articulation_world")


def importable(path: Path, world: World) -> Usd.Stage:
    """A stage without the joints that are constraints and without mimics, which `wsim.sim.constraints` adds.

    Newton's importer takes few loops, and couples joints of one articulation alone.
    """
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    for joint in world.joints:
        if joint.closing:
            stage.GetPrimAtPath(joint.prim).SetActive(False)
    for prim in stage.Traverse():
        if is_mimic(prim):
            prim.CreateAttribute("newton:mimicEnabled", Sdf.ValueTypeNames.Bool, False).Set(False)
    return stage


def complete_articulations(builder: Any) -> None:
    """Give every joint that holds a body of its own an articulation.

    UsdPhysics' parser lists no bodies for a single body jointed to the world, so the importer of Newton 1.8 adds the
    joint but no articulation, and MuJoCo's solver then never moves the body.

    Args:
        builder: The `newton.ModelBuilder` that a stage was imported into, before worlds are replicated.
    """
    held = {builder.joint_child[j] for j in range(builder.joint_count) if builder.joint_articulation[j] >= 0}
    for joint in range(builder.joint_count):
        child = builder.joint_child[joint]
        if builder.joint_articulation[joint] < 0 and child not in held:
            builder.add_articulation([joint], label=builder.joint_label[joint])
            held.add(child)
    _sort_by_first_joint(builder)


def _sort_by_first_joint(builder: Any) -> None:
    """Newton's model needs the articulations in the order of their joints."""
    order = sorted(range(len(builder.articulation_start)), key=builder.articulation_start.__getitem__)
    for name in PER_ARTICULATION:
        values = getattr(builder, name)
        setattr(builder, name, [values[k] for k in order])
    rank = {old: new for new, old in enumerate(order)}
    builder.joint_articulation = [rank.get(k, -1) for k in builder.joint_articulation]
