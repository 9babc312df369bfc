"""What the index knows, held against the packages as they are installed."""

from __future__ import annotations

import inspect
import subprocess
import sys

import numpy as np
import pytest
from pxr import Gf, Usd, UsdPhysics

from wsim.errors import UserError
from wsim.program.api import Index
from wsim.scene import Drive, Fluid, Scene, Tank


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("hinge", "wsim.scene.Scene.joint_revolute"),
        ("door that swings", "wsim.scene.Scene.joint_revolute"),
        ("motor", "wsim.scene.Drive"),
        ("sweepable number", "wsim.scene.Scene.param"),
        ("thick liquid", "wsim.scene.Scene.fluid"),
        ("run longer", "wsim.scene.Scene.simulation"),
        ("mesh file", "wsim.scene.Scene.mesh"),
        ("push a body", "wsim.program.control_world.ControlWorld.apply_force"),
        ("where is the water surface", "wsim.scene.Fluid.surface"),
        ("restitution", "wsim.scene.Scene.contact"),  # what sets it, before what tells of it
        ("friction", "wsim.scene.Scene.contact"),
        ("rolling", "wsim.scene.Scene.material"),
        ("contact damping", "wsim.scene.Scene.contact"),
        ("bouncy", "wsim.scene.Scene.contact"),
        ("GetPrimAtPath", "pxr.Usd.Stage.GetPrimAtPath"),
        ("linspace", "numpy.linspace"),
        ("ModelBuilder add_body", "newton.ModelBuilder.add_body"),
    ],
)
def test_finds_by_words_and_by_meaning(api: Index, words: str, name: str) -> None:
    assert name in [hit.entry.name for hit in api.search(words, 5)]


@pytest.mark.parametrize("noun", ["chair", "mug", "table", "crate", "kitchen chair", "put a desk in the room"])
def test_a_thing_of_the_catalogue_leads_to_the_call_that_places_it(api: Index, noun: str) -> None:
    assert "wsim.scene.Scene.asset" in [hit.entry.name for hit in api.search(noun, 8)]


def test_half_a_character_finds_nothing(api: Index) -> None:
    assert api.search("\ud800") == []
    assert api.search("hinge \ud800")[0].entry.name == "wsim.scene.Scene.joint_revolute"


def test_how_heavy_finds_density_or_mass(api: Index) -> None:
    best = api.search("how heavy", 3)
    assert any(
        {"density", "mass"} & {p.name for p in hit.entry.parameters} or "density" in hit.entry.name for hit in best
    )


def test_hits_are_ordered_and_limited(api: Index) -> None:
    hits = api.search("box", 4)
    assert len(hits) == 4
    assert [hit.score for hit in hits] == sorted((hit.score for hit in hits), reverse=True)
    assert api.search("xyzzyqwv") == []


@pytest.mark.parametrize(
    ("short", "name"),
    [
        ("box", "wsim.scene.Scene.box"),
        ("Scene.box", "wsim.scene.Scene.box"),
        ("scene.box", "wsim.scene.Scene.box"),
        ("Drive", "wsim.scene.Drive"),
        ("MassAPI", "pxr.UsdPhysics.MassAPI"),
        ("Gf.Vec3d", "pxr.Gf.Vec3d"),
        ("np.linspace", "numpy.linspace"),
        ("physics:mass", "PhysicsMassAPI.physics:mass"),
        ("wsim:spacing", "WsimFluidAPI.wsim:spacing"),
        ("newton.ModelBuilder", "newton.ModelBuilder"),
    ],
)
def test_shows_by_short_names(api: Index, short: str, name: str) -> None:
    assert api.show(short).name == name


def test_an_unknown_name_is_told_with_the_nearest(api: Index) -> None:
    with pytest.raises(UserError, match=r"joint_revolut\b.*joint_revolute"):
        api.show("joint_revolut")


