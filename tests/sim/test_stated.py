"""A batch by what descriptions state is the batch that Newton's importer makes, to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.sim.test_batch import Build, carried, held, led, loose
from tests.sim.test_numbers import _arrays, _stages
from wsim.scene import Drive, Scene
from wsim.scene.describe import describe
from wsim.sim import model
from wsim.sim.model import Built, build_batch
from wsim.sim.numbers import texts
from wsim.sim.stated import confirmed, numbers_of


def tub(scene: Scene, draw: np.random.Generator) -> None:
    """Fluids of several sizes, and a block that stands askew in one."""
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.4), wall=0.02)
    level, density = draw.uniform(0.1, 0.2), draw.uniform(900, 1100)
    scene.fluid("water", fills=tank, level=level, spacing=0.04, density=density)
    scene.box("block", size=(0.12, 0.12, draw.uniform(0.08, 0.12)), position=(0, 0, 0.3),
              density=draw.uniform(200, 800), rotation_deg=(0, 0, draw.uniform(0, 90)))  # fmt: skip


def dam(scene: Scene, draw: np.random.Generator) -> None:
    """No body at all."""
    scene.tank("tank", inner_size=(draw.uniform(0.4, 0.6), 0.2, 0.4))
    scene.fluid("water", size=(0.2, 0.2, 0.2), position=(-0.1, 0, 0.1), spacing=0.04, density=draw.uniform(900, 1100))


def turned(scene: Scene, draw: np.random.Generator) -> None:
    """Round bodies and a post, turned and thrown every way."""
    scene.ground()
    for k, add in enumerate((scene.cylinder, scene.capsule)):
        add(f"thrown_{k}", radius=draw.uniform(0.05, 0.1), height=draw.uniform(0.2, 0.4),
            position=(k, draw.uniform(), 1), density=draw.uniform(200, 800),
            rotation_deg=tuple(draw.uniform(-80, 80, 3)), velocity=tuple(draw.uniform(-1, 1, 3)),
            angular_velocity_deg=tuple(draw.uniform(-90, 90, 3)))  # fmt: skip
    scene.cylinder("post", radius=0.1, height=draw.uniform(0.2, 0.5), position=(2, 0, 0.2), static=True,
                   rotation_deg=(0, draw.uniform(0, 90), 30))  # fmt: skip


def driven(scene: Scene, draw: np.random.Generator) -> None:
    """Arms on hinges, a slider on one of them, a ball joint: masses, stops, friction and drives; and what is loose."""
    scene.ground(friction=draw.uniform(0.3, 0.8))
    scene.box("loose", size=(0.2, 0.2, 0.2), density=draw.uniform(200, 800), position=(3, draw.uniform(), 1))
    scene.box("arm", size=(0.5, 0.1, 0.1), density=draw.uniform(200, 800), position=(0.3, 0, 2))
    motor = Drive(position=draw.uniform(-20, 20), velocity=draw.uniform(-5, 5), stiffness=draw.uniform(10, 50),
                  damping=draw.uniform(1, 5), max_force=40.0)  # fmt: skip
    scene.joint_revolute("hinge", None, "arm", anchor=(0, 0, 2), axis="Y", drive=motor, friction=draw.uniform(0.1, 0.5),
                         limits_deg=(-90, draw.uniform(30, 60)))  # fmt: skip
    scene.box("slide", size=(0.1, 0.1, 0.1), mass=draw.uniform(0.5, 2), position=(0.7, 0, 2))
    scene.joint_prismatic("rail", "arm", "slide", axis="X", limits=(-0.1, draw.uniform(0.1, 0.2)),
                          drive=Drive(position=draw.uniform(0, 0.05), stiffness=draw.uniform(50, 90)))  # fmt: skip
    scene.sphere("bob", radius=0.1, density=draw.uniform(200, 800), position=(0, 2, 1))
    scene.joint_spherical("ball", None, "bob", anchor=(0, 2, 2))


def swung(scene: Scene, draw: np.random.Generator) -> None:
    """A rod that hangs from a hinge and starts elsewhere in each world."""
    scene.box("arm", size=(0.5, 0.1, 0.1), density=500.0, position=(draw.uniform(0.3, 0.4), 0, 2))
    scene.joint_revolute("hinge", None, "arm", anchor=(0, 0, 2), axis="Y")


def _both(folder: Path, build: Build, monkeypatch: pytest.MonkeyPatch) -> tuple[Built, Built]:
    """Made as it comes, and by imports alone."""
    stages = _stages(folder, build, 4)
    worlds = [describe(stage) for stage in stages]
    made = build_batch(stages, worlds, "cpu")

    def none(*_: object) -> None:
        raise model._UnstatedError("it is to be imported")

    with monkeypatch.context() as patched:
        patched.setattr(model, "_stated", none)
        imported = build_batch(stages, worlds, "cpu")
    return made, imported


@pytest.mark.parametrize("build", [loose, carried, turned, tub, dam, driven])
def test_it_is_the_imported_batch(tmp_path: Path, build: Build, monkeypatch: pytest.MonkeyPatch) -> None:
    made, imported = _both(tmp_path, build, monkeypatch)
    assert not made.singly
    assert imported.singly == "it is to be imported"
    told, want = (_arrays(each.model) for each in (made, imported))
    for own in (told, want):
        own.pop("particle_colors", None)  # Newton leaves as it finds them what no colouring has written to
    assert told == want
    assert (made.worlds, made.fluids, made.breakable) == (imported.worlds, imported.fluids, imported.breakable)
    assert (made.cylinders, made.time_step) == (imported.cylinders, imported.time_step)
    if made.sph:
        for name in ("pressure", "rest_density", "viscosity"):
            pair = [getattr(each.model.sph, name).numpy() for each in (made, imported)]
            assert np.array_equal(*pair)
            assert pair[0].any()


@pytest.mark.parametrize(
    ("build", "why"),
    [
        (held, "that close loops or break"),
        (led, "worlds have meshes, paths"),
        (swung, "differ in what no description states"),
    ],
)
def test_what_is_tied_or_led_is_imported_and_it_is_said_why(tmp_path: Path, build: Build, why: str) -> None:
    stages, told = _stages(tmp_path, build, 4), []
    built = build_batch(
        stages, [describe(stage) for stage in stages], "cpu", progress=lambda what, done, total: told.append(what)
    )
    assert why in built.singly
    assert any("one by one" in each and why in each for each in told)


def test_a_number_that_was_told_wrong_is_seen(tmp_path: Path) -> None:
    stages = _stages(tmp_path, loose, 2)
    worlds = [describe(stage) for stage in stages]
    first, other = (model._import(*each, None).builder for each in zip(stages, worlds, strict=True))
    told = numbers_of(first, worlds)
    assert told is not None
    assert confirmed(other, texts(first), told, 1)
    for name, numbers in told.items():
        wrong = numbers.copy()
        wrong[1] = np.nextafter(wrong[1], np.float32(np.inf))
        assert not confirmed(other, texts(first), {**told, name: wrong}, 1), name


def test_bodies_weigh_what_the_description_says(tmp_path: Path) -> None:
    stage = _stages(tmp_path, loose, 1)[0]
    world = describe(stage)
    builder = model._import(stage, world, None).builder
    for k, body in enumerate(world.bodies):
        assert builder.body_mass[k] == np.float32(body.mass)
        assert np.allclose(np.array(builder.body_inertia[k]).ravel(), body.inertia, rtol=1e-7, atol=0.0)
