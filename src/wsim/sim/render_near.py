"""Newton's rays and shapes, with the ray's origin moved near the shape first.

Newton takes for the face of a box that a ray meets each whose distance is within 1e-6 m of the nearest one's, and as
close to a cylinder's end what is its cap. In single precision distances of 16 and 32 m are not known so well: pixels
found no face, or the other one, and no sun.
"""

import warp as wp
from newton._src.geometry import raycast

# As they are before `nearer` puts those below in their places.
box, capsule, cylinder = raycast.ray_intersect_box, raycast.ray_intersect_capsule, raycast.ray_intersect_cylinder
cone, ellipsoid = raycast.ray_intersect_cone, raycast.ray_intersect_ellipsoid


@wp.func
def way_to(origin: wp.vec3, direction: wp.vec3, radius: float) -> float:
    """How far a ray goes until it is within a `radius` of the shape's middle [m]; 0 where it begins there or leaves."""
    return wp.max(0.0, (-wp.dot(origin, direction) - radius * wp.length(direction)) / wp.dot(direction, direction))


@wp.func
def from_there(way: float, met: float) -> float:
    """The distance from the ray's own origin; below 0 it meets nothing."""
    return wp.where(met < 0.0, met, way + met)


@wp.func
def ray_intersect_box(origin: wp.vec3, direction: wp.vec3, size: wp.vec3) -> tuple[float, wp.vec3]:
    """Half edges [m]."""
    way = way_to(origin, direction, wp.length(size))
    met, normal = box(origin + way * direction, direction, size)
    return from_there(way, met), normal


@wp.func
def ray_intersect_capsule(origin: wp.vec3, direction: wp.vec3, r: float, h: float) -> tuple[float, wp.vec3]:
    """Radius and half the height without caps [m]."""
    way = way_to(origin, direction, r + h)
    met, normal = capsule(origin + way * direction, direction, r, h)
    return from_there(way, met), normal


@wp.func
def ray_intersect_cylinder(
    origin: wp.vec3, direction: wp.vec3, r: float, h: float, barrel_radius: float
) -> tuple[float, wp.vec3]:
    """Radius, half the height, and the radius of what bulges [m]."""
    way = way_to(origin, direction, r + h + wp.max(0.0, barrel_radius))
    met, normal = cylinder(origin + way * direction, direction, r, h, barrel_radius)
    return from_there(way, met), normal


@wp.func
def ray_intersect_cone(origin: wp.vec3, direction: wp.vec3, r: float, h: float) -> tuple[float, wp.vec3]:
    """Radius and half the height [m]."""
    way = way_to(origin, direction, r + h)
    met, normal = cone(origin + way * direction, direction, r, h)
    return from_there(way, met), normal


@wp.func
def ray_intersect_ellipsoid(origin: wp.vec3, direction: wp.vec3, semi_axes: wp.vec3) -> tuple[float, wp.vec3]:
    """Half axes [m]."""
    way = way_to(origin, direction, wp.length(semi_axes))
    met, normal = ellipsoid(origin + way * direction, direction, semi_axes)
    return from_there(way, met), normal


def nearer() -> None:
    """Have Newton's camera use these; before its first kernel is compiled."""
    for each in (
        ray_intersect_box, ray_intersect_capsule, ray_intersect_cylinder, ray_intersect_cone, ray_intersect_ellipsoid
    ):  # fmt: skip
        setattr(raycast, each.func.__name__, each)
