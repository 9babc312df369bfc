"""Motions of another engine, plain MuJoCo: sound ones have forces behind them, and none of these faults has."""

import mujoco
import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.importers import read_npz
from wsim.judge.checks.forces import CheckForces

G, RATE = 9.81, 60.0
BOX = '<body pos="{x} 0 {z}" quat="{quat}"><freejoint/><geom type="box" size=".1 .1 .1" density="500"/></body>'
BALL = '<body pos="{x} 0 {z}"><freejoint/><geom type="sphere" size=".1" density="1000"/></body>'
ARM = """<body pos="0 0 1.5"><joint type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/>
  <body pos=".4 0 0"><joint type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 .1" size=".03"/></body>
</body>"""


def box(x=0.0, z=0.1, quat="1 0 0 0"):
    return BOX.format(x=x, z=z, quat=quat)


def ball(x=0.0, z=0.1):
    return BALL.format(x=x, z=z)


def model_of(bodies, friction):
    """A plane and bodies; contacts are asked for by their speed alone, as a slide's must not lift."""
    return f"""<mujoco><option timestep="0.0005" cone="elliptic" integrator="RK4"/>
      <default><geom friction="{friction} 0 0" solimp="0 0.95 0.001"/></default>
      <worldbody><geom type="plane" size="9 9 1"/>{bodies}</worldbody></mujoco>"""


class Motion:
    """A run of `seconds` [s] from the speeds of `start`, under a hook that may push."""

    def __init__(self, bodies, seconds=1.0, friction=0.4, start=(), push=None):
        self.bodies, self.friction = bodies, friction
        model = mujoco.MjModel.from_xml_string(model_of(bodies, friction))
        data = mujoco.MjData(model)
        data.qvel[: len(start)] = start
        self.time, self.q, self.v = [0.0], [data.qpos.copy()], [data.qvel.copy()]
        for k in range(1, round(seconds * RATE) + 1):
            while data.time < k / RATE - 1e-9:
                if push:
                    data.xfrc_applied[1, :3] = push(data.time) * model.body_mass[1] * G
                mujoco.mj_step(model, data)
            self.time.append(data.time)
            self.q.append(data.qpos.copy())
            self.v.append(data.qvel.copy())

    def findings(self, folder, friction=None, change=None):
        """What the check says of it, where the world states another friction, or what is recorded is changed."""
        time, q, v = (np.array(each) for each in (self.time, self.q, self.v))
        if change:
            change(q, v)
        (folder / "world.xml").write_text(model_of(self.bodies, friction or self.friction))
        np.savez(folder / "run.npz", time=time, qpos=q, qvel=v)
        return ask(CheckForces(), read_npz(folder / "run.npz", folder / "world.xml"))


def sideways(t):
    return np.array([0.0, 0.3 if 0.2 <= t < 0.3 else 0.0, 0.0])


SLIDE = {"bodies": box(), "start": (2.5, 0, 0)}
ROLL = {"bodies": ball(), "start": (2, 0, 0, 0, 20, 0)}
DROP = {"bodies": ball(z=2.0), "seconds": 0.6}
SOUND = {
    "a box slides": SLIDE,
    "a box tumbles": {"bodies": box(z=0.8, quat="0.9 0.3 0.2 0.1"), "seconds": 1.5},
    "four boxes stand": {"bodies": "".join(box(0.01 * k, 0.1 + 0.2 * k) for k in range(4))},
    "a ball skids and rolls": {"bodies": ball(), "start": (2, 0, 0)},
    "a ball rolls": ROLL,
    "a ball hits another": {"bodies": ball() + ball(1.0), "start": (2, 0, 0, 0, 20, 0)},
    "a box is held by friction": {"bodies": box(), "push": lambda t: np.array([0.2, 0.0, 0.0])},
    "two arms swing": {"bodies": ARM},
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_motion_has_its_forces(tmp_path, name):
    findings = Motion(**SOUND[name]).findings(tmp_path)
    assert len(findings) == 2
    assert [finding.message for finding in findings if not finding.passed] == []


def half_spin(q, v):
    v[:, 3:] *= 0.5


def weak_gravity(q, v):
    v[:, 2] *= 0.9


def hover(q, v):
    q[:, 2] += 0.03


def slow_swing(q, v):
    v *= 0.8


FAULTS = {
    "a third more friction than stated": (SLIDE, {"friction": 0.3}, 0.1, "N"),
    "a quarter less friction than stated": (SLIDE, {"friction": 0.52}, 0.1, "N"),
    "hovers by 3 cm": (SLIDE, {"change": hover}, 1.0, "N"),
    "a push of 0.3 g from the side": (DROP | {"push": sideways}, {}, 0.3, "N"),
    "a push of 0.2 g where friction is 0.1": (
        {"bodies": box(), "friction": 0.1, "push": lambda t: np.array([0.2, 0, 0])}, {}, 0.1, "N"),
    "rolls with half its spin": ({"bodies": ball(), "start": (2, 0, 0)}, {"change": half_spin}, 0.1, "N m"),
    "falls at 0.9 g": (DROP, {"change": weak_gravity}, 0.1, "N"),
    "swings too slowly": ({"bodies": ARM}, {"change": slow_swing}, 0.1, "N m"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_force_that_nothing_gives_is_found(tmp_path, name):
    """At least by the share of the weight that it has by theory, less the tolerance."""
    motion, read_as, share, unit = FAULTS[name]
    made = Motion(**motion)
    found = next(finding for finding in made.findings(tmp_path, **read_as) if finding.unit == unit)
    assert not found.passed
    weight = mujoco.MjModel.from_xml_string(model_of(made.bodies, 0.4)).body_mass[1] * G
    assert found.value > 0.85 * share * weight * (1.0 if unit == "N" else 0.1)
