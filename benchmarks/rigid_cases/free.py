"""Flight and spin without contact."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from benchmarks.rigid_cases.case import Bench, G, Track, case, period
from wsim.scene import Scene

Array = np.ndarray
SIZE = np.array([0.4, 0.2, 0.1])  # a box whose middle axis is its second
MOMENTS = np.array([SIZE[[1, 2]] @ SIZE[[1, 2]], SIZE[[0, 2]] @ SIZE[[0, 2]], SIZE[[0, 1]] @ SIZE[[0, 1]]]) / 12
START = np.array([0.01, 5.0, 0.0])  # [rad/s]


@case("m")
def free_fall(bench: Bench) -> tuple[float, float]:
    """A ball falls g t² / 2 in 1 s."""
    track = bench.run(lambda scene: _ball(scene, (0, 0, 0)), 1.0)
    bench.show("z [m]", track.time, track.position("ball")[:, 2], -0.5 * G * track.time**2)
    return -float(track.position("ball")[-1, 2]), 0.5 * G


@case("m")
def projectile(bench: Bench) -> tuple[float, float]:
    """Thrown at 5 m/s up and 3 m/s along, a ball is at the height it left after 2 v / g; it has come 6 v / g."""
    track = bench.run(lambda scene: _ball(scene, (3, 0, 5)), 1.2)
    x, z = track.position("ball")[:, 0], track.position("ball")[:, 2]
    bench.show("z [m]", x, z, 5 / 3 * x - 0.5 * G * (x / 3) ** 2, "x [m]")
    k = int(np.flatnonzero((z[:-1] > 0) & (z[1:] <= 0))[-1])
    return float(x[k] + (x[k + 1] - x[k]) * z[k] / (z[k] - z[k + 1])), 3 * 10 / G


@case("m", 1e-3, "steps of second order have it exactly; what is recorded is in single precision")
def small_fall(bench: Bench) -> tuple[float, float]:
    """A ball of 1 cm falls by 1 cm in √(2 L / g), 45 ms."""
    track = bench.run(lambda scene: scene.sphere("ball", radius=0.005, density=600), 0.045, rate=1000.0)
    bench.show("z [m]", track.time, track.position("ball")[:, 2], -0.5 * G * track.time**2)
    return -float(track.position("ball")[-1, 2]), 0.5 * G * 0.045**2


@case("m", 1e-3, "likewise")
def small_throw(bench: Bench) -> tuple[float, float]:
    """A ball of 5 mm thrown up at √(2 g L) rises by L, 5 mm."""
    up = math.sqrt(2 * G * 0.005)

    def build(scene: Scene) -> None:
        scene.sphere("ball", radius=0.0025, density=600, velocity=(0, 0, up))

    track = bench.run(build, 0.06, rate=1000.0)
    z = track.position("ball")[:, 2]
    bench.show("z [m]", track.time, z, up * track.time - 0.5 * G * track.time**2)
    return float(z.max()), 0.005


def _ball(scene: Scene, velocity: Iterable[float]) -> None:
    scene.sphere("ball", radius=0.1, density=600, velocity=tuple(velocity))


def _box(bench: Bench, spin: Array, seconds: float) -> Track:
    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        degrees = tuple(float(x) for x in np.degrees(spin))
        scene.box("box", size=tuple(SIZE), mass=1.0, angular_velocity_deg=degrees)

    return bench.run(build, seconds)


def _kept(track: Track) -> tuple[Array, Array]:
    """Angular momentum [kg m²/s] and energy [J] of the box of 1 kg, a row a frame."""
    axes, spin = track.axes("box"), track.spin("box")
    own = np.einsum("tji,tj->ti", axes, spin)
    return np.einsum("tij,tj->ti", axes, MOMENTS * own), 0.5 * (MOMENTS * own**2).sum(axis=1)


@case("rad/s", 1e-3, "in single precision a turn into the body's axes and back adds 3e-7 to a spin, step after step")
def free_spin(bench: Bench) -> tuple[float, float]:
    """A box that spins about its third axis at 5 rad/s still does after 2 s."""
    track = _box(bench, np.array([0.0, 0.0, 5.0]), 2.0)
    bench.show("ω [rad/s]", track.time, track.spin("box")[:, 2], 5.0)
    return float(track.spin("box")[-1, 2]), 5.0


@case("s")
def dzhanibekov_flip(bench: Bench) -> tuple[float, float]:
    """Spun about its middle axis a box flips when Euler's equations do (integrated by Runge and Kutta)."""
    track = _box(bench, START, 5.0)
    own = np.einsum("tji,tj->ti", track.axes("box"), track.spin("box"))[:, 1]
    known = _euler(track.time, 100)
    bench.show("ω₂ [rad/s]", track.time, own, known)
    return _crossing(track.time, own), _crossing(track.time, known)


