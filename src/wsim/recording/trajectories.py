"""Many copies of a world through time, as arrays: what a sweep is judged by, without a file for each copy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.recording.frames import LogLine
from wsim.recording.recording import FluidTrack, Recording
from wsim.recording.solids import Solids

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import World

    Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Trajectories:
    """W copies of one world of B rigid bodies over T frames; rows follow `world.bodies`.

    Attributes:
        world: What the copies share.
        time: (T,) [s].
        body_q: (W, T, B, 7) [x y z qx qy qz qw], world frame.
        body_qd: (W, T, B, 6) [vx vy vz wx wy wz], of the centre of mass.
        contact_force: (W, T, B, 3) [N].
        penetration: (W, T) [m], the solver's deepest contact; None where it is not known.
        mass: (W, B) [kg], where the copies differ from `world`; None where they do not.
        scalars: (W, T) each: what else a recording keeps of a copy, by its name there.
        problems: (W,) lists of what went wrong in a copy, as its log would say it; empty: nothing in any.
        applied: What fluid and control gave to bodies and walls since the frame before, by a recording's field, each
            with the copies' axis first, as `applied_impulse` (W, T, B, 3) [N s]; empty where nothing did.
        fluids: (W,) the particles of each copy by the fluid's prim; empty without any.
        solids: (W,) the particles of what the fluids of each copy meet; empty where they are not known.
        metadata: As of a recording.
        own_metadata: (W,) what a copy has of its own beside it; empty where none has.
        worlds: (W,) what each copy's own stage states, where they differ in more than masses; empty where they do not.
    """

    world: World
    time: Array
    body_q: Array
    body_qd: Array
    contact_force: Array
    penetration: Array | None = None
    mass: Array | None = None
    scalars: dict[str, Array] = field(default_factory=dict)
    problems: list[list[str]] = field(default_factory=list)
    metadata: dict[str, Any] = field(default_factory=dict)
    worlds: Sequence[World] = ()
    applied: dict[str, Array] = field(default_factory=dict)
    fluids: Sequence[dict[str, FluidTrack]] = ()
    solids: Sequence[Solids] = ()
    own_metadata: Sequence[dict[str, Any]] = ()

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit one another.

        Raises:
            ValueError: Naming the array, its shape and the one that it must have.
        """
        worlds, frames, bodies = self.body_q.shape[:1] + self.time.shape + (len(self.world.bodies),)
        wanted = {
            "body_q": (worlds, frames, bodies, 7),
            "body_qd": (worlds, frames, bodies, 6),
            "contact_force": (worlds, frames, bodies, 3),
            "penetration": (worlds, frames),
            "mass": (worlds, bodies),
        }
        given = {name: getattr(self, name) for name in wanted} | self.scalars
        for name, array in given.items():
            shape = wanted.get(name, (worlds, frames))
            if array is not None and array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}; it must be {shape}")
        for name in ("problems", "worlds", "fluids", "solids", "own_metadata"):
            count = len(getattr(self, name))
            if count not in (0, worlds):
                raise ValueError(f"{name} has {count} entries; it must have one for each of {worlds} worlds")
        for name, array in self.applied.items():
            if array.shape[:2] != (worlds, frames):
                raise ValueError(f"{name} has shape {array.shape}; it must begin with {(worlds, frames)}")

    @property
    def world_count(self) -> int:
        """W."""
        return len(self.body_q)

    def part(self, first: int, last: int) -> Trajectories:
        """Worlds `first` to before `last`."""
        some = slice(first, last)
        return replace(
            self,
            body_q=self.body_q[some],
            body_qd=self.body_qd[some],
            contact_force=self.contact_force[some],
            penetration=None if self.penetration is None else self.penetration[some],
            mass=None if self.mass is None else self.mass[some],
            scalars={name: array[some] for name, array in self.scalars.items()},
            problems=self.problems[some],
            worlds=self.worlds[some],
            applied={name: array[some] for name, array in self.applied.items()},
            fluids=self.fluids[some],
            solids=self.solids[some],
            own_metadata=self.own_metadata[some],
        )

    def world_of(self, k: int) -> World:
        """World k as it was, or with its own masses; inertias go with them."""
        if self.worlds:
            return self.worlds[k]
        if self.mass is None:
            return self.world
        bodies = [
            body.model_copy(
                update={"mass": float(m), "inertia": tuple(m / body.mass * entry for entry in body.inertia)}
            )
            for body, m in zip(self.world.bodies, self.mass[k], strict=True)
        ]
        return self.world.model_copy(update={"bodies": bodies})

    def recording(self, k: int) -> Recording:
        """World k as a recording in memory."""
        kept = self.scalars | ({} if self.penetration is None else {"contact/penetration": self.penetration})
        scalars = {name: array[k].astype(np.float64) for name, array in kept.items()}
        end = float(self.time[-1]) if len(self.time) else 0.0
        problems = self.problems[k] if self.problems else []
        return Recording(
            path=Path(f"world-{k}"),
            world=self.world_of(k),
            metadata={
                "complete": not problems,
                **self.metadata,
                **(self.own_metadata[k] if self.own_metadata else {}),
            },
            time=np.asarray(self.time, dtype=np.float64),
            body_q=self.body_q[k],
            body_qd=self.body_qd[k],
            contact_force=self.contact_force[k],
            fluids=self.fluids[k] if self.fluids else {},
            solids=self.solids[k] if self.solids else None,
            scalars=scalars,
            log=[LogLine(end, "ERROR", problem) for problem in problems],
            images={},
            **{name: array[k] for name, array in self.applied.items()},
        )
