"""The law of contact, on MuJoCo's constraint rows.

A contact pushes, never pulls; its friction is at most mu times its push, against the slip where it slips (Coulomb);
bodies part with e times the speed at which they met (Newton's law of impact). MuJoCo minimises over the friction cones,
and there friction that may not exceed its cone buys push: a box that slides at v lifts off at mu v. What takes that
away is the correction of de Saxcé and Feng (1998): ask for a normal speed that is lower by mu times the slip at the
step's end. The slip is taken from the step's start, and again from each solution, until it stays. Where something
hits, the slip before says little of that after: it is taken from a solution without friction. A crate that a plough
shoves off slips on the floor and not on the plough; from rest, without any slip, the two would ask for a wedge.

What a row should reach stands in its reference acceleration, (target - velocity) / h, with an impedance near one.
A contact is a row before the surfaces touch: it may close its gap in the step and not more (Stewart and Trinkle 1996).
Where the two bounce, the step that ends farther below than it starts above is the one in which they meet; the speed
after the blow is that with which a body of the same acceleration comes back through the surface at e times its speed.
What MuJoCo's regularisation gives way under a blow is added to what is asked for, or each would lose 1e-4 of its speed.
Blows are impulses before the step, in rounds (`wsim.solvers.blows`), so that one goes through a row of bodies one by
one, as in Newton's cradle, and all keep their energy. Friction that turns a slip round
gives what surfaces stored: so much less is left of the rebound (`friction_pays` of `wsim.solvers.targets`).

What rolls is resisted by a torque of rho times its push, rho = C / (1/R1 + 1/R2): C is the pair's coefficient, R the
radii of the two surfaces where they touch, without end for a flat one (as discrete elements have it: Ai et al. 2011).
Surfaces that lose that much are pressed flat over a patch. Rolling takes 3/16 alpha a of the push as a torque, a the
patch's radius and alpha <= 1 the share of the work of pressing in that is lost (Johnson 1985, 9.2), and spinning about
the normal 3 pi/16 mu a (Lubkin 1951). So spinning is resisted by pi mu rho or more, and that is what is taken.

Sliding, spinning and rolling share one cone, an ellipsoid, and each is resisted in proportion to its own speed. For
sliding and spinning that is what a patch does, nearly (Howe and Cutkosky 1996). Rolling is not weakened by a push along
the surface in truth: here by the factor sqrt(1 - (F / mu N)^2).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from wsim.solvers.blows import BlowsC, Contacts
from wsim.solvers.breaking import BreakingC
from wsim.solvers.closing import ClosingC
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.contact_impulses import ContactImpulsesC
from wsim.solvers.contact_rows import ContactRows, weigh_rows
from wsim.solvers.cylinder_contacts import CylinderContacts, tilt_cylinders
from wsim.solvers.drives import DrivesC
from wsim.solvers.flight import Flight
from wsim.solvers.groups import mechanisms, tied_groups
from wsim.solvers.slips import seek_slip
from wsim.solvers.smooth_steps import REVERSAL_PARTS, Note, Owners, SmoothStepsC
from wsim.solvers.stops import StopsC
from wsim.solvers.surface_contacts import SurfaceContacts
from wsim.solvers.surfaces import Surfaces
from wsim.solvers.targets import first_meeting, targets
from wsim.solvers.tie_impulses import TieImpulsesC

Array = np.ndarray
MOST_MEETINGS = 8  # by which a step is parted
MEETS_AT_END = 1.0 / 64.0  # of a step: what meets so near its start or its end meets there
ON_END = math.sqrt(0.5)  # cosine between a cylinder's axis and the contact's normal, above which its flat end touches


class ContactLawC:
    """The law on MuJoCo's own data, one world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        flight: Steps the loose bodies.
        surfaces: Of the geoms of the one world.
        smooth: Whether mechanisms may go by Runge and Kutta's fourth order.
        config: How the law is applied.
        breaking: What breaks joints, if any may break.
        touching: Finds contacts with what MuJoCo does not know.
        cylinders: Finds those of cylinders.
        drives: The drives that damp, if there are any.
    """

    def __init__(
        self,
        mujoco: Any,
        model: Any,
        flight: Flight,
        surfaces: Surfaces,
        smooth: bool,
        config: ContactConfig,
        breaking: BreakingC | None = None,
        touching: SurfaceContacts | None = None,
        cylinders: CylinderContacts | None = None,
        drives: DrivesC | None = None,
    ) -> None:
        self.breaking, self.drives, self.flight = breaking, drives, flight
        self.impulses: ContactImpulsesC | None = None  # where somebody wants them summed
        self.ties: TieImpulsesC | None = None  # likewise
        self.told: Callable[[Any], None] | None = None  # looks at the contacts of each step that is solved
        self.mujoco, self.model, self.config, self.smooth = mujoco, model, config, smooth
        self.touching, self.cylinders, self._bow = touching, cylinders, np.zeros(0)
        self.classes, self.law, self.curvature = surfaces.classes[0], surfaces.law[0], surfaces.curvature[0]
        self.rolls = bool(self.law[..., 2].any())
        self.flat_ended = model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER
        rows = mujoco.mjtConstraint
        self.stops = StopsC(mujoco, model, config)
        touches = (rows.mjCNSTR_CONTACT_FRICTIONLESS, rows.mjCNSTR_CONTACT_ELLIPTIC)
        self._rubs = int(rows.mjCNSTR_FRICTION_DOF)
        self._jumping = np.zeros(len(rows.__members__), dtype=bool)  # of each kind of row
        self._jumping[[*self.stops.kinds, self._rubs, *map(int, touches)]] = True
        self._groups = tied_groups(mujoco, model)
        moves_as_one = np.zeros(model.nbody, dtype=int)
        if smooth:
            moves_as_one = mechanisms(mujoco, model, self._groups, flight.stated, driven=True)
        self.owners = Owners(mujoco, model, moves_as_one)
        self.closing = ClosingC(mujoco, model)
        self.smooth_steps = SmoothStepsC(mujoco, model, self.owners, drives, self.closing)
        self._stiff = drives is not None and bool(drives.stiff.any())
        self.blows = BlowsC(mujoco, model, config, self._aim_others, self._ends_of_stops)
        self._divides = touching is None and not flight.stated[1:].any()
        self._led = np.flatnonzero(flight.stated & (model.body_dofnum > 0))
        self._meeting = math.inf  # when surfaces of mechanisms meet that bounce, from the step's start [s]
        self._shared = False  # whether a blow may be shared with the next step
        self._turns = False  # whether friction on what is led round stops a slip in this step
        tilt_cylinders(mujoco, model)

    def step(self, data: Any) -> None:
        """Advance `data` by the model's time step, in parts where something changes within it."""
        h = self.model.opt.timestep
        try:
            self._advance(data, h, MOST_MEETINGS)
        finally:
            self.model.opt.timestep = h

    def _advance(self, data: Any, h: float, meetings: int) -> None:
        """Advance by `h` [s]: parted where surfaces of mechanisms meet and bounce, so many times at most, and in equal
        parts where one that is hit or pressed whirls, or a slip on what is led to and fro turns round."""
        self.model.opt.timestep = h
        touching = self._begin(data)
        until = self._meeting if meetings and self._divides else h
        if MEETS_AT_END * h < until < (1.0 - MEETS_AT_END) * h:
            self._undo(data)
            self._advance(data, until, 0)
            self.flight.keep()
            self._advance(data, h - until, meetings - 1)
            return
        parts = self._parts(data)
        if parts == 1:
            self._end(data, touching)
            return
        self.blows.undo(data)
        self.model.opt.timestep = h / parts
        for _ in range(parts):
            self.flight.keep()
            self._end(data, self._begin(data))

    def _begin(self, data: Any) -> bool:
        """The blows of a step and the accelerations after them; whether a contact, a stop or dry friction may be among
        their causes."""
        self.mujoco.mj_checkPos(self.model, data)
        self.mujoco.mj_checkVel(self.model, data)
        touching = self._forward(data)
        if self.breaking is not None:
            touching = self._break(data, self.breaking, touching)
        time = data.time
        self.mujoco.mj_checkAcc(self.model, data)
        if data.time < time:  # no numbers, of which it has a warning: MuJoCo has begun the world anew, with other rows
            self.blows.begin()
        return touching

    def _break(self, data: Any, breaking: BreakingC, touching: bool) -> bool:
        """Have joints break by what they bear in the step and by whole blows, and make it without them."""
        while breaking.give_way(data, self.blows.loads(data)):
            self._undo(data)
            touching = self._forward(data)
        if self._shared:
            self._undo(data)
            self._answer(data, touching)
        return touching

    def _undo(self, data: Any) -> None:
        self.blows.undo(data)
        self.flight.keep()

    def _parts(self, data: Any) -> int:
        """In how many parts a step is made, that of a mechanism which is hit, or which a contact presses.

        What whirls changes the force that it is pressed with within the step. What goes as stated, and meshes, are
        found once a step. Likewise where a slip ends on what is led and gains speed meanwhile: friction that is not
        enough to hold it would do so to the step's end.
        """
        if self._turns:
            return REVERSAL_PARTS
        if not self._divides or self.owners.count == 1:
            return 1
        force = self.blows.forces_after(data)
        which = self.owners.with_motion(self.blows.jump) | self.smooth_steps.pressed(data, force)
        return self.smooth_steps.parts(data, which)

    def _end(self, data: Any, touching: bool) -> None:
        """Move by the time step."""
        model = self.model
        whole = self._is_whole(touching)
        force = self.blows.forces_after(data)
        smooth, pushed = self.smooth_steps.choose(data, whole, force)
        struck = self.owners.with_motion(self.blows.jump)
        # Rows that close a loop ask that a speed be gone by the step's end, as the first order has it; of what they
        # then push with at its start Runge and Kutta's stages give 5/8, and that is not what is recorded.
        smooth &= ~(struck & self.owners.closed)
        rate = data.qacc - self.blows.jump / model.opt.timestep
        parts = max(self.smooth_steps.parts(data, smooth), self.smooth_steps.parts_of_reversal(data, rate, smooth))
        held = self.smooth_steps.rubbed(data) | self.smooth_steps.stopped(data, force)
        uneven = pushed | struck | held | (len(self._led) > 0)
        note = self._tell_ties(data, force, (smooth, smooth & ~uneven), struck, parts)
        self.blows.take_from(data)
        if whole and parts == 1:
            self.smooth_steps.step(data, note)
        else:
            if smooth.any():
                self.smooth_steps.make(data, force, pushed, parts, note)
            if whole:
                data.time += model.opt.timestep
            else:
                self._implicit(data)
                if self.impulses is not None:
                    self.impulses.add(data, model.opt.timestep)
                if self.told is not None:
                    self.told(data)
                self.flight.fly(model.opt.timestep)
            if smooth.any():
                self.smooth_steps.take(data, smooth)
        if model.nu:
            self._tell_efforts(data)

    def _tell_ties(
        self, data: Any, force: Array, smooth: tuple[Array, Array], struck: Array, parts: int
    ) -> Note | None:
        """Record what ties give, but for that which is left to whom it returns: what they give in smooth steps of which
        all is recorded by itself. Smooth are some mechanisms, and of these some by the forces of this start alone."""
        ties = self.ties
        if ties is None:
            return None
        h, (any_way, evenly) = self.model.opt.timestep, smooth
        goes_on = ties.goes_on(data, evenly)
        alone = any_way if parts > 1 else any_way & ~goes_on
        ties.add(data, h * (~alone | struck), evenly, goes_on)
        if (alone & struck).any():  # of what they gave the blow alone
            both, acceleration = data.efc_force.copy(), data.qacc.copy()
            data.efc_force[:] = force
            self.blows.take_from(data)
            ties.add(data, -h * (alone & struck))
            data.efc_force[:], data.qacc[:] = both, acceleration
        if not alone.any():
            return None
        return lambda beside, span, held: ties.add(beside, span * alone, held=held)

    def _is_whole(self, touching: bool) -> bool:
        """Whether all of the world goes by the fourth order, without a row of contacts, stops, friction or drives."""
        return self.smooth and not touching and not self._stiff

    def _forward(self, data: Any) -> bool:
        """The blows of the step, and accelerations after them; whether a contact, a stop or dry friction may be among
        their causes."""
        self._position(data)
        self.closing.begin(data)
        touching = bool(self._jumping[data.efc_type].any())
        if self.drives is not None:
            self.drives.choose(data, are_rows=not self._is_whole(touching))
        self._answer(data, touching, at_once=self.breaking is not None)
        return touching

    def _answer(self, data: Any, touching: bool, at_once: bool = False) -> None:
        """The blows and the accelerations; `at_once` those by which joints break, of blows that are not shared with the
        next step. Notes whether any would be."""
        self.blows.begin()
        self._turns, self._shared, self._meeting, self.stops.at_once = False, False, math.inf, at_once
        self._accelerate(data, touching)
        contacts = self._contacts(data)
        if contacts is None:
            self.stops.at_once = False
            self._aim_others(data)
            self.mujoco.mj_fwdConstraint(self.model, data)
            return
        rows = self.blows.rows(data, contacts)
        self._meeting = self._first_meeting(data, contacts, rows)
        if self.blows.strike(data, contacts, rows, partial(self._flies_smoothly, contacts.bodies), at_once):
            self._shared = at_once
            self.flight.keep()
            self._accelerate(data, touching)
            rows = self.blows.rows(data, contacts)
        self.stops.at_once = False
        self._solve_contacts(data, contacts, rows)
        self.blows.add_to(data)

    def _accelerate(self, data: Any, touching: bool) -> None:
        """Accelerations without constraints, at the present velocities."""
        mujoco, model = self.mujoco, self.model
        mujoco.mj_fwdVelocity(model, data)
        if not self._is_whole(touching):
            self.flight.tumble(model.opt.timestep)
        mujoco.mj_fwdActuation(model, data)
        if self.drives is not None:
            self.drives.take_over(data)
        mujoco.mj_fwdAcceleration(model, data)

    def _implicit(self, data: Any) -> None:
        """The step of the first order. Of drives' damping it knows already: their rows were solved with it."""
        off = int(self.mujoco.mjtDisableBit.mjDSBL_ACTUATION) if self.drives is not None else 0
        self.model.opt.disableflags |= off
        self.mujoco.mj_implicit(self.model, data)
        self.model.opt.disableflags &= ~off

    def _position(self, data: Any) -> None:
        """What hangs on the pose, contacts that MuJoCo does not find among it."""
        mujoco, model = self.mujoco, self.model
        if self.touching is None and self.cylinders is None:
            mujoco.mj_fwdPosition(model, data)
            self._bow = np.zeros(data.ncon)
            return
        mujoco.mj_fwdKinematics(model, data)
        mujoco.mj_makeM(model, data)
        mujoco.mj_factorM(model, data)
        mujoco.mj_collision(model, data)
        if self.cylinders is not None:
            self.cylinders.add_to_c(mujoco, model, data)
        self._bow = self.touching.add_to_c(mujoco, model, data) if self.touching else np.zeros(data.ncon)
        mujoco.mj_makeConstraint(model, data)
        mujoco.mj_island(model, data)
        mujoco.mj_transmission(model, data)
        mujoco.mj_projectConstraint(model, data)

    def _tell_efforts(self, data: Any) -> None:
        """What the drives give at the step's end, which the books need, whichever way the step was made."""
        mujoco, model = self.mujoco, self.model
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_transmission(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)

    def _aim_others(self, data: Any) -> None:
        """Ask what is no contact for the speeds that it should have."""
        self.stops.aim(data)
        self.closing.aim(data)
        rubbing = np.flatnonzero(data.efc_type == self._rubs)
        data.efc_aref[rubbing] = -data.efc_vel[rubbing] / self.model.opt.timestep

    def _ends_of_stops(self, data: Any) -> Array:
        """By how much joints of mechanisms approach their stops too fast to reach them by the step's end, (rows,)."""
        return self.stops.ends(data, self.smooth_steps.stops(data))

    def _contacts(self, data: Any) -> Contacts | None:
        """The contacts that have rows, if there are any, or none that something else is hit beside."""
        chosen = np.flatnonzero(data.contact.efc_address[: data.ncon] >= 0)
        if not len(chosen) and not self.blows.meets_stops(data):
            return None
        geoms = data.contact.geom[chosen]
        classes = self.classes[geoms]
        law = self.law[classes[:, 0], classes[:, 1]]
        friction = self._coefficients(data, chosen, geoms, law)
        if self.rolls:
            weigh_rows(data, data.contact.efc_address[chosen], data.contact.dim[chosen], friction)
        bodies, distance = self.model.geom_bodyid[geoms], data.contact.dist[chosen]
        return Contacts(chosen, bodies, friction, law[:, 1], distance, self._bow[chosen])

    def _first_meeting(self, data: Any, contacts: Contacts, rows: ContactRows) -> float:
        """When surfaces of mechanisms first meet that bounce, from the step's start [s]."""
        meets = (self.owners.of_body[contacts.bodies] > 0).any(axis=1) & (contacts.restitution > 0.0)
        if not meets.any():
            return math.inf
        speed = (data.efc_vel[rows.normal] + contacts.bow)[meets]
        return first_meeting(
            contacts.distance[meets], speed, rows.pull()[meets], self.config.threshold * self.model.opt.timestep
        )

    def _flies_smoothly(self, bodies: Array, speed: Array, free: Array) -> Array:
        """Whether what meets at these speeds has not gone by the first order all the fall, (contacts,)."""
        since = self.flight.since_exact(bodies)
        if self.smooth:
            since = np.minimum(since, self.smooth_steps.since[self.owners.of_body[bodies]])
        return np.asarray(since.max(axis=1) * np.abs(free) * self.model.opt.timestep < np.abs(speed))

    def _solve_contacts(self, data: Any, contacts: Contacts, rows: ContactRows) -> None:
        """Constraint forces after the blows, with the slip that they leave."""
        self._aim_others(data)
        h, config = self.model.opt.timestep, self.config
        speed = data.efc_vel[rows.normal] + contacts.bow
        goal = targets(contacts.distance, speed, contacts.restitution, h, config)
        rows.aim(goal + contacts.bow, np.zeros(len(goal), dtype=bool))
        seek_slip(rows.left, rows.slip, contacts.bodies, False, config, (config.lasting, config.lasting))
        if len(self._led) and self.touching is None:
            first = self.model.body_dofadr[self._led]
            hurries = data.qfrc_applied[first[:, None] + np.arange(6)].any(axis=1)
            self._turns = bool((rows.stops() & np.isin(contacts.bodies, self._led[hurries]).any(axis=1)).any())

    def _coefficients(self, data: Any, chosen: Array, geoms: Array, law: Array) -> Array:
        """Of the rows of friction, (contacts, 5): two of sliding, one of spinning [m], two of rolling [m]."""
        slide, roll = law[:, 0], np.zeros(len(geoms))
        least = np.full(len(geoms), self.config.smallest_friction)
        if self.rolls:
            axes = data.geom_xmat[geoms].reshape(-1, 2, 3, 3)[..., 2]
            leans = np.abs(np.einsum("nsi,ni->ns", axes, data.contact.frame[chosen, :3]))
            on_end = self.flat_ended[geoms] & (leans > ON_END)
            bend = np.where(on_end, 0.0, self.curvature[geoms]).sum(axis=1)
            np.divide(law[:, 2], bend, out=roll, where=bend > 0.0)
            least /= np.maximum(bend, 1.0)  # of the radius: what is small rolls as freely
        spin = np.maximum(math.pi * slide * roll, least)
        slide, roll = np.maximum(slide, self.config.smallest_friction), np.maximum(roll, least)
        return np.stack([slide, slide, spin, roll, roll], axis=1)