@pytest.mark.parametrize("cls", [Scene, Tank, Fluid, Drive])
def test_scene_signatures_are_those_that_python_has(api: Index, cls: type) -> None:
    for name, member in inspect.getmembers(cls):
        if name.startswith("_"):
            continue
        entry = api.show(f"wsim.scene.{cls.__name__}.{name}")
        if not inspect.isfunction(member):
            continue
        have = [p for p in inspect.signature(member).parameters.values() if p.name != "self"]
        assert [p.name for p in entry.parameters] == [p.name for p in have]
        assert [p.required for p in entry.parameters] == [p.default is p.empty for p in have]
        assert [p.kind == "keyword" for p in entry.parameters] == [p.kind is p.KEYWORD_ONLY for p in have]


def test_parameters_have_unit_and_meaning(api: Index) -> None:
    box = {p.name: p for p in api.show("box").parameters}
    assert box["size"].unit == "m"
    assert (box["density"].unit, box["mass"].unit) == ("kg/m^3", "kg")
    assert box["rotation_deg"].unit == "deg"
    assert "Roll" in box["rotation_deg"].meaning
    assert {p.name: p.unit for p in api.show("Drive").parameters}["stiffness"] == "N m/rad"
    assert {p.name: p.unit for p in api.show("joint_revolute").parameters}["anchor"] == "m"


def test_signature_is_written_as_python_has_it(api: Index) -> None:
    assert api.show("param").signature == (
        "Scene.param(name: str, default: float, *, low: float | None = None, high: float | None = None, "
        "unit: str = '') -> float"
    )


def test_usd_calls_have_the_arguments_that_the_bindings_take(api: Index) -> None:
    assert [p.name for p in api.show("UsdPhysics.DriveAPI.Apply").parameters] == ["prim", "name"]
    assert api.show("Usd.TimeCode.Default").overloads == ((),)
    assert api.show("UsdGeom.Cube.Define").returns == "pxr.UsdGeom.Cube"
    assert api.show("Usd.Stage.GetPrimAtPath").returns == "pxr.Usd.Prim"
    ways = {len(way) for way in api.show("Gf.Vec3d").overloads}
    for count in (0, 1, 3):
        assert count in ways
        Gf.Vec3d(*[1.0] * count)
    assert 2 not in ways
    with pytest.raises(Exception, match="did not match"):
        Gf.Vec3d(1.0, 2.0)


@pytest.mark.parametrize(
    "kind", [Usd.Prim, Usd.Stage, UsdPhysics.RevoluteJoint, Gf.Quatd, np.ndarray, np.random.Generator]
)
def test_classes_have_all_their_public_members(api: Index, kind: type) -> None:
    entry = api.show(f"{kind.__module__.partition('._')[0]}.{kind.__qualname__}")
    known = set().union(*(api.programs.children(each) for each in (entry.name, *entry.bases)))
    assert {name for name in dir(kind) if not name.startswith("_")} <= known


def test_schemas_of_usd_newton_and_wsim_are_there(api: Index) -> None:
    assert {"PhysicsMassAPI", "NewtonSceneAPI", "WsimFluidAPI"} <= set(api.programs.schemas())
    assert "drive:*:physics:damping" in api.programs.schema_attributes()
    assert api.show("physics:density").returns == "float"


def test_newton_and_warp_are_marked_as_not_for_programs(api: Index) -> None:
    assert not api.show("newton.ModelBuilder").programs
    assert not api.show("warp.quat_identity").programs
    assert api.show("box").programs


def test_schemas_are_whole_where_usd_has_read_its_own_before() -> None:
    code = (
        "from pxr import Usd; Usd.SchemaRegistry().FindConcretePrimDefinition('Cube')\n"
        "from wsim.program.api.sources import usd_schemas\n"
        "print(*(entry.name for entry in usd_schemas.entries()))"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert {"PhysicsMassAPI", "NewtonSceneAPI", "WsimFluidAPI"} <= set(done.stdout.split())
