"""The law of a pair: stated once, of two objects that meet, in range; read back, and checked where a stage is."""

from pathlib import Path

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.contact import curvature, pair_law, pair_laws
from wsim.scene.describe import describe
from wsim.scene.errors import SceneError
from wsim.scene.world import Contact, Shape, World


@pytest.fixture
def scene():
    made = Scene()
    made.ground(friction=0.8)
    made.box("wall", size=(1, 1, 1), position=(5, 0, 0.5), static=True)
    made.sphere("ball", radius=0.1, position=(0, 0, 1), mass=1.0, restitution=0.2)
    made.sphere("marble", radius=0.2, position=(1, 0, 1), material=made.material("steel", rolling=0.001))
    return made


def test_it_is_on_the_stage(scene, tmp_path):
    scene.contact("ball", "ground", friction=0.3, rolling=0.02)
    path = scene.save(tmp_path / "world.usda")
    assert check_stage(path, [tmp_path]) == []
    (contact,) = describe(path).contacts
    assert (contact.first, contact.second) == ("/World/ball", "/World/ground")
    assert (contact.friction, contact.restitution, contact.rolling) == (0.3, None, 0.02)
    assert contact.line and contact.line.startswith("test_contacts.py:")


def test_what_is_not_given_the_materials_decide(scene):
    scene.contact("ground", "ball", friction=0.3)
    world = describe(scene.stage)
    ball, marble = (body.shapes[0] for body in world.bodies)
    ground = next(each.shapes[0] for each in world.statics if each.prim == "/World/ground")
    for pair in (pair_law(world, ball, ground), pair_law(world, ground, ball)):
        assert (pair.friction, pair.restitution, pair.rolling) == pytest.approx((0.3, 0.2, 0.0))
    other = pair_law(world, marble, ground)
    assert (other.friction, other.restitution, other.rolling) == pytest.approx((0.8, 0.0, 0.001))
    assert pair_law(world, marble, ball).rolling == 0.001  # the larger counts; one that states none leaves it


def test_the_softer_surface_resists(scene):
    scene.box("sand", size=(1, 1, 0.1), static=True, rolling_friction=0.3)
    world = describe(scene.stage)
    sand = next(each.shapes[0] for each in world.statics if each.prim == "/World/sand")
    assert pair_law(world, sand, world.bodies[1].shapes[0]).rolling == 0.3
    assert curvature(sand, moves=False) == 0.0
    assert curvature(world.bodies[1].shapes[0], moves=True) == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("a", "b", "given", "says"),
    [
        ("bal", "ground", {"friction": 0.1}, 'a = "bal" is not in the scene; did you mean "ball"?'),
        ("ball", "ball", {"friction": 0.1}, 'a = "ball", b = "ball": a pair is two objects'),
        ("wall", "ground", {"friction": 0.1}, 'a = "wall", b = "ground": both are static or kinematic'),
        ("ball", "wall", {"rolling": -0.1}, "rolling = -0.1 must be >= 0"),
        ("ball", "wall", {"restitution": 1.2}, "restitution = 1.2 must be <= 1"),
        ("ball", "wall", {"friction": float("nan")}, "friction = nan must be finite"),
        ("ball", "wall", {}, "nothing is given; give friction, restitution or rolling"),
        ("marble", "ball", {"friction": 0.1}, "the pair is stated a second time"),
        ("Looks/steel", "ball", {"friction": 0.1}, 'a = "steel" has no surface that collides'),
    ],
)
def test_a_mistake_is_one_clear_line(scene, a, b, given, says):
    scene.contact("ball", "marble", restitution=0.9)
    with pytest.raises(SceneError) as error:
        scene.contact(a, b, **given)
    assert says in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("wsim:rolling = 0.02", "wsim:rolling = -0.02", "ball_ground.wsim:rolling: -0.02 must be >= 0"),
        ("wsim:rolling = 0.001", "wsim:rolling = 2", "steel.wsim:rolling: 2 must be <= 1"),
        ("second = </World/ground>", "second = </World/ball>", "a pair is two objects"),
        ("second = </World/ground>", "second = </World/nothing>", "</World/nothing> is not there"),
        ("second = </World/ground>", "second = </World/marble>", "the pair is stated in"),
        ("second = </World/ground>", "second = [</World/wall>, </World/ground>]", "names 2 objects; it must name one"),
        ("second = </World/ground>", "second = </World/Looks/steel>", "is a Material; it must be something that"),
        ("first = </World/ball>\n", "first = </World/wall>\n", "is static or kinematic, as wsim:first is"),
        ("wsim:restitution = 0.9", "wsim:spring = 0.9", "states nothing; give wsim:friction"),
    ],
)
def test_a_stage_written_by_hand_is_checked(scene, tmp_path: Path, old, new, says):
    scene.contact("ball", "ground", rolling=0.02)
    scene.contact("ball", "marble", restitution=0.9)
    path = scene.save(tmp_path / "world.usda")
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert any(says in problem for problem in check_stage(path, [tmp_path]))


@pytest.mark.parametrize("combine", ["smaller", "larger"])
def test_the_laws_of_many_pairs_are_those_of_each(combine: str) -> None:
    values = [(None, None, None), (0.3, None, 0.01), (0.6, 0.2, None), (0.6, 0.9, 0.02), (0.0, 0.0, 0.0)]
    shapes = [
        Shape(prim=f"/World/{k}", kind="sphere", size=(1.0,), friction=mu, restitution=e, rolling=rolling)
        for k, (mu, e, rolling) in enumerate(values)
    ]
    world = World(
        name="World",
        contacts=[Contact(prim="/World/pair", first="/World/3", second="/World/1", friction=0.05)],
        combine=combine,
    )
    for own in (world, world.model_copy(update={"contacts": []})):
        laws = [[pair_law(own, a, b) for b in shapes] for a in shapes]
        want = np.array([[(law.friction, law.restitution, law.rolling) for law in row] for row in laws])
        assert np.array_equal(pair_laws(own, shapes), want)
