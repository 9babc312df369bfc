"""What sensors told, written and read back."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from wsim.recording import RecordingWriter, read
from wsim.scene.world import World
from wsim.scene.world_sensors import SensorCamera, SensorIMU, SensorJoints, SensorRange


@pytest.fixture
def sensed(world: World) -> World:
    imu = SensorIMU(prim="/World/imu", rate=100.0, body="/World/block")
    joints = SensorJoints(prim="/World/encoder", rate=50.0, joints=["/World/a", "/World/b", "/World/c"])
    return world.model_copy(update={"sensors": [imu, joints]})


def test_samples_come_back_at_their_own_times(tmp_path: Path, sensed: World, make_frame, monkeypatch) -> None:
    monkeypatch.setattr("wsim.recording.sensors.ROWS", 7)  # chunks end in between
    random = np.random.default_rng(0)
    samples = random.standard_normal((23, 2, 3))
    efforts = random.standard_normal((11, 3, 3))
    with RecordingWriter(tmp_path / "r.rrd", sensed) as writer:
        writer.frame(0.0, make_frame(0))
        for k, (force, spin) in enumerate(samples):
            writer.sample(0.01 * k, "/World/imu", {"accelerometer": force, "gyroscope": spin})
        for k, (q, qd, effort) in enumerate(efforts):
            writer.sample(0.02 * k, "/World/encoder", {"position": q, "velocity": qd, "effort": effort})
    recording = read(tmp_path / "r.rrd")
    assert recording.world == sensed
    imu, encoder = recording.sensors["/World/imu"], recording.sensors["/World/encoder"]
    np.testing.assert_allclose(imu.time, 0.01 * np.arange(23), atol=1e-12)
    np.testing.assert_array_equal(imu["accelerometer"], samples[:, 0])
    np.testing.assert_array_equal(imu["gyroscope"], samples[:, 1])
    assert len(encoder.time) == 11
    np.testing.assert_array_equal(encoder["effort"], efforts[:, 2])
    assert set(recording.scalars) == {"energy/kinetic", "energy/potential"}  # samples are none of a frame's
    with pytest.raises(KeyError, match=r"no channel 'force'; the sensor tells \['accelerometer', 'gyroscope'\]"):
        imu["force"]


def test_scans_come_back_in_layers_with_what_they_did_not_meet(tmp_path: Path, world: World, monkeypatch) -> None:
    monkeypatch.setattr("wsim.recording.sensors.CHUNK_BYTES", 2000)
    scan = SensorRange(
        prim="/World/scan", rate=10.0, body=None, azimuths=[0.0] * 50, elevations=[0.0, 0.1], farthest=9.0
    )
    distances = np.random.default_rng(0).random((7, 2, 50))
    distances[:, 0, ::3] = np.inf
    with RecordingWriter(tmp_path / "r.rrd", world.model_copy(update={"sensors": [scan]})) as writer:
        for k, each in enumerate(distances):
            writer.sample(0.1 * k, "/World/scan", {"distance": each}, np.zeros((k, 3)))
    track = read(tmp_path / "r.rrd").sensors["/World/scan"]
    np.testing.assert_allclose(track.time, 0.1 * np.arange(7), atol=1e-12)
    np.testing.assert_array_equal(track["distance"], distances)


def test_a_sensor_that_was_never_read_has_no_samples(tmp_path: Path, sensed: World) -> None:
    with RecordingWriter(tmp_path / "r.rrd", sensed):
        pass
    track = read(tmp_path / "r.rrd").sensors["/World/encoder"]
    assert track.time.shape == (0,) and track["position"].shape == (0, 3)


def test_what_the_world_does_not_say_is_refused(tmp_path: Path, sensed: World) -> None:
    with RecordingWriter(tmp_path / "r.rrd", sensed) as writer:
        with pytest.raises(ValueError, match="no sensor '/World/lidar'; the world has"):
            writer.sample(0.0, "/World/lidar", {})
        with pytest.raises(ValueError, match=r"sample of /World/imu: it has .* the world says"):
            writer.sample(0.0, "/World/imu", {"accelerometer": np.zeros(2), "gyroscope": np.zeros(3)})


def camera(rate: float, channel: Literal["depth", "segmentation"]) -> SensorCamera:
    return SensorCamera(
        prim="/World/eye", rate=rate, body=None, width=4, height=3, fov=60.0, farthest=100.0, tells=[channel]
    )


@pytest.mark.parametrize(("asked", "apart"), [(1e4, 0.001), (1e4, 0.0125), (30.0, 1.0 / 30.0), (7.0, 0.125)])
def test_pictures_are_thinned_by_when_they_were_taken(tmp_path: Path, world: World, asked: float, apart: float) -> None:
    """At 20 frames a second at most each 50 ms, whatever the rate that was asked for: steps may be longer."""
    eye = camera(asked, "depth")
    eyed = world.model_copy(update={"sensors": [eye], "duration": 0.5, "frame_rate": 20.0})
    times = np.arange(round(0.5 / apart) + 1) * apart
    with RecordingWriter(tmp_path / "r.rrd", eyed) as writer:
        for time in times:
            writer.sample(time, "/World/eye", {"depth": np.full((3, 4), 1.0 + time, np.float32)})
    every = int(np.ceil(0.05 / apart - 1e-9))
    track = read(tmp_path / "r.rrd").sensors["/World/eye"]
    np.testing.assert_allclose(track.time, times[::every], atol=1e-8)
    np.testing.assert_allclose(track["depth"][:, 0, 0], 1.0 + times[::every], atol=1e-2)


def test_more_objects_than_a_picture_has_numbers_for_are_refused(tmp_path: Path, world: World, monkeypatch) -> None:
    eye = camera(10.0, "segmentation")
    monkeypatch.setattr("wsim.recording.sensor_pictures.MOST_OBJECTS", 1)
    with pytest.raises(ValueError, match=r"/World/eye: segmentation of \d objects; at most 1 have numbers"):
        RecordingWriter(tmp_path / "r.rrd", world.model_copy(update={"sensors": [eye]}))
