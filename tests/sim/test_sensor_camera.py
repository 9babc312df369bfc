"""Cameras that are sensors, against closed forms: how far what they see is, how large, and what it is."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from wsim.recording import read
from wsim.recording.sensor_pictures import MOST_PICTURES
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.collect import follow
from wsim.sim.sensor_camera import Camera

Build = Callable[[Scene], object]
WIDTH, HEIGHT, FOV = 121, 81, 60.0  # odd: a pixel in the middle looks along the axis
FOCAL = WIDTH / (2.0 * math.tan(math.radians(FOV) / 2.0))
SIZE: dict[str, Any] = {"width": WIDTH, "height": HEIGHT, "fov": FOV}
MIDDLE = (HEIGHT // 2, WIDTH // 2)
RIGHT, DOWN = np.meshgrid(np.arange(WIDTH) - MIDDLE[1], np.arange(HEIGHT) - MIDDLE[0])


def stage(folder: Path, build: Build, duration: float = 0.1, name: str = "stage") -> Path:
    scene = Scene()
    scene.simulation(duration=duration, frame_rate=20.0, gravity=(0.0, 0.0, 0.0))
    build(scene)
    return scene.save(folder / f"{name}.usda")


def samples(simulation: Simulation) -> dict[str, dict[str, NDArray[Any]]]:
    """What the sensors of all worlds tell as they stand, by prim, to somebody who wants it."""
    simulation.sensors.tell(lambda *_: None)
    simulation.sensors.ask(0, simulation)
    return dict(simulation.sensors._last)


def told(folder: Path, build: Build) -> dict[str, NDArray[Any]]:
    """What the one sensor of a world tells at the start."""
    (sample,) = samples(Simulation(stage(folder, build), device="cpu")).values()
    return {channel: value[0] for channel, value in sample.items()}


@pytest.mark.parametrize("pitch", [20.0, 35.0])
def test_a_plane_seen_at_an_angle(tmp_path: Path, pitch: float) -> None:
    """From h above the ground, looking down by a: the depth is h / (sin a - z cos a), z the slope of a pixel's ray."""
    high, a = 2.0, math.radians(pitch)

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sensor_camera("eye", None, position=(1.0, 2.0, high), rotation_deg=(0.0, pitch, 40.0), **SIZE)

    fall = math.sin(a) + DOWN / FOCAL * math.cos(a)
    depth = told(tmp_path, build)["depth"]
    wanted = np.where(fall > 0.02, high / np.where(fall > 0.02, fall, 1.0), np.inf)
    sure = (fall > 0.021) | (fall <= 0.0)  # farthest = 100 m ends in between
    np.testing.assert_allclose(depth[sure], wanted[sure], rtol=1e-4)


def test_a_sphere_in_the_middle(tmp_path: Path) -> None:
    """Its nearest point is d - r away; the cone that touches it has a radius of f r / sqrt(d^2 - r^2) pixels."""
    away, radius = 4.0, 0.7

    def build(scene: Scene) -> None:
        scene.sphere("ball", radius=radius, position=(0.0, away, 1.0), static=True)
        scene.sensor_camera("eye", None, position=(0.0, 0.0, 1.0), rotation_deg=(0.0, 0.0, 90.0), **SIZE)

    seen = told(tmp_path, build)
    assert seen["depth"][MIDDLE] == pytest.approx(away - radius, rel=1e-5)
    disc = FOCAL * radius / math.sqrt(away**2 - radius**2)
    assert np.count_nonzero(seen["segmentation"]) == pytest.approx(math.pi * disc**2, rel=0.03)
    inside = np.hypot(RIGHT, DOWN) < disc - 1.0
    # Of a ray of the slope s the nearer root of (d - x)^2 + (s x)^2 = r^2.
    slope = np.hypot(RIGHT, DOWN)[inside] / FOCAL
    wanted = (away - np.sqrt(away**2 - (1.0 + slope**2) * (away**2 - radius**2))) / (1.0 + slope**2)
    np.testing.assert_allclose(seen["depth"][inside], wanted, rtol=1e-4)
    assert np.isinf(seen["depth"][seen["segmentation"] == 0]).all()


