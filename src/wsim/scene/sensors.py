"""Sensors on bodies and joints."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim.defaults import PIXEL_CHANNELS
from wsim.limits import MAX_PIXELS, MAX_POSITION, MAX_RATE, MAX_RAYS, MIN_RATE
from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, note_line, rotation, set_pose, world_pose
from wsim.scene.validate import Call, shown
from wsim.scene.views import write_lens

_MOST_NOISE = 1e3  # [m/s^2/sqrt(Hz)], [rad/s/sqrt(Hz)]
_MOST_BIAS = 1e3  # [m/s^2], [rad/s]
_MOST_FORCE = 1e9  # [N]
_MAX_SEED = 2**31 - 1
_HERE = (0.0, 0.0, 0.0)
# From a sensor's frame, which looks along +X with +Z up, to USD's, along -Z with +Y up.
_LENS = Gf.Matrix3d(0, -1, 0, 0, 0, 1, -1, 0, 0).ExtractRotation().GetQuat()
Values = dict[str, tuple[Sdf.ValueTypeName, object]]


class Sensors(Author):
    """The calls that put sensors on bodies and joints."""

    def sensor_imu(
        self,
        name: str,
        body: Handle | str,
        *,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        rate: float = 100.0,
        accelerometer_noise: float = 0.0,
        gyroscope_noise: float = 0.0,
        accelerometer_bias: Sequence[float] = _HERE,
        gyroscope_bias: Sequence[float] = _HERE,
        seed: int | None = None,
    ) -> Handle:
        """Fix an inertial measurement unit to a body: an accelerometer and a gyroscope, in the sensor's own frame.

        The accelerometer tells the specific force [m/s^2] at its place, acceleration less gravity: 9.81 upwards at
        rest, 0 in free fall, and what turning adds away from the centre of mass. It is the mean since the sample
        before: the change of velocity, over the time between. The gyroscope tells the angular velocity [rad/s] at the
        sample.

        Args:
            name: Of its prim.
            body: That moves; a handle or a name.
            position: Of the sensor, in the body's frame [m].
            rotation_deg: Roll, pitch, yaw of its frame, in the body's [deg].
            rate: Samples a second [Hz]; the time between is rounded to whole steps, one at least.
            accelerometer_noise: Density of white noise [m/s^2/sqrt(Hz)]: a sample is off by that times sqrt(rate).
            gyroscope_noise: The same of the gyroscope [rad/s/sqrt(Hz)].
            accelerometer_bias: Added to each sample [m/s^2].
            gyroscope_bias: [rad/s].
            seed: Of its noise; by default the world's. Sensors of other names have noise of their own.

        Raises:
            SceneError: If nothing moves the body, or a number is out of range.
        """
        call = Call("sensor_imu", name)
        path = self._path(call)
        prim = self._rigid_body(call, "body", body)
        names = Sdf.ValueTypeNames
        values: Values = {}
        for part, noise, bias, unit in (
            ("accelerometer", accelerometer_noise, accelerometer_bias, "m/s^2"),
            ("gyroscope", gyroscope_noise, gyroscope_bias, "rad/s"),
        ):
            density = call.within(f"{part}_noise", noise, 0.0, _MOST_NOISE, f"{unit}/sqrt(Hz)")
            values[f"{part}Noise"] = (names.Double, density)
            offset = call.vector(f"{part}_bias", bias, _MOST_BIAS, unit)
            values[f"{part}Bias"] = (names.Vector3d, Gf.Vec3d(*offset))
        values |= _seed(call, seed) | _mounting(call, position, rotation_deg) | _rate(call, rate)
        made = self._sensor(path, schema.SENSOR_IMU, values)
        made.CreateRelationship("wsim:body", custom=False).SetTargets([prim.GetPath()])
        return Handle(made.GetName(), path, "sensor")

    def sensor_joints(self, name: str, joints: Handle | str | Sequence[Handle | str], *, rate: float = 100.0) -> Handle:
        """Read position, velocity and effort of hinges and sliders, in the order in which they are given.

        Positions and velocities are those that drives and `control` have, [rad] and [rad/s] or [m] and [m/s]. The
        effort [N m] or [N] is what the joint's drive and `control` gave along its motion in the last step; stops,
        friction and what the joint only bears are not in it.

        Args:
            name: Of its prim.
            joints: One or several, handles or names; a robot stands for all its hinges and sliders.
            rate: Samples a second [Hz]; the time between is rounded to whole steps, one at least.

        Raises:
            SceneError: If one is no hinge and no slider, one is named twice, or the rate is out of range.
        """
        call = Call("sensor_joints", name)
        path = self._path(call)
        several = joints if isinstance(joints, (list, tuple)) else [joints]
        found = [joint for k, each in enumerate(several) for joint in self._freedoms(call, f"joints[{k}]", each)]
        paths = [joint.GetPath() for joint in found]
        if not paths:
            call.fail(f"joints = {shown(joints)} has none; name the joints to be read")
        for k, one in enumerate(paths):
            if one in paths[:k]:
                call.fail(f'joints = {shown(joints)} has "{one.name}" twice; name it once')
        made = self._sensor(path, schema.SENSOR_JOINTS, _rate(call, rate))
        made.CreateRelationship("wsim:joints", custom=False).SetTargets(paths)
        return Handle(made.GetName(), path, "sensor")

    def sensor_range(
        self,
        name: str,
        body: Handle | str | None,
        *,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        rays: int = 181,
        fan_deg: Sequence[float] = (-90.0, 90.0),
        layers: int = 1,
        tilt_deg: Sequence[float] = (0.0, 0.0),
        nearest: float = 0.0,
        farthest: float = 30.0,
        rate: float = 10.0,
        noise: float = 0.0,
        seed: int | None = None,
    ) -> Handle:
        """Scan with a fan of rays, as a lidar does: the distance along each to the first surface [m], or infinity.

        A ray's azimuth goes from X of the sensor's frame (0) to Y (90 degrees), its elevation from there up to Z. All
        rays are cast at one moment. They meet solids as they are drawn, glass too, but neither the body that carries
        the sensor nor fluids.

        Args:
            name: Of its prim.
            body: That carries it, a handle or a name; None: it stands in the world.
            position: Of the sensor, in the body's frame, or the world's [m].
            rotation_deg: Roll, pitch, yaw of its frame, likewise [deg].
            rays: Of a layer.
            fan_deg: First and last azimuth, evenly divided [deg]; of a whole turn the last ray is left out, which would
                be the first.
            layers: One above the other.
            tilt_deg: Elevation of the lowest and of the highest layer [deg]; of one layer, their middle.
            nearest: What is nearer is not seen [m].
            farthest: Nor what is farther [m].
            rate: Scans a second [Hz]; the time between is rounded to whole steps, one at least.
            noise: Standard deviation of a distance [m].
            seed: Of the noise; by default the world's.

        Raises:
            SceneError: If the body never moves, there are too many rays, or a number is out of range.
        """
        call = Call("sensor_range", name)
        path = self._path(call)
        prim = (
            None if body is None else self._rigid_body(call, "body", body, ", or give None and a position in the world")
        )
        across, up = call.integer("rays", rays, 1, MAX_RAYS), call.integer("layers", layers, 1, MAX_RAYS)
        if across * up > MAX_RAYS:
            call.fail(f"rays = {across} in layers = {up} are {across * up}; at most {MAX_RAYS}")
        fan, tilt = call.range("fan_deg", fan_deg, 360.0, "deg"), call.range("tilt_deg", tilt_deg, 90.0, "deg")
        if fan[1] - fan[0] > 360.0:
            call.fail(f"fan_deg = ({fan[0]:g}, {fan[1]:g}) is more than a turn")
        near, far = call.within("nearest", nearest, 0.0, MAX_POSITION, "m"), call.size("farthest", farthest)
        if near >= far:
            call.fail(f"nearest = {near:g} m is not below farthest = {far:g} m")
        names = Sdf.ValueTypeNames
        values: Values = {
            "azimuths": (names.DoubleArray, Vt.DoubleArray(_divided(*fan, across))),
            "elevations": (names.DoubleArray, Vt.DoubleArray(_divided(*tilt, up))),
            "nearest": (names.Double, near),
            "farthest": (names.Double, far),
            "noise": (names.Double, call.within("noise", noise, 0.0, _MOST_NOISE, "m")),
        }
        made = self._sensor(
            path,
            schema.SENSOR_RANGE,
            values | _seed(call, seed) | _mounting(call, position, rotation_deg) | _rate(call, rate),
        )
        if prim:
            made.CreateRelationship("wsim:body", custom=False).SetTargets([prim.GetPath()])
        return Handle(made.GetName(), path, "sensor")

    def sensor_camera(
        self,
        name: str,
        body: Handle | str | None,
        *,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        width: int = 160,
        height: int = 120,
        fov: float = 60.0,
        farthest: float = 100.0,
        rate: float = 10.0,
        channels: Sequence[str] = PIXEL_CHANNELS,
    ) -> Handle:
        """Fix a camera to a body whose pictures are measurements: what it sees, how far that is, and what it is.

        It looks along +X of the sensor's frame, with +Z up in the picture. A pinhole, pixels square, the first row on
        top: what is y to the left and z above the axis at a depth x is (W - 1) / 2 - f y / x from the left and
        (H - 1) / 2 - f z / x from the top, f = W / (2 tan(fov / 2)). `color` is sRGB; `depth` is along the axis, not
        along the ray; `segmentation` is an index into `labels`. The last two are of opaque solids, springs and ropes:
        glass and fluids are looked through. The body that carries it is not in its pictures.

        Args:
            name: Of its prim.
            body: That carries it, a handle or a name; None: it stands in the world.
            position: Of the sensor, in the body's frame, or the world's [m].
            rotation_deg: Roll, pitch, yaw of its frame, likewise [deg]; a positive pitch looks down.
            width: Of a picture [pixel].
            height: Of a picture [pixel].
            fov: Field of view from left to right [deg].
            farthest: A depth beyond it is told as infinite [m].
            rate: Pictures a second [Hz]; the time between is rounded to whole steps, one at least.
            channels: Which of "color", "depth" and "segmentation" it tells.

        Raises:
            SceneError: If the body never moves, there are too many pixels, a channel is unknown, or a number is out of
                range.
        """
        call = Call("sensor_camera", name)
        path = self._path(call)
        prim = None if body is None else self._rigid_body(call, "body", body, ", or give None and a place in the world")
        columns, rows = (call.integer(*each, 1, MAX_PIXELS, "pixel") for each in (("width", width), ("height", height)))
        if columns * rows > MAX_PIXELS:
            call.fail(f"width = {columns} by height = {rows} are {columns * rows} pixels; at most {MAX_PIXELS}")
        angle = call.within("fov", fov, 1.0, 170.0, "deg")
        names = Sdf.ValueTypeNames
        values: Values = {
            "width": (names.Int, columns),
            "height": (names.Int, rows),
            "farthest": (names.Double, call.size("farthest", farthest)),
            "channels": (names.TokenArray, Vt.TokenArray(_channels(call, channels))),
        }
        mounting = _mounting(call, position, rotation_deg)
        values |= mounting | _rate(call, rate)
        camera = UsdGeom.Camera.Define(self._stage, path)
        made = camera.GetPrim()
        schema.apply(made, schema.SENSOR_CAMERA, values)
        write_lens(camera, angle, columns, rows)
        place, turn = Gf.Vec3d(mounting["position"][1]), Gf.Quatd(mounting["rotation"][1])
        if prim is not None:
            made.CreateRelationship("wsim:body", custom=False).SetTargets([prim.GetPath()])
            begin, turned = world_pose(prim)
            place, turn = begin + turned.Transform(place), turned * turn
        set_pose(made, (place[0], place[1], place[2]), turn * _LENS)
        note_line(made)
        return Handle(made.GetName(), path, "sensor")

    def sensor_contact(
        self,
        name: str,
        body: Handle | str,
        *,
        rotation_deg: Sequence[float] = _HERE,
        threshold: float = 1e-3,
        rate: float = 100.0,
    ) -> Handle:
        """Feel what contacts push a body with: the net force [N] in the sensor's frame, and whether anything touches.

        Both are of the last step. A blow is the impulse over a step, and is felt by the sample of its own step alone;
        what it does to the body an IMU tells at any rate. A body that is squeezed is touched, and its forces cancel.

        Args:
            name: Of its prim.
            body: That moves; a handle or a name. All its colliders feel.
            rotation_deg: Roll, pitch, yaw of the sensor's frame, in the body's [deg].
            threshold: It is touched where contacts together press with more [N].
            rate: Samples a second [Hz]; the time between is rounded to whole steps, one at least.

        Raises:
            SceneError: If the body never moves, nothing of it collides, or a number is out of range.
        """
        call = Call("sensor_contact", name)
        path = self._path(call)
        prim = self._rigid_body(call, "body", body)
        if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim)):
            call.fail(f"body = {shown(prim.GetName())} has nothing that collides; name a solid")
        names = Sdf.ValueTypeNames
        values: Values = {
            "threshold": (names.Double, call.within("threshold", threshold, 0.0, _MOST_FORCE, "N")),
            "rotation": (names.Quatd, rotation(call.angles(rotation_deg))),
        }
        made = self._sensor(path, schema.SENSOR_CONTACT, values | _rate(call, rate))
        made.CreateRelationship("wsim:body", custom=False).SetTargets([prim.GetPath()])
        return Handle(made.GetName(), path, "sensor")

    def _sensor(self, path: str, kind: str, values: Values) -> Usd.Prim:
        made = self._stage.DefinePrim(path, "Scope")
        schema.apply(made, kind, values)
        note_line(made)
        return made

    def _freedoms(self, call: Call, field: str, joint: Handle | str) -> list[Usd.Prim]:
        """A hinge or a slider, or those of a robot."""
        prim = self._find(call, field, joint)
        if holder := prim.GetChild("joints"):
            return [each for each in holder.GetChildren() if is_of_one_freedom(each)]
        if not is_of_one_freedom(prim):
            call.fail(f"{field} = {shown(prim.GetName())} is no hinge and no slider; name one, or a robot")
        return [prim]


def is_of_one_freedom(prim: Usd.Prim) -> bool:
    """Whether a prim is a hinge or a slider."""
    return bool(prim.IsA(UsdPhysics.RevoluteJoint) or prim.IsA(UsdPhysics.PrismaticJoint))


def _mounting(call: Call, position: Sequence[float], rotation_deg: Sequence[float]) -> Values:
    """Where a sensor is on its body."""
    names = Sdf.ValueTypeNames
    return {
        "position": (names.Point3d, Gf.Vec3d(*call.position("position", position))),
        "rotation": (names.Quatd, rotation(call.angles(rotation_deg))),
    }


def _rate(call: Call, rate: float) -> Values:
    return {"rate": (Sdf.ValueTypeNames.Double, call.positive("rate", rate, MAX_RATE, "Hz", low=MIN_RATE))}


def _seed(call: Call, seed: int | None) -> Values:
    return {} if seed is None else {"seed": (Sdf.ValueTypeNames.Int, call.integer("seed", seed, 0, _MAX_SEED))}


def _channels(call: Call, given: object) -> list[str]:
    """Which channels of pictures are told, in their own order."""
    asked = call.listed("channels", given, f"some of {', '.join(PIXEL_CHANNELS)}, in a list")
    for each in asked:
        call.one_of("channels", each, PIXEL_CHANNELS)
    if not asked:
        call.fail(f"channels = {shown(given)} has none; name some of {', '.join(PIXEL_CHANNELS)}")
    return [each for each in PIXEL_CHANNELS if each in asked]


def _divided(low: float, high: float, count: int) -> list[float]:
    """Angles from low to high [deg], both of them but where they are one direction."""
    if count == 1:
        return [0.5 * (low + high)]
    pieces = count if high - low == 360.0 else count - 1
    return [low + k * (high - low) / pieces for k in range(count)]
