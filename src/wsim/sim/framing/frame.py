"""The cameras that a run's pictures are taken with: those of its stage, or corrected where they do not show it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.scene.world import Camera
from wsim.sim.framing.moments import STILLS, Moment, chosen, moments
from wsim.sim.framing.motion import Motion
from wsim.sim.framing.shown import Scenario, Shown, shown
from wsim.sim.framing.subjects import Subject, subjects
from wsim.sim.framing.tried import views, views_from_there
from wsim.sim.render_views import DEFAULT_CAMERA, SUN

if TYPE_CHECKING:
    from wsim.recording import RecordingWriter
    from wsim.scene.world import World

Array = np.ndarray
# Which share of each subject (F, S) others hide, by a camera's picture of each of some frames (F,).
Look = Callable[[Camera, Scenario, Shown], Array]

FRAMES = 24  # that views are held against
EVENT, AFTER = 3.0, 0.3  # weights of frames about a moment, and after the last one, where others have 1
ABOUT = 0.15  # [s] about a moment
WELL, KEPT = 0.7, 0.75  # of 1, and of the best view's worth: a camera that is worth so much is kept
SHOWN = 0.9  # of the time: for how long a camera that is kept shows each main subject
LOOKED_AT = 4  # views whose pictures are looked at, at least, for what hides what
OWN = 1.1  # what a view from the side that the camera was on is worth, of one from another
LIT = 0.05  # what a view that the sun is behind is worth more, and one against it less
LEVEL, STEEP = 30.0, 0.6  # [deg] that a view is above the horizon; a view from above is worth less by so much
APART = 40.0  # [deg] between the ways in which two cameras look, where one of them was moved
DIGITS = 3


class Framing:
    """Keeps or corrects a world's cameras, by how the world moved.

    A camera is kept as it is if it is fixed, or if it shows what the run is about: each main subject (`subjects`) for
    nine tenths of the time that matters, at a useful size and not hidden, about as well as the best view that is tried.
    Else it is turned, moved or made to follow; the first one to the best view of all, the others where that shows
    enough from the side on which they are, or from one where none is. What could move and was in the picture of one
    stays in that of one. A world
    without cameras gets the best view, and one that stands and sees all of the way if that goes along.

    Args:
        world: What the stage states.
        motion: How it moved.
        named: Names of objects that the run is about.
        look: Says what is hidden; None: nothing is drawn to find out.

    Attributes:
        moments: When something happens, in order of time.
    """

    def __init__(self, world: World, motion: Motion, named: Sequence[str] = (), look: Look | None = None) -> None:
        self.world, self.motion, self._look = world, motion, look
        self.moments: list[Moment] = []
        self._scenario: Scenario | None = None
        if len(motion.time):
            found = subjects(world, motion, named)
            self.moments = moments(world, motion, found)
            if found:
                self._prepare(found)

    def cameras(self) -> list[Camera]:
        """Those that the pictures are taken with, in the world's order."""
        given = self.world.cameras
        if self._scenario is None:
            return list(given)
        if not given:
            return self._own(Camera(prim=DEFAULT_CAMERA, eye=(1.0, 0.0, 0.0), target=(0.0, 0.0, 0.0)))
        framed: list[Camera] = []
        for camera in given:
            framed.append(camera if camera.fixed else self._kept_or_better(camera, framed))
        self._needed = self._ever(given) & ~self._ever(framed)
        if self._needed.any() and not given[0].fixed:
            framed[0] = self._kept_or_better(given[0], [])
        return list(given) if (self._ever(given) & ~self._ever(framed)).any() else framed

    def _ever(self, cameras: Sequence[Camera]) -> Array:
        """(S,) which of the subjects that could move are in the picture of some camera at some time."""
        assert self._scenario is not None
        able = np.array([subject.able for subject in self._scenario.subjects])
        return np.asarray(able & np.any([shown(camera, self._scenario).ever for camera in cameras], axis=0))

    def _prepare(self, found: list[Subject]) -> None:
        """Thin the frames out, and weigh them."""
        time = self.motion.time
        happens = [moment.frame for moment in self.moments]
        strongest = sorted(self.moments, key=lambda moment: -moment.weight)[: FRAMES // 2]
        evenly = np.linspace(0, len(time) - 1, min(len(time), FRAMES - len(strongest))).astype(int)
        stills = chosen(self.moments, len(time), STILLS)
        frames = np.unique([*evenly, *stills, *(moment.frame for moment in strongest)])
        weight = np.gradient(time[frames]) if len(frames) > 1 else np.ones(1)
        apart = np.abs(time[frames][:, None] - time[happens][None]).min(axis=1, initial=math.inf)
        self._around = apart <= max(ABOUT, 0.1 * float(time[-1] - time[0]))
        weight[apart <= ABOUT] *= EVENT
        if happens:
            weight[time[frames] > time[max(happens)] + 2 * ABOUT] *= AFTER
        moved = Motion(
            time[frames], self.motion.body_q[frames], self.motion.speed[frames], self.motion.force[frames],
            {prim: points[frames] for prim, points in self.motion.fluids.items()},
        )  # fmt: skip
        thin = [replace(each, points=each.points[frames]) for each in found]
        self._scenario = Scenario(self.world, moved, thin, weight / weight.sum(), np.isin(frames, stills))
        self._needed = np.zeros(len(thin), dtype=bool)  # subjects that a view is not to lose

    def _own(self, lens: Camera) -> list[Camera]:
        assert self._scenario is not None
        tried = list(views(lens, self._scenario, self._around))
        best = self._best(tried)[0]
        if best.follows is None:
            return [_rounded(best)]
        whole = self._best([view for view in tried if view.follows is None])[0]
        return [_rounded(best), _rounded(whole.model_copy(update={"prim": f"{DEFAULT_CAMERA}_whole"}))]

    def _kept_or_better(self, camera: Camera, framed: Sequence[Camera]) -> Camera:
        """A camera, or a better one, which looks from elsewhere than those that are `framed` already."""
        assert self._scenario is not None
        own, shows = self._worth(camera)
        if shows and own >= WELL:
            return camera
        there, worth = self._best(views_from_there(camera, self._scenario, self._around))
        worth *= OWN
        if any(_apart(there, other) < APART for other in framed):
            there, worth = camera, 0.0  # what is seen from there is seen
        if not framed or worth < 0.5 * WELL:
            tried = views(camera, self._scenario, self._around)
            elsewhere = [view for view in tried if all(_apart(view, one) >= APART for one in framed)]
            other, found = self._best(elsewhere) if elsewhere else (camera, 0.0)
            if found > worth:
                there, worth = other, found
        if shows and own >= KEPT * worth / OWN:
            return camera
        return _rounded(there) if worth > own else camera

    def _taken_from(self, view: Camera) -> float:
        """What a view is worth for where it is taken from, of one as people stand, with the sun at their side.

        More with the sun behind the camera, and less from above: there a fall is a ball that becomes smaller.
        """
        rise = math.degrees(math.asin((view.eye[2] - view.target[2]) / math.dist(view.eye, view.target)))
        from_above = STEEP * max(0.0, rise - LEVEL) / (90.0 - LEVEL)
        sun = next((light.direction for light in self.world.lights if light.kind == "distant"), SUN)
        back, light = (np.array(way[:2]) for way in (np.subtract(view.eye, view.target), sun))
        shade = LIT * float(back @ light) / max(float(np.linalg.norm(back) * np.linalg.norm(light)), 1e-12)
        return (1.0 - from_above) * (1.0 - shade)

    def _worth(self, camera: Camera) -> tuple[float, bool]:
        """What a camera is worth, and whether it shows each main subject for long enough."""
        assert self._scenario is not None
        seen = shown(camera, self._scenario)
        hidden = self._hidden(camera, seen)
        main = np.array([subject.main for subject in self._scenario.subjects])
        shares = (self._scenario.weight @ seen.seen) * (1.0 - hidden)
        return seen.worth(self._scenario, hidden), bool((shares[main] >= SHOWN).all())

    def _hidden(self, camera: Camera, seen: Shown) -> Array:
        """(S,) share of each subject that is hidden, of the time that it is in the picture."""
        assert self._scenario is not None
        if self._look is None:
            return np.zeros(len(self._scenario.subjects))
        return self._look(camera, self._scenario, seen)

    def _best(self, tried: Iterable[Camera]) -> tuple[Camera, float]:
        """The view that shows most, and what it is worth; what hides what is looked at in the best ones only."""
        assert self._scenario is not None
        found = [(shown(view, self._scenario), view) for view in tried]
        found = [each for each in found if each[0].ever[self._needed].all()] or found
        rated = sorted(
            ((self._taken_from(view) * seen.worth(self._scenario), seen, view) for seen, view in found),
            key=lambda each: -each[0],
        )
        if self._look is None:
            return rated[0][2], rated[0][0]
        best = (rated[0][2], -1.0)
        sides: set[tuple[str | None, ...]] = set()
        for worth, seen, view in rated:
            if worth <= best[1] or (len(sides) >= LOOKED_AT and best[1] > KEPT * worth):
                break  # those that follow are worth less, hidden or not
            if _side(view) not in sides:
                sides.add(_side(view))
                told = self._taken_from(view) * seen.worth(self._scenario, self._hidden(view, seen))
                if told > best[1]:
                    best = (view, told)
        return best


def write_views(writer: RecordingWriter, world: World, motion: Motion, named: Sequence[str] = ()) -> None:
    """Have a recording say where a world's cameras would be framed, where no pictures are taken."""
    if world.cameras:
        writer.views(Framing(world, motion, named).cameras(), motion.time, motion.body_q)


def _apart(one: Camera, other: Camera) -> float:
    """Between the ways in which two cameras look [deg]."""
    ways = [np.subtract(each.target, each.eye) / math.dist(each.target, each.eye) for each in (one, other)]
    return math.degrees(math.acos(float(np.clip(ways[0] @ ways[1], -1.0, 1.0))))


def _side(view: Camera) -> tuple[str | None, ...]:
    """From where a view looks, whatever it follows."""
    way = np.subtract(view.eye, view.target)
    return (view.follows, *(f"{part:.2f}" for part in way / np.linalg.norm(way)))


def _rounded(camera: Camera) -> Camera:
    """To so many digits of the distance, as a person would say it."""
    digits = DIGITS - math.floor(math.log10(math.dist(camera.eye, camera.target)))
    place, aim = (tuple(round(v, digits) + 0.0 for v in each) for each in (camera.eye, camera.target))
    return camera.model_copy(update={"eye": place, "target": aim})
