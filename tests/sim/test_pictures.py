"""A run's pictures, drawn when it has ended: each of the state that was then, and stills of what happens."""

import json
import threading

import numpy as np
import pytest

from wsim.phases import Phases
from wsim.progress import silent
from wsim.recording import RecordingWriter, read
from wsim.recording.video import read_video
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.cameras import CameraRenderer
from wsim.sim.framing.motion import MotionLog
from wsim.sim.pictures import Film, Pictures

FRAMES = 12


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """A ball falls into a tank of water, another flies past it, seen by two cameras that stay."""
    scene = Scene()
    scene.simulation(duration=FRAMES / 50.0, frame_rate=50.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3), wall=0.02)
    scene.fluid("water", fills=tank, level=0.15, spacing=0.03)
    scene.sphere("ball", radius=0.05, density=2000.0, position=(0.0, 0.0, 0.25), velocity=(0.0, 0.0, -2.0))
    scene.sphere("bird", radius=0.06, density=500.0, position=(0.4, -0.3, 0.2), velocity=(0.0, 3.0, 1.5))
    scene.camera("side", eye=(1.2, -0.6, 0.5), target=(0.0, 0.0, 0.15), width=96, height=64, fixed=True)
    scene.camera("top", eye=(0.0, -0.4, 1.2), target=(0.0, 0.0, 0.1), width=64, height=96, fixed=True)
    return scene.save(tmp_path_factory.mktemp("tank") / "stage.usda")


@pytest.fixture(scope="module")
def folder(stage, tmp_path_factory):
    """Of a run."""
    made = tmp_path_factory.mktemp("run")
    Simulation(stage, device="cpu", draws=True).run(
        made / "r.rrd", made / "v.mp4", made / "frames", made / "review.json"
    )
    return made


def test_each_picture_is_of_the_state_that_was_then(folder, stage):
    """Drawn again from the recording: the ball falls 4 cm a frame, and the simulation had gone on to its end."""
    found = read(folder / "r.rrd")
    assert list(found.images) == ["/World/side", "/World/top"]
    assert len(found.images["/World/side"]) == FRAMES + 1
    simulation = Simulation(stage, device="cpu", draws=True)
    renderer = CameraRenderer(simulation.model, simulation.world)
    renderer.look_through(renderer.cameras)
    for frame in (0, 4, FRAMES):
        q = simulation.state.body_q.numpy()
        q[simulation.built.bodies] = found.body_q[frame]
        simulation.state.body_q.assign(q)
        water = {"/World/water": found.fluids["/World/water"].position[frame]}
        again = renderer.render(simulation.state, water)["/World/side"].rgb.astype(float)
        assert np.abs(again - found.images["/World/side"][frame]).mean() < 2.0  # of 255: JPEG
    assert np.abs(again - found.images["/World/side"][0]).mean() > 4.0


def test_the_video_has_each_frame_in_its_place(folder):
    """Of all pictures recorded, a frame of the video is nearest to that of its time; x264 itself rounds as it likes."""
    pictures = np.array([*read(folder / "r.rrd").images["/World/side"]], dtype=float)
    video = np.array([rgb for _, rgb in read_video(folder / "v.mp4", FRAMES + 1)], dtype=float)
    apart = np.abs(video[:, None] - pictures[None]).mean(axis=(2, 3, 4))
    assert np.argmin(apart, axis=1).tolist() == list(range(FRAMES + 1))


def test_stills_are_of_all_cameras_at_the_same_moments(folder):
    names = sorted(path.name for path in (folder / "frames").iterdir())
    times = [name.removeprefix("side_") for name in names if name.startswith("side_")]
    assert [name.removeprefix("top_") for name in names if name.startswith("top_")] == times
    assert len(times) == 6
    assert (times[0], times[-1]) == ("00.000s.png", f"{FRAMES / 50.0:06.3f}s.png")
    told = json.loads((folder / "review.json").read_text(encoding="utf-8"))
    assert [row["time"] for row in told["share_of_picture"] if row["camera"] == "/World/top"] == [
        float(time.removesuffix("s.png")) for time in times
    ]
    assert set(told["moments"][0]) == {"time", "what", "weight"}


def test_a_run_that_breaks_has_pictures_of_what_went_well(stage, tmp_path):
    """Frames of a state that is not finite are not drawn; stills are of the rest, to its end."""
    simulation = Simulation(stage, device="cpu", draws=True)

    def break_it(step, done, total):
        if step == "simulating" and done == 3:
            velocity = simulation.state.body_qd.numpy()
            velocity[:] = np.nan
            simulation.state.body_qd.assign(velocity)
            simulation.rigid.reset(simulation.state)

    result = simulation.run(
        tmp_path / "r.rrd", tmp_path / "v.mp4", tmp_path / "frames", tmp_path / "review.json", progress=break_it
    )
    assert result.problems
    assert "side_00.060s.png" in {path.name for path in result.stills}
    assert len(result.stills) == 2 * 4
    assert len(list(read_video(tmp_path / "v.mp4", 50))) == 4


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


@pytest.mark.parametrize("step", ["simulating", "drawing"])
def test_a_run_that_is_stopped_leaves_no_thread_and_no_video(stage, tmp_path, step):
    """Ctrl-C comes between two frames, while they are computed or drawn."""

    def stop(doing, done, total):
        if doing == step and done == 4:
            raise KeyboardInterrupt

    simulation = Simulation(stage, device="cpu", draws=True)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(tmp_path / "r.rrd", tmp_path / "v.mp4", tmp_path / "frames", progress=stop)
    assert "KeyboardInterrupt" in read(tmp_path / "r.rrd").metadata["error"]
    assert not list(tmp_path.glob("v.mp4*"))
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("pictures")]


def test_nothing_is_drawn_of_no_frames(stage, tmp_path):
    """A run that breaks before its first frame has no video."""
    simulation = Simulation(stage, device="cpu", draws=True)
    world, built = simulation.world, simulation.built
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        film = Film(tmp_path / "v.mp4", tmp_path / "frames", tmp_path / "review.json")
        with Pictures(world, built, lambda: built, writer, film, silent, Phases()) as pictures:
            pictures.draw(MotionLog().motion())
    assert not (tmp_path / "v.mp4").exists()
    assert json.loads((tmp_path / "review.json").read_text())["share_of_picture"] == []
