"""The loops over neighbours, written natively: all the time of a step is spent here.

Warp's own loops load a record in four pieces and keep a CPU from using its vector units. Measured on one core of an
AMD EPYC the same continuity sum takes 46 ms as a Warp loop and 24 ms so; on a GPU the 16-byte loads count. The text of
a loop is put together from choices that must cost nothing per pair: entries of a list or runs of cells, which axes are
periodic, whether to branch, and what is summed.

Every sum is over the neighbours of one kind, `other`, of particle s of `own`. It takes that one's world, position x,
velocity v and pressure p, `shape` of `density.Method`, and `common`: what is the same for all pairs, the weight of the
fluid rho_0 g [N/m^3] or, in the momentum equation, artificial and laminar factor and what is added to r^2. Where a
world has several liquids a pair has its own (`liquids`).
"""

from dataclasses import dataclass
from typing import Any

import warp as wp

from wsim.kernels.sph.creep_sums import CREEP, SHEAR, mirrored
from wsim.kernels.sph.gap_sums import ACROSS, BEHIND, BEYOND, GAP, GRADIENT, SEEPING, WAY, between
from wsim.kernels.sph.grid import Grid
from wsim.kernels.sph.liquids import (
    AMONG_LIQUIDS,
    EXTRAPOLATED_LIQUIDS,
    LIQUID_AT_SOLIDS,
    MORE_EXTRAPOLATED,
    ONE,
    SOLIDS_IN_LIQUIDS,
    Words,
    put,
)
from wsim.kernels.sph.rows import walk
from wsim.kernels.sph.species import BODIES, DRY, FLUID, KINDS, WALLS, Species

BLOCK = 128  # threads of a CUDA block; 3 % quicker than 256 for sums over neighbours, on an H200

# Sums of W, of W times pressure, and of V v.grad W of what has no void beside it.
Flux = wp.vec3

# Force per volume (3), sum of V W, and the way out of the wall (3), up to a factor.
AtWalls = wp.types.vector(length=7, dtype=wp.float32)

# Force per volume (3) of others across a gap, how many there are, wet or dry, their sum of V grad W (3), and that over
# the same body (3).
Gap = wp.types.vector(length=10, dtype=wp.float32)

# Sums of W, of W times pressure, of W times velocity (3), and of W times the way to the fluid (3).
Extrapolated = wp.types.vector(length=8, dtype=wp.float32)

_SUM = """
#if defined(__CUDA_ARCH__)
    typedef float4 Record;
    typedef float2 Liquid;
    #define WSIM_LOAD(records, j) __ldg((records) + j)
    #define WSIM_SATURATE(x) __saturatef(x)
#else
    struct Record { float x, y, z, w; };
    struct Liquid { float x, y; };
    #define WSIM_LOAD(records, j) (records)[j]
    #define WSIM_SATURATE(x) ((x) > 0.0f ? (x) : 0.0f)
#endif
    const Record* __restrict__ points = reinterpret_cast<const Record*>(other.point.data);
    const Record* __restrict__ motions = reinterpret_cast<const Record*>(other.motion.data);
    const float x0 = x[0], x1 = x[1], x2 = x[2];
    const float inv_support = shape[0], slope_norm = shape[1], support2 = shape[2];
    OWN_LIQUID
    BEFORE
    SEARCH
    #undef WSIM_LOAD
    #undef WSIM_SATURATE
    AFTER
"""

_RUN = """
#if defined(__CUDA_ARCH__)
    #pragma unroll UNROLL
#else
    VECTORIZE
#endif
    for (int k = first; k < last; ++k) {
        const int j = INDEX;
        const Record q = WSIM_LOAD(points, j);
        float d0 = x0 - q.x, d1 = x1 - q.y, d2 = x2 - q.z;
        IMAGES
        const float r2 = d0 * d0 + d1 * d1 + d2 * d2;
        IF_NEAR {
            const Record n = WSIM_LOAD(motions, j);
            ITS_LIQUID
            const float u = sqrtf(r2) * inv_support;
            const float t = WSIM_SATURATE(1.0f - u), t2 = t * t;
            TERM
        }
    }
"""

# The entries of a particle are its fluid neighbours, then walls, then bodies.
_LISTED = """
    const int* __restrict__ entries = own.entry.data;
    const wp::vec_t<3, int> counts = own.entry_count.data[s];
    const int first = s * own.capacity OTHERS, last = first + counts[KIND];
    LOOP
"""
_OTHERS = {FLUID: "", WALLS: "+ counts[0]", BODIES: "+ counts[0] + counts[1]"}

