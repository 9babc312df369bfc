"""Read a robot from URDF or MJCF by MuJoCo's own compiler, with its drives, springs, limits and what may touch."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_joints import KINDS, kind_of, to_axis
from wsim.importers.mujoco_names import body_name, clean, element
from wsim.importers.mujoco_tree import Tree
from wsim.intake.model import IntakeError
from wsim.intake.robot_forms import forms_of
from wsim.intake.robot_model import Link, Mimic, Robot, RobotJoint
from wsim.intake.robot_motors import drive_joints
from wsim.intake.robot_touch import apart_of
from wsim.intake.urdf import compiled

FREE = mujoco.mjtJoint.mjJNT_FREE
_SOLREF, _SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)  # MuJoCo's own
CARRIER = 1e-3  # share of a link's mass and inertia that each part between its several joints takes


def read_robot(path: Path) -> Robot:
    """The robot of a file.

    Raises:
        IntakeError: If MuJoCo does not read it, or nothing in it moves or stands.
    """
    notes: list[str] = []
    model = compiled(path, notes)
    tree = Tree(model)
    bases = _bases(model, tree)
    members = {base: [b for b in range(1, model.nbody) if tree.root(b) == 0 and _top(model, b) == base]
               for base in bases}  # fmt: skip
    members |= {root: tree.members(root) for root in tree.roots}
    if not members:
        raise IntakeError(f"file = {path.name} has no bodies; a robot has links and joints")
    names = _names(model, members)
    links = [_link(model, tree, names[b], b, members[b], notes) for b in sorted(members)]
    owner = {b: names[root] for root, all_of in members.items() for b in all_of}
    robot = Robot(links, [], notes=notes)
    by_name = {link.name: link for link in links}
    for root in tree.roots:
        _hang(model, tree, root, owner, by_name, robot)
    called = [joint.name for joint in robot.joints]
    if twice := {name for name in called if called.count(name) > 1}:
        raise IntakeError(f"joints = {', '.join(sorted(twice))} of {path.name}: two have one name in USD; rename one")
    if not model.njnt:
        notes.append("it has no joints")
    drive_joints(model, robot)
    robot.mimics = list(_mimics(model, robot))
    robot.apart = apart_of(model, tree, owner, notes)
    robot.poses = {element_key(model, k): _pose(model, robot, model.key_qpos[k]) for k in range(model.nkey)}
    notes += _left_out(model)
    robot.notes = list(dict.fromkeys(notes))
    return robot


def _bases(model: Any, tree: Tree) -> list[int]:
    """The bodies straight under the world that nothing lets move."""
    return [b for b in range(1, model.nbody) if tree.root(b) == 0 and int(model.body_parentid[b]) == 0]


def _top(model: Any, b: int) -> int:
    while int(model.body_parentid[b]) != 0:
        b = int(model.body_parentid[b])
    return b


def _names(model: Any, members: dict[int, list[int]]) -> dict[int, str]:
    found: dict[int, str] = {}
    for b in sorted(members):
        name = clean(body_name(model, b))
        while name in (*found.values(), "joints", "materials"):
            name += "_"
        found[b] = name
    return found


def _link(model: Any, tree: Tree, name: str, body: int, members: list[int], notes: list[str]) -> Link:
    frame = tree.pose(body)
    mass, com, inertia = tree.weight(members, frame)
    seen, collides = forms_of(model, tree, members, frame, notes)
    first = int(model.body_jntadr[body])
    free = bool(model.body_jntnum[body]) and kind_of(model, first) == FREE
    return Link(name, *frame, mass, com, inertia, seen, collides, free=free)


def _hang(model: Any, tree: Tree, body: int, owner: dict[int, str], links: dict[str, Link], robot: Robot) -> None:
    """The joints of a body; between several there are light links of the same frame."""
    numbers = [int(model.body_jntadr[body]) + k for k in range(int(model.body_jntnum[body]))]
    numbers = [j for j in numbers if kind_of(model, j) != FREE]
    if not numbers:
        return
    link = links[owner[body]]
    above = int(model.body_parentid[body])
    chain: list[str | None] = [owner.get(above)]
    for j in numbers[:-1]:
        share = CARRIER / len(numbers)
        name = f"{link.name}__{clean(element(model, 'joint', j))}"
        robot.links.append(Link(name, link.at, link.turn, share * link.mass, link.com, share * link.inertia))
        chain.append(name)
    if len(numbers) > 1:
        taken = CARRIER * (len(numbers) - 1) / len(numbers)
        link.mass, link.inertia = (1.0 - taken) * link.mass, (1.0 - taken) * link.inertia
        robot.notes.append(f"links of several joints have light links between, of {CARRIER:g} of their mass at most")
    chain.append(link.name)
    for j, (parent, child) in zip(numbers, pairwise(chain), strict=True):
        assert child is not None
        robot.joints.append(_joint(model, j, parent, child))


def _joint(model: Any, j: int, parent: str | None, child: str) -> RobotJoint:
    kind, at = KINDS[kind_of(model, j)], int(model.jnt_qposadr[j])
    zero = 0.0 if kind == "spherical" else float(model.qpos0[at])
    turn = to_axis(model.jnt_axis[j])
    joint = RobotJoint(clean(element(model, "joint", j)), kind, parent, child, model.jnt_pos[j].copy(), turn, zero)
    if model.jnt_limited[j] and kind != "spherical":
        joint.low, joint.high = (float(x) for x in model.jnt_range[j])
    return joint


def _mimics(model: Any, robot: Robot) -> Iterator[Mimic]:
    """Joints that follow another in proportion."""
    known = {joint.name: joint for joint in robot.joints}
    for e in range(model.neq):
        two = int(model.eq_obj2id[e])
        if model.eq_type[e] != int(mujoco.mjtEq.mjEQ_JOINT) or not model.eq_active0[e]:
            continue
        data = model.eq_data[e]
        follower = known.get(clean(element(model, "joint", int(model.eq_obj1id[e]))))
        leader = known.get(clean(element(model, "joint", two))) if two >= 0 else None
        if follower is None or leader is None or np.any(data[2:5]):
            robot.notes.append("joints that follow another by a curve, or stand still by an equality, do not")
            continue
        # MuJoCo counts both from the reference pose.
        offset = follower.zero + float(data[0]) - float(data[1]) * leader.zero
        yield Mimic(follower.name, leader.name, float(data[1]), offset)


def element_key(model: Any, k: int) -> str:
    """A key frame's name."""
    return str(model.key(k).name or f"key_{k}")


