"""Where fluid comes in and leaves: taps, rain, drains."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pxr import Gf, Sdf, Usd, UsdGeom

from wsim.limits import MAX_DURATION, MAX_POSITION, MAX_SIZE, MAX_SPEED
from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, note_line, set_pose
from wsim.scene.validate import Call, Vec3, shown

MAX_FLOW = 1e4  # [m^3/s]: a river
_DOWN = (0.0, 0.0, -1.0)
_NAMES = Sdf.ValueTypeNames
Values = dict[str, tuple[Sdf.ValueTypeName, object]]


class Openings(Author):
    """The calls that let fluid in and out."""

    def tap(
        self,
        name: str,
        fluid: Handle | str,
        *,
        rate: float,
        position: Sequence[float],
        direction: Sequence[float] = _DOWN,
        radius: float | None = None,
        size: Sequence[float] | None = None,
        start: float = 0.0,
        stop: float | None = None,
        speed: float = 0.0,
    ) -> Handle:
        """Let a fluid pour from a mouth at a rate: a tap, a hose, a jet, the upper end of a channel; or let it rain.

        It leaves the mouth at rate / area, all of it with that speed. With `speed` it falls as drops instead, spread
        over the mouth and over time: rain. The fluid may be empty at the start (`fluid(..., level=0)`).

        Args:
            name: Of the tap.
            fluid: What it pours; the world's only one.
            rate: How much [m^3/s]; 0.001 is a litre a second.
            position: Centre of the mouth [m], out of what is solid or in its surface; water must be free to leave it.
                It may be under water.
            direction: Which way the fluid goes there.
            radius: Of a round mouth [m].
            size: Instead of `radius`: width and height of a rectangular one [m], the height upright; across Z, along X
                and Y.
            start: When it opens [s].
            stop: When it shuts [s]; by default never.
            speed: That drops fall with at the mouth [m/s]; 0 for a stream.

        Raises:
            SceneError: If there is no such fluid or another one beside it, the mouth is narrower than two particles of
                a stream or inside of what is solid, or a number is out of range.
        """
        call = Call("tap", name)
        path = self._path(call)
        water, spacing = self._poured(call, fluid)
        mouth, across = _mouth(call, position, direction, radius, size)
        flow = call.positive("rate", rate, MAX_FLOW, "m^3/s")
        drops = call.within("speed", speed, 0.0, MAX_SPEED, "m/s")
        opens = call.within("start", start, 0.0, MAX_DURATION, "s")
        shuts = math.inf if stop is None else call.positive("stop", stop, MAX_DURATION, "s")
        if shuts <= opens:
            call.fail(f"stop = {shuts:g} s is not after start = {opens:g} s")
        if not drops and across < 2.0 * spacing:
            call.fail(
                f"the mouth is {across:g} m across and {shown(water.GetName())} has particles every {spacing:g} m; "
                f"make it {2.0 * spacing:g} m wide or more, or the spacing {across / 2.0:.3g} m"
            )
        values: Values = {
            "rate": (_NAMES.Double, flow),
            "start": (_NAMES.Double, opens),
            "dropSpeed": (_NAMES.Double, drops),
        }
        if stop is not None:
            values["stop"] = (_NAMES.Double, shuts)
        tap = self._open(path, "tap", schema.TAP, mouth | values, position, water)
        self._check_free(call, tap, spacing)
        return tap

    def _check_free(self, call: Call, tap: Handle, spacing: float) -> None:
        """Refuse a tap that lies in a solid which is there already; the others a stage's check finds."""
        from wsim.scene.mouths import blocked_by, told  # with pydantic, and few programs have a tap

        prim = self._stage.GetPrimAtPath(tap.path)
        blocked = blocked_by(prim, spacing, self._stage.Traverse(Usd.TraverseInstanceProxies()))
        if blocked:
            call.fail(f"position = {told(prim, *blocked)}")

    def drain(
        self,
        name: str,
        fluid: Handle | str,
        *,
        position: Sequence[float],
        direction: Sequence[float] = _DOWN,
        radius: float | None = None,
        size: Sequence[float] | None = None,
        falls: bool = True,
    ) -> Handle:
        """Let a fluid leave through a face: a hole in a floor or a wall, or the lower end of a channel.

        What comes through the face is gone. Fixed things and a tank's walls have a hole behind it, as wide as it is;
        it lies in their surface, and is not drawn.

        Args:
            name: Of the drain.
            fluid: What leaves by it.
            position: Centre of the face [m].
            direction: Which way the fluid leaves.
            radius: Of a round hole [m].
            size: Instead of `radius`: width and height of a rectangular one [m], as of a `tap`.
            falls: Whether there is nothing behind it, so that what has come through falls freely; otherwise it goes on
                as it came, as where a channel goes on.

        Raises:
            SceneError: If there is no such fluid, the hole is narrower than four particles, or a number is out of
                range.
        """
        call = Call("drain", name)
        path = self._path(call)
        water, spacing = self._fluid_of(call, fluid)
        mouth, across = _mouth(call, position, direction, radius, size)
        if across < 4.0 * spacing:
            call.fail(
                f"the hole is {across:g} m across and {shown(water.GetName())} has particles every {spacing:g} m, "
                f"which block it; make it {4.0 * spacing:g} m wide or more, or the spacing {across / 4.0:.3g} m"
            )
        values: Values = {"falls": (_NAMES.Bool, call.flag("falls", falls))}
        return self._open(path, "drain", schema.DRAIN, mouth | values, position, water)

    def _fluid_of(self, call: Call, fluid: Handle | str) -> tuple[Usd.Prim, float]:
        """A fluid's prim and its spacing [m]."""
        prim = self._find(call, "fluid", fluid)
        if not schema.has(prim, schema.FLUID):
            call.fail(f"fluid = {shown(prim.GetName())} is no fluid; give what scene.fluid returned")
        return prim, float(prim.GetAttribute("wsim:spacing").Get())

    def _poured(self, call: Call, fluid: Handle | str) -> tuple[Usd.Prim, float]:
        """The same, of the only fluid that there is."""
        prim, spacing = self._fluid_of(call, fluid)
        others = [each for each in self._stage.Traverse() if schema.has(each, schema.FLUID) and each != prim]
        if others:
            call.fail(
                f"fluid = {shown(prim.GetName())} is not the only fluid: {shown(others[0].GetName())} is there too; a "
                "tap is for a world with one fluid, so make them one, or fill a tank at the start"
            )
        return prim, spacing

    def _open(
        self, path: str, kind: str, applied: str, values: Values, position: Sequence[float], fluid: Usd.Prim
    ) -> Handle:
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        set_pose(prim, (float(position[0]), float(position[1]), float(position[2])))
        schema.apply(prim, applied, values)
        prim.CreateRelationship("wsim:fluid", custom=False).SetTargets([fluid.GetPath()])
        return Handle(prim.GetName(), path, kind)


def _mouth(
    call: Call,
    position: Sequence[float],
    direction: Sequence[float],
    radius: float | None,
    size: Sequence[float] | None,
) -> tuple[Values, float]:
    """What a stage says of a mouth, and how wide it is at its narrowest [m]."""
    call.position("position", position)
    way: Vec3 = call.vector("direction", direction, MAX_POSITION, "")
    if math.hypot(*way) < 1e-9:
        call.fail(f"direction = {shown(direction)} must not be zero")
    values: Values = {"direction": (_NAMES.Vector3d, Gf.Vec3d(*way).GetNormalized())}
    if (radius is None) == (size is None):
        call.fail("give the radius of a round mouth, or the size, width and height, of a rectangular one")
    if radius is not None:
        wide = call.size("radius", radius)
        return values | {"radius": (_NAMES.Double, wide)}, 2.0 * wide
    sides = call.listed("size", size, "width and height")
    if len(sides) != 2:
        call.fail(f"size = {shown(size)} must be two numbers, width and height [m]")
    width, height = (call.positive(f"size[{k}]", side, MAX_SIZE, "m") for k, side in enumerate(sides))
    return values | {"size": (_NAMES.Double2, Gf.Vec2d(width, height))}, min(width, height)
