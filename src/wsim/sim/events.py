"""What happens once in the first world of a simulation, and its log tells: joints break, bodies leave the fluid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from wsim.sim.model import Built
    from wsim.solvers.solver_sph import SolverSPH


class Events:
    """Tells of each event once.

    Args:
        built: The model.
        fluid: Its fluid, where there is one.
    """

    def __init__(self, built: Built, fluid: SolverSPH | None) -> None:
        self._built, self._fluid = built, fluid
        self._were_inside: set[str] = set()
        self._broken: set[str] = set()

    def breakages(self, scalars: Mapping[str, float]) -> list[tuple[str, str]]:
        """Joints that have broken since the last call, by a frame's scalars: prim and what to say."""
        found = []
        for joint in self._built.breakable[0]:
            name = joint.prim.removeprefix("/World")
            if scalars[f"broken{name}"] and joint.prim not in self._broken:
                self._broken.add(joint.prim)
                force, torque = scalars[f"force{name}"], scalars[f"torque{name}"]
                bears = force > joint.force or torque > joint.torque
                how = f"breaks under {force:.4g} N and {torque:.4g} N m" if bears else "lets go"
                found.append((joint.prim, f"{joint.prim} {how}"))
        return found

    def departures(self, state: Any) -> list[tuple[str, str]]:
        """Bodies that have left the fluid's domain since the last call: prim and what to say."""
        fluid = self._fluid
        if not fluid:
            return []
        outside = set(fluid.bodies_outside(state))
        bodies = zip(self._built.world.bodies, self._built.bodies, strict=True)
        prims = {body.prim: index in outside for body, index in bodies}
        gone = [prim for prim, is_outside in prims.items() if is_outside and prim in self._were_inside]
        self._were_inside = {prim for prim, is_outside in prims.items() if not is_outside}
        low, high = (np.round(corner, 3).tolist() for corner in fluid.domain)
        return [(prim, f"{prim} has left the fluid's domain, {low} to {high} m: no fluid is there") for prim in gone]
