"""The wheel carries what the code reads at run time, and nothing that was left lying about."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
WANTED = (
    "wsim/py.typed",
    "wsim/scene/schema/generatedSchema.usda",
    "wsim/scene/schema/plugInfo.json",
    "wsim/rules/language/english.lark",
    "wsim/rules/language/nouns.toml",
    "wsim/report/template.html",
    "wsim/report/style.css",
    "wsim/plan/drawing/fonts/DejaVuSans.ttf",
    "wsim/plan/drawing/fonts/LICENSE",
    "wsim/_skills/floating-bodies/SKILL.md",
    "wsim/_usd_assets/crate/asset.usda",
    "wsim/_usd_assets/crate/asset.json",
)


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (wheel,) = folder.glob("wsim-*-py3-none-any.whl")
    return zipfile.ZipFile(wheel).namelist()


@pytest.mark.parametrize("name", WANTED)
def test_wheel_has(names: list[str], name: str) -> None:
    assert name in names


def test_wheel_has_every_module(names: list[str]) -> None:
    modules = {path.relative_to(ROOT / "src").as_posix() for path in (ROOT / "src" / "wsim").rglob("*.py")}
    assert modules <= set(names)


def test_wheel_has_the_command_and_the_licence(names: list[str]) -> None:
    ends = {name.split(".dist-info/")[1] for name in names if ".dist-info/" in name}
    assert {"entry_points.txt", "licenses/LICENSE", "METADATA"} <= ends


def test_wheel_has_nothing_else(names: list[str]) -> None:
    assert all(name.startswith("wsim/") or ".dist-info/" in name for name in names)
    assert not [name for name in names if "__pycache__" in name or name.endswith((".pyc", ".rrd", ".mp4", ".partial"))]
