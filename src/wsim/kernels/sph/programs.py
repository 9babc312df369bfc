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
from wsim.kernels.sph.rows import make_rows


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
    def make(
        lists: bool, periodic: tuple[bool, bool, bool], branch: bool, reach: tuple[int, int], bodies: bool
    ) -> Programs:
        """Build the kernels, once in a process; see `make_pair_sums` and `make_rows`."""
        rows, sums = make_rows(reach, periodic), make_pair_sums(lists, periodic, branch, bodies)
        search = make_search(lists, rows)
        return Programs(
            make_find_neighbors(rows, sums),
            make_compress(search, sums),
            make_continuity(search, sums),
            make_extrapolate(search, sums),
            make_momentum(search, sums),
        )
