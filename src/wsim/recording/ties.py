"""What joints, springs and ropes gave bodies between frames: a row for each joint, one for each end of a cord."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from wsim.recording import columns as names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.table import Table
    from wsim.scene.world import World

    Floats = NDArray[np.float32]

JOINT_WIDTH = 17  # of a row of `TieSums.joints`
CORD_WIDTH = 7  # of a row of `TieSums.cords`
NAMES = (names.JOINT_SUMS, names.CORD_SUMS)


class Ties(Protocol):
    """The sums of a frame (`TieSums`), which may be made when they are asked for."""

    @property
    def joints(self) -> Floats:
        """(J, JOINT_WIDTH)."""

    @property
    def cords(self) -> Floats:
        """(K, CORD_WIDTH)."""


@dataclass(frozen=True, eq=False)
class TieSums:
    """Sums over the steps since the frame before, in the world's axes.

    Columns of `joints`, a row for each of `World.joints`: the impulse on the child (3) [N s]; the angular impulses on
    the parent and on the child, each about its own centre of mass (3 each), and on the child about the joint's anchor
    (3) [N m s]; of a hinge about its axis, of a slider along it [N m s or N s]: all that the joint passes on to its
    child (1), and of that what drive and control (1), dry friction (1), stops (1) and gears (1) say that they give.

    Columns of `cords`, a row for each of `cord_ends`: the impulse on the body (3) [N s], its angular impulse about the
    body's centre of mass (3) [N m s], and the cord's own tension, positive where it pulls (1) [N s].
    """

    joints: Floats  # (J, JOINT_WIDTH)
    cords: Floats  # (K, CORD_WIDTH)


@dataclass(frozen=True, eq=False)
class TieTrack:
    """A recording's, of T frames."""

    joints: Floats  # (T, J, JOINT_WIDTH)
    cords: Floats  # (T, K, CORD_WIDTH)

    @property
    def impulse(self) -> Floats:
        """Of each joint on its child, (T, J, 3) [N s]."""
        return self.joints[..., :3]

    @property
    def turn(self) -> Floats:
        """On the parent and on the child about their centres of mass, (T, J, 2, 3) [N m s]."""
        return self.joints[..., 3:9].reshape(*self.joints.shape[:2], 2, 3)

    @property
    def about_anchor(self) -> Floats:
        """On the child about the joint's anchor, (T, J, 3) [N m s]."""
        return self.joints[..., 9:12]

    @property
    def along(self) -> Floats:
        """All that goes about a hinge's axis or along a slider's, (T, J) [N m s or N s]."""
        return self.joints[..., 12]

    @property
    def drive(self) -> Floats:
        """What drives and control give of it, (T, J)."""
        return self.joints[..., 13]

    @property
    def friction(self) -> Floats:
        """What dry friction gives of it, (T, J)."""
        return self.joints[..., 14]

    @property
    def stop(self) -> Floats:
        """What stops give of it, (T, J)."""
        return self.joints[..., 15]

    @property
    def gear(self) -> Floats:
        """What gears give of it, (T, J)."""
        return self.joints[..., 16]

    @property
    def tension(self) -> Floats:
        """Of the cord at each end, (T, K) [N s]."""
        return self.cords[..., 6]


def columns_of_ties(ties: list[Ties], world: World) -> list[object]:
    """Some frames' sums as columns, a row a frame.

    Raises:
        ValueError: They are not of the world's joints and cords.
    """
    counts = len(world.joints) * JOINT_WIDTH, len(cord_ends(world)) * CORD_WIDTH
    rows = (np.stack([each.joints for each in ties]), np.stack([each.cords for each in ties]))
    flat = [np.asarray(part, dtype=np.float32).reshape(len(ties), -1) for part in rows]
    if (widths := tuple(part.shape[1] for part in flat)) != counts:
        raise ValueError(f"frame: ties have {widths} numbers, the world's joints and cords {counts}")
    return [names.column(name, part) for name, part in zip(NAMES, flat, strict=True) if part.shape[1]]


def read_ties(table: Table, world: World, frame_ns: NDArray[np.int64]) -> TieTrack | None:
    """What joints and cords gave, where it was recorded: recordings of before have none, and of them none is asked."""
    counts = (len(world.joints), JOINT_WIDTH), (len(cord_ends(world)), CORD_WIDTH)
    found = [np.zeros((len(frame_ns), *count), np.float32) for count in counts]
    for k, (name, count) in enumerate(zip(NAMES, counts, strict=True)):
        ns, values = table.get(names.FRAME_ENTITY, name, count, np.float32)
        if count[0] and not len(ns):
            return None
        if count[0]:
            found[k] = values[np.searchsorted(ns, frame_ns)]
    return TieTrack(*found) if any(count[0] for count in counts) else None


def cord_ends(world: World) -> list[tuple[int, int]]:
    """Which cord pulls which body, in the order of `TieSums.cords`: numbers in `world.cords` and `world.bodies`."""
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    held = [sorted({row[guide.body] for guide in cord.path if guide.body in row}) for cord in world.cords]
    return [(k, body) for k, bodies in enumerate(held) for body in bodies]
