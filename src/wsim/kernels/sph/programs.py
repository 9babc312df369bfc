"""The kernels that sum over neighbours, built for one way of searching."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import warp as wp

from wsim.kernels.sph.boundary import make_compress, make_extrapolate
from wsim.kernels.sph.density import make_continuity
from wsim.kernels.sph.momentum import make_momentum
from wsim.kernels.sph.neighbors import Finders, make_finders
from wsim.kernels.sph.pair_sums import make_pair_sums
from wsim.kernels.sph.pipes import make_fill
from wsim.kernels.sph.push import make_look_across, make_push
from wsim.kernels.sph.yielding import make_stages, make_yield


@dataclass(frozen=True)
class Programs:
    """Kernels of one way of searching: by lists or by cells, in an open or a periodic domain."""

    find: Finders
    compress: wp.Kernel
    continuity: wp.Kernel
    fill: wp.Kernel
    extrapolate: wp.Kernel
    momentum: wp.Kernel
    look_across: wp.Kernel
    push: wp.Kernel
    yields: wp.Kernel
    stages: tuple[wp.Kernel, wp.Kernel]

    @staticmethod
    @functools.cache
    def make(
        lists: bool,
        periodic: tuple[bool, bool, bool],
        branch: bool,
        reach: tuple[int, int],
        solids: tuple[int, ...],
        several: bool = False,
        yields: bool = False,
    ) -> Programs:
        """Build the kernels, once in a process; see `make_pair_sums`.

        Args:
            lists: Search by lists, or by walking cells.
            periodic: Which axes are.
            branch: Pass over what lies beyond the support.
            reach: Cells that the support spans along y and z.
            solids: `WALLS`, `BODIES`, both or none: the kinds of solids that there are.
            several: Whether each particle of fluid has its own liquid.
            yields: Whether any of these yields.
        """
        sums = make_pair_sums(lists, periodic, branch, reach, several, yields)
        return Programs(
            make_finders(sums, solids),
            make_compress(sums),
            make_continuity(sums, solids),
            make_fill(sums),
            make_extrapolate(sums),
            make_momentum(sums, solids),
            make_look_across(sums, solids),
            make_push(sums, solids),
            make_yield(sums, solids),
            make_stages(sums, solids),
        )
