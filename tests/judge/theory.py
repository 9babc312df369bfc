"""Recordings of single bodies that move as closed-form mechanics has it, for checks to look at."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from wsim.judge.evidence.evidence import Evidence
from wsim.recording.recording import Recording
from wsim.scene.world import Body, Camera, Joint, Shape, Static, World

G, RATE, STEP = 9.81, 30.0, 1.0 / 900.0
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
EDGE, RADIUS = 0.2, 0.1


def times(seconds, rate=RATE):
    return np.arange(round(seconds * rate) + 1) / rate


def ground(friction=0.5):
    plane = Shape(prim="/World/ground/plane", kind="plane", size=(), friction=friction)
    return Static(prim="/World/ground", shapes=[plane])


def slab(name, size, position):
    return Static(
        prim=f"/World/{name}", shapes=[Shape(prim=f"/World/{name}/g", kind="box", size=size, position=position)]
    )


def ball(name="ball", mass=4.0, **fields):
    shape = Shape(prim=f"/World/{name}/g", kind="sphere", size=(RADIUS,))
    inertia = tuple(np.diag([0.4 * mass * RADIUS**2] * 3).ravel())
    return _body(name, shape, mass, 4.0 / 3.0 * math.pi * RADIUS**3, inertia, **fields)


def box(name="box", size=(EDGE, EDGE, EDGE), mass=4.0, friction=0.5, **fields):
    shape = Shape(prim=f"/World/{name}/g", kind="box", size=size, friction=friction)
    x, y, z = (mass * edge**2 / 12.0 for edge in size)
    return _body(name, shape, mass, math.prod(size), tuple(np.diag([y + z, x + z, x + y]).ravel()), **fields)


def _body(name, shape, mass, volume, inertia, **fields):
    return Body(
        prim=f"/World/{name}", mass=mass, volume=volume, inertia=inertia, position=(0.0, 0.0, 0.0), rotation=UPRIGHT,
        shapes=[shape], line="program.py:7", **fields,
    )  # fmt: skip


def record(bodies, position, velocity, t, *, rotation=None, spin=None, force=None, statics=(), **fields):
    """A recording of bodies whose places and velocities are (T, 3) each, or (T, B, 3)."""
    count = len(bodies)

    def rows(array, width):
        return np.broadcast_to(np.asarray(array, dtype=np.float64).reshape(len(t), -1, width), (len(t), count, width))

    q = np.concatenate([rows(position, 3), rows(np.tile(UPRIGHT, (len(t), 1)) if rotation is None else rotation, 4)], 2)
    none = np.zeros((len(t), 3))
    qd = np.concatenate([rows(velocity, 3), rows(none if spin is None else spin, 3)], axis=2)
    contact = rows(none if force is None else force, 3)
    world = World(
        duration=float(t[-1]), frame_rate=round(1.0 / (t[1] - t[0]), 6), time_step=STEP, bodies=list(bodies),
        statics=list(statics), joints=fields.pop("joints", []), cameras=fields.pop("cameras", []),
    )  # fmt: skip
    scalars = {"contact/penetration": np.zeros(len(t))} | fields.pop("scalars", {})
    return Recording(
        Path("x.rrd"), world, fields.pop("metadata", {}), t, q.astype(np.float32), qd.astype(np.float32),
        contact.astype(np.float32), fields.pop("fluids", {}), scalars, [], {}, **fields,
    )  # fmt: skip


def edited(recording, field, where, change):
    """A copy in which `change` is added to part of an array."""
    array = getattr(recording, field).copy()
    array[where] += np.asarray(change, dtype=array.dtype)
    return replace(recording, **{field: array})


def with_world(recording, **fields):
    return replace(recording, world=recording.world.model_copy(update=fields))


def ask(check, recording, plan=None):
    """A check's findings on a recording, as the judge asks for them."""
    return check.run(Evidence(recording, plan))


def only(findings):
    assert len(findings) == 1, findings
    return findings[0]


# ---- motions
def thrown(seconds=1.0, g=G, up=4.0, along=2.0, height=3.0):
    """A ball in the air."""
    t = times(seconds)
    zero = np.zeros_like(t)
    place = np.stack([along * t, zero, height + up * t - g * t**2 / 2], axis=1)
    return record([ball()], place, np.stack([zero + along, zero, up - g * t], axis=1), t, statics=[ground()])


