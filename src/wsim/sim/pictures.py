"""Camera frames of a run: the first camera's video, the recording's images, stills and what they show."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.progress import Progress
from wsim.recording.video import VideoWriter
from wsim.sim.cameras import CameraRenderer
from wsim.sim.seen import ObjectPixels, still_name, write_png

if TYPE_CHECKING:
    from wsim.recording import RecordingWriter
    from wsim.sim.cameras import CameraImage
    from wsim.sim.simulation import Simulation

STILLS = 6


class Pictures:
    """Takes a frame's pictures with every camera.

    Args:
        simulation: Whose state is drawn.
        writer: Gets the pictures of the stage's cameras.
        video: Path of the first camera's MP4.
        frames_dir: Folder for a few PNGs of every camera, evenly over the run; None writes none.
        review: JSON file with the share of the picture that each object has in those, from the shape-index image: what
            is in frame, whether anyone looks at it or not; None writes none.
        frames: Number of the last frame.
        progress: Told about compilation.
    """

    def __init__(
        self,
        simulation: Simulation,
        writer: RecordingWriter,
        video: str | Path,
        frames_dir: str | Path | None,
        review: str | Path | None,
        frames: int,
        progress: Progress,
    ) -> None:
        self.simulation, self.writer = simulation, writer
        self.frames_dir = Path(frames_dir) if frames_dir else None
        self.review = Path(review) if review else None
        self.renderer = CameraRenderer(simulation.model, simulation.world, progress=progress)
        self.video = VideoWriter(video, fps=simulation.world.frame_rate)
        self.still_frames = {round(k * frames / (STILLS - 1)) for k in range(STILLS)}
        self.stills: list[Path] = []
        self.seen: list[dict[str, Any]] = []
        self.objects = ObjectPixels(self.renderer.shape_prims)
        self.recorded = {camera.prim for camera in simulation.world.cameras}

    def __enter__(self) -> Pictures:
        """Open the video."""
        self.video.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        """Finish the video, and write what the stills show; of a run that was stopped there is neither."""
        self.video.__exit__(*error)
        if self.review and error[0] is None:
            partial = self.review.with_name(self.review.name + ".partial")
            partial.write_text(json.dumps({"share_of_picture": self.seen}, indent=1) + "\n", encoding="utf-8")
            partial.replace(self.review)

    def take(self, frame: int) -> None:
        """Draw the present state: the first camera always, the others at the stills."""
        simulation = self.simulation
        still = frame in self.still_frames
        cameras = None if still else [self.renderer.cameras[0].prim]
        images = self.renderer.render(simulation.state, self._fluids(), cameras=cameras)
        for k, (camera, image) in enumerate(images.items()):
            if k == 0:
                self.video.write(image.rgb)
            if camera in self.recorded:
                self.writer.image(simulation.time, camera, image.rgb)
            shares = self._shares(image)
            self.writer.seen(simulation.time, camera, shares)
            if still:
                self._keep(camera, image, shares)

    def _fluids(self) -> dict[str, np.ndarray]:
        parts = self.simulation.built.fluids
        if not parts:
            return {}
        position = self.simulation.state.particle_q.numpy()
        return {prim: position[part] for prim, part in parts.items()}

    def _shares(self, image: CameraImage) -> dict[str, float]:
        """The share of a picture that each object takes up; 0 for one that is not to be seen."""
        return {prim: n / image.shape_index.size for prim, n in self.objects.count(image.shape_index).items()}

    def _keep(self, camera: str, image: CameraImage, shares: dict[str, float]) -> None:
        time = self.simulation.time
        shown = {prim: round(share, 5) for prim, share in shares.items() if share}
        self.seen.append({"camera": camera, "time": round(time, 4), "objects": shown})
        if self.frames_dir:
            path = self.frames_dir / still_name(camera, time)
            write_png(path, image.rgb)
            self.stills.append(path)
