"""Sound trajectories that nobody here wrote, judged: MuJoCo's models of other projects, and Newton's other solvers.

The models are in wheels; none is part of this repository:

    pip download --no-deps -d wheels gymnasium dm_control
    for wheel in wheels/*.whl; do python -m zipfile -e "$wheel" models; done
    .venv/bin/python benchmarks/judge_others.py models

Those in mujoco-warp's test data are run, too, where that is installed. Each model is run by plain MuJoCo at its own
time step from random states without deep contacts, without controls and, where it has actuators, with random ones. A
sound trajectory must not be rejected; the same in which gravity is a tenth less, or a force pushes that the model does
not have, should be. A run that takes more core time than `--limit` is given up, and counted as such.
"""

from __future__ import annotations

import argparse
import importlib.util
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import mujoco
import numpy as np

from wsim.errors import UserError
from wsim.importers import read_npz
from wsim.importers.trajectory import from_arrays
from wsim.judge import judge

SECONDS = 1.5
RATE = 60  # frames a second, as near as the time step allows
DEEP = 1e-3  # [m]: no state is drawn in which anything is deeper in another
PUSH = 0.3  # of the whole weight: the ghost's force
FAULTS = ("gravity", "ghost")
LIMIT = 300.0  # [s] of core time, of one run and its verdict


class TakesTooLong(BaseException):
    """A run has passed its limit; no `Exception`, as the judge goes on past those of a check."""


@dataclass
class Row:
    """One run's verdict."""

    model: str
    fault: str  # "" of a sound one
    status: str
    message: str
    seconds: float  # of core time

    def line(self) -> str:
        """As printed."""
        return f"{self.status:9} {self.fault or 'sound':8} {self.seconds:5.1f} s  {self.model:60} {self.message}"


def main() -> None:
    """Run all models, print a row for each run and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, help="folders with MJCF files, such as unpacked wheels")
    parser.add_argument("--draws", type=int, default=1, help="random states of each model")
    parser.add_argument("--only", default="", help="a part of the path of the models to run")
    parser.add_argument("--without", default="", help="parts of paths not to run, with commas between")
    parser.add_argument("--newton", action="store_true", help="and small worlds by Newton's other solvers")
    parser.add_argument("--faults", action="store_true", help="run them with faults, too")
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds of core time after which a run is given up")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGPROF, give_up)
    rows = []
    for path in models(arguments.folders):
        if arguments.only not in str(path) or any(part in str(path) for part in arguments.without.split(",") if part):
            continue
        for row in judged(path, arguments.draws, arguments.faults, arguments.limit):
            print(row.line(), flush=True)
            rows.append(row)
    for row in newton_rows() if arguments.newton else ():
        print(row.line(), flush=True)
        rows.append(row)
    summarize(rows)
    sys.exit(any(row.status in ("rejected", "error") and not row.fault for row in rows))


def models(folders: list[Path]) -> list[Path]:
    """All MJCF files there are."""
    spec = importlib.util.find_spec("mujoco_warp")
    if spec is not None and spec.submodule_search_locations:
        folders = [*folders, Path(spec.submodule_search_locations[0]) / "test_data"]
    return [path for folder in folders for path in sorted(folder.rglob("*.xml"))]


def give_up(*_: object) -> NoReturn:
    """What the alarm of a run's limit does."""
    raise TakesTooLong


def judged(path: Path, draws: int, faults: bool, limit: float) -> Iterator[Row]:
    """The rows of one model; none where MuJoCo does not read it, or nothing in it moves."""
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, RuntimeError):
        return
    if model.nv == 0:
        return
    for seed in range(draws):
        for controls in (False, True) if model.nu else (False,):
            name = f"{'/'.join(path.parts[-3:])} {seed}{' controls' if controls else ''}"
            row = one(path, name, seed, controls, "", limit)
            yield row
            if faults and row.status == "accepted":
                for fault in FAULTS:
                    if fault != "gravity" or np.any(model.opt.gravity):
                        yield one(path, name, seed, controls, fault, limit)


def newton_rows() -> Iterator[Row]:
    """Worlds that Newton's XPBD and Featherstone solvers run, by their velocities and by their poses alone."""
    from judge_others_newton import runs  # it loads Newton

    for name, world, arrays in runs():
        for poses in (False, True):
            start = time.process_time()
            kept = {key: array for key, array in arrays.items() if not (poses and key == "body_qd")}
            verdict = judge(from_arrays(kept, world))
            failures = [f"{finding.check}: {finding.message}" for finding in verdict.failures]
            title = f"{name}{', poses alone' if poses else ''}"
            yield Row(title, "", verdict.status, "; ".join(failures[:1]), time.process_time() - start)


