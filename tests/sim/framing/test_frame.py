"""Cameras framed on what happened: subjects are seen in all stills, whatever the stage's camera looked at."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st

from tests.sim.framing.runs import ENOUGH, HEIGHT, WIDTH, a_camera, a_world, drawn, recorded
from wsim.geometry.rotations import line_of_sight
from wsim.recording import read
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.framing.frame import Framing
from wsim.sim.framing.motion import Motion


def run(scene, named=()):
    """Pixels of each object in each still of the stage's camera, by time, and the recording, of a run with pictures."""
    stills, found = drawn(scene, named)
    return stills["/World/main"], found


def shows(stills, name, least=ENOUGH):
    """Whether each still has an object."""
    return [still.get(f"/World/{name}", 0) for still in stills], all(
        still.get(f"/World/{name}", 0) >= least for still in stills
    )


@settings(max_examples=6, deadline=None, phases=[Phase.explicit, Phase.generate])  # to make it smaller takes minutes
@example(0.5, 0.02, 303.2, 3.97, 114.4, 4.93)  # 90 times its size in the time
@given(
    st.floats(-2.0, 2.0), st.floats(0.02, 0.5), st.floats(0.0, 360.0), st.floats(0.0, 9.0), st.floats(0.0, 360.0),
    st.floats(0.0, 5.0),
)  # fmt: skip
def test_a_thing_thrown_anyhow_is_seen_in_all_stills(x, radius, heading, speed, looks, up):
    """Of 2 cm to half a metre, from rest to 9 m/s: to 300 times its size in the time, and a camera looks off.

    Where following it would show nothing that passes, all of its way is in the first picture, and what is too small
    there has a camera of its own.
    """
    scene = a_world()
    way = math.radians(heading)
    scene.sphere(
        "ball", radius=radius, position=(x, 0.0, radius + 0.5),
        velocity=(speed * math.cos(way), speed * math.sin(way), up),
    )  # fmt: skip
    aim = math.radians(looks)
    a_camera(scene, eye=(x, -2.0, 1.0), target=(x + 3.0 * math.cos(aim), -2.0 + 3.0 * math.sin(aim), 1.2))
    stills, _ = drawn(scene)
    by_camera = {camera: shows(of_it, "ball") for camera, of_it in stills.items()}
    assert any(seen for _, seen in by_camera.values()), by_camera
    assert all(min(pixels) > 0 for pixels, _ in by_camera.values()), by_camera


@pytest.mark.parametrize("side", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
def test_what_is_behind_a_wall_is_looked_at_from_its_other_side(side):
    """The stage's camera is right before the wall."""
    scene = a_world(0.4)
    across = (0.1, 6.0, 3.0) if side[0] else (6.0, 0.1, 3.0)
    scene.box("wall", size=across, position=(0.8 * side[0], 0.8 * side[1], 1.5), static=True)
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.6))
    a_camera(scene, eye=(4.0 * side[0], 4.0 * side[1], 1.0), target=(0.0, 0.0, 0.5))
    stills, found = run(scene, named=["ball"])
    pixels, seen = shows(stills, "ball")
    assert seen, (pixels, found.views)


def test_a_thing_in_a_box_without_a_lid_is_looked_at_from_above():
    scene = a_world(0.4)
    for k, (x, y) in enumerate(((0.6, 0.0), (-0.6, 0.0), (0.0, 0.6), (0.0, -0.6))):
        size = (0.05, 1.25, 1.5) if x else (1.25, 0.05, 1.5)
        scene.box(f"wall_{k}", size=size, position=(x, y, 0.75), static=True)
    scene.sphere("ball", radius=0.15, position=(0.0, 0.0, 0.5))
    a_camera(scene)
    pixels, seen = shows(run(scene)[0], "ball")
    assert seen, pixels


