"""What joints, springs and ropes give the bodies that they tie, summed over the steps of a frame.

What a joint passes on follows from the equations of motion of all that hangs on it: the rates of its momenta, less
gravity, contacts, constraints and cords, at the accelerations that the step was solved for (Featherstone, *Rigid Body
Dynamics Algorithms*, 2008, section 5.3). What acts along the joint's own motion is read from the solver beside it, so
that the two can be held against each other.

A step of the first order has the forces of its start. One of Runge and Kutta's has them change: their mean is that of
its start and its end, which is the next step's start, or where there is none goes on as it came. Where it did not come
so either, after a blow or once something was set from outside, its own end is looked at (`goes_on`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.recording.ties import CORD_WIDTH, JOINT_WIDTH

Array = np.ndarray
WORLD = 0  # MuJoCo's body
BATCH_BYTES = 4 * 1024 * 1024  # of steps that wait to be summed: of a single frame NumPy would take half a step's time


@dataclass(frozen=True)
class TiedJoint:
    """A joint under MuJoCo's numbers."""

    parent: int  # body; 0 is the world
    child: int
    anchor: Array  # (3,) in the child's frame [m]
    axis: Array  # (3,) of its own motion, in the child's frame; zeros where it has none of its own
    slides: bool = False
    joint: int = -1  # MuJoCo's joint with that motion
    equalities: tuple[int, ...] = ()  # what holds it, where it is none of the tree's


@dataclass(frozen=True)
class TiedCord:
    """A spring or a rope under MuJoCo's numbers."""

    tendon: int
    bodies: tuple[int, ...]  # what it pulls, in the order of a recording's rows


@dataclass(frozen=True)
class _Step:
    """What is kept of a step's start, or of an instant of it."""

    starts: bool
    smooth: Array  # whether the step of a joint or a cord is one of Runge and Kutta's, (joints + ends,)
    goes_on: Array  # and starts as the step before has ended, likewise
    span: Array  # for which it counts there, likewise [s]
    state: Array  # what does not change its size, one after another
    rows: tuple[Array, ...]  # of the constraints: kind, number, force, place


@dataclass
class _Frame:
    """The kept steps of a frame, S of them."""

    smooth: Array
    goes_on: Array
    span: Array
    starts: Array  # which are steps' starts
    parts: dict[str, Array]
    step: Array  # of each constraint row
    kind: Array
    id: Array
    force: Array
    place: Array

    def of(self, name: str, *shape: int) -> Array:
        """A part of the kept state, (S, bodies or the like, *shape)."""
        return self.parts[name].reshape(len(self.smooth), -1, *shape)


class TieSumsLater:
    """Sums of one frame (`wsim.recording.ties.TieSums`), made with those of others once somebody asks for them."""

    def __init__(self, make: Callable[[], None]) -> None:
        self._make, self._made = make, (np.zeros(0), np.zeros(0))
        self._is_made = False

    def tell(self, joints: Array, cords: Array) -> None:
        """Keep what was made."""
        self._made, self._is_made = (joints.astype(np.float32), cords.astype(np.float32)), True

    @property
    def joints(self) -> Array:
        """(J, JOINT_WIDTH)."""
        return self._parts()[0]

    @property
    def cords(self) -> Array:
        """(K, CORD_WIDTH)."""
        return self._parts()[1]

    def _parts(self) -> tuple[Array, Array]:
        if not self._is_made:
            self._make()
        return self._made


