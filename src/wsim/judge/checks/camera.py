"""Checks of the cameras: what the world is about is in frame, and is to be seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.framing import as_seen, framed, in_frame
from wsim.judge.evidence.strands import strands
from wsim.judge.language.kinds import formula_of
from wsim.judge.language.objective import ObjectiveCheck, conjuncts
from wsim.judge.verdict import RepairTarget
from wsim.plan.schema.formula import Eventually, Predicate, Then
from wsim.recording.recording import with_company
from wsim.scene.labels import object_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Body, Camera

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

MOVES = 0.05  # of its size, and of a radian: what goes and turns no farther lies still
MOMENTS = 48  # frames that are looked at
ONCE = "what the world is about is to be seen, once at least"
ASKED = "what the plan asks something of is to be seen as it does it, not only where it starts"


@dataclass
class CheckInFrame(Check):
    """Every camera has something that moves in frame, and everything that moves is in frame of some camera.

    At some time: what is hit may leave the picture for most of it, and a finding says for how much. What the plan asks
    something of is in frame for a part of the time that it takes to do that, and at the moment when it comes true.
    """

    asked: float = 0.25  # of the time, for an object of the plan's objectives
    about: float = 0.25  # [s] before and after what an objective is about, within which it is in frame once

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each camera and each object that is out of frame too long, or one for none."""
        world = evidence.world
        things = _things(evidence)
        if not world.cameras or not things or len(evidence.time) == 0:
            return []
        frames = _moments(len(evidence.time))
        inside = {camera.prim: _inside(evidence, camera, frames) for camera in world.cameras}
        found = []
        for camera in world.cameras:
            anything: Bools = np.asarray(inside[camera.prim].any(axis=1))
            target = _reframed(evidence, camera)
            found += self._out(evidence, frames, anything, camera.prim, "has nothing that moves in frame", target)
        anywhere: Bools = np.asarray(np.any(list(inside.values()), axis=0))
        standing = next((camera for camera in world.cameras if camera.follows is None), world.cameras[0])
        plan = evidence.plan
        asked = {evidence.prim(objective.object) for objective in plan.objectives} if plan is not None else set()
        for prim, shown in zip(things, anywhere.T, strict=True):
            target = _reframed(evidence, standing)
            found += self._out(evidence, frames, shown, prim, "is in frame of no camera", target)
            if prim in asked and shown.any():
                found += self._briefly(evidence, frames, shown, prim, target)
        found += self._unseen(evidence, {finding.prim for finding in found})
        shares = anywhere.mean(axis=0)
        limits = np.array([self.asked if prim in asked else 1.0 / len(frames) for prim in things])
        least = int(np.argmin(shares / limits))
        share = float(shares[least])
        return found or [
            self.measured(
                f"Everything that moves is in frame, {things[least]} least, at {share:.0%} of the times",
                share,
                float(limits[least]),
                "share of time",
                at_most=False,
                prim=things[least],
                line=None,  # where nothing is wrong, none is to be looked at
                limit_from=ASKED if things[least] in asked else ONCE,
            )
        ]

    def _briefly(
        self, evidence: Evidence, frames: NDArray[np.intp], seen: Bools, prim: str, target: RepairTarget
    ) -> list[Finding]:
        """The finding of what the plan asks something of, and no camera shows for long enough."""
        share = float(seen.mean())
        if share >= self.asked:
            return []
        why = "it goes out of every picture: frame its way from its start to where it ends"
        return [
            self.measured(
                f"{prim} is in frame at {share:.0%} of the times only", share, self.asked, "share of time",
                at_most=False, prim=prim, time=float(evidence.time[frames[int(np.argmin(seen))]]), limit_from=ASKED,
                target=target.model_copy(update={"why": why}),
            )
        ]  # fmt: skip

    def _unseen(self, evidence: Evidence, told: set[str | None]) -> Iterator[Finding]:
        """What happens, as the plan asks, while its object is out of every picture: once for each object."""
        cameras = evidence.world.cameras
        rows = {prim: k for k, prim in enumerate(_things(evidence))}
        for prim, time, sentence in _events(evidence):
            about = np.flatnonzero(np.abs(evidence.time - time) <= self.about)
            if prim in told or prim not in rows or not len(about):
                continue
            if not any(bool(_inside(evidence, camera, about)[:, rows[prim]].any()) for camera in cameras):
                told.add(prim)
                why = "what the plan asks for happens out of the picture: frame that place too"
                standing = next((each for each in cameras if each.follows is None), cameras[0])
                target = _reframed(evidence, standing).model_copy(update={"why": why})
                yield self.measured(
                    f"{prim} is in frame of no camera at {time:.3f} s, when it comes true: {sentence}",
                    0.0, 1.0, "frames", at_most=False, prim=prim, time=time, limit_from=ASKED, target=target,
                )  # fmt: skip

    def _out(
        self, evidence: Evidence, frames: NDArray[np.intp], seen: Bools, prim: str, what: str, target: RepairTarget
    ) -> list[Finding]:
        if seen.any():
            return []
        time = float(evidence.time[0])
        return [
            self.measured(
                f"{prim} {what} at any time",
                0.0, 1.0 / len(frames), "share of time", at_most=False, prim=prim, time=time, limit_from=ONCE,
                target=target,
            )
        ]  # fmt: skip


