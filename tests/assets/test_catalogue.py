"""The catalogue: strict metadata, errors that say what to do, and nothing heavy to import."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from wsim.assets import AssetError, assets_folder, get, load_catalogue
from wsim.errors import UserError

ASSETS = Path(__file__).parents[2] / "usd_assets"


@pytest.fixture
def mug(tmp_path: Path) -> Path:
    """A catalogue of one asset, that can be spoilt."""
    shutil.copytree(ASSETS / "mug", tmp_path / "mug")
    return tmp_path


def spoil(folder: Path, **changes: object) -> str:
    """The error of metadata with these changes; None takes a field away."""
    path = folder / "mug" / "asset.json"
    data = json.loads(path.read_text()) | changes
    path.write_text(json.dumps({key: value for key, value in data.items() if value is not None}))
    with pytest.raises(AssetError) as error:
        load_catalogue(folder)
    assert isinstance(error.value, UserError)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_shipped_assets_are_found() -> None:
    assert assets_folder() == ASSETS
    assert list(load_catalogue()) == sorted(path.parent.name for path in ASSETS.glob("*/asset.json"))
    assert load_catalogue() is load_catalogue()


def test_get() -> None:
    assert get("mug").path == ASSETS / "mug" / "asset.usda"
    assert get("mug").size == pytest.approx((0.082, 0.12, 0.095), abs=1e-3)


@pytest.mark.parametrize(
    ("id", "said"), [("tabel", "did you mean 'table'?"), ("bookcase", "'shelf'"), ("zzz", "known: anvil")]
)
def test_unknown_id(id: str, said: str) -> None:
    with pytest.raises(AssetError, match=f"no asset '{id}'") as error:
        get(id)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"size": [0.1, -0.1, 0.1]}, "mug/asset.json: size[1] = -0.1 must be three edges (x, y, z)"),
        ({"size": [0.1, 0.1]}, "size"),
        ({"mass": "heavy"}, 'mass = "heavy" must be a number > 0 in kg'),
        ({"mass": 0.0}, "mass = 0.0 must be a number > 0 in kg"),
        ({"license": None}, "license is missing; add it: its licence"),
        ({"weight": 1.0}, "weight is not a field; remove it"),
        ({"massa": 1.0}, "massa is not a field; remove it, or call it 'mass'"),
        ({"names": ["Mug"]}, "names[0]"),
        ({"names": []}, "names = [] must be what people call it"),
        ({"names": ["mug", "mug"]}, "names has a name twice"),
        ({"up_axis": "+Y"}, 'up_axis = "+Y" must be "+Z"'),
        ({"category": "mug"}, "category"),
        ({"file": "../crate/asset.usda"}, "file"),
        ({"file": "other.usda"}, 'file = "other.usda" is not there'),
        ({"id": "cup"}, "must be the name of its folder, 'mug'"),
        ({"anchors": {"top": [0.0, 0.0, 9.0]}}, "anchors.top = [0.0, 0.0, 9.0] lies outside the box"),
        ({"hollow": {"size": [0.1, 0.1, 0.5], "center": [0.0, 0.0, 0.05]}}, "hollow reaches out of the box"),
        ({"articulated": "no"}, 'articulated = "no" must be true if it has joints'),
    ],
    ids=lambda value: str(value)[:40],
)
def test_wrong_metadata(mug: Path, changes: dict, said: str) -> None:
    assert said in spoil(mug, **changes)


def test_infinite_number(mug: Path) -> None:
    path = mug / "mug" / "asset.json"
    path.write_text(path.read_text().replace('"mass": ', '"mass": 1e999, "x": '))
    with pytest.raises(AssetError, match="mass"):
        load_catalogue(mug)


def test_not_json(mug: Path) -> None:
    (mug / "mug" / "asset.json").write_text("{")
    with pytest.raises(AssetError, match=r"mug/asset\.json"):
        load_catalogue(mug)


def test_tables_of_the_document_are_those_of_the_catalogue() -> None:
    page = ASSETS.parent / "docs" / "assets.md"
    script = (
        "import sys; from pathlib import Path; sys.stdin.reconfigure(encoding='utf-8'); "
        "sys.stdout.reconfigure(encoding='utf-8'); "
        f"sys.path.insert(0, {str(ASSETS)!r}); import author; "
        f"sys.stdout.write(author.document(sys.stdin.read(), author.tables(Path({str(ASSETS)!r}))))"
    )
    text = page.read_text(encoding="utf-8")
    command = [sys.executable, "-c", script]
    made = subprocess.run(command, input=text, capture_output=True, text=True, check=True, encoding="utf-8").stdout
    assert made == text
    assert all(f"| `{id}`" in text for id in load_catalogue())
    pictures = {line.split("](")[1].rstrip(")") for line in text.splitlines() if line.startswith("![")}
    assert pictures and all((page.parent / picture).is_file() for picture in pictures)


def test_import_is_light() -> None:
    script = "import wsim.assets, sys; print(*{m.split('.')[0] for m in sys.modules})"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert {"newton", "warp", "pxr", "mujoco", "numpy", "rerun"}.isdisjoint(done.stdout.split())
