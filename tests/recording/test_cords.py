"""Springs and ropes in a recording: what the viewer draws is where their ends, pulleys and lengths say."""

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from tests.recording.test_scene import static_columns
from wsim.geometry.rotations import rotate
from wsim.recording import Frame, RecordingWriter, read
from wsim.recording.columns import APPLICATION
from wsim.recording.excerpt import write_excerpt
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import Guide, Spring

TOP, RADIUS, ARM = 2.0, 0.2, 0.7  # of the pulley [m]
STRIPS = "LineStrips3D:strips"


@pytest.fixture(scope="module")
def world():
    scene = Scene()
    scene.cylinder("wheel", radius=RADIUS, height=0.06, axis="Y", position=(0, 0, TOP), static=True)
    scene.box("left", size=(0.1, 0.1, 0.1), position=(-RADIUS, 0, TOP - ARM))
    scene.box("right", size=(0.1, 0.1, 0.1), position=(RADIUS, 0, TOP - ARM))
    scene.rope("rope", "left", "right", around=["wheel"], color=(1, 0, 0))
    scene.spring("coil", "left", "right", stiffness=10.0, anchor_b=(RADIUS, 0.05, TOP - ARM), radius=0.02)
    scene.spring("damper", "left", None, anchor_b=(-1, 0, 1), stiffness=0.0, damping=1.0, radius=0.03)
    return describe(scene.stage)


def frame(world, q):
    count = len(world.bodies)
    return Frame(np.asarray(q), np.zeros((count, 6)), np.zeros((count, 3)))


def poses(left, right, turn=(0.0, 0.0, 0.0, 1.0)):
    return [[*left, 0, 0, 0, 1], [*right, *turn]]


def strips(path, entity):
    """The lines of each row that is not static, by time [ns]."""
    rows = {}
    for chunk in RrdReader(path).stream():
        if chunk.entity_path == entity and not chunk.is_static:
            batch = chunk.to_record_batch()
            if STRIPS in batch.schema.names:
                times = batch.column("sim_time").cast("int64").to_pylist()
                rows |= dict(zip(times, batch.column(STRIPS).to_pylist(), strict=True))
    return [[np.array(line) for line in rows[t]] for t in sorted(rows)]


def length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def record(path, world, frames):
    with RecordingWriter(path, world) as writer:
        for k, q in enumerate(frames):
            writer.frame(0.1 * k, frame(world, q))
    return path


def test_a_taut_rope_runs_over_its_pulley(tmp_path, world):
    """Its length stays, 2 ARM + pi RADIUS, and each end is at its weight as they go up and down."""
    rises = (0.0, 0.3, -0.4)
    moved = [poses((-RADIUS, 0, TOP - ARM + z), (RADIUS, 0, TOP - ARM - z)) for z in rises]
    rows = strips(record(tmp_path / "r.rrd", world, moved), "/World/rope")
    assert len(rows) == len(rises)
    for z, [line] in zip(rises, rows, strict=True):
        np.testing.assert_allclose(line[[0, -1], 0], [-RADIUS, RADIUS], atol=1e-6)
        np.testing.assert_allclose(line[[0, -1], 2], [TOP - ARM + z, TOP - ARM - z], atol=1e-6)
        # Chords of 0.2 rad at most are shorter than their arc by 0.2**2 / 24 of it.
        whole = 2 * ARM + np.pi * RADIUS
        assert whole - np.pi * RADIUS * 0.2**2 / 24 - 1e-6 < length(line) < whole + 1e-6
        assert np.hypot(line[:, 0], line[:, 2] - TOP).min() == pytest.approx(RADIUS, abs=1e-6)
        assert line[:, 2].max() == pytest.approx(TOP + RADIUS, abs=0.005 * RADIUS)


