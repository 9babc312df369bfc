"""Camera frames of a run: the first camera's video, the recording's images, stills and what they show."""

from __future__ import annotations

import json
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.phases import Phases
from wsim.progress import Progress
from wsim.recording.video import VideoWriter
from wsim.sim.cameras import CameraRenderer
from wsim.sim.seen import ObjectPixels, still_name, write_png

if TYPE_CHECKING:
    import numpy as np
    from newton import State

    from wsim.recording import RecordingWriter
    from wsim.scene.world import World
    from wsim.sim.cameras import CameraImage
    from wsim.sim.model import Built

STILLS = 6
AHEAD = 2  # frames that the simulation may be ahead of the pictures: as many states are kept


class Pictures:
    """Takes a frame's pictures with every camera, in a thread of its own, while the simulation goes on.

    Warp's CPU kernels, x264 and zlib work without the interpreter's lock. The simulation waits for pictures that are
    more than `AHEAD` frames behind, and gives them to the recording then: its rows stand in one order, however quick
    each thread is. What breaks in the thread is raised where the picture is waited for.

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
        phases: Gets the time of encoding that the simulation waits for.
        beside: Whether frames are drawn in the thread; else only encoded and written there. A device's graph is caught
            from all that is launched meanwhile: where steps are one, nothing may be drawn beside them.
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
        beside: bool = False,
    ) -> None:
        self.built, self.writer, self.phases, self.beside = built, writer, phases, beside
        self.frames_dir = Path(frames_dir) if frames_dir else None
        self.review = Path(review) if review else None
        self.renderer = CameraRenderer(built.model, world, progress=progress)
        self.video = VideoWriter(video, fps=world.frame_rate)
        self.still_frames = {round(k * frames / (STILLS - 1)) for k in range(STILLS)}
        self.stills: list[Path] = []
        self.seen: list[dict[str, Any]] = []
        self.objects = ObjectPixels(self.renderer.shape_prims)
        self.recorded = {camera.prim for camera in world.cameras}
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="pictures")
        self._waiting: deque[tuple[float, Future[dict[str, CameraImage]]]] = deque()

    def __enter__(self) -> Pictures:
        """Open the video."""
        self.video.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        """Finish the video, and write what the stills show; of a run that was stopped there is neither."""
        try:
            if error[0] is None:
                self.finish()
        except BaseException as broken:
            error = (type(broken), broken, broken.__traceback__)
            raise
        finally:
            self._thread.shutdown(cancel_futures=True)
            with self.phases.phase("encode"):
                self.video.__exit__(*error)
        if self.review and error[0] is None:
            partial = self.review.with_name(self.review.name + ".partial")
            partial.write_text(json.dumps({"share_of_picture": self.seen}, indent=1) + "\n", encoding="utf-8")
            partial.replace(self.review)

    def take(self, frame: int, time: float, state: State) -> None:
        """Have a frame drawn: the first camera always, the others at the stills.

        Args:
            frame: Its number.
            time: Simulated [s].
            state: Of that time; it is copied.
        """
        if self.beside:
            kept = self.built.model.state()
            kept.assign(state)
            done = self._thread.submit(lambda: self._keep(frame, time, self._render(frame, kept)))
        else:
            done = self._thread.submit(self._keep, frame, time, self._render(frame, state))
        self._waiting.append((time, done))
        while len(self._waiting) > AHEAD:
            self._record()

    def finish(self) -> None:
        """Wait for the pictures that are not recorded yet."""
        while self._waiting:
            self._record()

    def _record(self) -> None:
        """Wait for the oldest frame, and record what its pictures are and show."""
        time, done = self._waiting.popleft()
        for camera, image in done.result().items():
            if camera in self.recorded:
                with self.phases.phase("record"):
                    self.writer.image(time, camera, image.rgb)
            self.writer.seen(time, camera, self._shares(image))

    def _render(self, frame: int, state: State) -> dict[str, CameraImage]:
        cameras = None if frame in self.still_frames else [self.renderer.cameras[0].prim]
        return self.renderer.render(state, self._fluids(state), cameras=cameras)

    def _keep(self, frame: int, time: float, images: dict[str, CameraImage]) -> dict[str, CameraImage]:
        """In the thread: write what does not go to the recording."""
        self.video.write(next(iter(images.values())).rgb)
        if frame in self.still_frames:
            for camera, image in images.items():
                self._keep_still(camera, time, image)
        return images

    def _fluids(self, state: State) -> dict[str, np.ndarray]:
        if not self.built.fluids[0]:
            return {}
        position = state.particle_q.numpy()
        return {prim: position[part] for prim, part in self.built.fluids[0].items()}

    def _shares(self, image: CameraImage) -> dict[str, float]:
        """The share of a picture that each object takes up; 0 for one that is not to be seen."""
        return {prim: n / image.shape_index.size for prim, n in self.objects.count(image.shape_index).items()}

    def _keep_still(self, camera: str, time: float, image: CameraImage) -> None:
        shown = {prim: round(share, 5) for prim, share in self._shares(image).items() if share}
        self.seen.append({"camera": camera, "time": round(time, 4), "objects": shown})
        if self.frames_dir:
            path = self.frames_dir / still_name(camera, time)
            write_png(path, image.rgb)
            self.stills.append(path)
