"""All that stands still, as particles where the fluid gets to: laid there before it does."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence

import newton
import numpy as np
import warp as wp
from newton import GeoType, ShapeFlags
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples
from wsim.geometry.rotations import conjugate, rotate
from wsim.kernels.sph.reach import find_strays
from wsim.solvers.fixed_shapes import FixedShape, fixed_shape
from wsim.solvers.shapes import OpenBox, sample_container
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.tiles import Tiles, keys_of
from wsim.solvers.vessel_walls import VesselWalls

Array = np.ndarray
TILE = 8  # spacings that a tile is long
FEW = 3  # particles that lie together, which have no weight to speak of
CORNERS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


class _Standing:
    """What stands still in one world.

    Attributes:
        shapes: Those that are not a tank's or a vessel's walls, planes last.
        hollows: Of its tanks.
        home: Tiles whose shapes have their particles, as keys.
        laid: Those particles, and the walls of vessels and tanks.
    """

    def __init__(
        self, shapes: list[FixedShape], planes: list[FixedShape], hollows: list[OpenBox], walls: list[Samples]
    ) -> None:
        self.shapes, self.hollows = [*shapes, *planes], hollows
        self.finite = len(shapes)
        self.home: Array = np.zeros(0, dtype=np.int64)
        self.laid = walls


class FixedSolids:
    """The particles of fixed shapes, in the tiles of space that are home to the fluid, and of tanks' and vessels'
    walls.

    What is inside of a tank's hollow is home from the start, and with it all that stands there. So is where a free
    fluid is, and what is below it. Where it goes from there, `ahead` follows, tile by tile.

    Where shapes overlap, particles are of the first alone: of a vessel's walls, a tank's, then of the first shape, of
    planes last.

    Args:
        model: The `newton.Model`.
        config: For the spacing, the kernel's support, dimensions and periodic axes.
        containers: Tanks of all worlds.
        vessels: The walls of what else holds fluid in them; those of bodies are left to `sample_bodies`.

    Raises:
        ValueError: If a container is too narrow for the spacing.
    """

    def __init__(
        self, model: newton.Model, config: ConfigSPH, containers: Sequence[OpenBox], vessels: VesselWalls
    ) -> None:
        self._config, self._vessels = config, vessels
        self.world_count = max(1, model.world_count)
        flat = np.array([False, config.dimensions == 2, False])
        periodic = np.array([ends is not None for ends in config.periodic])
        self._tiles = Tiles(TILE * config.spacing, ~(flat | periodic))
        # A particle sees as far as the support, and a list as far as its skin beyond.
        self._guard = (1.0 + config.skin) * config.support
        self._worlds = [
            _Standing(*shapes, [box for box in containers if box.world in (-1, w)], vessels.of(w))
            for w, shapes in enumerate(_shapes_of(model, config, containers, vessels))
        ]
        for w, world in enumerate(self._worlds):
            tanks = [Samples(*sample_container(box, config)) for box in world.hollows]
            world.laid += [vessels.beside(samples, w) for samples in tanks]
            world.laid += [self._lay(w, *self._around(box), world.finite) for box in world.hollows]
        self._find = _Finder(model, self._worlds, self._tiles, self._guard)

    @property
    def anywhere(self) -> bool:
        """Whether anything but the walls of tanks stands still."""
        return self._find.wanted

    def start(self, fluid: Array, fluid_world: Array) -> None:
        """Lay the particles of what is around and below fluid that no tank holds, (n, 3) [m], of worlds (n,)."""
        for w, world in enumerate(self._worlds):
            here = fluid[fluid_world == w]
            here = here[
                ~np.logical_or.reduce([_within(box, here) for box in world.hollows] or [np.zeros(len(here), bool)])
            ]
            if not len(here) or not world.shapes:
                continue
            low, high = here.min(axis=0), here.max(axis=0)
            low[2] = min(low[2], *(shape.low[2] for shape in world.shapes))
            self._bring_home(w, self._tiles.around(self._tiles.spanning(low, high)))
        self._find.read_home()

    def ahead(self, state: newton.State, seconds: float) -> bool:
        """Lay what the fluid may get to within a time [s]; whether there was anything."""
        found = False
        for w, places in self._find.strays(state, seconds):
            found |= self._bring_home(w, self._tiles.around(self._tiles.of(places)))
        return found

    def particles(self) -> tuple[Array, Array, Array]:
        """Positions (n, 3) [m], volumes (n,) [m^3] and worlds (n,) of all particles so far, world by world."""
        laid = [(w, each) for w, world in enumerate(self._worlds) for each in world.laid]
        if not laid:
            return np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=np.int32)
        worlds = np.repeat([w for w, _ in laid], [len(each.volume) for _, each in laid]).astype(np.int32)
        return np.concatenate([each.position for _, each in laid]), np.concatenate([e.volume for _, e in laid]), worlds

    def _bring_home(self, w: int, tiles: Array) -> bool:
        """Lay what is in some tiles of a world, if they are not home yet; whether there was anything."""
        world = self._worlds[w]
        keys = keys_of(w, tiles)
        fresh = ~np.isin(keys, world.home)
        world.home = np.union1d(world.home, keys[fresh])
        self._find.stale = True
        before = len(world.laid)
        corners = [self._tiles.corners(tile) for tile in tiles[fresh]]
        world.laid += [each for low, high in corners if len((each := self._lay(w, low, high)).volume)]
        return len(world.laid) > before

    def _lay(self, w: int, low: Array, high: Array, count: int | None = None) -> Samples:
        """Particles of a world's shapes, of the first `count`, that are in a box from one corner to another."""
        world, found = self._worlds[w], []
        for k, shape in enumerate(world.shapes[:count]):
            if (low > shape.high).any() or (high < shape.low).any():
                continue
            samples = shape.near(low, high)
            at = samples.position
            keep = ((at >= low) & (at < high)).all(axis=1) & self._in_period(at)
            for box in world.hollows:
                keep &= ~self._in_walls(box, at)
                if count is None:  # what is in a hollow is home already; a plane's is none
                    first, last = self._around(box)
                    keep &= ~((at >= first) & (at < last)).all(axis=1)
            for other in world.shapes[:k]:
                if not ((low > other.high).any() or (high < other.low).any()) and keep.any():
                    keep[keep] = other.depth(at[keep]) <= 0.0
            found.append(Samples(at[keep], samples.volume[keep]))
        if not found:
            return Samples(np.zeros((0, 3)), np.zeros(0))
        laid = Samples(np.concatenate([f.position for f in found]), np.concatenate([f.volume for f in found]))
        return self._vessels.beside(laid, w)

    def _around(self, box: OpenBox) -> tuple[Array, Array]:
        """Corners of what is upright around a hollow, and of what water at its rim sees [m]."""
        corners = rotate(np.array(box.rotation), 0.5 * CORNERS * np.array(box.size)) + np.array(box.center)
        return corners.min(axis=0), corners.max(axis=0) + np.array([0.0, 0.0, self._guard])

    def _in_walls(self, box: OpenBox, points: Array) -> Array:
        """Which points are where the particles of a tank's walls are."""
        own = rotate(conjugate(np.array(box.rotation)), points - np.array(box.center))
        half = 0.5 * np.array(box.size)
        grown = half + self._config.support
        rim = grown[2] if box.closed else half[2]
        outer = (np.abs(own) <= grown).all(axis=1) & (own[:, 2] <= rim)
        return np.asarray(outer & ~(np.abs(own) < half).all(axis=1))

    def _in_period(self, position: Array) -> Array:
        """Which positions are in the periodic box; what a fixed shape has beyond it is its own image."""
        keep = np.ones(len(position), dtype=bool)
        for axis, ends in enumerate(self._config.periodic):
            if ends is not None:
                keep &= (position[:, axis] >= ends[0]) & (position[:, axis] < ends[1])
        return keep


