"""What can be asked of a recording: quantities over time, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from wsim.errors import UserError
from wsim.geometry.rotations import tilt
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.tools.text import name_of, prim_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Fluid, Joint

    Values = NDArray[np.float64]

XYZ = ("x", "y", "z")
SCALAR_UNITS = {"energy": "J", "work": "J", "drive": "N or N m", "penetration": "m", "speed": "m/s"}


@dataclass(frozen=True)
class Signal:
    """A quantity over time."""

    name: str
    of: str  # whose it is, in words: "block", "ball to floor"; empty for the world's
    unit: str
    time: Values  # (T,) [s]
    value: Values  # (T, n)
    parts: tuple[str, ...] = ("",)  # names of the n columns; one without a name for a scalar

    @property
    def title(self) -> str:
        """What it is, whose, and in which unit."""
        of = f" of {self.of}" if self.of else ""
        return f"{self.name}{of}" + (f" [{self.unit}]" if self.unit else "")

    def part(self, part: str) -> Signal:
        """One of its components; UserError naming those that it has."""
        if part not in self.parts or not part:
            has = f"the components {', '.join(self.parts)}" if self.parts != ("",) else "no components"
            raise UserError(f"signal: {self.name} has {has}, not {part[:60]!r}")
        k = self.parts.index(part)
        return Signal(f"{self.name}.{part}", self.of, self.unit, self.time, self.value[:, k : k + 1])


@dataclass(frozen=True)
class _Kind:
    """A signal of a kind of prim."""

    unit: str
    values: Callable[[Evidence, int], Values]
    parts: tuple[str, ...] = ("",)


def find(evidence: Evidence, name: str, prim: str, other: str = "") -> Signal:
    """A signal by name.

    Args:
        evidence: Of a recording.
        name: Such as "position", "position.z", "angular velocity", "energy/kinetic".
        prim: Whose it is, as a plan or a stage calls it; empty for what is of the world as a whole.
        other: The second object of a gap.

    Raises:
        UserError: If there is no such prim or signal; it names those that there are.
    """
    recorded = evidence.recording.scalars
    if name in recorded:
        unit = next((unit for word, unit in SCALAR_UNITS.items() if word in name), "")
        return Signal(name, "", unit, evidence.time, np.asarray(recorded[name], np.float64)[:, None])
    stem, _, part = name.strip().lower().replace(" ", "_").replace("-", "_").partition(".")
    if not prim:
        raise UserError(f"prim: {name[:60]!r} is of an object; name one of {_prims(evidence)}")
    signal = _of_prim(evidence, stem, prim_of(prim), other)
    return signal.part(part) if part else signal


def known(evidence: Evidence) -> list[list[str]]:
    """(whose, which signals) for each kind of prim, and for the world."""
    world = evidence.world
    rows = [
        [
            ", ".join(name_of(item.prim) for item in items),
            ", ".join(f"{n} [{kind.unit}]" for n, kind in kinds.items() if n != "draft" or world.fluids),
        ]
        for items, kinds in ((world.bodies, BODY), (world.joints, JOINT), (world.fluids, FLUID))
        if items
    ]
    if world.bodies:
        rows[0][1] += ", gap [m] (to other)"
    return [*rows, ["", ", ".join(sorted(evidence.recording.scalars))]]


def _of_prim(evidence: Evidence, name: str, prim: str, other: str) -> Signal:
    world = evidence.world
    for items, kinds in ((world.bodies, BODY), (world.joints, JOINT), (world.fluids, FLUID)):
        prims = [item.prim for item in items]
        if prim not in prims:
            continue
        if name == "gap" and kinds is BODY:
            between = f"{name_of(prim)} to {name_of(prim_of(other))}"
            return Signal(name, between, "m", evidence.time, _gap(evidence, prim, other))
        if name not in kinds:
            raise UserError(f"signal: {name_of(prim)} has no {name[:60]!r}; it has {', '.join(kinds)}")
        try:
            value = kinds[name].values(evidence, prims.index(prim))
        except MissingError as error:
            raise UserError(f"signal: {name} of {name_of(prim)}: {error.args[0]}") from error
        time = evidence.track(world.fluids[prims.index(prim)]).time if kinds is FLUID else evidence.time
        return Signal(name, name_of(prim), kinds[name].unit, time, value.reshape(len(time), -1), kinds[name].parts)
    raise UserError(f"prim: nothing that is recorded is called {name_of(prim)[:60]!r}; there are {_prims(evidence)}")


def _prims(evidence: Evidence) -> str:
    world = evidence.world
    prims = [body.prim for body in world.bodies] + [joint.prim for joint in world.joints]
    names = [name_of(prim) for prim in (*prims, *(fluid.prim for fluid in world.fluids))]
    return ", ".join(names[:30]) + (f" and {len(names) - 30} more" if len(names) > 30 else "")


# ---- of bodies
def _rotation(evidence: Evidence, i: int) -> Values:
    return np.asarray(Rotation.from_quat(evidence.body_q[:, i, 3:]).as_euler("xyz", degrees=True))


def _draft(evidence: Evidence, i: int) -> Values:
    """How deep its lowest point is under the still surface of the nearest fluid that has one."""
    levels = []
    for fluid in evidence.world.fluids:
        container = evidence.container_of(fluid)
        if container is not None:
            away = evidence.local(container, evidence.body_q[-1:, i, :3])[0]
            levels.append((float(np.hypot(away[0], away[1])), evidence.level(fluid).height))
    if not levels:
        raise MissingError("no fluid here has a container, and so a level")
    return min(levels)[1] - evidence.ends(i)[0]


def _gap(evidence: Evidence, prim: str, other: str) -> Values:
    solids = [body.prim for body in evidence.world.bodies] + [static.prim for static in evidence.world.statics]
    if not other or prim_of(other) not in solids or prim_of(other) == prim:
        names = ", ".join(name_of(solid) for solid in solids if solid != prim)
        raise UserError(f"other: name the object that the gap is to, one of {names or 'none'}")
    return distance(evidence, prim, prim_of(other))[:, None]


BODY = {
    "position": _Kind("m", lambda e, i: e.body_q[:, i, :3], XYZ),
    "velocity": _Kind("m/s", lambda e, i: e.body_qd[:, i, :3], XYZ),
    "speed": _Kind("m/s", lambda e, i: np.linalg.norm(e.body_qd[:, i, :3], axis=1)),
    "rotation": _Kind("deg", _rotation, ("roll", "pitch", "yaw")),
    "tilt": _Kind("deg", lambda e, i: tilt(e.body_q[:, i, 3:], e.up)),
    "angular_velocity": _Kind("rad/s", lambda e, i: e.body_qd[:, i, 3:], XYZ),
    "kinetic_energy": _Kind("J", lambda e, i: e.motion.kinetic[:, i]),
    "contact_force": _Kind("N", lambda e, i: np.asarray(e.recording.contact_force[:, i], np.float64), XYZ),
    "lowest_point": _Kind("m", lambda e, i: e.ends(i)[0]),
    "highest_point": _Kind("m", lambda e, i: e.ends(i)[1]),
    "draft": _Kind("m", _draft),
}


# ---- of joints
def _joint(evidence: Evidence, i: int) -> tuple[Joint, Values, Values]:
    joint = evidence.world.joints[i]
    track = evidence.joint(joint)
    if track is None:
        raise MissingError("the recording does not say where its anchors are")
    return joint, track.position, track.apart


def _angle(evidence: Evidence, i: int) -> Values:
    joint, position, _ = _joint(evidence, i)
    if joint.kind != "revolute":
        raise MissingError(f"a {joint.kind} joint has no angle")
    return np.degrees(position)


def _slide(evidence: Evidence, i: int) -> Values:
    joint, position, _ = _joint(evidence, i)
    if joint.kind != "prismatic":
        raise MissingError(f"a {joint.kind} joint has no slide")
    return position


JOINT = {
    "angle": _Kind("deg", _angle),
    "slide": _Kind("m", _slide),
    "apart": _Kind("m", lambda e, i: _joint(e, i)[2]),
}


# ---- of fluids, at the frames at which their particles are recorded
def _fluid(evidence: Evidence, i: int) -> Fluid:
    return evidence.world.fluids[i]


def _level(evidence: Evidence, i: int) -> Values:
    """Height of the surface: that of the fluid's median column, seen from above (T,)."""
    fluid = _fluid(evidence, i)
    track = evidence.track(fluid)
    frames = (points[track.there(k)].astype(np.float64) for k, points in enumerate(track.position))
    return np.array([_surface(points, fluid.spacing) if len(points) else np.nan for points in frames])


