"""Where a body is to start instead: out of what it starts in, or over what is to carry it. Tried on the numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import sides_of
from wsim.judge.evidence.contact import distance, overlaps
from wsim.judge.evidence.posed import posed
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Body

    Floats = NDArray[np.float64]

TRIED = 48  # places along a way
FARTHEST = 3.0  # sizes of the body that it may be moved by to part it from what it starts in
TOUCHING = 1e-3  # of its smallest extent: what overlaps no more than this touches
DIGITS = 5


def start_at(body: Body, to: Floats, why: str) -> RepairTarget:
    """A body is to start elsewhere [m]."""
    vector = tuple(round(float(x), DIGITS) for x in to)
    return RepairTarget(
        kind="settlement", prim=body.prim, parameter="position", direction="change", vector=vector, unit="m", why=why
    )


def overlapping_start(evidence: Evidence, prim: str | None, least: float = TOUCHING) -> RepairTarget | None:
    """The target for a body that starts inside another object: out of it, the shortest way that is free.

    Args:
        evidence: What happened.
        prim: The body, or what it starts in; any, if None.
        least: How deep it is in that at least, of the smaller one's smallest extent.
    """
    pairs = [pair for pair in overlaps(evidence) if prim in (pair.a.owner, pair.b.owner) or prim is None]
    deepest = max(pairs, key=lambda pair: float(pair.depth[0]), default=None)
    if deepest is None:
        return None
    depth = float(deepest.depth[0])
    size = min(part.kind.thinnest for part in (deepest.a, deepest.b) if part.body >= 0)
    if depth <= least * size:
        return None
    ends = ((deepest.a, deepest.b), (deepest.b, deepest.a))
    # Of two that may be moved, the one that is out of everything the sooner.
    ways = [(each, other, _parted(evidence, each.body)) for each, other in ends if each.body >= 0]
    ways = sorted((way for way in ways if way[2] is not None), key=lambda way: _way(evidence, way[0].body, way[2]))
    moved, other, to = ways[0] if ways else (deepest.a, deepest.b, None)
    body = evidence.body(moved.owner)
    why = f"it starts {depth:.3g} m inside {other.owner}: move them apart by that"
    if to is None:
        return RepairTarget(
            kind="settlement", prim=body.prim, parameter="position", direction="change", unit="m", why=why
        )
    return start_at(body, to, why)


def _way(evidence: Evidence, i: int, to: Floats | None) -> float:
    assert to is not None
    return float(np.linalg.norm(to - evidence.body_q[0, i, :3]))


def over(evidence: Evidence, prim: str, ref: str, why: str) -> RepairTarget | None:
    """A body is to start over the middle of what carries it, touching it; None where nothing tells where that is."""
    i, body = evidence.index(prim), evidence.body(prim)
    middle = _middle(evidence, ref)
    if middle is None:
        return None
    up = evidence.up
    here = np.array(body.position, dtype=np.float64)
    place = middle - (middle @ up) * up + (here @ up) * up
    container = evidence.container(ref)
    if container is not None:
        low, high = (float(end[0]) for end in evidence.ends(i))
        floor = container.inner_center[2] - container.inner_size[2] / 2
        inside = floor + 0.5 * (high - low) <= place[2]
        return start_at(body, place if inside else place + (floor - low) * up, why)
    size = max(evidence.solid(i).smallest, float(np.ptp([end[0] for end in evidence.ends(i)])))
    top = float(middle @ up) + 4.0 * size + _reach(evidence, ref)
    rest = _first_free(evidence, i, place - (place @ up) * up + top * up, -up, top - float(middle @ up) + size, ref)
    return None if rest is None else start_at(body, rest, why)


def _reach(evidence: Evidence, ref: str) -> float:
    """How far an object reaches from its middle at most, where it has an end [m]."""
    shapes = [placed for placed in evidence.placed if placed.owner == ref and np.isfinite(placed.radius)]
    return max((placed.radius for placed in shapes), default=0.0)


def _middle(evidence: Evidence, ref: str) -> Floats | None:
    container = evidence.container(ref)
    if container is not None:
        return np.array(container.inner_center, dtype=np.float64)
    placed = [each for each in evidence.placed if each.owner == ref]
    if not placed or any(each.shape.kind == "plane" for each in placed):
        return None
    return np.asarray(np.mean([each.position[0] for each in placed], axis=0), dtype=np.float64)


def _gaps(evidence: Evidence, i: int, places: Floats, others: list[str]) -> Floats:
    """The least gap of a body to others, put to places (n, 3) as all else starts, (n,) [m]."""
    rows = list(range(len(evidence.world.bodies)))
    q = np.repeat(evidence.body_q[:1].astype(np.float64), len(places), axis=0)
    q[:, i, :3] = places
    there = posed(evidence.world, rows, np.arange(len(places), dtype=np.float64), q)
    prim = evidence.world.bodies[i].prim
    return np.asarray(np.min([distance(there, prim, other) for other in others], axis=0))


def _others(evidence: Evidence, i: int) -> list[str]:
    """What a body may not start in: all that collides, but what a joint holds to it."""
    prim = evidence.world.bodies[i].prim
    held = {end for joint in evidence.world.joints for end in (joint.parent, joint.child, joint.fixture)
            if prim in (joint.parent, joint.child)}  # fmt: skip
    return sorted({placed.owner for placed in evidence.placed} - held - {prim})


def _parted(evidence: Evidence, i: int) -> Floats | None:
    """The nearest place (3,) up, or level, at which a body starts in nothing; None if none is near.

    Along each way it goes on by as much as it is still in something: it cannot pass over the first free place.
    """
    solid, others = evidence.solid(i), _others(evidence, i)
    here = evidence.body_q[0, i, :3].astype(np.float64)
    size = max(solid.smallest, float(np.ptp([end[0] for end in evidence.ends(i)])))
    sides = sides_of(evidence.up)
    ways = np.concatenate([evidence.up[None], sides, -sides])
    gone, limit = np.zeros(len(ways)), 0.5 * TOUCHING * solid.smallest
    for _ in range(TRIED):
        depth = -_gaps(evidence, i, here + gone[:, None] * ways, others)
        if (depth <= limit).all():
            break
        gone = np.where(depth > limit, gone + depth, gone)
    free = (depth <= limit) & (gone <= FARTHEST * size)
    if not free.any():
        return None
    # Of ways about as long, up: what stands on something was most likely put too low.
    cost = np.where(free, gone * np.array([1.0, 1.1, 1.1, 1.1, 1.1]), np.inf)
    best = int(np.argmin(cost))
    return np.asarray(here + gone[best] * ways[best])


def _first_free(evidence: Evidence, i: int, start: Floats, way: Floats, most: float, ref: str) -> Floats | None:
    """The last place along a way down to an object before it is touched."""
    low, high = 0.0, most
    for _ in range(2):
        ways = np.linspace(low, high, TRIED)
        touched = np.flatnonzero(_gaps(evidence, i, start + ways[:, None] * way, [ref]) < 0.0)
        if not len(touched) or touched[0] == 0:
            return None
        low, high = float(ways[touched[0] - 1]), float(ways[touched[0]])
    return start + low * way
