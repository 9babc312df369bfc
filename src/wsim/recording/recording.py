"""What a recording says, as arrays; `wsim.recording.read` makes one of a file."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from wsim.recording.contacts import ContactTrack
from wsim.recording.frames import FluidFrame, Frame, LogLine
from wsim.recording.sensors import SensorTrack
from wsim.recording.solids import Solids
from wsim.recording.ties import TieTrack
from wsim.scene.world import Camera, World

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Bools = NDArray[np.bool_]
    Floats = NDArray[np.float32]
    Times = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FluidTrack:
    """One fluid through time; its frames may be fewer than the recording's.

    Where a particle is not in the world, as taps and drains may have it, all three are NaN.
    """

    time: Times  # (T,) [s]
    position: Floats  # (T, N, 3) [m]
    velocity: Floats  # (T, N, 3) [m/s]
    density: Floats  # (T, N) [kg/m^3]
    present: Bools | None = None  # (T, N) which are in the world; None: all, always

    @property
    def count(self) -> NDArray[np.intp]:
        """Particles in the world at each frame, (T,)."""
        if self.present is None:
            return np.full(len(self.time), self.position.shape[1])
        count: NDArray[np.intp] = self.present.sum(axis=1)
        return count

    def there(self, k: int) -> slice | NDArray[np.intp]:
        """Which particles are in the world at frame k, as an index."""
        return slice(None) if self.present is None else np.flatnonzero(self.present[k])

    def percentile(self, of: NDArray[Any], share: float) -> Times:
        """What a share of the particles in the world keep to at each frame, of what each has, (T, N); 0 where none is.

        Not interpolated: it is one of them.
        """
        ranks = np.minimum(np.maximum(self.count - 1, 0), (share * self.count).astype(int))
        if self.present is None and len(ranks):
            found: Times = np.partition(of, ranks[0], axis=1)[:, ranks[0]]
            return found
        rows = (row[self.there(k)] for k, row in enumerate(of))
        return np.array([np.partition(row, r)[r] if len(row) else 0.0 for row, r in zip(rows, ranks, strict=True)])

    def mean(self, of: NDArray[Any]) -> Times:
        """The mean over the particles in the world at each frame of what each has, (T, N, ...); 0 where none is."""
        if self.present is None:
            mean: Times = of.astype(np.float64).mean(axis=1)
            return mean
        own = self.present.reshape(*self.present.shape, *(1,) * (of.ndim - 2))
        total = np.where(own, of, 0.0).sum(axis=1, dtype=np.float64)
        share: Times = total / np.maximum(self.count, 1).reshape(-1, *(1,) * (of.ndim - 2))
        return share


def with_company(points: NDArray[Any], present: Bools | None) -> NDArray[Any]:
    """A fluid's points (F, n, 3) [m]; one that is not in the world stands in the middle of those that are then.

    Before the first is there it is in the middle of those at the time when they are.
    """
    if present is None or present.all() or not present.any():
        return points if present is None or present.any() else points[:, :0]
    own = present[..., None]
    count = own.sum(axis=1)
    middle = np.where(own, points, 0.0).sum(axis=1) / np.maximum(count, 1)
    some = np.flatnonzero(count[:, 0])
    nearest = some[np.abs(some[None] - np.arange(len(points))[:, None]).argmin(axis=1)]
    return np.where(own, points, middle[nearest][:, None]).astype(points.dtype)


@dataclass(frozen=True, eq=False)
class ImageTrack(Sequence["NDArray[np.uint8]"]):
    """One camera's pictures through time, decoded when they are asked for."""

    time: Times  # (T,) [s]
    jpegs: list[Any]  # Arrow scalars of bytes

    def __len__(self) -> int:
        return len(self.jpegs)

    def __getitem__(self, index: Any) -> Any:
        """The picture (H, W, 3) uint8 RGB at an index; a list of them for a slice."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        with Image.open(io.BytesIO(self.jpeg(index))) as picture:
            return np.array(picture.convert("RGB"))

    def __iter__(self) -> Iterator[NDArray[np.uint8]]:
        return (self[i] for i in range(len(self)))

    def jpeg(self, index: int) -> bytes:
        """The picture's file as it was stored."""
        return bytes(self.jpegs[index])

    def at(self, t: float) -> NDArray[np.uint8]:
        """The picture nearest to time `t` [s], (H, W, 3) uint8 RGB."""
        image: NDArray[np.uint8] = self[_nearest(self.time, t)]
        return image


