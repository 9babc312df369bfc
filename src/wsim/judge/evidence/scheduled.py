"""What schedules say of a recorded world: when their clocks began, and what they set at frames and between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.scene.contact import stated_pair, within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.recorded import Recorded
    from wsim.scene.world import Joint, Schedule, Shape, World

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

OF_DRIVES = ("position", "velocity")
PUSH = ("force", "torque", "effort")
ROUNDING = 1e-9  # [s]


def pushes(world: World) -> bool:
    """Whether schedules push bodies or joints."""
    return any(each.quantity in PUSH for each in world.schedules)


def begin_of(evidence: Recorded, schedule: Schedule) -> float | None:
    """When a schedule's clock began [s]; None where it never did."""
    if schedule.after is None:
        return 0.0
    said = evidence.recording.scalars.get("begin" + schedule.prim.removeprefix("/World"))
    told = np.zeros(0) if said is None else said[np.nan_to_num(said, nan=-1.0) >= 0.0]
    return float(told[-1]) if len(told) else None


@dataclass(frozen=True)
class ByTime:
    """A quantity as a schedule has it, over the frames of a recording; before its first key it is as stated."""

    at: Floats  # (T, n) at each frame; from a key on its own
    means: Floats  # (T - 1, n) over each interval
    spread: Floats  # (T - 1, n) how far it is from that mean within the interval, at most
    jumps: Bools  # (T - 1,) whether a key is within an interval, or at its end

    @staticmethod
    def of(evidence: Recorded, schedule: Schedule, stated: tuple[float, ...]) -> ByTime:
        """Of a schedule, and what is stated beside it."""
        base = np.zeros(len(schedule.values[0])) if not stated else np.array(stated, dtype=np.float64)
        time = evidence.time
        begin, profile = begin_of(evidence, schedule), schedule.profile
        if begin is None:
            still = np.zeros(max(len(time) - 1, 0), dtype=bool)
            means = np.tile(base, (len(still), 1))
            return ByTime(np.tile(base, (len(time), 1)), means, np.zeros_like(means), still)
        own = time - begin
        first = profile.times[0]
        at = np.where((own >= first - ROUNDING)[:, None], profile.at(own + ROUNDING), base)
        waits = np.clip(first - own, 0.0, None)
        sums = profile.sum_to(own) - base * waits[:, None]
        keys = (profile.times > own[:-1, None] + ROUNDING) & (profile.times <= own[1:, None] + ROUNDING)
        means = np.diff(sums, axis=0) / np.diff(time)[:, None]
        before = profile.at(own[1:] - ROUNDING)  # of a step at an interval's end that it comes from
        before = np.where((own[1:] >= first - ROUNDING)[:, None], before, base)
        spread = np.max(np.abs(np.stack([at[:-1], at[1:], before]) - means), axis=0)
        return ByTime(at, means, spread, np.asarray(keys.any(axis=1)))


@dataclass(frozen=True)
class Aims:
    """What a drive aims at, and what pushes its joint beside it, of T frames."""

    position: Floats  # (T,) [rad] or [m]
    velocity: Floats  # (T,)
    mean_position: Floats  # (T - 1,)
    mean_velocity: Floats
    effort: Floats  # (T - 1,) the mean of what is beside the drive [N m] or [N]
    jumps: Bools  # (T - 1,) whether the drive's aim jumps or bends
    set: bool  # whether a schedule sets any of these

    @staticmethod
    def of(evidence: Recorded, joint: Joint) -> Aims:
        """Of a hinge or a slider."""
        drive, frames = joint.drive, len(evidence.time)
        own: dict[str, Schedule] = {
            each.quantity: each for each in evidence.world.schedules if each.target == joint.prim
        }
        stated = {what: 0.0 if drive is None else float(getattr(drive, what)) for what in OF_DRIVES} | {"effort": 0.0}
        even: dict[str, ByTime] = {}
        jumps = np.zeros(max(frames - 1, 0), dtype=bool)
        for what, value in stated.items():
            if what in own:
                even[what] = ByTime.of(evidence, own[what], (value,))
                jumps |= even[what].jumps & (what in OF_DRIVES)
            else:
                even[what] = ByTime(np.full((frames, 1), value), np.full((len(jumps), 1), value), jumps)
        position, velocity = even["position"], even["velocity"]
        return Aims(position.at[:, 0], velocity.at[:, 0], position.means[:, 0], velocity.means[:, 0],
                    even["effort"].means[:, 0], jumps, bool(set(own) & set(stated)))  # fmt: skip


def released(evidence: Recorded, joint: Joint) -> bool:
    """Whether a schedule lets a joint go in the time of the recording; `CheckSchedules` asks when."""
    own = [each for each in evidence.world.schedules if each.target == joint.prim and each.quantity == "release"]
    begun = [(begin_of(evidence, each), each.times[0]) for each in own]
    return any(begin is not None and begin + time <= float(evidence.time[-1]) for begin, time in begun)


def drive_is_set(world: World, joint: Joint) -> bool:
    """Whether a schedule sets what a joint's drive aims at, or pushes beside it."""
    return any(each.target == joint.prim and each.quantity != "release" for each in world.schedules)


