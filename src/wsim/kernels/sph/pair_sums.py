"""The loops over neighbours, written natively: all the time of a step is spent here.

Warp's own loops load a record in four pieces and keep a CPU from using its vector units. Measured on one core of an
AMD EPYC the same continuity sum takes 46 ms as a Warp loop and 24 ms so; on a GPU the 16-byte loads count. The text of
a loop is put together from choices that must cost nothing per pair: entries of a list or runs of cells, which axes are
periodic, whether to branch, and what is summed.

Every sum takes `Pairs`, which all of them read, and the run `[first, last)`.
"""

from __future__ import annotations

from dataclasses import dataclass

import warp as wp

OPTIONS = {"fast_math": True}


@wp.struct
class Pairs:
    """What every loop reads."""

    entry: wp.array(dtype=int)  # of lists; not read when cells are walked
    point: wp.array(dtype=wp.vec4)  # x, y, z, V; V < 0 is a boundary particle's
    motion: wp.array(dtype=wp.vec4)  # vx, vy, vz, p
    shape: wp.vec3  # of the kernel function: (1 / 2h, -5 norm / h^2, (2h)^2)
    period: wp.vec3  # of the domain [m]
    inv_period: wp.vec3


# Sums of W, of W times pressure, and of V (v - v_b).grad W.
Flux = wp.vec3

# Sums of W, of W times pressure, of W times velocity (3), and of W times the way to the fluid (3).
Extrapolated = wp.types.vector(length=8, dtype=wp.float32)

_LOOP = """
#if defined(__CUDA_ARCH__)
    typedef float4 Record;
    #define WSIM_LOAD(records, j) __ldg(records + j)
    #define WSIM_SATURATE(x) __saturatef(x)
#else
    struct Record { float x, y, z, w; };
    #define WSIM_LOAD(records, j) records[j]
    #define WSIM_SATURATE(x) ((x) > 0.0f ? (x) : 0.0f)
#endif
    const Record* __restrict__ points = reinterpret_cast<const Record*>(pairs.point.data);
    const Record* __restrict__ motions = reinterpret_cast<const Record*>(pairs.motion.data);
    const int* __restrict__ entries = pairs.entry.data;
    const float x0 = x[0], x1 = x[1], x2 = x[2];
    const float inv_support = pairs.shape[0], slope_norm = pairs.shape[1], support2 = pairs.shape[2];
    BEFORE
#if defined(__CUDA_ARCH__)
    #pragma unroll 2
#else
    #pragma clang loop vectorize(enable) interleave(enable)
#endif
    for (int k = first; k < last; ++k) {
        const int j = INDEX;
        const Record q = WSIM_LOAD(points, j);
        float d0 = x0 - q.x, d1 = x1 - q.y, d2 = x2 - q.z;
        IMAGES
        const float r2 = d0 * d0 + d1 * d1 + d2 * d2;
        IF_NEAR {
            const Record n = WSIM_LOAD(motions, j);
            const float u = sqrtf(r2) * inv_support;
            const float t = WSIM_SATURATE(1.0f - u), t2 = t * t;
            TERM
        }
    }
    #undef WSIM_LOAD
    #undef WSIM_SATURATE
    AFTER
"""

_CONTINUITY = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2], w0 = weight[0], w1 = weight[1], w2 = weight[2];
    float divergence = 0.0f, smoothing = 0.0f, carried = 0.0f, body = 0.0f;
    """,
    """
            const float slope = t2 * t;
            divergence += fabsf(q.w) * slope * ((v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2);
            smoothing -= (q.w > 0.0f ? q.w : 0.0f) * slope * (n.w - p + w0 * d0 + w1 * d1 + w2 * d2);
            const float marked = q.w > 0.0f ? 0.0f : n.w;
            OF_BODIES
            carried += t2 * t2 * (1.0f + 4.0f * u) * given_back;
    """,
    "return wp::vec_t<4, float>(slope_norm * divergence, slope_norm * smoothing, carried, body);",
)

# What stands in for OF_BODIES, where there are bodies and where there are none.
_OF_BODIES = {
    True: """const bool of_body = marked > 1.0e10f;
            body += of_body ? t : 0.0f;
            const float given_back = of_body ? 0.0f : marked;""",
    False: "const float given_back = marked;",
}

_FLUX = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2], w0 = weight[0], w1 = weight[1], w2 = weight[2];
    float total = 0.0f, pressure = 0.0f, flux = 0.0f;
    """,
    """
            const float volume = q.w > 0.0f ? q.w : 0.0f;
            const float w = q.w > 0.0f ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            total += w;
            pressure += w * (n.w + w0 * d0 + w1 * d1 + w2 * d2);
            flux -= volume * (t2 * t) * ((n.x - v0) * d0 + (n.y - v1) * d1 + (n.z - v2) * d2);
    """,
    "return wp::vec_t<3, float>(total, pressure, slope_norm * flux);",
)

