"""What the importer carries of MuJoCo's models: sound runs are accepted, and those with a fault are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from tests.importers.runs import FLOOR, model_of, recorded, verdict_of
from wsim.importers import read_npz
from wsim.importers.mujoco_model import world_of
from wsim.judge import judge
from wsim.judge.evidence import compound
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.joints import anchors_of

LINK = '<geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.4"/>'
LEAP = (  # thrown in a plane: two sliders and a hinge of one body, and a leg with a spring, a damper and a rotor
    '<body name="torso" pos="0 0 2"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    '<joint axis="0 1 0"/><geom type="box" size="0.2 0.1 0.1"/><body name="leg">'
    f'<joint axis="0 1 0" stiffness="20" damping="0.5" armature="0.05" springref="30"/>{LINK}</body></body>'
)
CARRIED: dict[str, tuple[str, str, dict[int, float]]] = {
    "a plane's sliders and hinge, and a sprung leg": (LEAP, "", {0: 1.0, 1: 1.0, 2: 2.0, 3: -4.0}),
    "masks: balls pass through each other": (
        '<body name="a" pos="0 0 2"><freejoint/><geom size="0.1" contype="2" conaffinity="1"/></body>'
        '<body name="b" pos="0.4 0 2"><freejoint/><geom size="0.1" contype="2" conaffinity="1"/></body>',
        "", {0: 1.0, 6: -1.0},
    ),
    "an exclude": (
        '<body name="a" pos="0 0 2"><freejoint/><geom size="0.1"/></body>'
        '<body name="b" pos="0.4 0 2"><freejoint/><geom size="0.1"/></body>',
        '<contact><exclude body1="a" body2="b"/></contact>', {0: 1.0, 6: -1.0},
    ),
    "an ellipsoid": (
        '<body name="a" pos="0 0 9"><freejoint/><geom type="ellipsoid" size="0.1 0.2 0.3"/></body>', "", {3: 0.5},
    ),
    "gravity compensated": (
        '<body name="a" gravcomp="1" pos="0 0 2"><freejoint/><geom size="0.1"/></body>', "", {0: 1.0},
    ),
    "welded parts": (
        '<body name="a" pos="0 0 9"><freejoint/><geom size="0.1"/>'
        '<body pos="0.3 0 0"><geom size="0.12"/></body></body>',
        "", {3: 2.0, 4: 1.0},
    ),
    "a loop that a connect closes": (
        f'<body name="a" pos="0 0 2"><joint axis="0 1 0"/>{LINK}</body>'
        f'<body name="b" pos="0.3 0 2"><joint axis="0 1 0"/>{LINK}</body>',
        '<equality><connect body1="a" body2="b" anchor="0.15 0 -0.2"/></equality>'
        '<default><equality solref="0.002 1"/></default><contact><exclude body1="a" body2="b"/></contact>',
        {0: 1.0, 1: 1.0},
    ),
    "joints that an equality gears": (
        f'<body name="a" pos="0 0 2"><joint name="i" axis="0 1 0"/>{LINK}</body>'
        f'<body name="b" pos="0.5 0 2"><joint name="j" axis="0 1 0"/>{LINK}</body>',
        '<equality><joint joint1="i" joint2="j" polycoef="0 2 0 0 0" solref="0.002 1"/></equality>',
        {0: 2.0, 1: 1.0},
    ),
    "contacts from afar": (
        FLOOR + '<body name="a" pos="0 0 0.12"><freejoint/><geom size="0.1" margin="0.02"/></body>', "", {},
    ),
    "a tendon along joints": (
        f'<body name="a" pos="0 0 2"><joint name="i" axis="0 1 0"/>{LINK}<body pos="0 0 -0.4">'
        f'<joint name="j" axis="0 1 0"/>{LINK}</body></body>',
        '<tendon><fixed stiffness="30"><joint joint="i" coef="1"/><joint joint="j" coef="-1"/></fixed></tendon>',
        {0: 2.0},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CARRIED)
def test_a_sound_run_is_accepted(tmp_path: Path, name: str) -> None:
    bodies, rest, speeds = CARRIED[name]
    verdict = verdict_of(tmp_path, bodies, rest, speeds=speeds)
    assert verdict.status == "accepted", verdict.summary


@pytest.mark.parametrize("fault", [{"gravity": 0.9 * 9.81}, {"push": 0.2}])
@pytest.mark.parametrize("name", list(CARRIED)[:4])
def test_a_fault_in_it_is_found(tmp_path: Path, name: str, fault: dict[str, Any]) -> None:
    bodies, rest, speeds = CARRIED[name]
    assert verdict_of(tmp_path, bodies, rest, speeds=speeds, **fault).status == "rejected"


def test_balls_that_pass_through_each_other_without_a_mask_are_rejected(tmp_path: Path) -> None:
    bodies, rest, speeds = CARRIED["masks: balls pass through each other"]
    plain = bodies.replace('contype="2" conaffinity="1"', "")
    verdict = verdict_of(tmp_path, bodies, rest, speeds=speeds, judged_as=plain)
    assert "CheckPenetration" in {finding.check for finding in verdict.failures}


def test_a_soft_contact_gives_back_what_it_takes(tmp_path: Path) -> None:
    """A box that drops 0.3 m on a floor of MuJoCo's own softness, with no contact forces in the file."""
    box = '<body name="box" pos="0 0 0.4"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>'
    verdict = verdict_of(tmp_path, FLOOR + box)
    assert verdict.status == "accepted", verdict.summary


