"""The text of a walk over the rows of cells around a position, each trimmed to the sphere that is searched.

A search visits tens of rows for some 150 candidates, so that what a row costs counts: how many there are and which
axes are periodic is put in the text, and what all rows of a plane share is worked out once.
"""

_WALK = """
    const float along = (x0 - grid.offset[0]) * grid.inv_cell[0] - (float)(grid.first[0]);
    const float at_y = (x1 - grid.offset[1]) * grid.inv_cell[1] - (float)(grid.first[1]);
    const float at_z = (x2 - grid.offset[2]) * grid.inv_cell[2] - (float)(grid.first[2]);
    const int nx = grid.count[0], ny = grid.count[1], nz = grid.count[2];
    // What lies beyond the grid is in its rim, as near to the rest as can be.
    const int iy = (int)(WSIM_CLAMP(floorf(at_y), 0.0f, (float)(ny - 1)));
    const int iz = (int)(WSIM_CLAMP(floorf(at_z), 0.0f, (float)(nz - 1)));
    const float beside_y = WSIM_CLAMP(at_y - (float)iy, 0.0f, 1.0f);
    const float beside_z = WSIM_CLAMP(at_z - (float)iz, 0.0f, 1.0f);
    const float reach2 = grid.support * grid.support;
    // A little more, so that rounding never drops a neighbour at the edge of the support.
    const float margin = 0.0005f * grid.support;
    const int* __restrict__ starts = other.cell_start.data;
    #pragma unroll 1
    for (int step_z = -REACH_Z; step_z <= REACH_Z; ++step_z) {
        int jz = iz + step_z;
        WRAP_Z
        if (jz < 0 || jz >= nz) continue;
        const float gap_z = grid.cell[2] * WSIM_GAP(beside_z, (float)step_z);
        const float left_z = reach2 - gap_z * gap_z;
        const int plane = (world * nz + jz) * ny;
        #pragma unroll 1
        for (int step_y = -REACH_Y; step_y <= REACH_Y; ++step_y) {
            int jy = iy + step_y;
            WRAP_Y
            const float gap_y = grid.cell[1] * WSIM_GAP(beside_y, (float)step_y);
            const float left = left_z - gap_y * gap_y;
            if (left <= 0.0f || jy < 0 || jy >= ny) continue;
            const float half = (sqrtf(left) + margin) * grid.inv_cell[0];
            const int* row = starts + (plane + jy) * nx;
            SPAN
            LOOP
            END_SPAN
        }
    }
"""

_OPEN_SPAN = """
            const int first = row[(int)(WSIM_CLAMP(floorf(along - half), 0.0f, (float)(nx - 1)))];
            const int last = row[(int)(WSIM_CLAMP(floorf(along + half), 0.0f, (float)(nx - 1))) + 1];
"""

# A row that wraps is two runs of the sorted list: what is inside, and what comes round from the other end.
_PERIODIC_SPAN = """
            const int low = (int)(floorf(along - half)), high = (int)(floorf(along + half));
            const int parts = low < 0 || high >= nx ? 2 : 1;
            for (int part = 0; part < parts; ++part) {
                const int from = part == 0 ? (low < 0 ? 0 : low) : (low < 0 ? low + nx : 0);
                const int to = part == 0 ? (high < nx ? high + 1 : nx) : (low < 0 ? nx : high - nx + 1);
                const int first = row[from], last = row[to];
"""

HELPERS = """
#if defined(__CUDA_ARCH__)
    #define WSIM_MAX(a, b) fmaxf(a, b)
    #define WSIM_MIN(a, b) fminf(a, b)
#else
    #define WSIM_MAX(a, b) ((a) > (b) ? (a) : (b))
    #define WSIM_MIN(a, b) ((a) < (b) ? (a) : (b))
#endif
    #define WSIM_CLAMP(x, low, high) WSIM_MIN(WSIM_MAX(x, low), high)
    // From a place in a cell to the cell so many steps further on, in cells.
    #define WSIM_GAP(beside, steps) WSIM_MAX(WSIM_MAX((steps) - beside, beside - (steps) - 1.0f), 0.0f)
"""


def walk(loop: str, reach: tuple[int, int], periodic: tuple[bool, bool, bool]) -> str:
    """The walk of a position `x0, x1, x2` in a `world` over the cells of `other`, in C++.

    Args:
        loop: What is done with the run `[first, last)` of the sorted list.
        reach: Cells that the support spans along y and z.
        periodic: Which axes are.
    """
    wrap = "j{0} = j{0} < 0 ? j{0} + n{0} : (j{0} >= n{0} ? j{0} - n{0} : j{0});"
    text = _WALK.replace("REACH_Y", str(reach[0])).replace("REACH_Z", str(reach[1]))
    text = text.replace("WRAP_Y", wrap.format("y") if periodic[1] else "")
    text = text.replace("WRAP_Z", wrap.format("z") if periodic[2] else "")
    text = text.replace("END_SPAN", "}" if periodic[0] else "")
    text = text.replace("SPAN", _PERIODIC_SPAN if periodic[0] else _OPEN_SPAN)
    return HELPERS + text.replace("LOOP", loop)
