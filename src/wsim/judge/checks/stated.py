"""Checks of the motion that the stage itself states: where bodies start, and where what is led goes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.paths import exponential
from wsim.geometry.rotations import lengths, multiply, rotate
from wsim.judge.checks.check import Check, Checks, worst
from wsim.judge.evidence.motion import FLOAT32, OURS
from wsim.judge.evidence.scheduled import led
from wsim.judge.repair.start import start_taken, way_taken
from wsim.scene.usd_motion import curve_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding, RepairTarget
    from wsim.scene.world import Body

    Floats = NDArray[np.float64]


@dataclass
class CheckStart(Check):
    """Each body starts where, turned and moving as the stage states."""

    place: float = 5e-3  # of the body's radius: a seed moves it by 1e-4 of its thickness, joints are closed likewise
    turn: float = 5e-3  # [rad]: a seed turns a hinge by 1e-4
    share: float = 5e-3  # of a stated speed; joints may miss it by 1e-3
    still: float = 1e-4  # [m/s, rad/s]: below, a loose body stands

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """What starts most unlike what is stated, of places, turns and speeds."""
        if OURS not in evidence.recording.metadata or not len(evidence.motion.mass):
            return []
        value, limit = self._asked(evidence)
        margin = np.where(np.isnan(value), np.inf, limit - value)
        if not np.any(margin < 0.0):  # one is told of, as they are many
            margin = np.where(np.arange(margin.size).reshape(margin.shape) == np.argmin(margin), margin, np.inf)
        asked = zip(*np.nonzero(np.isfinite(margin)), strict=True)
        return worst(
            [self._finding(evidence, int(k), int(n), float(value[k, n]), float(limit[k, n])) for k, n in asked]
        )

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """The start that was taken."""
        return start_taken(evidence, finding)

    def _asked(self, evidence: Evidence) -> tuple[Floats, Floats]:
        """Of each body how far off place, turn, velocity and rate are, and may be, (B, 4) each; NaN: not asked."""
        motion, bodies = evidence.motion, evidence.world.bodies
        names = "position", "rotation", "velocity", "angular_velocity"
        place, turn, *rates = (np.array([getattr(body, name) for body in bodies]) for name in names)
        free, rounding = _free(evidence), 8.0 * FLOAT32 * lengths(place)
        value = [lengths(motion.q[0, :, :3] - place), _angles(motion.q[0, :, 3:], turn)]
        limit = [self.place * motion.radius + rounding, np.full(len(bodies), self.turn)]
        for has, stated in zip((motion.v[0], motion.w[0]), rates, strict=True):
            # What joints make of a speed that nobody states is theirs.
            value.append(np.where(stated.any(axis=1) | free, lengths(has - stated), np.nan))
            limit.append(self.share * lengths(stated) + self.still)
        asked = np.where(motion.kinematic[:, None], np.nan, np.stack(value, axis=1))
        return asked, np.stack(limit, axis=1)

    def _finding(self, evidence: Evidence, k: int, n: int, value: float, limit: float) -> Finding:
        """Of body k: its place, turn, velocity or rate."""
        prim, unit = evidence.world.bodies[k].prim, ("m", "rad", "m/s", "rad/s")[n]
        how = (
            f"starts {value:.3g} m from where it stands",
            f"starts turned by {math.degrees(value):.3g}°",
            f"moves at the start by {value:.3g} m/s otherwise than stated",
            f"turns at the start by {value:.3g} rad/s otherwise than stated",
        )[n]
        return self.measured(
            f"{prim} {how}", value, limit, unit, expected=0.0, prim=prim, time=0.0,
            limit_from="what a seed and the joints' closing change", fine="All starts as it is stated to",
        )  # fmt: skip


@dataclass
class CheckPath(Check):
    """What is kinematic goes where its velocity takes it, or along its path.

    Of other engines, and of tables of poses, what states a velocity, and from where it is first seen: their models may
    start anywhere, their clocks when a path has begun, and what states no motion may be led by a script.
    """

    place: float = 1e-3  # of the body's radius
    turn: float = 1e-3  # [rad]
    share: float = 1e-3  # of the way gone, by adding up steps in single precision
    others: float = 1e-2  # of it, in others' steps: where quaternions add up a turn by p a step is off by p^2 / 12

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The place and the turn that are farthest off, of each kinematic body."""
        metadata = evidence.recording.metadata
        found: list[Finding] = []
        for k, body in enumerate(evidence.world.bodies):
            if body.kinematic and OURS in metadata:
                found += self._of(evidence, k, body, self.share)
            elif body.kinematic and body.path is None and _moves(body) and not metadata.get("controlled"):
                first = evidence.motion.q[0, k].tolist()
                start = {"position": tuple(first[:3]), "rotation": tuple(first[3:])}
                found += self._of(evidence, k, body.model_copy(update=start), self.others)
        return worst(found)

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """The way that was taken."""
        return way_taken(evidence, finding)

    def _of(self, evidence: Evidence, k: int, body: Body, share: float) -> list[Finding]:
        motion, time = evidence.motion, evidence.time
        places, turns = _by_schedules(evidence, body) or _led(body, time)
        far = lengths(motion.q[:, k, :3] - places)
        way = np.concatenate([[0.0], np.cumsum(lengths(np.diff(places, axis=0)))])
        rounding = 8.0 * FLOAT32 * lengths(places)
        turned = _angles(motion.q[:, k, 3:], turns)
        round_ = float(np.linalg.norm(body.angular_velocity)) * (time - time[0])
        if (gone := led(evidence, body.prim)) is not None:
            round_ = np.cumsum(lengths(gone[1]))
        return [
            self._worst(body, time, far, self.place * motion.radius[k] + share * way + rounding, "m", "is"),
            self._worst(body, time, turned, self.turn + share * round_, "rad", "is turned"),
        ]

    def _worst(self, body: Body, time: Floats, off: Floats, limit: Floats, unit: str, verb: str) -> Finding:
        limit = np.broadcast_to(limit, off.shape)
        worst_at = int(np.argmax(np.where(np.isfinite(off), off / limit, np.inf)))
        by = "path" if body.path is not None else "velocity"
        message = f"{body.prim} {verb} {off[worst_at]:.3g} {unit} from where its {by} takes it"
        return self.measured(
            message, float(off[worst_at]), float(limit[worst_at]), unit, expected=0.0, prim=body.prim,
            time=float(time[worst_at]), limit_from=f"{self.place:g} of its size, and a share of its way",
            fine=f"What is kinematic goes by its {by}",
        )  # fmt: skip


