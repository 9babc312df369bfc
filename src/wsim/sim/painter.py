"""Draws a run's kept frames: on a CPU several at once, each thread with a model of its own."""

from __future__ import annotations

import queue
from collections import deque
from collections.abc import Collection, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.sim.cameras import CameraImage, CameraRenderer
    from wsim.sim.framing.motion import Motion
    from wsim.sim.kept_states import KeptStates
    from wsim.sim.marks import Marks
    from wsim.sim.model import Built

AHEAD = 3  # frames a painter, that are drawn before they are asked for

Images = dict[str, "CameraImage"]


class Painter:
    """One thread's model, state and renderer.

    Args:
        renderer: Of the model.
        built: The model, in which nobody else moves anything.
    """

    def __init__(self, renderer: CameraRenderer, built: Built) -> None:
        self.renderer, self._built = renderer, built
        self._state = built.model.state()

    def paint(self, kept: KeptStates, frame: int, cameras: Collection[str] | None) -> Images:
        """The pictures of a frame, by some cameras or all."""
        particles = kept.restore(frame, self._state)
        fluids = {prim: particles[part] for prim, part in self._built.fluids[0].items()}
        return self.renderer.render(self._state, fluids, cameras=None if cameras is None else list(cameras))


def painted(
    painters: list[Painter], kept: KeptStates, motion: Motion, whole: Collection[int], marks: Marks
) -> Iterator[tuple[int, Images]]:
    """Number and pictures of each frame, in order: by the first camera, and of some frames by all.

    Warp's CPU kernels work without the interpreter's lock.

    Args:
        painters: Each draws one frame at a time.
        kept: The frames.
        motion: Of the same.
        whole: Frames that all cameras take.
        marks: That are drawn over the pictures.
    """
    cameras = {camera.prim: camera for camera in painters[0].renderer.cameras}
    first = [painters[0].renderer.cameras[0].prim]
    free: queue.SimpleQueue[Painter] = queue.SimpleQueue()
    for painter in painters:
        free.put(painter)

    def paint(frame: int) -> Images:
        painter = free.get()
        try:
            images = painter.paint(kept, frame, None if frame in whole else first)
        finally:
            free.put(painter)
        return {
            prim: replace(image, rgb=marks.draw(image.rgb, cameras[prim], frame, motion.body_q[frame]))
            for prim, image in images.items()
        }

    with ThreadPoolExecutor(len(painters), thread_name_prefix="pictures") as pool:
        waiting: deque[tuple[int, Future[Images]]] = deque()
        try:
            for frame in range(len(kept)):
                waiting.append((frame, pool.submit(paint, frame)))
                if len(waiting) > AHEAD * len(painters):
                    done, images = waiting.popleft()
                    yield done, images.result()
            for done, images in waiting:
                yield done, images.result()
        finally:
            pool.shutdown(cancel_futures=True)
