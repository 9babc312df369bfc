"""Newton's law of impact: bounces, pairs of surfaces, collisions."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import EXACT, Bench, Case, Track, bounces, case, step_at, swing
from wsim.scene import Scene

STEPS = (0.0005, 0.00125, 0.004)  # [s]; the last is longer than the simulator would take


def _first_apex(bench: Bench, ball: float | None, ground: float | None, step: float | None = None) -> float:
    """How high a ball comes that falls by 1 m [m]."""

    def build(scene: Scene) -> None:
        scene.ground(restitution=ground)
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 1.1), restitution=ball)

    track = bench.run(build, 1.6, rate=250.0, step=step, exactly=step is not None)
    smaller = min(e for e in (ball, ground) if e is not None)
    bench.show("height [m]", track.time, track.position("ball")[:, 2] - 0.1, bounces(track.time, 1.0, smaller))
    rising = np.flatnonzero(track.velocity("ball")[:, 2] > 0.0)
    falling = np.flatnonzero(track.velocity("ball")[:, 2] < 0.0)
    first = rising[0] if len(rising) else len(track.time) - 1
    later = falling[falling > first]
    last = later[0] if len(later) else len(track.time) - 1
    return float(track.position("ball")[first : last + 1, 2].max() - 0.1)


def _bounce(restitution: float) -> Case:
    def run(bench: Bench) -> tuple[float, float]:
        expected = restitution**2
        found = [(_first_apex(bench, restitution, restitution, step), step) for step in STEPS]
        apexes = np.array([apex for apex, _ in found])
        bench.show("first apex [m]", 1e3 * np.array(STEPS), apexes, expected, "step [ms]")
        value, bench.step = max(found, key=lambda pair: abs(pair[0] - expected))
        return value, expected

    run.__doc__ = (
        f"""A ball that falls 1 m rises e² · 1 m, e = {restitution:g}: the worst of steps of 0.5, 1.25, 4 ms."""
    )
    if restitution:
        return case("m", name=f"bounce_{restitution:g}")(run)
    return case("m", 1e-3, "it does not bounce", name="bounce_0")(run)


BOUNCES = tuple(_bounce(e) for e in (0.0, 0.3, 0.5, 0.8, 1.0))


@case("m")
def smaller_restitution_counts(bench: Bench) -> tuple[float, float]:
    """A ball of e = 0.8 rises 0.5² · 1 m from ground of 0.5."""
    return _first_apex(bench, 0.8, 0.5), 0.25


@case("m")
def unstated_restitution(bench: Bench) -> tuple[float, float]:
    """Ground that states none leaves it to the ball: 0.8² · 1 m."""
    return _first_apex(bench, 0.8, None), 0.64


def _collide(bench: Bench, masses: tuple[float, float], restitution: float, off: float = 0.0) -> Track:
    """A ball at 2 m/s meets one at rest, both of radius 0.1 m, smooth, `off` [m] beside the line of centres."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        for name, mass, place, speed in (("a", masses[0], (-0.5, off, 0), 2.0), ("b", masses[1], (0, 0, 0), 0.0)):
            scene.sphere(name, radius=0.1, mass=mass, position=place, velocity=(speed, 0, 0), friction=0.0,
                         restitution=restitution)  # fmt: skip

    return bench.run(build, 0.6)


def _after(bench: Bench, track: Track, speed: np.ndarray, before: float, after: float, off: float = 0.0) -> float:
    """The last of a ball's speeds; shows them."""
    met = (0.5 - math.sqrt(0.2**2 - off**2)) / 2.0
    bench.show("v [m/s]", track.time, speed, step_at(track.time, met, before, after))
    return float(speed[-1])


@case("m/s")
def head_on_equal(bench: Bench) -> tuple[float, float]:
    """Elastic balls of one mass exchange their speeds: the second leaves at v = 2 m/s."""
    track = _collide(bench, (1, 1), 1.0)
    return _after(bench, track, track.velocity("b")[:, 0], 0.0, 2.0), 2.0


@case("m/s")
def head_on_unequal(bench: Bench) -> tuple[float, float]:
    """1 kg meets 3 kg at e = 0.5: it comes back at v (m - e M) / (m + M)."""
    track = _collide(bench, (1, 3), 0.5)
    return _after(bench, track, track.velocity("a")[:, 0], 2.0, -0.25), 2.0 * (1 - 1.5) / 4


@case("m/s")
def head_on_dead(bench: Bench) -> tuple[float, float]:
    """At e = 0 both go on at v / 2."""
    track = _collide(bench, (1, 1), 0.0)
    return _after(bench, track, track.velocity("a")[:, 0], 2.0, 1.0), 1.0


