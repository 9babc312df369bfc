"""What views of a run are worth, hidden or not, and which of many is the best."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

from wsim.sim.framing.shown import IN, Scenario, Shown, shown
from wsim.sim.render_views import SUN

if TYPE_CHECKING:
    from wsim.scene.world import Camera

Array = np.ndarray
# Which share of each subject (S,) others hide, by a camera's pictures of a scenario.
Look = Callable[["Camera", Scenario, Shown], Array]
Worth = Callable[[Shown, Scenario, "Array | float"], float]

KEPT = 0.75  # of the best view's worth: a camera that is worth so much is kept
SHOWN = 0.9  # of the time: for how long a camera that is kept shows each main subject
LOOKED_AT = 4  # views whose pictures are looked at, at least, for what hides what
LIT = 0.05  # what a view that the sun is behind is worth more, and one against it less
WIDE = 60.0  # [deg] of a lens: a view through a wider one is worth less
LEVEL, STEEP = 30.0, 0.6  # [deg] that a view is above the horizon; a view from above is worth less by so much


class Rating:
    """Rates the views of a scenario.

    Args:
        scenario: What they are held against.
        look: Says what is hidden; None: nothing is drawn to find out.
    """

    def __init__(self, scenario: Scenario, look: Look | None) -> None:
        self.scenario, self._look = scenario, look
        self._main = np.array([subject.main for subject in scenario.subjects])
        self._able = np.array([subject.able for subject in scenario.subjects])
        lights = scenario.world.lights
        self._sun = next((light.direction for light in lights if light.kind == "distant"), SUN)

    def worth(self, camera: Camera) -> tuple[float, bool]:
        """What a camera is worth, and whether it shows each main subject for long enough."""
        seen = shown(camera, self.scenario)
        hidden = self._hidden(camera, seen)
        shares = (self.scenario.weight @ seen.seen) * (1.0 - hidden)
        return seen.worth(self.scenario, hidden), bool((shares[self._main] >= SHOWN).all())

    def seen_for(self, camera: Camera) -> Array:
        """(S,) for which share of the time that matters a camera shows each subject, and nothing hides it."""
        seen = shown(camera, self.scenario)
        return np.asarray((self.scenario.weight @ seen.seen) * (1.0 - self._hidden(camera, seen)))

    def ever(self, camera: Camera) -> Array:
        """(S,) which of the subjects that could move are in a camera's picture at some time."""
        return np.asarray(shown(camera, self.scenario).ever & self._able)

    def shows_all(self, camera: Camera) -> bool:
        """Whether a camera stands, and has all of the way of each main subject in its picture."""
        if camera.follows is not None:
            return False
        inside = self.scenario.weight @ (shown(camera, self.scenario).inside >= IN)
        return bool((inside[self._main] >= SHOWN).all())

    def best(
        self, tried: Iterable[Camera], needed: Array | None = None, worth: Worth = Shown.worth
    ) -> tuple[Camera, float]:
        """The view that shows most, and what it is worth; what hides what is looked at in the best ones only.

        Args:
            tried: One or more.
            needed: (S,) subjects that it is not to lose, if any view has them.
            worth: What a view is worth for what it shows.
        """
        found = [(shown(view, self.scenario), view) for view in tried]
        if needed is not None:
            found = [each for each in found if each[0].ever[needed].all()] or found
        rated = sorted(
            ((self._taken_from(view) * worth(seen, self.scenario, 0.0), seen, view) for seen, view in found),
            key=lambda each: -each[0],
        )
        if self._look is None:
            return rated[0][2], rated[0][0]
        best = (rated[0][2], -1.0)
        sides: set[tuple[str | None, ...]] = set()
        for most, seen, view in rated:
            if most <= best[1] or (len(sides) >= LOOKED_AT and best[1] > KEPT * most):
                break  # those that follow are worth less, hidden or not
            if _side(view) not in sides:
                sides.add(_side(view))
                told = self._taken_from(view) * worth(seen, self.scenario, self._hidden(view, seen))
                if told > best[1]:
                    best = (view, told)
        return best

    def _hidden(self, camera: Camera, seen: Shown) -> Array:
        """(S,) share of each subject that is hidden, of the time that it is in the picture."""
        if self._look is None:
            return np.zeros(len(self.scenario.subjects))
        return self._look(camera, self.scenario, seen)

    def _taken_from(self, view: Camera) -> float:
        """What a view is worth for where it is taken from, of one as people stand, with the sun at their side.

        More with the sun behind the camera, less from above: there a fall is a ball that becomes smaller, and less
        through a wide lens: what is at the side of its picture is drawn out.
        """
        rise = math.degrees(math.asin((view.eye[2] - view.target[2]) / math.dist(view.eye, view.target)))
        from_above = STEEP * max(0.0, rise - LEVEL) / (90.0 - LEVEL)
        back, light = (np.array(way[:2]) for way in (np.subtract(view.eye, view.target), self._sun))
        shade = LIT * float(back @ light) / max(float(np.linalg.norm(back) * np.linalg.norm(light)), 1e-12)
        return (1.0 - from_above) * (1.0 - shade) * min(1.0, WIDE / view.fov)


def _side(view: Camera) -> tuple[str | None, ...]:
    """From where a view looks, through which lens, whatever it follows."""
    way = np.subtract(view.eye, view.target)
    return (view.follows, f"{view.fov:.0f}", *(f"{part:.2f}" for part in way / np.linalg.norm(way)))
