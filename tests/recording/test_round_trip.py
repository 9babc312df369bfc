from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import rerun as rr

from wsim.errors import UserError
from wsim.recording import Frame, RecordingWriter, read
from wsim.recording.view import rerun_binary


def bits(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array).view(np.uint32)


@pytest.fixture
def recorded(tmp_path, world, make_frame):
    frames = [make_frame(seed) for seed in range(40)]
    path = tmp_path / "recording.rrd"
    with RecordingWriter(path, world, {"solver": "test", "nested": {"a": [1, 2.5]}}) as writer:
        for i, frame in enumerate(frames):
            writer.frame(i / 30, frame)
    return path, frames


def test_arrays_come_back_bit_for_bit(recorded, world):
    path, frames = recorded
    recording = read(path)
    assert recording.world == world
    assert recording.metadata == {"solver": "test", "nested": {"a": [1, 2.5]}, "complete": True}
    assert recording.complete
    assert recording.time.tolist() == [i / 30 for i in range(40)]
    for name in ("body_q", "body_qd", "contact_force"):
        assert getattr(recording, name).dtype == np.float32
        np.testing.assert_array_equal(bits(getattr(recording, name)), bits([getattr(f, name) for f in frames]))
    water = recording.fluids["/World/water"]
    assert water.time.tolist() == recording.time.tolist()
    for name in ("position", "velocity", "density"):
        written = np.stack([getattr(f.fluids["/World/water"], name) for f in frames])
        np.testing.assert_array_equal(bits(getattr(water, name)), bits(written))
    for name in ("energy/kinetic", "energy/potential"):
        assert recording.scalars[name].tolist() == [f.scalars[name] for f in frames]


def test_chunk_borders_lose_nothing(tmp_path, world, make_frame, monkeypatch):
    monkeypatch.setattr("wsim.recording.buffers.CHUNK_ROWS", 7)
    frames = [make_frame(seed) for seed in range(23)]
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for i, frame in enumerate(frames):
            writer.frame(0.1 * i, frame)
    recording = read(tmp_path / "r.rrd")
    np.testing.assert_array_equal(bits(recording.body_q), bits([f.body_q for f in frames]))
    written = np.stack([f.fluids["/World/water"].position for f in frames])
    np.testing.assert_array_equal(bits(recording.fluids["/World/water"].position), bits(written))


def test_the_writer_keeps_copies(tmp_path, world, make_frame):
    frame = make_frame(0)
    first = frame.body_q.copy()
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.frame(0.0, frame)
        frame.body_q[:] = 0.0
        writer.frame(0.1, frame)
    np.testing.assert_array_equal(read(tmp_path / "r.rrd").body_q[0], first)


def test_nan_and_infinity_survive(tmp_path, world, make_frame):
    frame = make_frame(1)
    payload = np.array([0x7FC00123], np.uint32).view(np.float32)[0]  # a NaN with bits of its own
    frame.body_q[0, :] = np.nan
    frame.body_q[1, 2] = payload
    frame.body_qd[0, 0] = np.inf
    frame.body_qd[0, 1] = -0.0
    frame.fluids["/World/water"].velocity[3] = np.nan
    frame.fluids["/World/water"].position[4] = -np.inf
    frame.scalars = {"energy/kinetic": float("nan")}
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.frame(0.0, frame)
    recording = read(tmp_path / "r.rrd")
    np.testing.assert_array_equal(bits(recording.body_q[0]), bits(frame.body_q))
    np.testing.assert_array_equal(bits(recording.body_qd[0]), bits(frame.body_qd))
    water = recording.fluids["/World/water"]
    np.testing.assert_array_equal(bits(water.velocity[0]), bits(frame.fluids["/World/water"].velocity))
    np.testing.assert_array_equal(bits(water.position[0]), bits(frame.fluids["/World/water"].position))
    assert np.isnan(recording.scalars["energy/kinetic"]).all()


def test_log_lines_come_back_in_order(tmp_path, world, make_frame):
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.log(0.0, "info", "started")
        writer.frame(0.0, make_frame(0))
        writer.frame(1 / 3, make_frame(1))
        writer.log(1 / 3, "warning", "penetration", prim="/World/block")
        writer.log(1 / 3, "ERROR", "änd öut", prim="/World/ball")
        writer.log(0.1, "debug", "late")
    log = read(tmp_path / "r.rrd").log
    assert [(line.time, line.level, line.text, line.prim) for line in log] == [
        (0.0, "INFO", "started", None),
        (0.1, "DEBUG", "late", None),
        (1 / 3, "WARN", "penetration", "/World/block"),
        (1 / 3, "ERROR", "änd öut", "/World/ball"),
    ]


