"""What the two drawings show, as text and as a picture, of plans whose places are known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from wsim.plan import load
from wsim.plan.cost import cost_of
from wsim.plan.drawing.labels import Wanted, place, together
from wsim.plan.drawing.picture import WIDTH, draw_picture
from wsim.plan.drawing.silhouettes import scene_of
from wsim.plan.drawing.text import draw_text, nice
from wsim.plan.schema import Material, Plan, PlanObject, Pose, Relation
from wsim.plan.schema.objects import SPREAD
from wsim.rules.planner import plan as plan_of

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "plans").glob("*.json"))
WOOD = Material(name="wood", density=600.0, color=(0.5, 0.25, 0.1))
RED = Material(name="red", density=600.0, color=(0.7, 0.0, 0.0))
TURNED = Pose(position=(0.0, 0.0, 0.5), rotation_deg=(0.0, 0.0, 30.0))


def body(name: str, primitive: str, size: tuple[float, ...], at: tuple[float, float, float], **fields) -> PlanObject:
    pose = fields.pop("pose", Pose(position=at))
    return PlanObject.proxy(
        name=name, role="rigid_body", primitive=primitive, size=size, pose=pose, material=WOOD, **fields
    )


def made(*objects: PlanObject, **fields) -> Plan:
    return Plan(title="A test", prompt="a test", objects=list(objects), **fields)


@pytest.fixture
def tank() -> Plan:
    """A ball half a metre over the left front corner of the water in a tank of 2 x 1 x 1 m, and the ground."""
    glass = Material(name="glass", density=2500.0, opacity=0.2)
    water = Material(name="water", density=1000.0, color=(0.1, 0.3, 0.6))
    rows = [Relation(predicate="PLACE-IN", ref="tank"), Relation(predicate="FREE-SURFACE-AT", value=0.5)]
    return made(
        PlanObject.proxy(name="ground", role="terrain", primitive="ground", state="static"),
        PlanObject.proxy(
            name="tank", role="container", primitive="tank", size=(2.0, 1.0, 1.0), state="static", material=glass,
            pose=Pose(position=(0.0, 0.0, 0.0)),
        ),
        PlanObject.proxy(
            name="water", role="fluid", primitive="fluid", state="fluid", material=water, relations=rows,
        ),
        body("ball", "sphere", (0.1,), (0.8, 0.3, 1.1)),
    )  # fmt: skip


def of(plan: Plan, view: str, name: str):
    return next(one for one in scene_of(plan).views[view] if one.name == name)


def test_outlines_have_the_things_corners() -> None:
    plan = made(
        body("box", "box", (2.0, 1.0, 0.5), (1.0, 2.0, 3.0)),
        body("bar", "box", (2.0, 0.5, 0.2), (0.0, 0.0, 0.0), pose=TURNED),
        body("rod", "cylinder", (0.1, 2.0), (0.0, 0.0, 0.0), pose=Pose(position=(0, 0, 5), rotation_deg=(90, 0, 0))),
        body("pill", "capsule", (0.5, 1.0), (0.0, 0.0, 8.0)),
    )
    assert (of(plan, "above", "box").low, of(plan, "above", "box").high) == ((0.0, 1.5), (2.0, 2.5))
    assert (of(plan, "side", "box").low, of(plan, "side", "box").high) == ((0.0, 2.75), (2.0, 3.25))
    corner = (math.cos(math.radians(30)) - 0.25 * 0.5, 0.5 + 0.25 * math.cos(math.radians(30)))
    turned = of(plan, "above", "bar")
    assert min(math.dist(corner, point) for point in turned.points) < 1e-6
    assert len(turned.points) == 4 and not turned.upright
    assert of(plan, "above", "rod").high == pytest.approx((0.1, 1.0), abs=1e-3)
    assert of(plan, "side", "rod").high == pytest.approx((0.1, 5.1), abs=1e-3)
    assert of(plan, "side", "pill").high == pytest.approx((0.5, 9.0), abs=1e-6)


def test_water_is_drawn_as_deep_as_it_stands_and_glass_around_it(tank: Plan) -> None:
    water = of(tank, "side", "water")
    assert (water.low, water.high) == (pytest.approx((-1.0, 0.02)), pytest.approx((1.0, 0.52)))
    assert of(tank, "above", "tank").high == pytest.approx((1.02, 0.52))
    assert [one.name for one in scene_of(tank).views["above"]] == ["water", "tank", "ball"]
    assert scene_of(tank).ground == 0.0


def test_what_looks_somewhere_has_its_front_where_it_looks() -> None:
    pose = Pose(position=(1.0, 0.0, 0.5), rotation_deg=(0.0, 0.0, 90.0))
    rows = [Relation(predicate="FACING-LEFT")]
    plan = made(
        body("chair", "box", (0.4, 0.6, 1.0), (0, 0, 0), pose=pose, relations=rows),
        body("ball", "sphere", (1.0,), (0, 0, 1)),
    )
    assert of(plan, "above", "chair").front == pytest.approx((1.0, 0.2))
    assert of(plan, "above", "ball").front is None


def test_text_has_front_to_the_right_and_left_above(tank: Plan) -> None:
    drawn = draw_text(tank, 80)
    above, side = drawn.split("side, from the right")
    for words in ("↑ LEFT (+Y)", "→ FRONT (+X)"):
        assert words in above
    lines = above.splitlines()[1:]
    row, column = next((r, line.index("B")) for r, line in enumerate(lines) if "B" in line)
    assert row < len(lines) / 2 and column > len(lines[0]) / 2
    assert "▔" in side and "▔" not in above
    first = {letter: next(k for k, line in enumerate(side.splitlines()[1:]) if letter in line) for letter in "B~"}
    assert first["B"] < first["~"]
    assert "A tank   ~ water   B ball" in drawn


@pytest.mark.parametrize("width", [20, 40, 80, 300])
def test_text_keeps_to_its_width_and_is_the_same_again(tank: Plan, width: int) -> None:
    drawn = draw_text(tank, width)
    assert drawn == draw_text(tank, width)
    assert max(len(line) for line in drawn.splitlines() if line[0] in "┌│└├") <= max(30, min(width, 100))


def test_more_things_than_letters_share_one() -> None:
    plan = made(*(body(f"box_{k}", "box", (0.1, 0.1, 0.1), (0.2 * k, 0.0, 0.05)) for k in range(70)))
    drawn = draw_text(plan, 100)
    assert "9 box_61" in drawn and "# 8 more" in drawn


def test_an_empty_plan_and_one_of_a_point_are_drawn(tmp_path: Path) -> None:
    for plan in (made(), made(body("dot", "sphere", (1e-6,), (5.0, 5.0, 5.0)))):
        assert draw_text(plan)
        draw_picture(plan, tmp_path / "plan.png")


def test_what_starts_high_over_the_ground_is_drawn(tmp_path: Path) -> None:
    draw_picture(plan_of("A ball is thrown and flies."), tmp_path / "plan.png")
    assert Image.open(tmp_path / "plan.png").width == WIDTH


def test_the_picture_has_things_where_they_are(tank: Plan, tmp_path: Path) -> None:
    """The ball's brown is right of the middle and in the upper half of the view from above."""
    draw_picture(tank, tmp_path / "plan.png")
    assert [path.name for path in tmp_path.iterdir()] == ["plan.png"]
    pixels = np.asarray(Image.open(tmp_path / "plan.png").convert("RGB")).astype(int)
    assert pixels.shape[1] == WIDTH
    brown = (abs(pixels - (194, 149, 101)) < 25).all(axis=2)
    rows, columns = np.nonzero(brown)
    assert len(rows) > 200
    assert columns.min() > WIDTH / 2
    above, side = rows[rows < pixels.shape[0] / 2], rows[rows > pixels.shape[0] / 2]
    assert len(above) > 100 and len(side) > 100
    blue = (pixels[:, :, 2] - pixels[:, :, 0] > 25).sum(axis=1)
    assert blue[: len(blue) // 2].max() > 400 and blue[len(blue) // 2 :].max() > 400
    before = (tmp_path / "plan.png").read_bytes()
    draw_picture(tank, tmp_path / "plan.png")
    assert (tmp_path / "plan.png").read_bytes() == before


def test_names_find_places_of_their_own() -> None:
    frame = (0.0, 0.0, 1000.0, 500.0)
    things = [
        Wanted(f"block_{k}", (60.0, 17.0), (300.0 + 25 * k, 200.0, 320.0 + 25 * k, 220.0), "middle") for k in range(12)
    ]
    placed = place(things, frame)
    for k, a in enumerate(placed):
        assert frame[0] <= a[0] and a[2] <= frame[2] and frame[1] <= a[1] and a[3] <= frame[3]
        for b in placed[:k]:
            shared = max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))
            assert shared < 0.1 * 60 * 17


