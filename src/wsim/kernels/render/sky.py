"""What a ray sees behind all glass and water: the sky, the sun, lit shapes and the ground's pattern; linear RGB."""

import warp as wp

FAR = wp.constant(1.0e6)  # [m]: farther than anything
BESIDE_SUN = wp.constant(0.98)  # cosine from the sun below which its disc adds nothing: 12 * 0.98^1200 is 4e-10


@wp.struct
class Look:
    """How the sky, the sun and the ground look."""

    sun_direction: wp.vec3  # unit, from the sun into the scene
    sun_color: wp.vec3
    ambient: wp.vec3  # radiance from above
    ambient_below: wp.vec3  # and from below
    zenith: wp.vec3
    horizon: wp.vec3
    fog_distance: float  # [m]: where the ground has mostly faded into the horizon
    checker: float  # [m]: edge of a square of the ground's pattern; 0 is plain
    checker_contrast: float
    reflection: float  # 0 is none, 1 is Fresnel's
    scatter: float  # 0 is a medium that only absorbs
    pixel_angle: float  # [rad]: between two pixels


@wp.func
def sky(direction: wp.vec3, look: Look) -> wp.vec3:
    """Radiance of the sky [linear RGB], sun included."""
    up = wp.clamp(direction[2], 0.0, 1.0)
    color = wp.lerp(look.horizon, look.zenith, wp.pow(up, 0.55))
    toward_sun = wp.max(-wp.dot(direction, look.sun_direction), 0.0)
    glow = 0.25 * power_24(toward_sun)
    if toward_sun > BESIDE_SUN:
        glow += 12.0 * wp.pow(toward_sun, 1200.0)
    return color + look.sun_color * glow


@wp.func
def daylight(normal: wp.vec3, look: Look) -> wp.vec3:
    """The light that falls on a face: of the sun by Lambert's law, and of all around."""
    around = wp.lerp(look.ambient_below, look.ambient, 0.5 + 0.5 * normal[2])
    return around + look.sun_color * wp.max(-wp.dot(look.sun_direction, normal), 0.0)


@wp.func
def power_24(x: float) -> float:
    """The 24th power, by five products: a tenth of the time of `wp.pow`."""
    x4 = x * x * x * x
    x8 = x4 * x4
    return x8 * x8 * x8


@wp.func
def checker_filtered(x: float, y: float, width: float) -> float:
    """A checker of period 2 in x and y averaged over a square of edge `width`, in -1 .. 1."""
    w = wp.max(width, 1.0e-4)
    ax = 2.0 * (wp.abs(_fract((x - 0.5 * w) * 0.5) - 0.5) - wp.abs(_fract((x + 0.5 * w) * 0.5) - 0.5)) / w
    ay = 2.0 * (wp.abs(_fract((y - 0.5 * w) * 0.5) - 0.5) - wp.abs(_fract((y + 0.5 * w) * 0.5) - 0.5)) / w
    return ax * ay


@wp.func
def _fract(x: float) -> float:
    return x - wp.floor(x)


@wp.func
def opaque_color(
    origin: wp.vec3,
    direction: wp.vec3,
    t: float,
    lit: wp.vec3,
    on_ground: bool,
    look: Look,
) -> wp.vec3:
    """The colour behind all glass and water: a lit shape, patterned and faded into the distance, or the sky."""
    if t >= FAR:
        return sky(direction, look)
    color = lit
    if on_ground:
        if look.checker > 0.0:
            point = origin + direction * t
            footprint = look.pixel_angle * t / wp.max(wp.abs(direction[2]), 0.02) / look.checker
            if footprint < 8.0:
                pattern = checker_filtered(point[0] / look.checker, point[1] / look.checker, footprint)
                color = color * (1.0 + look.checker_contrast * pattern)
        fade = t / look.fog_distance
        level = wp.normalize(wp.vec3(direction[0], direction[1], 0.0))
        color = wp.lerp(sky(level, look), color, wp.exp(-fade * fade))
    return color
