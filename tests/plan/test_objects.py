"""What is known of one object: how much room it takes, and what it weighs."""

import math

import pytest

from wsim.plan.schema import FromAsset, Material, PlanObject, Proxy, Registration

WOOD = Material(name="wood", density=600.0)


def made(primitive: str, *size: float, role: str = "rigid_body", state: str = "dynamic", **registration) -> PlanObject:
    return PlanObject.proxy(
        name="thing", role=role, primitive=primitive, size=size, state=state, material=WOOD,
        registration=Registration(**registration),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("item", "volume"),
    [
        (made("box", 0.2, 0.3, 0.5), 0.03),
        (made("sphere", 0.3), 0.036 * math.pi),
        (made("cylinder", 0.1, 0.5), 0.005 * math.pi),
        (made("capsule", 0.3, 0.5), (0.045 + 0.036) * math.pi),
        (made("fluid", 1.0, 0.5, 0.2, role="fluid", state="fluid"), 0.1),
        (made("fluid", role="fluid", state="fluid"), None),
        (made("tank", 1.0, 1.0, 1.0, role="container", state="static"), None),
        (made("ground", role="terrain", state="static"), None),
        (made("box", 1.0, 1.0, 1.0).model_copy(update={"construction": FromAsset(asset="mug")}), None),
    ],
    ids=lambda what: what.primitive if isinstance(what, PlanObject) else "",
)
def test_volume_is_that_of_the_solid(item: PlanObject, volume: float | None) -> None:
    assert item.volume == (None if volume is None else pytest.approx(volume, rel=1e-12))


def test_what_an_object_has_of_its_own_comes_before_its_material() -> None:
    plain, dense, heavy = (made("box", 0.5, 0.5, 1.0, **own) for own in ({}, {"density": 800.0}, {"mass": 100.0}))
    assert (plain.density, plain.mass) == (600.0, 150.0)
    assert (dense.density, dense.mass) == (800.0, 200.0)
    assert (heavy.density, heavy.mass) == (400.0, 100.0)


def test_what_the_plan_does_not_say_is_not_known() -> None:
    mug = PlanObject(name="mug", role="rigid_body", construction=FromAsset(asset="mug"))
    assert (mug.volume, mug.density, mug.mass) == (None, None, None)
    table = PlanObject(
        name="table", role="background", construction=Proxy(primitive="box", size=(1, 1, 1)), state="static"
    )
    assert (table.volume, table.density, table.mass) == (1.0, None, None)
    tank = made("tank", 1.0, 1.0, 1.0, role="container", mass=5.0)
    assert (tank.density, tank.mass) == (600.0, 5.0)  # how much of it is glass, only the stage says
