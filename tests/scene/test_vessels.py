"""What a vessel of any shape holds, by level and by volume, and what is told of one that does not hold so much."""

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.sim import vessel_shapes as shapes
from wsim.scene import Handle, Scene, SceneError
from wsim.scene.describe import describe

SPACING = 0.01


def placed(folder: Path, mesh: object, scene: Scene | None = None, **given: object) -> tuple[Scene, Handle]:
    """A scene with a vessel that stands still."""
    mesh.export(folder / "vessel.stl")
    scene = scene or Scene()
    return scene, scene.mesh("vessel", file=folder / "vessel.stl", static=True, **given)


def ball_cap(radius: float, depth: float) -> float:
    return math.pi * depth**2 * (radius - depth / 3.0)


CASES = {
    "cup": (lambda: shapes.cup(0.05, 0.12, 0.004), 0.08, math.pi * 0.05**2 * 0.08),
    "sheet": (lambda: shapes.sheet_cup(0.05, 0.12), 0.08, math.pi * 0.05**2 * 0.08),
    "cone": (
        lambda: shapes.cup(0.03, 0.12, 0.004, 0.4), 0.08,
        math.pi * 0.08 * (0.03**2 + 0.03 * 0.062 + 0.062**2) / 3,
    ),
    "bowl": (lambda: shapes.bowl(0.07, 0.005), 0.05, ball_cap(0.07, 0.05)),
    "bottle": (lambda: shapes.bottle(0.05, 0.02, 0.15, 0.004), 0.09, math.pi * 0.05**2 * 0.09),
    "trough": (
        lambda: shapes.trough(0.05, 0.15, 0.005), 0.04,
        0.15 * (0.05**2 * math.acos(0.2) - 0.01 * math.sqrt(0.05**2 - 0.01**2)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_level_is_a_volume_and_back(tmp_path: Path, name: str) -> None:
    mesh, level, volume = CASES[name]
    scene, vessel = placed(tmp_path, mesh(), position=(0.3, 0.2, 0.5))
    water = scene.fluid("water", fills=vessel, level=level, spacing=SPACING)
    (found,) = describe(scene.stage).fluids
    assert found.volume == pytest.approx(volume, rel=0.03)  # a bowl and a pipe of flat faces hold less
    assert found.container == "/World/vessel"
    assert water.size[2] == pytest.approx(level, abs=1e-9)
    scene, vessel = placed(tmp_path, mesh(), position=(0.3, 0.2, 0.5))
    again = scene.fluid("water", fills="vessel", volume=found.volume, spacing=SPACING)
    assert again.surface == pytest.approx(water.surface, abs=0.02 * SPACING)


@settings(max_examples=8)
@given(st.floats(0.03, 0.08), st.floats(0.05, 0.15), st.floats(0.1, 0.5), st.floats(0.0, 360.0))
def test_tilted_it_holds_what_is_under_its_lowest_rim(
    tmp_path_factory: pytest.TempPathFactory, radius: float, height: float, share: float, yaw: float
) -> None:
    """A cylinder tilted by less than its diagonal holds pi r^2 (h - r tan a) at most."""
    angle = share * math.atan(height / (2.0 * radius))
    scene, vessel = placed(
        tmp_path_factory.mktemp("tilted"), shapes.cup(radius, height, 0.004), rotation_deg=(math.degrees(angle), 0, yaw)
    )
    most = math.pi * radius**2 * (height - radius * math.tan(angle))
    with pytest.raises(SceneError, match=r"volume = .* is more than \"vessel\" holds as it stands"):
        scene.fluid("water", fills=vessel, volume=1.06 * most, spacing=SPACING)
    scene.fluid("water", fills=vessel, volume=0.94 * most, spacing=SPACING)
    assert describe(scene.stage).fluids[0].volume == pytest.approx(0.94 * most, rel=1e-6)


def test_what_is_closed_all_round_holds_its_room(tmp_path: Path) -> None:
    import trimesh

    hollow = trimesh.util.concatenate([trimesh.creation.box((0.12, 0.12, 0.12)), _turned_in(0.1)])
    scene, vessel = placed(tmp_path, hollow)
    scene.fluid("water", fills=vessel, volume=0.5e-3, spacing=SPACING)
    assert describe(scene.stage).fluids[0].size[2] == pytest.approx(0.05, abs=0.1 * SPACING)


def _turned_in(edge: float) -> object:
    import trimesh

    inner = trimesh.creation.box((edge, edge, edge))
    inner.invert()
    return inner


def test_a_tank_is_filled_by_volume() -> None:
    scene = Scene()
    tank = scene.tank("tank", inner_size=(0.4, 0.3, 0.3))
    water = scene.fluid("water", fills=tank, volume=0.024, spacing=0.02)
    assert water.size == pytest.approx((0.4, 0.3, 0.2))
    assert describe(scene.stage).fluids[0].volume is None


def test_an_asset_is_filled() -> None:
    scene = Scene()
    mug = scene.asset("mug", "mug", static=True, position=(0.1, 0.0, 0.4))
    scene.fluid("tea", fills=mug, level=0.05, spacing=0.005)
    (found,) = describe(scene.stage).fluids
    assert found.container == "/World/mug"
    assert found.size[2] == pytest.approx(0.05)


REFUSED: list[tuple[dict[str, object], dict[str, object], str]] = [
    ({}, {"fills": "vessel", "level": 0.2}, 'level = 0.2 m is above the rim of "vessel"'),
    ({}, {"fills": "vessel", "volume": 0.1}, 'volume = 0.1 m^3 is more than "vessel"'),
    ({}, {"fills": "vessel", "level": 0.05, "spacing": 0.03}, 'spacing = 0.03 m is too coarse for "vessel"'),
    ({}, {"fills": "vessel"}, "fills is given without level"),
    ({}, {"fills": "vessel", "level": 0.1, "volume": 0.1}, "with level and volume"),
    ({}, {"volume": 0.1}, "volume = 0.1 needs fills="),
    ({"rotation_deg": (180, 0, 0)}, {"fills": "vessel", "level": 0.05}, 'fills = "vessel" holds no fluid as it stands'),
]


@pytest.mark.parametrize(("pose", "asked", "said"), REFUSED)
def test_what_a_vessel_does_not_hold_is_told(
    tmp_path: Path, pose: dict[str, object], asked: dict[str, object], said: str
) -> None:
    scene, _ = placed(tmp_path, shapes.cup(0.05, 0.12, 0.004), **pose)
    with pytest.raises(SceneError) as refused:
        scene.fluid("w", **{"spacing": SPACING, **asked})
    assert said in str(refused.value)
    assert describe(scene.stage).fluids == []


def test_a_solid_holds_nothing() -> None:
    scene = Scene()
    scene.box("block", size=(1.0, 1.0, 1.0), static=True)
    with pytest.raises(SceneError, match='fills = "block" holds no fluid'):
        scene.fluid("water", fills="block", level=0.5, spacing=0.1)