_CONTINUITY = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2], w0 = common[0], w1 = common[1], w2 = common[2];
    float divergence = 0.0f, smoothing = 0.0f, filled = 0.0f;
    """,
    """
            const float slope = q.w * (t2 * t);
            divergence += slope * ((v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2);
            smoothing -= WITHIN_LIQUID slope * (n.w - p + w0 * d0 + w1 * d1 + w2 * d2);
            filled += slope * r2;
    """,
    "return wp::vec_t<3, float>(slope_norm * divergence, slope_norm * smoothing, -slope_norm * filled);",
)

_CONTINUITY_AT_WALLS = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2];
    float divergence = 0.0f, given_back = 0.0f, filled = 0.0f;
    """,
    """
            const float slope = q.w * (t2 * t);
            divergence += slope * ((v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2);
            given_back += t2 * t2 * (1.0f + 4.0f * u) * n.w;
            filled += slope * r2;
    """,
    "return wp::vec_t<3, float>(slope_norm * divergence, given_back, -slope_norm * filled);",
)

_CONTINUITY_AT_BODIES = (
    """
    const Record* __restrict__ handeds = reinterpret_cast<const Record*>(other.handed.data);
    const float v0 = v[0], v1 = v[1], v2 = v[2], w0 = common[0], w1 = common[1], w2 = common[2];
    float divergence = 0.0f, presence = 0.0f, filled = 0.0f, seeping = 0.0f;
    """,
    """
            const Record h = WSIM_LOAD(handeds, j);
            const float slope = q.w * (t2 * t);
            divergence += slope * ((v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2);
            presence += t;
            filled += slope * r2;
            seeping -= h.x > 0.5f * DRY_PRESSURE ? slope * (h.x - p + w0 * d0 + w1 * d1 + w2 * d2) : 0.0f;
    """,
    "return wp::vec_t<4, float>(slope_norm * divergence, presence, -slope_norm * filled, slope_norm * seeping);",
)

_FLUX = (
    """
    const float* __restrict__ fulls = other.full.data;
    const float w0 = common[0], w1 = common[1], w2 = common[2];
    float total = 0.0f, pressure = 0.0f, flux = 0.0f;
    """,
    """
            const float w = t2 * t2 * (1.0f + 4.0f * u);
            total += w;
            pressure += w * (n.w + ITS_DENSITY (w0 * d0 + w1 * d1 + w2 * d2));
            flux -= fulls[j] * q.w * (t2 * t) * (n.x * d0 + n.y * d1 + n.z * d2);
    """,
    "return wp::vec_t<3, float>(total, pressure, slope_norm * flux);",
)

_EXTRAPOLATION = (
    """
    const float w0 = common[0], w1 = common[1], w2 = common[2];
    float total = 0.0f, pressure = 0.0f, f0 = 0.0f, f1 = 0.0f, f2 = 0.0f, o0 = 0.0f, o1 = 0.0f, o2 = 0.0f;
    """,
    """
            const float w = t2 * t2 * (1.0f + 4.0f * u);
            total += w;
            pressure += w * (n.w + ITS_DENSITY (w0 * d0 + w1 * d1 + w2 * d2));
            f0 += w * n.x;
            f1 += w * n.y;
            f2 += w * n.z;
            o0 -= w * d0;
            o1 -= w * d1;
            o2 -= w * d2;
    """,
    """
    wp::vec_t<8, float> sums;
    sums[0] = total, sums[1] = pressure, sums[2] = f0, sums[3] = f1, sums[4] = f2;
    sums[5] = o0, sums[6] = o1, sums[7] = o2;
    return sums;
    """,
)

_OF_LIQUIDS = (
    (
        _EXTRAPOLATION[0] + MORE_EXTRAPOLATED[0],
        _EXTRAPOLATION[1] + MORE_EXTRAPOLATED[1],
        _EXTRAPOLATION[2].replace("wp::vec_t<8, float> sums;", MORE_EXTRAPOLATED[2]),
    ),
    EXTRAPOLATED_LIQUIDS,
)

_FREE = (
    """
    const int* __restrict__ orders = other.order.data;
    const int* __restrict__ stages = other.stage.data;
    const float w0 = common[0], w1 = common[1], w2 = common[2];
    float total = 0.0f, pressure = 0.0f;
    """,
    """
            const float w = stages[orders[j]] == 0 ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            total += w;
            pressure += w * (n.w + w0 * d0 + w1 * d1 + w2 * d2);
    """,
    "return wp::vec_t<2, float>(total, pressure);",
)

