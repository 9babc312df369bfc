"""What is drawn over a picture that has no body: hinges, pushes that nothing seen gives, where specks go, and text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from wsim.geometry.rotations import line_of_sight, rotate
from wsim.scene.following import camera_at
from wsim.scene.labels import object_of, wholes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.scene.world import Camera, Joint, World

Array = np.ndarray
PIN, PUSH, INK, PAPER, SPECK = (250, 250, 250), (235, 105, 20), (20, 20, 20), (255, 255, 255), (200, 20, 90)
SMALL, RING = 8.0 / 640.0, 0.014  # of the picture's width: what is smaller has a ring of this radius round it
PIN_RADIUS, LONGEST, LEAST = 0.007, 0.09, 0.02  # of the picture's width: a hinge's ring, the arrow of the largest push
FAINT = 0.02  # of the largest push of a run: what is less is not drawn
TEXT = 0.026  # of the picture's width, the height of its letters


class Marks:
    """Draws marks for one run.

    Args:
        world: What the stage states.
        push: (F, B, 3) forces that control gives the bodies [N]; None: there are none.
        things: Corners of what the run is about, (F, n, 3) [m] each: where one is a speck, a ring is round it, and a
            camera that stands has the way that it came.
    """

    def __init__(self, world: World, push: Array | None, things: Sequence[Array] = ()) -> None:
        self.world, self._things = world, things
        self._push = push
        self._largest = float(np.linalg.norm(push, axis=2).max(initial=0.0)) if push is not None else 0.0
        self._rows = {body.prim: k for k, body in enumerate(world.bodies)}
        self._whole = wholes(world)
        self._hinges = [joint for joint in world.joints if joint.kind == "revolute" and self._is_shown(joint)]

    def _is_shown(self, joint: Joint) -> bool:
        """Whether a hinge is between things: those of one, as a vehicle's wheels and a robot's links, are its own."""
        known = joint.child in self._rows and joint.child_anchor is not None
        ends = [self._whole.get(object_of(prim)) for prim in (joint.parent, joint.child) if prim is not None]
        return known and len(set(ends)) == len(ends)

    def draw(self, rgb: Array, camera: Camera, frame: int, body_q: Array) -> Array:
        """A picture with the marks of a frame.

        Args:
            rgb: (H, W, 3) uint8.
            camera: That took it, as the world starts.
            frame: Its number.
            body_q: (B, 7) poses then.
        """
        follows = camera.follows is not None
        if camera.follows is not None:
            camera = camera_at(camera, self.world, body_q[self._rows[camera.follows]])
        pins = [_held_at(joint, body_q[self._rows[joint.child]]) for joint in self._hinges]
        arrows = self._arrows(camera, frame, body_q)
        specks = [points for points in self._things if _is_speck(camera, points[frame])]
        if not pins and not arrows and not specks:
            return rgb
        picture = Image.fromarray(rgb)
        brush = ImageDraw.Draw(picture)
        for points in specks:
            way = points[frame if follows else 0 : frame + 1].mean(axis=1)
            _ringed(brush, [_projected(camera, place) for place in way], camera.width)
        for place in pins:
            _pin(brush, _projected(camera, place), camera.width)
        for tail, tip in arrows:
            _arrow(brush, _projected(camera, tail), _projected(camera, tip), camera.width)
        return np.asarray(picture)

    def _arrows(self, camera: Camera, frame: int, body_q: Array) -> list[tuple[Array, Array]]:
        """Tails and tips [m] of the pushes of a frame: what pushes comes from outside, to the body's middle."""
        if self._push is None or self._largest <= 0.0 or frame >= len(self._push):
            return []
        found = []
        for k, push in enumerate(self._push[frame]):
            size = float(np.linalg.norm(push))
            if size > FAINT * self._largest:
                away = float(np.linalg.norm(body_q[k, :3] - np.array(camera.eye)))
                width = 2.0 * away * math.tan(math.radians(camera.fov) / 2.0)
                length = width * max(LEAST, LONGEST * size / self._largest)
                middle = body_q[k, :3] + rotate(body_q[k, 3:], np.array(self.world.bodies[k].com))
                found.append((middle - push / size * length, middle))
        return found