def _led(body: Body, time: Floats) -> tuple[Floats, Floats]:
    """Where a kinematic body is at each time: places (T, 3) [m] and rotations (T, 4), xyzw."""
    if body.path is not None:
        curve = curve_of(body.path)
        poses = [curve.pose(float(t)) for t in time]
        return np.array([place for place, _ in poses]), np.array([turn for _, turn in poses])
    since, start = (time - time[0])[:, None], np.array(body.rotation)
    turns = multiply(exponential(since * np.array(body.angular_velocity)), np.broadcast_to(start, (len(time), 4)))
    arm = np.array(body.com)
    centre = np.array(body.position) + rotate(start, arm) + since * np.array(body.velocity)
    return centre - rotate(turns, np.broadcast_to(arm, centre.shape)), turns


def _by_schedules(evidence: Evidence, body: Body) -> tuple[Floats, Floats] | None:
    """Where schedules of its velocities take a kinematic body, as `_led`; None where it has none."""
    gone = led(evidence, body.prim)
    if gone is None:
        return None
    turns = [np.array(body.rotation, dtype=np.float64)]
    for turn in exponential(gone[1][1:]):
        turns.append(multiply(turn, turns[-1]))
    every, arm = np.array(turns), np.array(body.com)
    centre = np.array(body.position) + rotate(every[0], arm) + gone[0]
    return centre - rotate(every, np.broadcast_to(arm, centre.shape)), every


def _moves(body: Body) -> bool:
    """Whether it is stated to have a velocity."""
    return any((*body.velocity, *body.angular_velocity))


def _free(evidence: Evidence) -> NDArray[np.bool_]:
    """Whether a body starts as it is stated, at rest where nothing is, (B,): joints and gears give it no speed."""
    world = evidence.world
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    unit = np.arange(len(row))
    child = {joint.prim: joint.child for joint in world.joints}
    pairs: list[tuple[str | None, str | None]] = [(joint.parent, joint.child) for joint in world.joints]
    pairs += [(child.get(gear.first), child.get(gear.second)) for gear in world.gears]
    for one, other in pairs:
        if one in row and other in row:
            unit[unit == unit[row[other]]] = unit[row[one]]
    moves = [_moves(body) or body.path is not None for body in world.bodies]
    ends = {end for joint in world.joints for end in (joint.parent, joint.child)}
    tied = np.array([prim in ends for prim in row], dtype=bool)
    free: NDArray[np.bool_] = ~tied | ~np.isin(unit, unit[np.array(moves, dtype=bool)])
    return free


def _angles(a: Floats, b: Floats) -> Floats:
    """Between rotations (n, 4), xyzw, (n,) [rad]."""
    # The chord, not the cosine, which loses small angles to rounding.
    a, b = a / lengths(a)[:, None], b / lengths(b)[:, None]
    chord = np.minimum(lengths(a - b), lengths(a + b))
    return np.asarray(4.0 * np.arcsin(np.minimum(1.0, 0.5 * chord)))


CHECKS: Checks = (CheckStart, CheckPath)
