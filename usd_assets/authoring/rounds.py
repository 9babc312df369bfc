"""Open round vessels: what falls in comes to lie on their floor."""

from __future__ import annotations

import itertools

from .asset import Asset, Body
from .forms import inscribed
from .matter import Paint
from .parts import Profile, drum, lathe, staves


def vessel(
    asset: Asset,
    body: Body,
    paint: Paint,
    outside: Profile,
    inside: Profile,
    wall: float,
    *,
    mass: float | None = None,
    count: int = 14,
    named: bool = True,
) -> None:
    """A solid of revolution that is hollow from its floor up.

    Its profiles of (radius, z) [m] run up from the foot, and up from the floor to the rim; the inner one collides as
    flat staves of thickness `wall` [m], `count` around. It weighs as its substance or `mass` [kg]. `named` names top
    and inside, and the free room.
    """
    floor, height = inside[0][1], inside[-1][1]
    body.add(lathe([(0.0, outside[0][1]), *outside, *reversed(inside), (0.0, floor)], 40), paint, mass=mass)
    body.collide("floor", paint, drum(outside[0][0], outside[0][1], floor))
    for k, ((r0, z0), (r1, z1)) in enumerate(itertools.pairwise(inside)):
        body.collide(f"wall_{k}", paint, *staves((r0, r1), wall, z0, z1, count))
    if named:
        body.anchors |= {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, floor)}
        edge = inscribed(min(r for r, _ in inside))
        asset.hollow = ((edge, edge, height - floor), (0.0, 0.0, (height + floor) / 2))
