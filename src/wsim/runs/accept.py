"""Acceptance: what only served the review goes, the bare program runs again, and must go the same way."""

from __future__ import annotations

import ast
import hashlib
import shutil
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wsim import recording, sim
from wsim.judge.verdict import Finding, RepairTarget, Verdict
from wsim.progress import Progress, silent
from wsim.runs.folder import RunFolder, write_json, write_whole
from wsim.runs.pipeline import Settings, run_program

if TYPE_CHECKING:
    from wsim.plan.schema import Plan

REVIEW = "review_"  # how cameras and lights are called that only served the review
_LOOKING = ("camera", "light")


@dataclass(frozen=True)
class Trajectory:
    """Where the bodies of a world went.

    Attributes:
        time: Of each frame [s], shape (T,).
        body_q: Position [m] and rotation (xyzw) of each body, shape (T, B, 7).
        particles: Where each fluid's particles are at the end [m], shape (N, 3), by prim.
    """

    time: np.ndarray
    body_q: np.ndarray
    particles: dict[str, np.ndarray]

    @classmethod
    def of(cls, path: Path) -> Trajectory:
        """A recording's."""
        found = recording.read(path)
        ends = {prim: np.asarray(track.position[-1]) for prim, track in found.fluids.items() if len(track.time)}
        return cls(np.asarray(found.time), np.asarray(found.body_q), ends)

    def distance(self, other: Trajectory) -> float:
        """Largest distance [m]; infinite if not comparable, and not a number where one is none.

        Of a body at one frame, or of a point on it 1 m from its centre, which also turns; of a particle at the end.
        """
        pairs = [(self.body_q[..., :3], other.body_q[..., :3])]
        pairs += [(2.0 * self.body_q[..., 3:], 2.0 * other.body_q[..., 3:])]  # small angles are 2 |q - q'|
        pairs += [(end, other.particles.get(prim, end[:0])) for prim, end in self.particles.items()]
        if self.particles.keys() != other.particles.keys() or any(a.shape != b.shape for a, b in pairs):
            return float("inf")
        return float(np.max([np.linalg.norm(a - b, axis=-1).max(initial=0.0) for a, b in pairs]))


