"""Robots of other people: links, joints, drives and limits of a URDF or MJCF file, put into the stage."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from wsim.scene import schema
from wsim.scene.articulation import mark_articulations
from wsim.scene.authoring import Author, Handle, calling_folder, note_line, rotation, set_pose, world_pose
from wsim.scene.reaches import rising, write_reach, write_schedule
from wsim.scene.robot_drives import ROBOT, JointLaw, is_angular, write_drive
from wsim.scene.robot_pose import followed, lowest, one_freedom, place_links
from wsim.scene.validate import Call, shown, suggestion

_HERE = (0.0, 0.0, 0.0)
_MAX_GAIN = 1e9
_FILES = (".urdf", ".xml", ".mjcf")
_LAYERS = (".usd", ".usda", ".usdc")
_SLACK = 1e-6  # [rad or m]: by which a start may lie beyond a limit


@dataclass(frozen=True)
class Robot(Handle):
    """A robot in the scene. Its links and joints are called as in its file, but for signs that USD has not."""

    _stage: Usd.Stage = field(repr=False, compare=False)

    @property
    def _prim(self) -> Usd.Prim:
        return self._stage.GetPrimAtPath(self.path)

    @property
    def links(self) -> list[str]:
        """Names of its links."""
        return [child.GetName() for child in self._prim.GetChildren() if child.HasAPI(UsdPhysics.RigidBodyAPI)]

    @property
    def joints(self) -> list[str]:
        """Names of its joints."""
        return [prim.GetName() for prim in _joints(self._prim)]

    @property
    def notes(self) -> list[str]:
        """What of its file was not carried, or was changed."""
        return list((self._prim.GetCustomDataByKey(ROBOT) or {}).get("notes", []))

    def link(self, name: str) -> Handle:
        """One of its links, for joints and cameras; `SceneError` with those that may be meant."""
        child = self._link(Call("link", name), name)
        return Handle(child.GetName(), str(child.GetPath()), "body" if child.HasAPI(UsdPhysics.RigidBodyAPI) else
                      "static")  # fmt: skip

    def joint(self, name: str) -> Handle:
        """One of its joints; `SceneError` with those that may be meant."""
        prim = _named(Call("joint", name), self._prim, str(name))
        return Handle(prim.GetName(), str(prim.GetPath()), "joint")

    def drive(
        self,
        joint: str,
        *,
        position: float | None = None,
        velocity: float | None = None,
        stiffness: float | None = None,
        damping: float | None = None,
        max_force: float | None = None,
        times: Sequence[float] | None = None,
        positions: Sequence[float] | None = None,
    ) -> None:
        """Let motors hold a position or a velocity, or go by a schedule; in the file's own coordinates.

        What is not given is the file's.

        A servo's effort is stiffness (position - q) + damping (velocity - q'), at most `max_force`; the file's springs
        and dampers act beside it. An effort by itself is what `control` sets: `world.joint(name).force`.

        Args:
            joint: Of a hinge or a slider; a pattern such as "*_knee" means all that it fits.
            position: [deg] or [m]; where it starts, if no velocity is given.
            velocity: [deg/s] or [m/s]. Alone it has no stiffness, unless one is given.
            stiffness: [N m/rad] or [N/m].
            damping: [N m s/rad] or [N s/m].
            max_force: [N m] or [N].
            times: Of a schedule [s], rising, with `positions` and in place of a position and a velocity.
            positions: At each of those times [deg] or [m]: it goes smoothly from one to the next, its speed too is the
                servo's aim, and stands before the first and after the last.

        Raises:
            SceneError: If there is no such joint, or neither the file nor the call says a gain.
        """
        call = Call("drive", joint)
        if (times is None) != (positions is None) or (times is not None and (position, velocity) != (None, None)):
            call.fail("a schedule is times and positions, and no position or velocity beside; give one or the other")
        when = [] if times is None else rising(call, "times", times)
        where = [call.within(f"positions[{k}]", each, -36000.0, 36000.0) for k, each in
                 enumerate(() if positions is None else call.listed("positions", positions, "numbers"))]  # fmt: skip
        fit = [prim for prim in _joints(self._prim) if one_freedom(prim) and fnmatchcase(prim.GetName(), str(joint))]
        for prim in fit or [_named(call, self._prim, str(joint))]:
            if not one_freedom(prim):
                call.fail(f"{prim.GetName()} is no hinge and no slider; a drive needs one")
            law = JointLaw.of(prim)
            free = velocity is not None and position is None
            gain = call.within("stiffness", (0.0 if free else law.motor_stiffness) if stiffness is None else stiffness,
                               0.0, _MAX_GAIN)  # fmt: skip
            damp = call.within("damping", law.motor_damping if damping is None else damping, 0.0, _MAX_GAIN)
            most = law.effort if max_force is None else call.positive("max_force", max_force, _MAX_GAIN, "")
            if gain == 0.0 and (damp == 0.0 or not free):
                call.fail(f"{prim.GetName()}: {_no_servo(prim)}")
            if (position, velocity) != (None, None) and schema.has(prim, schema.SCHEDULE):
                call.fail(f"{prim.GetName()} has a schedule, which says where it goes; leave position and velocity out")
            unit = math.pi / 180.0 if is_angular(prim) else 1.0
            start = float(prim.GetCustomDataByKey(f"{ROBOT}Start") or 0.0)
            goal = start if position is None else call.within("position", position, -36000.0, 36000.0) * unit
            if when:
                goal = where[0] * unit if where else start
                write_schedule(call, prim, when, where)
            speed = 0.0 if velocity is None else call.within("velocity", velocity, -1e6, 1e6) * unit
            law = law.tuned(gain, damp, most)
            law.note(prim)
            write_drive(prim, law, goal, speed)

    def reach(
        self,
        link: str,
        *,
        position: Sequence[float],
        by: float,
        rotation_deg: Sequence[float] | None = None,
        point: Sequence[float] = _HERE,
        start: float | None = None,
    ) -> None:
        """Let servos bring a link to a place: the simulator finds how the joints must stand for it within their limits.

        Of several ways it takes the nearest. The joints go there evenly, with what their load and their speed ask of
        the servos, and stay until the next reach; calls come in the order of time. A place that cannot be reached ends
        the run before it starts, and by how much it is missed is said.

        Args:
            link: Of a chain of hinges and sliders that begins at what is held, all of them with servos.
            position: Where `point` is to be, in the world [m].
            by: When [s].
            rotation_deg: Roll, pitch, yaw of the link in the world [deg]; by default as it comes.
            point: Of the link, in its frame [m]; its origin by default.
            start: When it sets out [s]; by default when the reach before is done, or at 0.

        Raises:
            SceneError: If there is no such link, it is held, or the times are out of order.
        """
        call = Call("reach", link)
        write_reach(call, self._prim, self._link(call, link), [by], [position], rotation_deg, point, start, False)

    def follow(
        self,
        link: str,
        *,
        path: Sequence[Sequence[float]],
        times: Sequence[float],
        rotation_deg: Sequence[float] | None = None,
        point: Sequence[float] = _HERE,
        start: float | None = None,
    ) -> None:
        """Let servos take a point of a link along straight lines, as `reach` takes it to a place.

        It goes straight from where it is to the first way-point, too. It rests at the last, and wherever the way turns
        by more than 20 degrees; others it passes, at a speed that never jumps.

        Args:
            link: As of `reach`.
            path: Way-points (x, y, z) in the world [m].
            times: When it is at each [s], rising.
            rotation_deg: As of `reach`, at all of them; it turns to it on the way to the first.
            point: As of `reach`.
            start: When it sets out for the first way-point [s]; by default when the reach before is done, or at 0.

        Raises:
            SceneError: As `reach`, or if there are not as many times as way-points.
        """
        call = Call("follow", link)
        write_reach(call, self._prim, self._link(call, link), times, path, rotation_deg, point, start, True)

    def _link(self, call: Call, name: str) -> Usd.Prim:
        child = self._prim.GetChild(str(name))
        if not child or not child.IsA(UsdGeom.Xform):
            known = [each.GetName() for each in self._prim.GetChildren() if each.IsA(UsdGeom.Xform)]
            call.fail(f"{self.name} has no such link; {suggestion(str(name), known)}")
        return child


class Robots(Author):
    """The call that places a robot."""

    def robot(
        self,
        name: str,
        file_or_id: str | Path | None = None,
        *,
        position: Sequence[float] = _HERE,
        yaw_deg: float = 0.0,
        pose: str | None = None,
        joints: Mapping[str, float] | None = None,
        fixed: bool | None = None,
        origin: bool = False,
    ) -> Robot:
        """Place a robot; its servos hold the pose that it starts in.

        Args:
            name: Of its prim; its links are prims under it, its joints under "joints".
            file_or_id: A robot that `wsim assets robot FILE --name ID` took in or `wsim assets pull ID` got, or a USD
                file that one of them wrote; by default the robot called `name`.
            position: x and y of its file's origin, z of the lowest point of what collides of it [m].
            yaw_deg: About the vertical [deg].
            pose: A key frame of the file to start in; by default "home" if it has one, else its reference pose, within
                its limits.
            joints: Where joints start, by name [deg] or [m], in the file's coordinates; over `pose`.
            fixed: Hold its base to the world, or let it go; by default as in the file (a URDF's is fixed).
            origin: z of `position` is that of the file's origin, too.

        Raises:
            SceneError: If there is no such robot, pose or joint, a start lies beyond a limit, or a base without mass
                is let go.
        """
        call = Call("robot", name)
        path = self._path(call)
        file_or_id = name if file_or_id is None else file_or_id
        place = call.position("position", position)
        yaw = call.within("yaw_deg", yaw_deg, -36000.0, 36000.0, "deg")
        layer = Sdf.Layer.OpenAsAnonymous(str(_layer(call, file_or_id)))
        if not layer.defaultPrim or not _noted(layer):
            call.fail(f"{shown(str(file_or_id))} is no robot's layer; `wsim assets robot FILE --name ID` writes one")
        Sdf.CopySpec(layer, Sdf.Path(f"/{layer.defaultPrim}"), self._stage.GetRootLayer(), Sdf.Path(path))
        prim = self._stage.GetPrimAtPath(path)
        try:
            start = _start(call, prim, pose, joints)
            place_links(prim, _joints(prim), start)
            set_pose(prim, place, rotation((0.0, 0.0, yaw)))
            low = None if call.flag("origin", origin) else lowest(prim)
            if low is not None:
                set_pose(prim, (place[0], place[1], 2.0 * place[2] - low), rotation((0.0, 0.0, yaw)))
            self._hold(call, prim, fixed)
        except Exception:
            self._stage.RemovePrim(path)
            raise
        for joint in _joints(prim):
            note_line(joint)
            if joint.GetName() in start:
                joint.SetCustomDataByKey(f"{ROBOT}Start", start[joint.GetName()])
                write_drive(joint, JointLaw.of(joint), start[joint.GetName()])
        for part in (prim, *prim.GetChildren()):
            note_line(part)
        mark_articulations(self._stage)
        return Robot(prim.GetName(), path, "robot", self._stage)

    def _hold(self, call: Call, robot: Usd.Prim, fixed: bool | None) -> None:
        """Make what the robot's trees begin with part of the world, or let it go; joints to the world are put there."""
        hung = {path for joint in _joints(robot) for path in UsdPhysics.Joint(joint).GetBody1Rel().GetTargets()}
        links = [child for child in robot.GetChildren() if child.IsA(UsdGeom.Xform)]
        for base in (link for link in links if link.GetPath() not in hung):
            free = bool((base.GetCustomDataByKey(ROBOT) or {}).get("free"))
            if fixed is None or call.flag("fixed", fixed):
                if not free or fixed:
                    base.RemoveAPI(UsdPhysics.RigidBodyAPI)
                    base.RemoveAPI(UsdPhysics.MassAPI)
            elif not base.HasAPI(UsdPhysics.RigidBodyAPI):
                call.fail(f"fixed = False, and its base {base.GetName()} has no mass in its file; leave it fixed")
        for prim in _joints(robot):
            joint = UsdPhysics.Joint(prim)
            above = joint.GetBody0Rel().GetTargets()
            holder = self._stage.GetPrimAtPath(above[0]) if above else robot
            if holder.HasAPI(UsdPhysics.RigidBodyAPI):
                continue
            place, turn = world_pose(holder)
            joint.GetLocalPos0Attr().Set(Gf.Vec3f(place + turn.Transform(Gf.Vec3d(joint.GetLocalPos0Attr().Get()))))
            joint.GetLocalRot0Attr().Set(Gf.Quatf(turn * Gf.Quatd(joint.GetLocalRot0Attr().Get())))
            joint.GetBody0Rel().ClearTargets(True)
            if above:
                prim.CreateRelationship("wsim:fixture", custom=False).SetTargets(above)


def _no_servo(prim: Usd.Prim) -> str:
    """Why a joint cannot be led, and what can."""
    leader = followed(prim)
    if leader is not None:
        return f"it follows {leader[0]}, whose servo moves both; leave it out"
    return "its file has no servo for that; give a stiffness and a damping, or of a velocity a damping"


def _layer(call: Call, named: str | Path) -> Path:
    """The USD layer of a robot."""
    from wsim.assets.robots import robot_path  # few programs have a robot
    from wsim.errors import UserError

    if not isinstance(named, (str, Path)) or not str(named):
        call.fail(f"file_or_id = {shown(named)} must be the id of a robot, or the path of its layer")
    suffix = Path(named).suffix.lower()
    if suffix in _FILES:
        call.fail(
            f"file_or_id = {shown(str(named))}: take it in once, `wsim assets robot {named} --name ID`, and name its ID"
        )
    if suffix in _LAYERS:
        folder = calling_folder()
        path = Path(named) if Path(named).is_absolute() or folder is None else folder / named
        if not path.is_file():
            call.fail(f"file_or_id = {shown(str(named))} is not there")
        return path
    try:
        return robot_path(str(named))
    except UserError as error:
        call.fail(f"file_or_id: {error}")


def _noted(layer: Sdf.Layer) -> bool:
    """Whether a layer holds what `wsim.intake.robot_write` writes."""
    space, _, key = ROBOT.partition(":")
    return key in layer.GetPrimAtPath(f"/{layer.defaultPrim}").customData.get(space, {})


def _joints(robot: Usd.Prim) -> list[Usd.Prim]:
    return [prim for prim in robot.GetChild("joints").GetChildren() if prim.IsA(UsdPhysics.Joint)]


def _named(call: Call, robot: Usd.Prim, name: str, argument: str = "joint") -> Usd.Prim:
    found = next((prim for prim in _joints(robot) if prim.GetName() == name), None)
    if found is None:
        names = [prim.GetName() for prim in _joints(robot)]
        call.fail(f"{argument} = {shown(name)} is none of {robot.GetName()}; {suggestion(name, names)}")
    return found


def _start(call: Call, robot: Usd.Prim, pose: str | None, joints: Mapping[str, float] | None) -> dict[str, float]:
    """Where each hinge and slider starts [rad or m]."""
    movable = [prim for prim in _joints(robot) if one_freedom(prim)]
    found = {prim.GetName(): min(max(JointLaw.of(prim).zero, _limits(prim)[0]), _limits(prim)[1]) for prim in movable}
    poses = robot.GetCustomDataByKey(ROBOT).get("poses", {})
    pose = "home" if pose is None and "home" in poses else pose
    if pose is not None:
        if not isinstance(pose, str) or pose not in poses:
            call.fail(f"pose = {shown(pose)} is none of its file's; {suggestion(str(pose), poses)}")
        found |= {str(key): float(value) for key, value in poses[pose].items()}
    if joints is not None and not isinstance(joints, Mapping):
        call.fail(f'joints = {shown(joints)} must be angles by name, such as {{"elbow": 90.0}}')
    for name, value in (joints or {}).items():
        prim = _named(call, robot, str(name), "joints")
        if str(name) not in found:
            call.fail(f"joints: {name} is no hinge and no slider; it starts as in the file")
        unit = math.pi / 180.0 if is_angular(prim) else 1.0
        found[str(name)] = call.number(f"joints[{shown(name)}]", value) * unit
    for prim in movable:
        leader = followed(prim)
        if leader is not None and prim.GetName() not in (joints or {}):
            found[prim.GetName()] = leader[2] + leader[1] * found[leader[0]]
        _within(call, prim, found[prim.GetName()])
    return found


def _limits(prim: Usd.Prim) -> tuple[float, float]:
    """A joint's stops [rad or m]; infinite where it has none."""
    unit = math.pi / 180.0 if is_angular(prim) else 1.0
    low, high = (prim.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper"))
    return float(low) * unit, float(high) * unit


def _within(call: Call, prim: Usd.Prim, value: float) -> None:
    (low, high), (unit, of) = _limits(prim), (math.pi / 180.0, "deg") if is_angular(prim) else (1.0, "m")
    if not low - _SLACK <= value <= high + _SLACK:
        call.fail(
            f"{prim.GetName()} would start at {value / unit:.6g} {of}, beyond its limits {low / unit:.6g} to "
            f"{high / unit:.6g} {of}; give joints={{{prim.GetName()!r}: ...}} between"
        )
