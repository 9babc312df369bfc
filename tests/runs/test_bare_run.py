"""The run that confirms another: ahead in a process of its own, it is the run that it would be here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wsim.judge.verdict import Verdict
from wsim.recording import read
from wsim.runs.accept import accept
from wsim.runs.bare_run import BareRun
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.runs.standby import Standby

PROGRAM = """\
from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.simulation(duration=0.3)
    scene.ground()
    scene.box("low", size=(0.2, 0.2, 0.2), density=600.0, position=(0.0, 0.0, 0.1))
    scene.box("high", size=(0.2, 0.2, 0.2), density=600.0, position=(0.05, 0.0, 0.5), rotation_deg=(20.0, 10.0, 0.0))
    print("seen")
"""


@pytest.fixture
def iteration(tmp_path: Path) -> Iteration:
    folder = tmp_path / "iterations" / "01"
    folder.mkdir(parents=True)
    (folder / "program.py").write_text(PROGRAM)
    return Iteration(folder, None, Settings(device="cpu", pictures=False))


def ran(folder: Path, iteration: Iteration, ahead: bool) -> tuple[Verdict, np.ndarray]:
    with BareRun(folder, iteration) as run:
        assert not run.as_it_was
        if ahead:
            run.start()
        verdict = run.verdict()
        body_q = np.array(read(run.iteration.recording).body_q)
    assert not folder.exists()
    return verdict, body_q


def test_ahead_it_goes_as_it_goes_here(tmp_path: Path, iteration: Iteration) -> None:
    here, q_here = ran(tmp_path / "here", iteration, ahead=False)
    ahead, q_ahead = ran(tmp_path / "ahead", iteration, ahead=True)
    assert ahead == here
    assert np.array_equal(q_ahead, q_here)


def test_one_that_is_killed_is_run_here(tmp_path: Path, iteration: Iteration) -> None:
    with BareRun(tmp_path / "killed", iteration) as run:
        run.start()
        assert run._process is not None
        run._process.process.kill()
        assert run.verdict().status == "accepted"


def test_one_that_is_not_wanted_ends_and_leaves_nothing(tmp_path: Path, iteration: Iteration) -> None:
    with BareRun(tmp_path / "unwanted", iteration) as run:
        run.start()
    assert run._process is not None
    assert run._process.process.returncode is not None
    assert not (tmp_path / "unwanted").exists()


def test_one_that_had_loaded_already_goes_as_it_goes_here(tmp_path: Path, iteration: Iteration) -> None:
    here, q_here = ran(tmp_path / "here", iteration, ahead=False)
    with Standby() as standby:
        with BareRun(tmp_path / "ahead", iteration) as run:
            run.start(standby)
            assert run.verdict() == here
            assert np.array_equal(np.array(read(run.iteration.recording).body_q), q_here)
        assert standby.process.returncode == 0


def test_one_that_is_given_nothing_ends() -> None:
    with Standby() as standby:
        assert standby.process.poll() is None
    assert standby.process.returncode is not None
    alone = Standby()
    assert alone.process.stdin is not None
    alone.process.stdin.close()
    assert not alone.done()


def test_a_world_is_accepted_by_one_that_was_started_ahead(tmp_path: Path, iteration: Iteration) -> None:
    folder = RunFolder(tmp_path)
    with BareRun(tmp_path / "bare.partial", iteration) as run:
        run.start()
        assert iteration.run().status == "accepted"
        assert accept(folder, iteration, bare_run=run).status == "accepted"
    assert "print" not in (tmp_path / "accepted" / "program.py").read_text()