def _surface(points: Values, spacing: float) -> float:
    """Median over columns two spacings wide of the highest particle's top [m]."""
    cell = np.floor(points[:, :2] / (2.0 * spacing)).astype(np.int64)
    _, column = np.unique(cell, axis=0, return_inverse=True)
    top = np.full(int(column.max()) + 1, -np.inf)
    np.maximum.at(top, column.reshape(-1), points[:, 2])
    return float(np.median(top)) + spacing / 2


def _fastest(evidence: Evidence, i: int) -> Values:
    velocity = evidence.track(_fluid(evidence, i)).velocity.astype(np.float64)
    return np.nan_to_num(np.linalg.norm(velocity, axis=2)).max(axis=1)


def _density_error(evidence: Evidence, i: int) -> Values:
    fluid = _fluid(evidence, i)
    track = evidence.track(fluid)
    return track.mean(np.abs(track.density.astype(np.float64) / fluid.density - 1.0))


FLUID = {
    "level": _Kind("m", _level),
    "center": _Kind("m", lambda e, i: e.track(_fluid(e, i)).mean(e.track(_fluid(e, i)).position), XYZ),
    "fastest": _Kind("m/s", _fastest),
    "outside": _Kind("share", lambda e, i: e.outside(_fluid(e, i))),
    "density_error": _Kind("share", _density_error),
}
