"""Motion that a world states: surfaces that move as belts do, and kinematic bodies that go through key frames."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim.geometry.paths import Curve
from wsim.limits import MAX_DURATION, MAX_KEYS, MAX_PATH_SPEED, MAX_PATH_SPIN
from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, rotation, set_pose, world_pose
from wsim.scene.validate import Call, Vec3, shown

_MOST_SAMPLES = 5000  # of a path, for other tools
_LARGEST_TURN = 170.0  # [deg], from key to key: of more than half a turn the way round could not be told

_SAME_PLACE = 1e-6  # [m]
_SAME_TURN = 1e-3  # [deg]


class Motions(Author):
    """The calls that state a motion."""

    def __init__(self) -> None:
        super().__init__()
        self._paths: dict[str, Curve] = {}

    def surface_velocity(self, body: Handle | str, *, velocity: Sequence[float]) -> None:
        """Let the surface of an object move as a conveyor's or a treadmill's does, while the object stays.

        What touches it is carried by friction, as by a belt that runs under it, and pushes back on the object.

        Args:
            body: A static object, or a body; a handle or a name. All its colliders move so.
            velocity: (x, y, z) in the object's own axes, and turns with it [m/s]. Only its part along the surface acts:
                (1, 0, 0) on a box moves its top, its bottom and two of its sides. Zeros stop it.

        Raises:
            SceneError: If there is no such object, nothing of it collides, it has a surface velocity already, or the
                velocity is out of range.
        """
        call = Call("surface_velocity", getattr(body, "name", body))
        prim = self._find(call, "body", body)
        speed = call.velocity(velocity)
        if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim)):
            call.fail(f'body = "{prim.GetName()}" has nothing that collides; name a solid')
        if schema.has(prim, schema.SURFACE_VELOCITY):
            now = tuple(prim.GetAttribute("wsim:surfaceVelocity").Get())
            call.fail(f'body = "{prim.GetName()}" has a surface velocity already, {now} m/s; give it one')
        value = Gf.Vec3f(*speed)
        schema.apply(prim, schema.SURFACE_VELOCITY, {"surfaceVelocity": (Sdf.ValueTypeNames.Vector3f, value)})

    def path(
        self,
        body: Handle | str,
        *,
        times: Sequence[float],
        positions: Sequence[Sequence[float]] | None = None,
        rotations_deg: Sequence[Sequence[float]] | None = None,
        repeat: bool = False,
    ) -> None:
        """Let a kinematic body go through key frames, whatever it meets; it pushes, carries and stops what it meets.

        It is where the keys have it at their times, goes smoothly from one to the next (its velocity never jumps, and
        it never overshoots: between two equal keys it stands still). It waits where it stands until the first key's
        time, and the first key is where it stands.

        Args:
            body: Made with kinematic=True and no velocity; a handle or a name.
            times: Of the keys, rising [s]; two or more.
            positions: (x, y, z) at each, in the world [m]; by default where it stands.
            rotations_deg: Roll, pitch, yaw at each [deg], less than half a turn from key to key; by default as it is.
            repeat: Start anew after the last key, which must then equal the first; else it holds there.

        Raises:
            SceneError: If the body is not kinematic, has a path already, stands elsewhere than the first key, keys are
                missing or out of order, or it would jump.
        """
        call = Call("path", getattr(body, "name", body))
        prim = self._leads(call, body)
        if str(prim.GetPath()) in self._paths:
            call.fail(f'body = "{prim.GetName()}" has a path already; give it one, with all of its keys')
        when = _times(call, times)
        if positions is None and rotations_deg is None:
            call.fail("neither positions nor rotations_deg is given; give one, or both")
        place, turn = world_pose(prim)
        there, here = (place[0], place[1], place[2]), [turn] * len(when)
        places = [there] * len(when) if positions is None else _vectors(call, "positions", positions, len(when))
        if rotations_deg is not None:
            here = _turns(call, _vectors(call, "rotations_deg", rotations_deg, len(when)))
        if call.flag("repeat", repeat) and (places[0] != places[-1] or abs(Gf.Dot(here[0], here[-1])) < 1.0 - 1e-9):
            call.fail(f"repeat = True, and the last key, {places[-1]}, is not the first, {places[0]}; end as it begins")
        self._check_start(call, prim, places[0], here[0])
        turned = [[*q.GetImaginary(), q.GetReal()] for q in here]
        curve = Curve.through(when, places, turned, repeat)
        _check_speed(call, curve)
        names = Sdf.ValueTypeNames
        values: dict[str, tuple[Sdf.ValueTypeName, object]] = {
            "times": (names.DoubleArray, Vt.DoubleArray(when)),
            "positions": (names.Point3dArray, Vt.Vec3dArray([Gf.Vec3d(*at) for at in places])),
            "rotations": (names.QuatdArray, Vt.QuatdArray(here)),
            "repeat": (names.Bool, bool(repeat)),
        }
        schema.apply(prim, schema.PATH, values)
        start, q = curve.pose(0.0)
        set_pose(prim, (float(start[0]), float(start[1]), float(start[2])), Gf.Quatd(q[3], Gf.Vec3d(*q[:3])))
        self._paths[str(prim.GetPath())] = curve

    def _leads(self, call: Call, body: Handle | str) -> Usd.Prim:
        """The kinematic body that an argument means."""
        prim = self._find(call, "body", body)
        api = UsdPhysics.RigidBodyAPI(prim)
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI) or not api.GetKinematicEnabledAttr().Get():
            call.fail(f'body = "{prim.GetName()}" is not kinematic; make it with kinematic=True')
        if any(api.GetVelocityAttr().Get()) or any(api.GetAngularVelocityAttr().Get()):
            call.fail(f'body = "{prim.GetName()}" has a velocity, too; leave it out: the path gives it')
        return prim

    @staticmethod
    def _check_start(call: Call, prim: Usd.Prim, first: Vec3, turn: Gf.Quatd) -> None:
        """The first key is where the body stands, which was said of it where it was made."""
        at, now = world_pose(prim)
        if (Gf.Vec3d(*first) - at).GetLength() > _SAME_PLACE:
            call.fail(
                f'positions[0] = {shown(tuple(first))} is not where "{prim.GetName()}" stands, {_short(at)} m; make it '
                "there, or begin with that key"
            )
        angle = math.degrees(2.0 * math.acos(min(1.0, abs(Gf.Dot(turn, now)))))
        if angle > _SAME_TURN:
            call.fail(
                f'rotations_deg[0] turns "{prim.GetName()}" by {angle:.4g} deg from how it stands; make it so, or '
                "begin with that key"
            )

    def _bake_paths(self, duration: float, rate: float) -> None:
        """Author each path as time samples of the body's transform, one a frame, which every USD tool plays."""
        for path, curve in self._paths.items():
            prim = self._stage.GetPrimAtPath(path)
            if prim:
                _bake(prim, curve, round(duration * rate), rate)


