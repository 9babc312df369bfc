"""Cameras by a view: where they stand, what they look at, and that they see it."""

import math

import pytest

from tests.plan.layout.scenes import GROUND, at, box, rel, solve, tank, water
from wsim.plan.layout import Box, LayoutError
from wsim.plan.layout.bodies import around
from wsim.plan.schema import CameraPlan, Plan, Pose
from wsim.plan.views import ASPECT, FIELD_OF_VIEW, bounds, inside

SCENE = [box("a", pose=Pose(position=(1.0, 2.0, 0.5)), size=(2.0, 1.0, 1.0)),
         box("b", pose=Pose(position=(3.0, 2.0, 0.1)), size=(0.2, 0.2, 0.2))]  # fmt: skip
WALLS = [box(f"wall_{k}", size=size, role="background", state="static", pose=Pose(position=(x, y, 1.25)))
         for k, (x, y, size) in enumerate([(3.0, 0.0, (0.1, 6.0, 2.5)), (-3.0, 0.0, (0.1, 6.0, 2.5)),
                                           (0.0, 3.0, (6.1, 0.1, 2.5)), (0.0, -3.0, (6.1, 0.1, 2.5))])]  # fmt: skip
SIDES = {"side_plus_x": (1, 0), "side_minus_x": (-1, 0), "side_plus_y": (0, 1), "side_minus_y": (0, -1)}


def see(view: str, *objects, of: str | None = None) -> tuple[Plan, CameraPlan]:
    placed = solve(*objects, cameras=[CameraPlan(name="cam", view=view, of=of)])
    return placed, placed.cameras[0]


def in_picture(camera: CameraPlan, box: Box) -> bool:
    """Whether every corner of a box is in the frame of the camera."""
    forward = [b - a for a, b in zip(camera.eye, camera.target, strict=True)]
    length = math.hypot(*forward)
    f = [v / length for v in forward]
    right = [f[1], -f[0], 0.0]
    norm = math.hypot(*right)
    right = [v / norm for v in right]
    up = [right[1] * f[2] - right[2] * f[1], right[2] * f[0] - right[0] * f[2], right[0] * f[1] - right[1] * f[0]]
    half = math.tan(math.radians(FIELD_OF_VIEW / 2))
    for k in range(8):
        p = [(box.high if k >> axis & 1 else box.low)[axis] - camera.eye[axis] for axis in range(3)]
        depth, x, y = (sum(a * b for a, b in zip(p, axis, strict=True)) for axis in (f, right, up))
        if depth <= 0 or abs(x) > half * depth or abs(y) > half * ASPECT * depth:
            return False
    return True


@pytest.mark.parametrize("view", [*SIDES, "top_down"])
@pytest.mark.parametrize("of", [None, "b"])
def test_views(view, of):
    placed, camera = see(view, *SCENE, of=of)
    shown = Box(*bounds(placed)) if of is None else around(placed.object(of))
    assert camera.view == view and in_picture(camera, shown)
    if view == "top_down":
        assert camera.eye[2] > shown.high[2] and camera.eye[0] == pytest.approx(shown.center[0], abs=1e-3)
    else:
        x, y = SIDES[view]
        assert (camera.eye[0] - camera.target[0]) * x + (camera.eye[1] - camera.target[1]) * y > 0
        assert camera.target == pytest.approx(shown.center, abs=1e-3)


@pytest.mark.parametrize("view", [f"{view}_room" for view in (*SIDES, "top_down")])
def test_room_views(view):
    things = [GROUND, *WALLS, box("desk", size=(1.0, 0.5, 0.7)), box("b", rel("FRONT-OF", "desk"))]
    placed, camera = see(view, *things)
    room = inside(placed)
    assert room.low[:2] == pytest.approx((-2.95, -2.95)) and room.high[:2] == pytest.approx((2.95, 2.95))
    assert all(room.low[k] < camera.eye[k] < room.high[k] for k in range(3))
    assert in_picture(camera, around(placed.object("desk")))


def test_a_tank_is_the_room_of_what_is_in_it():
    placed, camera = see(
        "side_minus_y_room", tank(), water(), box("b", rel("FLOATS-AT-SURFACE", "water"), size=(0.1,) * 3)
    )
    assert inside(placed).size == pytest.approx((1.0, 0.6, 0.5))
    assert -0.3 < camera.eye[1] < at(placed, "b")[1] and camera.eye[2] < 0.52


def test_no_room_is_the_scene():
    placed, camera = see("side_plus_x_room", *SCENE)
    low, high = bounds(placed)
    assert inside(placed) is None and all(low[k] <= camera.eye[k] <= high[k] for k in range(3))


def test_what_has_no_box_is_refused():
    with pytest.raises(LayoutError, match="camera cam: ground has no box of its own; look at a body"):
        see("top_down", GROUND, *SCENE, of="ground")
    assert see("top_down", tank(), water(), of="water")[1].target[:2] == (0, 0)
