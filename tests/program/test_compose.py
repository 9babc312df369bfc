from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from pydantic import ValidationError

from wsim.assets import get
from wsim.errors import UserError
from wsim.plan.schema import (
    Assumption,
    CameraPlan,
    External,
    FromAsset,
    Joint,
    Material,
    Objective,
    Plan,
    PlanObject,
    Pose,
    Proxy,
    Registration,
    Relation,
    SimulationPlan,
)
from wsim.program.compose import compose
from wsim.program.sandbox import build
from wsim.scene.describe import describe

WOOD = Material(name="wood", density=600.0, friction=0.4, restitution=0.1, color=(0.5, 0.27, 0.11))
PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"


def _tank_plan(**changes: object) -> Plan:
    blocks = [
        PlanObject.proxy(
            name=f"block_{i}",
            role="rigid_body",
            primitive="box",
            size=(0.3, 0.3, 0.2),
            material=WOOD,
            pose=Pose(position=(x, 0.0, 0.75)),
        )
        for i, x in enumerate((-0.5, 0.1 + 0.2 - 0.3, 0.5))
    ]
    water = PlanObject.proxy(
        name="water",
        role="fluid",
        primitive="fluid",
        state="fluid",
        relations=[
            Relation(predicate="PLACE-IN", ref="tank"),
            Relation(predicate="FREE-SURFACE-AT", value=0.6),
        ],
    )
    tank = PlanObject.proxy(
        name="tank",
        role="container",
        primitive="tank",
        size=(2.0, 1.0, 1.0),
        state="static",
        pose=Pose(position=(0.0, 0.0, 0.0)),
    )
    values: dict[str, object] = {
        "title": "Three wooden blocks float in a glass tank",
        "prompt": "three wooden blocks float in a glass tank",
        "objects": [water, *blocks, tank],
        "cameras": [CameraPlan(name="side", eye=(0.0, -4.0, 1.5), target=(0.0, 0.0, 0.5))],
        "simulation": SimulationPlan(duration=4.0, spacing=0.05),
        **changes,
    }
    return Plan.model_validate(values)


EXPECTED = '''"""Three wooden blocks float in a glass tank."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    """Author the world."""
    wood_density = scene.param(
        "wood_density",
        600.0,
        low=300.0,
        high=900.0,
        unit="kg/m^3",
    )
    wood = scene.material(
        "wood",
        density=wood_density,
        friction=0.4,
        restitution=0.1,
        color=(0.5, 0.27, 0.11),
    )

    for i, x in enumerate((-0.5, 0.0, 0.5)):
        scene.box(
            f"block_{i}",
            size=(0.3, 0.3, 0.2),
            position=(x, 0.0, 0.75),
            material=wood,
        )
    tank = scene.tank("tank", inner_size=(2.0, 1.0, 1.0))
    scene.fluid("water", fills=tank, level=0.6, spacing=0.05)
    scene.camera("side", eye=(0.0, -4.0, 1.5), target=(0.0, 0.0, 0.5))
    scene.simulation(duration=4.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
'''


def test_it_reads_as_a_person_would_write_it() -> None:
    assert compose(_tank_plan()) == EXPECTED


def test_a_fluids_own_density_comes_before_its_materials() -> None:
    plan = _tank_plan()
    plan.object("water").material = Material(name="water", density=1000.0, color=(0.1, 0.2, 0.3))
    assert "density=1000.0, color=(0.1, 0.2, 0.3)" in " ".join(compose(plan).split())
    plan.object("water").registration.density = 1025.0
    assert "density=1025.0, color=(0.1, 0.2, 0.3)" in " ".join(compose(plan).split())


