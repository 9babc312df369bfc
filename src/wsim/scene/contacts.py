"""The law of contact of one pair of objects, where it is not what their materials combine to."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdGeom, UsdPhysics

from wsim.scene import schema
from wsim.scene.authoring import CONTACTS, Author, Handle, note_line
from wsim.scene.usd_contacts import ends, owner, tied, yields
from wsim.scene.validate import Call, shown


class Contacts(Author):
    """The call that states the law of a pair."""

    def contact(
        self,
        a: Handle | str,
        b: Handle | str,
        *,
        friction: float | None = None,
        restitution: float | None = None,
        rolling: float | None = None,
    ) -> None:
        """State how two objects rub, bounce and roll on each other; what is not given their materials decide.

        Args:
            a: A body, or an object that never moves.
            b: Another; one of the two moves.
            friction: Coefficient of friction, 0 to 10.
            restitution: 0 (dead) to 1 (elastic): the damping of the contact follows from it.
            rolling: Rolling resistance, 0 to 1, as that of `material`.

        Raises:
            SceneError: If an object is not there, nothing is given or out of range, the pair has been stated, or it
                never touches: two that a joint ties, or a gear meshes.
        """
        call = Call("contact", f"{_name(a)}, {_name(b)}")
        first, second = self._solid_of(call, "a", a), self._solid_of(call, "b", b)
        values = {
            "friction": None if friction is None else call.friction(friction),
            "restitution": None if restitution is None else call.fraction("restitution", restitution),
            "rolling": None if rolling is None else call.fraction("rolling", rolling),
        }
        if all(value is None for value in values.values()):
            call.fail("nothing is given; give friction, restitution or rolling")
        self._check_pair(call, first, second)
        prim = self._new_pair(f"{first.GetName()}_{second.GetName()}")
        double = Sdf.ValueTypeNames.Double
        schema.apply(prim, schema.CONTACT, {key: (double, each) for key, each in values.items() if each is not None})
        for key, end in (("first", first), ("second", second)):
            prim.CreateRelationship(f"wsim:{key}", custom=False).SetTargets([end.GetPath()])

    def _new_pair(self, name: str) -> Usd.Prim:
        scope = self._stage.GetPrimAtPath(CONTACTS) or UsdGeom.Scope.Define(self._stage, CONTACTS).GetPrim()
        while scope.GetChild(name):
            name += "_"
        prim = UsdGeom.Scope.Define(self._stage, f"{CONTACTS}/{name}").GetPrim()
        note_line(prim)
        return prim

    def _check_pair(self, call: Call, first: Usd.Prim, second: Usd.Prim) -> None:
        one, other = first.GetPath(), second.GetPath()
        if one.HasPrefix(other) or other.HasPrefix(one):
            call.fail(f"a = {shown(first.GetName())}, b = {shown(second.GetName())}: a pair is two objects")
        if not yields(first) and not yields(second):
            call.fail(
                f"a = {shown(first.GetName())}, b = {shown(second.GetName())}: both are static or kinematic; no "
                "contact moves either: name a loose body"
            )
        tie = tied(self._stage.Traverse()).get(frozenset((one, other)))
        if tie is not None:
            call.fail(
                f"a = {shown(first.GetName())}, b = {shown(second.GetName())}: they never touch: {tie}; leave the "
                "pair out"
            )
        scope = self._stage.GetPrimAtPath(CONTACTS)
        if scope and any(set(ends(pair)) == {one, other} for pair in scope.GetChildren()):
            call.fail("the pair is stated a second time; give all its coefficients in one call")

    def _solid_of(self, call: Call, field: str, what: Handle | str) -> Usd.Prim:
        """The object that an argument means, which has a surface."""
        prim = self._find(call, field, what)
        if not any(part.HasAPI(UsdPhysics.CollisionAPI) for part in Usd.PrimRange(prim)):
            call.fail(f"{field} = {shown(prim.GetName())} has no surface that collides; name a body or a static object")
        return owner(prim)


def _name(what: object) -> object:
    return what.name if isinstance(what, Handle) else what