def _pose(model: Any, robot: Robot, qpos: np.ndarray) -> dict[str, float]:
    known = {joint.name for joint in robot.joints if joint.kind != "spherical"}
    named = [(clean(element(model, "joint", j)), int(model.jnt_qposadr[j])) for j in range(model.njnt)]
    return {name: float(qpos[at]) for name, at in named if name in known}


def _left_out(model: Any) -> list[str]:
    """What no stage has, a line each."""
    kinds = mujoco.mjtEq
    ties = [e for e in range(model.neq) if model.eq_type[e] in (int(kinds.mjEQ_CONNECT), int(kinds.mjEQ_WELD))]
    fixed = int((model.geom_bodyid == 0).sum())
    option = model.opt
    found = {
        f"{fixed} shapes of the world itself (floors, tables): put your own": fixed,
        f"{len(ties)} equality constraints that close loops": len(ties),
        f"{model.ntendon} tendons": model.ntendon,
        "a medium that drags": option.density > 0.0 or option.viscosity > 0.0,
        "gravity compensation": bool(np.any(model.body_gravcomp)),
        "deformable parts": model.nflex,
        **_contacts_left_out(model),
    }
    return [f"not carried: {what}" for what, there in found.items() if there]


def _contacts_left_out(model: Any) -> dict[str, bool]:
    """How what collides meets other things, as far as a stage has no words for it."""
    hits = (model.geom_contype > 0) | (model.geom_conaffinity > 0)
    hits &= model.geom_bodyid > 0
    soft = np.any(model.geom_solref != _SOLREF, axis=1) | np.any(model.geom_solimp != _SOLIMP, axis=1)
    option, plain = model.opt, mujoco.MjOption()
    return {
        "softness of contacts (solref, solimp)": bool(np.any(hits & soft)),
        "friction against rolling and spinning (condim above 3)": bool(np.any(hits & (model.geom_condim > 3))),
        "contacts without friction (condim 1): the friction of the shape holds": bool(
            np.any(hits & (model.geom_condim == 1))
        ),
        "how its contacts are solved (cone, impratio)": (option.cone, option.impratio) != (plain.cone, plain.impratio),
        "its sensors": model.nsensor > 0,
    }
