"""USD stage → Newton model of one or many worlds."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import newton
import numpy as np

from wsim.errors import UserError
from wsim.forks import shared_out, uncollected
from wsim.progress import Progress, silent
from wsim.scene.skeleton import skeleton
from wsim.scene.usd_threads import forks
from wsim.scene.world import World
from wsim.sim.alike import check_alike, topology
from wsim.sim.articulations import complete_articulations, importable
from wsim.sim.constraints import add_constraints
from wsim.sim.contacts import harden_contacts, let_roll, rows_of_rolling, spare_kinematic, spare_tied
from wsim.sim.cord_shapes import add_cord_shapes
from wsim.sim.cords import add_cords
from wsim.sim.drives import add_drives
from wsim.sim.fluids import (
    Seeded,
    add_seeded,
    containers_of,
    largest_step,
    mesh_depths,
    of_worlds,
    seed,
    several_liquids,
    sph_config,
)
from wsim.sim.forward import forward_only
from wsim.sim.numbers import add_worlds, differences, texts
from wsim.sim.openings import drains_of, taps_of
from wsim.sim.pieces import with_pieces
from wsim.sim.placed import aim_drives, place_joints
from wsim.sim.stated import confirmed, numbers_of, replicate, state_numbers, unstated
from wsim.sim.surfaces import take_cylinders, take_surfaces
from wsim.sim.time_step import TimeStep, choose_time_step
from wsim.sim.vessels import vessels_of
from wsim.solvers.breaking import Breakable
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH
from wsim.solvers.sph_mouths import Drain, Tap
from wsim.solvers.surface_contacts import SurfaceParts
from wsim.solvers.vessels import Vessel

forward_only()

LEAST_MOMENT = 1e-15  # [kg m^2]: MuJoCo takes nothing below


@dataclass(frozen=True)
class Built:
    """A Newton model, with what the solvers need to know of the stage.

    `worlds` is what the stage of all worlds alike, or that of each, states. `bodies[k]` is the index of
    `world.bodies[k]` in the first world of the model; `fluids[w][prim]` the range of its particles in world w;
    `breakable` the joints that may break, of all worlds alike or of each. `singly` says why each stage of a batch was
    read by itself; "" where the numbers of descriptions did.
    """

    model: Any
    worlds: tuple[World, ...]
    bodies: np.ndarray
    fluids: tuple[dict[str, slice], ...]
    sph: Any  # SolverSPH.Config, or None without a fluid
    containers: tuple[OpenBox, ...]
    taps: tuple[Tap, ...]
    drains: tuple[Drain, ...]
    vessels: tuple[Vessel, ...]
    time_step: TimeStep
    breakable: list[list[Breakable]]
    surfaces: SurfaceParts | None = None  # what collides by its triangles
    cylinders: tuple[tuple[int, int], ...] = ()  # pairs of shapes that MuJoCo does not see touch, a cylinder first
    singly: str = ""

    @property
    def world(self) -> World:
        """What the stage of the first world states."""
        return self.worlds[0]

    def world_of(self, w: int) -> World:
        """What the stage of world w states."""
        return self.worlds[w % len(self.worlds)]


@dataclass(frozen=True)
class _One:
    """A builder of one world, or its `differences` from that of the batch's first; and what else there is of it."""

    builder: Any
    world: World
    fluids: dict[str, slice]
    breakable: list[Breakable]
    surfaces: SurfaceParts | None
    cylinders: tuple[tuple[int, int], ...]
    stated: bool  # its bodies' masses and velocities are the description's


def build_model(stage: Path, world: World, device: Any, world_count: int = 1, time_step: float | None = None) -> Built:
    """Import a checked stage into Newton, and fill in the fluid's particles.

    Args:
        stage: USD file.
        world: What `wsim.scene.describe` read from it.
        device: Warp device, or its name.
        world_count: Copies of the world, at the same place; worlds do not touch.
        time_step: Upper bound for the time step [s]; by default the stage's, or chosen.

    Raises:
        UserError: If the stage holds what the solvers cannot simulate.
    """
    config = sph_config([world])
    one = _import(stage, world, config, several_liquids([world]))
    step = _time_step([one.world], config, time_step)
    builder = one.builder
    if world_count == 1:
        add_cord_shapes(builder, one.world)
    else:
        builder = _builder(world)
        builder.replicate(one.builder, world_count)
    return _finalized(builder, [one], config, step, device)