def test_images_are_decoded_when_asked_for(tmp_path, world, make_frame):
    y, x = np.mgrid[0:90, 0:160]
    pictures = [np.stack([x + 5 * i, y + 40, np.full_like(x, 30 * i)], axis=2).astype(np.uint8) for i in range(3)]
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for i, picture in enumerate(pictures):
            writer.frame(i / 10, make_frame(i))
            writer.image(i / 10, "/World/side", picture)
        writer.log(0.0, "info", "a line on the camera's own entity", prim="/World/side")
    recording = read(tmp_path / "r.rrd")
    track = recording.images["/World/side"]
    assert track.time.tolist() == recording.time.tolist()
    assert len(track) == 3
    assert track.jpeg(0).startswith(b"\xff\xd8\xff")
    for written, shown in zip(pictures, track, strict=True):
        assert shown.shape == (90, 160, 3)
        assert np.abs(shown.astype(int) - written).mean() < 3.0
    np.testing.assert_array_equal(track.at(0.21), track[2])
    assert len(recording.log) == 1


def test_accessors(recorded):
    path, frames = recorded
    recording = read(path)
    assert recording.body_index("/World/can") == 2
    np.testing.assert_array_equal(recording.position("/World/can"), [f.body_q[2, :3] for f in frames])
    np.testing.assert_array_equal(recording.velocity("/World/can"), [f.body_qd[2, :3] for f in frames])
    np.testing.assert_array_equal(recording.force("/World/can"), [f.contact_force[2] for f in frames])
    frame = recording.frame_at(0.51)
    np.testing.assert_array_equal(frame.body_q, frames[15].body_q)
    np.testing.assert_array_equal(frame.fluids["/World/water"].density, frames[15].fluids["/World/water"].density)
    assert frame.scalars == frames[15].scalars
    with pytest.raises(KeyError, match="/World/ball"):
        recording.body_index("/World/nothing")


def test_frames_without_fluid_or_with_other_scalars(tmp_path, world, make_frame):
    bare = make_frame(0)
    bare.fluids, bare.scalars = {}, {"contact/penetration": 0.25}
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.frame(0.0, bare)
        writer.frame(0.1, make_frame(1))
    recording = read(tmp_path / "r.rrd")
    assert recording.fluids["/World/water"].time.tolist() == [0.1]
    np.testing.assert_array_equal(recording.scalars["contact/penetration"], [0.25, np.nan])
    assert recording.frame_at(0.0).fluids == {}


def test_a_world_without_bodies_or_frames(tmp_path, world):
    empty = world.model_copy(update={"bodies": [], "fluids": [], "cameras": []})
    none = Frame(np.zeros((0, 7)), np.zeros((0, 6)), np.zeros((0, 3)))
    with RecordingWriter(tmp_path / "a.rrd", empty) as writer:
        writer.frame(0.0, none)
        writer.frame(0.5, none)
    recording = read(tmp_path / "a.rrd")
    assert recording.body_q.shape == (2, 0, 7)
    assert recording.time.tolist() == [0.0, 0.5]
    with RecordingWriter(tmp_path / "b.rrd", world):
        pass
    recording = read(tmp_path / "b.rrd")
    assert recording.body_q.shape == (0, 5, 7)
    with pytest.raises(ValueError, match="no frames"):
        recording.frame_at(0.0)


def test_wrong_frames_are_refused(tmp_path, world, make_frame):
    writer = RecordingWriter(tmp_path / "r.rrd", world)
    writer.frame(0.0, make_frame(0))

    def broken(**changes) -> Frame:
        frame = make_frame(1)
        for name, value in changes.items():
            setattr(frame, name, value)
        return frame

    water = make_frame(1).fluids["/World/water"]
    for frame, message in (
        (broken(body_q=np.zeros((4, 7))), r"body_q has shape \(4, 7\).*5 bodies"),
        (broken(body_qd=np.zeros((5, 7))), r"body_qd has shape \(5, 7\)"),
        (broken(contact_force=np.zeros(5)), "contact_force"),
        (broken(fluids={"/World/oil": water}), "no fluid '/World/oil'.*water"),
        (make_frame(1, particles=49), "49 particles, 50 before"),
        (broken(scalars={"two words": 1.0}), "scalar 'two words'"),
    ):
        with pytest.raises(ValueError, match=message):
            writer.frame(0.1, frame)
    for t in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="time"):
            writer.frame(t, make_frame(1))
    with pytest.raises(ValueError, match="loud"):
        writer.log(0.0, "loud", "text")
    with pytest.raises(ValueError, match="block"):
        writer.log(0.0, "info", "text", prim="block")
    with pytest.raises(ValueError, match="/World/side"):
        writer.image(0.0, "/World/top", np.zeros((9, 16, 3), np.uint8))
    with pytest.raises(ValueError, match="uint8"):
        writer.image(0.0, "/World/side", np.zeros((9, 16, 3), np.float32))
    writer.close()
    with pytest.raises(ValueError, match="closed"):
        writer.frame(0.2, make_frame(2))
    assert len(read(tmp_path / "r.rrd").time) == 1  # nothing of the refused frames got in