def test_a_box_is_as_large_as_its_distance_has_it(tmp_path: Path) -> None:
    """f w / d pixels wide and f h / d high, by its face at d; what is y to the left is f y / d left of the middle."""
    away, wide, high, left, up = 5.0, 1.2, 0.6, 0.8, 0.3

    def build(scene: Scene) -> None:
        scene.box("crate", size=(0.2, wide, high), position=(away + 0.1, left, 1.0 + up), static=True)
        scene.box("behind", size=(0.2, 20.0, 20.0), position=(9.1, 0.0, 1.0), static=True)
        car = scene.box("car", size=(1.0, 1.0, 1.0), position=(-0.3, 0.0, 1.0), kinematic=True)
        scene.sensor_camera("eye", car, position=(0.3, 0.0, 0.0), **SIZE)  # inside its body, which it looks through

    seen = told(tmp_path, build)
    crate = seen["segmentation"] == 2  # by the world's order: what moves first
    rows, columns = np.nonzero(crate)
    assert np.ptp(columns) + 1 == pytest.approx(FOCAL * wide / away, abs=1.0)
    assert np.ptp(rows) + 1 == pytest.approx(FOCAL * high / away, abs=1.0)
    assert columns.mean() - MIDDLE[1] == pytest.approx(-FOCAL * left / away, abs=0.5)
    assert rows.mean() - MIDDLE[0] == pytest.approx(-FOCAL * up / away, abs=0.5)
    edge = 2.0 * FOCAL * (wide + high) / away
    assert crate.sum() == pytest.approx(FOCAL**2 * wide * high / away**2, abs=0.5 * edge)
    assert (seen["segmentation"] > 0).all() and not (seen["segmentation"] == 1).any()
    np.testing.assert_allclose(seen["depth"][crate], away, rtol=1e-5)  # along the axis: the same all over a face
    np.testing.assert_allclose(seen["depth"][seen["segmentation"] == 3], 9.0, rtol=1e-5)