def test_things_at_one_place_share_a_label() -> None:
    assert together(["block_2", "block_1"]) == "block_1, 2"
    assert together([f"block_{k}" for k in range(1, 13)] + ["ball"]) == "ball, block_1 … 12"
    assert together(["a", "b", "c", "d", "e"]) == "a, b, c +2"


@pytest.mark.parametrize(("length", "expected"), [(0.99, 0.5), (1.0, 1.0), (3.0, 2.0), (70.0, 50.0), (0.0021, 0.002)])
def test_scales_are_round_numbers(length: float, expected: float) -> None:
    assert nice(length) == pytest.approx(expected)


def test_cost_of_a_tank_is_its_volume_over_the_spacing_cubed(tank: Plan) -> None:
    plan = tank.model_copy(update={"simulation": tank.simulation.model_copy(update={"spacing": 0.05, "duration": 2.0})})
    cost = cost_of(plan)
    assert cost.fluid == 40 * 20 * 10
    walls = 44 * 24 * 22 - 40 * 20 * 20  # two layers of them, up to the rim
    assert cost.others == pytest.approx(walls + 4 / 3 * math.pi * 2**3, abs=1.0)
    assert cost.steps >= 2.0 * 800
    assert cost.wall == pytest.approx(cost.steps * (cost.fluid + cost.others) / 1.3e6, rel=0.05)
    assert "about 8,000 particles of fluid" in cost.sentence()
    assert "no fluid" in cost_of(made(body("box", "box", (1.0, 1.0, 1.0), (0, 0, 0.5)))).sentence()


@pytest.mark.parametrize(("name", "steps"), [("go2_office", 32_000), ("hmmwv_offroad", 32_000)])
def test_what_walks_or_drives_costs_milliseconds_a_step(name: str, steps: int) -> None:
    """The two examples took 3.1 and 3.8 ms a step of one core."""
    cost = cost_of(load(next(path for path in EXAMPLES if path.stem == name)))
    assert cost.steps == steps
    assert 2.5e-3 < cost.wall / cost.steps < 5e-3


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_plan_written_by_hand_is_laid_out_and_drawn(path: Path, tmp_path: Path) -> None:
    plan = load(path)
    placed = {item.name for item in plan.objects if item.pose is not None}
    assert placed >= {item.name for item in plan.objects if item.primitive not in ("ground", "fluid", *SPREAD)}
    assert all(camera.eye is not None and camera.target is not None for camera in plan.cameras)
    drawn = draw_text(plan, 80)
    assert all(item.name in drawn for item in plan.objects if item.primitive not in ("ground", "scatter"))
    draw_picture(plan, tmp_path / "plan.png")
    assert Image.open(tmp_path / "plan.png").size[0] == WIDTH
