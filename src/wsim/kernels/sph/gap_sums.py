"""The texts of loops over solids across a gap that no particle of fluid fits into; `pair_sums` puts them together."""

from wsim.kernels.sph.species import BODIES, WALLS

# Of the way across a gap: fluid that lies farther off behind a particle than 30 degrees past the level is not in there.
BEYOND = 0.5
# And what lies behind a particle itself is the other side of its body only when it is straight behind: beside an edge
# whose faces lean inward, as a prism's, fluid stands at 58 degrees over the level.
BEHIND = 0.9

WAY = (
    """
    BODY
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;
    """,
    """
            const float w = OF_ANOTHER ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            a0 -= w * d0;
            a1 -= w * d1;
            a2 -= w * d2;
    """,
    "return wp::vec_t<3, float>(a0, a1, a2);",
)

GAP = (
    """
    BODY
    const Record* __restrict__ facings = reinterpret_cast<const Record*>(other.facing.data);
    const Record* __restrict__ acrosses = reinterpret_cast<const Record*>(other.across.data);
    const Record g = reinterpret_cast<const Record*>(own.facing.data)[s];
    const Record e = reinterpret_cast<const Record*>(own.across.data)[s];
    const float widening = reinterpret_cast<const Record*>(own.handed.data)[s].z;
    const float w0 = common[0], w1 = common[1], w2 = common[2], mean = v[0], least = v[1];
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f, partners = 0.0f;
    float g0 = 0.0f, g1 = 0.0f, g2 = 0.0f, o0 = 0.0f, o1 = 0.0f, o2 = 0.0f;
    """,
    """
            const Record f = WSIM_LOAD(facings, j);
            ACROSS
            const bool another = OF_ANOTHER;
            const bool between = another & (g.x * e0 + g.y * e1 + g.z * e2 > -BEHIND * length)
                & (f.x * e0 + f.y * e1 + f.z * e2 < BEYOND * length) & (t > 0.0f);
            const float still = mean - w0 * d0 - w1 * d1 - w2 * d2;
            const float if_dry = IF_DRY;
            const float its = n.w > 0.5f * DRY_PRESSURE ? n.w : if_dry;
            const float slope = q.w * (t2 * t);
            const float force = (between & (its > 0.5f * DRY_PRESSURE)) ? slope * WIDENING * (p + its) : 0.0f;
            const float there = between ? slope : 0.0f, same = another ? 0.0f : slope;
            partners += between ? 1.0f : 0.0f;
            a0 -= force * d0;
            a1 -= force * d1;
            a2 -= force * d2;
            g0 += there * d0;
            g1 += there * d1;
            g2 += there * d2;
            o0 += same * d0;
            o1 += same * d1;
            o2 += same * d2;
    """,
    """
    wp::vec_t<10, float> sums;
    sums[0] = slope_norm * a0, sums[1] = slope_norm * a1, sums[2] = slope_norm * a2, sums[3] = partners;
    sums[4] = slope_norm * g0, sums[5] = slope_norm * g1, sums[6] = slope_norm * g2;
    sums[7] = slope_norm * o0, sums[8] = slope_norm * o1, sums[9] = slope_norm * o2;
    return sums;
    """,
)

GRADIENT = (
    "float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;",
    """
            const float slope = q.w * (t2 * t);
            a0 += slope * d0;
            a1 += slope * d1;
            a2 += slope * d2;
    """,
    "return wp::vec_t<3, float>(slope_norm * a0, slope_norm * a1, slope_norm * a2);",
)

SEEPING = (
    """
    const Record* __restrict__ handeds = reinterpret_cast<const Record*>(other.handed.data);
    const float body = handeds[s].w, w0 = common[0], w1 = common[1], w2 = common[2];
    float total = 0.0f, pressure = 0.0f, hops = 1.0e9f;
    """,
    """
            const Record h = WSIM_LOAD(handeds, j);
            const bool from = (h.x > 0.5f * DRY_PRESSURE) & (h.w == body) & (j != s);
            const float w = from ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            total += w;
            pressure += w > 0.0f ? w * (h.x + w0 * d0 + w1 * d1 + w2 * d2) : 0.0f;
            hops = ((w > 0.0f) & (h.y < hops)) ? h.y : hops;
    """,
    "return wp::vec_t<3, float>(total, pressure, hops);",
)

# What differs between walls, which have nothing that was handed on, and bodies.
ACROSS = {
    WALLS: {
        "BODY": "",
        "OF_ANOTHER": "true",
        "ACROSS": "const float e0 = e.x, e1 = e.y, e2 = e.z, length = 1.0f;",
        "IF_DRY": "still > least ? still : least",
        "WIDENING": "widening",
    },
    BODIES: {
        "BODY": """const Record* __restrict__ handeds = reinterpret_cast<const Record*>(other.handed.data);
    const float body = handeds[s].w;""",
        "OF_ANOTHER": "WSIM_LOAD(handeds, j).w != body",
        "ACROSS": """const Record c = WSIM_LOAD(acrosses, j), h = WSIM_LOAD(handeds, j);
            const float e0 = e.x - c.x, e1 = e.y - c.y, e2 = e.z - c.z, length = sqrtf(e0 * e0 + e1 * e1 + e2 * e2);""",
        "IF_DRY": "h.x",
        "WIDENING": "(0.5f * (widening + h.z))",
    },
}


def between(parts: tuple[str, str, str], words: dict[str, str]) -> tuple[str, str, str]:
    """A loop over solids across a gap, of one kind of them."""
    before, term, after = parts
    for name, word in words.items():
        before, term = before.replace(name, word), term.replace(name, word)
    return before, term, after
