"""Run folders: never overwritten, files whole or absent."""

import hashlib
import subprocess
import sys

import pytest

from tests.patience import STUCK
from wsim.errors import UserError
from wsim.runs.folder import RunFolder, slug, write_whole


def test_slug_is_short_and_plain():
    assert slug("Three wooden blocks float, while a ball sinks!") == "three-wooden-blocks-float-while-a-ball"
    assert slug("///..//") == "run"


def test_folders_of_the_same_second_do_not_meet(tmp_path):
    paths = {RunFolder.create(tmp_path, "same title").path for _ in range(4)}
    assert len(paths) == 4


@pytest.mark.parametrize("below", ["", "deeper"])
def test_a_link_to_nowhere_is_named(tmp_path, below):
    (tmp_path / "runs").symlink_to(tmp_path / "gone")
    with pytest.raises(UserError, match=r"runs is a link to .*gone, which is not there; name another with --runs"):
        RunFolder.create(tmp_path / "runs" / below, "a")


@pytest.mark.parametrize("below", ["", "deep/er"])
def test_a_file_where_runs_would_be_is_named(tmp_path, below):
    """By `wsim generate` before the simulator is loaded, which takes seconds."""
    (tmp_path / "runs").write_text("a file")
    said = rf"{tmp_path / 'runs'} is a file; choose another with --runs"
    with pytest.raises(UserError, match=said):
        RunFolder.create(tmp_path / "runs" / below, "run")
    script = (
        "import sys; from wsim.cli import main\ntry: main()\n"
        "except SystemExit as end: print('code', end.code, 'newton' in sys.modules)"
    )
    command = [
        sys.executable,
        "-c",
        script,
        "generate",
        "A ball rolls.",
        "--yes",
        "--runs",
        str(tmp_path / "runs" / below),
    ]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=STUCK)
    assert done.stdout.splitlines()[-1] == "code 2 False"
    assert "choose another with --runs" in done.stderr


def test_run_json_grows(tmp_path):
    run = RunFolder.create(tmp_path, "a")
    run.record(prompt="p")
    run.record(status="accepted")
    assert run.facts() == {"prompt": "p", "status": "accepted"}


def test_open_finds_the_run_from_inside_it(tmp_path):
    run = RunFolder.create(tmp_path, "a")
    run.record(prompt="p")
    assert RunFolder.open(run.iteration(1)).path.resolve() == run.path.resolve()
    assert RunFolder.open(run.path).last_iteration().name == "01"
    with pytest.raises(UserError, match="does not exist"):
        RunFolder.open(tmp_path / "nothing")
    with pytest.raises(UserError, match=r"run\.json"):
        RunFolder.open(tmp_path)


def test_accepted_has_checksums(tmp_path):
    run = RunFolder.create(tmp_path, "a")
    iteration = run.iteration(1)
    (iteration / "program.py").write_text("x = 1\n")
    (iteration / "stage.usda").write_text("#usda 1.0\n")
    accepted = run.stamp(iteration)
    for line in (accepted / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((accepted / name).read_bytes()).hexdigest() == digest
    assert not (run.path / "accepted.partial").exists()


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "file.json"
    write_whole(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "new \udcff")
    assert path.read_text() == "old"
