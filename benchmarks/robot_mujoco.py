"""The Go2 by its policy in MuJoCo itself, from the same file: over kerbs, and pushed as the examples push it.

    .venv/bin/wsim assets pull go2
    .venv/bin/python benchmarks/robot_mujoco.py --kerbs 0.03 0.09 0.15 --pushes 1.0 1.5 2.0 2.5

Kerbs are those of examples/robots/go2_kerbs.py, at 0.7 m/s for 6 s. Pushes come while it walks in a circle for 30 s.
"""

from __future__ import annotations

import argparse
import runpy
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.assets.policies import PolicySpec, policy
from wsim.assets.sources import source
from wsim.assets.wheels import fetch
from wsim.scene.world import Policy
from wsim.sim.commands import Commands
from wsim.sim.networks import read_network
from wsim.sim.policies import axes

EXAMPLES = Path(__file__).resolve().parents[1] / "examples" / "robots"
STEP = 0.00125  # [s], 16 of them between two turns of the policy
HOME, HEIGHT = np.tile([0.0, 0.8, -1.5], 4), 0.335  # [rad], [m]
EFFORT = np.tile([23.7, 23.7, 45.43], 4)  # [N m]
FALLEN = 0.5  # of the cosine of how far it leans


class Dog:
    """A Go2 in MuJoCo, and its policy.

    Args:
        command: Forward, to the left [m/s], turning to the left [rad/s].
        kerbs: Where each begins and ends along x [m].
        height: Theirs [m].
    """

    def __init__(
        self, command: tuple[float, float, float], kerbs: tuple[tuple[float, float], ...] = (), height: float = 0.0
    ) -> None:
        self.spec, network, _ = policy("go2_walk")
        self.network = read_network(network, self.spec.size, len(self.spec.joints))
        file = mujoco.MjSpec.from_file(str(fetch(source("go2")) / source("go2").robot))
        file.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 0.1])
        for first, last in kerbs:
            size, place = [0.5 * (last - first), 1.0, 0.5 * height], [0.5 * (first + last), 0.0, 0.5 * height]
            file.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=place)
        self.model = file.compile()
        self.model.opt.timestep = STEP
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name).id for name in self.spec.joints]
        self.at, self.dof = self.model.jnt_qposadr[joints], self.model.jnt_dofadr[joints]
        self.data.qpos[2], self.data.qpos[self.at] = HEIGHT, HOME
        self.commands = Commands([
            Policy(prim="/p", base="/b", joints=self.spec.joints, network="", sha256="", spec=self.spec,
                   commands=[command])
        ])  # fmt: skip
        self.action = np.zeros(len(joints))

    def turn(self) -> np.ndarray:
        """Ask the policy; where the servos are to go [rad]."""
        data, spec = self.data, self.spec
        own = axes(np.roll(data.qpos[3:7], -1)[None])[0]
        heading = own[0, :2] / np.linalg.norm(own[0, :2])
        ahead, left = data.qvel[:2] @ heading, data.qvel[1] * heading[0] - data.qvel[0] * heading[1]
        measured = np.array([[ahead, left, (own.T @ data.qvel[3:6])[2]]])
        seen: dict[str, Any] = {
            "angular_velocity": data.qvel[3:6],
            "gravity": -own[:, 2],
            "command": self.commands.at(data.time, measured, np.zeros((1, 3)))[0],
            "joint_position": data.qpos[self.at],
            "joint_velocity": data.qvel[self.dof],
            "last_action": self.action,
        }
        x = np.clip(observed(spec, seen), -spec.observation_limit, spec.observation_limit)
        self.action = np.clip(self.network(x[None])[0].astype(float), -spec.action_limit, spec.action_limit)
        return np.asarray(spec.action_offset) + np.asarray(spec.action_scale) * self.action

    def walk(self, seconds: float, push: Any = None) -> str:
        """What comes of it, in a line; `push` gives a force on the base at a time [N], (3,)."""
        heights, leans, goal = [], [], HOME
        for k in range(round(seconds / STEP)):
            if k % 16 == 0:
                goal = self.turn()
                leans.append(1.0 - 2.0 * (self.data.qpos[4] ** 2 + self.data.qpos[5] ** 2))
                heights.append(self.data.qpos[2])
                if leans[-1] < FALLEN:
                    return f"falls at {self.data.time:.1f} s, x = {self.data.qpos[0]:.2f} m"
            effort = 20.0 * (goal - self.data.qpos[self.at]) - 0.5 * self.data.qvel[self.dof]
            self.data.qfrc_applied[self.dof] = np.clip(effort, -EFFORT, EFFORT)
            if push:
                self.data.xfrc_applied[1, :3] = push(self.data.time)  # the first body is the base
            mujoco.mj_step(self.model, self.data)
        x, y = self.data.qpos[:2]
        return (
            f"stays up: at x = {x:.2f} m, y = {y:.2f} m in the end, its base {min(heights):.3f} to "
            f"{max(heights):.3f} m high, leans by {np.degrees(np.arccos(min(leans))):.1f} deg at most"
        )


def observed(spec: PolicySpec, seen: dict[str, Any]) -> np.ndarray:
    """What the network sees."""
    parts = [np.asarray(each.scale) * (seen[each.of] - np.asarray(each.offset)) for each in spec.observations]
    return np.concatenate(parts).astype(np.float32)


def main() -> None:
    """Print a line for each kerb and each push."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kerbs", type=float, nargs="*", default=[], help="heights [m]")
    parser.add_argument("--pushes", type=float, nargs="*", default=[], help="changes of velocity [m/s]")
    args = parser.parse_args()
    for height in args.kerbs:
        kerbs = runpy.run_path(str(EXAMPLES / "go2_kerbs.py"))["KERBS"]
        print(f"kerbs of {100 * height:g} cm: {Dog((0.7, 0.0, 0.0), kerbs, height).walk(6.0)}", flush=True)
    pushed = runpy.run_path(str(EXAMPLES / "go2_pushed.py"))
    for change in args.pushes:

        def push(t: float, change: float = change) -> np.ndarray:
            which, since = divmod(t + 1e-6, pushed["EVERY"])
            if not which or since >= pushed["LONG"]:
                return np.zeros(3)
            side = pushed["SIDES"][int(which)]
            return pushed["MASS"] * change / pushed["LONG"] * np.array([np.cos(side), np.sin(side), 0.0])

        print(f"pushes of {change:g} m/s: {Dog((0.5, 0.0, 0.5)).walk(30.0, push)}", flush=True)


if __name__ == "__main__":
    main()
