"""What collides in a mesh's place: a plain shape, its hull, or convex parts, as many as keep its hollows open."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from wsim.assets import Collision, Room
from wsim.intake.fit import few_corners, fit
from wsim.intake.measure import Fit, Seen
from wsim.intake.model import Array, Collider, Faces, IntakeError, Mesh
from wsim.intake.parts import MOST_PARTS, SECONDS, decompose, has_volume
from wsim.intake.repair import Solid
from wsim.intake.sheet import THICKNESS, thickened
from wsim.intake.shells import is_closed, shells
from wsim.progress import Progress, silent

THRESHOLD = 0.01  # [m]
_OF_SIZE = 0.05  # of its longest edge: a threshold above this would lose what is small
OPEN = 0.9  # share of a hollow that must stay open
TRIES = 4  # each at half the threshold of the one before


@dataclass(frozen=True)
class Collided:
    """Colliders, how they came about, and how well they stand for what is seen."""

    colliders: list[Collider]
    collision: Collision
    seen: Seen
    fit: Fit


def collide(solid: Solid, threshold: float | None, notes: list[str], progress: Progress = silent) -> Collided:
    """What collides in a solid's place.

    Args:
        solid: Mended.
        threshold: CoACD's for the first try [m]; by default 0.01, or 5 % of what is smaller than 0.2 m.
        notes: Told of what was closed, and of what was tried.
        progress: Told of the tries.

    Raises:
        IntakeError: If no part could be made.
    """
    seen = Seen.of(solid)
    plain, rest = _apart(solid)
    if not rest:
        return _told(seen, plain, "shapes" if len(plain) > 1 else plain[0].kind, None)
    longest = float(np.ptp(solid.points, axis=0).max())
    first = threshold if threshold is not None else min(THRESHOLD, _OF_SIZE * longest)
    best: Collided | None = None
    why, ends = "", time.monotonic() + SECONDS
    for k in range(TRIES):
        progress("convex parts", k, TRIES)
        found = _parts(rest, first / 2**k, ends)
        if isinstance(found, str):
            why = found
            break
        made = _told(seen, plain + found, "coacd", first / 2**k)
        if best is None or made.fit.open > best.fit.open:
            best = made
        if made.fit.open >= OPEN or len(found) >= MOST_PARTS:
            break
    progress("convex parts", TRIES, TRIES)
    if best is None:
        return _hull_alone(seen, why, notes)
    _tell(best, first, why, notes)
    return best


def _apart(solid: Solid) -> tuple[list[Collider], list[Mesh]]:
    """The shells that are convex, each as one collider, and the meshes that must be taken apart.

    What is open goes as a sheet: CoACD alone looks for an inside that it does not have until its time is over.
    """
    whole = solid.mesh()
    if not solid.closed:
        return [], [thickened(whole, THICKNESS * float(np.ptp(solid.points, axis=0).max()))]
    found = shells(solid.faces)
    meshes = [Mesh("", *_used(solid.points, solid.faces[shell])) for shell in found]
    # A shell that winds inwards is a room inside another, and a shell that is open goes with what it touches.
    if len(found) > MOST_PARTS or not all(is_closed(mesh.faces) and mesh.volume > 0.0 for mesh in meshes):
        return [], [whole]
    plain, rest = [], []
    for mesh in meshes:
        shape = fit(mesh)
        if shape is None:
            rest.append(mesh)
        else:
            plain.append(shape)
    return plain, rest


def _used(points: Array, faces: Faces) -> tuple[Array, Faces]:
    used, index = np.unique(faces, return_inverse=True)
    return points[used], index.reshape(-1, 3)


def _parts(meshes: list[Mesh], threshold: float, ends: float) -> list[Collider] | str:
    """Parts of each mesh, if need be of one that CoACD made a manifold of first; or why there are none."""
    colliders = []
    for mesh in meshes:
        found = decompose(mesh, threshold, seconds=max(1.0, ends - time.monotonic()))
        if isinstance(found, str) and time.monotonic() < ends:
            again = decompose(mesh, threshold, preprocess="on", seconds=max(1.0, ends - time.monotonic()))
            found = found if isinstance(again, str) else again
        if isinstance(found, str):
            return found
        # A mesh that CoACD made a manifold of is a little larger than the mesh.
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        parts = [np.clip(points, low, high) for points in found]
        colliders += [Collider("hull", points=few_corners(part)) for part in parts if has_volume(part)]
    return colliders


def _hull_alone(seen: Seen, why: str, notes: list[str]) -> Collided:
    try:
        hull = Collider("hull", points=few_corners(seen.solid.points))
    except Exception:  # noqa: BLE001 - Qhull has one error for all that is flat
        raise IntakeError(f"collision: {why}, and it has no hull; give it thickness, or export it again") from None
    made = _told(seen, [hull], "hull", None)
    notes.append(f"{why}: it collides as its convex hull, and every hollow of it is closed; simplify it and try again")
    return made


def _told(seen: Seen, colliders: list[Collider], method: str, threshold: float | None) -> Collided:
    fitted = seen.measure(colliders)
    collision = Collision(
        method=method,  # type: ignore[arg-type]
        parts=len(colliders),
        threshold=threshold,
        volume_ratio=None if fitted.volume_ratio is None else round(fitted.volume_ratio, 4),
        hausdorff=round(fitted.hausdorff, 6),
        hollow_open=tuple(
            Room(
                center=tuple(round(float(v), 4) for v in hollow.center),  # type: ignore[arg-type]
                volume=float(f"{hollow.volume:.4g}"),
                open=round(min(1.0, max(0.0, hollow.open)), 3),
            )
            for hollow in fitted.hollows
        ),
    )
    return Collided(colliders, collision, seen, fitted)


def _tell(made: Collided, first: float, why: str, notes: list[str]) -> None:
    """Say what more parts were tried for, and what stays closed."""
    used = made.collision.threshold or first
    if used < first:
        notes.append(
            f"parts at a threshold of {first:.3g} m closed a hollow; {made.collision.parts} at {used:.3g} m keep "
            f"{100 * made.fit.open:.0f} % of each open"
        )
    if made.fit.open < OPEN:
        notes.append(
            f"what collides leaves {100 * made.fit.open:.0f} % of its least open hollow open; "
            + (f"finer ones: {why}" if why else "a smaller --threshold opens more")
        )
    if not made.seen.solid.closed:
        thickness = THICKNESS * float(np.ptp(made.seen.solid.points, axis=0).max())
        notes.append(
            f"what collides is a sheet of {1e3 * thickness:.3g} mm, and could not be measured against its inside: "
            "it has none"
        )
