"""What a recording says that contacts gave: it balances by itself, and is what contacts of these surfaces can give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.balance import Books
from wsim.judge.books.forces import ONE_WAY, STILL
from wsim.judge.books.leaning import leaning
from wsim.judge.books.recorded import SOLVED, RecordedContacts
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Bools = NDArray[np.bool_]
    Floats = NDArray[np.float64]

LEANS = 0.97  # of the length of a mean normal: those of its points lean apart along a slip by 14 degrees at most


@dataclass
class CheckRecordedForces(Check):
    """Where the impulses of contacts are recorded, they explain each body's motion, and each is admissible.

    Of what hangs on joints, springs and ropes with theirs, where they are recorded, too (`CheckRecordedTies`).

    They push, inside the cone of their pair's friction and on its edge against a slip that lasts, where both surfaces
    are. Where they are not recorded nothing is asked: then `CheckForces` looks for some that would do.
    """

    share: float = SOLVED  # of gravity and of what contacts gave
    single: float = 0.02  # likewise, of a solver in single precision
    cone: float = 0.001  # of the normal impulse: the solver's tolerance
    edge: float = 0.02  # of the friction of a slip that lasts
    near: float = 0.05  # of a body's smallest extent: as deep as what is pressed may be (`CheckPenetration`)

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """Momentum, angular momentum, friction and places, each where it is worst by its limit."""
        track, bodies = evidence.recording.contacts, evidence.world.bodies
        if track is None or not bodies or len(evidence.time) < 2:
            return []
        contacts = RecordedContacts(evidence, track)
        found = self._balance(evidence, contacts)
        if len(track.frame):
            found += [self._inside(evidence, contacts), *self._against(evidence, contacts)]
            found.append(self._there(evidence, contacts))
        return found

    # ---- the sums
    def _balance(self, evidence: Evidence, contacts: RecordedContacts) -> list[Finding]:
        books, motion = contacts.balanced(), evidence.motion
        about = evidence.recording.metadata
        single = str(about.get("device", "cpu")).startswith("cuda") or int(about.get("world_count") or 1) > 1
        part = self.single if single else self.share
        share = part * (max(evidence.gravity, 1.0) + books.moved)
        found = []
        for left, judged, weight, limits, unit in (
            (books.force, books.judged, motion.mass, share + books.stepped, "N"),
            (books.torque, books.turned, motion.mass * motion.radius, share + books.lagging, "N m"),
        ):
            if not judged.any():
                continue
            size = np.where(judged, np.linalg.norm(left, axis=2), 0.0)
            k, i = (int(at) for at in np.unravel_index(int(np.argmax(size / limits)), size.shape))
            prim, start, end = evidence.world.bodies[i].prim, float(evidence.time[k]), float(evidence.time[k + 1])
            way = listed(tuple((left[k, i] / max(float(size[k, i]), 1e-300)).round(2)))
            value, limit = float(size[k, i] * weight[i]), float(limits[k, i] * weight[i])
            verb, kind, cause = (
                ("pushed", "momentum", "force") if unit == "N" else ("turned", "angular momentum", "torque")
            )
            found.append(
                self.measured(
                    f"{prim} is {verb} by {value:.3g} {unit} towards {way} that nothing recorded gives, from "
                    f"{start:.3f} to {end:.3f} s",
                    value, limit, unit, prim=prim, time=end, span=(start, end), expected=0.0,
                    fine=f"What is recorded gives each body the {kind} that it gained",
                    limit_from=f"{part:g} of gravity and of what contacts, ties and fluid gave, and what steps of the "
                    "first order leave where bodies turn",
                    target=RepairTarget(kind="program", prim=prim, why=f"a {cause} that is not recorded acts on it"),
                )
            )  # fmt: skip
        return found

    # ---- each of them
    def _inside(self, evidence: Evidence, contacts: RecordedContacts) -> Finding:
        """They push, and rub no more than they may."""
        pressed = contacts.track.pressed.astype(np.float64)
        unit = np.maximum(np.abs(pressed), 1e-30)
        turned = np.linalg.norm(contacts.track.along.astype(np.float64), axis=1) - pressed
        over = (
            np.maximum(contacts.rubbed - (contacts.friction + contacts.spread) * pressed, np.maximum(turned, -pressed))
            / unit
        )
        k = int(np.argmax(over))
        return self._of_row(
            evidence, contacts, k,
            f"rub with {contacts.rubbed[k] / unit[k]:.3g} of what they press; their friction is "
            f"{contacts.friction[k]:.3g}",
            float(contacts.rubbed[k] / unit[k] if pressed[k] > 0.0 else np.inf),
            float(contacts.friction[k] + contacts.spread[k] + self.cone), "1",
            "Every recorded contact pushes, and rubs inside its friction's cone",
            f"the pair's friction, and {self.cone:g} for the solver",
        )  # fmt: skip

    def _against(self, evidence: Evidence, contacts: RecordedContacts) -> list[Finding]:
        """Where a slip lasts, they rub against it with all their friction, or what resisted rolling leaves of it."""
        track, slip = contacts.track, contacts.slip
        pressed = np.maximum(track.pressed.astype(np.float64), 1e-30)
        normal = track.along.astype(np.float64) / pressed[:, None]
        across = slip - np.einsum("nei,ni->ne", slip, normal)[..., None] * normal[:, None]
        speed = np.linalg.norm(across, axis=2)
        cosine = np.einsum("ni,ni->n", across[:, 0], across[:, 1]) / np.maximum(speed.prod(axis=1), 1e-30)
        # As in the books, it lasts where it would have a frame longer: else it may have stuck, or turned and come back.
        change, slowest = np.linalg.norm(across[:, 1] - across[:, 0], axis=1), speed.min(axis=1)
        lasts = contacts.lasting & (cosine > ONE_WAY)
        lasts &= slowest > np.maximum(STILL + contacts.rolled, change)
        # Landings that turn a slip turn its friction: they change it by at most the sine of that of its speed.
        held = self._chattering(evidence, contacts, lasts, normal, (across, speed))
        lasts &= contacts.loose
        aside = contacts.landed(Books.of(evidence).landed)
        rows = np.flatnonzero(lasts & (contacts.friction > 0.0))
        aside[rows] += contacts.knocked(rows, normal, change[rows])
        aside /= np.maximum(slowest, 1e-30)
        rows = rows[aside[rows] < 1.0]
        if not len(rows):
            return held
        mean = across[rows].mean(axis=1)
        way = mean / np.linalg.norm(mean, axis=1, keepdims=True)
        rubs = np.einsum("ni,ni->n", (track.impulse - track.along)[rows].astype(np.float64), -way) / pressed[rows]
        friction, (least, most) = contacts.friction[rows], contacts.rubs(normal, speed)[:, rows]
        resists = least < friction
        # Of points whose normals lean apart along the slip, as a box's on a hill, friction leans as they do. Across it,
        # as in a trough, they may lean by more and take nothing, and a mean does not tell which: places do.
        least = least * np.clip(
            np.linalg.norm(normal[rows], axis=1), leaning(evidence, contacts, rows, way, LEANS), 1.0
        )
        turned = contacts.swing(normal, speed.min(axis=1))[rows]
        round_ = 1.0 - np.sqrt(1.0 - aside[rows] ** 2)
        slack = (
            (self.edge + 1.0 - cosine[rows] + 0.5 * turned**2 + round_) * friction + contacts.spread[rows] + self.cone
        )
        given = np.clip(rubs, least, most)
        worst = int(np.argmax(np.abs(rubs - given) / slack))
        k, value, expected, limit = int(rows[worst]), float(rubs[worst]), float(given[worst]), float(slack[worst])
        resisted = ", with what resists rolling," if resists[worst] else ""
        return [
            *held,
            self._of_row(
                evidence, contacts, k, f"slip, and rub with {value:.3g} of what they press; their friction is"
                f"{resisted} {expected:.3g}", abs(value - expected), limit, "1",
                "What slips rubs with all its friction",
                f"{self.edge:g} of the friction, and how far slips turn, by what lands in between, too",
            )
        ]  # fmt: skip

    def _chattering(
        self, evidence: Evidence, contacts: RecordedContacts, lasts: Bools, normal: Floats, slips: tuple[Floats, Floats]
    ) -> list[Finding]:
        """All that slips of what hangs on joints rubs, together, with all its friction.

        Links of a cable chatter between frames, so that each may rub otherwise for a while. A slip that changes by a
        share x of its speed turns by arcsin x at most, and those of a pair's points, of what spins, from their mean's
        way by as much as `RecordedContacts.swing` has it: of friction that is turned by t 1 - cos t is lost.
        """
        across, speed = slips
        rows = np.flatnonzero(lasts & ~contacts.loose & (contacts.friction > 0.0))
        most = contacts.rubs(normal, speed)[0] * np.maximum(contacts.track.pressed.astype(np.float64), 0.0)
        owner = np.where(evidence.motion.jointed[np.maximum(contacts.body[:, 0], 0)] & (contacts.body[:, 0] >= 0),
                         contacts.body[:, 0], contacts.body[:, 1])  # fmt: skip
        found = []
        for unit in np.unique(evidence.motion.unit[owner[rows]]):
            own = rows[evidence.motion.unit[owner[rows]] == unit]
            if not (total := float(most[own].sum())) > 0.0:
                continue
            way = across[own].mean(axis=1)
            way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-30)
            rubs = -np.einsum("ni,ni->n", (contacts.track.impulse - contacts.track.along)[own].astype(np.float64), way)
            change = np.linalg.norm(across[own, 1] - across[own, 0], axis=1) / speed[own].min(axis=1)
            turned = np.arcsin(np.minimum(change, 1.0)) + contacts.swing(normal, speed.min(axis=1))[own]
            lost = float((most[own] * (1.0 - np.cos(np.minimum(turned, 0.5 * np.pi)))).sum()) / total
            share, k = float(rubs.sum()) / total, int(own[np.argmax(most[own])])
            found.append(
                self._of_row(
                    evidence, contacts, k, f"and all that slips as they do rub with {share:.3g} of their friction",
                    max(share - 1.0, 1.0 - share - lost, 0.0), self.edge + self.cone, "1",
                    "What slips on joints rubs with all its friction",
                    f"{self.edge:g} of the friction, and how far slips turn between two frames",
                )
            )  # fmt: skip
        return found

    def _there(self, evidence: Evidence, contacts: RecordedContacts) -> Finding:
        """They act where both surfaces are."""
        gap, allowed = contacts.gap(self.near)
        k = int(np.argmax(gap - allowed))
        return self._of_row(
            evidence, contacts, k, f"press at a place that is {gap[k]:.3g} m from one of them", float(gap[k]),
            float(allowed[k]), "m", "Every recorded contact is where both surfaces are",
            f"{self.near:g} of the body's smallest extent, and how far bodies go in the interval",
        )  # fmt: skip

    def _of_row(
        self, evidence: Evidence, contacts: RecordedContacts, k: int, what: str, value: float, limit: float, unit: str,
        fine: str, limit_from: str,
    ) -> Finding:  # fmt: skip
        frame, (one, two) = int(contacts.track.frame[k]), contacts.track.pair[k].tolist()
        prims, time = (contacts.shapes[one].prim, contacts.shapes[two].prim), float(evidence.time[frame])
        i = int(contacts.body[k].max())
        prim = evidence.world.bodies[i].prim if i >= 0 else prims[1]
        return self.measured(
            f"{prims[0]} and {prims[1]} {what}, at {time:.3f} s",
            value, limit, unit, prim=prim, time=time, expected=0.0, fine=fine, limit_from=limit_from,
            target=RepairTarget(kind="program", prim=prim, why="its contacts are not those of the stated surfaces"),
        )  # fmt: skip


CHECKS: Checks = (CheckRecordedForces,)