@pytest.mark.parametrize("tilt", [30, 44, 65])
def test_a_soft_contact_carries_the_weight_of_what_it_pushes_out(tmp_path: Path, tilt: float) -> None:
    """A plate that drops on its edge: it is lifted by as deep as it came in, several times 0.002 of its thickness."""
    size = 'size="0.05 0.04 0.003" mass="0.8"'
    plate = f'<body name="cup" pos="0 0 0.07" euler="{tilt} 0 0"><freejoint/><geom type="box" {size}/></body>'
    verdict = verdict_of(tmp_path, FLOOR + plate, seconds=0.6)
    assert verdict.status == "accepted", verdict.summary


def test_soft_contacts_with_a_height_field_hold_what_they_give_back(tmp_path: Path) -> None:
    ball = '<geom type="hfield" hfield="t"/><body name="ball" pos="0.1 0 0.25"><freejoint/><geom size="0.1"/></body>'
    slope = '<asset><hfield name="t" nrow="2" ncol="2" size="1 1 0.1 0.3" elevation="0 0 1 1"/></asset>'
    verdict = verdict_of(tmp_path, ball, slope, seconds=0.6)
    assert verdict.status == "accepted", verdict.summary


@pytest.mark.parametrize(("x", "y", "along", "aside"), [(-0.2, 0.45, -1.0, 0.4), (0.3, 0.3, 1.0, 1.0)])
def test_a_ball_rolls_over_the_creases_of_a_height_field(
    tmp_path: Path, x: float, y: float, along: float, aside: float
) -> None:
    """A hill of 3 by 3 heights: where its cells are cut says which way each side of it falls."""
    ball = f'<body name="ball" pos="{x} {y} 0.17"><freejoint/><geom size="0.1"/></body>'
    hill = '<asset><hfield name="t" nrow="3" ncol="3" size="1 1 0.1 0.3" elevation="0 0 0 0 1 0 0 0 0"/></asset>'
    bodies, speeds = '<geom type="hfield" hfield="t"/>' + ball, {0: along, 1: aside}
    verdict = verdict_of(tmp_path, bodies, hill, seconds=0.6, speeds=speeds)
    assert verdict.status == "accepted", verdict.summary


@pytest.mark.parametrize("height", [0.154, 0.178])
def test_a_blow_on_soft_contacts_takes_a_slip_without_all_of_its_friction(tmp_path: Path, height: float) -> None:
    """Its tip meets a slope late in an interval: the slip dies away in the next one, inside the cone."""
    soft = 'solref="0.005 1" solimp="0.9 0.97 0.001"'
    rod = (
        f'<geom type="box" pos="0 0 -0.1" euler="0 20 0" size="1 1 0.1" friction="0" {soft}/>'
        f'<body name="rod" pos="0.03 0 {height}"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        '<joint axis="0 1 0"/>'
        f'<geom type="capsule" size="0.005" fromto="0 0 -0.05 0 0 0.05" friction="0.7" {soft}/></body>'
    )
    assert verdict_of(tmp_path, rod, '<option cone="elliptic"/>', seconds=0.5).status == "accepted"


