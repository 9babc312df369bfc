"""Cables: ropes that weigh, lie and rub, as chains of short links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from pxr import Gf, UsdPhysics

from wsim.geometry.catenary import hanging
from wsim.geometry.laid import laid
from wsim.limits import MAX_MASS
from wsim.scene.authoring import WORLD, Handle
from wsim.scene.cords import HEMP, Cords
from wsim.scene.fluids import Fluids
from wsim.scene.validate import Call, shown

_LINKS, _MOST_LINKS = 30, 200
_SLENDER = 4.0  # a link's length over its radius, at least: shorter ones would touch the next but one
_LIGHTEST = 1e-9  # [kg/m], a tenth of a thread of a spider's silk
_DENSITY = 1000.0  # [kg/m^3], wet hemp and most plastics

Array = np.ndarray


class Cables(Fluids, Cords):
    """The call that makes cables."""

    def cable(
        self,
        name: str,
        a: Handle | str | None,
        b: Handle | str | None,
        *,
        anchor_a: Sequence[float] | None = None,
        anchor_b: Sequence[float] | None = None,
        length: float | None = None,
        through: Sequence[Sequence[float]] = (),
        loose: bool = False,
        links: int | None = None,
        radius: float = 0.01,
        mass_per_length: float | None = None,
        material: Handle | str | None = None,
        friction: float | None = None,
        color: Sequence[float] | None = None,
    ) -> list[Handle]:
        """Hang a rope that weighs: a chain of links on ball joints, which collide and rub as other bodies do.

        It starts at rest: straight from point to point, or, where it is longer than that, as a chain hangs. It does not
        stretch, and nothing stiffens or damps its bending. For the ends see `Cords`.

        Args:
            name: Of the cable; its links are bodies `name_0`, `name_1`, …, from `a` to `b`.
            a: What its first end is tied to.
            b: What its other end is tied to.
            anchor_a: Where it is tied to `a`.
            anchor_b: Where it is tied to `b`; where it ends, if it is loose.
            length: [m]; as long as its way at the start if not given.
            through: Points that it runs through on its way at the start [m]; then it is as long as that way. Where it
                turns by less than 45 degrees at each it is an arc, and links touch it from outside: round a post of
                radius R give points at R + `radius`, and it lies on it.
            loose: Its other end is tied to nothing; `b` is None.
            links: How many, 2 to 200; about 30 if not given. A turn round something wants one in 15 degrees.
            radius: [m].
            mass_per_length: [kg/m]; by the material's density if not given, 1000 kg/m^3 without one.
            material: As for solids.
            friction: As for solids.
            color: As for solids.

        Returns:
            The links, from `a` to `b`.
        """
        call = Call("cable", name)
        self._path(call)
        thick = call.size("radius", radius)
        listed = call.listed("through", through, "points (x, y, z) in m, in a list")
        if call.flag("loose", loose) and b is not None:
            call.fail(f"b = {shown(b)} and loose=True: an end that is tied to something is not loose")
        if loose and anchor_b is None:
            call.fail("loose=True needs anchor_b, where the loose end is at the start [m]")
        ends = self._ends(call, a, b, anchor_a, anchor_b, still=True)
        between = [Gf.Vec3d(*call.position(f"through[{k}]", point)) for k, point in enumerate(listed)]
        way = np.array([ends[0].point, *between, ends[1].point], dtype=np.float64)
        points = self._laid(call, way, length, links, thick)
        mass = (
            None
            if mass_per_length is None
            else call.positive("mass_per_length", mass_per_length, MAX_MASS, "kg/m", low=_LIGHTEST)
        )
        look = self._surface(call, material, friction, None, HEMP if material is None and color is None else color)
        made = self._links(name, points, thick, mass or math.pi * thick**2 * (look.density or _DENSITY), look)
        tied = [end.prim.GetName() if end.prim else None for end in ends]
        self._join(name, made, points, (tied[0], tied[1]), loose=loose)
        return made

    def _laid(self, call: Call, way: Array, length: float | None, links: int | None, radius: float) -> Array:
        """Ends of the links at the start, (links + 1, 3) [m]."""
        steps = np.linalg.norm(np.diff(way, axis=0), axis=1)
        shortest = float(steps.sum())
        long = shortest if length is None else call.size("length", length)
        if long < shortest * (1.0 - 1e-6):
            call.fail(f"length = {long:g} m is shorter than its way at the start, {shortest:.4g} m")
        if len(way) > 2 and long > shortest * (1.0 + 1e-6):
            call.fail(f"length = {long:g} m and through are both given, whose way is {shortest:.4g} m; give one")
        most = int(min(long / (_SLENDER * radius), _MOST_LINKS))
        if most < 2:
            call.fail(f"radius = {radius:g} m is too thick for a cable of {long:.4g} m: at most {long / 8.0:.3g} m")
        count = min(_LINKS, most) if links is None else call.integer("links", links, 2, _MOST_LINKS)
        if count > most:
            call.fail(
                f"links = {count} of {long / count:.3g} m are too short for a radius of {radius:g} m, each is "
                f"{_SLENDER:g} radii long or more: at most {most} links, or a radius of {long / count / _SLENDER:.2g} m"
            )
        if len(way) == 2:
            return hanging(way[0], way[1], long, count + 1)
        points = laid(way, count)
        each = np.linalg.norm(np.diff(points, axis=0), axis=1)
        k = int(np.argmin(each))
        if each[k] < 2.0 * radius:
            at = ", ".join(f"{x:.3g}" for x in 0.5 * (points[k] + points[k + 1]))
            call.fail(
                f"through bends by so little at ({at}) m that the link there is {each[k]:.3g} m long, and those beside "
                f"it, {radius:g} m thick, would be in each other: let it bend by more, or not at all, or give a radius "
                f"below {0.5 * each[k]:.2g} m"
            )
        return points

    def _links(self, name: str, points: Array, radius: float, mass: float, look: Handle) -> list[Handle]:
        made = []
        for k, (start, end) in enumerate(pairwise(points)):
            x, y, z = (end - start).tolist()
            long = math.sqrt(x * x + y * y + z * z)
            turn = (0.0, -math.degrees(math.asin(max(-1.0, min(1.0, z / long)))), math.degrees(math.atan2(y, x)))
            middle = (0.5 * (start + end)).tolist()
            made.append(
                self.capsule(
                    f"{name}_{k}", radius=radius, height=long, axis="X", position=middle, rotation_deg=turn,
                    mass=mass * long, material=look,
                )
            )  # fmt: skip
        return made

    def _join(
        self, name: str, links: list[Handle], points: Array, ends: tuple[str | None, str | None], *, loose: bool
    ) -> None:
        """Tie links to each other and to what holds them, from the end that never moves, where there is one."""
        first, last = ends
        if not loose and self._moves(first) and not self._moves(last):
            links, points, first, last = links[::-1], points[::-1], last, first
        chain: list[Handle | str | None] = [first, *links]
        for k, (parent, child) in enumerate(pairwise(chain)):
            self.joint_spherical(f"{name}_joint_{k}", parent, child, anchor=points[k].tolist())  # type: ignore[arg-type]
        if loose:
            return
        parent, child = (links[-1], last) if last is not None and self._moves(last) else (last, links[-1])
        self.joint_spherical(f"{name}_joint_{len(links)}", parent, child, anchor=points[-1].tolist())

    def _moves(self, end: str | None) -> bool:
        return end is not None and bool(self._stage.GetPrimAtPath(f"{WORLD}/{end}").HasAPI(UsdPhysics.RigidBodyAPI))
