"""The texts of loops over pairs where a liquid yields; `pair_sums` puts them together."""

from wsim.kernels.sph.liquids import Words
from wsim.kernels.sph.species import FLUID

# Where a liquid yields: solids are met at their own velocity, mirrored in the particle's own for no slip.
_CREEPS = """
    const Record* __restrict__ creeps = reinterpret_cast<const Record*>(other.creep.data);
    const float v0 = v[0], v1 = v[1], v2 = v[2];
    const float laminar = common[1], eta2 = common[2];
"""
_APPROACH = """
            const Record c = WSIM_LOAD(creeps, j);
            const float approach = MIRRORED ((v0 - c.x) * d0 + (v1 - c.y) * d1 + (v2 - c.z) * d2);
            const float slope = q.w * (t2 * t);
"""

CREEP = (
    _CREEPS + "float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;",
    _APPROACH
    + """
            const float force = slope * (LAMINAR * approach / (r2 + eta2));
            a0 += force * d0;
            a1 += force * d1;
            a2 += force * d2;
    """,
    "return wp::vec_t<3, float>(slope_norm * a0, slope_norm * a1, slope_norm * a2);",
)

SHEAR = (
    _CREEPS + "float rate = 0.0f, filled = 0.0f;",
    _APPROACH
    + """
            rate += slope * approach * approach / (r2 + eta2);
            filled += slope * r2;
    """,
    "return wp::vec_t<2, float>(-slope_norm * rate, -slope_norm * filled);",
)


def mirrored(kind: int, among: Words, at_solids: Words) -> Words:
    """Words of a sum over one kind of neighbours in which those of solids are mirrored."""
    return among | {"MIRRORED": ""} if kind == FLUID else at_solids | {"MIRRORED": "2.0f *"}
