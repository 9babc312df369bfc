"""How deep a point is in a mesh."""

import numpy as np
import pytest
import warp as wp

from wsim.kernels.inside import depth_inside


def test_depth_in_a_cube() -> None:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float32)
    faces = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3]
    mesh = wp.Mesh(
        points=wp.array(corners, dtype=wp.vec3f, device="cpu"),
        indices=wp.array(faces, dtype=wp.int32, device="cpu"),
        support_winding_number=True,
    )
    points = wp.array([(0.8, 0.0, 0.0), (0.0, 0.0, 0.5), (1.5, 0.0, 0.0)], dtype=wp.vec3f, device="cpu")
    out = wp.zeros(3, dtype=float, device="cpu")
    wp.launch(depth_inside, dim=3, inputs=[mesh.id, points, 2.0], outputs=[out], device="cpu")
    assert out.numpy() == pytest.approx((0.2, 0.5, -0.5), abs=1e-5)