def test_masses_of_what_is_welded_add_up(tmp_path: Path) -> None:
    """Two balls 0.3 m apart: 2/5 m r^2 each, and Steiner's part of the reduced mass about their common centre."""
    bodies, _, _ = CARRIED["welded parts"]
    (tmp_path / "scene.xml").write_text(model_of(bodies))
    (body,) = world_of(tmp_path / "scene.xml").bodies
    one, two = (1000.0 * 4.0 / 3.0 * np.pi * r**3 for r in (0.1, 0.12))
    own = 0.4 * (one * 0.1**2 + two * 0.12**2)
    across = own + one * two / (one + two) * 0.3**2
    assert body.mass == pytest.approx(one + two)
    assert body.com == pytest.approx((0.3 * two / (one + two), 0.0, 0.0))
    assert np.array(body.inertia).reshape(3, 3) == pytest.approx(np.diag([own, across, across]))
    assert len(body.shapes) == 2


def test_three_hinges_through_different_points_are_where_mujoco_has_them(tmp_path: Path) -> None:
    lines = (("0 0 1", "0 0 0.1"), ("0 1 0", "0.1 0 0"), ("1 0 0", "0 0 0"))
    hinges = "".join(f'<joint axis="{axis}" pos="{at}"/>' for axis, at in lines)
    bodies = f'<body name="a" pos="0 0 2" euler="10 20 30">{hinges}{LINK}</body>'
    recording = recorded(tmp_path, bodies, speeds={0: 1.0, 1: -1.5, 2: 2.0}, seconds=0.4)
    evidence = Evidence(recording)
    (joint,) = recording.world.joints
    found = compound.placed(joint, anchors_of(evidence, joint))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "scene.xml"))
    data = mujoco.MjData(model)
    with np.load(tmp_path / "run.npz") as run:
        for k, qpos in enumerate(run["qpos"]):
            data.qpos[:] = qpos
            mujoco.mj_kinematics(model, data)
            for at, axis, anchor in zip(found, data.xaxis, data.xanchor, strict=True):
                assert at is not None
                assert at.axis[k] == pytest.approx(axis, abs=1e-5)
                off = at.point[k] - anchor  # any point of the axis will do
                assert off - (off @ axis) * axis == pytest.approx(0.0, abs=1e-5)
    track = evidence.joint(joint)
    assert track is not None
    assert track.apart.max() < 1e-5


CART = """<mujoco><option timestep="0.02" integrator="RK4"/><worldbody>
<body name="cart"><joint name="slider" type="slide" axis="1 0 0" damping="{damping}"/>
  <geom type="capsule" size="0.1" fromto="-0.1 0 0 0.1 0 0"/>
  <body name="pole"><joint name="hinge" axis="0 1 0" damping="{damping}"/>
    <geom type="capsule" size="0.049" fromto="0 0 0 0 0 0.6"/></body></body>
</worldbody><contact><exclude body1="cart" body2="pole"/></contact></mujoco>"""


@pytest.mark.parametrize(("told", "status"), [(1.0, "accepted"), (0.85, "rejected"), (1.15, "rejected")])
def test_a_joint_damps_by_its_mean_rate_in_steps_of_the_fourth_order(tmp_path: Path, told: float, status: str) -> None:
    """A step takes c dq of it, none of what it was before: 0.14 N of a pole's 49 N, for 16 frames, seemed missing."""
    path = tmp_path / "scene.xml"
    path.write_text(CART.format(damping=1.0))
    model = mujoco.MjModel.from_xml_path(str(path))
    data, rows = mujoco.MjData(model), []
    data.qpos[:], data.qvel[:] = (0.1, 0.2), (0.3, 0.0)
    for _ in range(60):
        rows.append((data.time, data.qpos.copy(), data.qvel.copy()))
        mujoco.mj_step(model, data)
    time, places, rates = (np.array(column) for column in zip(*rows, strict=True))
    np.savez(tmp_path / "run.npz", time=time, qpos=places, qvel=rates)
    path.write_text(CART.format(damping=told))
    verdict = judge(read_npz(tmp_path / "run.npz", path))
    assert verdict.status == status, [finding.message for finding in verdict.failures]
