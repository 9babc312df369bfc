from __future__ import annotations

import numpy as np
import pytest
from rerun.chunk import RrdReader

from wsim.geometry.rotations import rotate
from wsim.recording import RecordingWriter
from wsim.recording.shapes import look_at, rgba, shape_visual
from wsim.scene.world import Camera, Shape

QUARTER_X = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))  # +90 degrees about X: Z goes to -Y


def static_columns(path) -> dict[tuple[str, str], object]:
    """First static value of every column, by entity and column."""
    found = {}
    for chunk in RrdReader(path).stream():
        if chunk.is_static:
            batch = chunk.to_record_batch()
            for i, field in enumerate(batch.schema):
                if field.name != "rerun.controls.RowId":
                    found[chunk.entity_path, field.name] = batch.column(i)[-1].as_py()
    return found


@pytest.fixture
def drawn(tmp_path, world):
    with RecordingWriter(tmp_path / "r.rrd", world):
        pass
    return static_columns(tmp_path / "r.rrd")


def test_every_shape_is_drawn_at_its_size(drawn):
    assert drawn["/World/block/geometry", "Boxes3D:half_sizes"][0] == pytest.approx([0.15, 0.15, 0.1])
    assert drawn["/World/ball/geometry", "Ellipsoids3D:half_sizes"][0] == pytest.approx([0.12] * 3)
    assert drawn["/World/can/geometry", "Cylinders3D:lengths"] == pytest.approx([0.25])
    assert drawn["/World/can/geometry", "Cylinders3D:radii"] == pytest.approx([0.1])
    assert drawn["/World/pill/geometry", "Capsules3D:lengths"] == pytest.approx([0.2])
    # Rerun's capsule starts at its origin.
    assert drawn["/World/pill/geometry", "Capsules3D:translations"][0] == pytest.approx([0, 0, -0.1])
    assert len(drawn["/World/wedge/geometry", "Mesh3D:vertex_positions"]) == 12
    ground = drawn["/World/ground/geometry", "Boxes3D:half_sizes"][0]
    assert ground[0] > 5.0
    assert drawn["/World/ground/geometry", "Boxes3D:centers"][0][2] == pytest.approx(-ground[2])  # its top is z = 0
    assert drawn["/World/water", "Points3D:radii"] == pytest.approx([0.05])


def test_glass_is_transparent(drawn):
    assert drawn["/World/tank/wall_minus_x", "Boxes3D:colors"][0] & 0xFF == 64
    assert drawn["/World/block/geometry", "Boxes3D:colors"][0] & 0xFF == 255


def test_a_prim_says_which_line_made_it(drawn):
    assert drawn["/World/block", "wsim.Prim:line"] == ["program.py:12"]
    assert drawn["/World/block", "wsim.Prim:mass"] == [2.0]


def test_the_camera_looks_at_its_target(drawn, world):
    camera = world.cameras[0]
    width, height = drawn["/World/side", "Pinhole:resolution"][0]
    assert (width, height) == (160, 90)
    matrix = np.array(drawn["/World/side", "Pinhole:image_from_camera"][0]).reshape(3, 3).T
    rotation = np.array(drawn["/World/side", "Transform3D:mat3x3"][0]).reshape(3, 3).T
    eye = np.array(drawn["/World/side", "Transform3D:translation"][0])

    def project(point) -> np.ndarray:
        pixel = matrix @ (rotation.T @ (np.asarray(point) - eye))
        return pixel[:2] / pixel[2]

    np.testing.assert_allclose(project(camera.target), [80, 45], atol=1e-3)
    assert project(np.add(camera.target, (0, 0, 0.3)))[1] < 45  # up in the world is up in the picture
    # A point at half the horizontal field of view is at the picture's edge.
    edge = rotation @ [np.tan(np.radians(camera.fov) / 2), 0.0, 1.0]
    np.testing.assert_allclose(project(eye + edge), [160, 45], atol=1e-3)