class _Finder:
    """Finds the fluid that is about to leave home, on the model's device."""

    def __init__(self, model: newton.Model, worlds: list[_Standing], tiles: Tiles, guard: float) -> None:
        self._worlds, self._tiles, self._guard, self.stale = worlds, tiles, guard, True
        self._model = model
        self.wanted = any(world.shapes for world in worlds)
        first = np.cumsum([0, *(len(world.hollows) for world in worlds)])
        hollows = [box for world in worlds for box in world.hollows]
        poses = np.array([[*box.center, *box.rotation] for box in hollows]).reshape(-1, 7)
        halves = np.array([0.5 * np.array(box.size) for box in hollows]).reshape(-1, 3)
        with wp.ScopedDevice(model.device):
            self._hollows = (
                wp.array(first, dtype=int), wp.array(poses, dtype=wp.transform), wp.array(halves, dtype=wp.vec3),
            )  # fmt: skip
            self._stray = wp.zeros(model.particle_count if self.wanted else 0, dtype=wp.uint8)
            self._strays = wp.zeros(len(worlds), dtype=int)
            self._world = wp.array(np.maximum(model.particle_world.numpy(), 0), dtype=int)
        shapes = [shape for world in worlds for shape in world.shapes]
        self._low = np.min([shape.low for shape in shapes], axis=0) - guard if shapes else np.zeros(3)
        self._high = np.max([shape.high for shape in shapes], axis=0) + guard if shapes else np.zeros(3)

    def read_home(self) -> None:
        """Take the tiles that are home to the device."""
        home = np.sort(np.concatenate([world.home for world in self._worlds]))
        self._home = wp.array(home, dtype=wp.int64, device=self._model.device)
        self.stale = False

    def strays(self, state: newton.State, seconds: float) -> Iterator[tuple[int, Array]]:
        """Worlds, and in each the places (n, 3) [m] on the ways out of what is home."""
        if self.stale:
            self.read_home()
        self._strays.zero_()
        wp.launch(
            find_strays,
            dim=len(self._stray),
            inputs=[
                self._world, self._model.particle_flags, state.particle_q, state.particle_qd, self._model.gravity,
                seconds, wp.vec3(*self._tiles.inverse), self._guard, wp.vec3(*self._low), wp.vec3(*self._high),
                *self._hollows, self._home,
            ],
            outputs=[self._stray, self._strays],
            device=self._model.device,
        )  # fmt: skip
        if not self._strays.numpy().any():
            return
        stray = self._stray.numpy() != 0
        place, velocity = state.particle_q.numpy()[stray], state.particle_qd.numpy()[stray]
        world, gravity = self._world.numpy()[stray], self._model.gravity.numpy()
        for w in np.unique(world).tolist():
            own = np.flatnonzero(world == w)
            own = own[self._together(place[own])]
            if len(own):
                yield w, self._ways(place[own].astype(float), velocity[own].astype(float), gravity[w], seconds)

    def _together(self, place: Array) -> Array:
        """Which particles are more than a drop of a few, which faces hold as well."""
        near = cKDTree(place).query_ball_point(place, self._guard, return_length=True)
        return np.asarray(near > FEW)

    def _ways(self, place: Array, velocity: Array, gravity: Array, seconds: float) -> Array:
        """Places on the ways of particles, no farther from each other than a tile is long."""
        far = seconds * (np.linalg.norm(velocity, axis=1).max() + 0.5 * seconds * np.linalg.norm(gravity))
        times = np.linspace(0.0, seconds, 2 + int(far / self._tiles.edge))[:, None, None]
        way: Array = (place + times * velocity + 0.5 * times**2 * gravity).reshape(-1, 3)
        return np.unique(np.round(way / self._guard), axis=0) * self._guard