def caption(rgb: Array, time: float, text: str) -> Array:
    """A picture with its time [s] and a line of text below."""
    picture = Image.fromarray(rgb)
    brush = ImageDraw.Draw(picture)
    height = max(9, round(TEXT * picture.width))
    font = ImageFont.load_default(size=height)
    line = f"{time:.2f} s  {text}"
    while len(line) > 8 and brush.textlength(line, font=font) > picture.width - height:
        line = line[:-2].rstrip(" .") + "…"
    brush.rectangle((0, picture.height - round(1.7 * height), picture.width, picture.height), fill=INK)
    brush.text((height // 2, picture.height - round(1.5 * height)), line, fill=PAPER, font=font)
    return np.asarray(picture)


def _held_at(joint: Joint, pose: Array) -> Array:
    return np.asarray(pose[:3] + rotate(pose[3:], np.array(joint.child_anchor)))


def _projected(camera: Camera, point: Array) -> tuple[float, float] | None:
    """Where a point is in a picture [px]; None behind the camera."""
    right, ahead = line_of_sight(camera.eye, camera.target, camera.up)
    local = point - np.array(camera.eye)
    depth = float(local @ ahead)
    if depth <= 1e-6:
        return None
    focal = 0.5 * camera.width / math.tan(math.radians(camera.fov) / 2.0)
    x, y = float(local @ right), float(local @ np.cross(ahead, right))
    return 0.5 * camera.width + focal * x / depth, 0.5 * camera.height + focal * y / depth


def _is_speck(camera: Camera, points: Array) -> bool:
    """Whether points (n, 3) [m] are in the picture, and so near to each other that they are hardly to be told."""
    found = [_projected(camera, point) for point in points]
    seen = np.array([each for each in found if each is not None])
    if len(seen) < len(found):
        return False
    inside = ((seen >= 0.0) & (seen <= (camera.width, camera.height))).all()
    return bool(inside and np.ptp(seen, axis=0).max() < SMALL * camera.width)


def _ringed(brush: ImageDraw.ImageDraw, way: Sequence[tuple[float, float] | None], width: int) -> None:
    """A ring about where a way has come to, and the way before it."""
    points, at = [each for each in way if each is not None], way[-1]
    if at is None:
        return
    radius = max(3.0, RING * width)
    before = [each for each in points if math.dist(each, at) > radius]
    if len(before) > 1:
        brush.line(before, fill=SPECK, width=1)
    brush.circle(at, radius, outline=SPECK, width=max(1, round(radius / 5.0)))


def _pin(brush: ImageDraw.ImageDraw, at: tuple[float, float] | None, width: int) -> None:
    if at is not None:
        radius = max(2.0, PIN_RADIUS * width)
        brush.circle(at, radius, fill=PIN, outline=INK, width=max(1, round(radius / 2.5)))


def _arrow(
    brush: ImageDraw.ImageDraw, tail: tuple[float, float] | None, tip: tuple[float, float] | None, width: int
) -> None:
    if tail is None or tip is None:
        return
    way = np.subtract(tip, tail)
    length = float(np.linalg.norm(way))
    if length < 2.0:
        return
    along, thick = way / length, max(2, round(0.005 * width))
    across = np.array([-along[1], along[0]])
    neck = np.array(tip) - min(4.0 * thick, 0.6 * length) * along
    brush.line([tuple(tail), tuple(neck)], fill=PUSH, width=thick)
    brush.polygon([tuple(tip), tuple(neck + 2.0 * thick * across), tuple(neck - 2.0 * thick * across)], fill=PUSH)