@pytest.mark.parametrize("size", [0.002, 0.05, 8.0])
@pytest.mark.parametrize("place", [0.0, 150.0])
def test_small_large_and_far_things_fill_a_useful_part(size, place):
    """A millimetre, a house, far from the origin: a ball that drops by its own size is a tenth of the picture."""
    scene = a_world(0.2)
    scene.sphere("ball", radius=size / 2, position=(place, 0.0, 1.5 * size))
    a_camera(scene)
    pixels, _ = shows(run(scene)[0], "ball")
    assert min(pixels) > math.pi / 4 * (0.1 * HEIGHT) ** 2, pixels
    assert max(pixels) < 0.5 * WIDTH * HEIGHT


def test_what_goes_far_is_followed():
    """A ball of 10 cm that goes 90 m: of all its way in one picture it would be a fifth of a pixel."""
    scene = a_world(0.6)
    scene.sphere("ball", radius=0.05, position=(0.0, 0.0, 0.05), velocity=(150.0, 0.0, 0.0))
    a_camera(scene)
    stills, found = run(scene)
    pixels, seen = shows(stills, "ball")
    assert seen, pixels
    assert found.views[0].follows == "/World/ball"
    assert found.world.cameras == found.views  # what the judge holds against what happened


def test_what_falls_out_of_the_world_is_seen():
    scene = Scene()
    scene.simulation(duration=2.0, frame_rate=12.0)
    scene.box("ledge", size=(0.5, 0.5, 0.1), position=(0.0, 0.0, 0.0), static=True)
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.15), velocity=(1.0, 0.0, 0.0))
    a_camera(scene)
    stills, _ = drawn(scene)
    pixels, seen = shows(stills["/World/default_camera_ball"], "ball")
    assert seen, pixels


def test_frames_from_the_first_that_is_no_number_are_left_out(tmp_path):
    """What follows it may be finite again, and is not believed."""
    scene = a_world()
    scene.sphere("ball", radius=0.05, position=(3.0, 0.0, 2.0), velocity=(2.0, 0.0, 0.0))
    a_camera(scene)
    stage = scene.save(tmp_path / "stage.usda")
    Simulation(stage, device="cpu").run(tmp_path / "r.rrd")
    found = read(tmp_path / "r.rrd")
    q = found.body_q.copy()
    q[8] = np.nan
    q[9:, 0, 0] = 1e30
    broken = Motion.of(replace(found, body_q=q))
    assert len(broken.time) == 8
    assert Framing(describe(stage), broken).cameras()[0].follows is None
    nothing = Motion.of(replace(found, body_q=np.full_like(q, np.nan)))
    assert Framing(describe(stage), nothing).cameras() == describe(stage).cameras


def test_a_camera_that_shows_it_is_kept_to_the_bit_and_a_fixed_one_always(tmp_path):
    scene = a_world(0.5)
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.8))
    a_camera(scene, eye=(0.3, -2.3, 0.8), target=(0.0, 0.0, 0.45))
    scene.camera("away", eye=(0.0, -3.0, 1.0), target=(0.0, -9.0, 1.0), fixed=True)
    world, motion = recorded(scene, tmp_path)
    assert Framing(world, motion).cameras() == world.cameras
    assert read(tmp_path / "r.rrd").views == world.cameras


def test_the_objects_that_are_asked_about_are_framed_and_not_what_else_moves(tmp_path):
    """A small ball is asked about; a large one rolls away beside it, 8 m off."""
    scene = a_world(0.6)
    scene.sphere("small", radius=0.05, position=(0.0, 0.0, 0.6))
    scene.sphere("large", radius=0.5, position=(8.0, 0.0, 0.5), velocity=(3.0, 0.0, 0.0))
    a_camera(scene, eye=(20.0, 0.0, 2.0), target=(30.0, 0.0, 1.0))
    world, motion = recorded(scene, tmp_path)
    (asked,) = Framing(world, motion, ["small"]).cameras()
    assert math.dist(asked.eye, (0.0, 0.0, 0.3)) < 3.0
    (both,) = Framing(world, motion, ["small", "large"]).cameras()
    assert math.dist(both.eye, (4.0, 0.0, 0.3)) > 5.0