_EXTRAPOLATION = (
    """
    const float w0 = weight[0], w1 = weight[1], w2 = weight[2];
    float total = 0.0f, pressure = 0.0f, f0 = 0.0f, f1 = 0.0f, f2 = 0.0f, o0 = 0.0f, o1 = 0.0f, o2 = 0.0f;
    """,
    """
            const float w = q.w > 0.0f ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            total += w;
            pressure += w * (n.w + w0 * d0 + w1 * d1 + w2 * d2);
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

_MOMENTUM = (
    """
    const float v0 = v[0], v1 = v[1], v2 = v[2];
    const float artificial = viscosity[0], laminar = viscosity[1], eta2 = viscosity[2];
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;
    """,
    """
            const float approach = (v0 - n.x) * d0 + (v1 - n.y) * d1 + (v2 - n.z) * d2;
            const float push = approach < 0.0f ? (artificial + laminar) * approach : laminar * approach;
            const float solid = -solids * q.w, volume = q.w > solid ? q.w : solid;
            const float force = volume * (t2 * t) * (push / (r2 + eta2) - p - n.w);
            a0 += force * d0;
            a1 += force * d1;
            a2 += force * d2;
    """,
    "return wp::vec_t<3, float>(slope_norm * a0, slope_norm * a1, slope_norm * a2);",
)

_FIND = """
    struct Record { float x, y, z, w; };
    const Record* __restrict__ points = reinterpret_cast<const Record*>(pairs.point.data);
    int* __restrict__ found = pairs.entry.data + base;
    const float x0 = x[0], x1 = x[1], x2 = x[2];
    const float support2 = pairs.shape[2];
    int count = start;
    for (int j = first; j < last; ++j) {
        const Record q = points[j];
        float d0 = x0 - q.x, d1 = x1 - q.y, d2 = x2 - q.z;
        IMAGES
        // Written first and counted after: a branch here would be mispredicted half the time.
        found[count < capacity ? count : capacity - 1] = j;
        count += (d0 * d0 + d1 * d1 + d2 * d2 < support2) & (j != s) & (fluid | (q.w > 0.0f));
    }
    return count;
"""


@dataclass(frozen=True)
class PairSums:
    """The native loops of one way of searching.

    Attributes:
        continuity: Sums of V_j (v_i - v_j).grad W, of the density diffusion, of what walls give back times W, and of
            1 - r / 2h over the neighbours that have `boundary.BODY` in its place.
        flux: `Flux`, over fluid neighbours; W up to a factor.
        extrapolation: `Extrapolated`, over fluid neighbours; W up to a factor.
        force: Force on a particle, per volume, from fluid and `solids` times from boundary neighbours.
        find: Write a run's neighbours behind `start` others; returns how many there are then. For lists alone.
    """

    continuity: wp.Function
    flux: wp.Function
    extrapolation: wp.Function
    force: wp.Function
    find: wp.Function


def _images(periodic: tuple[bool, bool, bool]) -> str:
    """Take the nearest periodic image along each periodic axis."""
    return "\n        ".join(
        f"d{axis} -= pairs.period[{axis}] * rintf(d{axis} * pairs.inv_period[{axis}]);"
        for axis in range(3)
        if periodic[axis]
    )


def make_pair_sums(lists: bool, periodic: tuple[bool, bool, bool], branch: bool, bodies: bool) -> PairSums:
    """Put the loops together.

    Args:
        lists: Over the entries of lists; otherwise over runs of cells.
        periodic: Which axes are.
        branch: Pass over what lies beyond the support. The kernel is zero there, so the sums are right without, and
            the loads of the next pair need not wait: on an H200 the branch costs 7 % at 74 neighbours and saves 8 %
            at 270; a CPU mispredicts it a quarter of the time.
        bodies: Some boundary particles are of moving bodies.
    """

    def loop(parts: tuple[str, str, str]) -> str:
        before, term, after = parts
        text = _LOOP.replace("INDEX", "entries[k]" if lists else "k")
        text = text.replace("IF_NEAR", "if (r2 < support2)" if branch else "")
        text = text.replace("BEFORE", before).replace("TERM", term).replace("AFTER", after)
        text = text.replace("OF_BODIES", _OF_BODIES[bodies])
        return text.replace("IMAGES", _images(periodic))

    @wp.func_native(loop(_CONTINUITY))
    def continuity(
        pairs: Pairs, first: int, last: int, x: wp.vec3, v: wp.vec3, p: float, weight: wp.vec3
    ) -> wp.vec4: ...

    @wp.func_native(loop(_FLUX))
    def flux(pairs: Pairs, first: int, last: int, x: wp.vec3, v: wp.vec3, weight: wp.vec3) -> Flux: ...

    @wp.func_native(loop(_EXTRAPOLATION))
    def extrapolation(pairs: Pairs, first: int, last: int, x: wp.vec3, weight: wp.vec3) -> Extrapolated: ...

    @wp.func_native(loop(_MOMENTUM))
    def force(
        pairs: Pairs, first: int, last: int, x: wp.vec3, v: wp.vec3, p: float, viscosity: wp.vec3, solids: float
    ) -> wp.vec3: ...

    @wp.func_native(_FIND.replace("IMAGES", _images(periodic)))
    def find(
        pairs: Pairs, first: int, last: int, x: wp.vec3, s: int, fluid: bool, base: int, capacity: int, start: int
    ) -> int: ...

    return PairSums(continuity, flux, extrapolation, force, find)
