"""Joint sensors: position, velocity and effort of hinges and sliders."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsim.errors import UserError
from wsim.sim.joint_arrays import joint_indices

if TYPE_CHECKING:
    from wsim.sim.model import Built


class Joints:
    """Reads one sensor in W worlds.

    Args:
        built: The model.
        k: Which of the world's sensors it is.
        interval: Between samples [s].
        seeds: What each world's noise differs by; it has none.

    Attributes:
        spans: Whether a sample tells of the time before it.

    Raises:
        UserError: If one of its joints has no position of its own in the model.
    """

    spans = False

    def __init__(self, built: Built, k: int, interval: float, seeds: Sequence[int]) -> None:
        sensor: Any = built.world.sensors[k]
        closing = {joint.prim for joint in built.world.joints if joint.closing}
        for joint in sensor.joints:
            if joint in closing:
                raise UserError(
                    f"{sensor.prim}: its joint {joint} closes a loop or may break, and has no position of its own; "
                    "leave it out, and read another joint of the loop"
                )
        worlds = max(1, built.model.world_count)
        self._position, self._velocity, _ = joint_indices(built.model, worlds, sensor.joints)

    def __call__(self, t: float, simulation: Any) -> dict[str, NDArray[np.float64]]:
        """`position` [rad or m], `velocity` and `effort` [N m or N], (W, J) each."""
        state, rigid = simulation.state, simulation.rigid
        effort = simulation.control.joint_f.numpy()[self._velocity].astype(np.float64)
        if rigid.driven and t > 0.0:  # no step was taken at the start
            effort += rigid.observables.qfrc_actuator.numpy()[self._velocity]
        return {
            "position": state.joint_q.numpy()[self._position].astype(np.float64),
            "velocity": state.joint_qd.numpy()[self._velocity].astype(np.float64),
            "effort": effort,
        }
