"""A body's triangles, apart: a cupboard of six boards is six closed shells, each plain by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from wsim.intake.model import Faces


def edges_of(faces: Faces) -> tuple[Faces, Faces]:
    """The edges of faces in turn, (3 F,): the number of each, the same for both ways; and 1 or -1 for its way."""
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, number = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return number.reshape(-1), np.where(edges[:, 0] < edges[:, 1], 1, -1)


def is_closed(faces: Faces) -> bool:
    """Whether each edge has a twin the other way: what encloses a volume, shells that touch along an edge too."""
    if not len(faces):
        return False
    number, way = edges_of(faces)
    return not np.bincount(number, weights=way).any()


def shells(faces: Faces) -> list[Faces]:
    """The numbers of the faces of each shell: those that hang together over edges of two faces.

    Where more faces meet in an edge, things touch each other there.
    """
    number, _ = edges_of(faces)
    count = np.bincount(number)
    face = np.repeat(np.arange(len(faces)), 3)
    plain = count[number] == 2
    order = np.argsort(number[plain], kind="stable")
    pairs = face[plain][order].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(faces),) * 2)
    label = connected_components(graph, directed=False)[1]
    order = np.argsort(label, kind="stable")
    return list(np.split(order, np.flatnonzero(np.diff(label[order])) + 1))


def turned_over(faces: Faces) -> NDArray[np.bool_]:
    """Which faces, (F,), must turn over for all of a shell to turn the way of its first."""
    number, way = edges_of(faces)
    face = np.repeat(np.arange(len(faces)), 3)
    plain = np.bincount(number)[number] == 2
    order = np.argsort(number[plain], kind="stable")
    pairs, ways = face[plain][order].reshape(-1, 2), way[plain][order].reshape(-1, 2)
    near: dict[int, list[tuple[int, bool]]] = {}
    for (a, b), (one, other) in zip(pairs.tolist(), ways.tolist(), strict=True):
        near.setdefault(a, []).append((b, one == other))
        near.setdefault(b, []).append((a, one == other))
    over, seen = np.zeros(len(faces), dtype=bool), np.zeros(len(faces), dtype=bool)
    for first in range(len(faces)):
        waiting = [] if seen[first] else [first]
        seen[first] = True
        while waiting:
            at = waiting.pop()
            for neighbour, against in near.get(at, ()):
                if not seen[neighbour]:
                    seen[neighbour] = True
                    over[neighbour] = over[at] ^ against
                    waiting.append(neighbour)
    return over
