"""Newton's kernels forwards only: wsim follows no gradient back through a step.

Warp compiles a kernel's adjoint along with it unless told otherwise, and a machine that meets these modules for
the first time would wait for their adjoints longer than for all else that a first run compiles.
"""

from __future__ import annotations

from importlib import import_module

import warp as wp

LARGE = (  # those of Newton's modules that have adjoints and are large; wsim's own kernels have none
    "newton._src.solvers.mujoco.kernels",
    "newton._src.sim.articulation",
    "mujoco_warp._src.set_const",
    "newton._src.sim.ik.ik_common",
    "newton._src.sim.ik.ik_objectives",
    "newton._src.sim.ik.ik_lm_optimizer",
)


def forward_only() -> None:
    """Have adjoints left out, before the first of these kernels is launched; call it once."""
    for name in LARGE:
        wp.set_module_options({"enable_backward": False}, import_module(name))
