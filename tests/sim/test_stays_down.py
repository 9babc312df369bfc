"""No world lifts off: what starts on a floor or a ramp slides or rolls on it, in every world that the project shows."""

from pathlib import Path

import numpy as np
import pytest

from tests.skills.blocks import WHOLE
from wsim.program.compose import compose
from wsim.rules.planner import plan
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

ROOT = Path(__file__).parents[2]
SECONDS = 0.4
LIFTED = 1e-3  # [m]
SENTENCES = (
    "A concrete block slides across the floor at 3 m/s and hits a wall",
    "An ice block slides down a ramp of 20 degrees",
    "An oak cube slides down a 35 degree ramp",
    "A barrel slides across the floor at 4 m/s",
    "A ball rolls at 3 m/s",
    "A steel ball rolls down a wooden ramp",
    "A box is pushed to the left at 2 m/s",
)


def _programs() -> dict[str, str]:
    """Every example, every whole program of a skill, the last program of every transcript."""
    last = {path.parents[1]: path for path in sorted(ROOT.glob("tests/transcripts/*/iterations/*/program.py"))}
    files = [*sorted((ROOT / "examples").glob("*.py")), *last.values()]
    found = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in files}
    return found | {block.name: block.program for block in WHOLE}


def _built(text: str, path: Path) -> Path | None:
    """The stage of a program; None where it has a fluid, beside which little slides and a second takes minutes."""
    names: dict = {"__name__": "program"}
    scene = Scene()
    exec(compile(text, "program.py", "exec"), names)  # ours: no program of a stranger
    names["build"](scene)
    stage = scene.save(path)
    return None if describe(stage).fluids else stage


class Watch:
    """Loose bodies that touch nothing but what lies still on one side of them, and how far they leave it [m]."""

    def __init__(self, stage: Path) -> None:
        self.simulation = Simulation(stage, "cpu")
        self.data, self.model = self.simulation.rigid.solver.mj_data, self.simulation.rigid.solver.mj_model
        self.start: dict[int, tuple[tuple, np.ndarray]] = {}  # body: the side that it is on, its place
        self.worst: dict[str, float] = {}

    def _touched(self) -> dict[int, dict[tuple, float]]:
        """The gaps between each body and what it touches: bodies, and sides of static objects by their normals."""
        found: dict[int, dict[tuple, float]] = {}
        for k in range(self.data.ncon):
            contact = self.data.contact[k]
            a, b = (int(self.model.geom_bodyid[geom]) for geom in contact.geom)
            for body, other, sign in ((b, a, 1.0), (a, b, -1.0)):
                side = (other,) if other else tuple(np.round(sign * contact.frame[:3], 1) + 0.0)
                gaps = found.setdefault(body, {})
                gaps[side] = min(gaps.get(side, 1.0), float(contact.dist))
        return found

    def _begin(self, touched: dict[int, dict[tuple, float]]) -> None:
        """Note what starts on one side of static objects, and is not thrown off it."""
        for joint in np.flatnonzero(self.model.jnt_type == 0):
            body, first = int(self.model.jnt_bodyid[joint]), int(self.model.jnt_dofadr[joint])
            sides = touched.get(body, {})
            for side, gap in sides.items() if len(sides) == 1 else ():
                if len(side) == 3 and gap < LIFTED and self.data.qvel[first : first + 3] @ np.array(side) < 0.1:
                    self.start[body] = (side, self.data.xipos[body].copy())

    def run(self) -> dict[str, float]:
        """How far each body was lifted off what it started on, until it touched something else."""
        for k in range(round(SECONDS / self.simulation.dt)):
            self.simulation.step()
            touched = self._touched()
            if k == 0:
                self._begin(touched)
            for body, (side, place) in list(self.start.items()):
                now = touched.get(body, {})
                if set(now) - {side}:
                    del self.start[body]  # something else may throw it from now on
                    continue
                rise = float((self.data.xipos[body] - place) @ np.array(side))  # of its middle, not as it tips
                name = self.model.body(body).name
                self.worst[name] = max(self.worst.get(name, 0.0), min(rise, now.get(side, rise)))
        return self.worst


def test_nothing_lifts_off_in_the_worlds_that_the_project_shows(tmp_path: Path) -> None:
    programs = _programs() | {sentence: compose(plan(sentence)) for sentence in SENTENCES}
    watched, lifted = 0, {}
    for k, (name, text) in enumerate(programs.items()):
        stage = _built(text, tmp_path / f"{k}.usda")  # a name of its own: USD keeps open layers by their path
        if stage is not None:
            for body, height in Watch(stage).run().items():
                watched += 1
                if height > LIFTED:
                    lifted[f"{name}: {body}"] = height
    assert watched > 20 and not lifted


@pytest.mark.parametrize("gravity", [-9.81, 0.5])
def test_the_watch_sees_what_lifts_off(tmp_path: Path, gravity: float) -> None:
    """A crate slides, or is drawn up at 0.5 m/s^2."""
    scene = Scene()
    scene.simulation(gravity=(0, 0, gravity))
    scene.ground()
    scene.box("crate", size=(0.3, 0.3, 0.3), density=300, position=(0, 0, 0.15), velocity=(2, 0, 0))
    (height,) = Watch(scene.save(tmp_path / "stage.usda")).run().values()
    assert height == pytest.approx(max(0.5 * gravity * SECONDS**2, 0.0), rel=0.01, abs=1e-5)
