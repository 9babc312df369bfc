"""A cable is one thing to who looks at it; other chains are as many things as they have bodies."""

from __future__ import annotations

from pathlib import Path

from wsim.judge.evidence.strands import strands
from wsim.scene import Scene
from wsim.scene.describe import describe


def test_the_links_of_a_cable_are_one_thing(tmp_path: Path) -> None:
    scene = Scene()
    scene.box("load", size=(0.1, 0.1, 0.1), mass=1.0, position=(0.0, 0.0, 0.0))
    scene.cable("line", None, "load", anchor_a=(0.0, 0.0, 1.05), anchor_b=(0.0, 0.0, 0.05), links=12)
    scene.cable(
        "other", None, None, anchor_a=(1.0, 0.0, 1.0), anchor_b=(2.0, 0.0, 1.0), length=1.2, links=9, loose=False
    )
    scene.capsule("upper", radius=0.04, height=0.3, position=(4.0, 0.0, 1.0))
    scene.capsule("lower", radius=0.03, height=0.3, position=(4.0, 0.0, 0.5))
    scene.joint_spherical("elbow", "upper", "lower", anchor=(4.0, 0.0, 0.75))
    found = strands(describe(scene.save(tmp_path / "stage.usda")))
    assert sorted(len(thing) for thing in found) == [1, 1, 1, 9, 12]
    assert sorted(body.prim for thing in found if len(thing) == 1 for body in thing) == [
        "/World/load", "/World/lower", "/World/upper"
    ]  # fmt: skip


def test_a_vehicle_is_one_thing(tmp_path: Path) -> None:
    """What is between its wheels and its springs meets nothing, and is hidden behind the wheels."""
    scene = Scene()
    scene.vehicle("car", "car")
    scene.box("crate", size=(0.1, 0.1, 0.1), position=(5.0, 0.0, 0.0))
    found = strands(describe(scene.save(tmp_path / "stage.usda")))
    assert sorted(len(thing) for thing in found) == [1, 11]


def test_what_is_fixed_for_good_is_one_thing(tmp_path: Path) -> None:
    """A door with its handle; not a bob on a hook that may break, nor one that is let go."""
    scene = Scene()
    for k, name in enumerate(("door", "handle", "beam", "bob", "arm", "load")):
        scene.box(name, size=(0.1, 0.1, 0.1), position=(0.1 * k, 0.0, 1.0))
    scene.joint_fixed("screws", "door", "handle")
    scene.joint_fixed("hook", "beam", "bob", break_force=50.0)
    grip = scene.joint_fixed("grip", "arm", "load")
    scene.schedule("drop", grip, "release", times=(1.0,))
    found = strands(describe(scene.save(tmp_path / "stage.usda")))
    assert sorted([body.prim[7:] for body in thing] for thing in found) == [
        ["arm"], ["beam"], ["bob"], ["door", "handle"], ["load"]
    ]  # fmt: skip


def test_a_cart_is_one_thing_with_its_wheels(tmp_path: Path) -> None:
    """From the side its far wheels are behind the others; two cranks that differ are two things more."""
    scene = Scene()
    scene.box("cart", size=(1.0, 0.4, 0.1), mass=10.0, position=(0.0, 0.0, 0.3))
    for k, (x, y) in enumerate(((-0.4, -0.3), (-0.4, 0.3), (0.4, -0.3), (0.4, 0.3))):
        scene.cylinder(f"wheel_{k}", radius=0.1, height=0.04, axis="Y", mass=1.0, position=(x, y, 0.2))
        scene.joint_revolute(f"axle_{k}", "cart", f"wheel_{k}", axis="Y", anchor=(x, y, 0.2))
    for k, radius in enumerate((0.05, 0.08)):
        scene.cylinder(f"crank_{k}", radius=radius, height=0.02, axis="Y", mass=1.0, position=(0.1 * k, 0.0, 0.5))
        scene.joint_revolute(f"pin_{k}", "cart", f"crank_{k}", axis="Y", anchor=(0.1 * k, 0.0, 0.5))
    found = strands(describe(scene.save(tmp_path / "stage.usda")))
    assert sorted(len(thing) for thing in found) == [1, 1, 5]
