"""A sliding gate held by a force law with memory; a class keeps the controller's state."""
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wsim.scene import Drive, Scene


@dataclass
class Pid:
    kp: float
    ki: float = 0.0
    kd: float = 0.0
    limit: float = 100.0
    _sum: NDArray | float = field(default=0.0, repr=False)

    def __call__(self, error: NDArray, rate: NDArray, dt: float) -> NDArray:
        self._sum = np.clip(self._sum + error * dt, -1.0, 1.0)
        return np.clip(self.kp * error + self.ki * self._sum - self.kd * rate, -self.limit, self.limit)


PID = Pid(kp=120.0, ki=20.0, kd=15.0)
_last = {"t": 0.0}


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0)
    scene.ground()
    frame = scene.box("frame", size=(0.1, 0.6, 0.1), position=(0, 0, 1.2), static=True)
    gate = scene.box("gate", size=(0.04, 0.4, 0.5), position=(0, 0, 0.6), mass=4.0)
    scene.joint_prismatic("lift", frame, gate, axis="Z", limits=(-0.3, 0.4), drive=Drive(damping=2.0))
    scene.camera("front", eye=(3, 0, 1), target=(0, 0, 0.7))


def control(world, t):
    dt, _last["t"] = t - _last["t"], t
    lift = world.joint("lift")
    goal = 0.2 if t > 0.5 else 0.0
    lift.force = 4.0 * 9.81 + PID(goal - lift.position, lift.velocity, dt)
    assert "/World/gate" in world.bodies and len(world.joints) == 1
