"""What the importer cannot carry: the verdict is blocked, and names it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from wsim.cli import app
from wsim.importers import read_npz
from wsim.judge import judge
from wsim.judge.verdict import Verdict

BALL = '<geom name="skin" type="sphere" size="0.1"/>'
FREE = f'<body name="ball" pos="0 0 1"><freejoint name="float"/>{BALL}</body>'
MODELS = {  # what acts: (the world's bodies, what else the model has, a word of the message, the element's prim)
    "medium": (FREE, '<option density="1000"/>', "density 1000", "/World"),
    "sticky": (FREE.replace("size=", 'adhesion="2" size='), "", "adhesion 2 N", "/World/skin"),
    "thrust": (
        FREE.replace("<geom", '<site name="nozzle"/><geom'),
        '<actuator><motor name="jet" site="nozzle" gear="0 0 1 0 0 0"/></actuator>',
        "actuator", "/World/jet",
    ),
    "drag": (FREE.replace("<freejoint", '<joint type="free" damping="2"').replace('"float"/>', '"float"/>'), "",
             "damping", "/World/float"),
}  # fmt: skip


def run(folder: Path, bodies: str, rest: str) -> tuple[Path, Path]:
    """A model and 0.2 s of it, as files."""
    model, states = folder / "scene.xml", folder / "run.npz"
    model.write_text(f"<mujoco><worldbody>{bodies}</worldbody>{rest}</mujoco>")
    compiled = mujoco.MjModel.from_xml_path(str(model))
    data = mujoco.MjData(compiled)
    rows = []
    for _ in range(21):
        rows.append((data.time, data.qpos.copy(), data.qvel.copy()))
        mujoco.mj_step(compiled, data, 5)
    np.savez(states, **dict(zip(("time", "qpos", "qvel"), map(np.array, zip(*rows, strict=True)), strict=True)))
    return model, states


def verdict_of(folder: Path, bodies: str, rest: str = "") -> Verdict:
    model, states = run(folder, bodies, rest)
    return judge(read_npz(states, model))


@pytest.mark.parametrize("name", MODELS)
def test_what_is_not_carried_blocks_the_verdict_and_is_named(tmp_path: Path, name: str) -> None:
    bodies, rest, word, prim = MODELS[name]
    verdict = verdict_of(tmp_path, bodies, rest)
    assert verdict.status == "blocked", verdict.summary
    assert verdict.summary.startswith("Blocked: cannot judge")
    (finding,) = verdict.findings
    assert word in finding.message
    assert finding.prim == prim
    assert not finding.passed


def test_the_same_ball_without_it_is_judged(tmp_path: Path) -> None:
    assert verdict_of(tmp_path, FREE).status == "accepted"


def test_a_blocked_trajectory_ends_the_command_with_3(tmp_path: Path) -> None:
    model, states = run(tmp_path, *MODELS["medium"][:2])
    done = CliRunner().invoke(app, ["judge", str(states), "--model", str(model)])
    assert done.exit_code == 3, done.output
    assert "cannot judge" in done.output
