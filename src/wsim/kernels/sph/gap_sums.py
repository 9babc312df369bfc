"""The texts of loops over solids across a gap that no particle of fluid fits into; `pair_sums` puts them together."""

from wsim.kernels.sph.species import BODIES, WALLS

# Of the way across a gap: fluid that lies farther off behind a particle than 30 degrees past the level is not in there.
BEYOND = 0.5

WAY = (
    """
    const Record* __restrict__ facings = reinterpret_cast<const Record*>(other.facing.data);
    const float body = WHOSE;
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f;
    """,
    """
            const float w = LOAD_WHOSE != body ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            a0 -= w * d0;
            a1 -= w * d1;
            a2 -= w * d2;
    """,
    "return wp::vec_t<3, float>(a0, a1, a2);",
)

GAP = (
    """
    const Record* __restrict__ facings = reinterpret_cast<const Record*>(other.facing.data);
    const Record* __restrict__ acrosses = reinterpret_cast<const Record*>(other.across.data);
    const Record g = reinterpret_cast<const Record*>(own.facing.data)[s];
    const Record e = reinterpret_cast<const Record*>(own.across.data)[s];
    const float w0 = common[0], w1 = common[1], w2 = common[2], mean = v[0], least = v[1];
    float a0 = 0.0f, a1 = 0.0f, a2 = 0.0f, partners = 0.0f;
    """,
    """
            const Record f = WSIM_LOAD(facings, j);
            WAY_ACROSS
            const bool between = (g.x * e0 + g.y * e1 + g.z * e2 > -BEYOND * length)
                & (f.x * e0 + f.y * e1 + f.z * e2 < BEYOND * length) & OF_ANOTHER & (t > 0.0f);
            const float still = mean - w0 * d0 - w1 * d1 - w2 * d2;
            const float if_dry = IF_DRY;
            const float its = n.w > 0.5f * DRY_PRESSURE ? n.w : if_dry;
            const float force = (between & (its > 0.5f * DRY_PRESSURE)) ? q.w * (t2 * t) * (p + its) : 0.0f;
            partners += between ? 1.0f : 0.0f;
            a0 -= force * d0;
            a1 -= force * d1;
            a2 -= force * d2;
    """,
    "return wp::vec_t<4, float>(slope_norm * a0, slope_norm * a1, slope_norm * a2, partners);",
)

SEEPING = (
    """
    const Record* __restrict__ facings = reinterpret_cast<const Record*>(other.facing.data);
    const Record* __restrict__ acrosses = reinterpret_cast<const Record*>(other.across.data);
    const float body = facings[s].w, w0 = common[0], w1 = common[1], w2 = common[2];
    float total = 0.0f, pressure = 0.0f, hops = 1.0e9f;
    """,
    """
            const float handed = other.seeped.data[j];
            const Record f = WSIM_LOAD(facings, j);
            const bool from = (handed > 0.5f * DRY_PRESSURE) & (f.w == body) & (j != s);
            const float w = from ? t2 * t2 * (1.0f + 4.0f * u) : 0.0f;
            const float came = WSIM_LOAD(acrosses, j).w;
            total += w;
            pressure += w > 0.0f ? w * (handed + w0 * d0 + w1 * d1 + w2 * d2) : 0.0f;
            hops = ((w > 0.0f) & (came < hops)) ? came : hops;
    """,
    "return wp::vec_t<3, float>(total, pressure, hops);",
)

# What differs between walls, which take part in no seeping, and bodies.
ACROSS = {
    WALLS: {
        "WHOSE": "0.0f",
        "LOAD_WHOSE": "1.0f",
        "WAY_ACROSS": "const float e0 = e.x, e1 = e.y, e2 = e.z, length = 1.0f;",
        "OF_ANOTHER": "true",
        "IF_DRY": "still > least ? still : least",
    },
    BODIES: {
        "WHOSE": "facings[s].w",
        "LOAD_WHOSE": "WSIM_LOAD(facings, j).w",
        "WAY_ACROSS": """const Record c = WSIM_LOAD(acrosses, j);
            const float e0 = e.x - c.x, e1 = e.y - c.y, e2 = e.z - c.z, length = sqrtf(e0 * e0 + e1 * e1 + e2 * e2);""",
        "OF_ANOTHER": "(f.w != g.w)",
        "IF_DRY": "other.seeped.data[j]",
    },
}


def between(parts: tuple[str, str, str], words: dict[str, str]) -> tuple[str, str, str]:
    """A loop over solids across a gap, of one kind of them."""
    before, term, after = parts
    for name in sorted(words, key=len, reverse=True):
        before, term = before.replace(name, words[name]), term.replace(name, words[name])
    return before, term, after
