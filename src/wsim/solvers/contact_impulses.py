"""What each pair of geoms gives the other by contact, summed over the steps of a frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.contact_impulses import accumulate_contacts
from wsim.recording.contacts import WIDTH, Pushes

Array = np.ndarray
ROWS = np.arange(6)  # of a contact: push, two of sliding, one of spinning, two of rolling
SLOTS_A_CONTACT = 4  # of the table, for each contact that there may be at once: pairs change within a frame


class ContactImpulsesC:
    """One world on the CPU.

    Args:
        model: MuJoCo's model.
        shapes: The number of each geom's shape, as a recording counts them; below 0 for none.
    """

    def __init__(self, model: Any, shapes: Array) -> None:
        self._body, self._shapes = model.geom_bodyid.copy(), shapes
        self._still = _still_shapes(shapes, self._body)
        self._kept: list[tuple[Array, ...]] = []

    def add(self, data: Any, h: float) -> None:
        """Keep what the contacts of a step of `h` [s] gave, once the step is solved."""
        if data.ncon:
            # Copies alone: what is made of them is made once a frame.
            contact = data.contact
            arrays = (contact.efc_address, contact.dim, contact.geom, contact.pos, contact.frame)
            self._kept.append((*(array.copy() for array in arrays), h * data.efc_force, data.xipos.copy()))

    def take(self) -> Pushes:
        """The sums since the last call, which start anew."""
        kept, self._kept = self._kept, []
        if not kept:
            return Pushes(np.zeros((0, 2), np.int32), np.zeros((0, WIDTH), np.float32))
        first, dim, geom, point, frame, force, center = (np.concatenate(parts) for parts in zip(*kept, strict=True))
        counts = [len(each[0]) for each in kept]
        starts = np.cumsum([0, *(len(each[5]) for each in kept[:-1])])
        bodies = self._body[geom] + np.repeat(np.arange(len(kept)) * len(kept[0][6]), counts)[:, None]
        chosen = np.flatnonzero(first >= 0)
        rows = (first + np.repeat(starts, counts))[chosen, None] + ROWS
        given = np.where(dim[chosen, None] > ROWS, force[np.minimum(rows, len(force) - 1)], 0.0)
        point, axes = point[chosen], frame[chosen].reshape(-1, 3, 3)
        push, spin = np.moveaxis(np.einsum("nri,nsr->nsi", axes, given.reshape(-1, 2, 3)), 1, 0)
        press, arms = given[:, :1], point[:, None] - center[bodies[chosen]]
        turn = _cross(arms, push[:, None]) + spin[:, None]
        turn[:, 0] *= -1.0
        parts = [push, press, press * axes[:, 0], press * point, turn.reshape(-1, 6)]
        pairs, sums = _summed(self._shapes[geom[chosen]], np.concatenate(parts, axis=1))
        return _known(pairs, sums, self._still)

    def clear(self) -> None:
        """Forget the sums: the run starts anew."""
        self._kept = []


class ContactImpulsesWarp:
    """The first of the worlds of MuJoCo Warp; for the arguments see `ContactImpulsesC`.

    Args:
        model: MuJoCo's model.
        shapes: The number of each geom's shape.
        device: Where the worlds are.
        capacity: Contacts that a world may have at once.
    """

    def __init__(self, model: Any, shapes: Array, device: Any, capacity: int) -> None:
        self._shapes, self._still = shapes, _still_shapes(shapes, model.geom_bodyid)
        if len(shapes) ** 2 >= 2**31:
            raise ValueError(f"contacts between {len(shapes)} geoms cannot be told apart; at most 46340")
        count = SLOTS_A_CONTACT * max(1, capacity)
        with wp.ScopedDevice(device):
            self._geom_body = wp.array(model.geom_bodyid, dtype=int)
            self._keys, self._lost = wp.zeros(count, dtype=int), wp.zeros(1, dtype=int)
            self._sums = wp.zeros((count, WIDTH), dtype=float)

    def add(self, data: Any, h: float) -> None:
        """Add what the contacts of a step of `h` [s] gave, once the step is solved."""
        contact = data.contact
        wp.launch(
            accumulate_contacts,
            dim=data.naconmax,
            inputs=[
                data.nacon, contact.worldid, contact.geom, contact.pos, contact.frame, contact.efc_address, contact.dim,
                data.efc.force, self._geom_body, data.xipos, len(self._shapes), h,
            ],
            outputs=[self._keys, self._sums, self._lost],
        )  # fmt: skip

    @property
    def lost(self) -> int:
        """Contacts that found no room in the table since the start."""
        return int(self._lost.numpy()[0])

    def take(self) -> Pushes:
        """The sums since the last call, which start anew."""
        keys = self._keys.numpy()
        used = np.flatnonzero(keys)
        geoms = np.stack(np.divmod(keys[used] - 1, len(self._shapes)), axis=1)
        pairs, sums = _summed(self._shapes[geoms], self._sums.numpy()[used].astype(np.float64))
        self._keys.zero_()
        self._sums.zero_()
        return _known(pairs, sums, self._still)

    def clear(self) -> None:
        """Forget the sums: the run starts anew."""
        for array in (self._keys, self._sums, self._lost):
            array.zero_()


def _still_shapes(shapes: Array, body: Array) -> Array:
    """The shapes that are the world's own."""
    return np.unique(shapes[(body == 0) & (shapes >= 0)])


def _cross(one: Array, two: Array) -> Array:
    """Cross products along the last axis; NumPy's own takes five times as long."""
    x, y, z = (one[..., k] for k in range(3))
    u, v, w = (two[..., k] for k in range(3))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def _summed(pair: Array, rows: Array) -> tuple[Array, Array]:
    """Pairs (p, 2) that are among those of some rows (n, 2), in order, and the sums of their rows, (p, WIDTH)."""
    if not len(pair):
        return pair.reshape(0, 2), rows
    key = (pair[:, 0] + 1) * (pair.max() + 2) + pair[:, 1]
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-(2**62)))
    return pair[order[first]], np.add.reduceat(rows[order], first, axis=0)


def _known(pairs: Array, sums: Array, still: Array) -> Pushes:
    """Sums of pairs that a recording knows and that pressed, without the turns of what stands still."""
    keep = (pairs >= 0).all(axis=1) & (sums[:, 3] != 0.0)
    pairs, sums = pairs[keep], sums[keep]
    for side in (0, 1):
        sums[np.isin(pairs[:, side], still), 10 + 3 * side : 13 + 3 * side] = 0.0
    return Pushes(pairs.astype(np.int32), sums.astype(np.float32))