def _crossing(time: Array, values: Array) -> float:
    """When values first pass zero [s]."""
    k = int(np.flatnonzero(values < 0)[0])
    return float(time[k] - values[k] * (time[k] - time[k - 1]) / (values[k] - values[k - 1]))


def _euler(time: Array, parts: int) -> Array:
    """The spin about the middle axis by Euler's equations, in `parts` steps between two times [rad/s]."""

    def change(w: Array) -> Array:
        return np.cross(MOMENTS * w, w) / MOMENTS

    w, h, found = START.copy(), (time[1] - time[0]) / parts, [START[1]]
    for k in range(1, parts * (len(time) - 1) + 1):
        a = change(w)
        b = change(w + 0.5 * h * a)
        c = change(w + 0.5 * h * b)
        w = w + h / 6 * (a + 2 * b + 2 * c + change(w + h * c))
        if k % parts == 0:
            found.append(w[1])
    return np.array(found)


@case("of L", 1e-4, "the step keeps it; what is recorded is in single precision")
def dzhanibekov_momentum(bench: Bench) -> tuple[float, float]:
    """Its angular momentum changes by 0 in 5 s."""
    track = _box(bench, START, 5.0)
    momentum = _kept(track)[0]
    change = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
    bench.show("|L - L₀| / L₀", track.time, change, 0.0)
    return float(change.max()), 0.0


@case("of E", 1e-4, "the step adds none over time; what is recorded is in single precision")
def dzhanibekov_energy(bench: Bench) -> tuple[float, float]:
    """Its energy changes by 0 in 5 s."""
    track = _box(bench, START, 5.0)
    energy = _kept(track)[1]
    bench.show("E / E₀ - 1", track.time, energy / energy[0] - 1, 0.0)
    return float(np.abs(energy / energy[0] - 1).max()), 0.0


FAST = 80.0 * np.array([0.3, 0.9, 0.3])  # [rad/s]


@case("of L", 1e-4, "the step keeps it; what is recorded is in single precision")
def tumbling_momentum(bench: Bench) -> tuple[float, float]:
    """The angular momentum of a box that tumbles at 80 rad/s changes by 0 in 2 s."""
    momentum = _kept(_box(bench, FAST, 2.0))[0]
    return float((np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])).max()), 0.0


@case("of E", 1e-4, "the step adds none over time; what is recorded is in single precision")
def tumbling_energy(bench: Bench) -> tuple[float, float]:
    """So does its energy."""
    track = _box(bench, FAST, 2.0)
    energy = _kept(track)[1]
    bench.show("E / E₀ - 1", track.time, energy / energy[0] - 1, 0.0)
    return float(np.abs(energy / energy[0] - 1).max()), 0.0


