"""What is broken is mended and said so, or refused in one line that names the field and the way out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.intake import models
from wsim.intake import IntakeError, Placing, Wanted, add
from wsim.intake.model import Mesh
from wsim.intake.orient import orient
from wsim.intake.read import MOST_FACES, read
from wsim.intake.repair import repair


def stl_head(faces: int) -> bytes:
    return b"\0" * 80 + faces.to_bytes(4, "little")


def refused(path: Path, wanted: Wanted | None = None) -> str:
    with pytest.raises(IntakeError) as caught:
        add(path, wanted or Wanted("thing", picture=False))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.txt", b"words", "must end in one of .glb"),
        ("a.glb", b"", "has 0 bytes"),
        ("a.glb", b"glTF" + b"\x07" * 400, "cannot be read"),
        ("a.obj", b"no mesh at all\n", "export"),
        ("a.stl", b"\xff" * 300, "export"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement face 10000000\nend_header\n",
            f"faces = 10000000 of a.ply; at most {MOST_FACES}",
        ),
        ("a.usda", b"#usda 1.0\n(\n", "cannot be read"),
        ("a.usda", b"#usda 1.0\n", "holds no triangles"),
        ("a.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "no triangles with finite points"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 3\nv 0 2 0\nf 1 2 3\n", "thickness"),
    ],
)
def test_what_is_no_mesh_is_refused(own: Path, tmp_path: Path, name: str, data: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(data)
    assert said in refused(tmp_path / name)
    assert not own.exists() or list(own.iterdir()) == []


def test_ten_million_faces_are_refused_unread(own: Path, tmp_path: Path) -> None:
    path = tmp_path / "huge.stl"
    with path.open("wb") as stream:
        stream.write(stl_head(7_000_000))
        stream.truncate(84 + 50 * 7_000_000)
    assert f"faces = 7000000 of huge.stl; at most {MOST_FACES}: decimate it" in refused(path)


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        (Wanted("thing", Placing(height=float("nan"))), "height = nan must be a number above 0"),
        (Wanted("thing", Placing(height=1e6)), "longest edge must be 0.001 to 100 m: give another --height"),
        (Wanted("thing", Placing(unit="mile")), "unit = mile must be one of m, cm"),
        (Wanted("thing", Placing(up="w")), "up = w must be one of +x"),
        (Wanted("thing", Placing("z", "-z")), "forward = -z lies along up = z"),
        (Wanted("thing", density=0.0), "density = 0 must be"),
        (Wanted("thing", density=1.0, mass=1.0), "give one"),
        (Wanted("thing", mass=float("inf")), "mass = inf must be"),
        (Wanted("thing", category="Chairs"), "category = 'Chairs' must be a path"),
        (Wanted("thing", synonyms=["a/b"]), "synonyms: 'a/b' must be"),
        (Wanted("7 samurai"), "must begin with a letter"),
        (Wanted("../../etc", picture=False), ""),
    ],
)
def test_a_wrong_word_is_named(own: Path, tmp_path: Path, wanted: Wanted, said: str) -> None:
    path = models.write(models.box(), tmp_path / "thing.stl")
    if said:
        assert said in refused(path, wanted)
    else:
        assert add(path, wanted).path.parent == own / "etc"


def test_a_sheet_has_no_thickness(own: Path, tmp_path: Path) -> None:
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    assert "has no thickness" in refused(models.write(sheet, tmp_path / "sheet.stl"))


def solid_of(points: np.ndarray, faces: np.ndarray) -> tuple[float, list[str], bool]:
    notes: list[str] = []
    solid = repair([Mesh("m", np.asarray(points, float), np.asarray(faces))], notes)
    return solid.mesh().volume, notes, solid.closed


BALL = trimesh.creation.icosphere(subdivisions=2)


@settings(max_examples=30)
@given(st.integers(0, 2**31), st.integers(0, 6), st.integers(0, 40), st.integers(0, 20), st.booleans())
def test_a_ball_is_mended(seed: int, holes: int, turned: int, doubled: int, split: bool) -> None:
    """Faces dropped, turned over, doubled, shuffled and torn apart: the volume is a ball's again."""
    rng = np.random.default_rng(seed)
    faces = np.asarray(BALL.faces).copy()
    over = rng.choice(len(faces), turned, replace=False)
    faces[over] = faces[over, ::-1]
    faces = np.delete(faces, rng.choice(len(faces), holes, replace=False), axis=0)
    faces = np.concatenate([faces, faces[rng.integers(0, len(faces), doubled)], [[0, 0, 1]]])
    faces = faces[rng.permutation(len(faces))]
    points = np.asarray(BALL.vertices)
    if split:  # as STL has them
        points, faces = points[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    volume, notes, closed = solid_of(points, faces)
    assert any("without area" in note for note in notes)
    if closed:
        assert volume == pytest.approx(BALL.volume, rel=0.02)
    else:  # holes that touch in a point are left
        assert holes > 1 and any("not closed" in note for note in notes)


def test_each_mending_is_said() -> None:
    faces = np.asarray(BALL.faces)
    assert solid_of(BALL.vertices, faces)[1] == []
    assert "which faced inwards" in solid_of(BALL.vertices, faces[:, ::-1])[1][0]
    assert solid_of(BALL.vertices, faces[1:])[1] == ["mended: 1 small holes filled"]
    half = faces[np.asarray(BALL.triangles_center)[:, 2] < 0.3]
    _, notes, closed = solid_of(BALL.vertices, half)
    assert not closed and "not closed" in notes[0]


def test_a_room_inside_stays_a_room() -> None:
    inner = BALL.copy()
    inner.apply_scale(0.5)
    points = np.concatenate([BALL.vertices, inner.vertices])
    faces = np.concatenate([BALL.faces, np.asarray(inner.faces)[:, ::-1] + len(BALL.vertices)])
    assert solid_of(points, faces)[0] == pytest.approx(BALL.volume * (1.0 - 0.125), rel=1e-6)


@settings(max_examples=25)
@given(st.data())
def test_any_numbers_are_an_asset_or_one_line(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Points that are no numbers, faces that name points that are not there: read, or refused, never a crash."""
    number = st.one_of(st.floats(width=32), st.floats(-2, 2, width=32))
    points = data.draw(st.lists(st.tuples(number, number, number), min_size=1, max_size=8))
    faces = data.draw(st.lists(st.tuples(*[st.integers(-2, 10)] * 3), min_size=1, max_size=8))
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a} {b} {c}" for a, b, c in faces]
    path = tmp_path_factory.mktemp("any") / "any.obj"
    path.write_text("\n".join(lines))
    try:
        model = orient(read(path), Placing())
        notes: list[str] = []
        solid = repair(model.bodies[0].meshes, notes)
    except IntakeError as error:
        assert "\n" not in str(error)
        return
    assert np.isfinite(solid.points).all()
    assert np.ptp(solid.points, axis=0).max() <= 100.0


def test_an_open_shell_stays_hollow_and_says_what_it_lacks(own: Path, tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=1)
    half = trimesh.Trimesh(ball.vertices, np.asarray(ball.faces)[np.asarray(ball.triangles_center)[:, 2] < 0.2])
    half.apply_scale(0.2)
    wanted = Wanted("shell", mass=0.4, threshold=0.03, picture=False)
    asset = add(models.write(half, tmp_path / "shell.stl"), wanted)
    assert any(note.startswith("not closed: ") for note in asset.notes)
    assert any(note.startswith("what collides is a sheet of 8 mm") for note in asset.notes)
    assert asset.collision.volume_ratio is None
    assert 0.0 < asset.collision.hausdorff < 0.03  # its hull is 170 mm off, in the middle of its mouth
    assert asset.mass == pytest.approx(0.4)
