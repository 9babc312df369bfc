"""The cameras that a run's pictures are taken with: those of its stage, corrected or with others beside them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.scene.world import Camera
from wsim.sim.framing.moments import STILLS, Moment, chosen, moments
from wsim.sim.framing.motion import Motion
from wsim.sim.framing.rating import KEPT, SHOWN, Look, Rating
from wsim.sim.framing.shown import IN, Scenario, Shown, passes, shown
from wsim.sim.framing.subjects import Subject, alone, subjects
from wsim.sim.framing.tried import ground_of, views, views_from_there, views_of_all
from wsim.sim.render_views import DEFAULT_CAMERA

if TYPE_CHECKING:
    from wsim.recording import RecordingWriter
    from wsim.scene.world import World

Array = np.ndarray
FRAMES = 24  # that views are held against
EVENT, AFTER = 3.0, 0.3  # weights of frames about a moment, and after the last one, where others have 1
ABOUT = 0.15  # [s] about a moment
WELL = 0.7  # of 1: a camera that is worth so much is kept
OWN = 1.1  # what a view from the side that the camera was on is worth, of one from another
APART = 40.0  # [deg] between the ways in which two cameras look, where one of them was moved
HALF = 0.5  # of the time that matters: a first view from near shows each main subject for longer
LONG = 0.25  # of it: a main subject that no camera shows for longer gets one of its own
MORE = 4  # cameras beside those of a world, at most
DIGITS = 3
LENS = Camera(prim=DEFAULT_CAMERA, eye=(0.0, -1.0, 0.0), target=(0.0, 0.0, 0.0))


class Framing:
    """Keeps or corrects a world's cameras, by how the world moved, and adds those that it takes beside them.

    A camera is kept as it is if it is fixed, or if it shows what the run is about: each main subject (`subjects`) for
    nine tenths of the time that matters, at a useful size and not hidden, about as well as the best view that is tried.
    Else it is turned, moved or made to follow; the first one to the best view of all, the others where that shows
    enough from the side on which they are, or from one where none is. What could move and was in the picture of one
    stays in that of one. A world without cameras gets the best view.

    One camera stands and has all of the way in its picture, whatever the size of what goes it: the first one where no
    view from near has each main subject, or where the best one goes along through the empty sky; or another of the
    world's, or one beside them. What none of them shows for long enough has a camera of its own.

    Args:
        world: What the stage states.
        motion: How it moved.
        named: Names of objects that the run is about.
        look: Says what is hidden; None: nothing is drawn to find out.

    Attributes:
        moments: When something happens, in order of time.
        things: Corners of what goes somewhere and is what the run is about, (F, n, 3) [m] each.
    """

    def __init__(self, world: World, motion: Motion, named: Sequence[str] = (), look: Look | None = None) -> None:
        self.world, self.motion, self._look = world, motion, look
        self.moments: list[Moment] = []
        self.things: list[Array] = []
        self._rating: Rating | None = None
        if len(motion.time):
            found = subjects(world, motion, named)
            self.moments = moments(world, motion, found)
            self.things = [each.points for each in found if each.main and each.able and each.moves]
            if found:
                self._rating = Rating(self._scenario(found), look)

    def cameras(self) -> list[Camera]:
        """Those that the pictures are taken with: the world's in their order, and what it takes beside them."""
        given = self.world.cameras
        rating = self._rating
        if rating is None:
            return list(given)
        if not given:
            tried = views(LENS, rating.scenario, self._around)
            return self._with_more([_rounded(self._first(*rating.best(tried), LENS)[0])], rating)
        framed: list[Camera] = []
        for camera in given:
            framed.append(camera if camera.fixed else self._kept_or_better(camera, framed, rating))
        needed = _any(rating, given) & ~_any(rating, framed)
        if needed.any() and not given[0].fixed:
            framed[0] = self._kept_or_better(given[0], [], rating, needed)
        return framed if all(camera.fixed for camera in given) else self._with_more(framed, rating)

    def _scenario(self, found: list[Subject]) -> Scenario:
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
        return Scenario(self.world, moved, thin, weight / weight.sum(), np.isin(frames, stills))

    def _kept_or_better(
        self, camera: Camera, framed: Sequence[Camera], rating: Rating, needed: Array | None = None
    ) -> Camera:
        """A camera, or a better one, which looks from elsewhere than those that are `framed` already."""
        own, shows = rating.worth(camera)
        if shows and own >= WELL:
            return camera
        there, worth = rating.best(views_from_there(camera, rating.scenario, self._around), needed)
        worth *= OWN
        if any(_apart(there, other) < APART for other in framed):
            there, worth = camera, 0.0  # what is seen from there is seen
        if not framed or worth < 0.5 * WELL:
            tried = views(camera, rating.scenario, self._around)
            elsewhere = [view for view in tried if all(_apart(view, one) >= APART for one in framed)]
            other, found = rating.best(elsewhere, needed) if elsewhere else (camera, 0.0)
            if found > worth:
                there, worth = other, found
        if shows and own >= KEPT * worth / OWN:
            return camera
        if not framed:
            there, worth = self._first(there, worth, camera)
        elif not any(rating.shows_all(each) for each in (*framed, there)):
            there, worth = self._whole(camera), math.inf
        return _rounded(there) if worth > own else camera

    def _first(self, best: Camera, worth: float, lens: Camera) -> tuple[Camera, float]:
        """The best view from near, or that of all the way where one from near does not do.

        It misses a subject that is in the other, or goes along where nothing goes by: in an empty sky a thing hangs
        still in its picture.
        """
        assert self._rating is not None
        scenario, whole = self._rating.scenario, self._whole(lens)
        asked = np.array([each.main or each.asked for each in scenario.subjects])
        there, near = (shown(view, scenario).inside[scenario.stills] >= IN for view in (whole, best))
        short = (self._rating.seen_for(best)[asked & there.all(axis=0)] <= HALF).any() or (
            (there & ~near)[:, [each.main for each in scenario.subjects]].any()
        )
        empty = best.follows is not None and passes(best, scenario, ground_of(self.world)) < SHOWN
        return (whole, math.inf) if short or empty else (best, worth)

    def _whole(self, lens: Camera) -> Camera:
        """The best view of all the way, from the side of a camera or another."""
        assert self._rating is not None
        return self._rating.best(views_of_all(lens, self._rating.scenario), worth=Shown.worth_of_all)[0]

    def _with_more(self, framed: list[Camera], rating: Rating) -> list[Camera]:
        """Cameras, and those that show what they do not: all of the way at once, or what they miss, from near."""
        lens = (self.world.cameras or [LENS])[0]
        found = list(framed)
        if not any(rating.shows_all(camera) for camera in found):
            found.append(_named(self._whole(lens), "whole"))
        left = rating.scenario.subjects
        while len(found) < len(framed) + MORE and (left := _missed(left, found, rating)):
            missed, left = left[0], left[1:]
            near = Rating(replace(rating.scenario, subjects=alone(rating.scenario.subjects, missed)), self._look)
            view, worth = near.best(views(lens, near.scenario, self._around, steep=True))
            if worth > 0.0:
                found.append(_named(view, missed.prim.rsplit("/", 1)[-1]))
        return found


