"""Sound worlds of what contacts lead to and fro, or round; and energy that they feed it a little in each step.

A step of the simulator that goes the way of the mean of its first and last velocities is exact where a body
accelerates evenly; where a contact leads it round at w [rad/s] it adds w^2 h / 2 of the energy a second, by forces that
are admissible in every interval between frames.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.judge_families.drawn import Draw, Sound, mechanism
from benchmarks.judge_families.family import SHARE, Faulty, family
from benchmarks.judge_families.record import Array, Track, own, simulated, world_of
from benchmarks.judge_families.stepping import MeanSteps
from wsim.scene import Part, Scene
from wsim.scene.world import World

SECONDS, RATES = 3.0, (30.0, 60.0, 60.0, 120.0)
SMALL, LARGE = 0.01, 0.08  # radius of what leads a body [m]: in larger ones such steps add little
LAST = 0.25  # of the run, whose greatest energy is that at the end


def _begin(scene: Scene, draw: Draw) -> tuple[float, float]:
    """The radius of what leads [m], and how far from the middle the body starts [rad]."""
    scene.simulation(gravity=(0.0, 0.0, -draw.between(3.0, 20.0)), duration=SECONDS, frame_rate=draw.pick(RATES))
    return draw.log(SMALL, LARGE), math.radians(draw.between(10.0, 50.0))


@mechanism("led")
def gutter(scene: Scene, draw: Draw) -> None:
    """A ball rolls to and fro across a gutter, and perhaps along it."""
    wide, lean = _begin(scene, draw)
    radius = wide * draw.between(0.15, 0.5)
    arm, along = wide - radius, draw.pick((0.0, 0.5)) * math.sqrt(wide)
    scene.track("gutter", pieces=[("line", 4.0 + 8.0 * wide)], start=(-1.0, 0, 0), profile="round", width=2 * wide,
                wall=0.9 * wide, thickness=0.15 * wide, friction=1.0)  # fmt: skip
    scene.sphere("ball", radius=radius, density=draw.density(radius), friction=draw.between(0.6, 1.0),
                 position=(0, -arm * math.sin(lean), wide - arm * math.cos(lean)), velocity=(along, 0, 0),
                 angular_velocity_deg=(0, math.degrees(along / radius), 0))  # fmt: skip


@mechanism("led")
def valley(scene: Scene, draw: Draw) -> None:
    """A ball rolls to and fro along a track that is bent up."""
    wide, lean = _begin(scene, draw)
    radius, half = wide * draw.between(0.1, 0.3), 70.0
    turn, arm = math.radians(half), wide - radius
    start = (-wide * math.sin(turn), 0, wide * (1 - math.cos(turn)))
    scene.track("valley", pieces=[("up", wide, 2.0 * half)], start=start, slope_deg=-half, width=3 * radius,
                thickness=0.15 * wide, friction=1.0)  # fmt: skip
    scene.sphere("ball", radius=radius, density=draw.density(radius), friction=draw.between(0.6, 1.0),
                 position=(arm * math.sin(lean), 0, wide - arm * math.cos(lean)))  # fmt: skip


@mechanism("led")
def rocker(scene: Scene, draw: Draw) -> None:
    """A plank rocks on a round post."""
    radius, lean = _begin(scene, draw)
    lean *= 0.5
    thick, length = radius * draw.between(0.1, 0.4), radius * draw.between(4.0, 10.0)
    out, aside = radius + 0.5 * thick, radius * lean
    scene.cylinder("post", radius=radius, height=2 * radius, axis="Y", static=True, friction=1.0)
    scene.box("plank", size=(length, radius, thick), rotation_deg=(0, math.degrees(lean), 0), friction=1.0,
              density=draw.density(length), position=(out * math.sin(lean) - aside * math.cos(lean), 0,
                                                      out * math.cos(lean) + aside * math.sin(lean)))  # fmt: skip


@mechanism("led")
def tumbler(scene: Scene, draw: Draw) -> None:
    """A ball with a weight low in it rolls to and fro on the ground."""
    radius, lean = _begin(scene, draw)
    scene.ground(friction=1.0)
    low = 0.6 * radius
    weight = Part("sphere", radius=0.3 * radius, position=(0, 0, -low), density=8000.0)
    scene.compound("tumbler", parts=[Part("sphere", radius=radius, density=draw.density(radius)), weight],
                   position=(0, 0, radius), rotation_deg=(0, math.degrees(lean), 0))  # fmt: skip


def _energy(track: Track, world: World) -> tuple[Array, Array]:
    """Kinetic and potential energy of all bodies, (T,) each [J]."""
    energies = own(track, world).scalars
    return energies["energy/kinetic_bodies"], energies["energy/potential_bodies"]


def gained(track: Track, world: World) -> float:
    """By how much more than it began with a run ends, as a share of the energy that changed hands at its start."""
    kinetic, potential = _energy(track, world)
    parts = int(LAST * len(kinetic))
    total = kinetic + potential
    return float((total[-parts:].mean() - total[:parts].mean()) / np.ptp(potential[:parts]) / (1.0 - LAST))


@family((0.02, 0.05, 0.1, 0.2), SHARE, ("led",))
def fed_by_contacts(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What a contact leads to and fro gains energy in some of its steps, each by forces that contacts may give."""
    world = world_of(sound.stage)
    most = gained(simulated(sound.stage, MeanSteps(1.0)), world)
    share = math.log1p(size) / max(math.log1p(max(most, 0.0)), 1e-9)
    if share > 1.0:  # the whole of its steps gives less: another world
        return Faulty(simulated(sound.stage), world)
    return Faulty(simulated(sound.stage, MeanSteps(round(share, 4))), world)
