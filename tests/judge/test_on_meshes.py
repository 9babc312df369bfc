"""Faults planted in what moves on static meshes: on a track, and on a height field."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.test_turned import failing, simulated
from tests.judge.theory import ask, edited
from wsim.judge.checks.forces import CheckForces

SLOPE = math.radians(20.0)


def rolls(scene):
    scene.track("run", pieces=[("line", 3.0)], start=(0, 0, 1), slope_deg=-5, profile="round", width=0.16, friction=0.5)
    a = math.radians(5.0)
    scene.sphere("ball", radius=0.05, position=(0.3, 0, 1 - 0.3 * math.tan(a) + 0.05 / math.cos(a)), friction=0.5)


def rolls_on_rods(scene):
    """A ball of 6 cm on rods of 1 cm, 4 cm apart, so steep that its rolling takes 0.14 of what presses."""
    rods = {"profile": "rails", "width": 0.04, "thickness": 0.01, "friction": 0.5}
    track = scene.track("run", pieces=[("line", 2.0)], start=(0, 0, 1), slope_deg=-25, **rods)
    at = track.place(0.1, math.sqrt(0.035**2 - 0.02**2))
    scene.sphere("ball", radius=0.03, density=2000, friction=0.5, position=at)


def slides(scene):
    scene.height_field("slope", heights=lambda x, y: x * math.tan(SLOPE), size=(8, 4), cells=(40, 20), friction=0.2)
    at = (2 - 0.15 * math.sin(SLOPE), 0, 2 * math.tan(SLOPE) + 0.15 * math.cos(SLOPE))
    scene.box("crate", size=(0.3,) * 3, density=400, position=at, rotation_deg=(0, -20, 0), friction=0.2)


def waves(scene):
    """A ball in a trough and a box across one, on ground whose bend changes along a cell of a seventh of a wave."""
    scene.height_field("land", size=(3.5, 2.2), cells=(48, 30), friction=0.4, thickness=0.2,
                       heights=lambda x, y: 0.11 * math.sin(4.8 * x))  # fmt: skip
    scene.sphere("ball", radius=0.11, density=400, position=(0.41, 0.5, 0.225), friction=0.6)
    scene.box("crate", size=(0.22, 0.18, 0.11), density=600, position=(0.7, -0.3, 0.1), friction=0.4,
              rotation_deg=(0, 28, 0), velocity=(1.5, 0, -0.8))  # fmt: skip


def stated(recording, **surface):
    """Beside a world whose surfaces have other coefficients, each by so many times its own."""

    def changed(item):
        shapes = [s.model_copy(update={name: (getattr(s, name) or 0.0) * by for name, by in surface.items()})
                  for s in item.shapes]  # fmt: skip
        return item.model_copy(update={"shapes": shapes})

    world = recording.world
    both = {name: [changed(item) for item in getattr(world, name)] for name in ("bodies", "statics")}
    return replace(recording, world=world.model_copy(update=both))


def test_waves_lead_what_rolls_and_slides_as_their_bend_goes(tmp_path):
    """The push is square to the curve that its triangles stand for; friction leans as a box's corners do there."""
    sound = simulated(tmp_path, waves, 0.8, rate=120)
    for run in (sound, replace(sound, contacts=None)):
        assert failing(run) == set()
        lighter = run.world.model_copy(update={"gravity": (0.0, 0.0, -0.9 * 9.81)})
        assert {"CheckEnergy", "CheckForces"} & failing(replace(run, world=lighter))
        for by in (0.9, 1.1):
            assert {"CheckForces", "CheckRecordedForces"} & failing(stated(run, friction=by))


def test_a_ball_beside_its_track_is_carried_by_nothing(tmp_path):
    sound = simulated(tmp_path, rolls, 1.0)
    assert failing(sound) == set()
    assert failing(edited(sound, "body_q", (slice(None), 0, 1), 0.3)) == {
        "CheckForces",
        "CheckRecordedForces",
        "CheckStart",
        "CheckSupport",
    }


def test_rods_carry_a_ball_and_hold_it_by_their_friction(tmp_path):
    sound = simulated(tmp_path, rolls_on_rods, 0.5)
    for run in (sound, replace(sound, contacts=None)):
        assert failing(run) == set()
        assert "CheckForces" in failing(edited(run, "body_q", (slice(None), 0, 2), 0.01))
        shapes = [body.shapes[0].model_copy(update={"friction": 0.1}) for body in run.world.bodies]
        bodies = [body.model_copy(update={"shapes": [s]}) for body, s in zip(run.world.bodies, shapes, strict=True)]
        slippery = [
            still.model_copy(update={"shapes": [s.model_copy(update={"friction": 0.1}) for s in still.shapes]})
            for still in run.world.statics
        ]
        world = run.world.model_copy(update={"bodies": bodies, "statics": slippery})
        assert "CheckForces" in failing(replace(run, world=world))


def test_a_crate_that_hovers_or_slides_up_a_height_field_is_found(tmp_path):
    sound = simulated(tmp_path, slides, 1.0)
    assert failing(sound) == set()
    assert failing(edited(sound, "body_q", (slice(None), 0, 2), 0.1)) == {
        "CheckForces",
        "CheckRecordedEnergy",
        "CheckRecordedForces",
        "CheckStart",
        "CheckSupport",
    }
    q, qd = sound.body_q.copy(), sound.body_qd.copy()
    q[:, 0, :3] = 2 * q[0, 0, :3] - q[:, 0, :3]
    qd[:, 0, :3] *= np.float32(-1)
    assert "CheckEnergy" in failing(replace(sound, body_q=q, body_qd=qd))


# ---- a slab of 1 cm
DOWN, FRICTION = math.radians(20.0), 0.15


def sled(friction):
    def build(scene):
        track = scene.track("run", pieces=[("line", 2.5)], start=(0, 0, 1), slope_deg=-20, profile="flat", width=0.4,
                            friction=0.9)  # fmt: skip
        scene.box("sled", size=(0.15, 0.1, 0.05), position=track.place(0.15, 0.0255), rotation_deg=(0, 20, 0),
                  density=500, friction=friction)  # fmt: skip

    return build


def without_contacts(recording, world):
    return replace(recording, world=world, contacts=None, ties=None)


def test_a_slabs_underside_does_not_draw_a_sled_down_to_brake_it(tmp_path):
    """Friction a fifth too great is 0.03 m g cos(20) that nothing gives; drawn down, friction would be any."""
    sound, slow = (simulated(tmp_path / str(mu), sled(mu), 1.0) for mu in (FRICTION, 1.2 * FRICTION))
    assert failing(without_contacts(sound, sound.world)) == set()
    assert failing(without_contacts(slow, slow.world)) == set()
    found = [f for f in ask(CheckForces(), without_contacts(slow, sound.world)) if not f.passed]
    missing = 0.2 * FRICTION * slow.world.bodies[0].mass * 9.81 * math.cos(DOWN)
    assert [f.value for f in found if f.unit == "N"] == [pytest.approx(missing, rel=0.05)]
