"""What a sum over pairs takes of liquids: nothing where a world has one, else each particle's own numbers.

Continuity and the pressure's force know volumes and pressures alone (Colagrossi & Landrini 2003), and so hold for any
liquids side by side: pressure is continuous, each has its own mass. What does know the density is the weight of a
column, and the two viscosities; the words below stand for it in the texts of the loops (`pair_sums`). A build for one
liquid has none of it in its loops.
"""

import warp as wp

Words = dict[str, str]

# One liquid: `common` has what all pairs share.
ONE: Words = {
    "OWN_LIQUID": "",
    "ITS_LIQUID": "",
    "WITHIN_LIQUID": "",
    "ITS_DENSITY": "",
    "ARTIFICIAL": "artificial",
    "LAMINAR": "laminar",
}

_OWN = "const Liquid own_liquid = WSIM_LOAD(reinterpret_cast<const Liquid*>(own.liquid.data), s);"
_THEIRS = "const Liquid* __restrict__ liquids = reinterpret_cast<const Liquid*>(other.liquid.data);"
_ITS = "const Liquid its_liquid = WSIM_LOAD(liquids, j);"

# Several: `common` has the gravity g, and the factors of the viscosities without density and viscosity.
#
# Density diffusion stays within a liquid: beside an interface the pressure has a kink there, which across it would be
# diffused for ever (Hammani et al. 2020). The laminar viscosity of a pair is the harmonic mean, with which the shear
# stress is continuous across an interface (Hu & Adams 2006); the artificial one is there for stability, and has the
# plain mean of the densities.
AMONG_LIQUIDS: Words = {
    "OWN_LIQUID": _OWN + _THEIRS,
    "ITS_LIQUID": _ITS,
    "WITHIN_LIQUID": "its_liquid.x != own_liquid.x ? 0.0f :",
    "ITS_DENSITY": "its_liquid.x *",
    "ARTIFICIAL": "(0.5f * artificial * (own_liquid.x + its_liquid.x))",
    "LAMINAR": "(2.0f * laminar * own_liquid.y * its_liquid.y / (own_liquid.y + its_liquid.y + 1.0e-30f))",
}
# Between a solid and a liquid it is the liquid's, seen from either.
LIQUID_AT_SOLIDS: Words = ONE | {
    "OWN_LIQUID": _OWN,
    "ARTIFICIAL": "(artificial * own_liquid.x)",
    "LAMINAR": "(laminar * own_liquid.y)",
}
SOLIDS_IN_LIQUIDS: Words = ONE | {
    "OWN_LIQUID": _THEIRS,
    "ITS_LIQUID": _ITS,
    "ITS_DENSITY": "its_liquid.x *",
    "ARTIFICIAL": "(artificial * its_liquid.x)",
    "LAMINAR": "(laminar * its_liquid.y)",
}

# Besides what `pair_sums` extrapolates to a solid from one liquid: sums of W times density and viscosity.
EXTRAPOLATED_LIQUIDS = wp.types.vector(length=10, dtype=wp.float32)
MORE_EXTRAPOLATED = (
    "float density = 0.0f, viscosity = 0.0f;",
    """
            density += w * its_liquid.x;
            viscosity += w * its_liquid.y;
    """,
    """
    wp::vec_t<10, float> sums;
    sums[8] = density, sums[9] = viscosity;
    """,
)


def put(words: Words, text: str) -> str:
    """A text with the words in their places."""
    for name, word in words.items():
        text = text.replace(name, word)
    return text


@wp.kernel(enable_backward=False)
def gather_liquids(
    # Data in:
    order: wp.array(dtype=int),
    liquid: wp.array(dtype=wp.vec2),
    mass: wp.array(dtype=float),
    speed_of_sound: float,
    # Data in and out:
    motion: wp.array(dtype=wp.vec4),
    point: wp.array(dtype=wp.vec4),
    # Data out:
    sorted_liquid: wp.array(dtype=wp.vec2),
):
    """Copy each particle's rest density and viscosity into sorted order, and give it the volume that it has by them."""
    s = wp.tid()
    i = order[s]
    own = liquid[i]
    x = point[s]
    density = own[0] + motion[s][3] / (speed_of_sound * speed_of_sound)
    point[s] = wp.vec4(x[0], x[1], x[2], mass[i] / density)
    sorted_liquid[s] = own
