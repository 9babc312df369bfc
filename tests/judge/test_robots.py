"""Robots of others' files, whose links of several joints have light links without a shape between."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from wsim.assets.folders import VARIABLE
from wsim.intake.robots import take_in
from wsim.judge import judge
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

if TYPE_CHECKING:
    from pathlib import Path

    from wsim.recording.recording import Recording

CRAB = """\
<mujoco><worldbody><body name="torso" pos="0 0 0.4"><freejoint/>
  <geom type="capsule" fromto="-.2 0 0 .2 0 0" size="0.05"/>
  <body name="leg" pos="-0.2 0 0">
    <joint name="hip_x" axis="1 0 0" damping="0.5"/><joint name="hip_y" axis="0 1 0" damping="0.5"/>
    <joint name="hip_z" axis="0 0 1" damping="0.5"/>
    <geom type="capsule" fromto="0 0 -.07 -.1 0 -.3" size="0.03"/></body>
  <body name="arm" pos="0.2 0 0"><joint name="slide" type="slide" axis="1 0 0" range="0 0.1"/>
    <joint name="turn" axis="0 1 0" damping="0.5"/>
    <geom type="capsule" fromto=".07 0 0 .2 .05 -.2" size="0.03"/></body>
</body></worldbody></mujoco>
"""  # fmt: skip


@pytest.fixture
def fallen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Recording:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    (tmp_path / "crab.xml").write_text(CRAB)
    take_in(tmp_path / "crab.xml", "crab")
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=60.0)
    scene.ground()
    scene.robot("crab", "crab", position=(0.0, 0.0, 0.1), joints={"hip_y": 10.0})
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    return read(tmp_path / "r.rrd")


def test_what_falls_with_links_that_have_no_shape_is_judged(fallen: Recording) -> None:
    bare = [body.prim for body in fallen.world.bodies if not body.shapes]
    assert len(bare) == 3
    verdict = judge(fallen)
    assert verdict.status == "accepted", [finding.message for finding in verdict.findings if not finding.passed]
    assert verdict.crashes == []
    energy = next(finding for finding in verdict.findings if finding.check == "CheckRecordedEnergy")
    assert energy.value < 0.1 * energy.limit


def test_a_link_without_a_shape_that_strays_is_found(fallen: Recording) -> None:
    k = next(k for k, body in enumerate(fallen.world.bodies) if not body.shapes)
    strayed = fallen.body_q.copy()
    strayed[30:, k, 0] += 0.05
    failed = {finding.check for finding in judge(replace(fallen, body_q=strayed)).findings if not finding.passed}
    assert {"CheckJoints", "CheckContinuity"} <= failed