class TieImpulsesC:
    """One world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        joints: As a recording counts them.
        cords: Likewise.
        mechanism: Of each body (`wsim.solvers.groups.mechanisms`).
    """

    OF_BODIES = ("cfrc_int", "subtree_com", "xipos", "xpos", "xquat", "qpos", "qfrc_actuator", "qfrc_applied")
    OF_CORDS = ("ten_length", "ten_velocity", "wrap_xpos", "wrap_obj", "ten_wrapnum")

    def __init__(
        self, mujoco: Any, model: Any, joints: Sequence[TiedJoint], cords: Sequence[TiedCord], mechanism: Array
    ) -> None:
        self._mujoco, self._model, self._joints, self._cords = mujoco, model, joints, cords
        tied = [(joint.child, joint.parent) for joint in joints] + [cord.bodies for cord in cords for _ in cord.bodies]
        self._mechanism = np.array([mechanism[list(bodies)].max(initial=0) for bodies in tied], dtype=int)
        self._widths = [JOINT_WIDTH] * len(joints) + [CORD_WIDTH] * (len(tied) - len(joints))
        self._parts = self.OF_BODIES + (self.OF_CORDS if cords else ())
        self._sizes: list[int] = []  # of these
        self._kept: list[_Step] = []
        self._frames: list[tuple[int, TieSumsLater]] = []  # that wait: where their steps end
        self._before: Array | None = None  # what joints and cords gave at the last step's start; NaN where not smooth
        self._goes: Array | None = None  # of the last step: mechanisms that were smooth, (mechanisms,)
        self._told: Array | None = None  # likewise: how many constraints held what moves, and what was set from outside
        kinds, types = mujoco.mjtConstraint, mujoco.mjtEq
        self._equality, self._rubs = int(kinds.mjCNSTR_EQUALITY), int(kinds.mjCNSTR_FRICTION_DOF)
        self._drives, self._taut = int(kinds.mjCNSTR_FRICTION_TENDON), int(kinds.mjCNSTR_LIMIT_TENDON)
        self._stops = int(kinds.mjCNSTR_LIMIT_JOINT)
        self._touches = int(kinds.mjCNSTR_CONTACT_FRICTIONLESS)  # the first of the kinds of contacts
        self._weld, self._gear = int(types.mjEQ_WELD), int(types.mjEQ_JOINT)
        sites = [int(model.site_bodyid[k]) if kind == mujoco.mjtWrap.mjWRAP_SITE else -1
                 for kind, k in zip(model.wrap_type, model.wrap_objid, strict=True)]  # fmt: skip
        self._sites = [
            [body for body in sites[first : first + count] if body >= 0]
            for first, count in zip(model.tendon_adr, model.tendon_num, strict=True)
        ]

    # ---- step by step
    def goes_on(self, data: Any, smooth: Array) -> Array:
        """Mechanisms that go on in this step as they came in the last one, of those that are `smooth`, (mechanisms,).

        Of the others the force at a step's end is not told by those of its start and of the step before: that was none
        of Runge and Kutta's, or something was set from outside since, or broke, or its length is another.

        Args:
            data: MuJoCo's, of a step's start.
            smooth: Mechanisms that go by the fourth order, and that nothing strikes, presses or drags.
        """
        # Contacts that push a mechanism are known to whoever says what is smooth; those of others are no affair of it.
        held = np.count_nonzero(data.efc_type < self._touches)
        told = np.concatenate(
            [[held, self._model.opt.timestep], data.ctrl, data.qfrc_applied, data.xfrc_applied.ravel()]
        )
        same = self._told is not None and np.array_equal(told, self._told)
        before = self._goes if same and self._goes is not None else np.zeros(len(smooth), dtype=bool)
        self._told, self._goes = told, smooth.copy()
        return smooth & before

    def add(
        self,
        data: Any,
        span: Array,
        smooth: Array | None = None,
        goes_on: Array | None = None,
        held: Sequence[Array] = (),
    ) -> None:
        """Keep what acts in a step, once it is solved and before it is made, or at an instant of it.

        Args:
            data: MuJoCo's.
            span: For which it counts, of each mechanism, (mechanisms,) [s]; less than none takes it back.
            smooth: At a step's start: those that go on from it by Runge and Kutta's, with its forces, (mechanisms,).
            goes_on: Those of them that were so in the step before, which ended with these forces, (mechanisms,).
            held: Rows that act beside those of `data`: kind, number, force, place.
        """
        self._mujoco.mj_rnePostConstraint(self._model, data)
        views = [getattr(data, name).ravel() for name in self._parts]  # not copied
        self._sizes = [len(view) for view in views]
        rows: tuple[Array, ...] = ()
        own, starts = self._mechanism, smooth is not None
        none = np.zeros(len(span), dtype=bool)
        smooth, goes_on = none if smooth is None else smooth, none if goes_on is None else goes_on
        if data.nefc:
            rows = tuple(array.copy() for array in (data.efc_type, data.efc_id, data.efc_force, data.efc_pos))
        if len(held) and len(held[0]):
            rows = tuple(np.concatenate(both) for both in zip(rows, held, strict=True)) if rows else tuple(held)
        self._kept.append(_Step(starts, smooth[own], goes_on[own], span[own], np.concatenate(views), rows))

    def take(self) -> TieSumsLater:
        """The sums since the last call, which start anew."""
        later = TieSumsLater(self._sum)
        self._frames.append((len(self._kept), later))
        if self._kept and len(self._kept) * self._kept[-1].state.nbytes > BATCH_BYTES:
            self._sum()
        return later

    def clear(self) -> None:
        """Forget the sums: the run starts anew."""
        self._kept, self._frames, self._before, self._told, self._goes = [], [], None, None, None

    def _sum(self) -> None:
        """Make the sums of all frames that wait."""
        kept, frames, joints = self._kept, self._frames, len(self._joints)
        ends = sum(len(cord.bodies) for cord in self._cords)
        last = frames[-1][0]
        self._kept, self._frames = kept[last:], []
        width = joints * JOINT_WIDTH
        total = np.zeros((1, width + ends * CORD_WIDTH))
        if last:
            frame = self._frame(kept[:last])
            parts = [part.reshape(last, -1) for part in (self._of_joints(frame), self._of_cords(frame))]
            given = self._means(np.concatenate(parts, axis=1), frame)
            total = np.concatenate([total, np.cumsum(given, axis=0)])
        start = 0
        for end, later in frames:
            sums, start = total[end] - total[start], end
            later.tell(sums[:width].reshape(joints, JOINT_WIDTH), sums[width:].reshape(ends, CORD_WIDTH))

    def _means(self, acting: Array, frame: _Frame) -> Array:
        """Impulses of each step by what acts at its start, or of what acts in its midst for a while, (S, n)."""
        span, smooth, goes_on = (
            np.repeat(array, self._widths, axis=1) for array in (frame.span, frame.smooth, frame.goes_on)
        )
        found = span * acting
        starts = frame.starts
        smooth, acting, none = smooth[starts], acting[starts], np.full(acting.shape[1], np.nan)
        known = np.where(smooth, acting, np.nan)
        before = np.concatenate([[none if self._before is None else self._before], known[:-1]])
        follows = np.concatenate([np.where(goes_on[starts][1:], acting[1:], np.nan), [none]])
        after = np.where(np.isnan(follows), 2.0 * acting - before, follows)
        after = np.where(np.isnan(after), acting, after)  # of a step that is looked at by itself
        self._before = known[-1]
        found[starts] = np.where(smooth, 0.5 * span[starts] * (acting + after), found[starts])
        return found

    def _frame(self, kept: list[_Step]) -> _Frame:
        values, at, parts = np.stack([step.state for step in kept]), 0, {}
        for name, size in zip(self._parts, self._sizes, strict=True):
            parts[name] = values[:, at : at + size]
            at += size
        steps = [(k, step.rows) for k, step in enumerate(kept) if step.rows]
        if steps:
            columns = [np.concatenate(column) for column in zip(*(rows for _, rows in steps), strict=True)]
        else:
            columns = [np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0), np.zeros(0)]
        starts = np.flatnonzero([step.starts for step in kept])
        number = np.repeat([k for k, _ in steps], [len(rows[0]) for _, rows in steps]).astype(int)
        smooth, goes_on, span = (
            np.array([getattr(step, name) for step in kept]) for name in ("smooth", "goes_on", "span")
        )
        return _Frame(smooth, goes_on, span, starts, parts, number, *columns)

    # ---- cords
    def _of_cords(self, frame: _Frame) -> Array:
        """What each cord gives each body that it pulls, (S, ends, CORD_WIDTH)."""
        center, found = frame.of("xipos", 3), []
        for cord in self._cords:
            tension = self._tension(frame, cord.tendon)
            pull = tension[:, None, None] * self._unit_pull(frame, cord.tendon)
            for body in cord.bodies:
                push = pull[:, body, :3]
                turn = pull[:, body, 3:] - np.cross(center[:, body], push)
                found.append(np.concatenate([push, turn, tension[:, None]], axis=1))
        return np.stack(found, axis=1) if found else np.zeros((len(frame.smooth), 0, CORD_WIDTH))

    def _tension(self, frame: _Frame, tendon: int) -> Array:
        """A spring's by its law, a rope's by its row, (S,) [N]."""
        model = self._model
        stretch = frame.parts["ten_length"][:, tendon] - model.tendon_lengthspring[tendon, 1]
        found: Array = model.tendon_stiffness[tendon] * stretch
        found = found + model.tendon_damping[tendon] * frame.parts["ten_velocity"][:, tendon]
        return found + self._summed(frame, self._taut, tendon)

    def _unit_pull(self, frame: _Frame, tendon: int) -> Array:
        """Of a tension of one on all bodies, torques about the world's origin, (S, bodies, 6)."""
        model, parts, count = self._model, frame.parts, len(frame.smooth)
        found = np.zeros((count, model.nbody, 6))
        number = parts["ten_wrapnum"][:, tendon].astype(int)
        first = parts["ten_wrapnum"][:, :tendon].sum(axis=1).astype(int)
        points, objects = frame.of("wrap_xpos", 3), frame.of("wrap_obj").astype(int)
        ways, which = np.unique(np.c_[first, number, objects], axis=0, return_inverse=True)
        for k, (start, stops, *geoms) in enumerate(ways.tolist()):
            steps, way = np.flatnonzero(which.ravel() == k), geoms[start : start + stops]
            sites = iter(self._sites[tendon])
            bodies = [int(model.geom_bodyid[geom]) if geom >= 0 else next(sites) for geom in way]
            at = points[steps, start : start + stops]
            along = np.diff(at, axis=1)
            along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
            for n, (one, two) in enumerate(pairwise(bodies)):
                if one == two:
                    continue
                for body, place, pull in ((one, at[:, n], along[:, n]), (two, at[:, n + 1], -along[:, n])):
                    found[steps, body] += np.concatenate([pull, np.cross(place, pull)], axis=1)
        return found

    # ---- joints
    def _of_joints(self, frame: _Frame) -> Array:
        """What each joint gives, (S, joints, JOINT_WIDTH)."""
        model, center, place, turned = self._model, frame.of("xipos", 3), frame.of("xpos", 3), _turns(frame)
        passed = self._passed(frame)
        found = np.zeros((len(frame.smooth), len(self._joints), JOINT_WIDTH))
        for n, joint in enumerate(self._joints):
            if joint.equalities:
                wrench = self._held(frame, joint)
            elif model.body_parentid[joint.child] == joint.parent:
                wrench = passed[:, joint.child]
            else:  # it hangs the other way round
                wrench = -passed[:, joint.parent]
            push, turn = wrench[:, :3], wrench[:, 3:]
            own = turned[:, joint.child]
            axis = rotate(own, joint.axis[None])
            about = turn - np.cross(place[:, joint.child] + rotate(own, joint.anchor[None]), push)
            row = found[:, n]
            row[:, :3] = push
            row[:, 3:6] = np.cross(center[:, joint.parent], push) - turn if joint.parent != WORLD else 0.0
            row[:, 6:9] = turn - np.cross(center[:, joint.child], push)
            row[:, 9:12] = about
            row[:, 12] = np.einsum("si,si->s", push if joint.slides else about, axis)
            if joint.joint >= 0:
                row[:, 13:] = self._efforts(frame, joint)
        return found

    def _passed(self, frame: _Frame) -> Array:
        """What each body's joint gives it, torques about the world's origin, (S, bodies, 6)."""
        inner = frame.of("cfrc_int", 6)
        about, push = frame.of("subtree_com", 3)[:, self._model.body_rootid], inner[..., 3:]
        return np.concatenate([push, inner[..., :3] + np.cross(about, push)], axis=2)

    def _held(self, frame: _Frame, joint: TiedJoint) -> Array:
        """What a joint that is a constraint gives its child, torque about the world's origin, (S, 6)."""
        model, place, turned = self._model, frame.of("xpos", 3), _turns(frame)
        found = np.zeros((len(frame.smooth), 6))
        for eq in joint.equalities:
            weld = model.eq_type[eq] == self._weld
            rows = np.flatnonzero((frame.kind == self._equality) & (frame.id == eq)).reshape(-1, 6 if weld else 3)
            if not len(rows):
                continue  # it is broken
            steps, force = frame.step[rows[:, 0]], frame.force[rows]
            first = bool(model.eq_obj1id[eq] == joint.child)
            own = model.eq_data[eq, :3] if first != weld else model.eq_data[eq, 3:6]
            at = place[steps, joint.child] + rotate(turned[steps, joint.child], own[None])
            turn = np.cross(at, force[:, :3])
            if weld:
                turn += self._weld_torque(turned[steps], eq, force[:, 3:])
            found[steps] += (1.0 if first else -1.0) * np.concatenate([force[:, :3], turn], axis=1)
        return found

    def _weld_torque(self, turned: Array, eq: int, force: Array) -> Array:
        """On a weld's first body, (n, 3): its last rows are the vector part of a quaternion, half an angle."""
        model, one, two = self._model, self._model.eq_obj1id[eq], self._model.eq_obj2id[eq]
        target = multiply(turned[:, one], np.tile(model.eq_data[eq, [7, 8, 9, 6]], (len(force), 1)))
        spun = multiply(turned[:, two], np.concatenate([force, np.zeros((len(force), 1))], axis=1))
        return np.asarray(0.5 * model.eq_data[eq, 10] * multiply(spun, conjugate(target))[:, :3])

    def _efforts(self, frame: _Frame, joint: TiedJoint) -> Array:
        """Along the joint's own motion: of drive and control, dry friction, stops and gears, (S, 4)."""
        model = self._model
        dof = int(model.jnt_dofadr[joint.joint])
        way = 1.0 if model.jnt_axis[joint.joint] @ joint.axis > 0.0 else -1.0
        if model.jnt_bodyid[joint.joint] != joint.child:
            way = -way
        drive = frame.parts["qfrc_actuator"][:, dof] + frame.parts["qfrc_applied"][:, dof]
        for tendon in range(model.ntendon):
            first = model.tendon_adr[tendon]
            if model.wrap_type[first] == self._mujoco.mjtWrap.mjWRAP_JOINT and model.wrap_objid[first] == joint.joint:
                drive = drive + self._summed(frame, self._drives, tendon)
        gear = np.zeros(len(frame.smooth))
        for eq in np.flatnonzero(model.eq_type == self._gear).tolist():
            force = self._summed(frame, self._equality, eq)
            if model.eq_obj1id[eq] == joint.joint:
                gear += force
            elif model.eq_obj2id[eq] == joint.joint:
                gear -= model.eq_data[eq, 1] * force
        rubs = self._summed(frame, self._rubs, dof)
        return way * np.stack([drive, rubs, self._stopped(frame, joint.joint), gear], axis=1)

    def _stopped(self, frame: _Frame, joint: int) -> Array:
        """What a joint's stops give along MuJoCo's axis, (S,)."""
        rows = np.flatnonzero((frame.kind == self._stops) & (frame.id == joint))
        found = np.zeros(len(frame.smooth))
        if len(rows):
            low, high = self._model.jnt_range[joint]
            at = frame.parts["qpos"][frame.step[rows], self._model.jnt_qposadr[joint]]
            lower = np.abs(at - low - frame.place[rows]) < np.abs(high - at - frame.place[rows])
            np.add.at(found, frame.step[rows], np.where(lower, frame.force[rows], -frame.force[rows]))
        return found

    @staticmethod
    def _summed(frame: _Frame, kind: int, number: int) -> Array:
        """The forces of the rows of a kind and a number, (S,)."""
        rows = (frame.kind == kind) & (frame.id == number)
        return np.bincount(frame.step[rows], frame.force[rows], minlength=len(frame.smooth))


def _turns(frame: _Frame) -> Array:
    """How bodies are turned, xyzw, (S, bodies, 4)."""
    return frame.of("xquat", 4)[..., [1, 2, 3, 0]]
