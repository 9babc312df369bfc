"""What contacts and joints may do: the impulses that a world can exert, as columns of a small linear problem.

Columns are impulses on bodies, 6 rows a body: momentum and angular momentum about its own centre of mass.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import cross, rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.touching import Contacts, Touching

    Floats = NDArray[np.float64]

EDGES = 8  # of the friction cone, which it is cut around
STILL = 0.02  # [m/s]: a slower slip may come and go within an interval
ONE_WAY = 0.9  # cosine between the slips at both ends of an interval that lasts


@dataclass(frozen=True)
class Poses:
    """All bodies at one instant; (B, …)."""

    q: Floats  # (B, 7) of the bodies' origins [m; xyzw]
    com: Floats  # (B, 3) [m]
    v: Floats  # (B, 3), of the centres of mass [m/s]
    w: Floats  # (B, 3) [rad/s]


@dataclass(frozen=True)
class Columns:
    """Impulses of strength one: on the bodies of two rows, c of them; a row below 0 is the world, which takes any."""

    one: NDArray[np.intp]  # (c,)
    two: NDArray[np.intp]
    on_one: Floats  # (c, 6)
    on_two: Floats
    both: NDArray[np.bool_]  # (c,) whether it may act both ways, or only as it is
    more: NDArray[np.bool_] | None = None  # (c,) whether it is the one before it, on more bodies; None: none is
    cap: Floats | None = None  # (c,) the most that its strength may be, either way; None: any
    close: NDArray[np.bool_] | None = None  # (c,) whether it is at hand, and not a contact of what is apart; None: all

    @property
    def goes_on(self) -> NDArray[np.bool_]:
        """Whether each is one with the column before it, whose strength it has, (c,)."""
        return np.zeros(len(self.one), dtype=bool) if self.more is None else self.more

    @property
    def most(self) -> Floats:
        """The greatest strength of each, (c,)."""
        return np.full(len(self.one), np.inf) if self.cap is None else self.cap

    @property
    def near(self) -> NDArray[np.bool_]:
        """Whether each acts without a gap, (c,)."""
        return np.ones(len(self.one), dtype=bool) if self.close is None else self.close

    def shifted(self, by: int) -> Columns:
        """The same on bodies whose rows are higher."""
        one, two = (np.where(rows >= 0, rows + by, rows) for rows in (self.one, self.two))
        return replace(self, one=one, two=two)

    @staticmethod
    def of(parts: list[Columns]) -> Columns:
        """All of several."""
        names = "one", "two", "on_one", "on_two", "both", "goes_on", "most", "near"
        return Columns(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def slip(touching: Touching, contacts: Contacts, poses: Poses) -> Floats:
    """Velocity of the second body's surface over the first's at each contact, (n, 3) [m/s]."""
    return _surface(touching, contacts, poses, 1) - _surface(touching, contacts, poses, 0)


def _surface(touching: Touching, contacts: Contacts, poses: Poses, side: int) -> Floats:
    rows = contacts.two if side else contacts.one
    moving = rows >= 0
    at = np.maximum(rows, 0)
    if not len(poses.v):
        return np.zeros((len(rows), 3))
    velocity = poses.v[at] + cross(poses.w[at], contacts.surface(side) - poses.com[at])
    found: Floats = np.where(moving[:, None], velocity, 0.0)
    if touching.surface_velocity.any():
        turn = np.where(moving[:, None], poses.q[at, 3:], (0.0, 0.0, 0.0, 1.0))
        found += rotate(turn, touching.surface_velocity[contacts.shapes[:, side]])
    return found


def pushes(
    contacts: Contacts, poses: Poses, friction: Floats, along: Floats, rolling: Floats,
    near: NDArray[np.bool_] | None = None,
) -> Columns:  # fmt: skip
    """The impulses of contacts: inside the cone, or on its edge where `along` says which ways a slip lasts.

    Args:
        contacts: n of them, at the
        poses: that their arms are taken from.
        friction: (n,).
        along: Ways of the lasting slip of the second body over the first, (n, 2, 3), as long as the share of friction
            that is against it: 1 but where rolling is resisted, too; 0 where there is none.
        rolling: Torque that resists turning, for a push of one, (n,) [m].
        near: Whether each is at hand, (n,); None: all are.
    """
    n, lasting = contacts.normal, np.any(along != 0.0, axis=(1, 2))
    other = np.where(np.abs(n[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    t1 = cross(n, other)
    t1 /= np.linalg.norm(t1, axis=1, keepdims=True)
    t2 = cross(n, t1)
    angle = 2.0 * np.pi * np.arange(EDGES) / EDGES
    ring = (np.cos(angle)[:, None, None] * t1 + np.sin(angle)[:, None, None] * t2) / np.cos(np.pi / EDGES)
    cone = (n + friction[:, None] * ring).reshape(-1, 3)
    which = np.tile(np.arange(len(n)), EDGES)
    keep = ~lasting[which]
    edges = [(n - friction[:, None] * along[:, k])[lasting] for k in range(along.shape[1])]
    force = np.concatenate([cone[keep], *edges])
    which = np.concatenate([which[keep], *([np.flatnonzero(lasting)] * len(edges))])
    spin = np.zeros_like(force)
    turned, rolls = np.flatnonzero(rolling > 0.0), np.flatnonzero((rolling > 0.0) & ~lasting)
    axes = _turning(contacts, poses, friction) if len(turned) else ()
    rubs, slides = friction[:, None] * ring, friction[:, None] * along[:, 0]
    more = [(turned, -slides, way * axis) for axis in axes for way in (-1.0, 1.0)]
    # What rolls with a slight slip takes a little of the one beside nearly all of the other: their cone is round, and
    # an octagon about it has the corners (1, tan(pi / 8)), (tan(pi / 8), 1).
    little = np.tan(np.pi / EDGES)
    for axis in (*axes[:1], *(-each for each in axes[:1])):
        more += [(rolls, edge, little * axis) for edge in rubs] + [(rolls, little * edge, axis) for edge in rubs]
    force = np.concatenate([force, *((n + rub)[rows] for rows, rub, _ in more)])
    spin = np.concatenate([spin, *((rolling[:, None] * axis)[rows] for rows, _, axis in more)])
    which = np.concatenate([which, *(rows for rows, *_ in more)])
    both = enumerate((contacts.one, contacts.two))
    arms = [contacts.surface(side) - poses.com[np.maximum(rows, 0)] for side, rows in both]
    on_two = np.concatenate([force, cross(arms[1][which], force) + spin], axis=1)
    on_one = np.concatenate([-force, -cross(arms[0][which], force) - spin], axis=1)
    close = None if near is None else near[which]
    none = np.zeros(len(which), dtype=bool)
    return Columns(contacts.one[which], contacts.two[which], on_one, on_two, none, close=close)


def _turning(contacts: Contacts, poses: Poses, friction: Floats) -> tuple[Floats, Floats, Floats]:
    """Axes for the torques that resist turning, square to each other, (n, 3) each: the first against it, or with it."""
    turning, normal = np.zeros_like(contacts.normal), contacts.normal
    for rows, sign in ((contacts.one, -1.0), (contacts.two, 1.0)):
        turning += sign * np.where((rows >= 0)[:, None], poses.w[np.maximum(rows, 0)], 0.0)
    spins = np.einsum("ni,ni->n", turning, normal)[:, None]
    turning += ((np.pi * friction[:, None]) ** 2 - 1.0) * spins * normal  # each by its speed and its share of the cone
    length = np.linalg.norm(turning, axis=1, keepdims=True)
    first = np.where(length > 0.0, turning / np.maximum(length, 1e-300), normal)
    other = np.where(np.abs(first[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    second = cross(first, other)
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    return first, second, cross(first, second)


def holds(one: int, two: int, arms: tuple[Floats, Floats], forces: Floats, torques: Floats) -> Columns:
    """A joint's impulses: forces (f, 3) at its anchor, `arms` (3,) from both centres of mass, and torques (t, 3)."""
    twist = np.concatenate([np.zeros_like(torques), torques], axis=1)
    on_two = np.concatenate([np.concatenate([forces, cross(arms[1], forces)], axis=1), twist])
    on_one = -np.concatenate([np.concatenate([forces, cross(arms[0], forces)], axis=1), twist])
    count = len(on_two)
    rows = np.full(count, one, dtype=np.intp), np.full(count, two, dtype=np.intp)
    return Columns(*rows, on_one, on_two, np.ones(count, dtype=bool))


def shared(rows: NDArray[np.intp], on: Floats, *, both: bool = False) -> Columns:
    """One impulse on several bodies at once, (n, 6), which acts only as it is, or both ways."""
    count = len(rows)
    before = np.concatenate([[-1], rows[:-1]]).astype(np.intp)
    return Columns(before, rows, np.zeros((count, 6)), on, np.full(count, both), np.arange(count) > 0)


def turns(rows: NDArray[np.intp]) -> Columns:
    """Any torque on some bodies."""
    which = np.repeat(rows, 3)
    twist = np.tile(np.concatenate([np.zeros((3, 3)), np.eye(3)], axis=1), (len(rows), 1))
    return Columns(np.full(len(which), -1), which, np.zeros_like(twist), twist, np.ones(len(which), dtype=bool))