def one(path: Path, name: str, seed: int, controls: bool, fault: str, limit: float) -> Row:
    """Run, import and judge one."""
    start = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        with tempfile.TemporaryDirectory() as folder:
            np.savez(Path(folder) / "run.npz", **run(path, seed, controls, fault))
            verdict = judge(read_npz(Path(folder) / "run.npz", path))
        failures = verdict.failures
        message = f"{failures[0].check}: {failures[0].message}" if failures else ""
        if len(failures) > 1:
            message += f" (+ {', '.join(sorted({f.check for f in failures[1:]}))})"
        status = verdict.status
    except FloatingPointError as error:
        status, message = "no run", str(error)
    except UserError as error:
        status, message = "error", str(error)
    except Exception as error:  # noqa: BLE001 - a crash is what this looks for
        status, message = "error", f"{type(error).__name__}: {error}"
        traceback.print_exc()
    except TakesTooLong:
        status, message = "given up", f"takes more than {limit:g} s"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return Row(name, fault, status, message, time.process_time() - start)


def run(path: Path, seed: int, controls: bool, fault: str) -> dict[str, np.ndarray]:
    """Times and states of a model from a random state, (T,), (T, nq) and (T, nv).

    Raises:
        FloatingPointError: MuJoCo's own integration fails, or no state without deep contacts was found.
    """
    model = mujoco.MjModel.from_xml_path(str(path))
    data, random = mujoco.MjData(model), np.random.default_rng(seed)
    place(model, data, random)
    if fault == "gravity":
        model.opt.gravity *= 0.9
    body = int(np.argmax(model.body_mass * (model.body_weldid > 0)))
    every = max(1, round(1.0 / RATE / model.opt.timestep))
    steps = round(SECONDS / model.opt.timestep)
    low, high = np.where(model.actuator_ctrllimited[:, None], model.actuator_ctrlrange, [-1.0, 1.0]).T
    rows: dict[str, list[Any]] = {"time": [], "qpos": [], "qvel": []}
    for step in range(steps + 1):
        if step % every == 0:
            for key, values in rows.items():
                values.append(np.copy(getattr(data, key)))
            if controls:
                data.ctrl[:] = low + (high - low) * random.uniform(0.0, 1.0, model.nu)
        pushed = fault == "ghost" and 0.3 <= step / steps < 0.6
        data.xfrc_applied[body, 0] = PUSH * 9.81 * float(model.body_mass[1:].sum()) if pushed else 0.0
        mujoco.mj_step(model, data)
    if not np.isfinite(rows["qpos"]).all() or any(warning.number for warning in data.warning[3:]):
        raise FloatingPointError("MuJoCo's own run is not stable")
    return {key: np.array(values) for key, values in rows.items()}


def place(model: Any, data: Any, random: np.random.Generator) -> None:
    """A random state near the model's own, with nothing deep in another."""
    for trial in range(40):
        mujoco.mj_resetData(model, data)
        spread = 0.4 * 0.9**trial
        velocity = random.normal(0.0, spread, model.nv)
        mujoco.mj_integratePos(model, data.qpos, random.normal(0.0, spread, model.nv), 1.0)
        for j in range(model.njnt):
            at = model.jnt_qposadr[j]
            if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE:
                data.qpos[at + 2] += 0.1 * trial * model.stat.extent
            elif model.jnt_limited[j] and model.jnt_type[j] != mujoco.mjtJoint.mjJNT_BALL:
                data.qpos[at] = np.clip(data.qpos[at], *model.jnt_range[j])
        data.qvel[:] = velocity
        mujoco.mj_forward(model, data)
        held = np.abs(data.efc_pos[: data.ne]).max(initial=0.0)  # of equalities, which a draw may break
        if held < DEEP and (data.ncon == 0 or data.contact.dist.min() > -DEEP):
            return
        if held >= DEEP and trial % 2:  # near the model's own state they hold
            mujoco.mj_resetData(model, data)
            mujoco.mj_forward(model, data)
            held = np.abs(data.efc_pos[: data.ne]).max(initial=0.0)
            if held < DEEP and (data.ncon == 0 or data.contact.dist.min() > -DEEP):
                return
    raise FloatingPointError("no state without deep contacts found")


def summarize(rows: list[Row]) -> None:
    """Print the sums."""
    sound = [row for row in rows if not row.fault]
    print(f"\n{len(sound)} sound runs: {dict(Counter(row.status for row in sound))}")
    for status in ("blocked", "rejected", "error", "given up"):
        for message, count in Counter(cause(row) for row in sound if row.status == status).most_common():
            print(f"  {status} {count:3}: {message}")
    for fault in FAULTS:
        faulty = [row for row in rows if row.fault == fault]
        print(f"{fault}: {sum(row.status == 'rejected' for row in faulty)} of {len(faulty)} rejected")


def cause(row: Row) -> str:
    """Why, without the names of one model."""
    if row.status == "blocked":
        return row.message.split(" has ", 1)[-1].split(" (")[0]
    return row.message.split(":")[0]


if __name__ == "__main__":
    main()
