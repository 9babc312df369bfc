"""What a world's cameras show together: all of the way at once, and each thing from near, whatever is between."""

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from tests.sim.framing.runs import ENOUGH, HEIGHT, WIDTH, a_camera, a_world, drawn, recorded
from wsim.geometry.rotations import line_of_sight
from wsim.scene.describe import describe
from wsim.scene.world import Camera
from wsim.sim.framing.frame import Framing
from wsim.sim.framing.motion import Motion
from wsim.sim.framing.rooms import Walls, before_walls
from wsim.sim.framing.subjects import subjects

LARGE = ENOUGH * 16  # of pictures of 640


def inside(camera, points):
    """Whether each of points (..., 3) is in the picture of a camera that stands."""
    right, ahead = line_of_sight(camera.eye, camera.target, camera.up)
    local = np.asarray(points) - np.array(camera.eye)
    depth, half = local @ ahead, math.tan(math.radians(camera.fov) / 2)
    across, above = np.abs(local @ right), np.abs(local @ np.cross(ahead, right))
    return (depth > 0.0) & (across <= half * depth) & (above <= half * camera.height / camera.width * depth)


def a_still_motion(world, times, places):
    """Bodies at places (F, B, 3), unturned."""
    q = np.concatenate([places, np.tile((0.0, 0.0, 0.0, 1.0), (*places.shape[:2], 1))], axis=2)
    return Motion(times, q, np.zeros(q.shape[:2]), np.zeros(q.shape[:2]))


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.8), (0.7, -0.7, 0.3)])
def test_a_thing_in_a_closed_room_is_seen_from_within(start):
    scene = a_world(0.6)
    for name, place, size in (
        ("north", (0.0, 1.05, 0.75), (2.2, 0.1, 1.5)), ("south", (0.0, -1.05, 0.75), (2.2, 0.1, 1.5)),
        ("east", (1.05, 0.0, 0.75), (0.1, 2.0, 1.5)), ("west", (-1.05, 0.0, 0.75), (0.1, 2.0, 1.5)),
        ("roof", (0.0, 0.0, 1.55), (2.2, 2.2, 0.1)),
    ):  # fmt: skip
        scene.box(name, size=size, position=place, static=True)
    scene.sphere("ball", radius=0.1, position=start, velocity=(-start[0], 0.5, 0.0))
    a_camera(scene)
    stills, found = drawn(scene)
    pixels = [still.get("/World/ball", 0) for still in stills["/World/main"]]
    assert min(pixels) >= ENOUGH, (pixels, found.views)


def test_two_far_from_each_other_are_both_seen_as_they_fall():
    """60 m apart, 20 cm large: in one picture of both each has 2 px of 640; so each has a camera of its own, too."""
    scene = a_world(1.2, frame_rate=20.0)
    scene.sphere("a", radius=0.1, position=(-30.0, 0.0, 1.5))
    held = scene.box("b", size=(0.2, 0.2, 0.2), position=(30.0, 5.0, 2.0), mass=1.0)
    scene.schedule("lets_go", scene.joint_fixed("hold", None, held), "release", times=(0.6,))
    stills, found = drawn(scene)
    assert [camera.prim for camera in found.views] == [f"/World/default_camera{end}" for end in ("", "_a", "_b")]
    for name in ("a", "b"):
        pixels = [still.get(f"/World/{name}", 0) for still in stills[f"/World/default_camera_{name}"]]
        assert min(pixels) >= LARGE, (name, pixels)


@settings(max_examples=8, deadline=None, phases=[Phase.generate])
@given(st.floats(12.0, 40.0), st.floats(0.0, 360.0), st.floats(40.0, 90.0), st.booleans())
def test_a_far_flier_has_a_camera_that_stands_and_sees_all_its_way_and_the_ground(speed, heading, rise, given_camera):
    """Its parabola by theory, of a world with cameras of its own or none; another camera goes along."""
    scene = a_world()
    scene.sphere("ball", radius=0.05, position=(0.0, 0.0, 0.05))
    if given_camera:
        a_camera(scene)
        scene.camera("top", eye=(0.0, -0.1, 5.0), target=(0.0, 0.0, 0.0), width=WIDTH, height=HEIGHT)
    world = describe(scene.stage)
    up, way = speed * math.sin(math.radians(rise)), math.radians(heading)
    level = speed * math.cos(math.radians(rise))
    t = np.linspace(0.0, 2.0 * up / 9.81, 60)
    place = np.stack([level * math.cos(way) * t, level * math.sin(way) * t, 0.05 + up * t - 4.905 * t**2], axis=1)
    framed = Framing(world, a_still_motion(world, t, place[:, None])).cameras()
    whole = next(camera for camera in framed if camera.follows is None)
    assert inside(whole, place).all()
    assert inside(whole, place * (1.0, 1.0, 0.0)).all()  # and the ground below it
    assert any(camera.follows == "/World/ball" for camera in framed)
    assert whole == framed[0] or up**2 / 19.62 < 8.0  # above most of its way there is nothing that goes by
    if given_camera:
        assert [camera.prim for camera in framed] == ["/World/main", "/World/top"]


