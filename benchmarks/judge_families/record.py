"""Stages → recordings: simulated rightly or wrongly, kept by content, and put before the judge as evidence."""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
import re
import tempfile
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.judge_families.stepping import MeanSteps, Push, Stepper
from wsim.geometry.rotations import conjugate, rotate
from wsim.importers.trajectory import from_arrays
from wsim.recording.contacts import ContactTrack
from wsim.recording.frames import FluidFrame, Frame
from wsim.recording.recording import FluidTrack, Recording
from wsim.recording.ties import TieTrack
from wsim.scene.cord_paths import spring_track
from wsim.scene.describe import describe
from wsim.scene.world import World

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / "build" / "judge_faults" / "families"
FORMAT = 6  # of what is kept: raise it where the simulator records more
Array = np.ndarray


@dataclass(frozen=True)
class Track:
    """What a simulation did: frames' arrays by name, scalars, particles, and what it says of itself."""

    time: Array
    frames: dict[str, Array]
    scalars: dict[str, Array]
    fluids: dict[str, FluidTrack]
    facts: dict[str, Any]

    @property
    def q(self) -> Array:
        """Poses (T, B, 7)."""
        return self.frames["body_q"]

    @property
    def qd(self) -> Array:
        """Velocities (T, B, 6)."""
        return self.frames["body_qd"]


@lru_cache(256)
def world_of(stage: str) -> World:
    """What a stage states."""
    source = _written(stage)
    try:
        return describe(source)
    finally:
        source.unlink()


def simulated(stage: str, push: Push | MeanSteps | None = None) -> Track:
    """Simulate a stage with wsim on the CPU, pushed by nothing that the stage has, or in wrong steps; it is kept.

    Raises:
        RuntimeError: If the run broke.
    """
    path = _kept("tracks", f"{_text(stage)}{push!r}", ".npz")
    if not path.exists():
        source = _written(stage)
        _save(path, _simulate(source, push))
        source.unlink()
    return _load(path)


def _simulate(stage: Path, push: Push | MeanSteps | None) -> Track:
    from wsim.sim import Simulation
    from wsim.sim.measure import measure

    # Read here, so that it is not checked: a fault is planted whether or not the check would let it through.
    simulation = Simulation(stage, device="cpu", worlds=[describe(stage)])
    if simulation.rigid:
        simulation.rigid.keep_contacts()
    if isinstance(push, MeanSteps):
        push.spoil(simulation)
        push = None
    advance = Stepper(simulation, push).frame
    frames: list[Frame] = []
    times: list[float] = []
    for k in range(round(simulation.world.duration * simulation.world.frame_rate) + 1):
        if k:
            advance()
        times.append(simulation.time)
        frames.append(measure(simulation.built, simulation.state, simulation.rigid, simulation.fluid))
    if problems := simulation.problems():
        raise RuntimeError("; ".join(problems))
    names = [f.name for f in fields(Frame) if f.name not in ("fluids", "scalars", "contacts", "ties")]
    arrays = {name: np.array([getattr(frame, name) for frame in frames]) for name in names
              if getattr(frames[-1], name) is not None}  # fmt: skip
    if frames[-1].ties is not None:
        arrays["tie_joints"] = np.array([frame.ties.joints for frame in frames])  # type: ignore[union-attr]
        arrays["tie_cords"] = np.array([frame.ties.cords for frame in frames])  # type: ignore[union-attr]
    if frames[-1].contacts is not None:
        counts = [len(frame.contacts.pair) for frame in frames]  # type: ignore[union-attr]
        arrays["contact_frame"] = np.repeat(np.arange(len(frames), dtype=np.int32), counts)
        arrays["contact_pair"] = np.concatenate([frame.contacts.pair for frame in frames])  # type: ignore[union-attr]
        arrays["contact_sums"] = np.concatenate([frame.contacts.sums for frame in frames])  # type: ignore[union-attr]
    scalars = {name: np.array([frame.scalars.get(name, math.nan) for frame in frames]) for name in frames[-1].scalars}
    time = np.array(times)
    fluids = {
        prim: FluidTrack(
            time, *(np.array([getattr(frame.fluids[prim], f.name) for frame in frames]) for f in fields(FluidFrame))
        )
        for prim in frames[-1].fluids
    }
    return Track(time, arrays, scalars, fluids, {"complete": True, **simulation.facts()})


def own(track: Track, world: World) -> Recording:
    """As wsim itself would have recorded it in a world, with forces; energies are those of the world's own masses."""
    names = {f.name for f in fields(Recording)}
    return Recording(
        path=Path("drawn.rrd"),
        world=world,
        metadata=track.facts,
        time=track.time,
        fluids=track.fluids,
        scalars={**track.scalars, **_energies(track, world)},
        log=[],
        images={},
        contacts=_contacts(track),
        ties=TieTrack(track.frames["tie_joints"], track.frames["tie_cords"]) if "tie_joints" in track.frames else None,
        **{name: array for name, array in track.frames.items() if name in names},
    )


