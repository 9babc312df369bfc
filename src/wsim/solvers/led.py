"""Contacts that lead a mechanism round: those whose normals turn for as long as they press.

A push that is held over a step lags behind what it does, by half a step. Where its normal stays as it is, as on a
floor, that is nothing, since what it presses does not move along it. Where the normal turns at w, as across a gutter,
it gives w^2 h / 2 of the energy a second, as with loose bodies (`wsim.solvers.flight`); steps of the first order keep
it. A blow, and what presses for an instant, have no time to. What hangs on the same body is pushed in the coordinates
of the joints between, which turn with that body: from there the normals are seen.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from wsim.solvers.groups import joint_root

Array = np.ndarray
Normal = tuple[float, float, float]
FAR = 0.2  # that a normal has turned by since its contact presses, of what is led [rad]
LASTS = 0.1  # for which it has pressed then [s]: what a cable throws off is not led
AGAIN = 0.02  # for which a contact may let go and still be the same [s]


class Led:
    """Of one world on the CPU: which contacts lead.

    Args:
        model: MuJoCo's model.
        of_geom: The mechanism of each geom, 0 for none.
    """

    def __init__(self, model: Any, of_geom: Array) -> None:
        self._model, self._of_geom, self._count = model, of_geom, int(of_geom.max(initial=0)) + 1
        self._roots: dict[tuple[int, int], int] = {}
        self._seen: dict[tuple[int, int], tuple[float, float, float, Normal]] = {}
        # since when each presses, until when, how far it turned, its normal

    def root(self, one: int, two: int) -> int:
        """The body that the bodies of two geoms both hang on; 0 for the world."""
        if (one, two) not in self._roots:
            self._roots[one, two] = joint_root(self._model, *self._model.geom_bodyid[[one, two]].tolist())
        return self._roots[one, two]

    def mechanisms(self, data: Any, rows: Array) -> Array:
        """Mechanisms that contacts lead, (mechanisms,); these are `rows` of MuJoCo's that push now."""
        found, now = np.zeros(self._count, dtype=bool), float(data.time)
        geoms = data.contact.geom[rows]
        ours = self._of_geom[geoms].any(axis=1)
        pairs = [(one, two) for one, two in geoms[ours].tolist()]
        turns = data.xmat[[self.root(one, two) for one, two in pairs]].reshape(-1, 3, 3)
        seen = np.einsum("ni,nij->nj", data.contact.frame[rows[ours], :3], turns)
        sums: dict[tuple[int, int], Normal] = {}
        for pair, (x, y, z) in zip(pairs, seen.tolist(), strict=True):  # of a few NumPy's arrays cost more
            a, b, c = sums.get(pair, (0.0, 0.0, 0.0))
            sums[pair] = a + x, b + y, c + z
        for pair, (x, y, z) in sums.items():
            size = max(math.hypot(x, y, z), 1e-12)
            normal = x / size, y / size, z / size
            since, last, turned, before = self._seen.get(pair, (now, -math.inf, 0.0, normal))
            if not 0.0 <= now - last <= AGAIN:
                since, turned, before = now, 0.0, normal
            turned += 2.0 * math.asin(min(0.5 * math.dist(normal, before), 1.0))
            self._seen[pair] = since, now, turned, normal
            if turned > FAR and now - since > LASTS:
                found[self._of_geom[list(pair)]] = True
        return found
