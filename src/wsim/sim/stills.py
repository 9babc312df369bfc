"""Stills of a world: as it starts, or as a recording has it at some time. Nothing is simulated for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import newton
import numpy as np

from wsim.progress import Progress, silent
from wsim.scene.describe import describe
from wsim.sim import render_views
from wsim.sim.cameras import CameraRenderer
from wsim.sim.devices import pick_device
from wsim.sim.framing.frame import Framing
from wsim.sim.framing.hidden import Hidden
from wsim.sim.framing.moments import STILLS, chosen
from wsim.sim.framing.motion import Motion
from wsim.sim.marks import Marks
from wsim.sim.model import build_model
from wsim.sim.openings import seen_particles
from wsim.sim.seen import ObjectPixels

if TYPE_CHECKING:
    from wsim.recording import Recording
    from wsim.scene.world import Camera, World


@dataclass(frozen=True)
class Still:
    """One camera's picture of one moment.

    Attributes:
        camera: Who looks.
        time: Of the moment [s].
        rgb: (H, W, 3) uint8, sRGB.
        pixels: How many pixels each object has, by prim, those with none as well. Glass and water are looked through,
            and have none.
    """

    camera: Camera
    time: float
    rgb: np.ndarray
    pixels: dict[str, int]


class Stills:
    """Draws a stage's cameras.

    Args:
        stage: USD file, checked.
        device: "cpu", "cuda:0", or "auto".
        cameras: Those to draw, the stage's or others; all of the stage's by default, and where it has none the
            default view.
        progress: Told about compilation.
    """

    def __init__(
        self,
        stage: str | Path,
        device: str = "auto",
        cameras: Sequence[Camera] | None = None,
        progress: Progress = silent,
    ) -> None:
        world = describe(Path(stage))
        self.world = world if cameras is None else world.model_copy(update={"cameras": list(cameras)})
        self._built = build_model(Path(stage), self.world, pick_device(device, world))
        model = self._built.model
        self._state = model.state()
        newton.eval_fk(model, self._state.joint_q, self._state.joint_qd, self._state)
        self._renderer = CameraRenderer(model, self.world, progress=progress)
        self._objects = ObjectPixels(self._renderer.shape_prims)

    def draw_start(self) -> list[Still]:
        """The world as the stage states it, one still a camera."""
        particles = seen_particles(self._built.model, self._state) if self._built.fluids[0] else np.zeros((0, 3))
        return self._draw(0.0, {prim: particles[part] for prim, part in self._built.fluids[0].items()})

    def draw_moments(self, recording: Recording, named: Sequence[str] = (), most: int = STILLS) -> list[Still]:
        """What happens in a recording of the world, by its cameras, framed on it as a run's are; one moment at a time.

        Args:
            recording: Also of a run that broke: its finite frames are drawn.
            named: Names of the objects that it is about; none: what moves.
            most: Moments.

        Raises:
            ValueError: The recording is of another world.
        """
        motion = Motion.of(recording)
        framing = Framing(self.world, motion, named, Hidden(self._renderer, self._built))
        self._renderer.look_through(framing.cameras() or self._renderer.cameras)
        times = motion.time[chosen(framing.moments, len(motion.time), most)]
        marks = Marks(self.world, motion.push, framing.things)
        frames = [recording.frame_index(float(time)) for time in times]
        return [
            replace(still, rgb=marks.draw(still.rgb, still.camera, frame, motion.body_q[frame]))
            for frame, time in zip(frames, times, strict=True)
            for still in self.draw(recording, float(time))
        ]

    def draw(self, recording: Recording, time: float) -> list[Still]:
        """The world as a recording of it has it at its frame nearest to a time [s], one still a camera.

        Raises:
            ValueError: The recording has no frames, or is of another world.
        """
        prims = [body.prim for body in self.world.bodies]
        recorded = [body.prim for body in recording.world.bodies]
        if prims != recorded:
            raise ValueError(f"the stage has the bodies {prims}, the recording {recorded}")
        frame = frame_to_draw(recording, time)
        if prims:
            q = self._state.body_q.numpy()
            q[self._built.bodies] = recording.body_q[frame]
            self._state.body_q.assign(q)
        at = float(recording.time[frame])
        fluids = {
            prim: track.position[int(np.argmin(np.abs(track.time - at)))]
            for prim, track in recording.fluids.items()
            if len(track.time)
        }
        return self._draw(at, fluids)

    def _draw(self, time: float, fluids: dict[str, np.ndarray]) -> list[Still]:
        images = self._renderer.render(self._state, fluids)
        return [
            Still(camera, time, image.rgb, self._objects.count(image.shape_index))
            for camera, image in zip(self._renderer.cameras, images.values(), strict=True)
        ]


def frame_to_draw(recording: Recording, time: float) -> int:
    """The frame nearest to a time [s]; in a world with fluid, of those at which its particles were recorded."""
    times = np.asarray(recording.time)
    for track in recording.fluids.values():
        if len(track.time):
            times = track.time
    nearest = float(times[int(np.argmin(np.abs(times - time)))]) if len(times) else time
    return recording.frame_index(nearest)


def cameras_of(world: World) -> list[Camera]:
    """The cameras that a world is drawn with: its own, or the default view."""
    return world.cameras or [render_views.default_camera(world)]