def bouncing(restitution, seconds=2.0, height=1.0, rate=RATE):
    """A ball that falls on the ground and comes up with a share of its speed, in contact for no time."""
    t = times(seconds, rate)
    z, v = np.zeros_like(t), np.zeros_like(t)
    start, top, speed = 0.0, height, 0.0
    for k, now in enumerate(t):
        while True:
            fall = (speed + math.sqrt(speed**2 + 2 * G * top)) / G
            if now <= start + fall or fall < 1e-6:
                break
            start, speed, top = start + fall, restitution * (G * fall - speed), 0.0
        z[k], v[k] = top + speed * (now - start) - G * (now - start) ** 2 / 2, speed - G * (now - start)
    zero = np.zeros_like(t)
    place = np.stack([zero, zero, RADIUS + z], axis=1)
    return record([ball()], place, np.stack([zero, zero, v], axis=1), t, statics=[ground()])


def sliding(pull, speed=3.0, seconds=2.0, friction=0.5):
    """A box on the ground that is slowed by `pull` [m/s^2] until it stands."""
    t = times(seconds)
    v = np.maximum(speed - pull * t, 0.0)
    stop = speed / pull if pull > 0.0 else math.inf
    x = np.where(t < stop, speed * t - pull * t**2 / 2, speed**2 / (2 * pull) if pull > 0.0 else 0.0)
    zero = np.zeros_like(t)
    place = np.stack([x, zero, zero + EDGE / 2], axis=1)
    force = np.stack([np.where(v > 0.0, -4.0 * pull, 0.0), zero, zero + 4.0 * G], axis=1)
    body = box(friction=friction)
    return record([body], place, np.stack([v, zero, zero], axis=1), t, force=force, statics=[ground(friction)])


def resting(seconds=2.0, **fields):
    """A box that stands on the ground."""
    return sliding(0.0, 0.0, seconds, **fields)


def swinging(growth=0.0, angle=0.8, length=1.0, seconds=4.0, rate=60.0):
    """A rod on a hinge at (0, 0, 2), about Y; its energy grows by a share of `growth` a second.

    Integrated at a tenth of a millisecond; the speed is scaled as it goes.
    """
    t = times(seconds, rate)
    body = box("rod", (0.04, 0.04, length), 2.0)
    moment = 2.0 * length**2 / 3.0  # about the end, of a thin rod
    theta, omega, dt = angle, 0.0, 1e-4
    stiffness = 2.0 * G * length / 2.0 / (body.inertia[4] + 2.0 * (length / 2) ** 2)
    assert math.isclose(stiffness * moment, 2.0 * G * length / 2, rel_tol=0.01)
    angles, rates = [theta], [omega]
    steps = round(1.0 / rate / dt)
    pace = 1.0 / rate / steps
    scale = 2.0 * stiffness * (1.0 - math.cos(angle))  # of omega^2: the energy that swings
    for _ in t[1:]:
        for _ in range(steps):
            omega -= 0.5 * pace * stiffness * math.sin(theta)
            theta += pace * omega
            omega -= 0.5 * pace * stiffness * math.sin(theta)
            if abs(omega) > 0.1:
                omega = math.copysign(math.sqrt(omega**2 + growth * scale * pace), omega)
        angles.append(theta)
        rates.append(omega)
    a, w = np.array(angles), np.array(rates)
    zero = np.zeros_like(a)
    arm = np.stack([np.sin(a), zero, np.cos(a)], axis=1) * length / 2
    # Turning by +angle about Y swings a rod that hangs towards -X.
    place = np.array([0.0, 0.0, 2.0]) - arm
    velocity = -np.stack([np.cos(a), zero, -np.sin(a)], axis=1) * (w * length / 2)[:, None]
    rotation = np.stack([zero, np.sin(a / 2), zero, np.cos(a / 2)], axis=1)
    hinge = Joint(
        prim="/World/hinge", kind="revolute", parent=None, child="/World/rod", axis="Y", parent_anchor=(0.0, 0.0, 2.0),
        child_anchor=(0.0, 0.0, length / 2), line="program.py:9",
    )  # fmt: skip
    spin = np.stack([zero, w, zero], axis=1)
    return record([body], place, velocity, t, rotation=rotation, spin=spin, joints=[hinge])


def camera(eye=(0.0, -5.0, 1.0), target=(0.0, 0.0, 1.0), name="side"):
    return Camera(prim=f"/World/{name}", eye=eye, target=target)
