"""Springs, dampers, ropes over pulleys, and cables of links."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import EXACT, Bench, G, Track, case, elliptic_k, period
from wsim.geometry.catenary import hanging
from wsim.scene import Scene

_WAIST = 1.622131  # u of sinh(u) / u = 1.5: half the width of the rope below over its catenary's parameter


def _weight(bench: Bench, seconds: float, damping: float = 0.0) -> Track:
    """2 kg on a spring of 200 N/m, let go where the spring is slack."""

    def build(scene: Scene) -> None:
        scene.box("weight", size=(0.1, 0.1, 0.1), mass=2.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 2), stiffness=200.0, damping=damping)

    return bench.run(build, seconds)


@case("s", 1e-4, "steps of the fourth order")
def weight_on_a_spring(bench: Bench) -> tuple[float, float]:
    """A weight of 2 kg on a spring of 200 N/m bobs in 2 π √(m / k)."""
    track = _weight(bench, 6.5)
    return period(track.time, track.position("weight")[:, 2] - 1.0 + 2.0 * G / 200.0), 2 * math.pi * 0.1


@case("m", 1e-3, "kept: nothing damps it")
def hundred_periods(bench: Bench) -> tuple[float, float]:
    """After a hundred periods it still bobs by 2 m g / k."""
    z = _weight(bench, 63.5).position("weight")[-70:, 2]
    return float(np.ptp(z)), 4.0 * G / 200.0


@case("s", 1e-4, "steps of the fourth order")
def pair_on_a_spring(bench: Bench) -> tuple[float, float]:
    """Two free balls of 1 and 3 kg on a spring of 300 N/m swing in 2 π √(μ / k), μ = m M / (m + M)."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("one", radius=0.05, mass=1.0, position=(0, 0, 0))
        scene.sphere("two", radius=0.05, mass=3.0, position=(1, 0, 0))
        scene.spring("spring", "one", "two", stiffness=300.0, rest_length=0.9)

    track = bench.run(build, 3.0)
    apart = track.position("two")[:, 0] - track.position("one")[:, 0] - 0.9
    return period(track.time, apart), 2 * math.pi * math.sqrt(0.75 / 300.0)


@case("m")
def damped_spring(bench: Bench) -> tuple[float, float]:
    """With a damper of 4 N s/m its first swing beyond rest goes exp(-ζ π / √(1 - ζ²)) as far, ζ = c / (2 √(k m)))."""
    track = _weight(bench, 0.5, 4.0)
    drop, zeta = 2.0 * G / 200.0, 4.0 / (2 * math.sqrt(200.0 * 2.0))
    overshoot = 1.0 - drop - float(track.position("weight")[:, 2].min())
    return overshoot, drop * math.exp(-zeta * math.pi / math.sqrt(1 - zeta**2))


@case("m/s²")
def atwood(bench: Bench) -> tuple[float, float]:
    """Of 2 and 1 kg on a rope over a wheel the heavier falls at (M - m) / (M + m) g."""

    def build(scene: Scene) -> None:
        scene.cylinder("wheel", radius=0.2, height=0.1, axis="Y", position=(0, 0, 2), static=True)
        scene.box("heavy", size=(0.1, 0.1, 0.1), mass=2.0, position=(-0.2, 0, 1.5))
        scene.box("light", size=(0.1, 0.1, 0.1), mass=1.0, position=(0.2, 0, 0.8))
        scene.rope("rope", "heavy", "light", around=["wheel"])

    track = bench.run(build, 0.5)
    return -float(track.velocity("heavy")[-1, 2]) / 0.5, G / 3.0