@case("m/s")
def off_centre(bench: Bench) -> tuple[float, float]:
    """Struck at half a diameter aside the second leaves at v cos 30°."""
    track, expected = _collide(bench, (1, 1), 1.0, 0.1), 2.0 * math.cos(math.pi / 6)
    return _after(bench, track, np.linalg.norm(track.velocity("b"), axis=1), 0.0, expected, 0.1), expected


@case("kg m/s", 1e-5, EXACT)
def off_centre_momentum(bench: Bench) -> tuple[float, float]:
    """The momentum of both is the first's, m v = 2 kg m/s."""
    track = _collide(bench, (1, 1), 1.0, 0.1)
    momentum = np.linalg.norm(track.velocity("a") + track.velocity("b"), axis=1)
    bench.show("m v [kg m/s]", track.time, momentum, 2.0)
    return float(momentum[-1]), 2.0


@case("J")
def off_centre_energy(bench: Bench) -> tuple[float, float]:
    """The energy of both is the first's, m v² / 2 = 2 J."""
    track = _collide(bench, (1, 1), 1.0, 0.1)
    energy = 0.5 * ((track.velocity("a") ** 2).sum(axis=1) + (track.velocity("b") ** 2).sum(axis=1))
    bench.show("energy [J]", track.time, energy, 2.0)
    return float(energy[-1]), 2.0


def _glance(bench: Bench, velocity: tuple[float, float], friction: float) -> Track:
    """A ball that does not spin meets a floor at (along, down), e = 0.5, without gravity."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.ground()
        scene.sphere("ball", radius=0.1, mass=1.0, position=(0, 0, 0.3), velocity=(velocity[0], 0, -velocity[1]),
                     friction=friction, restitution=0.5)  # fmt: skip

    return bench.run(build, 0.3)


@case("m/s")
def glancing_loss(bench: Bench) -> tuple[float, float]:
    """A ball that slides through its bounce loses μ (1 + e) v_z along the floor."""
    track = _glance(bench, (3.0, 2.0), 0.1)
    lost = 3.0 - track.velocity("ball")[:, 0]
    bench.show("lost [m/s]", track.time, lost, step_at(track.time, 0.1, 0.0, 0.3))
    return float(lost[-1]), 0.1 * 1.5 * 2.0


@case("rad/s")
def glancing_spin(bench: Bench) -> tuple[float, float]:
    """It spins up to 5 μ (1 + e) v_z / (2 R)."""
    track = _glance(bench, (3.0, 2.0), 0.1)
    bench.show("ω [rad/s]", track.time, track.spin("ball")[:, 1], step_at(track.time, 0.1, 0.0, 7.5))
    return float(track.spin("ball")[-1, 1]), 2.5 * 0.1 * 1.5 * 2.0 / 0.1


@case("m/s")
def glancing_grip(bench: Bench) -> tuple[float, float]:
    """A ball that grips leaves rolling, at 5/7 of its speed along the floor."""
    track = _glance(bench, (1.0, 2.0), 1.0)
    bench.show("v [m/s]", track.time, track.velocity("ball")[:, 0], step_at(track.time, 0.1, 1.0, 5 / 7))
    return float(track.velocity("ball")[-1, 0]), 5 / 7


@case("m/s")
def spinning_bounce(bench: Bench) -> tuple[float, float]:
    """However fast it spins, a ball of e = 0.5 and μ = 1 leaves at e v_z: its friction lifts nothing, holds nothing."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.ground()
        scene.sphere("ball", radius=0.1, mass=1.0, position=(0, 0, 0.3), velocity=(0, 0, -2.0),
                     angular_velocity_deg=(0, math.degrees(150.0), 0), friction=1.0, restitution=0.5)  # fmt: skip

    track = bench.run(build, 0.3)
    bench.show("v [m/s]", track.time, track.velocity("ball")[:, 2], step_at(track.time, 0.1, -2.0, 1.0))
    return float(track.velocity("ball")[-1, 2]), 1.0


@case("m", 0.02, "five joints at e = 1, and the strike falls within a step")
def cradle(bench: Bench) -> tuple[float, float]:
    """The last ball of a cradle of five rises as high as the first was let go, L (1 - cos 0.5)."""

    def build(scene: Scene) -> None:
        for k in range(5):
            x = 0.2 * k
            place = (x - math.sin(0.5), 0, 2 - math.cos(0.5)) if k == 0 else (x, 0, 1.0)
            scene.sphere(f"b{k}", radius=0.1, density=7800, position=place, restitution=1.0, friction=0.0)
            scene.joint_revolute(f"j{k}", None, f"b{k}", anchor=(x, 0, 2.0), axis="Y")

    track = bench.run(build, 1.3)
    height = track.position("b4")[:, 2] - 1.0
    angle = swing(track.time, -0.5, 1.004)  # as one ball would swing; the last takes over at the bottom
    bench.show("last ball's height [m]", track.time, height, np.where(angle > 0.0, 1.0 - np.cos(angle), 0.0))
    return float(height.max()), 1.0 - math.cos(0.5)
