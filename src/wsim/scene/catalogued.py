"""Objects of the catalogue, copied into the stage: it needs no file beside it."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Sdf, Usd, UsdPhysics

from wsim.scene.authoring import Author, Handle, note_line, rotation, set_pose, world_pose
from wsim.scene.bodies import set_start
from wsim.scene.validate import Call, shown

_HERE = (0.0, 0.0, 0.0)


class Catalogued(Author):
    """The call that places an asset."""

    def asset(
        self,
        name: str,
        id: str,
        *,
        position: Sequence[float] = _HERE,
        rotation_deg: Sequence[float] = _HERE,
        velocity: Sequence[float] = _HERE,
        angular_velocity_deg: Sequence[float] = _HERE,
        static: bool = False,
    ) -> Handle:
        """Place an object of the catalogue.

        Args:
            name: Name of its prim.
            id: Of the asset, such as "desk"; `wsim.assets.search` finds it by other words.
            position: Of the centre of its bottom face [m].
            rotation_deg: Roll, pitch, yaw about the world's X, Y, Z, in this order [deg].
            velocity: Of the centre of mass, in the world, of what is one body [m/s].
            angular_velocity_deg: [deg/s].
            static: Never moves.

        Raises:
            SceneError: If the catalogue has no such asset, it has joints and is to be static, or it is static or of
                several bodies and is to start with a velocity.
        """
        from wsim.assets import AssetError, get  # with pydantic, and few programs name an asset

        call = Call("asset", name)
        path = self._path(call)
        if not isinstance(id, str):
            call.fail(f"id = {shown(id)} must be the name of an asset")
        try:
            entry = get(id)
        except AssetError as error:
            call.fail(f"id: {error}")
        turn = rotation(call.angles(rotation_deg))
        if call.flag("static", static) and entry.articulated:
            call.fail(f"static = True on {id!r}, whose parts move on a joint; leave it out")
        place, start = call.position("position", position), call.velocity(velocity)
        spin = call.spin(angular_velocity_deg)
        if any((*start, *spin)) and (static or entry.articulated):
            field, value = ("velocity", start) if any(start) else ("angular_velocity_deg", spin)
            why = "a static object" if static else f"{id!r}, which is several bodies: only one body starts with one"
            call.fail(f"{field} = {value} on {why}; leave it out")
        layer = Sdf.Layer.OpenAsAnonymous(str(entry.path))
        Sdf.CopySpec(layer, Sdf.Path(f"/{layer.defaultPrim}"), self._stage.GetRootLayer(), Sdf.Path(path))
        prim = self._stage.GetPrimAtPath(path)
        set_pose(prim, place, turn)
        bodies = [part for part in Usd.PrimRange(prim) if part.HasAPI(UsdPhysics.RigidBodyAPI)]
        for part in {prim, *bodies}:
            note_line(part)
        if static:
            for part in bodies:
                part.RemoveAPI(UsdPhysics.RigidBodyAPI)
                part.RemoveAPI(UsdPhysics.MassAPI)
        elif any((*start, *spin)):
            set_start(bodies[0], world_pose(bodies[0])[1], start, spin)
        return Handle(name=prim.GetName(), path=path, kind="static" if static else "body")