@case("m", 1e-3, "a place at 1 km is recorded to 3e-5 m")
def far_and_slow(bench: Bench) -> tuple[float, float]:
    """A ball 1 km from the origin, at 1 cm/s, comes 4 cm in 4 s."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("ball", radius=0.05, mass=1.0, position=(1000, 0, 0), velocity=(0.01, 0, 0))

    track = bench.run(build, 4.0)
    place = track.position("ball")[:, 0] - 1000.0
    bench.show("x [m]", track.time, place, 0.01 * track.time)
    return float(place[-1]), 0.04


@case("rad")
def gyroscope(bench: Bench) -> tuple[float, float]:
    """A wheel on a ball joint, its axle level, precesses by m g l / (I ω) a second (steady: exact)."""
    radius, arm, spin = 0.1, 0.2, 100.0
    rate = G * arm / (0.5 * radius**2 * spin)

    def build(scene: Scene) -> None:
        scene.cylinder("wheel", radius=radius, height=0.02, axis="X", mass=1.0, position=(arm, 0, 0),
                       velocity=(0, rate * arm, 0),
                       angular_velocity_deg=(math.degrees(spin), 0, math.degrees(rate)))  # fmt: skip
        scene.joint_spherical("pivot", None, "wheel", anchor=(0, 0, 0))

    track = bench.run(build, 1.0)
    place = track.position("wheel")
    turned = np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
    bench.show("precession [rad]", track.time, turned, rate * track.time)
    return float(turned[-1]), rate


LEAN, TOP_SPIN, TOP_ARM = math.radians(30.0), 200.0, 0.2  # of a fast top: start [rad], [rad/s], to its wheel [m]


def _top(bench: Bench) -> tuple[Track, Array, Array]:
    """A wheel of 1 kg on an arm without mass, let go leaning and spinning: its track, lean and precession [rad]."""

    def build(scene: Scene) -> None:
        axis = np.array([math.sin(LEAN), 0.0, math.cos(LEAN)])
        scene.cylinder("wheel", radius=0.1, height=0.02, mass=1.0, position=tuple((TOP_ARM * axis).tolist()),
                       rotation_deg=(0, math.degrees(LEAN), 0),
                       angular_velocity_deg=tuple(np.degrees(TOP_SPIN * axis).tolist()))  # fmt: skip
        scene.joint_spherical("pivot", None, "wheel", anchor=(0, 0, 0))

    track = bench.run(build, 2.0, rate=400.0)
    place = track.position("wheel") / TOP_ARM
    return track, np.arccos(place[:, 2]), np.unwrap(np.arctan2(place[:, 1], place[:, 0]))


def _lagrange(time: Array, parts: int = 10) -> tuple[Array, Array]:
    """Lean and precession of Lagrange's top that starts without precession, by Runge and Kutta [rad]."""
    own, across = 0.5 * 0.1**2, 0.1**2 / 4 + 0.02**2 / 12 + TOP_ARM**2
    kept = own * TOP_SPIN * math.cos(LEAN)

    def change(state: Array) -> Array:
        lean, rate, _ = state
        turns = (kept - own * TOP_SPIN * math.cos(lean)) / (across * math.sin(lean) ** 2)
        pull = turns * math.sin(lean) * (turns * math.cos(lean) - own * TOP_SPIN / across)
        return np.array([rate, pull + G * TOP_ARM * math.sin(lean) / across, turns])

    state, found, h = np.array([LEAN, 0.0, 0.0]), [(LEAN, 0.0)], (time[1] - time[0]) / parts
    for _ in time[1:]:
        for _ in range(parts):
            a = change(state)
            b = change(state + 0.5 * h * a)
            c = change(state + 0.5 * h * b)
            state = state + h / 6 * (a + 2 * b + 2 * c + change(state + h * c))
        found.append((float(state[0]), float(state[2])))
    return np.array(found).T[0], np.array(found).T[1]


@case("rad")
def top_nutation(bench: Bench) -> tuple[float, float]:
    """A fast top let go at 30° nods down to where Lagrange's equations take it (integrated by Runge and Kutta)."""
    track, lean, _ = _top(bench)
    known = _lagrange(track.time)[0]
    bench.show("lean [rad]", track.time, lean, known)
    return float(lean.max()) - LEAN, float(known.max()) - LEAN


@case("s")
def top_nutation_period(bench: Bench) -> tuple[float, float]:
    """It nods as often as they say: 2 π I₁ / (I₃ ω) where it is fast."""
    track, lean, _ = _top(bench)
    middle = lean - LEAN
    known = _lagrange(track.time)[0] - LEAN
    return period(track.time, middle - middle.mean()), period(track.time, known - known.mean())


@case("rad")
def top_precession(bench: Bench) -> tuple[float, float]:
    """In 2 s it goes round by as much."""
    track, _, turned = _top(bench)
    known = _lagrange(track.time)[1]
    bench.show("precession [rad]", track.time, turned, known)
    return float(turned[-1]), float(known[-1])