_MOMENTUM = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2];
    const float artificial = common[0], laminar = common[1], eta2 = common[2];
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;
    """,
    """
            const float approach = (v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2;
            const float push = approach < 0.0f ? (ARTIFICIAL + LAMINAR) * approach : LAMINAR * approach;
            const float slope = q.w * (t2 * t);
            const float force = slope * (push / (r2 + eta2) - p - n.w);
            a0 += force * d0;
            a1 += force * d1;
            a2 += force * d2;
    """,
    "return wp::vec_t<3, float>(slope_norm * a0, slope_norm * a1, slope_norm * a2);",
)

_MOMENTUM_AT_WALLS = (
    _MOMENTUM[0] + "float share = 0.0f, n0 = 0.0f, n1 = 0.0f, n2 = 0.0f;",
    _MOMENTUM[1]
    + """
            share += q.w * (t2 * t2) * (1.0f + 4.0f * u);
            n0 += slope * d0;
            n1 += slope * d1;
            n2 += slope * d2;
    """,
    """
    wp::vec_t<7, float> sums;
    sums[0] = slope_norm * a0, sums[1] = slope_norm * a1, sums[2] = slope_norm * a2;
    sums[3] = -0.05f * slope_norm * support2 * share;  // W is norm t^4 (1 + 4 u), and slope_norm -5 norm / h^2
    sums[4] = n0, sums[5] = n1, sums[6] = n2;
    return sums;
    """,
)

_FIND = """
    struct Record { float x, y, z, w; };
    const Record* __restrict__ points = reinterpret_cast<const Record*>(other.point.data);
    const int capacity = own.capacity;
    int* __restrict__ found = own.entry.data + s * capacity;
    const float x0 = x[0], x1 = x[1], x2 = x[2];
    int count = start;
    SEARCH
    return count;
"""

_FIND_RUN = """
    for (int j = first; j < last; ++j) {
        const Record q = points[j];
        float d0 = x0 - q.x, d1 = x1 - q.y, d2 = x2 - q.z;
        IMAGES
        // Written first and counted after: a branch here would be mispredicted half the time.
        found[count < capacity ? count : capacity - 1] = j;
        count += (d0 * d0 + d1 * d1 + d2 * d2 < reach2) & (j != itself);
    }
"""


@dataclass(frozen=True)
class PairSums:
    """The native loops of one way of searching. W stands for W up to a factor; v_ij is v_i - v_j.

    Attributes:
        continuity: Over fluid: sums of V_j v_ij.grad W, of the density diffusion, and of -V_j x_ij.grad W.
        continuity_at_walls: Over walls: sums of V_j v_ij.grad W, of W times what a wall gives back, and of
            -V_j x_ij.grad W.
        continuity_at_bodies: Over bodies: sums of V_j v_ij.grad W, of 1 - r / 2h, of -V_j x_ij.grad W, and of the
            density diffusion over those that hand on a pressure in a gap.
        flux: `Flux`, over fluid around what stands still.
        extrapolation: `Extrapolated`, over fluid.
        free: Sums of W and of W times pressure, over fluid that no opening leads.
        force: Force on a particle of fluid per volume, over fluid or bodies.
        force_on_solid: Force on a particle of a solid per volume, over fluid.
        force_at_walls: `AtWalls`, over walls.
        way: Sum of W times the way to them, over walls or other bodies.
        force_in_gap: `Gap`, over walls or bodies. Takes the particle's pressure and the least that there is as v, the
            weight of the fluid as `common`.
        gradient: Sum of V grad W, over fluid.
        creep: Force on a particle of fluid by the laminar viscosity alone per volume, over each kind.
        creep_on_solid: The same on a particle of a solid, over fluid.
        shear: Sums of -V_j (v_ij.x_ij)^2 / r^2 dW/dr / r and of -V_j x_ij.grad W, over each kind.
        seeping: Sums of W and of W times pressure, and the fewest hops, over what its own body's particles hand on.
        find: Write the neighbours of one kind behind `start` others, but `itself`; returns how many there are then.
            For lists alone.
        several: Whether each particle of fluid has its own liquid.
        yields: Whether any of these yields.
        options: What `wp.kernel` is to do with a kernel that sums.
    """

    continuity: wp.Function
    continuity_at_walls: wp.Function
    continuity_at_bodies: wp.Function
    flux: wp.Function
    extrapolation: wp.Function
    free: wp.Function
    force: dict[int, wp.Function]
    force_on_solid: wp.Function
    force_at_walls: wp.Function
    way: dict[int, wp.Function]
    force_in_gap: dict[int, wp.Function]
    gradient: wp.Function
    creep: dict[int, wp.Function]
    creep_on_solid: wp.Function
    shear: dict[int, wp.Function]
    seeping: wp.Function
    find: wp.Function
    several: bool
    yields: bool
    options: dict[str, Any]


def _images(periodic: tuple[bool, bool, bool]) -> str:
    """Take the nearest periodic image along each periodic axis."""
    return "\n        ".join(
        f"d{axis} -= grid.period[{axis}] * rintf(d{axis} * grid.inv_period[{axis}]);"
        for axis in range(3)
        if periodic[axis]
    )


def make_pair_sums(
    lists: bool,
    periodic: tuple[bool, bool, bool],
    branch: bool,
    reach: tuple[int, int],
    several: bool = False,
    yields: bool = False,
) -> PairSums:
    """Put the loops together.

    Args:
        lists: Over the entries of lists; otherwise over the cells around a position.
        periodic: Which axes are.
        branch: Pass over what lies beyond the support. The kernel is zero there, so the sums are right without, and
            the loads of the next pair need not wait: on an H200 the branch costs 10 % of a step at 70 neighbours and
            saves 5 % at 250, there with blocks enough on a multiprocessor to hide the wait (2 %). A CPU mispredicts it
            a quarter of the time.
        reach: Cells that the support spans along y and z.
        several: Whether each particle of fluid has its own liquid.
        yields: Whether any of these yields.
    """
    among, at_solids, in_solids = (AMONG_LIQUIDS, LIQUID_AT_SOLIDS, SOLIDS_IN_LIQUIDS) if several else (ONE, ONE, ONE)

    def text(parts: tuple[str, str, str], kind: int, words: Words) -> str:
        before, term, after = parts
        loop = _RUN.replace("INDEX", "entries[k]" if lists else "k")
        loop = loop.replace("IF_NEAR", "if (r2 < support2)" if branch else "")
        # The least of a loop is not found so, without a promise that it is a number.
        loop = loop.replace(
            "VECTORIZE", "" if parts is SEEPING else "#pragma clang loop vectorize(enable) interleave(enable)"
        )
        loop = loop.replace("UNROLL", "2" if branch else "1")
        loop = loop.replace("IMAGES", _images(periodic)).replace("TERM", term.replace("DRY_PRESSURE", f"{DRY:e}f"))
        loop = loop.replace("BEYOND", f"{BEYOND:e}f").replace("BEHIND", f"{BEHIND:e}f")
        listed = _LISTED.replace("OTHERS", _OTHERS[kind]).replace("KIND", str(kind)).replace("LOOP", loop)
        search = listed if lists else walk(loop, reach, periodic)
        return put(words, _SUM.replace("SEARCH", search).replace("BEFORE", before).replace("AFTER", after))

    def total(parts: tuple[str, str, str], result: Any, kind: int = FLUID, words: Words = ONE) -> wp.Function:
        @wp.func_native(text(parts, kind, words))
        def pair_sum(
            grid: Grid,
            own: Species,
            other: Species,
            s: int,
            world: int,
            shape: wp.vec3,
            x: wp.vec3,
            v: wp.vec3,
            p: float,
            common: wp.vec3,
        ) -> result: ...

        return pair_sum

    @wp.func_native(_FIND.replace("SEARCH", walk(_FIND_RUN.replace("IMAGES", _images(periodic)), reach, periodic)))
    def find(
        grid: Grid, own: Species, other: Species, s: int, world: int, x: wp.vec3, itself: int, start: int
    ) -> int: ...

    options: dict[str, Any] = {"enable_backward": False, "grid_stride": False, "module": "unique"}
    options |= {"module_options": {"fast_math": True}} | ({"launch_bounds": (BLOCK, 12)} if branch else {})
    return PairSums(
        continuity=total(_CONTINUITY, wp.vec3, FLUID, among),
        continuity_at_walls=total(_CONTINUITY_AT_WALLS, wp.vec3, WALLS),
        continuity_at_bodies=total(_CONTINUITY_AT_BODIES, wp.vec4, BODIES),
        flux=total(_FLUX, Flux, FLUID, in_solids),
        extrapolation=total(*(_OF_LIQUIDS if several else (_EXTRAPOLATION, Extrapolated)), FLUID, in_solids),
        free=total(_FREE, wp.vec2),
        force={
            kind: total(_MOMENTUM, wp.vec3, kind, among if kind == FLUID else at_solids) for kind in (FLUID, BODIES)
        },
        force_on_solid=total(_MOMENTUM, wp.vec3, FLUID, in_solids),
        force_at_walls=total(_MOMENTUM_AT_WALLS, AtWalls, WALLS, at_solids),
        way={kind: total(between(WAY, words), wp.vec3, kind) for kind, words in ACROSS.items()},
        force_in_gap={kind: total(between(GAP, words), Gap, kind) for kind, words in ACROSS.items()},
        gradient=total(GRADIENT, wp.vec3),
        creep={kind: total(CREEP, wp.vec3, kind, mirrored(kind, among, at_solids)) for kind in KINDS},
        creep_on_solid=total(CREEP, wp.vec3, FLUID, in_solids | {"MIRRORED": "2.0f *"}),
        shear={kind: total(SHEAR, wp.vec2, kind, mirrored(kind, among, at_solids)) for kind in KINDS},
        seeping=total(SEEPING, wp.vec3, BODIES),
        find=find,
        several=several,
        yields=yields,
        options=options,
    )