def test_the_poses_of_a_camera_that_follows_come_with_the_frames(tmp_path, world, make_frame):
    block = world.bodies[0]
    camera = world.cameras[0].model_copy(update={"follows": block.prim})
    with RecordingWriter(tmp_path / "r.rrd", world.model_copy(update={"cameras": [camera]})) as writer:
        frames = [make_frame(k) for k in range(2)]
        for k, frame in enumerate(frames):
            writer.frame(0.1 * k, frame)
    found = static_columns(tmp_path / "r.rrd")
    assert ("/World/side", "Pinhole:resolution") in found and ("/World/side", "Transform3D:translation") not in found
    poses = {}
    for chunk in RrdReader(tmp_path / "r.rrd").stream():
        if chunk.entity_path == "/World/side" and not chunk.is_static:
            batch = chunk.to_record_batch()
            for name in ("translation", "quaternion"):
                index = batch.schema.get_field_index(f"Transform3D:{name}")
                if index >= 0:
                    poses[name] = np.array([row[0] for row in batch.column(index).to_pylist()])
    offset = np.subtract(camera.eye, block.position)
    np.testing.assert_allclose(poses["translation"], [frame.body_q[0, :3] + offset for frame in frames], atol=1e-5)
    np.testing.assert_allclose(np.abs([rotate(q, np.array((0.0, 0.0, 1.0))) for q in poses["quaternion"]]),
                               np.abs([look_at(camera)[:, 2]] * 2), atol=1e-5)  # fmt: skip


@pytest.mark.parametrize("target", [(0, 0, -1), (0, 0, 1), (1, 0, 0), (-1, 2, 0.5)])
def test_camera_axes_are_a_rotation(target):
    axes = look_at(Camera(prim="/World/c", eye=(0, 0, 0), target=target))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(axes[:, 2], np.array(target) / np.linalg.norm(target), atol=1e-12)


def test_turned_capsules_and_meshes_are_placed():
    np.testing.assert_allclose(rotate(np.array(QUARTER_X), np.array([0.0, 0.0, 1.0])), [0, -1, 0], atol=1e-12)
    pill = Shape(prim="/World/p", kind="capsule", size=(0.1, 2.0), position=(5, 0, 0), rotation=QUARTER_X)
    start = shape_visual(pill).translations.as_arrow_array().to_pylist()[0]
    assert start == pytest.approx([5, 1, 0], abs=1e-6)
    mesh = Shape(
        prim="/World/m",
        kind="mesh",
        size=(1, 1, 1),
        position=(5, 0, 0),
        rotation=QUARTER_X,
        vertices=[(0, 0, 0), (1, 0, 0), (0, 0, 1)],
        triangles=[(0, 1, 2)],
    )
    corners = shape_visual(mesh).vertex_positions.as_arrow_array().to_pylist()
    np.testing.assert_allclose(corners, [[5, 0, 0], [6, 0, 0], [5, -1, 0]], atol=1e-6)
    assert shape_visual(mesh.model_copy(update={"vertices": [], "triangles": []})) is None


def test_colours_are_srgb():
    assert rgba((0.0, 0.2140, 1.0), 0.5) == [0, 127, 255, 128]
    assert rgba((-1.0, 2.0, 0.0)) == [0, 255, 0, 255]


def test_a_body_below_another_keeps_its_own_pose(tmp_path, world, make_frame):
    below = world.bodies[1].model_copy(update={"prim": "/World/block/child"})
    nested = world.model_copy(update={"bodies": [*world.bodies, below]})
    with RecordingWriter(tmp_path / "r.rrd", nested) as writer:
        frame = make_frame(0)
        for name in ("body_q", "body_qd", "contact_force"):
            array = getattr(frame, name)
            setattr(frame, name, np.concatenate([array, array[:1]]))
        writer.frame(0.0, frame)
    parents = {}
    for chunk in RrdReader(tmp_path / "r.rrd").stream():
        batch = chunk.to_record_batch()
        index = batch.schema.get_field_index("Transform3D:parent_frame")
        if index >= 0:
            parents[chunk.entity_path] = batch.column(index).to_pylist()
    assert parents == {"/World/block/child": [["tf#/"]]}