def test_glass_is_looked_through_and_what_is_far_is_infinite(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        glass = scene.material("glass", density=2500.0, opacity=0.2)
        scene.box("pane", size=(0.1, 9.0, 9.0), position=(2.0, 0.0, 0.0), static=True, material=glass)
        scene.box("near", size=(0.1, 9.0, 9.0), position=(3.05, 4.5, 0.0), static=True)
        scene.box("far", size=(0.1, 9.0, 9.0), position=(6.05, -4.5, 0.0), static=True)
        scene.sensor_camera("eye", None, farthest=5.0, channels=("segmentation", "depth"), **SIZE)

    seen = told(tmp_path, build)
    assert list(seen) == ["depth", "segmentation"]
    left, right = seen["depth"][MIDDLE[0], MIDDLE[1] - 5], seen["depth"][MIDDLE[0], MIDDLE[1] + 5]
    assert (left, right) == (pytest.approx(3.0, rel=1e-5), math.inf)
    assert (seen["segmentation"][MIDDLE[0], [MIDDLE[1] - 5, MIDDLE[1] + 5]] == (2, 3)).all()


def test_a_camera_turns_with_its_body_and_is_recorded(tmp_path: Path) -> None:
    """A box that turns by w t sees a ball at an azimuth of b - w t: f tan of that left of the middle."""
    turn, azimuth, away = 60.0, 25.0, 8.0

    def build(scene: Scene) -> None:
        box = scene.box(
            "box", size=(0.4, 0.4, 0.4), position=(2.0, 1.0, 1.0), angular_velocity_deg=(0.0, 0.0, turn)
        )  # fmt: skip
        angle = math.radians(azimuth)
        scene.sphere(
            "ball", radius=0.4, position=(2.0 + away * math.cos(angle), 1.0 + away * math.sin(angle), 1.0),
            static=True, color=(0.8, 0.02, 0.02),
        )  # fmt: skip
        scene.sensor_camera("eye", box, rate=20.0, **SIZE)

    path = stage(tmp_path, build, duration=0.8)
    assert Simulation(path, device="cpu").run(tmp_path / "recording.rrd").problems == []
    track = read(tmp_path / "recording.rrd").sensors["/World/eye"]
    np.testing.assert_allclose(track.time, np.arange(17) * 0.05, atol=1e-9)
    assert track.labels == ["", "/World/box", "/World/ball"]
    colors, depths, parts = track["color"], track["depth"], track["segmentation"]
    assert colors.shape == (17, HEIGHT, WIDTH, 3) and colors.dtype == np.uint8
    for time, color, depth, part in zip(track.time, colors, depths, parts, strict=True):
        ball = part == 2
        relative = math.radians(azimuth - turn * time)
        wanted = -FOCAL * math.tan(relative)
        assert np.nonzero(ball)[1].mean() - MIDDLE[1] == pytest.approx(wanted, abs=0.75)
        # Along the axis, which is not the way to its centre.
        assert depth[ball].min() == pytest.approx(away * math.cos(relative) - 0.4, abs=0.01)
        assert color[ball].mean(axis=0)[0] > 2.0 * color[ball].mean(axis=0)[1]  # red, through JPEG as well
        assert np.isinf(depth[part == 0]).all()


def test_what_a_recording_keeps_is_exact_to_its_steps_and_bounded(tmp_path: Path) -> None:
    """Of 100 pictures a second as many as there are frames; depth to a step of farthest / 65534."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("box", size=(1.0, 1.0, 1.0), position=(4.0, 0.3, 0.5))
        scene.sensor_camera("eye", None, position=(0.0, 0.0, 1.5), rotation_deg=(0.0, 15.0, 0.0), rate=100.0,
                            farthest=20.0, width=64, height=48)  # fmt: skip

    path = stage(tmp_path, build, duration=0.5)
    simulation = Simulation(path, device="cpu")
    first = {channel: value[0] for channel, value in samples(simulation)["/World/eye"].items()}
    assert simulation.run(tmp_path / "recording.rrd").problems == []
    track = read(tmp_path / "recording.rrd").sensors["/World/eye"]
    np.testing.assert_allclose(track.time, np.arange(11) * 0.05, atol=1e-9)
    np.testing.assert_array_equal(track["segmentation"][0], first["segmentation"])
    met = np.isfinite(first["depth"])
    assert (np.isfinite(track["depth"][0]) == met).all() and met.any() and not met.all()
    np.testing.assert_allclose(track["depth"][0][met], first["depth"][met], atol=0.51 * 20.0 / 65534)
    assert np.abs(track["color"][0].astype(int) - first["color"]).mean() < 3.0
    with pytest.raises(KeyError, match="the sensor tells"):
        track["distance"]
    assert MOST_PICTURES * 640 * 480 * 3 < 1e9  # bytes, if nothing of them was compressed


def test_worlds_of_a_batch_see_each_their_own(tmp_path: Path) -> None:
    """Two worlds of one topology: a wall at 3 m and at 5 m, seen by wider and by narrower lenses."""

    def build(away: float, fov: float) -> Build:
        def made(scene: Scene) -> None:
            scene.box("wall", size=(0.2, 1.0, 1.0), position=(away + 0.1, 0.0, 1.0), static=True)
            car = scene.box("car", size=(0.4, 0.4, 0.4), position=(0.0, 0.0, 1.0))
            scene.sensor_camera("eye", car, width=61, height=41, fov=fov)

        return made

    lenses = ((3.0, 60.0), (5.0, 40.0))
    stages = [stage(tmp_path, build(*lens), name=f"stage_{k}") for k, lens in enumerate(lenses)]
    simulation = Simulation(stages, device="cpu")
    seen = samples(simulation)["/World/eye"]
    assert seen["color"].shape == (2, 41, 61, 3)
    assert simulation.sensors.flat().shape == (2, 41 * 61 * 5)
    for depth, part, (away, fov) in zip(seen["depth"], seen["segmentation"], lenses, strict=True):
        assert depth[20, 30] == pytest.approx(away, rel=1e-5)
        focal = 61.0 / (2.0 * math.tan(math.radians(fov) / 2.0))
        assert np.count_nonzero((part == 2).any(axis=0)) == pytest.approx(focal / away, abs=1.0)


@pytest.mark.cuda
def test_a_gpu_shows_what_a_cpu_shows(tmp_path: Path) -> None:
    """Far flat faces, round ones, glass, two worlds: but for what lies on an edge, and a step of colour."""

    def build(away: float) -> Build:
        def made(scene: Scene) -> None:
            scene.ground()
            pane = scene.material("pane", density=1000.0, opacity=0.3)
            scene.box("pane", size=(0.05, 1.0, 1.0), position=(3.0, 0.5, 0.6), static=True, material=pane)
            scene.box("far", size=(6.0, 6.0, 6.0), position=(away, -6.0, 3.0), static=True)
            scene.cylinder("drum", radius=2.0, height=4.0, position=(away, 5.0, 2.0), static=True)
            scene.capsule("post", radius=0.4, height=0.8, position=(5.0, -1.0, 0.4), static=True)
            scene.sphere("ball", radius=0.3, position=(4.0, 0.4, 0.3))
            car = scene.box("car", size=(0.4, 0.4, 0.4), position=(0.0, 0.0, 0.2))
            scene.sensor_camera("eye", car, position=(0.0, 0.0, 1.0), rotation_deg=(0.0, 5.0, 0.0), **SIZE)

        return made

    stages = [stage(tmp_path, build(away), name=f"stage_{k}") for k, away in enumerate((24.0, 48.0))]
    here, there = (samples(Simulation(stages, device=device))["/World/eye"] for device in ("cpu", "cuda:0"))
    same = here["segmentation"] == there["segmentation"]
    assert np.count_nonzero(~same) <= 0.003 * same.size
    assert len(np.unique(here["segmentation"])) >= 6
    seen = same & np.isfinite(here["depth"]) & np.isfinite(there["depth"])
    assert np.count_nonzero(seen) > 0.5 * same.size
    assert np.quantile(np.abs(there["depth"][seen] / here["depth"][seen] - 1.0), 0.995) < 1e-4
    shade = np.abs(here["color"].astype(int) - there["color"].astype(int)).max(axis=-1)
    assert np.quantile(shade[same], 0.99) <= 2


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Simulation:
    """Two worlds: a red wall behind something opaque to the left of the middle, and a blue one behind glass."""

    def build(color: tuple[float, float, float], opacity: float) -> Build:
        def made(scene: Scene) -> None:
            pane = scene.material("pane", density=1000.0, opacity=opacity)
            scene.box("wall", size=(0.2, 9.0, 9.0), position=(6.1, 0.0, 0.0), static=True, color=color)
            scene.box("pane", size=(0.2, 3.0, 3.0), position=(3.1, 1.5, 0.0), static=True, material=pane)
            car = scene.box("car", size=(0.4, 0.4, 0.4), position=(0.0, 0.0, 0.0))
            scene.sensor_camera("eye", car, width=41, height=31, fov=60.0)

        return made

    folder = tmp_path_factory.mktemp("pair")
    looks = (((0.8, 0.02, 0.02), 1.0), ((0.02, 0.02, 0.8), 0.2))
    stages = [stage(folder, build(*each), name=f"stage_{k}") for k, each in enumerate(looks)]
    return Simulation(stages, device="cpu")


def test_worlds_of_a_batch_have_their_own_colours_and_glass(pair: Simulation) -> None:
    before = pair.model.shape_color.numpy().copy()
    seen = samples(pair)["/World/eye"]
    red, blue = seen["color"][:, 15, 30].astype(int)
    assert red[0] > 3 * red[2] and blue[2] > 3 * blue[0]
    np.testing.assert_allclose(seen["depth"][:, 15, 10], (3.0, 6.0), rtol=1e-5)
    np.testing.assert_array_equal(seen["segmentation"][:, 15, [10, 30]], [[3, 2], [2, 2]])
    np.testing.assert_array_equal(pair.model.shape_color.numpy(), before)  # films have their own


@pytest.mark.parametrize("place", [np.nan, 1e20])
def test_a_world_that_is_lost_tells_nothing_and_the_other_tells_on(pair: Simulation, place: float) -> None:
    before = samples(pair)["/World/eye"]
    kept = pair.state.body_q.numpy().copy()
    lost = kept.copy()
    lost[1, 0] = place
    try:
        pair.state.body_q.assign(lost)
        after = samples(pair)["/World/eye"]
    finally:
        pair.state.body_q.assign(kept)
    for channel, nothing in (("color", 0), ("depth", np.inf), ("segmentation", 0)):
        np.testing.assert_array_equal(after[channel][0], before[channel][0])
        assert (after[channel][1] == nothing).all() and (before[channel][1] != nothing).any()


def test_a_carrier_of_glass_is_no_more_seen_than_another(tmp_path: Path) -> None:
    """Two cameras far apart before one plain wall, each inside its own car."""

    def build(scene: Scene) -> None:
        glass = scene.material("glass", density=1000.0, opacity=0.5)
        scene.box("wall", size=(0.2, 90.0, 9.0), position=(6.1, 0.0, 0.0), static=True, color=(0.8, 0.8, 0.8))
        for name, left, look in (("bare", 20.0, {}), ("glazed", -20.0, {"material": glass})):
            car = scene.box(
                f"{name}_car", size=(2.0, 2.0, 2.0), position=(0.0, left, 0.0), color=(1.0, 0.0, 0.0), **look
            )
            scene.sensor_camera(name, car, width=21, height=15, channels=("color",))

    simulation = Simulation(stage(tmp_path, build), device="cpu")
    seen = samples(simulation)
    bare, glazed = (seen[f"/World/{name}"]["color"][0].astype(int) for name in ("bare", "glazed"))
    assert np.abs(bare - glazed).max() <= 1


def test_depth_goes_as_deep_in_the_corner_as_in_the_middle(tmp_path: Path) -> None:
    """To 1000 m along the axis, which in the corner is 1216 m along the ray."""

    def build(scene: Scene) -> None:
        scene.box("wall", size=(0.2, 1000.0, 1000.0), position=(990.1, 0.0, 0.0), static=True)
        scene.sensor_camera("eye", None, width=21, height=15, fov=50.0, farthest=1000.0, channels=("depth",))

    depth = told(tmp_path, build)["depth"]
    np.testing.assert_allclose(depth, 990.0, rtol=1e-5)


def test_objects_are_known_whatever_the_root_of_the_stage(tmp_path: Path) -> None:
    """`/Env/World` in place of `/World`: its one object is `/Env/World`, and the wall has its colour."""

    def build(scene: Scene) -> None:
        scene.box("wall", size=(0.2, 9.0, 9.0), position=(3.1, 0.0, 0.0), static=True, color=(0.8, 0.02, 0.02))
        scene.sensor_camera("eye", None, width=9, height=7)

    text = stage(tmp_path, build).read_text(encoding="utf-8").replace("/World", "/Env/World")
    text = text.replace('defaultPrim = "World"', 'defaultPrim = "Env"')
    text = text.replace('def Xform "World"', 'def Xform "Env"\n{\ndef Xform "World"') + "}\n"
    path = tmp_path / "env.usda"
    path.write_text(text, encoding="utf-8")
    simulation = Simulation(path, device="cpu")
    seen = samples(simulation)["/Env/World/eye"]
    assert (seen["segmentation"] == 1).all()
    assert seen["color"][0, 3, 4, 0] > 3 * seen["color"][0, 3, 4, 2].astype(int)


def test_pictures_are_drawn_where_somebody_wants_them_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not in a sweep without `control`; there once at each of its turns."""

    def build(scene: Scene) -> None:
        box = scene.box("box", size=(0.4, 0.4, 0.4), position=(0.0, 0.0, 1.0))
        scene.sensor_camera("eye", box, rate=20.0, width=8, height=6)

    drawn: list[float] = []
    made: list[object] = []
    call, prepare = Camera.__call__, Camera.prepare
    monkeypatch.setattr(Camera, "__call__", lambda self, t, sim: drawn.append(t) or call(self, t, sim))
    monkeypatch.setattr(Camera, "prepare", lambda self: made.append(self) or prepare(self))
    path = stage(tmp_path, build)
    follow(Simulation(path, device="cpu", world_count=2))
    assert not drawn and not made
    follow(Simulation(path, device="cpu", world_count=2, controller=lambda t, simulation: None))
    assert drawn == pytest.approx([0.0, 0.05]) and len(made) == 1
    drawn.clear()
    assert Simulation(path, device="cpu").run(tmp_path / "recording.rrd").problems == []
    assert drawn == pytest.approx([0.0, 0.05, 0.1]) and len(made) == 2
