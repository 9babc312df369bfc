"""The camera's kernels against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from wsim.kernels.render import display, faces, sky, surface


@wp.kernel
def _curves(x: wp.array(dtype=float), out_srgb: wp.array(dtype=float), out_tone: wp.array(dtype=float)):
    i = wp.tid()
    out_srgb[i] = display.srgb(x[i])
    out_tone[i] = display.tone(x[i])


@wp.kernel
def _fresnel(cosine: wp.array(dtype=float), out: wp.array(dtype=float)):
    i = wp.tid()
    out[i] = faces.fresnel(cosine[i], 1.0, 1.5)


@wp.kernel
def _checker(x: wp.array(dtype=float), width: float, out: wp.array(dtype=float)):
    i, j = wp.tid()
    wp.atomic_add(out, 0, sky.checker_filtered(x[i], x[j], width))
    if i == 0 and j == 0:
        out[1] = sky.checker_filtered(0.5, 0.5, 0.01)
        out[2] = sky.checker_filtered(1.5, 0.5, 0.01)
        out[3] = sky.checker_filtered(0.3, 0.7, 4.0)


@wp.kernel
def _box(half: wp.vec3, pose: wp.transform, origin: wp.vec3, direction: wp.vec3, out: wp.array(dtype=wp.vec3)):
    span = faces.span_of_box(half, pose, origin, direction)
    out[0] = wp.vec3(span[0], span[1], 0.0)
    out[1] = faces.normal_of_box(half, pose, origin + direction * span[0])
    out[2] = faces.normal_of_box(half, pose, origin + direction * span[1])


def floats(*values: float) -> wp.array:
    return wp.array(values, dtype=float, device="cpu")


def test_srgb_and_tone() -> None:
    x = np.array([0.0, 0.002, 0.18, 0.5, 0.75, 1.0, 3.0], dtype=np.float32)
    srgb, tone = wp.zeros(7, dtype=float, device="cpu"), wp.zeros(7, dtype=float, device="cpu")
    wp.launch(_curves, dim=7, inputs=[floats(*x)], outputs=[srgb, tone], device="cpu")
    assert srgb.numpy()[1] == pytest.approx(0.02584, abs=1e-5)
    assert srgb.numpy()[2:4] == pytest.approx((0.46136, 0.73536), abs=1e-4)  # IEC 61966-2-1
    assert tone.numpy()[:5] == pytest.approx(x[:5])
    assert 0.75 < tone.numpy()[5] < tone.numpy()[6] <= 1.0


def test_fresnel_of_glass() -> None:
    out = wp.zeros(2, dtype=float, device="cpu")
    wp.launch(_fresnel, dim=2, inputs=[floats(1.0, 0.0)], outputs=[out], device="cpu")
    assert out.numpy() == pytest.approx((0.04, 1.0), abs=1e-5)


def test_checker_alternates_averages_to_nothing_and_fades() -> None:
    x = np.linspace(0.0, 4.0, 64, endpoint=False, dtype=np.float32) + 1.0 / 32.0
    out = wp.zeros(4, dtype=float, device="cpu")
    wp.launch(_checker, dim=(64, 64), inputs=[floats(*x), 0.05], outputs=[out], device="cpu")
    total, even, odd, far = out.numpy()
    assert total / 64**2 == pytest.approx(0.0, abs=1e-4)
    assert abs(even) == pytest.approx(1.0, abs=1e-3)
    assert odd == pytest.approx(-even, abs=1e-3)
    assert abs(far) < 0.3


def test_ray_through_a_turned_box() -> None:
    turned = wp.transform(wp.vec3(1.0, 0.0, 0.0), wp.quat_from_axis_angle(wp.vec3(0.0, 0.0, 1.0), np.pi / 2))
    out = wp.zeros(3, dtype=wp.vec3, device="cpu")
    inputs = [wp.vec3(0.5, 0.2, 0.1), turned, wp.vec3(-1.0, 0.0, 0.0), wp.vec3(1.0, 0.0, 0.0)]
    wp.launch(_box, dim=1, inputs=inputs, outputs=[out], device="cpu")
    span, entry, leave = out.numpy()
    assert span[:2] == pytest.approx((1.8, 2.2), abs=1e-6)
    assert entry == pytest.approx((-1.0, 0.0, 0.0), abs=1e-6)
    assert leave == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)


def test_keep_finite_flags_what_it_drops() -> None:
    given = np.array([[1, 2, 3], [np.nan, 0, 0], [0, np.inf, 0], [0, 0, -2e4]], dtype=np.float32)
    points, flags = wp.zeros(4, dtype=wp.vec3f, device="cpu"), wp.zeros(4, dtype=wp.int32, device="cpu")
    inputs = [wp.array(given, dtype=wp.vec3f, device="cpu"), 1e4]
    wp.launch(surface.keep_finite, dim=4, inputs=inputs, outputs=[points, flags], device="cpu")
    assert flags.numpy().tolist() == [1, 0, 0, 0]
    assert points.numpy()[0].tolist() == [1, 2, 3]
    assert not points.numpy()[1:].any()


def test_fit_container_brings_the_rim_to_the_wall_and_leaves_the_rest() -> None:
    half, near, overlap = 0.5, 0.1, 0.01
    x = np.linspace(0.3, 0.52, 45, dtype=np.float32)
    rows = [[v, 0, 0] for v in x] + [[0.6, 0, 0], [0.48, 0, 0.8], [0, 0, -0.48], [0, 0, 0.48]]
    points = wp.array(np.array(rows, dtype=np.float32), dtype=wp.vec3f, device="cpu")
    inputs = [wp.vec3f(0.0), wp.quatf(0.0, 0.0, 0.0, 1.0), wp.vec3f(half), near, overlap]
    wp.launch(surface.fit_container, dim=len(rows), inputs=inputs, outputs=[points], device="cpu")
    moved = points.numpy()
    fitted = moved[:45, 0]
    assert fitted[x < 0.4] == pytest.approx(x[x < 0.4])
    assert fitted[x > 0.451] == pytest.approx(half + overlap)
    assert (np.diff(fitted) >= 0).all()  # in one piece: no fold
    assert np.abs(np.diff(fitted)).max() < 3 * (x[1] - x[0])  # and no tear
    assert moved[45:47] == pytest.approx(np.array(rows[45:47]))  # outside, and over the rim
    assert moved[47, 2] == pytest.approx(-half - overlap)  # the floor is met
    assert moved[48, 2] == pytest.approx(0.48)  # the top is open
