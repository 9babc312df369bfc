"""Rocks, trees and whatever the catalogue has, scattered over terrain by a seed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Gf, UsdGeom

from wsim.limits import MAX_SIZE
from wsim.scene.authoring import Handle, note_line, set_pose
from wsim.scene.bodies import Bodies, finish_collider
from wsim.scene.catalogued import Catalogued
from wsim.scene.layers import Floats, nearest, point, polyline
from wsim.scene.roads import Road
from wsim.scene.rocks import STANDS, rock
from wsim.scene.static_mesh import define_mesh
from wsim.scene.terrain import Terrain
from wsim.scene.validate import Call, Vec3, shown

ROCKS = "rocks"
_MOST = 1000
_TRIES = 500  # places that are looked at for each thing
_SUNK = 0.2  # of a rock's height, under the lowest ground at its middle
_AROUND = [(math.cos(k * math.pi / 4.0), math.sin(k * math.pi / 4.0)) for k in range(8)]
_STONE = (0.33, 0.31, 0.28)


class Scattered(Catalogued, Bodies):
    """The call that scatters."""

    def scatter(
        self,
        name: str,
        what: str | Sequence[str] = ROCKS,
        *,
        on: Terrain,
        count: int,
        size: Sequence[float] = (0.3, 1.0),
        clear: Sequence[Sequence[Any]] = (),
        seed: int = 0,
        material: Handle | str | None = None,
        friction: float | None = None,
        color: Sequence[float] | None = None,
    ) -> list[Handle]:
        """Scatter static things over terrain, none over another, the same for the same seed.

        Rocks lie sunk in the ground by a fifth of their height; things of the catalogue stand upright, turned by
        chance, on the lowest ground within 0.3 m of their middle.

        Args:
            name: What the prims' names begin with: name_0, name_1, ...
            what: "rocks", which are convex and each another, or an asset's id such as "conifer", or several of them.
            on: What `scene.terrain` returned.
            count: How many.
            size: Least and greatest length of a rock [m]; small ones are more.
            clear: What they keep away from, and by how much beyond its own width [m]: (road, 1.0), ((x, y), 3.0), or
                ([(x, y), ...], 2.0) for a line; in the world.
            seed: Another gives other places and shapes.
            material: Of rocks: what `scene.material` returned, or its name.
            friction: Of rocks; overrides the material's.
            color: Of rocks; overrides the material's.

        Raises:
            SceneError: If an asset is not in the catalogue, a number is out of range, or there is no room.
        """
        call = Call("scatter", name)
        self._path(call)
        if not isinstance(on, Terrain):
            call.fail(f"on = {shown(on)} must be what scene.terrain returned")
        random = np.random.default_rng(call.integer("seed", seed, 0, 2**31 - 1))
        lengths = _lengths(call, size)
        many = call.integer("count", count, 1, _MOST)
        away = [_kept(call, k, each) for k, each in enumerate(call.listed("clear", clear, "a list of (road, 1.0)"))]
        if what == ROCKS:
            low, high = lengths
            long = low * (high / low) ** random.random(many) ** 2
            _fits(call, on, f"size = ({low:g}, {high:g}) m", float(long.max()), 0.5 * float(long.max()))
            places = _places(call, on, many, 0.5 * long, away, random)
            surface = self._surface(
                call, material, friction, None, _STONE if color is None and material is None else color
            )
            each = [(float(a), rock(float(a), random), random.uniform(0.0, 2.0 * math.pi)) for a in long]
            return [self._rock(f"{name}_{k}", on, at, *each[k][1:], surface) for k, at in enumerate(places)]
        for field, given in (("material", material), ("friction", friction), ("color", color)):
            if given is not None:
                call.fail(f"{field} = {shown(given)}: things of the catalogue have their own; leave it out")
        entries = self._entries(call, what)
        for entry in entries:
            across = max(entry.size[:2])
            _fits(call, on, f"what = {shown(entry.id)}", across, max(0.5 * across, STANDS))
        chosen = [entries[k] for k in random.integers(0, len(entries), many)]
        wide = np.array([0.5 * max(entry.size[:2]) for entry in chosen])
        made = []
        for k, (x, y) in enumerate(_places(call, on, many, wide, away, random)):
            low_ground = min(on.height(x + STANDS * c, y + STANDS * s) for c, s in _AROUND)
            turn = (0.0, 0.0, float(random.uniform(0.0, 360.0)))
            made.append(self.asset(f"{name}_{k}", chosen[k].id, position=(x, y, low_ground), rotation_deg=turn,
                                   static=True))  # fmt: skip
        return made

    def _rock(
        self, name: str, on: Terrain, at: tuple[float, float], made: tuple[Floats, Any], turn: float, surface: Any
    ) -> Handle:  # fmt: skip
        """A rock in the ground, turned about the vertical [rad]."""
        points, faces = made
        path = self._path(Call("scatter", name))
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        note_line(prim)
        place: Vec3 = on.place(*at, above=float(-points[:, 2].min() - _SUNK * np.ptp(points[:, 2])))
        set_pose(prim, place, Gf.Quatd(math.cos(0.5 * turn), Gf.Vec3d(0.0, 0.0, math.sin(0.5 * turn))))
        mesh = define_mesh(self._stage, f"{path}/geometry", points, [faces], None).GetPrim()
        note_line(mesh)
        finish_collider(mesh, surface)
        return Handle(prim.GetName(), path, "static")

    def _entries(self, call: Call, what: object) -> list[Any]:
        """What the catalogue has of some ids; SceneError for one that it has not, or that moves on joints."""
        from wsim.assets import AssetError, get  # with pydantic, and few programs name an asset

        listed = [what] if isinstance(what, str) else call.listed("what", what, '"rocks" or ids of assets')
        if not listed:
            call.fail('what = [] names nothing; give "rocks" or ids of assets')
        found = []
        for each in listed:
            if not isinstance(each, str):
                call.fail(f'what = {shown(each)} must be "rocks" or the id of an asset, or several of these')
            try:
                found.append(get(each))
            except AssetError as error:
                call.fail(f"what: {error}")
            if found[-1].articulated:
                call.fail(f"what = {shown(each)}, whose parts move on a joint; take another")
        return found


def _lengths(call: Call, size: object) -> tuple[float, float]:
    listed = call.listed("size", size, "(least, greatest) length in m")
    if len(listed) != 2:
        call.fail(f"size = {shown(size)} must be 2 numbers, (least, greatest) length in m")
    low, high = (call.size(f"size[{k}]", each) for k, each in enumerate(listed))
    if low > high:
        call.fail(f"size = ({low:g}, {high:g}) m: the least must not be above the greatest; swap them")
    return low, high


def _kept(call: Call, k: int, given: object) -> tuple[Floats, float]:
    """A line that things keep away from, and by how much [m]."""
    field = f"clear[{k}]"
    pair = call.listed(field, given, "(road, 1.0), ((x, y), 3.0) or ([(x, y), ...], 2.0)")
    if len(pair) != 2:
        call.fail(f"{field} = {shown(given)} must be such as (road, 1.0), ((x, y), 3.0) or ([(x, y), ...], 2.0)")
    margin = call.within(f"{field}[1]", pair[1], 0.0, MAX_SIZE, "m")
    if isinstance(pair[0], Road):
        road = Call(call.method, call.name, f"{field}[0].")
        return pair[0].checked_line(road), margin + 0.5 * road.size("width", pair[0].width)
    items = call.listed(f"{field}[0]", pair[0], "a Road, (x, y) in m, or a list of those")
    if items and isinstance(items[0], (Sequence, np.ndarray)):
        return polyline(call, items, f"{field}[0]"), margin
    return np.array([point(call, f"{field}[0]", items)]), margin


def _fits(call: Call, on: Terrain, given: str, across: float, margin: float) -> None:
    """SceneError if a thing that stays `margin` [m] within a terrain's edges is too wide for it."""
    if margin > on.reach:
        call.fail(f"{given}: one of {across:.3g} m is too wide for on = {shown(on.name)}, which must be "
                  f"{2.0 * margin:.3g} m or more in x and y and is {2.0 * on.reach:.3g}; take a smaller one, or larger "
                  "terrain")  # fmt: skip


def _places(
    call: Call, on: Terrain, count: int, radius: Floats, away: list[tuple[Floats, float]], random: np.random.Generator
) -> list[tuple[float, float]]:  # fmt: skip
    """Where they stand, (x, y) in the world [m]; the widest are placed first."""
    found: dict[int, tuple[float, float]] = {}
    for k in np.argsort(-radius, kind="stable"):
        reach = float(radius[k])
        for _ in range(_TRIES):
            x, y = on.anywhere(random, max(reach, STANDS))
            if all(_far(line, x, y) >= margin + reach for line, margin in away) and all(
                math.hypot(x - a, y - b) >= reach + radius[j] for j, (a, b) in found.items()
            ):
                found[int(k)] = x, y
                break
        else:
            call.fail(f"count = {count}: after {len(found)} there is no room for one of {2.0 * reach:.3g} m; take "
                      "fewer or smaller ones, or less in clear")  # fmt: skip
    return [found[k] for k in range(count)]


def _far(line: Floats, x: float, y: float) -> float:
    if len(line) == 1:
        return math.hypot(x - line[0, 0], y - line[0, 1])
    return float(nearest(line, np.array([x]), np.array([y]))[0][0])