def _short(place: Gf.Vec3d) -> str:
    return f"({place[0]:.6g}, {place[1]:.6g}, {place[2]:.6g})"


def _bake(prim: Usd.Prim, curve: Curve, frames: int, rate: float) -> None:
    xform = UsdGeom.Xformable(prim)
    ops = {op.GetOpType(): op for op in xform.GetOrderedXformOps()}
    move = ops.get(UsdGeom.XformOp.TypeTranslate) or xform.AddTranslateOp()
    turn = ops.get(UsdGeom.XformOp.TypeOrient) or xform.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    xform.SetXformOpOrder([move, turn])
    codes = range(0, frames + 1, max(1, math.ceil(frames / _MOST_SAMPLES)))
    for time in (Usd.TimeCode.Default(), *(Usd.TimeCode(code) for code in codes)):
        place, q = curve.pose(0.0 if time.IsDefault() else time.GetValue() / rate)
        move.Set(Gf.Vec3d(*place), time)
        turn.Set(Gf.Quatd(q[3], Gf.Vec3d(*q[:3])), time)


def _times(call: Call, times: Sequence[float]) -> list[float]:
    listed = call.listed("times", times, "two or more numbers in s")
    when = [call.within(f"times[{k}]", time, 0.0, MAX_DURATION, "s") for k, time in enumerate(listed)]
    if not 2 <= len(when) <= MAX_KEYS:
        call.fail(f"times has {len(when)} keys; it must have 2 to {MAX_KEYS}")
    for k in range(1, len(when)):
        if when[k] <= when[k - 1]:
            call.fail(f"times[{k}] = {when[k]:g} s must be later than times[{k - 1}] = {when[k - 1]:g} s")
    return when


def _vectors(call: Call, field: str, values: Sequence[Sequence[float]], count: int) -> list[Vec3]:
    items = call.listed(field, values, "a list of (x, y, z), one for each of times")
    if len(items) != count:
        call.fail(f"{field} has {len(items)} keys, and times has {count}; give one for each")
    if field == "positions":
        return [call.position(f"{field}[{k}]", item) for k, item in enumerate(items)]
    return [call.vector(f"{field}[{k}]", item, 1e6, "deg") for k, item in enumerate(items)]


def _turns(call: Call, degrees: list[Vec3]) -> list[Gf.Quatd]:
    for k in range(1, len(degrees)):
        most = max(abs(a - b) for a, b in zip(degrees[k], degrees[k - 1], strict=True))
        if most > _LARGEST_TURN:
            call.fail(
                f"rotations_deg[{k}] is {most:g} degrees from rotations_deg[{k - 1}]; give keys between, "
                f"{_LARGEST_TURN:g} degrees apart at most"
            )
    return [rotation(value) for value in degrees]


def _check_speed(call: Call, curve: Curve) -> None:
    for values, most, unit in zip(curve.speeds(), (MAX_PATH_SPEED, MAX_PATH_SPIN), ("m/s", "rad/s"), strict=True):
        k = int(np.argmax(values))
        if values[k] > most:
            call.fail(
                f"from times[{k}] to times[{k + 1}] it would go at {values[k]:.4g} {unit}, a jump; at most {most:g} "
                f"{unit}: give it more time"
            )
