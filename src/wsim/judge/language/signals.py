"""What a formula is evaluated on: the signals of one recording, or of many worlds that share one description."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.geometry.rotations import conjugate, rotate, upwards
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.posed import posed
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.welded import welded
from wsim.judge.language.between import Course
from wsim.scene.contact import largest_friction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.geometry.shapes import Solid
    from wsim.plan.schema import Plan
    from wsim.recording.recording import Recording
    from wsim.scene.world import Body, Container, Fluid, Shape, World

    Floats = NDArray[np.float64]


@dataclass(eq=False)
class Signals:
    """W worlds of T frames and B bodies in the order of `world.bodies`.

    Args:
        world: What all of them are made of; their masses may differ.
        time: (T,) [s], increasing.
        body_q: (W, T, B, 7), [x y z qx qy qz qw], world frame.
        body_qd: (W, T, B, 6), velocity of the centre of mass [m/s] and angular velocity [rad/s], world frame.
        contact_force: (W, T, B, 3), net force of the contacts on a body [N]; NaN where it was not recorded.
        mass: (W, B) [kg]; the description's if left out.
        evidence: The recording they are from, for what has no world axis: the particles of a fluid.
        worlds: W of them, where their surfaces and starts differ, too; none: all are `world`.

    Raises:
        ValueError: The shapes do not fit each other, or time does not increase.
    """

    world: World
    time: Floats
    body_q: NDArray[Any]
    body_qd: NDArray[Any]
    contact_force: NDArray[Any]
    mass: Floats | None = None
    evidence: Evidence | None = None
    worlds: Sequence[World] = ()
    _frames: dict[tuple[str, ...], Evidence] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.time = np.asarray(self.time, dtype=np.float64)
        count, frames, bodies = self.body_q.shape[0], len(self.time), len(self.world.bodies)
        for name, width in (("body_q", 7), ("body_qd", 6), ("contact_force", 3)):
            shape, wanted = getattr(self, name).shape, (count, frames, bodies, width)
            if shape != wanted:
                raise ValueError(f"{name} has the shape {shape}; {frames} times and {bodies} bodies need {wanted}")
        if frames == 0 or not np.all(np.diff(self.time) > 0.0):
            raise ValueError("time must be one or more finite seconds that increase")
        if self.mass is None:
            self.mass = np.tile([body.mass for body in self.world.bodies], (count, 1)).reshape(count, bodies)
        elif self.mass.shape != (count, bodies):
            raise ValueError(f"mass has the shape {self.mass.shape}; {count} worlds of {bodies} bodies need one each")

    @classmethod
    def of(cls, evidence: Evidence) -> Signals:
        """One recorded world."""
        return cls(
            evidence.world, evidence.time, evidence.body_q[None], evidence.body_qd[None],
            np.asarray(evidence.recording.contact_force)[None], evidence=evidence,
        )  # fmt: skip

    @classmethod
    def of_copies(cls, joined: Evidence, worlds: Sequence[World]) -> Signals:
        """Many worlds of one geometry, whose evidence was joined (`Evidence.join`)."""
        motion = joined.motion
        turning = np.concatenate([motion.v, motion.w], axis=-1)
        return cls(
            joined.world, joined.time, motion.q, turning, motion.contact_force, mass=motion.mass[:, 0], worlds=worlds
        )

    @classmethod
    def of_recording(cls, recording: Recording, plan: Plan | None = None) -> Signals:
        """One recorded world."""
        return cls.of(Evidence(recording, plan))

    # ---- time and space
    @property
    def count(self) -> int:
        """How many worlds."""
        return int(self.body_q.shape[0])

    @cached_property
    def step(self) -> float:
        """The median time between two frames [s]; 0 where there is one frame alone."""
        return float(np.median(np.diff(self.time))) if len(self.time) > 1 else 0.0

    @cached_property
    def friction(self) -> Floats:
        """The largest of any surface or pair, which bounds what friction does, (W, 1)."""
        return np.array([[largest_friction(world)] for world in self.worlds or [self.world] * self.count])

    def start_velocity(self, name: str) -> Floats:
        """As a body's world states it, (W, 3) [m/s]."""
        row = self.row(name)
        return np.array([world.bodies[row].velocity for world in self.worlds or [self.world] * self.count])

    @property
    def gravity(self) -> float:
        """The strength of gravity [m/s^2]."""
        return float(np.linalg.norm(self.world.gravity))

    @cached_property
    def up(self) -> Floats:
        """Against gravity (3,); +Z where there is none."""
        return upwards(self.world.gravity)

    def speed_scale(self, length: float) -> float:
        """The speed sqrt(g L) that gravity gives over a length [m/s]."""
        return math.sqrt(max(self.gravity, 1e-9) * length)

    def pressed(self, one: str, other: str) -> NDArray[np.bool_]:
        """Where a contact is recorded by which two objects pressed on each other between frames, (W, T - 1)."""
        found = np.zeros((self.count, len(self.time)), dtype=bool)
        contacts = self.evidence.recording.contacts if self.evidence is not None else None
        if contacts is not None:
            on = self._pushes({self.prim(one)}, {self.prim(other)}) != 0
            found[:, contacts.frame[on & (contacts.pressed > 0.0)]] = True
        return found[:, 1:]

    def given(self, prims: set[str], by: set[str]) -> Floats | None:
        """What some objects are given by others through contacts, as a mean since the frame before, (1, T, 3) [N].

        None where contacts are not recorded.
        """
        contacts = self.evidence.recording.contacts if self.evidence is not None else None
        if contacts is None or len(self.time) < 2:
            return None
        found = np.zeros((len(self.time), 3))
        np.add.at(found, contacts.frame, self._pushes(prims, by)[:, None] * contacts.impulse.astype(np.float64))
        found[1:] /= np.diff(self.time)[:, None]
        found[0] = found[1]
        return found[None]

    def pressing(self, name: str, but: Sequence[str]) -> dict[str, Floats]:
        """What else than some others presses on an object or a part of it: how hard, as a mean since the frame before.

        Returns:
            By the prim of each, (1, T) [N]: sums of sizes, which do not cancel; none of what never presses.

        Raises:
            MissingError: Contacts are not recorded, as those of many worlds at once are not.
        """
        contacts = self.evidence.recording.contacts if self.evidence is not None and self.count == 1 else None
        if contacts is None:
            raise MissingError("the recording has no contacts: what presses on what is not told")
        own, allowed = self.parts(name), set().union(*(self.parts(each) for each in but))
        owners = self._owners()
        h = np.diff(self.time, prepend=2.0 * self.time[0] - self.time[1]) if len(self.time) > 1 else np.ones(1)
        found: dict[str, Floats] = {}
        for frame, pair, pressed in zip(contacts.frame, contacts.pair, contacts.pressed, strict=True):
            one, two = owners[pair[0]], owners[pair[1]]
            if (one in own) == (two in own) or pressed <= 0.0:
                continue
            other = two if one in own else one
            if other not in allowed:
                found.setdefault(other, np.zeros((1, len(self.time))))[0, frame] += pressed / h[frame]
        return found

    def _owners(self) -> list[str]:
        """The prim that each shape is of, as a recording counts shapes."""
        found = [body.prim for body in self.world.bodies for _ in body.shapes]
        return found + [static.prim for static in self.world.statics for _ in static.shapes]

    def _pushes(self, prims: set[str], by: set[str]) -> NDArray[np.int8]:
        """Of each recorded push: 1 if it is on the first objects by the others, -1 if it is the other way, else 0."""
        assert self.evidence is not None and self.evidence.recording.contacts is not None
        owners = self._owners()
        ours, theirs = (np.array([owner in some for owner in owners], dtype=np.int8) for some in (prims, by))
        one, two = self.evidence.recording.contacts.pair.T
        return np.asarray(ours[two] * theirs[one] - ours[one] * theirs[two])

    def together(self, name: str) -> set[str]:
        """The prims of an object, of all its bodies if it is made of several, and of what fixed joints hold to it."""
        if not self.moves(name):
            return {self.prim(name)}
        bodies = self.world.bodies
        everything = self.frames(*(body.prim for body in bodies))
        own = [self._rows[prim] for prim in self.parts(name) if prim in self._rows]
        return {bodies[k].prim for row in own for k in welded(everything, row)}

    def tied(self, name: str) -> set[str]:
        """The same, and what joints and cords of any kind tie to it, one after another: it may hang on it."""
        found, world = self.together(name), self.world
        ends = [{joint.parent or "", joint.child} for joint in world.joints]
        ends += [{guide.body or "" for guide in cord.path} for cord in world.cords]
        while more := {prim for pair in ends if found & pair for prim in pair if prim in self._rows} - found:
            found |= more
        return found

    # ---- who is who
    def parts(self, name: str) -> set[str]:
        """The prims of all bodies of an object that is made of several, as a robot or a vehicle is; else its own."""
        whole = name if name.startswith("/") else Evidence.prim(name)
        solids = [body.prim for body in self.world.bodies] + [static.prim for static in self.world.statics]
        item = self.evidence.planned(whole) if self.evidence is not None else None
        if item is not None and whole == Evidence.prim(item.name) and len(item.prims) > 1:
            return {Evidence.prim(each) for each in item.prims} & {*solids}
        return {prim for prim in solids if prim == whole or prim.startswith(f"{whole}/")} or {self.prim(name)}

    def prim(self, name: str) -> str:
        """The prim of a name, of what is made of several bodies that of its base, which hangs on no other of them.

        Raises:
            MissingError: There is none; it names all that are known.
        """
        prim = name if name.startswith("/") else Evidence.prim(name)
        if prim in self._known:
            return prim
        world = self.world
        within = [body.prim for body in world.bodies if body.prim.startswith(f"{prim}/")]
        if within:
            hung = {joint.child for joint in world.joints if joint.parent in within}
            return next((each for each in within if each not in hung), within[0])
        raise MissingError(f"the world has no {name!r}; it has {', '.join(self._known) or 'nothing'}")

    @cached_property
    def _known(self) -> dict[str, None]:
        """The prims of all that has a name, in order."""
        world = self.world
        known = [body.prim for body in world.bodies] + [static.prim for static in world.statics]
        known += [container.prim for container in world.containers] + [fluid.prim for fluid in world.fluids]
        return dict.fromkeys(known)

    @cached_property
    def _rows(self) -> dict[str, int]:
        """The row of each body by its prim."""
        return {body.prim: k for k, body in enumerate(self.world.bodies)}

    def row(self, name: str) -> int:
        """The row of a body; MissingError naming the bodies."""
        prim = self.prim(name)
        if prim not in self._rows:
            raise MissingError(f"{name!r} is no body that moves; those are {', '.join(self._rows) or 'none'}")
        return self._rows[prim]

    def moves(self, name: str) -> bool:
        """Whether a name is a body's."""
        return self.prim(name) in self._rows

    def body(self, name: str) -> Body:
        """A body's description."""
        return self.world.bodies[self.row(name)]

    def container(self, name: str) -> Container:
        """A container; MissingError naming the containers."""
        prim = self.prim(name)
        for container in self.world.containers:
            if container.prim == prim:
                return container
        known = ", ".join(container.prim for container in self.world.containers) or "none"
        raise MissingError(f"{name!r} is no container; those are {known}")

    def fluid(self, name: str) -> tuple[Evidence, Fluid]:
        """A fluid, by its name or its container's, and the recording with its particles.

        Raises:
            MissingError: It is no fluid, or these are many worlds: their particles are in no recording.
        """
        prim = self.prim(name)
        if self.evidence is None or self.count != 1:
            raise MissingError(
                f"{name!r} is seen through its particles, which only a recording of one world has; these signals are "
                f"of {self.count} worlds without: evaluate the objective on each world's own recording"
            )
        return self.evidence, self.evidence.fluid(prim)

    # ---- signals of a body, float64
    def q(self, name: str) -> Floats:
        """Poses (W, T, 7)."""
        return self.body_q[:, :, self.row(name)].astype(np.float64)

    def qd(self, name: str) -> Floats:
        """Velocities (W, T, 6)."""
        return self.body_qd[:, :, self.row(name)].astype(np.float64)

    def force(self, name: str) -> Floats:
        """Contact forces (W, T, 3) [N]."""
        return self.contact_force[:, :, self.row(name)].astype(np.float64)

    def weight(self, name: str) -> Floats:
        """A body's weight in each world, (W, 1) [N]."""
        assert self.mass is not None
        return self.mass[:, [self.row(name)]] * self.gravity

    def velocity(self, name: str) -> Floats:
        """Velocities (W, T, 3) of an object's centre of mass [m/s]; zero of what never moves."""
        return self.qd(name)[..., :3] if self.moves(name) else np.zeros((self.count, len(self.time), 3))

    def centre(self, name: str) -> Floats:
        """Positions (W, T, 3) of a body's origin, or (3,) of a fixed object's middle [m]."""
        if self.moves(name):
            return self.q(name)[..., :3]
        prim = self.prim(name)
        for container in self.world.containers:
            if container.prim == prim:
                return np.array(container.inner_center, dtype=np.float64)
        for static in self.world.statics:
            if static.prim == prim:
                return np.mean([shape.position for shape in static.shapes], axis=0)
        raise MissingError(f"{name!r} is a fluid, which has no centre; name a body, a fixed object or a point")

    def centre_of_mass(self, i: int) -> Floats:
        """Positions (W, T, 3) of the centre of mass of body i [m]."""
        q = self.body_q[:, :, i].astype(np.float64)
        com = np.array(self.world.bodies[i].com, dtype=np.float64)
        return q[..., :3] + rotate(q[..., 3:], com) if com.any() else q[..., :3]

    def course(self, name: str) -> Course:
        """How a body's centre of mass goes, between frames too."""
        i = self.row(name)
        pull = np.zeros(3) if self.world.bodies[i].kinematic else np.array(self.world.gravity, dtype=np.float64)
        return Course(self.time, self.centre_of_mass(i), self.velocity(name), pull)

    def origin_course(self, name: str) -> Course:
        """How a body's origin goes, between frames too; of what stands still, its middle."""
        if not self.moves(name):
            place = np.broadcast_to(self.centre(name), (self.count, len(self.time), 3))
            return Course(self.time, place, np.zeros_like(place), np.zeros(3))
        course, qd = self.course(name), self.qd(name)
        place, velocity = self.centre(name), course.velocity
        if any(self.body(name).com):
            velocity = velocity + np.cross(qd[..., 3:], place - course.place)
        return Course(self.time, place, velocity, course.pull)

    def inertia_about(self, i: int, axes: Floats) -> Floats:
        """n . I n of body i about its centre of mass, (W, n) of axes n at the first frames (W, n, 3) [kg m^2 of n^2].

        A world with another mass has it at the same places: inertia goes with mass.
        """
        assert self.mass is not None
        body = self.world.bodies[i]
        inertia = np.array(body.inertia, dtype=np.float64).reshape(3, 3)
        if np.allclose(inertia, inertia[0, 0] * np.eye(3), rtol=1e-6, atol=1e-6 * inertia[0, 0]):
            own = inertia[0, 0] * np.einsum("wni,wni->wn", axes, axes)  # the same about every axis
        else:
            q = self.body_q[:, : axes.shape[1], i, 3:].astype(np.float64)
            own_axes = rotate(conjugate(q), axes)
            own = np.einsum("wni,wni->wn", own_axes @ inertia, own_axes)
        return np.asarray(own * (self.mass[:, [i]] / body.mass))

    # ---- frames one by one
    def frames(self, *names: str) -> Evidence:
        """The poses of the named bodies in all worlds' frames behind one another, (W * T,).

        For what looks at one frame at a time; `fold` gives its answers their world axis again.
        """
        prims = tuple(dict.fromkeys(self.prim(name) for name in names))
        if prims not in self._frames:
            rows = [i for i, body in enumerate(self.world.bodies) if body.prim in prims]
            q = self.body_q[:, :, rows].reshape(-1, len(rows), 7)
            self._frames[prims] = self.posed(rows, np.tile(self.time, self.count), q)
        return self._frames[prims]

    def posed(self, rows: list[int], time: Floats, q: NDArray[Any]) -> Evidence:
        """Some bodies at any poses, (N, len(rows), 7) at times (N,)."""
        return posed(self.world, rows, time, q)

    def fold(self, flat: NDArray[Any]) -> NDArray[Any]:
        """Answers (W * T, ...) with their world axis, (W, T, ...)."""
        return flat.reshape(self.count, len(self.time), *flat.shape[1:])

    def solid(self, name: str) -> Solid[Shape]:
        """A body's shapes."""
        return self.frames(name).solid(0)

    def ends(self, name: str) -> tuple[Floats, Floats]:
        """Height of a body's lowest and highest point, (W, T) each [m]."""
        low, high = self.frames(name).ends(0)
        return self.fold(low), self.fold(high)
