"""Read a robot from USD: a tree of UsdPhysics joints with one `PhysicsArticulationRootAPI`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdPhysics

from wsim.errors import UserError
from wsim.geometry.rotations import matrices, multiply, rotate
from wsim.importers.mujoco_names import clean
from wsim.intake.model import Array, IntakeError
from wsim.intake.robot_model import Link, Mimic, Motor, Robot, RobotJoint
from wsim.intake.robot_usd_forms import forms_of
from wsim.intake.robot_usd_joints import FIXED, Hinge, hinges_of
from wsim.scene.describe import describe
from wsim.scene.world import Body, World

Pose = tuple[Array, Array]  # place [m] and turn xyzw

NOWHERE: Pose = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
CARRIER = 1e-3  # share of a link's mass and inertia that the parts between its several joints take
OFF = 1e-4  # [rad or m]: by which a coordinate is not 0
SELF = ("newton:selfCollisionEnabled", "physxArticulation:enabledSelfCollisions")


def read_usd_robot(path: Path) -> Robot:
    """The robot of a USD file. Links stand where the joints are at 0; as the file has them is the pose "home".

    Raises:
        IntakeError: If it does not open, is not in metres, kilograms and Z up, or holds no robot, or several.
    """
    try:
        stage = Usd.Stage.Open(str(path))
        world = describe(stage)
    except Tf.ErrorException as error:
        raise IntakeError(f"file = {path.name} does not open: {str(error).splitlines()[0]}") from error
    except UserError as error:
        raise IntakeError(f"file = {error}") from error
    roots = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    if len(roots) != 1:
        names = "".join(f", {prim.GetPath()}" for prim in roots[:4])
        raise IntakeError(
            f"file = {path.name} has {len(roots)} prims with PhysicsArticulationRootAPI{names}; a robot has one: give "
            "a file of one"
        )
    notes: list[str] = []
    tree = _Tree.of(stage, world, list(hinges_of(stage, world, notes)), notes)
    robot = tree.robot(stage)
    called = [joint.name for joint in robot.joints]
    if twice := sorted({name for name in called if called.count(name) > 1}):
        raise IntakeError(f"file = {path.name} has two joints of the name {twice[0]}; rename one")
    robot.apart += _apart(stage, roots[0], world, tree, robot)
    robot.notes = list(dict.fromkeys([*notes, *_left_out(stage)]))
    return robot


@dataclass(frozen=True)
class _Tree:
    """Bodies that hang together: what hangs by which joints on what, and what is part of which link."""

    bodies: dict[str, Body]
    hangs: dict[str, list[Hinge]]  # of a link the joints that it hangs by, the parent's end first
    part_of: dict[str, tuple[str, Pose]]  # the link of each body, and where it is in that
    held: set[str]  # links that are fixed to the world
    names: dict[str, str]
    mimics: tuple[Mimic, ...]

    @classmethod
    def of(cls, stage: Usd.Stage, world: World, joints: list[Hinge], notes: list[str]) -> _Tree:
        bodies = {body.prim: body for body in world.bodies}
        above: dict[str, list[Hinge]] = {}
        for joint in _outwards(joints, notes):
            above.setdefault(joint.child, []).append(joint)
        part_of: dict[str, tuple[str, Pose]] = {}
        held: set[str] = set()

        def place(body: str) -> tuple[str, Pose]:
            if body not in part_of:
                own = above.get(body, [])
                part_of[body] = body, NOWHERE
                if len(own) == 1 and own[0].kind == FIXED:
                    if own[0].parent is None:
                        held.add(body)
                    else:
                        link, pose = place(own[0].parent)
                        part_of[body] = link, _after(pose, own[0].between)
            return part_of[body]

        for body in bodies:
            place(body)
        hangs = {
            body: [joint for joint in own if joint.kind != FIXED]
            for body, own in above.items() if part_of[body][0] == body
        }  # fmt: skip
        ends = {joint.prim: joint.name for own in hangs.values() for joint in own}
        mimics = tuple(
            Mimic(ends[gear.second], ends[gear.first], gear.ratio, gear.offset)
            for gear in world.gears if gear.first in ends and gear.second in ends
        )  # fmt: skip
        return cls(bodies, {body: own for body, own in hangs.items() if own}, part_of, held, _names(bodies), mimics)

    def robot(self, stage: Usd.Stage) -> Robot:
        """All of it."""
        robot = Robot([], [], list(self.mimics))
        poses: dict[str, Pose] = {}
        for body in self._ordered():
            members = [(each, pose) for each, (link, pose) in self.part_of.items() if link == body]
            poses[body] = self._pose(body, poses)
            link = self._link(stage, body, members, poses[body])
            robot.links.append(link)
            self._hang(robot, link, body)
        home = {joint.name: joint.at for own in self.hangs.values() for joint in own if joint.moves}
        if any(abs(at) > OFF for at in home.values()):
            robot.poses = {"home": home}
        return robot

    def _ordered(self) -> list[str]:
        """The links, parents first."""
        found: list[str] = []

        def add(body: str) -> None:
            if body in found:
                return
            for joint in self.hangs.get(body, [])[:1]:
                if joint.parent is not None:
                    add(self.part_of[joint.parent][0])
            found.append(body)

        for body, (link, _) in self.part_of.items():
            if body == link:
                add(body)
        return found

    def _pose(self, body: str, poses: dict[str, Pose]) -> Pose:
        """Where a link is with all joints at 0."""
        own = self.hangs.get(body, [])
        if not own:
            return _of(self.bodies[body])
        first = own[0]
        base = NOWHERE
        if first.parent is not None:
            link, pose = self.part_of[first.parent]
            base = _after(poses[link], pose)
        return _after(base, first.between)

    def _link(self, stage: Usd.Stage, body: str, members: list[tuple[str, Pose]], pose: Pose) -> Link:
        mass = sum(self.bodies[each].mass for each, _ in members)
        com = sum((self.bodies[each].mass * _at(self.bodies[each], own) for each, own in members), np.zeros(3))
        com = com / mass if mass else com
        inertia = np.zeros((3, 3))
        for each, own in members:
            part, turn = self.bodies[each], matrices(own[1])
            arm = _at(part, own) - com
            inertia += turn @ np.array(part.inertia).reshape(3, 3) @ turn.T
            inertia += part.mass * ((arm @ arm) * np.eye(3) - np.outer(arm, arm))
        seen, solid = forms_of(stage, [(self.bodies[each], own) for each, own in members])
        free = body not in self.held and body not in self.hangs
        return Link(self.names[body], *pose, mass, com, inertia, seen, solid, free=free)

    def _hang(self, robot: Robot, link: Link, body: str) -> None:
        """The joints of a link; between several there are light links of the same frame."""
        own = self.hangs.get(body, [])
        if not own:
            return
        chain: list[str | None] = [None if own[0].parent is None else self.names[self.part_of[own[0].parent][0]]]
        for joint in own[:-1]:
            share = CARRIER / len(own)
            name = f"{link.name}__{joint.name}"
            robot.links.append(Link(name, link.at, link.turn, share * link.mass, link.com, share * link.inertia))
            chain.append(name)
        if len(own) > 1:
            taken = CARRIER * (len(own) - 1) / len(own)
            link.mass, link.inertia = (1.0 - taken) * link.mass, (1.0 - taken) * link.inertia
            robot.notes.append(
                f"links of several joints have light links between, of {CARRIER:g} of their mass at most"
            )
        chain.append(link.name)
        robot.joints += [
            _joint(joint, parent, str(child)) for joint, (parent, child) in zip(own, pairwise(chain), strict=True)
        ]


def _joint(joint: Hinge, parent: str | None, child: str) -> RobotJoint:
    if joint.kind == FIXED:
        raise ValueError(joint.prim)
    motor = None
    if joint.motor is not None:
        motor = Motor(joint.motor.stiffness, joint.motor.damping, joint.motor.max_effort)
    return RobotJoint(
        joint.name, joint.kind, parent, child, *joint.child_frame, low=joint.low, high=joint.high,
        friction=joint.friction, armature=joint.armature, motor=motor,
        effort=joint.motor.max_effort if joint.motor else None, fastest=joint.fastest,
    )  # fmt: skip


def _outwards(joints: list[Hinge], notes: list[str]) -> Iterator[Hinge]:
    """Joints from what is held, or from what hangs on nothing, outwards; without what closes a loop."""
    reached: set[str | None] = {None}
    waiting = [[each for each in joints if each.group == group] for group in dict.fromkeys(j.group for j in joints)]
    while waiting:
        ready = next((own for own in waiting if own[0].parent in reached or own[0].child in reached), None)
        if ready is None:  # the rest hangs on nothing that is held
            children = {joint.child for own in waiting for joint in own}
            reached.add(next((own[0].parent for own in waiting if own[0].parent not in children), waiting[0][0].parent))
            continue
        waiting.remove(ready)
        if ready[0].parent not in reached:
            ready = [joint.turned() for joint in reversed(ready)]
        if ready[0].child in reached:
            notes.append("not carried: joints that close a loop")
            continue
        reached.add(ready[0].child)
        yield from ready


def _names(bodies: dict[str, Body]) -> dict[str, str]:
    found: dict[str, str] = {}
    for body in bodies:
        name = clean(body.rpartition("/")[2])
        while name in (*found.values(), "joints", "materials"):
            name += "_"
        found[body] = name
    return found


def _apart(stage: Usd.Stage, root: Usd.Prim, world: World, tree: _Tree, robot: Robot) -> list[tuple[str, str]]:
    """Pairs of links that never touch: filtered, or all where the file switches touching off."""
    solid = [link.name for link in robot.links if link.collides]
    joined = {frozenset((joint.parent, joint.child)) for joint in robot.joints}
    for name in SELF:
        attribute = root.GetAttribute(name)
        if attribute and attribute.HasAuthoredValue() and not attribute.Get():
            return [pair for pair in combinations(solid, 2) if frozenset(pair) not in joined]
    found = set()
    for one, two in world.apart:
        ends = [tree.names[tree.part_of[each][0]] for each in (one, two) if each in tree.part_of]
        if len(ends) == 2 and ends[0] != ends[1]:
            found.add((ends[0], ends[1]))
    return sorted(found)


def _left_out(stage: Usd.Stage) -> list[str]:
    """What no layer of a robot has, a line each."""
    prims = list(stage.Traverse())
    names = {str(each.GetName()) for prim in prims for each in prim.GetAuthoredAttributes()}
    spaces = {name.partition(":")[0] for name in names}
    held = {prim.GetPath() for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)}
    world = [prim for prim in prims if prim.IsA(UsdGeom.Gprim) and prim.HasAPI(UsdPhysics.CollisionAPI)
             and not any(path in held for path in prim.GetPath().GetPrefixes())]  # fmt: skip
    found = {
        f"{len(world)} shapes of the world itself (floors, tables): put your own": bool(world),
        "what its drives go for: they hold the pose that it starts in": any(
            name.endswith(("targetPosition", "targetVelocity")) for name in names
        ),
        "what PhysX alone reads (physx*), but for speed limits, armature, friction and self-collision": any(
            space.startswith("physx") for space in spaces
        ),
        "what MuJoCo alone reads (mjc:*)": "mjc" in spaces,
        "textures": any(prim.GetTypeName() == "Shader" and prim.GetAttribute("inputs:file") for prim in prims),
        "tendons": any("Tendon" in name for prim in prims for name in prim.GetAppliedSchemas()),
    }
    return [f"not carried: {what}" for what, there in found.items() if there]


def _of(body: Body) -> Pose:
    return np.array(body.position), np.array(body.rotation)


def _at(body: Body, own: Pose) -> Array:
    return np.asarray(own[0] + rotate(own[1], np.array(body.com)))


def _after(first: Pose, second: Pose) -> Pose:
    return first[0] + rotate(first[1], second[0]), multiply(first[1], second[1])
