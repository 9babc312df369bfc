"""Camera frames of a run: the first camera's video, the recording's images, stills and what they show.

They are drawn when the simulation has ended: then it is known what happened, and where a camera shows it.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.phases import Phases
from wsim.progress import Progress
from wsim.recording.video import VideoWriter
from wsim.sim.cameras import CameraRenderer
from wsim.sim.framing.frame import Framing
from wsim.sim.framing.hidden import Hidden
from wsim.sim.framing.moments import STILLS, chosen
from wsim.sim.kept_states import KeptStates
from wsim.sim.marks import Marks, caption
from wsim.sim.seen import ObjectPixels, still_name, write_png

if TYPE_CHECKING:
    from newton import State

    from wsim.recording import RecordingWriter
    from wsim.scene.world import World
    from wsim.sim.cameras import CameraImage
    from wsim.sim.framing.motion import Motion
    from wsim.sim.model import Built

AHEAD = 3  # pictures that wait to be encoded


class Pictures:
    """Keeps a run's frames, and draws them when it has ended.

    A thread encodes and writes pictures while the next are drawn. What breaks in it is raised here.

    Args:
        world: What the stage states.
        built: Its model.
        writer: Gets the pictures of the world's cameras.
        video: Path of the first camera's MP4.
        frames_dir: Folder for a few PNGs of every camera, of the moments when something happens; None writes none.
        review: JSON file with those moments, and the share of the picture that each object has in those stills, from
            the shape-index image: what is in frame, whether anyone looks at it or not; None writes none.
        named: Names of the objects that the run is about; none: what moves.
        words: A line below the video's pictures, after their time; None: there is none.
        progress: Told about compilation, and how many frames are drawn.
        phases: Gets the time of drawing and encoding.
    """

    def __init__(
        self,
        world: World,
        built: Built,
        writer: RecordingWriter,
        video: str | Path,
        frames_dir: str | Path | None,
        review: str | Path | None,
        named: Sequence[str],
        words: str | None,
        progress: Progress,
        phases: Phases,
    ) -> None:
        self.world, self.built, self.writer = world, built, writer
        self.words, self.named, self.progress, self.phases = words, named, progress, phases
        self.frames_dir = Path(frames_dir) if frames_dir else None
        self.review = Path(review) if review else None
        self.video = VideoWriter(video, fps=world.frame_rate)
        self.renderer = CameraRenderer(built.model, world, progress=progress)
        self.objects = ObjectPixels(self.renderer.shape_prims)
        self.stills: list[Path] = []
        self.seen: list[dict[str, Any]] = []
        self._kept = KeptStates()
        self._exits = ExitStack()

    def __enter__(self) -> Pictures:
        """Open the file of what is kept."""
        self._exits.enter_context(self._kept)
        return self

    def __exit__(self, *error: Any) -> None:
        """Of a run that was stopped there are no pictures."""
        self._exits.__exit__(*error)

    def keep(self, time: float, state: State) -> None:
        """Have a frame drawn later.

        Args:
            time: Simulated [s].
            state: Of that time; it is copied.
        """
        self._kept.add(time, state)

    def draw(self, motion: Motion) -> None:
        """Frame the cameras on a run's motion, and draw all that was kept: the first every frame, the others stills."""
        with self.phases.phase("frame cameras"):
            framing = Framing(self.world, motion, self.named, Hidden(self.renderer, self.built))
            self.renderer.look_through(framing.cameras() or self.renderer.cameras)
            self.writer.views(self.renderer.cameras, motion.time, motion.body_q)
        stills = set(chosen(framing.moments, len(self._kept), STILLS))
        with self.phases.phase("draw"), self.video, ThreadPoolExecutor(1, thread_name_prefix="pictures") as thread:
            try:
                self._draw_all(stills, motion, thread)
            except BaseException:
                thread.shutdown(cancel_futures=True)
                raise
        if self.review:
            told = [
                {"time": round(float(motion.time[m.frame]), 4), "what": m.what, "weight": round(m.weight, 3)}
                for m in framing.moments
            ]
            self._write_review({"share_of_picture": self.seen, "moments": told})

    def _draw_all(self, stills: set[int], motion: Motion, thread: ThreadPoolExecutor) -> None:
        waiting: deque[tuple[float, dict[str, CameraImage], Future[None]]] = deque()
        state, first = self.built.model.state(), self.renderer.cameras[0].prim
        marks = Marks(self.world, motion.push)
        cameras = {camera.prim: camera for camera in self.renderer.cameras}
        for frame, time in enumerate(self._kept.times):
            particles = self._kept.restore(frame, state)
            fluids = {prim: particles[part] for prim, part in self.built.fluids[0].items()}
            images = self.renderer.render(state, fluids, cameras=None if frame in stills else [first])
            for prim, image in images.items():
                rgb = marks.draw(image.rgb, cameras[prim], frame, motion.body_q[frame])
                images[prim] = replace(image, rgb=rgb)
            waiting.append((time, images, thread.submit(self._keep, time, images, frame in stills)))
            while len(waiting) > AHEAD:
                self._record(*waiting.popleft())
            self.progress("drawing", frame + 1, len(self._kept))
        while waiting:
            self._record(*waiting.popleft())

    def _record(self, time: float, images: dict[str, CameraImage], kept: Future[None]) -> None:
        """Wait until a frame's pictures are kept, and record what they are and show."""
        kept.result()
        for camera, image in images.items():
            self.writer.image(time, camera, image.rgb)
            self.writer.seen(time, camera, self._shares(image))

    def _keep(self, time: float, images: dict[str, CameraImage], still: bool) -> None:
        """In the thread: write what does not go to the recording."""
        film = next(iter(images.values())).rgb
        self.video.write(film if self.words is None else caption(film, time, self.words))
        for camera, image in images.items() if still else ():
            shown = {prim: round(share, 5) for prim, share in self._shares(image).items() if share}
            self.seen.append({"camera": camera, "time": round(time, 4), "objects": shown})
            if self.frames_dir:
                path = self.frames_dir / still_name(camera, time)
                write_png(path, image.rgb)
                self.stills.append(path)

    def _shares(self, image: CameraImage) -> dict[str, float]:
        """The share of a picture that each object takes up; 0 for one that is not to be seen."""
        return {prim: n / image.shape_index.size for prim, n in self.objects.count(image.shape_index).items()}

    def _write_review(self, told: dict[str, Any]) -> None:
        assert self.review is not None
        partial = self.review.with_name(self.review.name + ".partial")
        partial.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        partial.replace(self.review)
