"""Joints that break: what a constraint bears is read off its rows after each solution.

A joint that bears more than it can is brittle: it gives way before the step is made, which is then solved again without
it, so it passes on nothing in the step in which it breaks. Of several the weakest for its load goes first, and the
others may be relieved: a chain breaks at one link. As many break in a step as must; with a CUDA driver before 12.4,
whose graphs have no loops, one in each world.

A blow of a rigid world has no duration: it counts as lasting a set time, whatever the step. What meets without a bounce
would share its blow between two steps; for what breaks all of it counts at once (`wsim.solvers.targets.at_once`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.breaking import bear, break_worst, find_rows, note_struck, sum_up

Array = np.ndarray
POINTS = 2  # of a hinge; a ball joint has one, a weld is one row
CONNECT, WELD = 0, 1  # mjtEq


@dataclass(frozen=True)
class Breakable:
    """A joint that may break: its rows of `mujoco:equality_constraint`, and the loads [N], [N m] that break it."""

    prim: str
    rows: tuple[int, ...]
    force: float
    torque: float


class BreakingC:
    """Joints that break, one world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        constraints: MuJoCo's equality constraints of each joint.
        strength: (1, joints, 2), the force [N] and the torque [N m] that each bears.

    Attributes:
        broken: (1, joints), whether each is broken.
        load: (1, joints, 2), the largest force and torque that each bore since it was last set to 0.
    """

    def __init__(self, mujoco: Any, model: Any, constraints: Sequence[Sequence[int]], strength: Array) -> None:
        self.mujoco, self.model, self.constraints, self.strength = mujoco, model, constraints, strength[0]
        self.broken = np.zeros((1, len(constraints)), dtype=bool)
        self.load = np.zeros((1, len(constraints), 2))

    def give_way(self, data: Any, force: Array) -> bool:
        """Break what bears most, by its strength, if that is too much; whether the step must be made anew.

        Args:
            data: MuJoCo's.
            force: Of its constraint rows [N, N m], (rows,).
        """
        equality = data.efc_type == self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        whole = np.flatnonzero(~self.broken[0])
        if not len(whole):
            return False
        loads = np.array([self._load(data, force, equality, self.constraints[k]) for k in whole.tolist()])
        shares = (loads / self.strength[whole]).max(axis=1)
        worst = int(np.argmax(shares))
        if shares[worst] > 1.0:
            self.broken[0, whole[worst]] = True
            self.load[0, whole[worst]] = np.maximum(self.load[0, whole[worst]], loads[worst])
            data.eq_active[list(self.constraints[whole[worst]])] = 0
            return True
        self.load[0, whole] = np.maximum(self.load[0, whole], loads)
        return False

    def _load(self, data: Any, force: Array, equality: Array, own: Sequence[int]) -> tuple[float, float]:
        model = self.model
        forces = [force[np.flatnonzero(equality & (data.efc_id == c))] for c in own]
        if model.eq_type[own[0]] == WELD:
            # Its last rows are the vector part of a quaternion, half the angle.
            scale = 0.5 * model.eq_data[own[0], 10]
            return float(np.linalg.norm(forces[0][:3])), scale * float(np.linalg.norm(forces[0][3:]))
        if len(own) < POINTS:
            return float(np.linalg.norm(forces[0])), 0.0
        turn = data.xmat[model.eq_obj1id[own[0]]].reshape(3, 3)
        arm = turn @ (0.5 * (model.eq_data[own[1], :3] - model.eq_data[own[0], :3]))
        torque = np.cross(arm, forces[1] - forces[0])
        return float(np.linalg.norm(forces[0] + forces[1])), float(np.linalg.norm(torque))

    def release(self, data: Any, joint: int) -> None:
        """Let a joint go, whatever it bears."""
        self.broken[0, joint] = True
        data.eq_active[list(self.constraints[joint])] = 0

    def clear(self, data: Any) -> None:
        """Mend all joints."""
        self.broken[:], self.load[:] = False, 0.0
        data.eq_active[[c for own in self.constraints for c in own]] = 1

    def take(self) -> tuple[Array, Array]:
        """`broken` and `load`; the loads start anew."""
        taken = self.broken.copy(), self.load.copy()
        self.load[:] = 0.0
        return taken


class BreakingWarp:
    """The same for all worlds of a batch, in MuJoCo Warp; for the arguments see `BreakingC`.

    `strength` is (N, joints, 2), N = 1 where all worlds are alike.

    Attributes:
        constraint: (joints, 2), MuJoCo's constraints of each, the second -1 where there is one alone.
        anew: (worlds,), whether something broke since the last `begin`.
        again: (1,), whether anything did in the last solution, so that others may be relieved by the next.
    """

    def __init__(self, model: Any, constraints: Sequence[Sequence[int]], strength: Array, worlds: int) -> None:
        count = len(constraints)
        pairs = np.array([[own[0], own[1] if len(own) == POINTS else -1] for own in constraints], dtype=np.int32)
        self.constraint = wp.array(pairs, dtype=wp.int32)
        self._strength = wp.array(np.minimum(strength, 1e30).astype(np.float32), dtype=wp.float32)
        self._own = wp.array(pairs[pairs >= 0], dtype=wp.int32)
        self._now = wp.zeros((worlds, count), dtype=wp.spatial_vector)
        self._blown: Any = wp.zeros((worlds, count), dtype=wp.spatial_vector)
        self._struck: Any = wp.zeros(worlds, dtype=wp.int32)
        self._row = wp.full((worlds, model.neq), -1, dtype=wp.int32)
        self.anew: Any = wp.zeros(worlds, dtype=wp.int32)
        self.again = wp.zeros(1, dtype=wp.int32)
        self.broken = wp.zeros((worlds, count), dtype=wp.int32)
        self.load = wp.zeros((worlds, count), dtype=wp.vec2)

    def begin(self) -> None:
        """A step begins, in which nothing was struck yet, and nothing breaks."""
        self._blown.zero_()
        self.anew.zero_()
        self._struck.zero_()

    def give_way(self, model: Any, data: Any, share: float = 1.0, *, struck: bool = False) -> None:
        """Break what bears most, if that is too much, in each world by itself, and note in `again` if anything did.

        Args:
            model: MuJoCo Warp's.
            data: MuJoCo Warp's, with the forces of what acts.
            share: For which that does, of the time that a blow lasts, or of the step.
            struck: Of worlds that were struck, or of those that were not.
        """
        self._measure(model, data)
        self.again.zero_()
        wp.launch(
            break_worst,
            dim=data.nworld,
            inputs=[
                self.constraint, self._strength, self._row, model.eq_type, self._now, share, self._blown,
                self._struck, int(struck),
            ],
            outputs=[self.again, self.anew, self.broken, self.load, data.efc.D, data.eq_active],
        )  # fmt: skip

    def add_blow(self, model: Any, data: Any, share: float) -> None:
        """Count the forces of a round of blows to what acts in the step: none in worlds that it is none of."""
        self._measure(model, data)
        wp.launch(sum_up, dim=self.broken.shape, inputs=[self._now, share], outputs=[self._blown])

    def end_blows(self, state: Any) -> None:
        """Note which worlds were struck, by the `state` of their rounds of blows."""
        wp.launch(note_struck, dim=self.anew.shape, inputs=[state], outputs=[self._struck])

    def _measure(self, model: Any, data: Any) -> None:
        efc = data.efc
        self._row.fill_(-1)
        wp.launch(find_rows, dim=(data.nworld, data.njmax), inputs=[data.nefc, efc.type, efc.id], outputs=[self._row])
        wp.launch(
            bear,
            dim=self.broken.shape,
            inputs=[
                self.constraint, self._row, model.eq_type, model.eq_data, model.eq_obj1id, data.xmat, efc.force,
            ],
            outputs=[self._now],
        )  # fmt: skip

    def clear(self, data: Any) -> None:
        """Mend all joints."""
        self.broken.zero_()
        self.load.zero_()
        active = data.eq_active.numpy()
        active[:, self._own.numpy()] = True
        data.eq_active.assign(active)

    def take(self) -> tuple[Array, Array]:
        """`broken` and `load` of all worlds; the loads start anew."""
        taken = self.broken.numpy().astype(bool), self.load.numpy().astype(np.float64)
        self.load.zero_()
        return taken