@case("m/s²")
def movable_pulley(bench: Bench) -> tuple[float, float]:
    """1 kg lifts a block of 1 kg that hangs in its rope at (2 m - M) g / (M + 4 m)."""

    def build(scene: Scene) -> None:
        scene.cylinder("fixed", radius=0.1, height=0.1, axis="Y", position=(0, 0, 2), static=True)
        scene.cylinder("block", radius=0.1, height=0.1, axis="Y", position=(0.2, 0, 1), mass=1.0)
        scene.box("weight", size=(0.1, 0.1, 0.1), mass=1.0, position=(-0.1, 0, 1.5))
        scene.rope("rope", "weight", None, anchor_b=(0.3, 0, 2), around=["fixed", ("block", "under")])

    return float(bench.run(build, 0.4).velocity("block")[-1, 2]) / 0.4, G / 5.0


@case("s")
def ball_on_a_string(bench: Bench) -> tuple[float, float]:
    """A ball on a rope of 1 m swings by 60° each way in 4 √(l / g) K(sin 30°)."""
    start = math.radians(60.0)

    def build(scene: Scene) -> None:
        scene.sphere("bob", radius=0.01, mass=1.0, position=(math.sin(start), 0, -math.cos(start)))
        scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))

    track = bench.run(build, 6.6)
    return period(track.time, track.position("bob")[:, 0]), 4 / math.sqrt(G) * elliptic_k(math.sin(start / 2))


@case("s", 2e-3, "the leapfrog's own, (ω h)² / 24, and what frames tell of a period")
def ball_on_a_short_string(bench: Bench) -> tuple[float, float]:
    """On a rope of 1 cm likewise, 1 s long: it keeps its length and its energy."""
    start, length = math.radians(60.0), 0.01

    def build(scene: Scene) -> None:
        place = (length * math.sin(start), 0, -length * math.cos(start))
        scene.sphere("bob", radius=0.05 * length, mass=0.001, position=place)
        scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))

    track = bench.run(build, 1.0, rate=500.0)
    known = 4 * math.sqrt(length / G) * elliptic_k(math.sin(start / 2))
    return period(track.time, track.position("bob")[:, 0]), known


@case("m")
def string_goes_slack(bench: Bench) -> tuple[float, float]:
    """A ball that leaves the bottom of its rope's circle with v² = 7/2 g l goes slack at 3/2 l and rises to 27/16 l."""

    def build(scene: Scene) -> None:
        scene.sphere("bob", radius=0.01, mass=1.0, position=(0, 0, -1), velocity=(math.sqrt(3.5 * G), 0, 0))
        scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))

    return float(bench.run(build, 0.9).position("bob")[:, 2].max()) + 1.0, 27.0 / 16.0


@case("m", 1e-3, EXACT)
def rope_stops_a_fall(bench: Bench) -> tuple[float, float]:
    """A weight that falls 0.8 m on a slack rope of 1 m stops at its length."""

    def build(scene: Scene) -> None:
        scene.sphere("bob", radius=0.05, mass=1.0, position=(0, 0, -0.2))
        scene.rope("rope", None, "bob", anchor_a=(0, 0, 0), length=1.0)

    return -float(bench.run(build, 1.0).position("bob")[:, 2].min()), 1.0


@case("m")
def catenary(bench: Bench) -> tuple[float, float]:
    """A cable of 1.5 m between points 1 m apart sags by a (cosh(d / 2 a) - 1), sinh(d / 2 a) = L / 2 a."""

    def build(scene: Scene) -> None:
        scene.cable("c", None, None, anchor_a=(-0.5, 0, 2), anchor_b=(0.5, 0, 2), length=1.5, links=31)

    low = float(bench.run(build, 1.0).position("c_15")[:, 2].min())
    line = hanging(np.array([-0.5, 0, 2.0]), np.array([0.5, 0, 2.0]), 1.5, 10001)
    return 2.0 - low, 2.0 - float(line[:, 2].min())


