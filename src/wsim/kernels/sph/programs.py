"""The kernels that sum over neighbours, built for one way of searching."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import warp as wp

from wsim.kernels.sph.boundary import make_compress, make_extrapolate
from wsim.kernels.sph.density import make_continuity
from wsim.kernels.sph.momentum import make_momentum
from wsim.kernels.sph.neighbors import make_find_neighbors, make_search
from wsim.kernels.sph.pair_sums import make_pair_sums


@dataclass(frozen=True)
class Programs:
    """Kernels of one way of searching: by lists or by cells, in an open or a periodic domain."""

    find_neighbors: wp.Kernel
    compress: wp.Kernel
    continuity: wp.Kernel
    extrapolate: wp.Kernel
    momentum: wp.Kernel

    @staticmethod
    @functools.cache
    def make(lists: bool, periodic: tuple[bool, bool, bool], branch: bool) -> Programs:
        """Build the kernels, once in a process; see `make_pair_sums`."""
        search, sums = make_search(lists), make_pair_sums(lists, periodic, branch)
        return Programs(
            make_find_neighbors(sums),
            make_compress(search, sums),
            make_continuity(search, sums),
            make_extrapolate(search, sums),
            make_momentum(search, sums),
        )