def test_a_motion_is_seen_across_the_picture(tmp_path):
    """A ball that rolls along +X is looked at along Y, by PCA of its way; one along +Y along X."""
    for velocity, axis in (((2.0, 0.0, 0.0), 1), ((0.0, 2.0, 0.0), 0)):
        scene = a_world(0.5)
        scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.1), velocity=velocity)
        a_camera(scene, eye=tuple(20.0 * v + 1.0 for v in velocity), target=(0.0, 0.0, 0.0))
        world, motion = recorded(scene, tmp_path)
        (camera,) = Framing(world, motion).cameras()
        way = np.subtract(camera.target, camera.eye)
        assert abs(way[axis]) > 2.0 * abs(way[1 - axis]), camera


def test_a_second_camera_stays_on_its_side(tmp_path):
    """One from the top that is too far off comes nearer, and looks down still."""
    scene = a_world(0.5)
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.1), velocity=(1.0, 0.0, 0.0))
    a_camera(scene, eye=(0.3, -1.5, 0.4), target=(0.3, 0.0, 0.1))
    scene.camera("top", eye=(5.0, -0.5, 40.0), target=(5.0, 0.0, 0.0))
    world, motion = recorded(scene, tmp_path)
    first, top = Framing(world, motion).cameras()
    assert first == world.cameras[0]
    way = np.subtract(top.target, top.eye)
    assert -way[2] / np.linalg.norm(way) > 0.99
    assert math.dist(top.eye, top.target) < 5.0


def test_what_lies_still_in_the_picture_is_not_lost_for_what_moves(tmp_path):
    """A marble that is too small to be told, and a block beside its way: both are bodies that may be asked about."""
    scene = a_world(1.0)
    scene.sphere("marble", radius=0.01, position=(-0.1, 0.0, 0.01), velocity=(0.2, 0.0, 0.0))
    scene.box("block", size=(0.1, 0.1, 0.1), position=(0.0, 1.2, 0.05))
    a_camera(scene, eye=(0.0, -3.0, 1.0), target=(0.0, 0.6, 0.0))
    world, motion = recorded(scene, tmp_path)
    camera, *_ = Framing(world, motion).cameras()
    assert camera != world.cameras[0]  # which showed a marble of 5 pixels
    right, ahead = line_of_sight(camera.eye, camera.target, camera.up)
    way = np.subtract((0.0, 1.2, 0.05), camera.eye)
    assert way @ ahead > 0.0
    assert abs(way @ right) < math.tan(math.radians(camera.fov / 2)) * (way @ ahead)


def test_a_world_in_which_nothing_can_move_is_framed_on_what_stands(tmp_path):
    scene = a_world(0.2)
    scene.box("pane", size=(0.1, 2.0, 2.0), position=(3.0, 0.0, 1.0), static=True)
    a_camera(scene, eye=(0.0, -6.0, 2.0), target=(0.0, -9.0, 1.0))
    world, motion = recorded(scene, tmp_path)
    (camera,) = Framing(world, motion).cameras()
    assert math.dist(camera.target, (3.0, 0.0, 1.0)) < 1.0


def test_a_world_of_ground_alone_keeps_its_camera(tmp_path):
    scene = a_world(0.2)
    a_camera(scene)
    world, motion = recorded(scene, tmp_path)
    assert Framing(world, motion).cameras() == world.cameras


def test_more_cameras_than_there_are_sides_are_framed(tmp_path):
    """Each that shows nothing gets a side of its own, until none is left."""
    scene = a_world()
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 0.5), velocity=(1.0, 0.0, 2.0))
    for k in range(24):
        scene.camera(f"view_{k}", eye=(0.0, -3.0, 1.0), target=(0.0, -6.0, 1.0), width=WIDTH, height=HEIGHT)
    world = describe(scene.save(tmp_path / "stage.usda"))
    Simulation(tmp_path / "stage.usda", device="cpu").run(tmp_path / "r.rrd")
    framed = Framing(world, Motion.of(read(tmp_path / "r.rrd"))).cameras()
    assert len(framed) == 24
    assert len({(camera.eye, camera.target) for camera in framed}) > 4
