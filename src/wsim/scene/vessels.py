"""Vessels of any shape: what the shapes of an object hold, as it stands at time 0."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.scene.hollows import hollow_of
from wsim.scene.usd_prims import object_path, owner_of
from wsim.scene.usd_shapes import collides, collides_as_hull, read_shape
from wsim.scene.validate import Call, Vec3, shown
from wsim.scene.world import Shape

ACROSS = 4  # spacings that the fluid in a vessel is wide, at least, as in a tank


class Vessel:
    """An object that may hold fluid.

    Args:
        call: For its errors.
        prim: What the program named.
        spacing: Between the fluid's particles [m].

    Attributes:
        path: Of the body, or of the object that stands still.
        hollow: What it holds.
    """

    def __init__(self, call: Call, prim: Usd.Prim, spacing: float) -> None:
        self._call, self.name = call, prim.GetName()
        stage = prim.GetStage()
        inside = [part for part in Usd.PrimRange(prim) if part.HasAPI(UsdPhysics.RigidBodyAPI)]
        if len(inside) > 1:
            call.fail(
                f"fills = {shown(self.name)} is {len(inside)} bodies; name the one that is hollow, such as "
                f"{shown(str(inside[0].GetPath()))}"
            )
        self.path = (str(inside[0].GetPath()) if inside else owner_of(prim)) or object_path(prim, stage)
        shapes = shapes_of(stage.GetPrimAtPath(self.path))
        moves = stage.GetPrimAtPath(self.path).HasAPI(UsdPhysics.RigidBodyAPI)
        try:
            self.hollow = hollow_of(shapes, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), spacing)
        except ValueError:
            call.fail(
                f"fills = {shown(self.name)} holds no fluid as it stands: it has no hollow that is open above, or "
                f"closed all round, of {ACROSS} spacings of {spacing:g} m; {_way_out(shapes, moves)}"
            )

    def level_of(self, level: float | None, volume: float | None) -> float:
        """The height of the surface in the world [m], by the depth above its lowest point or by the volume."""
        hollow, call = self.hollow, self._call
        deep, most = hollow.rim - hollow.floor, hollow.filling(hollow.rim).volume
        if level is not None:
            depth = call.number("level", level, "m")
            if depth != 0.0:
                depth = call.size("level", level)
            if depth > deep + 1e-6:
                call.fail(
                    f"level = {depth:g} m is above the rim of {shown(self.name)}: as it stands its hollow is "
                    f"{deep:.4g} m deep, and holds {most:.4g} m^3; take level <= {deep:.4g}"
                )
            return hollow.floor + depth
        amount = call.positive("volume", volume, 1e9, "m^3")
        if amount > most:
            call.fail(
                f"volume = {amount:g} m^3 is more than {shown(self.name)} holds as it stands: {most:.4g} m^3, "
                f"{deep:.4g} m deep; take volume <= {most:.4g}, or set it upright"
            )
        return hollow.level_of(amount)

    def filled(self, level: float, spacing: float) -> tuple[Vec3, Vec3, float]:
        """Edges and centre of the box round the fluid under a level [m], and its volume [m^3].

        One that is empty yet has no height, and is as wide as the whole hollow.
        """
        empty = level <= self.hollow.floor
        filling = self.hollow.filling(self.hollow.rim if empty else level)
        low, high = filling.cells.min(axis=0) - 0.5 * filling.edge, filling.cells.max(axis=0) + 0.5 * filling.edge
        low[2], high[2] = self.hollow.floor, level
        if min(high[:2] - low[:2]) < ACROSS * spacing:
            self._call.fail(
                f"spacing = {spacing:g} m is too coarse for {shown(self.name)}: the fluid in it is "
                f"{high[0] - low[0]:.3g} x {high[1] - low[1]:.3g} m wide, and takes {ACROSS} spacings; take spacing <= "
                f"{min(high[:2] - low[:2]) / ACROSS:.3g}"
            )
        size, center = (high - low).tolist(), (0.5 * (low + high)).tolist()
        volume = 0.0 if empty else filling.volume
        return (size[0], size[1], size[2]), (center[0], center[1], center[2]), volume


def shapes_of(prim: Usd.Prim) -> list[Shape]:
    """What collides of an object, in the world."""
    moves, found = prim.HasAPI(UsdPhysics.RigidBodyAPI), []
    for part in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()):
        if part.IsA(UsdGeom.Gprim) and collides(part):
            shape = read_shape(part, Gf.Matrix4d(1.0))
            if shape is not None and shape.kind != "plane":
                found.append(shape.model_copy(update={"convex": collides_as_hull(part, moves=moves)}))
    return found


def _way_out(shapes: Sequence[Shape], moves: bool) -> str:
    if moves and any(shape.kind == "mesh" and shape.convex for shape in shapes):
        return 'a mesh that moves collides as its convex hull: give it collision="convexDecomposition"'
    return "turn its opening up, take a smaller spacing, or name a tank, a bowl or another vessel"