def _shapes_of(
    model: newton.Model, config: ConfigSPH, containers: Sequence[OpenBox], vessels: VesselWalls
) -> list[tuple[list[FixedShape], list[FixedShape]]]:
    """Of each world the shapes that stand still, which are no walls of what holds fluid, and the planes."""
    walls = frozenset().union(*(box.shapes for box in containers))
    kinds, poses, scales = model.shape_type.numpy(), model.shape_transform.numpy(), model.shape_scale.numpy()
    bodies, flags, worlds = model.shape_body.numpy(), model.shape_flags.numpy(), model.shape_world.numpy()
    found: list[tuple[list[FixedShape], list[FixedShape]]] = [([], []) for _ in range(max(1, model.world_count))]
    for k in range(model.shape_count):
        label = str(model.shape_label[k])
        if bodies[k] >= 0 or not flags[k] & ShapeFlags.COLLIDE_SHAPES or label in walls or vessels.made_of(label):
            continue
        kind = int(kinds[k])
        shape = fixed_shape(kind, poses[k].astype(float), scales[k].astype(float), model.shape_source[k], config)
        if shape is None:
            name = GeoType(kind).name
            warnings.warn(f"SolverSPH: the fluid does not see {label}, a {name}", stacklevel=4)
            continue
        for w in range(len(found)) if worlds[k] < 0 else [int(worlds[k])]:
            found[w][kind == GeoType.PLANE].append(shape)
    return found


def _within(box: OpenBox, points: Array) -> Array:
    """Which points are in a hollow."""
    own = rotate(conjugate(np.array(box.rotation)), points - np.array(box.center))
    return np.asarray((np.abs(own) <= 0.5 * np.array(box.size)).all(axis=1))