@dataclass(frozen=True, eq=False)
class SeenTrack:
    """How much of a camera's picture each object takes up, through time."""

    time: Times  # (T,) [s]
    objects: list[str]  # prims
    share: Floats  # (T, objects)


@dataclass(frozen=True, eq=False)
class Recording:
    """What happened in a world. T frames, B bodies in the order of `world.bodies`."""

    path: Path
    world: World
    metadata: dict[str, Any]
    time: Times  # (T,) [s], as it was given to the writer
    body_q: Floats  # (T, B, 7) [x y z qx qy qz qw], world
    body_qd: Floats  # (T, B, 6) [vx vy vz wx wy wz]
    contact_force: Floats  # (T, B, 3) [N]
    fluids: dict[str, FluidTrack]  # by prim
    scalars: dict[str, Times]  # by name, (T,); NaN where a frame had none
    log: list[LogLine]  # in order of time, then of writing
    images: Mapping[str, ImageTrack]  # by camera prim
    views: list[Camera] = field(default_factory=list)  # that pictures are taken with: the world's, or one of its own
    seen: Mapping[str, SeenTrack] = field(default_factory=dict)  # by camera prim; empty where nothing was drawn
    applied_impulse: Floats | None = None  # (T, B, 3) [N s], of fluid and control since the frame before
    applied_work: Floats | None = None  # (T, B) [J], likewise
    applied_turn: Floats | None = None  # (T, B, 3) [N m s], likewise, about the centre of mass
    control_impulse: Floats | None = None  # (T, B, 3) [N s], what of the applied one is control's
    scheduled: Floats | None = None  # (T, B, 6) [N s, N m s], what of the applied ones is schedules'
    wall_impulse: Floats | None = None  # (T, 3) [N s], of fluid on all that stands still since the frame before
    lead: Floats | None = None  # (T, B, 6) [N s, N m s], momentum and angular momentum beside all impulses, likewise
    contacts: ContactTrack | None = None  # what pairs of shapes gave each other since the frame before
    solids: Solids | None = None  # particles that stand for what fluids meet; None in recordings of before
    ties: TieTrack | None = None  # what joints, springs and ropes gave, likewise; None in recordings of before
    sensors: Mapping[str, SensorTrack] = field(default_factory=dict)  # by prim

    @property
    def complete(self) -> bool:
        """Whether the run got to its end; if not, `metadata["error"]` may say why."""
        return bool(self.metadata.get("complete", False))

    def body_index(self, prim: str) -> int:
        """The row of a body; KeyError naming the known ones."""
        for i, body in enumerate(self.world.bodies):
            if body.prim == prim:
                return i
        raise KeyError(f"no body {prim!r}; the recording has {[b.prim for b in self.world.bodies]}")

    def position(self, prim: str) -> Floats:
        """A body's positions (T, 3) [m]."""
        return self.body_q[:, self.body_index(prim), :3]

    def rotation(self, prim: str) -> Floats:
        """A body's rotations (T, 4), xyzw."""
        return self.body_q[:, self.body_index(prim), 3:]

    def velocity(self, prim: str) -> Floats:
        """Velocities (T, 3) of a body's centre of mass [m/s]."""
        return self.body_qd[:, self.body_index(prim), :3]

    def angular_velocity(self, prim: str) -> Floats:
        """A body's angular velocities (T, 3) [rad/s]."""
        return self.body_qd[:, self.body_index(prim), 3:]

    def force(self, prim: str) -> Floats:
        """Net contact forces (T, 3) on a body [N]."""
        return self.contact_force[:, self.body_index(prim)]

    def frame_index(self, t: float) -> int:
        """The index of the frame nearest to time `t` [s]; ValueError when there is no frame."""
        return _nearest(self.time, t)

    def frame_at(self, t: float) -> Frame:
        """The frame nearest to time `t` [s]; fluids that have no particles recorded then are left out."""
        i = self.frame_index(t)
        fluids = {}
        for prim, track in self.fluids.items():
            for j in np.flatnonzero(track.time == self.time[i]):
                present = None if track.present is None else track.present[j]
                fluids[prim] = FluidFrame(track.position[j], track.velocity[j], track.density[j], present)
        scalars = {name: float(values[i]) for name, values in self.scalars.items()}
        return Frame(self.body_q[i], self.body_qd[i], self.contact_force[i], fluids, scalars)


def _nearest(times: Times, t: float) -> int:
    if not len(times):
        raise ValueError("the recording has no frames")
    return int(np.argmin(np.abs(times - t)))