def write_views(writer: RecordingWriter, world: World, motion: Motion, named: Sequence[str] = ()) -> None:
    """Have a recording say where a world's cameras would be framed, where no pictures are taken."""
    if world.cameras:
        writer.views(Framing(world, motion, named).cameras(), motion.time, motion.body_q)


def _any(rating: Rating, cameras: Sequence[Camera]) -> Array:
    return np.asarray(np.any([rating.ever(camera) for camera in cameras], axis=0))


def _missed(left: Sequence[Subject], cameras: Sequence[Camera], rating: Rating) -> list[Subject]:
    """Those of some subjects that no camera shows for long enough, or, of what only could move, at all."""
    shares = np.max([rating.seen_for(camera) for camera in cameras], axis=0)
    seen = {each.prim: float(share) for each, share in zip(rating.scenario.subjects, shares, strict=True)}
    return [each for each in left if each.able and seen[each.prim] <= (LONG if each.main else 0.0)]


def _apart(one: Camera, other: Camera) -> float:
    """Between the ways in which two cameras look [deg]."""
    ways = [np.subtract(each.target, each.eye) / math.dist(each.target, each.eye) for each in (one, other)]
    return math.degrees(math.acos(float(np.clip(ways[0] @ ways[1], -1.0, 1.0))))


def _named(view: Camera, what: str) -> Camera:
    """A view as a camera of its own."""
    return _rounded(view.model_copy(update={"prim": f"{DEFAULT_CAMERA}_{what}"}))


def _rounded(camera: Camera) -> Camera:
    """To so many digits of the distance, as a person would say it."""
    digits = DIGITS - math.floor(math.log10(math.dist(camera.eye, camera.target)))
    place, aim = (tuple(round(v, digits) + 0.0 for v in each) for each in (camera.eye, camera.target))
    return camera.model_copy(update={"eye": place, "target": aim})
