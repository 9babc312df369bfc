"""Camera frames of a run: the first camera's video, the recording's images, stills and what they show.

They are drawn when the simulation has ended: then it is known what happened, and where a camera shows it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
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
from wsim.sim.painter import Painter, painted
from wsim.sim.seen import ObjectPixels, still_name, write_png
from wsim.solvers.launch import thread_count

if TYPE_CHECKING:
    from newton import State

    from wsim.recording import RecordingWriter
    from wsim.scene.world import World
    from wsim.sim.cameras import CameraImage
    from wsim.sim.framing.motion import Motion
    from wsim.sim.model import Built

FEW = 24  # frames: for fewer, another model is not made
MOST = 4  # models that draw at once


@dataclass(frozen=True)
class Film:
    """What is made of a run's pictures.

    Attributes:
        video: Path of the first camera's MP4.
        frames_dir: Folder for a few PNGs of every camera, of the moments when something happens; None writes none.
        review: JSON file with those moments, and the share of the picture that each object has in those stills, from
            the shape-index image: what is in frame, whether anyone looks at it or not; None writes none.
        named: Names of the objects that the run is about; none: what moves.
        words: A line below the video's pictures, after their time; None: there is none.
    """

    video: Path
    frames_dir: str | Path | None = None
    review: str | Path | None = None
    named: Sequence[str] = ()
    words: str | None = None


class Pictures:
    """Keeps a run's frames, and draws them when it has ended.

    Threads draw while pictures that are done are encoded and written. What breaks in one is raised here.

    Args:
        world: What the stage states.
        built: Its model.
        again: Builds that model once more, for another thread.
        writer: Gets the pictures of the world's cameras.
        film: What is made of it.
        progress: Told about compilation, and how many frames are drawn.
        phases: Gets the time of drawing and encoding.
    """

    def __init__(
        self,
        world: World,
        built: Built,
        again: Callable[[], Built],
        writer: RecordingWriter,
        film: Film,
        progress: Progress,
        phases: Phases,
    ) -> None:
        self.world, self.built, self._again, self.writer = world, built, again, writer
        self.film, self.progress, self.phases = film, progress, phases
        self.video = VideoWriter(film.video, fps=world.frame_rate)
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
        self._kept.add(time, self.built.model, state)

    def draw(self, motion: Motion) -> None:
        """Frame the cameras on a run's motion, and draw all that was kept: the first every frame, the others stills."""
        with self.phases.phase("frame cameras"):
            framing = Framing(self.world, motion, self.film.named, Hidden(self.renderer, self.built))
            self.renderer.look_through(framing.cameras() or self.renderer.cameras)
            self.writer.views(self.renderer.cameras, motion.time, motion.body_q)
        marks = Marks(self.world, motion.push, framing.things)
        stills = set(chosen(framing.moments, len(self._kept), STILLS))
        with self.phases.phase("draw"), self.video:
            for frame, images in painted(self._painters(), self._kept, motion, stills, marks):
                self._keep(self._kept.times[frame], images, frame in stills)
                self.progress("drawing", frame + 1, len(self._kept))
        if self.film.review:
            told = [
                {"time": round(float(motion.time[m.frame]), 4), "what": m.what, "weight": round(m.weight, 3)}
                for m in framing.moments
            ]
            text = json.dumps({"share_of_picture": self.seen, "moments": told}, indent=1)
            partial = Path(f"{self.film.review}.partial")
            partial.write_text(text + "\n", encoding="utf-8")
            partial.replace(self.film.review)

    def _painters(self) -> list[Painter]:
        """This one's, and on a CPU another for each core, if there is enough to draw.

        Of a fluid's surface Warp's tiles are in memory that threads share: that is drawn by one.
        """
        alone = self.built.model.device.is_cuda or self.built.model.particle_count > 0
        many = 1 if alone else min(MOST, thread_count())
        found = [Painter(self.renderer, self.built)]
        for _ in range(min(many - 1, len(self._kept) // FEW)):
            built = self._again()
            renderer = CameraRenderer(built.model, self.world)
            renderer.look_through(self.renderer.cameras)
            found.append(Painter(renderer, built))
        return found

    def _keep(self, time: float, images: dict[str, CameraImage], still: bool) -> None:
        """Write a frame's pictures, and record what they are and show."""
        rgb, words = next(iter(images.values())).rgb, self.film.words
        self.video.write(rgb if words is None else caption(rgb, time, words))
        for camera, image in images.items():
            shares = self._shares(image)
            self.writer.image(time, camera, image.rgb)
            self.writer.seen(time, camera, shares)
            if still:
                shown = {prim: round(share, 5) for prim, share in shares.items() if share}
                self.seen.append({"camera": camera, "time": round(time, 4), "objects": shown})
                if self.film.frames_dir:
                    path = Path(self.film.frames_dir) / still_name(camera, time)
                    write_png(path, image.rgb)
                    self.stills.append(path)

    def _shares(self, image: CameraImage) -> dict[str, float]:
        """The share of a picture that each object takes up; 0 for one that is not to be seen."""
        return {prim: n / image.shape_index.size for prim, n in self.objects.count(image.shape_index).items()}