@case("N")
def catenary_tension(bench: Bench) -> tuple[float, float]:
    """A spring that holds its end, on a hook of 2 g, pulls with w a along and w L / 2 up, w its weight a metre."""
    level, up = 0.2 * G * 0.5 / _WAIST, 0.2 * G * 0.75 + 0.002 * G
    pull = math.hypot(level, up)
    along = np.array([level, 0.0, up]) / pull
    hook, far = np.array([0.5, 0.0, 2.0]), np.array([0.5, 0.0, 2.0]) + 0.3 * along

    def build(scene: Scene) -> None:
        scene.sphere("hook", radius=0.01, mass=0.002, position=hook)
        scene.cable("c", None, "hook", anchor_a=(-0.5, 0, 2), length=1.5, links=20, mass_per_length=0.2)
        scene.spring("spring", None, "hook", anchor_a=far, stiffness=500.0, rest_length=0.3 - pull / 500.0)

    track = bench.run(build, 2.0)
    stretched = np.linalg.norm(track.position("hook") - far, axis=1) - 0.3 + pull / 500.0
    return 500.0 * float(stretched.mean()), pull


def _chain_round_a_post(mu: float, post: float, ring: float, turn: float) -> float:
    """How many times its pull a chain holds that slips half round a post, by the statics of its links.

    Links touch the post in their middles, at a distance `ring` of their axes from its own [m], and are bent by `turn`
    [rad] at each joint. From link to link the force across a joint's radius and that along it grow by one factor: with
    the balance of forces along and across a link, and of moments about the post's axis, its
    x = (factor - 1) / (factor + 1) is the root of a x² + w x - mu s = 0.
    """
    c, s = math.cos(turn / 2), math.sin(turn / 2)
    w = ring / (post * c)
    a = mu * c * (w - c) / s
    x = (math.sqrt(w * w + 4 * a * mu * s) - w) / (2 * a)
    return float(((1 + x) / (1 - x)) ** (math.pi / turn))


@case("")
def capstan(bench: Bench) -> tuple[float, float]:
    """A cable of radius r drawn half round a post of R holds T e^(μ π R / (R + r)), 2.454: it rubs at its surface. Of
    links of 12° the statics make it 1 % less. It is pulled by springs whose ends stay clear of the post."""
    mu, post, thick = 0.3, 0.2, 0.01
    ring, stiffness, rest, low, reach = post + thick, 50.0, 0.33, 0.25, 0.63

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.cylinder("post", radius=post, height=0.3, axis="Y", static=True, friction=mu)
        turn = [(ring * math.cos(a), 0, ring * math.sin(a)) for a in np.linspace(math.pi, 0, 37)]
        for name, x in (("held", -ring), ("drawn", ring)):
            scene.box(name, size=(0.04, 0.04, 0.04), mass=0.05, position=(x, 0, -low))
        top = 0.02 - low
        scene.cable("c", "held", "drawn", anchor_a=(-ring, 0, top), anchor_b=(ring, 0, top), through=turn, links=26,
                    mass_per_length=0.1, radius=thick, friction=mu)  # fmt: skip
        scene.box("puller", size=(0.05, 0.05, 0.05), position=(ring, 0, -reach), kinematic=True, velocity=(0, 0, -0.2))
        common = {"stiffness": stiffness, "damping": 2.0, "rest_length": rest}
        scene.spring("one", None, "held", anchor_a=(-ring, 0, -reach), **common)
        scene.spring("two", "puller", "drawn", **common)

    track = bench.run(build, 2.0)
    held = np.linalg.norm(track.position("held") - (-ring, 0, -reach), axis=1) - rest
    drawn = np.linalg.norm(track.position("drawn") - track.position("puller"), axis=1) - rest
    slips = track.time > 0.8
    link = (math.pi * ring + 2 * (low - 0.02)) / 26
    known = _chain_round_a_post(mu, post, ring, 2 * math.atan(0.5 * link / ring))
    bench.show("pulls' ratio", track.time[slips], drawn[slips] / held[slips], known)
    return float((drawn[slips] / held[slips]).mean()), known