def test_a_slack_rope_hangs_at_its_length(tmp_path, world):
    lifted = poses((-RADIUS, 0, TOP - ARM), (RADIUS + 0.3, 0, TOP - ARM + 0.4))
    [[line]] = strips(record(tmp_path / "r.rrd", world, [lifted]), "/World/rope")
    assert length(line) == pytest.approx(2 * ARM + np.pi * RADIUS, rel=0.005)
    assert line[-1] == pytest.approx(lifted[1][:3], abs=1e-6)
    assert line[len(line) // 2 :, 2].min() < lifted[1][2] - 0.05  # below the weight that it hangs from


def test_springs_go_from_end_to_end(tmp_path, world):
    """Also from a point of a body that has turned: a zigzag within the coil's radius, a damper straight."""
    half = np.sqrt(0.5)
    q = poses((0.1, 0.2, 0.3), (0.5, -0.2, 0.4), (0, 0, half, half))
    path = record(tmp_path / "r.rrd", world, [q])
    [[coil]], [damper] = strips(path, "/World/coil"), strips(path, "/World/damper")
    end = np.array(q[1][:3]) + rotate(np.array([0, 0, half, half]), np.array([0.0, 0.05, 0.0]))
    np.testing.assert_allclose(coil[[0, -1]], [q[0][:3], end], atol=1e-6)
    along = (end - q[0][:3]) / np.linalg.norm(end - q[0][:3])
    off = coil - q[0][:3] - np.outer((coil - q[0][:3]) @ along, along)
    np.testing.assert_allclose(np.linalg.norm(off[1:-1], axis=1), 0.02, atol=1e-6)
    assert (np.einsum("ij,ij->i", off[1:-2], off[2:-1]) < 0.0).all()  # from side to side
    tube, rod = damper
    np.testing.assert_allclose(rod, [q[0][:3], (-1, 0, 1)], atol=1e-6)
    assert length(tube) == pytest.approx(0.55 * length(rod), rel=1e-6)


def test_cords_have_their_colour_and_radius_and_say_their_prim(tmp_path, world):
    drawn = static_columns(record(tmp_path / "r.rrd", world, []))
    assert drawn["/World/rope", "LineStrips3D:colors"] == [0xFF0000FF]
    assert drawn["/World/rope", "LineStrips3D:radii"] == pytest.approx([0.006])
    assert drawn["/World/damper", "LineStrips3D:radii"] == pytest.approx([0.015, 0.006])
    assert drawn["/World/coil", "wsim.Prim:prim"] == ["/World/coil"]


@pytest.mark.parametrize("nowhere", [np.nan, np.inf, 1e38])
def test_a_body_that_is_nowhere_holds_no_line(tmp_path, world, nowhere):
    there = poses((-RADIUS, 0, TOP - ARM), (RADIUS, 0, TOP - ARM))
    lost = np.array(there)
    lost[1, 0] = nowhere
    path = record(tmp_path / "r.rrd", world, [there, lost, there])
    assert [len(row) for row in strips(path, "/World/rope")] == [1, 0, 1]
    assert [len(row) for row in strips(path, "/World/damper")] == [2, 2, 2]  # it holds on to the other one
    np.testing.assert_array_equal(read(path).body_q[1], lost.astype(np.float32))


@pytest.mark.parametrize("seed", range(5))
def test_any_pose_can_be_drawn_and_reads_back(tmp_path, world, seed):
    q = np.random.default_rng(seed).standard_normal((20, 2, 7)) * 10.0 ** (seed - 2)
    path = record(tmp_path / "r.rrd", world, q)
    np.testing.assert_array_equal(read(path).body_q, q.astype(np.float32))
    for prim in ("rope", "coil", "damper"):
        rows = strips(path, f"/World/{prim}")
        assert len(rows) == 20
        assert all(np.isfinite(line).all() for row in rows for line in row)


def test_a_cord_below_a_body_stays_in_the_world(tmp_path, world):
    """Rerun would move its lines, which are in the world, with the body above."""
    path = [Guide(body="/World/left", position=(0, 0, 0)), Guide(position=(0, 0, 0))]
    spring = Spring(prim="/World/left/own", path=path, radius=0.02, stiffness=1.0, rest_length=1.0)
    nested = world.model_copy(update={"springs": [spring]})
    drawn = static_columns(record(tmp_path / "r.rrd", nested, []))
    assert drawn["/World/left/own", "Transform3D:parent_frame"] == ["tf#/"]
    assert ("/World/rope", "Transform3D:parent_frame") not in drawn


def test_a_recording_from_before_its_cords_were_drawn_reads(tmp_path, world):
    there = poses((-RADIUS, 0, TOP - ARM), (RADIUS, 0, TOP - ARM))
    new = record(tmp_path / "new.rrd", world, [there, there])
    cords = {cord.prim for cord in world.cords}
    stream = rr.RecordingStream(APPLICATION)
    stream.save(tmp_path / "old.rrd")
    stream.send_chunks([chunk for chunk in RrdReader(new).stream() if chunk.entity_path not in cords])
    stream.flush()
    stream.disconnect()
    old = read(tmp_path / "old.rrd")
    assert strips(tmp_path / "old.rrd", "/World/rope") == []
    assert old.world == world
    np.testing.assert_array_equal(old.body_q, read(new).body_q)


def test_an_excerpt_may_follow_a_rope(tmp_path, world):
    frames = [poses((-RADIUS, 0, TOP - ARM + 0.1 * k), (RADIUS, 0, TOP - ARM - 0.1 * k)) for k in range(4)]
    path = record(tmp_path / "r.rrd", world, frames)
    write_excerpt(path, tmp_path / "late.rrd", time=0.2, entity="/World/rope")
    whole, late = strips(path, "/World/rope"), strips(tmp_path / "late.rrd", "/World/rope")
    assert len(late) == 2
    np.testing.assert_array_equal(late[0][0], whole[2][0])


def test_lines_take_little_of_a_file(tmp_path, world):
    """A row of the rope and the two springs: less than 100 points of 12 bytes, and what Rerun says of them."""
    frames = [poses((-RADIUS, 0, TOP - ARM + z), (RADIUS, 0, TOP - ARM - z)) for z in np.linspace(0.0, 0.5, 300)]
    sizes = [
        record(tmp_path / f"{len(each.cords)}.rrd", each, frames).stat().st_size
        for each in (world, world.model_copy(update={"springs": [], "ropes": []}))
    ]
    assert 0 < (sizes[0] - sizes[1]) / len(frames) < 1200.0
