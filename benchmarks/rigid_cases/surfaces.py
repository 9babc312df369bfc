"""What rolls and slides on tracks, meshes and terrain, and bodies of several shapes."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import trimesh

from benchmarks.rigid_cases.case import Bench, G, case
from wsim.scene import Part, Scene

BALL = 0.03  # [m]
LOOP = 0.4  # [m]


def _looping(bench: Bench, radius: float, friction: float, height: float) -> np.ndarray:
    """Where a ball is that runs into a loop which ends 20° beyond its top, and how fast, (frames, 4)."""
    slope, level = math.radians(45.0), 0.6

    def build(scene: Scene) -> None:
        # Down a slope, through a bend of 45 degrees and a level stretch into the loop.
        fall = height + 0.3 - level * (1.0 - math.cos(slope))
        pieces = [("line", fall / math.sin(slope)), ("up", level, 45.0), ("line", 0.6), ("up", LOOP, 200.0)]
        track = scene.track("track", pieces=pieces, start=(0, 0, height + 0.3), slope_deg=-45.0, friction=friction)
        # Its middle begins `height` over where it runs on the level.
        at = (0.3 - radius * (1.0 - math.cos(slope))) / math.sin(slope)
        scene.sphere("it", radius=radius, mass=1.0, position=track.place(at, radius), friction=friction)

    track = bench.run(build, 1.8, rate=200.0)
    return np.column_stack([track.position("it"), np.linalg.norm(track.velocity("it"), axis=1)])


def _top(path: np.ndarray) -> np.ndarray:
    """The row in which what loops is highest after its way down."""
    bottom = int(np.flatnonzero(path[:, 2] < 0.05)[0])
    return path[bottom + int(np.argmax(path[bottom:, 2]))]


@case("m/s")
def loop_speed_at_the_top(bench: Bench) -> tuple[float, float]:
    """A ball let go 3.2 (R - r) high has √((3.2 - 2) (R - r) g · 10/7) at the top of a loop."""
    reach = LOOP - BALL
    path = _looping(bench, BALL, 1.0, 3.2 * reach)
    return _top(path)[3], math.sqrt(1.2 * reach * G * 10 / 7)


def _highest(bench: Bench, share: float) -> float:
    return _top(_looping(bench, BALL, 1.0, share * 2.7 * (LOOP - BALL)))[2]


@case("m", 0.0005, "it is at the top itself in one frame of many")
def loop_just_high_enough(bench: Bench) -> tuple[float, float]:
    """Let go 1 % above 2.7 (R - r), its least height, a ball passes the top of the loop on the track, at 2 R - r."""
    return _highest(bench, 1.01), 2 * LOOP - BALL


@case("m", 0.002, "it leaves at the end of a step, and is at the top of its arc in one frame of many")
def loop_not_high_enough(bench: Bench) -> tuple[float, float]:
    """Let go 5 % below that it leaves the loop where v² = g (R - r) cos φ, and flies as high as that throws it."""
    reach = LOOP - BALL
    cosine = 10 / 17 * (0.95 * 2.7 - 1.0)  # of the angle from the top: 7/10 v² = g (h - (R - r) (1 + cos φ))
    leaves = BALL + reach * (1.0 + cosine)
    rises = G * reach * cosine * (1.0 - cosine**2) / (2 * G)
    return _highest(bench, 0.95), leaves + rises


@case("m/s")
def loop_of_a_slider(bench: Bench) -> tuple[float, float]:
    """A ball that slides without friction from 3 (R - r) has √(2 g (R - r)) at the top; 2.5 is the least height."""
    reach = LOOP - 0.008
    path = _looping(bench, 0.008, 0.0, 3.0 * reach)
    return _top(path)[3], math.sqrt(2.0 * G * reach)


@case("m")
def u_track(bench: Bench) -> tuple[float, float]:
    """A ball on a U of two bends and a level between them rises on the far side as high as it was let go."""

    def build(scene: Scene) -> None:
        track = scene.track("u", pieces=[("up", 0.5, 80.0), ("line", 0.4), ("up", 0.5, 80.0)], start=(0, 0, 1),
                            slope_deg=-80.0, width=0.2, friction=1.0)  # fmt: skip
        scene.sphere("it", radius=BALL, mass=1.0, position=track.place(0.3, BALL), friction=1.0)

    z = bench.run(build, 2.0).position("it")[:, 2]
    low = int(np.argmax(z < z.min() + 1e-6))  # where it first comes to the level: it is back there before the end
    return float(z[low:].max() - z[low]), float(z[0] - z[low])


@case("s")
def ball_in_a_trough(bench: Bench) -> tuple[float, float]:
    """A ball rolls to and fro in a gutter by 20° each way in 4 √(7 (R - r) / (5 g)) K(sin 10°)."""
    radius, swing = 0.5, math.radians(20.0)

    def build(scene: Scene) -> None:
        scene.track("trough", pieces=[("line", 0.4)], start=(-0.2, 0, 0), profile="round", width=2 * radius,
                    friction=1.0)  # fmt: skip
        reach = radius - 0.05
        scene.sphere("it", radius=0.05, mass=1.0, friction=1.0,
                     position=(0, reach * math.sin(swing), radius - reach * math.cos(swing)))  # fmt: skip

    track = bench.run(build, 4.0)
    return _period(track.time, track.position("it")[:, 1]), _pendulum(7 / 5 * (radius - 0.05), swing)


@case("s")
def ball_in_a_bowl(bench: Bench) -> tuple[float, float]:
    """A ball rolls to and fro in a bowl of a mesh, of facets of 7.5°, in 4 √(7 (R - r) / (5 g)) K(sin 10°)."""
    radius, swing = 0.5, math.radians(20.0)
    reach = radius - 0.05

    def build(scene: Scene) -> None:
        with tempfile.TemporaryDirectory() as folder:
            scene.mesh(
                "bowl", file=_bowl(Path(folder) / "bowl.stl", radius), static=True, smooth_deg=20.0, friction=1.0
            )
        scene.sphere("it", radius=0.05, mass=1.0, friction=1.0,
                     position=(0, reach * math.sin(swing), -reach * math.cos(swing)))  # fmt: skip

    track = bench.run(build, 4.0)
    return _period(track.time, track.position("it")[:, 1]), _pendulum(7 / 5 * reach, swing)


@case("s")
def tautochrone(bench: Bench) -> tuple[float, float]:
    """What slides along a cycloid without friction from anywhere is at its foot after π √(a / g)."""
    a, r = 0.4, 0.01
    roll = np.linspace(math.radians(25.0), 2 * math.pi - math.radians(25.0), 241)
    # The ball's middle is to go along the cycloid, so the track is as far below it as the ball is thick.
    middle = np.column_stack([a * (roll - np.sin(roll)), np.zeros(len(roll)), a * (np.cos(roll) - 1.0)])
    normal = np.column_stack([np.cos(roll / 2), np.zeros(len(roll)), np.sin(roll / 2)])

    def build(scene: Scene) -> None:
        scene.track("cycloid", points=(middle - r * normal).tolist(), width=0.1, friction=0.0)
        start = 60
        scene.sphere("it", radius=r, mass=1.0, position=middle[start].tolist(), friction=0.0)

    track = bench.run(build, 1.0, rate=200.0)
    x = track.position("it")[:, 0] - math.pi * a
    k = int(np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))[0])
    return float(track.time[k] - x[k] / (x[k + 1] - x[k]) * (track.time[1])), math.pi * math.sqrt(a / G)


@case("m/s", 0.02, "the ball rolls high on the gutter's side, about a smaller circle than its own")
def helix(bench: Bench) -> tuple[float, float]:
    """A ball that slides down two turns of a helical gutter without friction leaves at √(2 g h)."""

    def build(scene: Scene) -> None:
        track = scene.track("helix", pieces=[("left", 0.5, 720.0), ("line", 0.5)], start=(0, 0, 2), slope_deg=-10.0,
                            profile="round", width=0.2, wall=0.15, friction=0.0)  # fmt: skip
        scene.sphere("it", radius=BALL, mass=1.0, position=track.place(0.05, BALL), friction=0.0)

    track = bench.run(build, 3.6)
    q, v = track.position("it"), np.linalg.norm(track.velocity("it"), axis=1)
    at = int(np.argmin(np.abs(q[:, 2] - (q[0, 2] - 1.0))))
    return float(v[at]), math.sqrt(2.0 * G * (q[0, 2] - q[at, 2]))


@case("m")
def box_over_seams(bench: Bench) -> tuple[float, float]:
    """A box at 3 m/s on ten level plates of meshes stops after v² / (2 μ g), as on one."""

    def build(scene: Scene) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "plate.stl"
            trimesh.creation.box((0.25, 1.0, 0.1)).export(file)
            for k in range(10):
                scene.mesh(f"plate_{k}", file=file, static=True, position=(0.25 * k, 0, -0.05))
        scene.box("it", size=(0.2, 0.2, 0.2), mass=1.0, position=(0, 0, 0.1), velocity=(3, 0, 0), friction=0.4)

    return bench.run(build, 1.2).moved(), 9.0 / (2 * 0.4 * G)


@case("m/s")
def ball_over_seams(bench: Bench) -> tuple[float, float]:
    """A ball that rolls at 2 m/s over ten plates that do not fit each other's corners still does."""

    def build(scene: Scene) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "plate.stl"
            trimesh.creation.box((0.25, 1.0, 0.1)).export(file)
            for k in range(10):
                scene.mesh(f"plate_{k}", file=file, static=True, position=(0.25 * k, 0.03 * (k % 3), -0.05))
        scene.sphere("it", radius=0.05, mass=1.0, position=(0, 0, 0.05), velocity=(2, 0, 0),
                     angular_velocity_deg=(0, math.degrees(40.0), 0))  # fmt: skip

    return float(bench.run(build, 1.0).velocity("it")[-1, 0]), 2.0