@dataclass
class CheckSeen(Check):
    """What moves, and what the plan names, is to be seen in some picture: not hidden in all, and not too small.

    Where nothing moves and there is no plan, that is all there is. What only lies there may be behind something.
    A cable is one thing, part of which may run behind a post; so is what inner parts that meet nothing hold together,
    what is fixed to each other for good, and a cart with its wheels.
    """

    pixels: float = 16.0  # of a picture, below which it is a speck

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each opaque body that is never to be seen, or one for none; nothing without pictures."""
        seen = evidence.recording.seen
        if not seen:
            return []
        sizes = {camera.prim: camera.width * camera.height for camera in evidence.world.cameras}
        found, least, least_prim = [], 1.0, ""
        for thing in _told_of(evidence):
            body = thing[0]
            if any(shape.opacity < 1.0 for each in thing for shape in each.shapes) or not body.shapes:
                continue  # what is clear is not in the pictures of what is opaque
            prims = {"/".join(each.prim.split("/")[:3]) for each in thing}
            times, visible = self._visible(evidence, prims, sizes)
            share = float(visible.mean()) if len(times) else 1.0
            if share < least:
                least, least_prim = share, body.prim
            if share == 0.0:
                target = RepairTarget(kind="camera", prim=next(iter(seen)), parameter="eye", direction="change")
                found.append(
                    self.measured(
                        f"{body.prim} is hidden or a speck in all pictures",
                        0.0, 1.0 / len(times), "share of pictures", at_most=False, prim=body.prim, time=float(times[0]),
                        limit_from=f"{self.pixels:g} pixels of some camera's picture, once", target=target,
                    )
                )  # fmt: skip
        hidden = f": {least_prim} is hidden longest, in {1.0 - least:.0%} of the pictures" if least_prim else ""
        return found or [
            self.passed(f"Everything that moves is to be seen{hidden}", prim=least_prim or None, line=None)
        ]

    def _visible(self, evidence: Evidence, prims: set[str], sizes: dict[str, int]) -> tuple[Floats, Bools]:
        """Times of pictures, and whether any camera then shows the object: at the times that the most cameras share."""
        seen = {
            camera: ([k for k, prim in enumerate(track.objects) if prim in prims], track)
            for camera, track in evidence.recording.seen.items()
        }
        tracks = [track for columns, track in seen.values() if columns and len(track.time)]
        if not tracks:
            return np.zeros(0), np.zeros(0, dtype=bool)
        # The first camera draws every frame, the others a few: where all draw, one of them has to show it.
        times = min((track.time for track in tracks), key=len)
        shown = np.zeros(len(times), dtype=bool)
        for camera, (columns, track) in seen.items():
            if columns and len(track.time):
                nearest = np.abs(track.time[None] - times[:, None]).argmin(axis=1)
                least = self.pixels / sizes.get(camera, 640 * 360)
                shown |= track.share[nearest][:, columns].sum(axis=1) >= least
        return times, shown


def _told_of(evidence: Evidence) -> list[list[Body]]:
    """What moves or turns by a twentieth of its size, and what the plan names; where there is none, all."""
    motion, things = evidence.motion, strands(evidence.world)
    if not len(evidence.time):
        return things
    gone = np.linalg.norm(motion.q[:, :, :3] - motion.q[0, :, :3], axis=2).max(axis=0)
    turned = 2.0 * np.arccos(np.clip(np.abs((motion.q[:, :, 3:] * motion.q[0, :, 3:]).sum(axis=2)), 0.0, 1.0))
    moves = ~((gone <= MOVES * motion.radius) & (turned.max(axis=0) <= MOVES))
    told = {body.prim for body, each in zip(evidence.world.bodies, moves, strict=True) if each}
    asked = {evidence.prim(item.name) for item in evidence.plan.objects} if evidence.plan is not None else set()
    found = [thing for thing in things if any(b.prim in told or object_of(b.prim) in asked for b in thing)]
    return found or things


def _events(evidence: Evidence) -> Iterator[tuple[str, float, str]]:
    """What comes true, as the plan asks: of which object, when [s], and in words. What always holds has no moment."""
    for objective in evidence.plan.objectives if evidence.plan is not None else []:
        check = ObjectiveCheck(objective)
        try:
            found = check.run(evidence)
        except Exception:  # noqa: BLE001 - the verdict tells of it where the objective itself is asked
            continue
        if not any(finding.passed for finding in found):
            continue  # one whose object is not there has one finding, whatever it is made of
        for finding, part in zip(found, conjuncts(formula_of(objective, evidence)), strict=True):
            once = isinstance(part, Eventually | Then) or (isinstance(part, Predicate) and part.alone == "eventually")
            if once and finding.passed and finding.prim and finding.time is not None:
                # The moment that decides is that of the greatest margin; it came true before.
                yield finding.prim, finding.span[0] if finding.span is not None else finding.time, check.asks


def _things(evidence: Evidence) -> list[str]:
    """Prims of what moves: bodies and fluids."""
    return [body.prim for body in evidence.world.bodies] + [fluid.prim for fluid in evidence.world.fluids]


def _reframed(evidence: Evidence, camera: Camera) -> RepairTarget:
    """Where a camera is to stand and look, so that it sees all that moves, all the time."""
    frames = _moments(len(evidence.time))
    seen = [as_seen(evidence, camera, frames, each) for each in _points(evidence, frames)]
    points = np.concatenate([each.reshape(-1, 3) for each in seen])
    points = points[np.isfinite(points).all(axis=1)]
    sizes = evidence.motion.radius[np.isfinite(evidence.motion.radius)]
    found = framed(camera, points, float(sizes.max(initial=0.0))) if len(points) else None
    target = RepairTarget(kind="camera", prim=camera.prim, parameter="target", direction="change", unit="m")
    if found is None:
        return target
    eye, at = (tuple(float(x) for x in place) for place in found)
    if eye == camera.eye:
        return target.model_copy(update={"vector": at})
    return target.model_copy(update={"parameter": "eye, target", "vector": (*eye, *at)})


def _moments(frames: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, frames - 1, min(frames, MOMENTS)).astype(int))


def _inside(evidence: Evidence, camera: Camera, frames: NDArray[np.intp]) -> Bools:
    """Whether each thing is in a camera's picture, (frames, things): a body's centre, some of a fluid's particles."""
    bodies, *fluids = (as_seen(evidence, camera, frames, each) for each in _points(evidence, frames))
    return np.column_stack([in_frame(camera, bodies), *(in_frame(camera, some).any(axis=1) for some in fluids)])


def _points(evidence: Evidence, frames: NDArray[np.intp]) -> list[Floats]:
    """Centres of the bodies (frames, B, 3), and some hundred particles of each fluid (frames, n, 3) [m]."""
    found = [evidence.motion.com[frames]]
    for fluid in evidence.world.fluids:
        track = evidence.track(fluid)
        at = np.abs(track.time[None] - evidence.time[frames, None]).argmin(axis=1)
        some = slice(None, None, max(1, track.position.shape[1] // 100))
        there = None if track.present is None else track.present[at, some]
        found.append(with_company(np.asarray(track.position[at, some], dtype=np.float64), there))
    return found


CHECKS: Checks = (CheckInFrame, CheckSeen)