def test_fluids_on_each_other_are_filled_from_below_with_their_own_law(tmp_path: Path) -> None:
    """Oil stands in the plan before the water that it lies on."""
    plan = _tank_plan()
    relations = [Relation(predicate="PLACE-IN", ref="tank"), Relation(predicate="FREE-SURFACE-AT", value=0.8)]
    own = Registration(density=900.0, viscosity=0.5, yield_stress=5.0, flow_index=0.8)
    mud = PlanObject.proxy(
        name="mud", role="fluid", primitive="fluid", state="fluid", relations=relations, registration=own
    )
    floating = [item for item in plan.objects if item.primitive != "box"]
    world = _world(compose(plan.model_copy(update={"objects": [mud, *floating]})), tmp_path)
    water, over = (next(each for each in world.fluids if each.prim.endswith(name)) for name in ("water", "mud"))
    assert over.center[2] - over.size[2] / 2 == pytest.approx(water.center[2] + water.size[2] / 2)
    assert (over.density, over.viscosity, over.yield_stress, over.flow_index) == (900.0, 0.5, 5.0, 0.8)


def test_the_same_plan_gives_the_same_text() -> None:
    assert compose(_tank_plan()) == compose(Plan.model_validate_json(_tank_plan().model_dump_json()))


def _solids() -> list[PlanObject]:
    """One object of every kind, with names that Python keeps for itself."""
    steel, paint = Material(name="Stahl (ä)", density=7850.0), Material(name="2 coats", density=1.0, opacity=0.5)
    turned = Pose(position=(0.0, 2.0, 1.0), rotation_deg=(0.0, 90.0, 0.0))
    return [
        PlanObject.proxy(name="ground", role="terrain", primitive="ground", state="static", material=paint),
        PlanObject.proxy(
            name="scene",
            role="rigid_body",
            primitive="sphere",
            size=(0.1,),
            material=steel,
            velocity=(1.0, 0.0, 0.00015),
            pose=Pose(position=(0.0, 0.0, 1.0)),
        ),
        PlanObject.proxy(
            name="class", role="rigid_body", primitive="cylinder", size=(0.1, 0.3), material=WOOD, pose=turned
        ),
        PlanObject.proxy(
            name="i",
            role="rigid_body",
            primitive="capsule",
            size=(0.1, 0.3),
            material=WOOD.model_copy(update={"color": (1.0, 0.0, 0.0)}),
            pose=Pose(position=(1 / 3, 4.0, 1.0)),
        ),
        PlanObject.proxy(
            name="step",
            role="terrain",
            primitive="box",
            size=(1.0, 1.0, 0.1),
            state="static",
            pose=Pose(position=(5.0, 0.0, 0.05)),
        ),
        PlanObject.proxy(
            name="drop",
            role="fluid",
            primitive="fluid",
            size=(0.2, 0.2, 0.2),
            state="fluid",
            pose=Pose(position=(8.0, 0.0, 0.5)),
            velocity=(1.0, 0.0, -0.5),
            material=Material(name="oil", density=900.0),
        ),
        *(
            PlanObject.proxy(
                name=f"ball_{i + 1}",
                role="rigid_body",
                primitive="sphere",
                size=(0.05,),
                material=steel,
                pose=Pose(position=(0.2 * (i % 5), 10.0 + 0.2 * (i // 5), 0.05)),
            )
            for i in range(20)
        ),
    ]


def _world(text: str, folder: Path):
    program = folder / "program.py"
    program.write_text(text)
    result = build(program, folder / "stage.usda", isolation="none")
    assert result.ok, f"{result.message}\n{result.log}\n{text}"
    return describe(folder / "stage.usda")


def test_what_it_builds_is_what_was_planned(tmp_path: Path) -> None:
    plan = Plan(title="All", prompt="", objects=_solids(), simulation=SimulationPlan(duration=2.5, frame_rate=60.0))
    world = _world(compose(plan), tmp_path)
    bodies = {body.prim.rsplit("/", 1)[-1]: body for body in world.bodies}
    dynamic = [item for item in plan.objects if item.state == "dynamic"]
    assert sorted(bodies) == sorted(item.name for item in dynamic)
    for item in dynamic:
        assert item.pose is not None
        assert item.material is not None
        body = bodies[item.name]
        assert body.position == pytest.approx(item.pose.position, abs=1e-6)
        assert body.mass == pytest.approx(item.material.density * body.volume, rel=1e-6)
        assert body.shapes[0].kind == item.primitive
        assert body.shapes[0].color == pytest.approx(item.material.color)
        assert body.velocity == pytest.approx(item.velocity)
    assert {static.prim for static in world.statics} == {"/World/ground", "/World/step"}
    assert (world.fluids[0].density, world.fluids[0].velocity) == (900.0, (1.0, 0.0, -0.5))
    assert (world.duration, world.frame_rate) == (2.5, 60.0)
    assert [parameter.default for parameter in world.parameters] == [7850.0, 600.0, 600.0]


HARMFUL = [
    'ends """ here\nimport os; os._exit(7)\n"""',
    "back\\slash \\N{BULLET} \\x41 \\",
    'a quote at the end"',
    "'''\n{__import__('os')._exit(7)}",
    "new\nline\r\nand \u2028 \u2029 \x0b \x0c \x85 separators",
    "\x00 nul, \u202e turned round, \ufeff",
    '"""',
    "",
    "# " + "long " * 200,
    "x" * 500,
]


@pytest.mark.parametrize("text", HARMFUL)
def test_text_of_the_plan_does_nothing(text: str, tmp_path: Path) -> None:
    words = [Assumption(subject=text, choice=text, why=text)]
    objectives = [Objective(kind="settles", object="block_0", sentence=text)]
    plan = _tank_plan().model_copy(
        update={"title": text, "prompt": text, "assumptions": words, "objectives": objectives}
    )
    plan.objects[1].words = text
    source = compose(plan)
    source.encode()
    tree, plain = ast.parse(source), ast.parse(EXPECTED)
    # The same but for the docstring, which `body[0]` is.
    assert [ast.dump(node) for node in tree.body[1:]] == [ast.dump(node) for node in plain.body[1:]]
    assert isinstance(ast.get_docstring(tree), str)
    if text.isprintable() or "\n" in text:
        _formatted(source, tmp_path)


@pytest.mark.parametrize("settings", [["--isolated"], ["--config", str(PYPROJECT)]])
def test_it_is_formatted_and_clean(settings: list[str], tmp_path: Path) -> None:
    plan = Plan(title="All", prompt="every kind of thing", objects=_solids())
    for source in (compose(_tank_plan()), compose(plan)):
        _formatted(source, tmp_path, settings)


def _formatted(source: str, folder: Path, settings: list[str] | None = None) -> None:
    program = folder / "program.py"
    program.write_text(source)
    for command in (["format", "--check", "--diff", "--no-cache"], ["check", "--no-cache"]):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, *(settings or ["--isolated"]), str(program)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr + source


def test_an_object_without_a_pose_is_a_users_mistake() -> None:
    plan = _tank_plan()
    plan.objects[1].pose = None
    with pytest.raises(UserError, match="block_0 has no pose"):
        compose(plan)


def _hinged(**changes: object) -> Plan:
    """A rod that hangs at 30 degrees from a hinge in the world, with a bob of 2 kg on it; and a bead on a slider."""
    turned = (0.0, -30.0, 0.0)
    steel = Material(name="steel", density=7850.0)
    values: dict[str, object] = {
        "title": "Hinged",
        "prompt": "",
        "objects": [
            PlanObject.proxy(
                name="rod",
                role="mechanism",
                primitive="cylinder",
                size=(0.01, 0.8),
                material=steel,
                pose=Pose(position=(0.2, 0.0, 1.0 - 0.4 * 3**0.5 / 2), rotation_deg=turned),
            ),
            PlanObject(
                name="bob",
                role="rigid_body",
                construction=External(candidate="a bob", stand_in=Proxy(primitive="sphere", size=(0.1,))),
                material=steel,
                registration=Registration(mass=2.0),
                pose=Pose(position=(0.45, 0.0, 1.0 - 0.9 * 3**0.5 / 2), rotation_deg=turned),
            ),
            PlanObject.proxy(
                name="bead",
                role="rigid_body",
                primitive="box",
                size=(0.1, 0.1, 0.1),
                material=steel,
                pose=Pose(position=(3.0, 0.0, 1.0)),
            ),
        ],
        "joints": [
            Joint(name="pivot", kind="hinge", child="rod", anchor=(0.0, 0.0, 0.4), axis="Y", limits=(-60.0, 60.0)),
            Joint(name="hold", kind="fixed", parent="rod", child="bob", anchor=(0.0, 0.0, 0.1)),
            Joint(name="rail", kind="slider", child="bead", axis="X", limits=(-1.0, 1.0)),
        ],
        **changes,
    }
    return Plan.model_validate(values)


def test_a_drive_that_saturates_is_built_so_and_written_in_the_plan(tmp_path: Path) -> None:
    drive = {"velocity": 30.0, "damping": 20.0, "max_force": 0.5}
    joints = [Joint.model_validate({**joint.model_dump(), "drive": None}) for joint in _hinged().joints]
    for saturates in (True, False):
        joints[0] = Joint.model_validate(
            {**joints[0].model_dump(), "drive": drive | ({"saturates": True} if saturates else {})}
        )
        plan = _hinged(joints=joints)
        assert ("saturates" in plan.model_dump_json()) == saturates
        assert ("saturates=True" in compose(plan)) == saturates
        world = _world(compose(plan), tmp_path)
        assert [joint.drive.saturates for joint in world.joints if joint.drive] == [saturates]
    with pytest.raises(ValidationError, match="saturates: true needs a max_force"):
        Joint.model_validate({**joints[0].model_dump(), "drive": {"damping": 1.0, "saturates": True}})


def test_joints_and_masses_are_built(tmp_path: Path) -> None:
    text = compose(_hinged())
    # Where the rod, turned, has its upper end.
    assert "anchor=(0.0, 0.0, 1.0)" in text and "limits_deg=(-60.0, 60.0)" in text
    world = _world(text, tmp_path)
    assert [(joint.kind, joint.parent, joint.child) for joint in world.joints] == [
        ("revolute", None, "/World/rod"),
        ("fixed", "/World/rod", "/World/bob"),
        ("prismatic", None, "/World/bead"),
    ]
    assert world.body("/World/bob").mass == pytest.approx(2.0)
    _formatted(text, tmp_path)


def test_an_asset_is_placed_as_the_catalogue_has_it(tmp_path: Path) -> None:
    desk = PlanObject(
        name="desk", role="rigid_body", construction=FromAsset(asset="desk"), pose=Pose(position=(1.0, 0.0, 0.0)),
        state="static",
    )  # fmt: skip
    mug = PlanObject(
        name="mug", role="rigid_body", construction=FromAsset(asset="mug"),
        pose=Pose(position=(1.0, 0.0, 0.74), rotation_deg=(0.0, 0.0, 90.0)),
    )  # fmt: skip
    text = compose(Plan(title="A mug on a desk", prompt="", objects=[desk, mug]))
    assert 'scene.asset("desk", "desk", position=(1.0, 0.0, 0.0), static=True)' in text
    world = _world(text, tmp_path)
    assert [body.prim for body in world.bodies] == ["/World/mug"]
    assert world.body("/World/mug").mass == pytest.approx(get("mug").mass, rel=0.01)
    _formatted(text, tmp_path)


def test_what_an_asset_has_of_its_own_is_refused_with_a_way_out() -> None:
    plan = _hinged(joints=[])
    plan.objects[2].construction = FromAsset(asset="mug")
    with pytest.raises(UserError, match=r"bead: an asset of the catalogue keeps its own material; .*proxy"):
        compose(plan)