@case("m")
def crate_on_terrain(bench: Bench) -> tuple[float, float]:
    """A crate slides down a field's slope of 25° with μ = 0.3 by g (sin α - μ cos α) t² / 2 in 1 s."""
    lean = math.radians(25.0)

    def build(scene: Scene) -> None:
        scene.height_field("slope", heights=lambda x, y: -math.tan(lean) * x, size=(5, 2), cells=(40, 16))
        place = (-1.5 + 0.1 * math.sin(lean), 0, 1.5 * math.tan(lean) + 0.1 * math.cos(lean))
        scene.box("it", size=(0.2, 0.2, 0.2), mass=1.0, position=place, rotation_deg=(0, 25, 0), friction=0.3)

    return bench.run(build, 1.0).moved(), 0.5 * G * (math.sin(lean) - 0.3 * math.cos(lean))


@case("s")
def compound_pendulum(bench: Bench) -> tuple[float, float]:
    """A hammer of two shapes hung at its handle's end swings by 30° in 4 √(I / (m g d)) K(sin 15°)."""
    handle, head = 700.0 * math.pi * 0.02**2 * 0.4, 7800.0 * 0.12 * 0.05 * 0.05
    mass = handle + head
    arm = (handle * 0.2 + head * 0.4) / mass
    inertia = handle * (0.02**2 / 4 + 0.4**2 / 12 + 0.2**2) + head * ((0.12**2 + 0.05**2) / 12 + 0.4**2)

    def build(scene: Scene) -> None:
        parts = [
            Part("cylinder", radius=0.02, height=0.4, position=(0, 0, -0.2), density=700),
            Part("box", size=(0.12, 0.05, 0.05), position=(0, 0, -0.4), density=7800),
        ]
        hammer = scene.compound("it", parts=parts, position=(0, 0, 1), rotation_deg=(0, 30, 0))
        scene.joint_revolute("pivot", None, hammer, anchor=(0, 0, 1), axis="Y")

    track = bench.run(build, 4.0, rate=200.0)
    swing = track.angle("it", 1) + math.radians(30.0)
    return _period(track.time, swing), _pendulum(inertia / (mass * arm), math.radians(30.0))


def _bowl(file: Path, radius: float) -> Path:
    angle = np.linspace(0.0, math.radians(75.0), 11)
    inner, outer = (r * np.column_stack([np.sin(angle), -np.cos(angle)]) for r in (radius, 1.1 * radius))
    trimesh.creation.revolve(np.concatenate([outer, inner[::-1]]), sections=48).export(file)
    return file


def _pendulum(length: float, swing: float) -> float:
    """Period of a pendulum by the mean of Gauss: 2 π √(l / g) / agm(1, cos(swing / 2))."""
    a, b = 1.0, math.cos(swing / 2)
    for _ in range(8):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return 2 * math.pi * math.sqrt(length / G) / a


def _period(time: np.ndarray, swing: np.ndarray) -> float:
    """From the first to the last time that it comes down through zero."""
    falls = np.flatnonzero((swing[:-1] > 0.0) & (swing[1:] <= 0.0))
    at = time[falls] + swing[falls] / (swing[falls] - swing[falls + 1]) * time[1]
    return float((at[-1] - at[0]) / (len(at) - 1))
