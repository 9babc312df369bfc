from __future__ import annotations

import av
import numpy as np
import pytest

from wsim.recording.video import VideoWriter, read_video, write_video


def pictures(count: int, height: int = 120, width: int = 160) -> list[np.ndarray]:
    y, x = np.mgrid[0:height, 0:width]
    return [np.stack([(x + 3 * i) % 256, np.full_like(x, 80), 60 + y], axis=2).astype(np.uint8) for i in range(count)]


def decode(path) -> list[np.ndarray]:
    with av.open(str(path)) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


def test_a_player_gets_what_was_written(tmp_path):
    written = pictures(20)
    assert write_video(tmp_path / "v.mp4", iter(written), 30) == 20
    with av.open(str(tmp_path / "v.mp4")) as container:
        stream = container.streams.video[0]
        assert stream.codec_context.name == "h264"
        assert stream.codec_context.pix_fmt == "yuv420p"
        assert stream.average_rate == 30
        assert stream.frames == 20
        assert (stream.width, stream.height) == (160, 120)
    shown = decode(tmp_path / "v.mp4")
    assert len(shown) == 20
    assert all(np.abs(a.astype(int) - b).mean() < 6.0 for a, b in zip(shown, written, strict=True))
    # A frame must look like itself rather than a neighbour: the order is right.
    errors = [np.abs(shown[10].astype(int) - picture).mean() for picture in written]
    assert int(np.argmin(errors)) == 10
    assert [p.name for p in tmp_path.iterdir()] == ["v.mp4"]


def test_frames_are_read_back_evenly(tmp_path):
    written = pictures(20)
    write_video(tmp_path / "v.mp4", written, 10)
    for most, expected in ((2, [0, 19]), (5, [0, 5, 10, 14, 19]), (50, list(range(20)))):
        times, frames = zip(*read_video(tmp_path / "v.mp4", most), strict=True)
        assert times == pytest.approx([k / 10 for k in expected])
        assert all(np.abs(f.astype(int) - written[k]).mean() < 6.0 for f, k in zip(frames, expected, strict=True))


def test_the_index_stands_in_front(tmp_path):
    write_video(tmp_path / "v.mp4", pictures(5), 30)
    data = (tmp_path / "v.mp4").read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_odd_sizes_are_padded(tmp_path):
    written = pictures(4, 61, 75)
    write_video(tmp_path / "v.mp4", written, 29.97)
    shown = decode(tmp_path / "v.mp4")
    assert shown[0].shape == (62, 76, 3)
    assert np.abs(shown[0][:61, :75].astype(int) - written[0]).mean() < 6.0


def test_a_failure_leaves_what_was_there(tmp_path):
    write_video(tmp_path / "v.mp4", pictures(3), 30)
    before = (tmp_path / "v.mp4").read_bytes()

    def failing():
        yield from pictures(3)
        raise RuntimeError("renderer died")

    with pytest.raises(RuntimeError, match="renderer died"):
        write_video(tmp_path / "v.mp4", failing(), 30)
    with pytest.raises(ValueError, match=r"frame 2 is \(10, 10, 3\)"):
        write_video(tmp_path / "v.mp4", [*pictures(2), np.zeros((10, 10, 3), np.uint8)], 30)
    with pytest.raises(ValueError, match="no frames"):
        write_video(tmp_path / "v.mp4", [], 30)
    with pytest.raises(ValueError, match="float64"):
        write_video(tmp_path / "v.mp4", [np.zeros((10, 10, 3))], 30)
    with pytest.raises(ValueError, match="fps"):
        write_video(tmp_path / "v.mp4", pictures(2), 0)
    assert (tmp_path / "v.mp4").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["v.mp4"]


def test_frame_by_frame(tmp_path):
    with VideoWriter(tmp_path / "v.mp4", fps=30) as video:
        for picture in pictures(6):
            video.write(picture)
        assert not (tmp_path / "v.mp4").exists()
    assert video.frame_count == 6
    assert video.close() == 6
    assert len(decode(tmp_path / "v.mp4")) == 6
    with pytest.raises(ValueError, match="closed"):
        video.write(pictures(1)[0])


def test_a_video_without_frames_leaves_no_file(tmp_path):
    with VideoWriter(tmp_path / "v.mp4", fps=30) as video:
        pass
    assert video.frame_count == 0
    assert list(tmp_path.iterdir()) == []