def bare(program: str) -> str:
    """A program without its prints, and without cameras and lights named review_...; the text itself if it has none."""
    tree = ast.parse(program)
    used = Counter(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
    lines = program.encode().splitlines(keepends=True)  # ast counts columns in bytes
    blocks = [block for parent in ast.walk(tree) for block in _blocks(parent)]
    going = [(node, block) for block in blocks for node in block if _serves_review(node, used)]
    for node, block in sorted(going, key=lambda pair: (pair[0].lineno, pair[0].col_offset), reverse=True):
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        alone = not before.strip() and after.strip()[:1] in (b"", b"#")
        if alone and any(not _serves_review(other, used) for other in block):
            lines[first : last + 1] = []
        else:
            lines[first : last + 1] = [before + b"pass" + after]
    return b"".join(lines).decode()


def _blocks(parent: ast.AST) -> list[list[ast.stmt]]:
    found = [getattr(parent, field, None) for field in ("body", "orelse", "finalbody")]
    return [block for block in found if isinstance(block, list)]


def _serves_review(node: ast.stmt, used: Counter[str]) -> bool:
    call = node.value if isinstance(node, ast.Expr | ast.Assign) else None
    if not isinstance(call, ast.Call):
        return False
    if isinstance(node, ast.Expr) and isinstance(call.func, ast.Name) and call.func.id == "print":
        return True
    if isinstance(node, ast.Assign) and not all(isinstance(to, ast.Name) and used[to.id] == 1 for to in node.targets):
        return False  # what it is kept in is used
    named = [*call.args[:1], *(word.value for word in call.keywords if word.arg == "name")]
    return (
        isinstance(call.func, ast.Attribute)
        and call.func.attr in _LOOKING
        and any(isinstance(name, ast.Constant) and str(name.value).startswith(REVIEW) for name in named)
    )


def accept(
    run: RunFolder,
    iteration: Path,
    plan: Plan | None,
    settings: Settings | None = None,
    progress: Progress = silent,
    earlier: Trajectory | None = None,
) -> Verdict:
    """Strip an accepted iteration's program, run it again without pictures, and stamp it if it goes the same way.

    Args:
        run: The run; accepted/ gets program.py, stage.usda, acceptance.json and SHA256SUMS.
        iteration: The accepted iteration's folder.
        plan: What the bare world is judged by.
        settings: As the iteration was run.
        progress: Told how far it is.
        earlier: Another run of this very program; where nothing is stripped, it is the second run.

    Returns:
        The bare world's verdict; rejected, with the finding `CheckReproduced`, if it goes another way.
    """
    partial = run.path / "accepted.partial"
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir()
    try:
        return _confirmed(run, iteration, partial, plan, settings or Settings(), progress, earlier)
    finally:
        shutil.rmtree(partial, ignore_errors=True)  # once it is stamped, it has another name


def _confirmed(
    run: RunFolder,
    iteration: Path,
    partial: Path,
    plan: Plan | None,
    settings: Settings,
    progress: Progress,
    earlier: Trajectory | None,
) -> Verdict:
    """The verdict on the bare program, run in the folder `partial`, which becomes accepted/ if it goes the same way."""
    text = (iteration / "program.py").read_text(encoding="utf-8")
    stripped = bare(text)
    first = Trajectory.of(iteration / "recording.rrd")
    verdict = Verdict.model_validate_json((iteration / "verdict.json").read_text(encoding="utf-8"))
    if earlier is not None and stripped == text:
        second = earlier
        for name in ("program.py", "stage.usda"):
            shutil.copyfile(iteration / name, partial / name)
    else:
        write_whole(partial / "program.py", stripped)
        quiet = replace(settings, pictures=False, verify=False)
        verdict = run_program(partial / "program.py", partial, plan, quiet, progress)
        if not (partial / "recording.rrd").is_file():
            return verdict
        second = Trajectory.of(partial / "recording.rrd")
    apart = first.distance(second)
    found = _reproduced(apart, exact=_on_cpu(settings))
    if verdict.status != "accepted" or not found.passed:
        findings = [*verdict.findings, found]
        failed = sum(not finding.passed for finding in findings)
        return Verdict(status="rejected", summary=f"The bare program: {failed} findings fail.", findings=findings)
    _stamp(run, partial, apart, stripped != text)
    return verdict


def _reproduced(apart: float, exact: bool) -> Finding:
    """Whether two runs of one program went the same way; on a GPU, which rounds anew each time, it is only noted."""
    limit = 0.0 if exact else None
    passed = np.isfinite(apart) and (limit is None or apart <= limit)
    return Finding(
        check="CheckReproduced",
        passed=bool(passed),
        message=f"two runs of the program are {apart:.3g} m apart at most",
        value=apart if np.isfinite(apart) else None,
        limit=limit,
        unit="m",
        limit_from="a CPU repeats a run bit for bit" if exact else "none: a GPU rounds in another order each time",
        target=None if passed else RepairTarget(kind="program", why="it does not do the same each time"),
    )


def _on_cpu(settings: Settings) -> bool:
    return sim.pick_device(settings.device) == "cpu"


def _stamp(run: RunFolder, partial: Path, apart: float, stripped: bool) -> None:
    write_json(partial / "acceptance.json", {"stripped": stripped, "largest_distance_m": apart})
    digests = {name: hashlib.sha256((partial / name).read_bytes()).hexdigest() for name in ("program.py", "stage.usda")}
    sums = [f"{digest}  {name}\n" for name, digest in digests.items()]
    for leftover in ("recording.rrd", "verdict.json", "checks.json", "review.json"):
        (partial / leftover).unlink(missing_ok=True)
    write_whole(partial / "SHA256SUMS", "".join(sums))
    shutil.rmtree(run.path / "accepted", ignore_errors=True)
    partial.rename(run.path / "accepted")
