"""Every skill: its form, what its tables name, and each piece of code in it, built, simulated and judged."""

import json
import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

from tests.skills.blocks import PYTHON, WHOLE, Block, blocks
from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import parse
from wsim.judge.language.kinds import KINDS
from wsim.judge.language.objective import ObjectiveCheck, name_of
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Objective
from wsim.recording import read
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.skills import Skill, skills

PATTERNS = {
    "camera-sensors", "cameras-and-light", "containers-and-fluid", "control-functions", "conveyors-and-lifts",
    "floating-bodies", "joints-and-mechanisms",
    "objectives", "parameters", "pendulums-and-springs", "projectiles-and-collisions", "raw-usd", "repairing",
    "rigid-bodies", "robots", "ropes-and-pulleys", "stacks-and-contact", "time-step-and-stability",
    "schedules", "sensors", "terrain", "tracks-terrain-compounds", "vehicles", "waves-and-dam-breaks",
}  # fmt: skip
CHECKS = {check.name for check in [*run_checks(), *physics_checks()]} | {"CheckConverged", "ObjectiveFormula"}
CHECKS |= {name_of(kind) for kind in KINDS}
LONGEST = 6600  # characters: a language model pays for each

by_name = pytest.mark.parametrize("skill", skills(), ids=lambda skill: skill.name)


def test_each_pattern_has_a_skill() -> None:
    assert {skill.name for skill in skills()} == PATTERNS


@by_name
def test_it_says_when_to_use_it_and_when_not(skill: Skill) -> None:
    assert "Use it when" in skill.description and re.search(r"\bNot ", skill.description)


@by_name
def test_it_is_short_and_has_a_whole_program(skill: Skill) -> None:
    assert len(skill.text) <= LONGEST and len(skill.text.splitlines()) <= 130
    assert max(len(line) for line in skill.body.splitlines() if not line.startswith("|")) <= 120
    assert any(block.name.startswith(skill.name) for block in WHOLE)


@by_name
def test_what_it_refers_to_is_there(skill: Skill) -> None:
    named = set(re.findall(r"\b(?:Check|Objective)[A-Z]\w*", skill.body))
    assert named and named - {"CheckPlan"} <= CHECKS
    for target in re.findall(r"\]\(([^)#]+)\)", skill.body):
        assert (skill.folder / target).is_file(), target


def test_every_check_is_treated_by_some_skill() -> None:
    named = {name for skill in skills() for name in re.findall(r"\b(?:Check|Objective)[A-Z]\w*", skill.body)}
    untreated = CHECKS - named
    assert not untreated


def test_the_guide_from_findings_to_skills_names_skills() -> None:
    (guide,) = [skill for skill in skills() if skill.name == "repairing"]
    named = set(re.findall(r"\| ([a-z]+(?:-[a-z]+)+) \|$", guide.body, re.MULTILINE))
    assert len(named) > 5 and named <= PATTERNS


@cache
def judged(block: Block, folder: Path) -> Verdict:
    """A program, built in the sandbox, simulated on the CPU without pictures, and judged."""
    folder.mkdir()
    program = folder / "program.py"
    program.write_text(block.program, encoding="utf-8")
    return Iteration.of(program, folder, settings=Settings(device="cpu", pictures=False, params=block.params)).run()


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.mark.parametrize("block", PYTHON, ids=lambda block: block.name)
def test_it_builds_a_sound_stage(block: Block, tmp_path: Path) -> None:
    iteration = Iteration(tmp_path, settings=Settings(params=block.params))
    iteration.program.write_text(block.program, encoding="utf-8")
    built = iteration.build()
    assert built.ok, built
    world = describe(iteration.stage)
    assert world.bodies or world.fluids
    assert block.fragment or world.cameras
    assert all(item.line is not None for item in [*world.bodies, *world.fluids, *world.joints])


@pytest.mark.parametrize("block", WHOLE, ids=lambda block: block.name)
def test_the_program_is_accepted(block: Block, runs: Path) -> None:
    verdict = judged(block, runs / block.name)
    failed = [finding for finding in verdict.findings if not finding.passed]
    assert verdict.status == "accepted" and len(verdict.findings) >= 10, failed


def test_the_objectives_hold_in_their_program(runs: Path) -> None:
    (skill,) = [skill for skill in skills() if skill.name == "objectives"]
    (block,) = [block for block in WHOLE if block.name.startswith("objectives")]
    judged(block, runs / block.name)
    evidence = Evidence(read(runs / block.name / "recording.rrd"))
    texts = {each.language: each.source for each in blocks(skill)}
    sentences = [
        Objective(kind="formula", object="ball", formula=parse(line)) for line in texts["formula"].splitlines()
    ]
    items = [Objective.model_validate(item) for item in json.loads(texts["json"])]
    assert len(sentences) >= 6 and len(items) >= 4
    for objective in [*sentences, *items]:
        findings = ObjectiveCheck(objective).run(evidence)
        assert findings and all(finding.passed for finding in findings), findings


def world_of(block: Block, folder: Path) -> World:
    namespace: dict = {"__name__": "program"}
    exec(compile(block.program, f"{block.name}.py", "exec"), namespace)
    scene = Scene()
    namespace["build"](scene)
    stage = scene.save(folder / "stage.usda")
    assert check_stage(stage, [folder]) == []
    return describe(stage)


def test_program_of_floating_bodies_keeps_the_skills_own_rules(tmp_path: Path) -> None:
    (block,) = [each for each in WHOLE if each.name.startswith("floating-bodies")]
    world = world_of(block, tmp_path)
    (water,) = world.fluids
    (tank,) = world.containers
    surface = water.center[2] + water.size[2] / 2
    tallest = rise = 0.0
    spans = [(-tank.inner_size[0] / 2, -tank.inner_size[0] / 2), (tank.inner_size[0] / 2, tank.inner_size[0] / 2)]
    for body in world.bodies:
        (shape,) = body.shapes
        extents = shape.size if shape.kind == "box" else [2 * shape.size[0]] * 3
        tallest = max(tallest, extents[2])
        rise += min(body.mass / water.density, body.volume) / (tank.inner_size[0] * tank.inner_size[1])
        assert water.spacing <= min(extents) / 5 + 1e-9, body.prim
        gap = body.position[2] - extents[2] / 2 - surface
        assert gap == pytest.approx(0.005 if body.mass / body.volume < water.density else 0.15, abs=1e-6), body.prim
        spans.append((body.position[0] - extents[0] / 2, body.position[0] + extents[0] / 2))
    spans.sort()
    assert min(right[0] - left[1] for left, right in pairwise(spans)) >= 3.2 * water.spacing
    cells = [edge / water.spacing for edge in water.size]
    assert cells == pytest.approx([round(cell) for cell in cells], abs=1e-5)
    assert water.size[2] >= max(2 * tallest, 10 * water.spacing)
    assert tank.inner_size[2] >= water.size[2] + rise + 4 * water.spacing
    assert world.duration >= 3.5 * (tallest / 0.14) ** 0.5