def build_batch(
    stages: Sequence[Path],
    worlds: Sequence[World],
    device: Any,
    time_step: float | None = None,
    processes: int = 1,
    skeletons: Sequence[str] = (),
    progress: Progress = silent,
) -> Built:
    """Import checked stages of one topology (`wsim.sim.alike`) into one Newton model, a world each.

    Fluids share the largest speed of sound that one of them needs.

    Args:
        stages: USD files, two or more.
        worlds: What `wsim.scene.describe` read from them.
        device: Warp device, or its name.
        time_step: Upper bound for the time step of all worlds [s]; by default the shortest that one of them needs.
        processes: That stages are read in, side by side (`wsim.scene.usd_threads`).
        skeletons: Of the stages (`wsim.scene.skeleton`), where they are known.
        progress: Told that each stage has to be read by itself, and why, which takes thirty times as long.

    Raises:
        UserError: If a stage holds what the solvers cannot simulate.
        ValueError: If worlds differ in more than numbers.
    """
    config = sph_config(worlds)
    builder, singly, several = _builder(worlds[0]), "", several_liquids(worlds)
    numbers: dict[str, np.ndarray] = {}
    with uncollected():
        try:
            ones = _stated(builder, stages, worlds, skeletons)
        except _UnstatedError as error:
            singly = str(error)
            told = f"reading {len(stages)} stages one by one, as {singly}"
            progress(told, 0, 1)
            ones = list(_imports(stages, worlds, config, processes, several))
            add_worlds(builder, ones[0].builder, [one.builder for one in ones[1:]])
            progress(told, 1, 1)
        else:
            if config:
                filled = add_seeded(builder, worlds, config)
                ones = [replace(one, fluids=own) for one, own in zip(ones, filled.ranges, strict=True)]
                numbers = filled.numbers
                SolverSPH.register_custom_attributes(builder, several)
        if config:
            for name, own in of_worlds(worlds).items():
                builder.custom_attributes[f"sph:{name}"].values = dict(enumerate(own))
        built = _finalized(builder, ones, config, _time_step(worlds, config, time_step), device)
    for name, each in numbers.items():
        getattr(built.model.sph, name).assign(each)
    return replace(built, singly=singly)


class _UnstatedError(ValueError):
    """Descriptions do not state all that worlds differ in; says what."""


def _stated(builder: Any, stages: Sequence[Path], worlds: Sequence[World], skeletons: Sequence[str]) -> list[_One]:
    """Fill a builder with worlds, but for their fluids, by what their descriptions state (`wsim.sim.stated`).

    The first is imported; one in the middle and the last are, too, and are held against what was stated.

    Raises:
        _UnstatedError: With nothing done, where that is not all that there is to know.
    """
    if why := unstated(worlds[0]):
        raise _UnstatedError(why)
    texts_of = set(skeletons or map(skeleton, stages))
    if "" in texts_of:
        raise _UnstatedError("stages refer to other files")
    if len(texts_of) > 1:
        raise _UnstatedError("stages differ in what no description states")
    _weigh_spins(worlds)
    first = _import(stages[0], worlds[0], None)
    if not first.stated:
        raise _UnstatedError("Newton weighs a body otherwise than its description")
    told = numbers_of(first.builder, worlds) if first.surfaces is None else None
    if told is None:
        raise _UnstatedError("Newton's importer has made what no description states, or jointed bodies start elsewhere")
    rows, known = rows_of_rolling(first.builder, worlds[0]), texts(first.builder)
    if any(rows_of_rolling(first.builder, world) != rows for world in worlds[1:]):
        raise _UnstatedError("rolling is resisted in some worlds alone")
    for k in {len(worlds) // 2, len(worlds) - 1}:
        one = _import(stages[k], worlds[k], None)
        if not one.stated or one.cylinders != first.cylinders or not confirmed(one.builder, known, told, k):
            raise _UnstatedError(f"{stages[k].name}, read by itself, has other numbers than its description")
    replicate(builder, first.builder, told)
    return [replace(first, builder=None, world=world) for world in worlds]


def _import(stage: Path, world: World, config: Any | None, several: bool = False) -> _One:
    _weigh_spins([world])
    single = _builder(world)
    newton.solvers.SolverMuJoCo.register_custom_attributes(single)
    SolverSPH.register_custom_attributes(single, several)
    ignore = [f"{fluid.prim}/volume" for fluid in world.fluids]
    single.add_usd(importable(stage, world), ignore_paths=ignore, apply_up_axis_from_stage=True)
    complete_articulations(single)
    place_joints(single, world)
    aim_drives(single, world)
    stated = state_numbers(single, world)
    breakable = add_constraints(single, world)
    fluids = _add_fluids(single, world, config, several) if config else {}
    harden_contacts(single, ContactConfig())
    let_roll(single, world)
    spare_kinematic(single)
    spare_tied(single, world)
    surfaces = take_surfaces(single, world)
    world = with_pieces(single, world)
    add_cords(single, world, ContactConfig())
    add_drives(single, world)
    return _One(single, world, fluids, breakable, surfaces, take_cylinders(single), stated)


def _imports(
    stages: Sequence[Path], worlds: Sequence[World], config: Any | None, processes: int, several: bool
) -> Iterator[_One]:
    """Each world by itself; of all but the first, forks read the numbers (`wsim.sim.numbers`).

    Meshes are read here: Newton may work on them on a device, which a fork does not have.

    Raises:
        ValueError: If worlds differ in more than numbers.
    """
    same, rest = topology(worlds[0]), range(1, len(stages))
    solids = [*(body.shapes for body in worlds[0].bodies), *(static.shapes for static in worlds[0].statics)]
    meshes = any(shape.kind == "mesh" for shapes in solids for shape in shapes)
    first = _import(stages[0], worlds[0], config, several)
    yield first
    known = {} if meshes else texts(first.builder)

    def whole(k: int) -> _One:
        if topology(worlds[k]) != same:
            check_alike([stages[0], stages[k]], [worlds[0], worlds[k]])
        return _import(stages[k], worlds[k], config, several)

    def numbers(k: int) -> dict[str, Any] | None:
        with contextlib.suppress(Exception):  # what cannot be read there is read here, which says why
            one = whole(k)
            told = differences(one.builder, first.builder, known)
            return {"builder": told, "fluids": one.fluids, "breakable": one.breakable}
        return None

    if meshes:
        yield from map(whole, rest)
        return
    for k, found in zip(rest, shared_out(numbers, rest, forks(processes)), strict=True):
        yield replace(first, world=worlds[k], **found) if found else whole(k)


def _time_step(worlds: Sequence[World], config: Any | None, given: float | None) -> TimeStep:
    """The shortest of those that the worlds need."""
    own = (
        choose_time_step(
            world, largest_step(world, config) if config else None, world.time_step or None if given is None else given
        )
        for world in worlds
    )
    return min(own, key=_length)


def _length(step: TimeStep) -> float:
    return step.dt


def _finalized(builder: Any, ones: Sequence[_One], config: Any | None, step: TimeStep, device: Any) -> Built:
    model, first = builder.finalize(device=device), ones[0]
    return Built(
        model=model,
        worlds=tuple(one.world for one in ones),
        bodies=_body_indices(model, first.world),
        fluids=_ranges(ones, max(1, model.world_count)),
        sph=config,
        containers=tuple(_of_each(ones, containers_of)),
        taps=tuple(_of_each(ones, taps_of)),
        drains=tuple(_of_each(ones, drains_of)),
        vessels=tuple(_of_each(ones, vessels_of)),
        time_step=step,
        breakable=[one.breakable for one in ones],
        surfaces=first.surfaces,
        cylinders=first.cylinders,
    )


def _builder(world: World) -> Any:
    """A builder that takes small bodies as they are: Newton would add 1e-6 kg m^2 to moments below 1e-10.

    A box of 5 mm has 1e-10 kg m^2.
    """
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=world.gravity)
    builder.inertia_absolute_tolerance = LEAST_MOMENT
    builder.inertia_correction = 0.0
    return builder


