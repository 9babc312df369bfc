"""Faults of the solver: the stage is as it should be, and is simulated wrongly."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.judge_worlds.tamper import Tamper, row, set_twist, twist


def _geoms(simulation: Any, name: str) -> list[int]:
    """MuJoCo's geoms of an object, body or static, by the label of Newton's shapes."""
    labels = [str(label) for label in simulation.model.shape_label]
    shapes = simulation.rigid.solver.mjc_geom_to_newton_shape.numpy()[0]
    return [g for g, shape in enumerate(shapes) if shape >= 0 and labels[shape].startswith(f"/World/{name}/")]


def _mujoco_body(simulation: Any, name: str) -> int:
    return int(simulation.rigid.solver.mj_model.geom_bodyid[_geoms(simulation, name)[0]])


@dataclass
class Gravity(Tamper):
    """Gravity is stronger or weaker than the stage says."""

    factor: float

    def prepare(self, simulation: Any) -> None:
        """Scale MuJoCo's gravity."""
        simulation.rigid.solver.mj_model.opt.gravity[:] *= self.factor


@dataclass
class Mass(Tamper):
    """A body has another mass than the stage says."""

    name: str
    factor: float

    def prepare(self, simulation: Any) -> None:
        """Scale mass and inertia."""
        model, body = simulation.rigid.solver.mj_model, _mujoco_body(simulation, self.name)
        model.body_mass[body] *= self.factor
        model.body_inertia[body] *= self.factor
        import mujoco

        mujoco.mj_setConst(model, simulation.rigid.solver.mj_data)


@dataclass
class Friction(Tamper):
    """Contacts rub more or less than the materials do."""

    factor: float

    def prepare(self, simulation: Any) -> None:
        """Scale the sliding friction of every pair."""
        simulation.rigid.solver._law_c.law[..., 0] *= self.factor


@dataclass
class SoftContacts(Tamper):
    """Contacts are so soft that bodies sink into each other."""

    impedance: float  # of 1, where contacts let nothing in

    def prepare(self, simulation: Any) -> None:
        """Let contacts give way: a body at rest is g h times their settling time deep, (1 - d) / d times."""
        simulation.rigid.solver.mj_model.geom_solimp[:, :2] = self.impedance


@dataclass
class NoContact(Tamper):
    """From some time on, or for some time, an object touches nothing."""

    name: str
    start: float = 0.0  # [s]
    end: float = math.inf  # [s]
    kept: dict[int, tuple[int, int]] = field(default_factory=dict, repr=False)  # what its geoms collide with

    def stepped(self, simulation: Any) -> None:
        """Take the object out of the collisions once it is time, and put it back."""
        off = self.start <= simulation.time < self.end
        if off == bool(self.kept):
            return
        model = simulation.rigid.solver.mj_model
        for geom in _geoms(simulation, self.name):
            if off:
                self.kept[geom] = int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])
            model.geom_contype[geom], model.geom_conaffinity[geom] = (0, 0) if off else self.kept.pop(geom)


@dataclass
class GainEnergy(Tamper):
    """The bodies gain (or lose) energy from nowhere: their speed grows by `rate` of itself a second."""

    rate: float  # [1/s]

    def stepped(self, simulation: Any) -> None:
        """Scale all velocities."""
        set_twist(simulation, simulation.state.body_qd.numpy() * (1.0 + self.rate * simulation.dt))


@dataclass
class Bounce(Tamper):
    """A body leaves what it lands on at `factor` of the speed at which it came."""

    name: str
    factor: float
    fell: float = field(default=0.0, repr=False)  # the greatest speed of the present fall [m/s]
    before: float = field(default=0.0, repr=False)

    def stepped(self, simulation: Any) -> None:
        """Wait until a rebound is over, then set the speed."""
        twists, k = twist(simulation, self.name)
        up = float(twists[k, 2])
        self.fell = max(self.fell, -up)
        if self.fell > 0.3 and 0.0 < up < self.before:  # it rises, and slows down again: nothing pushes any more
            twists[k, 2] = self.factor * self.fell
            set_twist(simulation, twists)
            self.fell = 0.0
        self.before = up


@dataclass
class Brake(Tamper):
    """A body is slowed down by nothing that is there."""

    name: str
    deceleration: float  # [m/s^2]

    def stepped(self, simulation: Any) -> None:
        """Take some of the body's level speed."""
        twists, k = twist(simulation, self.name)
        speed = float(np.hypot(*twists[k, :2]))
        if speed > 0.0:
            twists[k, :2] *= max(0.0, 1.0 - self.deceleration * simulation.dt / speed)
            set_twist(simulation, twists)


@dataclass
class Kick(Tamper):
    """At one moment a body's velocity changes by nothing that is there."""

    name: str
    start: float  # [s]
    linear: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m/s]
    angular: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [rad/s]
    done: bool = field(default=False, repr=False)

    def stepped(self, simulation: Any) -> None:
        """Kick once."""
        if self.done or simulation.time < self.start:
            return
        self.done = True
        twists, k = twist(simulation, self.name)
        twists[k] += [*self.linear, *self.angular]
        set_twist(simulation, twists)


@dataclass
class Shake(Tamper):
    """A body trembles: its velocity is changed to and fro."""

    name: str
    speed: float  # [m/s]
    hertz: float = 15.0

    def stepped(self, simulation: Any) -> None:
        """Set the body's level velocity to a sine's."""
        twists, k = twist(simulation, self.name)
        twists[k, 0] = self.speed * math.sin(2 * math.pi * self.hertz * simulation.time)
        set_twist(simulation, twists)


@dataclass
class Lift(Tamper):
    """A share of a body's weight is carried by nothing that is there."""

    name: str
    share: float

    def stepped(self, simulation: Any) -> None:
        """Give back some of what gravity took."""
        twists, k = twist(simulation, self.name)
        twists[k, 2] += self.share * 9.81 * simulation.dt
        set_twist(simulation, twists)


@dataclass
class NoFluidForce(Tamper):
    """The fluid pushes a body with a share of the force that it should."""

    name: str
    factor: float

    def prepare(self, simulation: Any) -> None:
        """Scale what the fluid hands over, between its step and the bodies'."""
        index = int(simulation.built.bodies[row(simulation.world, self.name)])
        step = simulation.fluid.step

        def changed(state_in: Any, state_out: Any, *rest: Any) -> None:
            step(state_in, state_out, *rest)
            force = state_out.body_f.numpy()
            force[index] *= self.factor
            state_out.body_f.assign(force)

        simulation.fluid.step = changed