def _contacts(track: Track) -> ContactTrack | None:
    parts = [track.frames.get(f"contact_{name}") for name in ("frame", "pair", "sums")]
    return None if any(part is None for part in parts) else ContactTrack(*parts)  # type: ignore[arg-type]


def other(track: Track, world: World) -> Recording:
    """As another engine's trajectory would be imported: poses and velocities alone."""
    arrays = {"time": track.time, "body_names": np.array([body.prim for body in world.bodies]),
              "body_q": track.q, "body_qd": track.qd}  # fmt: skip
    return from_arrays(arrays, world)


def _energies(track: Track, world: World) -> dict[str, Array]:
    """Of the bodies and springs by what the world states; none where nothing moves."""
    if not world.bodies:
        return {}
    kinetic, potential = np.zeros(len(track.time)), np.zeros(len(track.time))
    for k, body in enumerate(world.bodies):
        q, v = track.q[:, k].astype(np.float64), track.qd[:, k].astype(np.float64)
        spin = rotate(conjugate(q[:, 3:]), v[:, 3:])
        kinetic += 0.5 * body.mass * (v[:, :3] ** 2).sum(axis=1)
        kinetic += 0.5 * np.einsum("ti,ij,tj->t", spin, np.reshape(body.inertia, (3, 3)), spin)
        centre = q[:, :3] + rotate(q[:, 3:], np.broadcast_to(body.com, (len(q), 3)))
        potential -= body.mass * centre @ np.array(world.gravity)
    found = {"energy/kinetic_bodies": kinetic, "energy/potential_bodies": potential}
    if world.springs:
        bodies = {body.prim: body for body in world.bodies}
        q, v = ({prim: array[:, k] for k, prim in enumerate(bodies)} for array in (track.q, track.qd))
        tracks = [spring_track(spring, bodies, q, v) for spring in world.springs]
        found["energy/potential_springs"] = np.sum([each.energy for each in tracks], axis=0)
    fluid = {name: track.scalars.get(f"energy/{name}_fluid", 0.0) for name in ("kinetic", "potential")}
    found["energy/kinetic"] = kinetic + fluid["kinetic"]
    found["energy/potential"] = potential + fluid["potential"] + found.get("energy/potential_springs", 0.0)
    return found


def edited(track: Track, q: Array | None = None, qd: Array | None = None, **fluids: FluidTrack) -> Track:
    """A track with other poses, velocities or particles."""
    frames = dict(track.frames)
    for name, array in (("body_q", q), ("body_qd", qd)):
        if array is not None:
            frames[name] = array.astype(np.float32)
    return replace(track, frames=frames, fluids={**track.fluids, **fluids})


def cut(track: Track, count: int) -> Track:
    """The first frames of a track without fluid."""
    frames, scalars = ({name: array[:count] for name, array in each.items()} for each in (track.frames, track.scalars))
    if "contact_frame" in track.frames:
        kept = track.frames["contact_frame"] < count
        frames |= {
            name: array[kept]
            for name, array in track.frames.items()
            if name.startswith("contact_") and name != "contact_force"
        }
    return replace(track, time=track.time[:count], frames=frames, scalars=scalars)


# ---- what is kept
def _text(stage: str) -> str:
    """A stage's text without the lines of the programs that wrote it."""
    return re.sub(r'string line = "[^"]*"', "", stage)


def _kept(folder: str, text: str, suffix: str) -> Path:
    return CACHE / folder / (hashlib.sha256(f"{FORMAT}\n{text}".encode()).hexdigest()[:20] + suffix)


def _written(stage: str) -> Path:
    """A file of its own: USD keeps what it has read by its path."""
    with tempfile.NamedTemporaryFile("w", suffix=".usda", delete=False, encoding="utf-8") as file:
        file.write(stage)
    return Path(file.name)


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    side = path.with_suffix(f".{os.getpid()}.part")
    side.write_bytes(content)
    side.replace(path)


def _save(path: Path, track: Track) -> None:
    arrays: dict[str, Array] = {"time": track.time, "facts": np.array(json.dumps(track.facts))}
    arrays |= {f"frame:{name}": array for name, array in track.frames.items()}
    arrays |= {f"scalar:{name}": array for name, array in track.scalars.items()}
    for prim, fluid in track.fluids.items():
        arrays |= {f"fluid:{prim}:{f.name}": getattr(fluid, f.name) for f in fields(FluidFrame)}
    with io.BytesIO() as file:
        np.savez(file, **arrays)
        _write(path, file.getvalue())


def _load(path: Path) -> Track:
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}

    def part(kind: str) -> dict[str, Array]:
        return {name.removeprefix(kind): array for name, array in arrays.items() if name.startswith(kind)}

    fluids: dict[str, dict[str, Array]] = {}
    for name, array in part("fluid:").items():
        prim, field = name.rsplit(":", 1)
        fluids.setdefault(prim, {})[field] = array
    time = arrays["time"]
    return Track(time, part("frame:"), part("scalar:"),
                 {prim: FluidTrack(time=time, **each) for prim, each in fluids.items()},
                 json.loads(str(arrays["facts"])))  # fmt: skip
