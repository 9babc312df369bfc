"""Springs, dampers and ropes between two bodies, or a body and the world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from pxr import Gf, Sdf, Usd, UsdGeom

from wsim.geometry.ropes import path_length
from wsim.limits import FARTHEST, MAX_DAMPING, MAX_SIZE, MAX_STIFFNESS, MOST_STRETCH, TAUT
from wsim.scene import schema
from wsim.scene.articulation import body_frame
from wsim.scene.authoring import Handle, note_line, world_pose
from wsim.scene.joints import Joints
from wsim.scene.usd_contacts import yields
from wsim.scene.validate import Call, Vec3, shown

Around = Sequence[Handle | str | tuple[Handle | str, str | Sequence[float]]]
HEMP = (0.55, 0.4, 0.2)  # linear RGB
_STEEL = (0.45, 0.47, 0.5)
_SIDES = {"over": (0.0, 0.0, 1.0), "under": (0.0, 0.0, -1.0)}
_Values = dict[str, tuple[Sdf.ValueTypeName, object]]


class _End(NamedTuple):
    prim: Usd.Prim | None  # None: the world
    point: Gf.Vec3d  # in the world [m]


class Cords(Joints):
    """The calls that make springs and ropes.

    `a` and `b` are what the ends are fixed to: bodies, static objects, or None for the world. `anchor_a` and `anchor_b`
    say where, in the world at time 0 [m]; an object's origin if not given.
    """

    def spring(
        self,
        name: str,
        a: Handle | str | None,
        b: Handle | str | None,
        *,
        stiffness: float,
        damping: float = 0.0,
        rest_length: float | None = None,
        anchor_a: Sequence[float] | None = None,
        anchor_b: Sequence[float] | None = None,
        radius: float | None = None,
        color: Sequence[float] | None = None,
    ) -> Handle:
        """Put a spring and damper between two points: it pulls where it is stretched, and pushes where it is pressed.

        Its force is stiffness (length - rest_length) + damping (rate of length), along the line between the points. It
        weighs nothing, and nothing collides with it. For the ends see `Cords`.

        Args:
            name: Name of the prim, drawn as a coil.
            a: One end.
            b: The other.
            stiffness: [N/m]; 0 is a damper alone. One that would need a time step below 10 microseconds is refused.
            damping: [N s/m].
            rest_length: [m]; that of the start if not given.
            anchor_a: Where it is fixed to `a`.
            anchor_b: Where it is fixed to `b`.
            radius: Of the drawn coil [m].
            color: Of the coil, linear RGB.
        """
        call = Call("spring", name)
        path = self._path(call)
        k = call.within("stiffness", stiffness, 0.0, MAX_STIFFNESS, "N/m")
        c = call.within("damping", damping, 0.0, MAX_DAMPING, "N s/m")
        if k == 0.0 and c == 0.0:
            call.fail("stiffness = 0 N/m and damping = 0 N s/m would do nothing; give one of them")
        ends = self._ends(call, a, b, anchor_a, anchor_b)
        apart = (ends[0].point - ends[1].point).GetLength()
        rest = apart if rest_length is None else call.within("rest_length", rest_length, 0.0, MAX_SIZE, "m")
        if apart > FARTHEST:
            call.fail(f"its ends are {apart:.4g} m apart; at most {FARTHEST:g} m: look at anchor_a and anchor_b")
        if k > 0.0 and rest > 0.0 and apart > MOST_STRETCH * rest:
            call.fail(
                f"rest_length = {rest:g} m, and its ends are {apart:.4g} m apart: a spring is stretched to "
                f"{MOST_STRETCH:g} times its length at most; give a longer one, or nearer anchors"
            )
        drawn = min(max(0.06 * apart, 0.005), 0.06) if radius is None else call.size("radius", radius)
        double = Sdf.ValueTypeNames.Double
        values: _Values = {"stiffness": (double, k), "damping": (double, c), "restLength": (double, rest)}
        look = _STEEL if color is None else call.color("color", color)
        return self._cord(call, path, schema.SPRING, ends, drawn, look, values)

    def rope(
        self,
        name: str,
        a: Handle | str | None,
        b: Handle | str | None,
        *,
        around: Around = (),
        length: float | None = None,
        anchor_a: Sequence[float] | None = None,
        anchor_b: Sequence[float] | None = None,
        radius: float = 0.006,
        color: Sequence[float] | None = None,
    ) -> Handle:
        """Tie a rope that weighs nothing and cannot be stretched: it pulls where it is taut, and goes slack.

        It slips on what it runs round without friction, and nothing collides with it; one that weighs, lies and rubs is
        a `cable`. For the ends see `Cords`.

        Args:
            name: Name of the prim, drawn as a tube.
            a: One end.
            b: The other.
            around: Cylinders that it runs round on its way, from `a` to `b`: each an object with a cylinder, which it
                passes above, or (object, side) with "over", "under" or a direction (x, y, z) from the cylinder's axis.
                It may do so by half a turn, and by more while its strands do not come together.
            length: [m]; as long as its way at the start, taut, if not given. More is slack.
            anchor_a: Where it is fixed to `a`.
            anchor_b: Where it is fixed to `b`.
            radius: Drawn [m].
            color: Linear RGB.
        """
        call = Call("rope", name)
        path = self._path(call)
        ends = self._ends(call, a, b, anchor_a, anchor_b)
        drawn = call.size("radius", radius)
        look = HEMP if color is None else call.color("color", color)
        listed = call.listed("around", around, 'a list of objects, or of (object, "under")')
        rounds = [self._round_of(call, k, item) for k, item in enumerate(listed)]
        paths = [prim.GetPath() for prim, _ in rounds]
        if len(set(paths)) < len(paths):
            call.fail(f"around names {shown(paths[-1].name)} twice; a rope runs round each object once")
        given = None if length is None else call.size("length", length)
        sides = [Gf.Vec3d(*side) for _, side in rounds]
        values: _Values = {
            "sides": (Sdf.ValueTypeNames.Double3Array, sides),
            "length": (Sdf.ValueTypeNames.Double, 0.0),
        }
        handle = self._cord(call, path, schema.ROPE, ends, drawn, look, values)
        prim = self._stage.GetPrimAtPath(path)
        if paths:
            prim.CreateRelationship("wsim:around", custom=False).SetTargets(paths)
        self._set_length(call, prim, given)
        return handle

    def _set_length(self, call: Call, prim: Usd.Prim, given: float | None) -> None:
        """Author a rope's length, its way at the start if none is given; the prim goes where that cannot be."""
        # They bring pydantic, and a program without ropes does not wait for it.
        from wsim.scene.check_cords import cord_problems
        from wsim.scene.describe_cords import read_rope, stops_at_start

        way = float(path_length(stops_at_start(read_rope(prim).path, self._stage))[0])
        wrong = f"length = {given:g} m is shorter than its way at the start, {way:.4g} m" if given else ""
        if given is None or given >= way - TAUT:
            prim.GetAttribute("wsim:length").Set(given or way)
            wrong = next((problem.partition(": ")[2] for problem in cord_problems(prim)), "")
        if wrong:
            self._stage.RemovePrim(prim.GetPath())
            call.fail(wrong)

    def _ends(
        self,
        call: Call,
        a: Handle | str | None,
        b: Handle | str | None,
        anchor_a: Sequence[float] | None,
        anchor_b: Sequence[float] | None,
        *,
        still: bool = False,
    ) -> tuple[_End, _End]:
        """What both ends are fixed to and where; `still` lets neither of them be a body that moves."""
        ends = []
        for field, what, anchor in (("a", a, anchor_a), ("b", b, anchor_b)):
            prim = None if what is None else self._body(call, field, what)
            if prim is None and anchor is None:
                call.fail(f"{field} = None is the world; give anchor_{field}, where its end is [m]")
            point = (
                world_pose(prim)[0] if anchor is None and prim else Gf.Vec3d(*call.position(f"anchor_{field}", anchor))
            )
            ends.append(_End(prim, point))
        one, other = ends
        if one.prim is not None and one.prim == other.prim:
            call.fail(f"a = b = {shown(one.prim.GetName())}: its ends need two bodies, or one and the world")
        if not still and not any(end.prim is not None and yields(end.prim) for end in ends):
            call.fail("neither a nor b is a body that it could move: each is static or kinematic; name a loose body")
        if (one.point - other.point).GetLength() < TAUT:
            call.fail(f"both its ends are at {_shown(one.point)} m: it has no length; give anchor_a or anchor_b")
        return one, other

    def _round_of(
        self, call: Call, k: int, item: Handle | str | tuple[Handle | str, str | Sequence[float]]
    ) -> tuple[Usd.Prim, Vec3]:
        """What a rope runs round, and the direction in which it passes it."""
        field = f"around[{k}]"
        if isinstance(item, (tuple, list)) and len(item) != 2:
            call.fail(f'{field} = {shown(item)} must be an object, or (object, side) with side "over" or "under"')
        what, side = item if isinstance(item, (tuple, list)) else (item, "over")
        if isinstance(side, str):
            if side not in _SIDES:
                call.fail(f'{field}: side = {shown(side)} must be "over", "under" or a direction (x, y, z)')
            way: Vec3 = _SIDES[side]
        else:
            way = call.vector(f"{field}: side", side, 1e6, "")
        prim = self._body(call, field, what)
        from wsim.scene.describe_cords import read_pulley  # brings pydantic, as above

        pulley = read_pulley(prim)
        if pulley is None:
            call.fail(f"{field} = {shown(prim.GetName())} has no cylinder that collides; a rope runs round cylinders")
        axis = Gf.Vec3d(body_frame(prim).TransformDir(Gf.Vec3d(*pulley.axis)))
        if Gf.Cross(axis, Gf.Vec3d(*way)).GetLength() < 1e-3:
            call.fail(f"{field}: side = {shown(side)} is along the axis of {shown(prim.GetName())}; give one across it")
        return prim, way

    def _cord(
        self, call: Call, path: str, kind: str, ends: tuple[_End, _End], radius: float, color: Vec3, values: _Values
    ) -> Handle:
        prim = UsdGeom.Scope.Define(self._stage, path).GetPrim()
        note_line(prim)
        types = Sdf.ValueTypeNames
        common: _Values = {"radius": (types.Double, radius), "color": (types.Color3f, Gf.Vec3f(*color))}
        for letter, end in zip("ab", ends, strict=True):
            point = end.point if end.prim is None else body_frame(end.prim).GetInverse().Transform(end.point)
            common[f"anchor{letter.upper()}"] = (types.Double3, point)
        schema.apply(prim, kind, common | values)
        for letter, end in zip("ab", ends, strict=True):
            if end.prim is not None:
                prim.CreateRelationship(f"wsim:{letter}", custom=False).SetTargets([end.prim.GetPath()])
        return Handle(name=prim.GetName(), path=path, kind=call.method)


def _shown(point: Gf.Vec3d) -> str:
    return "(" + ", ".join(f"{x:g}" for x in point) + ")"