def test_metadata_must_be_plain(tmp_path, world):
    with pytest.raises(ValueError, match="complete"):
        RecordingWriter(tmp_path / "r.rrd", world, {"complete": True})
    with pytest.raises(ValueError, match="JSON"):
        RecordingWriter(tmp_path / "r.rrd", world, {"x": object()})


def test_an_exception_keeps_what_was_recorded(tmp_path, world, make_frame):
    path = tmp_path / "r.rrd"
    with pytest.raises(ZeroDivisionError), RecordingWriter(path, world) as writer:
        writer.frame(0.0, make_frame(0))
        assert not path.exists()
        _ = 1 / 0
    recording = read(path)
    assert len(recording.time) == 1
    assert not recording.complete
    assert recording.metadata["error"] == "ZeroDivisionError: division by zero"
    assert not writer.partial_path.exists()


def test_a_killed_run_leaves_only_the_partial_file(tmp_path, world):
    (tmp_path / "world.json").write_text(world.model_dump_json())
    script = textwrap.dedent("""
        import os, pathlib, signal, sys
        import numpy as np
        from wsim.recording import Frame, RecordingWriter
        from wsim.scene.world import World
        import wsim.recording.buffers as buffers
        buffers.CHUNK_ROWS = 2
        folder = pathlib.Path(sys.argv[1])
        world = World.model_validate_json((folder / "world.json").read_text())
        writer = RecordingWriter(folder / "r.rrd", world)
        for i in range(4):
            writer.frame(i, Frame(np.full((5, 7), i), np.zeros((5, 6)), np.zeros((5, 3))))
        writer._stream.flush()
        os.kill(os.getpid(), signal.SIGKILL)
    """)
    run = subprocess.run([sys.executable, "-c", script, str(tmp_path)], env=os.environ | {"PYTHONPATH": "src"})
    assert run.returncode == -signal.SIGKILL
    partial = tmp_path / "r.rrd.partial"
    assert not (tmp_path / "r.rrd").exists()
    recording = read(partial)
    assert not recording.complete
    assert recording.metadata["error"] == "the recording was never closed"
    np.testing.assert_array_equal(recording.body_q[:, 0, 0], [0.0, 1.0, 2.0, 3.0])
    # Cut in the middle of a message, the error says how to save the rest; it is readable then.
    partial.write_bytes(partial.read_bytes()[:-10])
    with pytest.raises(UserError, match=r"rerun rrd optimize --continue-on-error .* -o .*r\.rrd$") as caught:
        read(partial)
    command = str(caught.value).split("with: rerun ")[1].split()
    subprocess.run([rerun_binary(), *command], check=True, capture_output=True)
    assert read(tmp_path / "r.rrd").body_q.shape[1:] == (5, 7)


def test_a_file_that_is_not_ours_is_a_users_error(tmp_path, recorded):
    with pytest.raises(UserError, match="no recording at"):
        read(tmp_path / "nothing.rrd")
    (tmp_path / "text.rrd").write_text("not a recording" * 100)
    with pytest.raises(UserError, match="not a whole Rerun recording"):
        read(tmp_path / "text.rrd")
    path, _ = recorded
    (tmp_path / "cut.rrd").write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(UserError, match="not a whole Rerun recording"):
        read(tmp_path / "cut.rrd")
    stream = rr.RecordingStream("somebody")
    stream.save(tmp_path / "other.rrd")
    stream.log("points", rr.Points3D([[0, 0, 0]]), static=True)
    stream.disconnect()
    with pytest.raises(UserError, match="holds no world"):
        read(tmp_path / "other.rrd")


def test_rerun_switched_off_is_said(tmp_path, world, monkeypatch):
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(UserError, match="RERUN"):
        RecordingWriter(tmp_path / "r.rrd", world)


def test_a_disk_that_cannot_be_written_is_said(tmp_path, world):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot write"):
        RecordingWriter(tmp_path / "file" / "r.rrd", world)


def test_recordings_side_by_side_do_not_mix(tmp_path, world, make_frame):
    writers = [RecordingWriter(tmp_path / f"{i}.rrd", world) for i in range(2)]
    for t, (i, writer) in itertools.product(range(3), enumerate(writers)):
        writer.frame(t, make_frame(10 * i + t))
    for i, writer in enumerate(writers):
        writer.close()
        written = [make_frame(10 * i + t).body_q for t in range(3)]
        np.testing.assert_array_equal(read(tmp_path / f"{i}.rrd").body_q, written)
