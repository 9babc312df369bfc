"""`python program.py`: both halves in one process, with a person's own program."""

from __future__ import annotations

import atexit
import gc
import shutil
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from wsim import report
from wsim import runs as passes
from wsim.cli.options import EXIT_CODES
from wsim.cli.show import ConsoleProgress, show_verdict
from wsim.door import keep_what_loads
from wsim.errors import UserError
from wsim.runs.folder import RunFolder
from wsim.runs.pulled import pull_missing
from wsim.runs.settings import Settings
from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage


def run_in_process(build: Callable[[Scene], None]) -> None:
    """Build, simulate and judge the calling program; leaves a run folder under ./runs, prints the verdict.

    Exits like `wsim run`: 0 accepted, 1 rejected, 3 blocked, 2 for a mistake in the program's calls.
    """
    keep_what_loads()  # the process ends with the run
    atexit.register(gc.freeze)
    program = Path(sys.modules[build.__module__].__file__ or "program.py")
    run = RunFolder.create("runs", program.stem)
    run.record(prompt=None, program=str(program), in_process=True)
    folder = run.iteration(1)
    shutil.copyfile(program, folder / "program.py")
    scene = Scene()
    try:
        with ConsoleProgress() as progress:
            pull_missing(program.read_text(encoding="utf-8"), progress)
        build(scene)
        problems = check_stage(scene.save(folder / "stage.usda"), [folder.resolve().anchor])
        if problems:
            raise UserError(f"{problems[0]}{f' (and {len(problems) - 1} more)' if len(problems) > 1 else ''}")
        with ConsoleProgress() as progress:
            # The simulator loads now: what the program's calls have wrong was said before.
            iteration = passes.Iteration(folder, None, Settings(isolation="none"), progress, program)
            verdict = iteration.conclude(iteration.happen())
    except (UserError, SceneError) as error:
        run.record(status="stopped", summary=str(error))
        print(f"{_place(error, program)}: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    if verdict.status == "accepted":
        run.stamp(folder)
    run.record(status=verdict.status, summary=verdict.summary)
    show_verdict(verdict, run.path, report.write(run.path))
    raise SystemExit(EXIT_CODES[verdict.status])


def _place(error: Exception, program: Path) -> str:
    """The program's name and, where the error came through it, the line."""
    calls = traceback.extract_tb(error.__traceback__)
    lines = [call.lineno for call in calls if Path(call.filename).resolve() == program.resolve()]
    return f"{program.name}:{lines[-1]}" if lines else program.name