def pushed(evidence: Recorded) -> tuple[Floats, Floats]:
    """Impulses and angular impulses about centres of mass that schedules have for each body since the frame before,
    (T, B, 6) [N s, N m s], and how far those may be off by how bodies turn between frames, (T, B) [N m s]."""
    world, time = evidence.world, evidence.time
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    found, unsure = np.zeros((len(time), len(row), 6)), np.zeros((len(time), len(row)))
    for each in world.schedules:
        if each.quantity not in ("force", "torque"):
            continue
        i, h = row[each.target], np.diff(time)[:, None]
        given = ByTime.of(evidence, each, (0.0, 0.0, 0.0)).means * h
        if each.quantity == "torque":
            found[1:, i, 3:] += given
            continue
        found[1:, i, :3] += given
        if each.point is not None:
            own = np.subtract(each.point, world.bodies[i].com)
            arm = rotate(evidence.body_q[:, i, 3:], own[None])
            found[1:, i, 3:] += np.cross(0.5 * (arm[1:] + arm[:-1]), given)
            size, turned = np.linalg.norm(given, axis=1), np.linalg.norm(np.diff(arm, axis=0), axis=1)
            unsure[1:, i] += size * turned
    return found, unsure


def between(evidence: Recorded) -> tuple[Floats, Floats]:
    """Speeds and rates that keys within an interval may give and take before it ends, (T - 1, B) each."""
    world, h = evidence.world, np.diff(evidence.time)
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    found = np.zeros((2, len(h), len(row)))
    for each in world.schedules:
        i = row.get(each.target)
        if i is None:
            continue
        most, jumps = max(float(np.linalg.norm(value)) for value in each.values), ByTime.of(evidence, each, ()).jumps
        inertia = np.linalg.eigvalsh(np.reshape(world.bodies[i].inertia, (3, 3))).min()
        gives = {"force": h / world.bodies[i].mass, "torque": h / max(float(inertia), 1e-12)}
        turns = int(each.quantity in ("torque", "angular_velocity"))
        found[turns, :, i] += np.where(jumps, most * gives.get(each.quantity, np.ones(len(h))), 0.0)
    return found[0], found[1]


def led(evidence: Recorded, prim: str) -> tuple[Floats, Floats] | None:
    """Where schedules take a kinematic body: the way of its centre of mass and the turn about the world's axes since
    the start, (T, 3) each [m, rad]; None where none does."""
    own = {each.quantity: each for each in evidence.world.schedules if each.target == prim}
    if not own.keys() & {"velocity", "angular_velocity"}:
        return None
    body, h = evidence.body(prim), np.diff(evidence.time)[:, None]
    parts = []
    for what in ("velocity", "angular_velocity"):
        stated = getattr(body, what)
        rate = np.tile(np.array(stated), (len(h), 1))
        if what in own:
            rate = ByTime.of(evidence, own[what], stated).means
        parts.append(np.concatenate([np.zeros((1, 3)), rate * h]))
    return np.cumsum(parts[0], axis=0), parts[1]


def belt(evidence: Recorded, shape: Shape) -> Floats:
    """How a surface of what never moves runs, or of a body in its own axes, at each frame, (T, 3) [m/s]."""
    for each in evidence.world.schedules:
        if each.quantity == "surface_velocity" and within(shape.prim, each.target):
            return ByTime.of(evidence, each, shape.surface_velocity).at
    return np.tile(np.array(shape.surface_velocity, dtype=np.float64), (len(evidence.time), 1))


def fastest(world: World, shape: Shape) -> tuple[float, ...]:
    """How a surface runs where it runs fastest [m/s]."""
    stated = [tuple(shape.surface_velocity)]
    for each in world.schedules:
        if each.quantity == "surface_velocity" and within(shape.prim, each.target):
            stated += each.values
    return max(stated, key=lambda velocity: float(np.linalg.norm(velocity)))


def changes(world: World, shape: Shape) -> bool:
    """Whether a schedule changes how a surface runs, or rubs on another."""
    pairs = {pair.prim: (pair.first, pair.second) for pair in world.contacts}
    owners = [each.target for each in world.schedules if each.quantity == "surface_velocity"]
    owners += [end for each in world.schedules if each.quantity == "friction" for end in pairs[each.target]]
    return any(within(shape.prim, owner) for owner in owners)


def roughest(world: World, one: Shape, other: Shape, stated: float) -> float:
    """The largest friction that a pair of surfaces ever has."""
    pair = stated_pair(world, one.prim, other.prim) if world.schedules else None
    own = [each for each in world.schedules if pair is not None and each.target == pair.prim]
    return max([stated, *(value[0] for each in own for value in each.values)])


def friction(evidence: Recorded, one: Shape, other: Shape, stated: float) -> ByTime | None:
    """The friction of a pair of surfaces by time, of one column; None where no schedule changes it."""
    pair = stated_pair(evidence.world, one.prim, other.prim) if evidence.world.schedules else None
    for each in evidence.world.schedules:
        if pair is not None and each.target == pair.prim:
            return ByTime.of(evidence, each, (stated,))
    return None
