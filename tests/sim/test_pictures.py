"""A run's pictures: drawn beside the simulation they are what they are in line, in one order; and they break well."""

import threading

import numpy as np
import pytest
from rerun.chunk import RrdReader

from wsim.phases import Phases
from wsim.progress import silent
from wsim.recording import RecordingWriter, read
from wsim.recording.video import read_video
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.measure import measure
from wsim.sim.pictures import AHEAD, Pictures

FRAMES = 8


class Counting(RecordingWriter):
    """A recording that knows how many pictures were given to it."""

    images = 0

    def image(self, *picture):
        self.images += 1
        super().image(*picture)


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """A ball falls into a tank of water, another flies past it, seen by two cameras."""
    scene = Scene()
    scene.simulation(duration=FRAMES / 50.0, frame_rate=50.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3), wall=0.02)
    scene.fluid("water", fills=tank, level=0.15, spacing=0.03)
    scene.sphere("ball", radius=0.05, density=2000.0, position=(0.0, 0.0, 0.25), velocity=(0.0, 0.0, -2.0))
    scene.sphere("bird", radius=0.06, density=500.0, position=(0.4, -0.3, 0.2), velocity=(0.0, 3.0, 1.5))
    scene.camera("side", eye=(1.2, -0.6, 0.5), target=(0.0, 0.0, 0.15), width=96, height=64)
    scene.camera("top", eye=(0.0, -0.4, 1.2), target=(0.0, 0.0, 0.1), width=64, height=96)
    return scene.save(tmp_path_factory.mktemp("tank") / "stage.usda")


def run(stage, folder, beside):
    """The stage, simulated, its pictures drawn beside it or not; how many the recording had after each frame."""
    simulation, recorded = Simulation(stage, device="cpu", draws=True), []
    world, built = simulation.world, simulation.built
    files = (folder / "v.mp4", folder / "frames", folder / "review.json")
    with (
        Counting(folder / "r.rrd", world) as writer,
        Pictures(world, built, writer, *files, FRAMES, silent, Phases(), beside) as pictures,
    ):
        for frame in range(FRAMES + 1):
            if frame:
                simulation.advance_frame()
            writer.frame(simulation.time, measure(built, simulation.state, simulation.rigid, simulation.fluid))
            pictures.take(frame, simulation.time, simulation.state)
            recorded.append(writer.images)
    return recorded


@pytest.fixture(scope="module")
def runs(stage, tmp_path_factory):
    """Folders of two runs, and what was recorded when: drawn in line, and beside."""
    folders = [tmp_path_factory.mktemp(name) for name in ("inline", "beside")]
    return folders, [run(stage, folder, beside) for folder, beside in zip(folders, (False, True), strict=True)]


def rows(path):
    """Entity, columns and number of rows of each chunk in time, in order; Rerun writes timeless ones as it likes."""
    found = [
        (chunk.entity_path, sorted(chunk.to_record_batch().schema.names), chunk.num_rows)
        for chunk in RrdReader(path).stream()
    ]
    return [each for each in found if "sim_time" in each[1]]


def test_pictures_drawn_beside_are_those_drawn_in_line(runs):
    """Also the state is as it was then, though the simulation has gone on: the ball falls 4 cm a frame."""
    inline, beside = (read(folder / "r.rrd") for folder in runs[0])
    assert list(beside.images) == list(inline.images) == ["/World/side", "/World/top"]
    for prim, track in inline.images.items():
        assert track.time.tolist() == beside.images[prim].time.tolist()
        assert [track.jpeg(k) for k in range(len(track))] == [beside.images[prim].jpeg(k) for k in range(len(track))]
        assert np.array_equal(inline.seen[prim].share, beside.seen[prim].share)
    assert len(inline.images["/World/side"]) == FRAMES + 1
    assert np.any(inline.images["/World/side"][0] != inline.images["/World/side"][4])


def test_a_recordings_rows_stand_in_one_order(runs):
    inline, beside = (rows(folder / "r.rrd") for folder in runs[0])
    assert inline == beside
    assert sum("side" in entity for entity, _, _ in inline) >= 2


def test_stills_are_the_same(runs):
    inline, beside = runs[0]
    names = sorted(path.name for path in (inline / "frames").iterdir())
    assert len(names) == 12
    for name in [*names, "../review.json"]:
        assert (inline / "frames" / name).read_bytes() == (beside / "frames" / name).read_bytes()


def test_the_video_has_each_frame_in_its_place(runs):
    """Of all pictures recorded, a frame of the video is nearest to that of its time; x264 itself rounds as it likes."""
    for folder in runs[0]:
        pictures = np.array([*read(folder / "r.rrd").images["/World/side"]], dtype=float)
        video = np.array([rgb for _, rgb in read_video(folder / "v.mp4", FRAMES + 1)], dtype=float)
        apart = np.abs(video[:, None] - pictures[None]).mean(axis=(2, 3, 4))
        assert np.argmin(apart, axis=1).tolist() == list(range(FRAMES + 1))


def test_the_simulation_is_no_more_than_so_many_frames_ahead(runs):
    """Frame k waits for the picture of frame k - AHEAD, and for no later one: both cameras' at the stills 0, 2, 3, …"""
    cameras = [2 if frame in (0, 2, 3, 5, 6, 8) else 1 for frame in range(FRAMES + 1)]
    expected = [sum(cameras[: max(0, frame + 1 - AHEAD)]) for frame in range(FRAMES + 1)]
    assert runs[1] == [expected, expected]


def test_a_picture_that_cannot_be_kept_ends_the_run(stage, tmp_path):
    """What breaks in the thread is raised in the run; the recording says so, and no video and no thread is left."""
    (tmp_path / "frames").write_text("no folder")
    with pytest.raises(FileExistsError):
        Simulation(stage, device="cpu", draws=True).run(
            tmp_path / "r.rrd", tmp_path / "v.mp4", tmp_path / "frames", tmp_path / "review.json"
        )
    recording = read(tmp_path / "r.rrd")
    assert not recording.metadata["complete"]
    assert "FileExistsError" in recording.metadata["error"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frames", "r.rrd"]
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("pictures")]


def test_a_run_that_is_stopped_leaves_no_thread_and_no_video(stage, tmp_path):
    """Ctrl-C comes between two frames, while pictures wait."""

    def stop(stage_of_work, done, total):
        if stage_of_work == "simulating" and done == 4:
            raise KeyboardInterrupt

    simulation = Simulation(stage, device="cpu", draws=True)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(tmp_path / "r.rrd", tmp_path / "v.mp4", tmp_path / "frames", progress=stop)
    assert "KeyboardInterrupt" in read(tmp_path / "r.rrd").metadata["error"]
    assert not list(tmp_path.glob("v.mp4*"))
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("pictures")]
