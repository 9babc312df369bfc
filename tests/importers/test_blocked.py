"""What the importer cannot carry: the verdict is blocked, and names it."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.importers.runs import recorded, verdict_of
from wsim.cli import app

BALL = '<geom name="skin" type="sphere" size="0.1"/>'
FREE = f'<body name="ball" pos="0 0 1"><freejoint name="float"/>{BALL}</body>'
CHAIN = (
    '<body name="a" pos="0 0 1"><joint name="j" axis="0 1 0"/><geom size="0.05" pos="0 0 -0.3"/><site name="s"/></body>'
)
MODELS = {  # what acts: (the world's bodies, what else the model has, a word of the message, the element's prim)
    "medium": (FREE, '<option density="1000"/>', "density 1000", "/World"),
    "sticky": (FREE.replace("size=", 'adhesion="2" size='), "", "adhesion 2 N", "/World/skin"),
    "thrust": (
        FREE.replace("<geom", '<site name="nozzle"/><geom'),
        '<actuator><motor name="jet" site="nozzle" gear="0 0 1 0 0 0"/></actuator>',
        "an actuator that pushes on a site", "/World/jet",
    ),
    "drag": (
        FREE.replace('<freejoint name="float"/>', '<joint name="float" type="free" damping="2"/>'), "",
        "damping", "/World/float",
    ),
    "string": (
        '<site name="hook" pos="1 0 1"/>' + CHAIN,
        '<tendon><spatial name="string" stiffness="5"><site site="hook"/><site site="s"/></spatial></tendon>',
        "a tendon through points", "/World/string",
    ),
    "by hand": ('<body name="hand" mocap="true"><geom size="0.1"/></body>' + CHAIN, "", "mocap", "/World/hand"),
    "belt": (
        CHAIN.replace("<geom", '<geom name="skin" surfacevel="1 0 0 0 0 0"'), "", "a surface that moves", "/World/skin",
    ),
    "slider after a hinge": (
        CHAIN.replace("<geom", '<joint name="k" type="slide" axis="0 0 1"/><geom'), "", "2 joints of one body",
        "/World/a",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MODELS)
def test_what_is_not_carried_blocks_the_verdict_and_is_named(tmp_path: Path, name: str) -> None:
    bodies, rest, word, prim = MODELS[name]
    verdict = verdict_of(tmp_path, bodies, rest, seconds=0.2)
    assert verdict.status == "blocked", verdict.summary
    assert verdict.summary.startswith("Blocked: cannot judge")
    (finding,) = verdict.findings
    assert word in finding.message
    assert finding.prim == prim
    assert not finding.passed


def test_the_same_ball_without_it_is_judged(tmp_path: Path) -> None:
    assert verdict_of(tmp_path, FREE, seconds=0.2).status == "accepted"


def test_a_blocked_trajectory_ends_the_command_with_3(tmp_path: Path) -> None:
    recorded(tmp_path, *MODELS["medium"][:2], seconds=0.2)
    command = ["judge", str(tmp_path / "run.npz"), "--model", str(tmp_path / "scene.xml")]
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 3, done.output
    assert "cannot judge" in done.output
