"""What bodies gave each other by contact between frames: a row for each pair of shapes that pressed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.recording import columns as names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.table import Table
    from wsim.scene.world import Shape, World

    Floats = NDArray[np.float32]
    Rows = NDArray[np.int32]

WIDTH = 16  # of a row of `Pushes.sums`


@dataclass(frozen=True, eq=False)
class Pushes:
    """Sums over the steps since the frame before, n pairs of shapes; a push is on the second from the first.

    Columns of `sums`: the impulse [N s] (3); of what presses along the normals the amount (1) and the sum as vectors
    (3) [N s]; that amount times where it presses, in the world (3) [N s m]; and the angular impulses about their
    bodies' centres of mass on the first and on the second (3 each) [N m s], 0 on what stands still.
    """

    pair: Rows  # (n, 2), shapes as `shapes_of` counts them
    sums: Floats  # (n, WIDTH)


@dataclass(frozen=True, eq=False)
class ContactTrack:
    """A recording's, all frames after each other."""

    frame: Rows  # (n,)
    pair: Rows  # (n, 2)
    sums: Floats  # (n, WIDTH)

    @property
    def impulse(self) -> Floats:
        """On the second shape's body, (n, 3) [N s]."""
        return self.sums[:, :3]

    @property
    def pressed(self) -> Floats:
        """Sum of the normal impulses' sizes, (n,) [N s]."""
        return self.sums[:, 3]

    @property
    def along(self) -> Floats:
        """Sum of the normal impulses as vectors, from the first to the second, (n, 3) [N s]."""
        return self.sums[:, 4:7]

    @property
    def point(self) -> Floats:
        """Mean place of the normal impulses, in the world, (n, 3) [m]."""
        least = np.float32(np.finfo(np.float32).tiny)
        return np.asarray(self.sums[:, 7:10] / np.maximum(self.sums[:, 3:4], least), dtype=np.float32)

    @property
    def turn(self) -> Floats:
        """On the first and on the second shape's body about its centre of mass, (n, 2, 3) [N m s]."""
        return self.sums[:, 10:].reshape(-1, 2, 3)


def shapes_of(world: World) -> list[Shape]:
    """All shapes of a world, in the order that `Pushes.pair` counts them: bodies', then those of what stands still."""
    still = [shape for static in world.statics for shape in static.shapes]
    return [shape for body in world.bodies for shape in body.shapes] + still


def columns_of(pushes: list[Pushes]) -> list[object]:
    """Some frames' pushes as columns, a list of rows for each frame."""
    lengths = [len(each.pair) for each in pushes]
    pair = np.concatenate([each.pair for each in pushes]).astype(np.int32).reshape(-1, 2)
    sums = np.concatenate([each.sums for each in pushes]).astype(np.float32).reshape(-1, WIDTH)
    return [names.column(names.CONTACT_PAIR, pair, lengths), names.column(names.CONTACT_SUMS, sums, lengths)]


def read_contacts(table: Table, frame_ns: NDArray[np.int64]) -> ContactTrack | None:
    """The pushes of all frames, where they were recorded."""
    ns, pairs = table.cells(names.CONTACT_ENTITY, names.CONTACT_PAIR)
    if not len(ns):
        return None
    sums = table.cells(names.CONTACT_ENTITY, names.CONTACT_SUMS)[1]
    known = np.flatnonzero(np.isin(ns, frame_ns))
    frames = np.searchsorted(frame_ns, ns[known])
    pair = [pairs[k].flatten().to_numpy().reshape(-1, 2) for k in known]
    return ContactTrack(
        np.repeat(frames, [len(each) for each in pair]).astype(np.int32),
        np.concatenate(pair).astype(np.int32),
        np.concatenate([sums[k].flatten().to_numpy().reshape(-1, WIDTH) for k in known]).astype(np.float32),
    )
