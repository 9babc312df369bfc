"""Cameras and lights."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from wsim.limits import MAX_POSITION
from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, note_line, set_pose
from wsim.scene.policies import base_of, is_held
from wsim.scene.validate import Call, Vec3

_APERTURE = 20.955  # [tenths of a unit], USD's own
_INTENSITY = {"distant": 2000.0, "dome": 500.0, "sphere": 30000.0}


class Views(Author):
    """The calls that make cameras and lights."""

    def camera(
        self,
        name: str,
        *,
        eye: Sequence[float],
        target: Sequence[float],
        fov: float = 50.0,
        width: int = 640,
        height: int = 360,
        follows: Handle | str | None = None,
        turns: bool = False,
        fixed: bool = False,
    ) -> Handle:
        """Make a camera that stands at `eye` and looks at `target`, Z up in its picture.

        One that follows a body is there when the world starts, and keeps its offset from the body's place: its picture
        keeps the body where it was.

        A run's pictures are taken with it as it is if it is fixed, or if it shows what happens: else it is turned,
        moved or made to follow, once it is known what happened.

        Args:
            name: Name of the prim.
            eye: [m].
            target: [m].
            fov: Horizontal field of view [deg].
            width: Of the picture [pixel].
            height: Of the picture [pixel].
            follows: A body that moves, a handle or a name; a robot stands for its base, and where
                that is held to the world the camera stands, too.
            turns: Whether it turns with that body too, as if it was fixed to it.
            fixed: Whether it stays as it is, whatever it shows: a view that was asked for.

        Raises:
            SceneError: If eye and target are one point, what it follows never moves, the name is taken or a number is
                out of range.
        """
        call = Call("camera", name)
        path = self._path(call)
        place, aim = call.position("eye", eye), call.position("target", target)
        distance = math.dist(place, aim)
        if distance < 1e-6:
            call.fail(f"eye = target = {place}: the camera looks at itself; move one of them")
        angle = call.within("fov", fov, 1.0, 170.0, "deg")
        columns = call.integer("width", width, 16, 8192, "pixel")
        rows = call.integer("height", height, 16, 8192, "pixel")
        body = None if follows is None else self._followed(call, follows)
        if call.flag("turns", turns) and follows is None:
            call.fail("turns = True needs follows, the body that it turns with")
        stays = call.flag("fixed", fixed)

        camera = UsdGeom.Camera.Define(self._stage, path)
        prim = camera.GetPrim()
        note_line(prim)
        set_pose(prim, place, _look_at(place, aim))
        write_lens(camera, angle, columns, rows)
        camera.CreateFocusDistanceAttr(distance)
        schema.apply(
            prim,
            schema.CAMERA,
            {
                "eye": (Sdf.ValueTypeNames.Double3, Gf.Vec3d(*place)),
                "target": (Sdf.ValueTypeNames.Double3, Gf.Vec3d(*aim)),
                "width": (Sdf.ValueTypeNames.Int, columns),
                "height": (Sdf.ValueTypeNames.Int, rows),
                **({"turns": (Sdf.ValueTypeNames.Bool, True)} if turns and body is not None else {}),
                **({"fixed": (Sdf.ValueTypeNames.Bool, True)} if stays else {}),
            },
        )
        if body is not None:
            prim.CreateRelationship("wsim:follows", custom=False).SetTargets([body.GetPath()])
        return Handle(name=name, path=path, kind="camera")

    def _followed(self, call: Call, what: Handle | str) -> Usd.Prim | None:
        """The body that is meant; None for a robot whose base is held, with which a camera stands."""
        prim = self._find(call, "follows", what)
        has_joints = bool(prim.GetChild("joints"))
        if has_joints and is_held(prim):
            return None
        base = base_of(prim) if has_joints else None
        return base or self._rigid_body(call, "follows", prim)

    def light(
        self,
        name: str,
        kind: str = "distant",
        *,
        intensity: float | None = None,
        color: Sequence[float] = (1.0, 1.0, 1.0),
        direction: Sequence[float] = (-0.4, 0.3, -1.0),
        position: Sequence[float] = (0.0, 0.0, 3.0),
        radius: float = 0.1,
    ) -> Handle:
        """Make a light.

        Args:
            name: Name of the prim.
            kind: "distant" (the sun), "dome" (the sky) or "sphere" (a lamp).
            intensity: UsdLux intensity; a sensible one if not given.
            color: Linear RGB.
            direction: Of a distant light: from the light into the scene.
            position: Of a sphere [m].
            radius: Of a sphere [m].

        Raises:
            SceneError: If the kind is unknown, the name is taken or a number is out of range.
        """
        call = Call("light", name)
        path = self._path(call)
        call.one_of("kind", kind, tuple(_INTENSITY))
        strength = call.within("intensity", _INTENSITY[kind] if intensity is None else intensity, 0.0, 1e8)
        tint = call.color("color", color)
        aim = call.vector("direction", direction, MAX_POSITION, "m")
        place = call.position("position", position)
        ball = call.size("radius", radius)
        if kind == "distant":
            if not any(aim):
                call.fail(f"direction = {aim} has no length; it points from the light into the scene")
            light = UsdLux.DistantLight.Define(self._stage, path)
            set_pose(light.GetPrim(), (0.0, 0.0, 0.0), _look_at((0.0, 0.0, 0.0), aim))
        elif kind == "dome":
            light = UsdLux.DomeLight.Define(self._stage, path)
        else:
            light = UsdLux.SphereLight.Define(self._stage, path)
            light.CreateRadiusAttr(ball)
            set_pose(light.GetPrim(), place)
        note_line(light.GetPrim())
        light.CreateIntensityAttr(strength)
        light.CreateColorAttr(Gf.Vec3f(*tint))
        return Handle(name=name, path=path, kind="light")


def write_lens(camera: UsdGeom.Camera, angle: float, columns: int, rows: int) -> None:
    """Author a pinhole lens that sees `angle` [deg] across, for square pixels."""
    camera.CreateHorizontalApertureAttr(_APERTURE)
    camera.CreateVerticalApertureAttr(_APERTURE * rows / columns)
    camera.CreateFocalLengthAttr(_APERTURE / 2 / math.tan(math.radians(angle) / 2))
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, MAX_POSITION))


def _look_at(eye: Vec3, target: Vec3) -> Gf.Quatd:
    """The rotation that turns -Z to the target and Y as far up as it goes; seen straight down, +Y is up."""
    forward = (Gf.Vec3d(*target) - Gf.Vec3d(*eye)).GetNormalized()
    up = Gf.Vec3d.ZAxis() if abs(forward[2]) < 0.9999 else Gf.Vec3d.YAxis()
    right = Gf.Cross(forward, up).GetNormalized()
    true_up = Gf.Cross(right, forward)
    rows = Gf.Matrix3d(*right, *true_up, *(-forward))
    return rows.ExtractRotation().GetQuat().GetNormalized()
