"""Camera frames of a run: the first camera's video, the recording's images, stills and what they show."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.phases import Phases
from wsim.progress import Progress
from wsim.recording.video import VideoWriter
from wsim.sim.cameras import CameraRenderer
from wsim.sim.seen import ObjectPixels, still_name, write_png

if TYPE_CHECKING:
    from newton import State

    from wsim.recording import RecordingWriter
    from wsim.scene.world import World
    from wsim.sim.cameras import CameraImage
    from wsim.sim.model import Built

STILLS = 6


class Pictures:
    """Takes a frame's pictures with every camera.

    Args:
        world: What the stage states.
        built: Its model.
        writer: Gets the pictures of the stage's cameras.
        video: Path of the first camera's MP4.
        frames_dir: Folder for a few PNGs of every camera, evenly over the run; None writes none.
        review: JSON file with the share of the picture that each object has in those, from the shape-index image: what
            is in frame, whether anyone looks at it or not; None writes none.
        frames: Number of the last frame.
        progress: Told about compilation.
        phases: Gets the time of encoding.
    """

    def __init__(
        self,
        world: World,
        built: Built,
        writer: RecordingWriter,
        video: str | Path,
        frames_dir: str | Path | None,
        review: str | Path | None,
        frames: int,
        progress: Progress,
        phases: Phases,
    ) -> None:
        self.built, self.writer, self.phases = built, writer, phases
        self.frames_dir = Path(frames_dir) if frames_dir else None
        self.review = Path(review) if review else None
        self.renderer = CameraRenderer(built.model, world, progress=progress)
        self.video = VideoWriter(video, fps=world.frame_rate)
        self.still_frames = {round(k * frames / (STILLS - 1)) for k in range(STILLS)}
        self.stills: list[Path] = []
        self.seen: list[dict[str, Any]] = []
        self.objects = ObjectPixels(self.renderer.shape_prims)
        self.recorded = {camera.prim for camera in world.cameras}

    def __enter__(self) -> Pictures:
        """Open the video."""
        self.video.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        """Finish the video, and write what the stills show; of a run that was stopped there is neither."""
        with self.phases.phase("encode"):
            self.video.__exit__(*error)
        if self.review and error[0] is None:
            partial = self.review.with_name(self.review.name + ".partial")
            partial.write_text(json.dumps({"share_of_picture": self.seen}, indent=1) + "\n", encoding="utf-8")
            partial.replace(self.review)

    def take(self, frame: int, time: float, state: State) -> None:
        """Draw a frame: the first camera always, the others at the stills.

        Args:
            frame: Its number.
            time: Simulated [s].
            state: Of that time.
        """
        still = frame in self.still_frames
        cameras = None if still else [self.renderer.cameras[0].prim]
        images = self.renderer.render(state, self._fluids(state), cameras=cameras)
        for k, (camera, image) in enumerate(images.items()):
            if k == 0:
                with self.phases.phase("encode"):
                    self.video.write(image.rgb)
            if camera in self.recorded:
                with self.phases.phase("record"):
                    self.writer.image(time, camera, image.rgb)
            shares = self._shares(image)
            self.writer.seen(time, camera, shares)
            if still:
                self._keep(camera, time, image, shares)

    def _fluids(self, state: State) -> dict[str, np.ndarray]:
        if not self.built.fluids[0]:
            return {}
        position = state.particle_q.numpy()
        return {prim: position[part] for prim, part in self.built.fluids[0].items()}

    def _shares(self, image: CameraImage) -> dict[str, float]:
        """The share of a picture that each object takes up; 0 for one that is not to be seen."""
        return {prim: n / image.shape_index.size for prim, n in self.objects.count(image.shape_index).items()}

    def _keep(self, camera: str, time: float, image: CameraImage, shares: dict[str, float]) -> None:
        shown = {prim: round(share, 5) for prim, share in shares.items() if share}
        self.seen.append({"camera": camera, "time": round(time, 4), "objects": shown})
        if self.frames_dir:
            path = self.frames_dir / still_name(camera, time)
            write_png(path, image.rgb)
            self.stills.append(path)
