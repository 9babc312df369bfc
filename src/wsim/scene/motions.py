"""Motion that a world states: surfaces that move as belts do."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Gf, Sdf, UsdGeom, UsdPhysics, Usd

from wsim.scene import schema
from wsim.scene.authoring import Author, Handle, note_line
from wsim.scene.validate import Call


class Motions(Author):
    """The calls that state a motion."""

    def surface_velocity(self, body: Handle | str, *, velocity: Sequence[float]) -> None:
        """Let the surface of an object move as a conveyor's or a treadmill's does, while the object stays.

        What touches it is carried by friction, as by a belt that runs under it, and pushes back on the object.

        Args:
            body: A static object, or a body; a handle or a name. All its colliders move so.
            velocity: (x, y, z) in the object's own axes, and turns with it [m/s]. Only its part along the surface acts:
                (1, 0, 0) on a box moves its top, its bottom and two of its sides. Zeros stop it.

        Raises:
            SceneError: If there is no such object, nothing of it collides, or the velocity is out of range.
        """
        call = Call("surface_velocity", getattr(body, "name", body))
        prim = self._find(call, "body", body)
        speed = call.velocity(velocity)
        if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim)):
            call.fail(f'body = "{prim.GetName()}" has nothing that collides; name a solid')
        value = Gf.Vec3f(*speed)
        schema.apply(prim, schema.SURFACE_VELOCITY, {"surfaceVelocity": (Sdf.ValueTypeNames.Vector3f, value)})
