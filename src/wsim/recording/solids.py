"""Particles that stand for what a fluid meets: they stay where they are, on walls or in a body, so they come once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.recording import columns as names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.recording.table import Table
    from wsim.scene.world import World

    Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class SolidParticles:
    """Of one body, in its frame, or of all that stands still, in the world's."""

    position: Floats  # (N, 3) [m]
    volume: Floats  # (N,) [m^3]

    def __post_init__(self) -> None:
        """Refuse what is no row of places and volumes.

        Raises:
            ValueError: Naming the shapes.
        """
        if self.position.shape != (len(self.volume), 3) or self.volume.ndim != 1:
            raise ValueError(
                f"solid particles have shapes {self.position.shape} and {self.volume.shape}; (n, 3) and (n,)"
            )


@dataclass(frozen=True, eq=False)
class Solids:
    """All that a world's fluids meet."""

    walls: SolidParticles
    bodies: Mapping[str, SolidParticles] = field(default_factory=dict)  # by prim, of those that have any


def send_solids(stream: Any, solids: Solids) -> None:
    """Write them, once for all times."""
    for entity, particles in _entities(solids):
        values = np.c_[particles.position, particles.volume].astype(np.float32)
        column = names.column(names.SOLID_PARTICLES, values, lengths=[len(values)])
        stream.send_columns(entity, [], [column], strict=True)


def read_solids(table: Table, world: World) -> Solids | None:
    """What a recording has of them; None in those of before, and without fluid."""
    walls = _read(table, names.WALL_ENTITY)
    if walls is None:
        return None
    found = {body.prim: _read(table, names.entity_path(body.prim)) for body in world.bodies}
    return Solids(walls, {prim: particles for prim, particles in found.items() if particles is not None})


def _entities(solids: Solids) -> Iterator[tuple[str, SolidParticles]]:
    yield names.WALL_ENTITY, solids.walls
    for prim, particles in solids.bodies.items():
        yield names.entity_path(prim), particles


def _read(table: Table, entity: str) -> SolidParticles | None:
    _, cells = table.cells(entity, names.SOLID_PARTICLES)
    if not cells:
        return None
    values = cells[-1].flatten().to_numpy(zero_copy_only=False).reshape(-1, 4)
    return SolidParticles(values[:, :3], values[:, 3])
