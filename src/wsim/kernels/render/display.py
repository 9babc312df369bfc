"""From linear radiance to the bytes of a picture: tone curve, sRGB, and smoothed edges."""

import warp as wp

SHOULDER = wp.constant(0.75)  # linear radiance up to which the tone curve keeps colours as they are


@wp.func
def tone(x: float) -> float:
    """Keep radiance as it is up to the shoulder, then roll off smoothly toward 1."""
    if x <= SHOULDER:
        return wp.max(x, 0.0)
    room = 1.0 - SHOULDER
    return SHOULDER + room * (1.0 - wp.exp(-(x - SHOULDER) / room))


@wp.func
def srgb(x: float) -> float:
    """The sRGB transfer curve (IEC 61966-2-1)."""
    if x <= 0.0031308:
        return 12.92 * x
    return 1.055 * wp.pow(x, 1.0 / 2.4) - 0.055


@wp.kernel(enable_backward=False)
def encode(
    # Data in:
    linear: wp.array2d(dtype=wp.vec3f),
    # Data out:
    encoded: wp.array2d(dtype=wp.vec3f),  # sRGB, 0 .. 1
):
    """Apply the tone curve and the sRGB transfer curve."""
    row, column = wp.tid()
    c = linear[row, column]
    encoded[row, column] = wp.vec3f(srgb(tone(c[0])), srgb(tone(c[1])), srgb(tone(c[2])))


@wp.func
def is_edge(
    group: wp.array(dtype=wp.int32),
    shape: wp.array2d(dtype=wp.int32),
    depth: wp.array2d(dtype=float),
    row: int,
    column: int,
    other_row: int,
    other_column: int,
) -> bool:
    """Whether a pixel is of a thing that ends beside it: before another one, the ground or the sky."""
    if other_row < 0 or other_column < 0 or other_row >= shape.shape[0] or other_column >= shape.shape[1]:
        return False
    mine = shape[row, column]
    theirs = shape[other_row, other_column]
    if mine < 0 or group[mine] < 0:
        return False
    if theirs < 0:
        return True
    if group[mine] == group[theirs]:
        return False
    # Of two things that touch, the line is on one side alone: that of the nearer, or else of the first.
    near = depth[row, column]
    far = depth[other_row, other_column]
    if group[theirs] < 0 or wp.abs(near - far) > 1.0e-3 * near:
        return near <= far
    return mine < theirs


@wp.kernel(enable_backward=False)
def draw_edges(
    # Data in:
    group: wp.array(dtype=wp.int32),  # what shapes belong together, by index; below 0 has no edge
    shape: wp.array2d(dtype=wp.int32),
    depth: wp.array2d(dtype=float),  # [m]
    darkness: float,  # share of the light that an edge takes
    # Data in and out:
    encoded: wp.array2d(dtype=wp.vec3f),  # sRGB, 0 .. 1
):
    """Darken the pixels where a thing ends: things of one colour are told apart."""
    row, column = wp.tid()
    if (
        is_edge(group, shape, depth, row, column, row - 1, column)
        or is_edge(group, shape, depth, row, column, row + 1, column)
        or is_edge(group, shape, depth, row, column, row, column - 1)
        or is_edge(group, shape, depth, row, column, row, column + 1)
    ):
        encoded[row, column] = encoded[row, column] * (1.0 - darkness)


@wp.func
def luma(color: wp.vec3) -> float:
    """Brightness of an sRGB colour (Rec. 601)."""
    return 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]


@wp.func
def sample(image: wp.array2d(dtype=wp.vec3f), x: float, y: float) -> wp.vec3:
    """Bilinear sample at pixel coordinates, clamped at the border."""
    height = image.shape[0]
    width = image.shape[1]
    px = wp.clamp(x, 0.0, float(width - 1))
    py = wp.clamp(y, 0.0, float(height - 1))
    x0 = wp.min(int(px), width - 1)
    y0 = wp.min(int(py), height - 1)
    x1 = wp.min(x0 + 1, width - 1)
    y1 = wp.min(y0 + 1, height - 1)
    u = px - float(x0)
    v = py - float(y0)
    top = image[y0, x0] * (1.0 - u) + image[y0, x1] * u
    bottom = image[y1, x0] * (1.0 - u) + image[y1, x1] * u
    return top * (1.0 - v) + bottom * v


@wp.kernel(enable_backward=False)
def smooth_edges(
    # Data in:
    image: wp.array2d(dtype=wp.vec3f),  # sRGB, 0 .. 1
    # Data out:
    rgb: wp.array3d(dtype=wp.uint8),
):
    """Blur along edges only, in the manner of FXAA (T. Lottes, NVIDIA, 2009)."""
    row, column = wp.tid()
    height = image.shape[0]
    width = image.shape[1]
    up = wp.max(row - 1, 0)
    down = wp.min(row + 1, height - 1)
    left = wp.max(column - 1, 0)
    right = wp.min(column + 1, width - 1)
    here = image[row, column]
    color = here
    center = luma(here)
    nw = luma(image[up, left])
    ne = luma(image[up, right])
    sw = luma(image[down, left])
    se = luma(image[down, right])
    low = wp.min(center, wp.min(wp.min(nw, ne), wp.min(sw, se)))
    high = wp.max(center, wp.max(wp.max(nw, ne), wp.max(sw, se)))
    if high - low > wp.max(0.03, 0.08 * high):
        along_x = (sw + se) - (nw + ne)
        along_y = (nw + sw) - (ne + se)
        damp = wp.max((nw + ne + sw + se) * 0.03125, 0.0078125)
        scale = 1.0 / (wp.min(wp.abs(along_x), wp.abs(along_y)) + damp)
        step_x = wp.clamp(along_x * scale, -6.0, 6.0)
        step_y = wp.clamp(along_y * scale, -6.0, 6.0)
        x = float(column)
        y = float(row)
        near = 0.5 * (
            sample(image, x - step_x / 6.0, y - step_y / 6.0) + sample(image, x + step_x / 6.0, y + step_y / 6.0)
        )
        wide = 0.5 * near + 0.25 * (
            sample(image, x - step_x * 0.5, y - step_y * 0.5) + sample(image, x + step_x * 0.5, y + step_y * 0.5)
        )
        wide_luma = luma(wide)
        color = near
        if wide_luma >= low and wide_luma <= high:
            color = wide
    for channel in range(3):
        rgb[row, column, channel] = wp.uint8(wp.clamp(color[channel], 0.0, 1.0) * 255.0 + 0.5)


@wp.kernel(enable_backward=False)
def quantize(
    # Data in:
    image: wp.array2d(dtype=wp.vec3f),  # sRGB, 0 .. 1
    # Data out:
    rgb: wp.array3d(dtype=wp.uint8),
):
    """Round each colour to bytes, edges left as they are."""
    row, column = wp.tid()
    for channel in range(3):
        rgb[row, column, channel] = wp.uint8(wp.clamp(image[row, column][channel], 0.0, 1.0) * 255.0 + 0.5)
