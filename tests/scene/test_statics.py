"""Tracks, height fields, compounds and round colliders: what is refused, and what is written."""

import math

import numpy as np
import pytest
import trimesh
from pxr import Gf, UsdGeom, UsdPhysics

from wsim.scene import Part, Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({}, "give pieces or points"),
        ({"pieces": [("line", 1.0)], "points": [(0, 0, 0), (1, 0, 0)]}, "give pieces or points"),
        ({"pieces": []}, "pieces = []"),
        ({"pieces": [("lien", 1.0)]}, "pieces[0]"),
        ({"pieces": [("line", 1.0), ("up", -0.5, 30.0)]}, "pieces[1] radius"),
        ({"pieces": [("up", 0.5, math.nan)]}, "pieces[0] angle"),
        ({"pieces": [("up", 0.5, 180.0), ("left", 0.5, 90.0)]}, "pieces[1]"),
        ({"pieces": [("left", 0.04, 90.0)], "width": 0.1}, "tighter"),
        ({"points": [(0, 0, 0)]}, "2 to 2000"),
        ({"points": [(0, 0, 0), (0, 0, 1)]}, "steeper"),
        ({"points": [(0, 0, 0), (0, 0, 0)]}, "0 m apart"),
        ({"pieces": [("line", 1.0)], "profile": "square"}, "profile"),
        ({"pieces": [("line", 1.0)], "profile": "rails", "width": 0.01, "thickness": 0.02}, "thickness"),
        ({"pieces": [("line", 1.0)], "slope_deg": 89.0}, "slope_deg"),
    ],
)
def test_a_track_that_cannot_be_is_refused(arguments, says):
    with pytest.raises(SceneError, match="track") as caught:
        Scene().track("t", **arguments)
    assert says in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"heights": [[0.0]], "size": (1, 1)}, "shape (1, 1)"),
        ({"heights": [[0, 0], [0, math.inf]], "size": (1, 1)}, "heights[1][1]"),
        ({"heights": [[0, 0], [0]], "size": (1, 1)}, "rows"),
        ({"heights": "flat", "size": (1, 1)}, "heights"),
        ({"heights": [[0, 0], [0, 0]], "size": 1.0}, "size"),
        ({"heights": lambda x, y: math.nan, "size": (1, 1)}, "heights(x, y)"),
        ({"heights": lambda x, y: 1.0 / (x - x), "size": (1, 1)}, "heights(-0.5, -0.5) raised ZeroDivisionError"),
        ({"heights": lambda x: x, "size": (1, 1)}, "give a function of x and y in m"),
        ({"heights": lambda x, y: 0.0, "size": (1, 1), "cells": (0, 5)}, "cells[0]"),
    ],
)
def test_a_field_that_cannot_be_is_refused(arguments, says):
    with pytest.raises(SceneError, match="height_field") as caught:
        Scene().height_field("f", **arguments)
    assert says in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([], "parts = []"),
        (["box"], "parts[0]"),
        ([Part("cube", size=(1, 1, 1))], "parts[0].shape"),
        ([Part("sphere")], "parts[0].radius"),
        ([Part("sphere", radius=0.1, size=(1, 1, 1))], "parts[0].size"),
        ([Part("sphere", radius=0.1, mass=1.0, density=2.0)], "give one"),
        ([Part("box", size=(1, 1, -1))], "parts[0].size[2]"),
    ],
)
def test_a_compound_that_cannot_be_is_refused(parts, says):
    with pytest.raises(SceneError, match="compound") as caught:
        Scene().compound("c", parts=parts)
    assert says in str(caught.value)


@pytest.mark.parametrize("profile", ["flat", "round", "rails"])
def test_a_track_is_a_closed_solid_of_its_section_and_length(tmp_path, profile):
    """Its volume is the section's times the line's length (Pappus), and its normals point out."""
    scene = Scene()
    pieces = [("line", 0.5), ("up", 0.6, 60.0), ("left", 0.8, 200.0), ("line", 0.3)]
    track = scene.track("t", pieces=pieces, slope_deg=-20.0, profile=profile, width=0.1, thickness=0.02)
    assert check_stage(scene.save(tmp_path / "s.usda"), [tmp_path]) == []
    shape = describe(scene.stage).statics[0].shapes[0]
    mesh = trimesh.Trimesh(shape.vertices, shape.triangles)
    corners = np.array(shape.vertices)[np.array(shape.triangles)]
    normals = np.array(shape.normals).reshape(-1, 3, 3)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    section = {"flat": 0.1 * 0.02, "round": math.pi / 2 * (0.07**2 - 0.05**2), "rails": 2 * math.pi * 0.01**2}[profile]
    assert shape.exact and mesh.is_watertight
    # Bends are lighter or heavier by the offset of the section's centre over their radius; rods are of 24 sides.
    assert mesh.volume == pytest.approx(section * track.length, rel=0.08)
    assert (np.einsum("fki,fi->fk", normals, flat) > 0).all()


def test_places_along_a_track():
    track = Scene().track("t", pieces=[("line", 1.0), ("up", 0.5, 90.0), ("loop", 0.2, 0.1)], start=(0, 0, 1))
    assert track.place(0.5, 0.1) == pytest.approx((0.5, 0, 1.1))
    assert track.place(1.0 + 0.25 * math.pi) == pytest.approx((1.5, 0, 1.5), abs=1e-9)
    assert track.direction(track.length) == pytest.approx((0, 0, 1), abs=1e-6)
    assert track.end == pytest.approx((1.5, 0.1, 1.5), abs=1e-6)
    with pytest.raises(SceneError, match="distance"):
        track.place(100.0)


def test_a_field_keeps_its_grid():
    scene = Scene()
    scene.height_field("f", heights=np.zeros((3, 5)), size=(2, 1))
    prim = scene.stage.GetPrimAtPath("/World/f/geometry")
    assert prim.GetAttribute("wsim:rows").Get() == 3 and prim.GetAttribute("wsim:columns").Get() == 5
    assert describe(scene.stage).statics[0].shapes[0].exact


@pytest.mark.parametrize(("scale", "fine"), [((1, 1, 1), True), ((2, 2, 2), True), ((1, 1, 2), False)])
def test_a_ball_scaled_unevenly_is_refused(tmp_path, scale, fine):
    scene = Scene()
    ball = UsdGeom.Sphere.Define(scene.stage, "/World/ball")
    ball.AddScaleOp().Set(Gf.Vec3f(*scale))
    UsdPhysics.CollisionAPI.Apply(ball.GetPrim())
    problems = check_stage(scene.save(tmp_path / "s.usda"), [tmp_path])
    assert (problems == []) == fine
    assert fine or ("scale" in problems[0] and "/World/ball" in problems[0])