def test_a_rope_is_seen_from_end_to_end(tmp_path):
    scene = a_world(1.5)
    bob = scene.sphere("bob", radius=0.06, position=(3.0, 0.0, 2.5), density=7800.0)
    scene.rope("rope", None, bob, anchor_a=(0.0, 0.0, 9.0), anchor_b=(3.0, 0.0, 2.5))
    world, motion = recorded(scene, tmp_path)
    first, *_ = Framing(world, motion, ["bob"]).cameras()
    ends = np.concatenate([motion.body_q[:, 0, :3], [(0.0, 0.0, 9.0)]])
    assert inside(first, ends).all()
    rope = next(each for each in subjects(world, motion, ["bob"]) if each.prim == "/World/rope")
    assert rope.main
    assert np.allclose(rope.points[:, 0], (0.0, 0.0, 9.0))
    assert np.allclose(np.linalg.norm(np.ptp(rope.points, axis=1), axis=1), math.hypot(3.0, 6.5), atol=0.02)


def test_two_that_go_opposite_ways_are_in_one_picture_to_the_end(tmp_path):
    scene = a_world(1.5)
    for name, side in (("left", -1.0), ("right", 1.0)):
        scene.sphere(name, radius=0.1, position=(0.3 * side, 0.0, 0.1), velocity=(8.0 * side, 0.0, 0.0))
    a_camera(scene)
    world, motion = recorded(scene, tmp_path)
    framed = Framing(world, motion).cameras()
    assert any(camera.follows is None and inside(camera, motion.body_q[:, :, :3]).all() for camera in framed)


def test_what_lies_behind_a_screen_and_nobody_asks_about_is_seen_too():
    scene = a_world(1.0, frame_rate=20.0)
    scene.box("screen", size=(0.1, 6.0, 2.0), position=(2.0, 0.0, 1.0), static=True)
    scene.box("screen2", size=(6.0, 0.1, 2.0), position=(5.0, -3.0, 1.0), static=True)
    scene.sphere("ball", radius=0.1, position=(-1.0, -4.0, 0.1), velocity=(1.0, 0.0, 0.0))
    scene.box("goal", size=(0.3, 0.3, 0.3), position=(6.0, -2.0, 0.15), mass=2.0)
    a_camera(scene)
    stills, found = drawn(scene)
    assert max(still.get("/World/goal", 0) for each in stills.values() for still in each) >= ENOUGH, found.views


def test_the_way_to_a_wall_ends_at_its_box():
    """A wall turned by 30 degrees about Z, its face 2 m off: along X it is 2 / cos(30) m to it; a pane is none."""

    def free_way(start, way, size=(0.2, 9.0, 3.0), opacity=1.0):
        scene = a_world()
        place = (2.1 * math.cos(math.radians(30.0)), 2.1 * math.sin(math.radians(30.0)), 0.0)
        scene.box("wall", size=size, position=place, rotation_deg=(0.0, 0.0, 30.0), static=True)
        world = describe(scene.stage)
        for static in world.statics:
            static.shapes = [shape.model_copy(update={"opacity": opacity}) for shape in static.shapes]
        return Walls.of(world).free_way(np.array(start), np.array(way))

    assert free_way((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == pytest.approx(2.0 / math.cos(math.radians(30.0)))
    assert free_way((0.0, 0.0, 0.0), (-1.0, 0.0, 0.0)) == math.inf
    assert free_way((0.0, 0.0, 2.0), (1.0, 0.0, 0.0)) == math.inf  # above it
    assert free_way((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), opacity=0.3) == math.inf
    assert free_way((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), size=(9.0, 9.0, 9.0)) == math.inf  # of one piece, round the point


def test_a_lens_before_a_wall_has_the_points_in_frame():
    scene = a_world()
    scene.box("wall", size=(6.0, 0.1, 3.0), position=(0.0, -1.05, 1.5), static=True)
    world = describe(scene.stage)
    points = np.array([(x, y, z) for x in (-0.6, 0.6) for y in (-0.1, 0.1) for z in (0.3, 0.7)])
    view = Camera(prim="/World/main", eye=(0.0, -3.0, 0.5), target=(0.0, 0.0, 0.5))
    (nearer,) = before_walls(view, points, Walls.of(world))
    assert -1.0 < nearer.eye[1] < -0.9
    assert inside(nearer, points).all()
    assert not inside(nearer.model_copy(update={"fov": view.fov}), points).all()
    assert list(before_walls(view.model_copy(update={"eye": (0.0, -0.8, 0.5)}), points, Walls.of(world))) == []
