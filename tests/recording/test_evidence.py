"""What fluid and control did to bodies, and what cameras saw, is read back as it was recorded."""

from dataclasses import replace

import numpy as np
import pytest

from wsim.recording import RecordingWriter, read
from wsim.recording.contacts import WIDTH, Pushes
from wsim.recording.solids import SolidParticles, Solids


def test_impulse_and_work_come_back_bit_for_bit(world, make_frame, tmp_path):
    frames = []
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for k in range(5):
            rng = np.random.default_rng(k)
            impulse = rng.standard_normal((len(world.bodies), 3)).astype(np.float32)
            work = rng.standard_normal(len(world.bodies)).astype(np.float32)
            turn, control = rng.standard_normal((2, len(world.bodies), 3)).astype(np.float32)
            others = {"applied_turn": turn, "control_impulse": control, "wall_impulse": rng.standard_normal(3)}
            others["lead"] = rng.standard_normal((len(world.bodies), 6)).astype(np.float32)
            frames.append(replace(make_frame(k), applied_impulse=impulse, applied_work=work, **others))
            writer.frame(0.1 * k, frames[-1])
    recording = read(tmp_path / "r.rrd")
    assert recording.applied_impulse.tobytes() == np.stack([f.applied_impulse for f in frames]).tobytes()
    for name in ("applied_work", "applied_turn", "control_impulse", "wall_impulse", "lead"):
        written = np.stack([getattr(frame, name) for frame in frames]).astype(np.float32)
        assert getattr(recording, name).tobytes() == written.tobytes()


def test_a_recording_without_them_has_none(world, make_frame, tmp_path):
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.frame(0.0, make_frame(0))
    recording = read(tmp_path / "r.rrd")
    assert recording.applied_impulse is None and recording.applied_work is None and recording.seen == {}
    assert recording.applied_turn is None and recording.control_impulse is None and recording.wall_impulse is None
    assert recording.contacts is None and recording.lead is None and recording.solids is None


def test_particles_of_solids_come_back_bit_for_bit(world, make_frame, tmp_path):
    rng = np.random.default_rng(5)
    walls, block = (
        SolidParticles(rng.normal(size=(n, 3)).astype(np.float32), rng.random(n).astype(np.float32)) for n in (40, 7)
    )
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        with pytest.raises(ValueError, match="/World/nobody"):
            writer.solids(Solids(walls, {"/World/nobody": block}))
        writer.solids(Solids(walls, {"/World/block": block}))
        writer.frame(0.0, make_frame(0))
        writer.frame(0.1, make_frame(1))
    solids = read(tmp_path / "r.rrd").solids
    assert list(solids.bodies) == ["/World/block"]
    for found, written in ((solids.walls, walls), (solids.bodies["/World/block"], block)):
        assert found.position.tobytes() == written.position.tobytes()
        assert found.volume.tobytes() == written.volume.tobytes()
    with pytest.raises(ValueError, match=r"\(4, 3\) and \(5,\)"):
        SolidParticles(np.zeros((4, 3)), np.zeros(5))


def test_they_come_in_all_frames_or_in_none(world, make_frame, tmp_path):
    count = len(world.bodies)
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.frame(0.0, make_frame(0))
        applied = replace(make_frame(1), applied_impulse=np.zeros((count, 3)), applied_work=np.zeros(count))
        with pytest.raises(ValueError, match="in all frames or in none"):
            writer.frame(0.1, applied)


def test_what_a_camera_saw_comes_back(world, make_frame, tmp_path):
    shares = [{"/World/block": 0.25, "/World/ball": 0.0}, {"/World/block": 0.125, "/World/ball": 0.0625}]
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for k, share in enumerate(shares):
            writer.frame(0.1 * k, make_frame(k))
            writer.seen(0.1 * k, "/World/side", share)
        with pytest.raises(ValueError, match="/World/block"):
            writer.seen(0.2, "/World/side", {"/World/block": 1.0})
    track = read(tmp_path / "r.rrd").seen["/World/side"]
    assert track.objects == ["/World/block", "/World/ball"]
    assert track.share.tolist() == [list(share.values()) for share in shares]
    assert track.time == pytest.approx([0.0, 0.1])


def test_what_pairs_gave_each_other_comes_back(world, make_frame, tmp_path):
    """Some frames have no contact at all."""
    rng = np.random.default_rng(4)
    pushes = [
        Pushes(rng.integers(0, 3, (n, 2)).astype(np.int32), rng.standard_normal((n, WIDTH)).astype(np.float32))
        for n in (0, 2, 0, 3, 1)
    ]
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for k, each in enumerate(pushes):
            writer.frame(0.1 * k, replace(make_frame(k), contacts=each))
        with pytest.raises(ValueError, match="in all frames or in none"):
            writer.frame(0.5, make_frame(5))
    track = read(tmp_path / "r.rrd").contacts
    assert track.frame.tolist() == [1, 1, 3, 3, 3, 4]
    assert track.pair.tobytes() == np.concatenate([each.pair for each in pushes]).tobytes()
    assert track.sums.tobytes() == np.concatenate([each.sums for each in pushes]).tobytes()
    assert track.impulse.shape == (6, 3) and track.turn.shape == (6, 2, 3) and track.pressed.shape == (6,)


def test_pushes_of_another_width_are_refused(world, make_frame, tmp_path):
    wrong = Pushes(np.zeros((2, 2), np.int32), np.zeros((2, 5), np.float32))
    with RecordingWriter(tmp_path / "r.rrd", world) as writer, pytest.raises(ValueError, match="contacts have shapes"):
        writer.frame(0.0, replace(make_frame(0), contacts=wrong))