def _weigh_spins(worlds: Sequence[World]) -> None:
    """Refuse what is too light to turn."""
    bodies = [body for world in worlds for body in world.bodies if not body.kinematic]
    moments = np.array([body.inertia for body in bodies], dtype=np.float64).reshape(-1, 3, 3)
    least = np.linalg.eigvalsh(moments)[:, 0]
    for k in np.flatnonzero(least < LEAST_MOMENT)[:1]:
        raise UserError(
            f"{bodies[k].prim}: its smallest moment of inertia is {least[k]:.2g} kg m^2; make it larger or heavier, to "
            f"{LEAST_MOMENT:.0e} kg m^2 or more: a grain of sand of half a millimetre"
        )


def _ranges(ones: Sequence[_One], count: int) -> tuple[dict[str, slice], ...]:
    """Where the particles of each fluid are in the model, of each of `count` worlds, which follow one another."""
    found, first = [], 0
    for k in range(count):
        own = ones[k % len(ones)].fluids
        found.append({prim: slice(first + part.start, first + part.stop) for prim, part in own.items()})
        first += max((part.stop for part in own.values()), default=0)
    return tuple(found)


def _of_each(ones: Sequence[_One], found: Callable[[World, int], list[Any]]) -> list[Any]:
    """What is found in all worlds alike, or in each."""
    if len(ones) == 1:
        return found(ones[0].world, -1)
    return [each for k, one in enumerate(ones) for each in found(one.world, k)]


def _add_fluids(builder: Any, world: World, config: Any, several: bool) -> dict[str, slice]:
    slices, meshes = {}, mesh_depths(builder, world)
    for fluid in world.fluids:
        seeded: Seeded = seed(fluid, world, config, meshes)
        first, count = builder.particle_count, len(seeded.position)
        own = {f"sph:{name}": [number] * count for name, number in seeded.liquid.items()} if several else {}
        builder.add_particles(
            pos=seeded.position.tolist(),
            vel=seeded.velocity.tolist(),
            mass=seeded.mass.tolist(),
            radius=[0.5 * fluid.spacing] * count,
            flags=seeded.flags.tolist(),
            custom_attributes={"sph:pressure": seeded.pressure.tolist()} | own,
        )
        slices[fluid.prim] = slice(first, first + count)
    return slices


def _body_indices(model: Any, world: World) -> np.ndarray:
    """Where each body of the description is in the model; both take their names from the prim paths."""
    index: dict[str, int] = {}
    for k, label in enumerate(model.body_label):
        index.setdefault(str(label), k)
    missing = [body.prim for body in world.bodies if body.prim not in index]
    if missing:
        raise UserError(f"the stage's rigid bodies {missing} did not reach the simulator, which knows {sorted(index)}")
    return np.array([index[body.prim] for body in world.bodies], dtype=np.int64)
