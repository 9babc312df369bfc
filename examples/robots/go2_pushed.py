"""A robot dog walks in a circle and is pushed from a side drawn at random, every three seconds; it stays on its legs.

A push is a force on its base for 0.1 s that gives all of it, were it free, a change of velocity of 1 m/s: 152 N. That
is the most by which policies of such robots are pushed as they are trained, there every 15 s (Rudin, Hoeller, Reist,
Hutter 2022, "Learning to Walk in Minutes Using Massively Parallel Deep Reinforcement Learning").
"""

from __future__ import annotations

import numpy as np

from wsim.scene import Scene

MASS = 15.2  # of the whole robot [kg]
CHANGE = 1.0  # [m/s]
LONG = 0.1  # [s]
EVERY = 3.0  # [s], the first one after as long
SIDES = np.random.default_rng(7).uniform(0.0, 2.0 * np.pi, 1000)  # which way each one goes, about z [rad]


def build(scene: Scene) -> None:
    duration = scene.param("duration", 60.0, low=1.0, high=600.0, unit="s")
    scene.simulation(duration=duration, frame_rate=25.0)
    scene.ground()
    dog = scene.robot("go2", position=(0.0, -1.0, 0.0))
    scene.policy("walk", dog, "go2_walk", command=(0.5, 0.0, 0.5))
    scene.camera("beside", eye=(2.6, -3.4, 1.8), target=(0.0, 0.0, 0.2))


def control(world, t: float) -> None:
    push, since = divmod(t + 1e-6, EVERY)  # calls come at whole hundredths of a second, to rounding
    if push and since < LONG:
        force, side = MASS * CHANGE / LONG, SIDES[int(push)]
        world.apply_force("base", (force * np.cos(side), force * np.sin(side), 0.0))


if __name__ == "__main__":
    from wsim import run

    run(build)
