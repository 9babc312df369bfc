"""What bodies could be stepped by: wsim's law of contact beside MuJoCo's own contacts and Newton's other solvers.

    python benchmarks/rigid_means.py --write
    python benchmarks/rigid_means.py --means "wsim" "XPBD"

Small worlds with a known answer, each the same USD stage for all, on one core at one time step. `--write` puts the
table into docs/rigid.md. A solver that leaves the answer by more than a metre or is not finite reads "lost".
Newton's Kamino is left out: on a core its step of one crate takes hundreds of milliseconds.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import newton
import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation

Array = np.ndarray
G, STEP = 9.81, 1.25e-3
DOCUMENT = Path(__file__).resolve().parents[1] / "docs/rigid.md"
MARKS = re.compile(r"(?<=<!-- means:begin -->\n).*?(?=<!-- means:end -->)", re.DOTALL)


@dataclass(frozen=True)
class Means:
    """A solver of Newton's and how it is set; without a solver, wsim.

    Attributes:
        solver: Its name in `newton.solvers`.
        options: For its constructor.
        solref: MuJoCo's time constant of contacts, in steps; None for MuJoCo's own, 20 ms.
        solimp: MuJoCo's impedance at the surface; None for its own, 0.9.
        substeps: Of a step.
    """

    solver: str = ""
    options: dict[str, Any] = field(default_factory=dict)
    solref: float | None = None
    solimp: float | None = None
    substeps: int = 1


C = {"use_mujoco_cpu": True, "use_mujoco_contacts": True}
ELLIPTIC = {**C, "cone": "elliptic"}
MEANS = {
    "wsim": Means(),
    "MuJoCo": Means("SolverMuJoCo", C),
    "MuJoCo, elliptic cones": Means("SolverMuJoCo", ELLIPTIC),
    "… contacts of 2.5 steps": Means("SolverMuJoCo", ELLIPTIC, solref=2.5),
    "… and impedance 0 at the surface": Means("SolverMuJoCo", ELLIPTIC, solref=2.5, solimp=0.0),
    "… four substeps": Means("SolverMuJoCo", ELLIPTIC, solref=2.5, substeps=4),
    "MuJoCo Warp, Newton's contacts": Means("SolverMuJoCo", {"use_mujoco_contacts": False, "cone": "elliptic"}),
    "XPBD": Means("SolverXPBD", {"enable_restitution": True}),
    "XPBD, four substeps": Means("SolverXPBD", {"enable_restitution": True}, substeps=4),
    "VBD": Means("SolverVBD"),
    "semi-implicit": Means("SolverSemiImplicit"),
    "Featherstone": Means("SolverFeatherstone"),
}


@dataclass(frozen=True)
class Run:
    """What the bodies did, from `STEP` to `STEP`.

    Attributes:
        place: Origins [m], (rows, bodies, 3).
        velocity: Of the centres of mass [m/s], (rows, bodies, 3).
        spin: In the world's axes [rad/s], (rows, bodies, 3).
        turn: Quaternions xyzw, (rows, bodies, 4).
        cost: Of a row [s].
    """

    place: Array
    velocity: Array
    spin: Array
    turn: Array
    cost: float


def simulate(means: Means, build: Callable[[Scene], None], seconds: float, step: float) -> Run:
    """A world by these means."""
    scene = Scene()
    scene.simulation(frame_rate=1.0 / STEP, time_step=step)
    build(scene)
    with tempfile.TemporaryDirectory() as folder:
        stage = scene.save(Path(folder) / "stage.usda")
        advance, read = _newton(means, stage, step) if means.solver else _wsim(stage, step)
    rows, spent = [read()], 0.0
    for _ in range(round(seconds / STEP)):
        started = time.perf_counter()
        advance()
        spent += time.perf_counter() - started
        rows.append(read())
    poses, twists = (np.array([row[k] for row in rows], dtype=float) for k in range(2))
    return Run(poses[..., :3], twists[..., :3], twists[..., 3:], poses[..., 3:], spent / (len(rows) - 1))


Stepper = tuple[Callable[[], Any], Callable[[], tuple[Array, Array]]]


def _wsim(stage: Path, step: float) -> Stepper:
    simulation = Simulation(stage, "cpu", time_step=step)
    bodies = simulation.built.bodies

    def read() -> tuple[Array, Array]:
        state = simulation.state
        return state.body_q.numpy()[bodies].copy(), state.body_qd.numpy()[bodies].copy()

    return simulation.advance_frame, read


def _newton(means: Means, stage: Path, step: float) -> Stepper:
    """Newton's import of the stage under one of its solvers, as its examples step one."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    kind = getattr(newton.solvers, means.solver)
    kind.register_custom_attributes(builder)
    builder.add_usd(str(stage), apply_up_axis_from_stage=True)
    if means.solver == "SolverVBD":
        builder.color()
    model = builder.finalize(device="cpu")
    count = means.substeps * round(STEP / step)
    solver, h = kind(model, **means.options), STEP / count
    if means.solref is not None:
        solver.mj_model.geom_solref[:] = means.solref * h, 1.0
    if means.solimp is not None:
        solver.mj_model.geom_solimp[:, 0] = means.solimp
    states, control = [model.state(), model.state()], model.control()
    for state in states:
        newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    own = means.solver == "SolverMuJoCo" and means.options["use_mujoco_contacts"]

    def advance() -> None:
        for _ in range(count):
            states[0].clear_forces()
            solver.step(states[0], states[1], control, None if own else model.collide(states[0]), h)
            states.reverse()

    def read() -> tuple[Array, Array]:
        return states[0].body_q.numpy().copy(), states[0].body_qd.numpy().copy()

    return advance, read


Measure = Callable[[Means], tuple[float, ...]]


def crate(means: Means) -> tuple[float, ...]:
    """A crate at 3 m/s, μ = 0.3: how far it comes, v² / (2 μ g) = 1.529 m, and how high it hops, 0 [mm]."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.3)
        scene.box("crate", size=(0.4, 0.4, 0.4), density=300, position=(0, 0, 0.2), velocity=(3, 0, 0), friction=0.3)

    run = simulate(means, build, 1.3, STEP)
    return float(run.place[-1, 0, 0]), 1e3 * float(run.place[:, 0, 2].max() - 0.2)


def ramp(means: Means) -> tuple[float, ...]:
    """A box on a ramp 1° below atan μ creeps by 0 [mm] in 1 s."""
    lean = math.atan(0.364) - math.radians(1.0)

    def build(scene: Scene) -> None:
        scene.box("ramp", size=(8, 1, 0.2), rotation_deg=(0, math.degrees(lean), 0), static=True, friction=0.364)
        scene.box("box", size=(0.2, 0.2, 0.2), density=600, position=(0.2 * math.sin(lean), 0, 0.2 * math.cos(lean)),
                  rotation_deg=(0, math.degrees(lean), 0), friction=0.364)  # fmt: skip

    place = simulate(means, build, 1.0, STEP).place
    return (1e3 * float(np.linalg.norm(place[-1, 0] - place[0, 0])),)


def _bounce(means: Means, step: float) -> float:
    """How high a ball of e = 0.9 comes back from 1 m, 0.81 [m]."""

    def build(scene: Scene) -> None:
        scene.ground(restitution=0.9)
        scene.sphere("ball", radius=0.1, density=500, position=(0, 0, 1.1), restitution=0.9)

    height = simulate(means, build, 0.95, step).place[:, 0, 2] - 0.1
    return float(height[round(0.6 / STEP) :].max())


def bounce(means: Means) -> tuple[float, ...]:
    """How high a ball of e = 0.9 comes back from 1 m at 1.25 and 0.625 ms, 0.81 [m]."""
    return _bounce(means, STEP), _bounce(means, 0.5 * STEP)


def row(means: Means) -> tuple[float, ...]:
    """An elastic ball at 2 m/s hits four in a row: the last leaves at 2 [m/s]."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.0)
        for k in range(5):
            scene.sphere(f"ball_{k}", radius=0.1, density=500, position=(0.2 * k - (0.3 if k == 0 else 0.0), 0, 0.1),
                         velocity=(2 if k == 0 else 0, 0, 0), restitution=1.0, friction=0.0)  # fmt: skip

    return (float(simulate(means, build, 0.4, STEP).velocity[-1, 4, 0]),)


def slip(means: Means) -> tuple[float, ...]:
    """A ball that starts sliding at 3 m/s comes to roll at 5/7 of it, 2.143 [m/s]."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.5)
        scene.sphere("ball", radius=0.1, density=500, position=(0, 0, 0.1), velocity=(3, 0, 0), friction=0.5)

    return (float(simulate(means, build, 0.8, STEP).velocity[-1, 0, 0]),)


def stack(means: Means) -> tuple[float, ...]:
    """Ten boxes in a stack move by 0 [mm] in 1 s; the cost of a step [ms]."""

    def build(scene: Scene) -> None:
        scene.ground()
        for k in range(10):
            scene.box(f"box_{k}", size=(0.2, 0.2, 0.2), density=500, position=(0, 0, 0.1 + 0.2 * k))

    run = simulate(means, build, 1.0, STEP)
    return 1e3 * float(np.linalg.norm(run.place[-1] - run.place[0], axis=1).max()), 1e3 * run.cost


def tumble(means: Means) -> tuple[float, ...]:
    """A box that spins about its middle axis at 10 rad/s, falling: its spin's energy changes by 0 [%] in 2 s."""
    size = np.array((0.1, 0.2, 0.3))

    def build(scene: Scene) -> None:
        scene.ground(height=-100.0)
        scene.box("box", size=tuple(size), density=500, position=(0, 0, 0),
                  angular_velocity_deg=(0.5, math.degrees(10.0), 0))  # fmt: skip

    run = simulate(means, build, 2.0, STEP)
    moments = (size**2).sum() - size**2
    energies = [float((moments * _turned_back(run.turn[k, 0], run.spin[k, 0]) ** 2).sum()) for k in (0, -1)]
    return (100.0 * (energies[1] / energies[0] - 1.0),)


def _turned_back(turn: Array, vector: Array) -> Array:
    """A vector of the world in the axes of a body."""
    way, w = -turn[:3], turn[3]
    return vector + 2.0 * np.cross(way, np.cross(way, vector) + w * vector)


COLUMNS: tuple[tuple[Measure, tuple[str, ...], tuple[float | None, ...]], ...] = (
    (crate, ("crate's way [m]", "hop [mm]"), (3.0**2 / (2 * 0.3 * G), 0.0)),
    (ramp, ("creep on a ramp [mm]",), (0.0,)),
    (bounce, ("rise, e = 0.9 [m]", "… at 0.625 ms [m]"), (0.81, 0.81)),
    (row, ("last of a row [m/s]",), (2.0,)),
    (slip, ("slip to roll [m/s]",), (15.0 / 7.0,)),
    (stack, ("stack of ten moves [mm]", "its step [ms]"), (0.0, None)),
    (tumble, ("energy of what tumbles [%]",), (0.0,)),
)


def cells(means: Means) -> list[str]:
    """A row of the table."""
    found: list[str] = []
    for measure, names, _ in COLUMNS:
        try:
            values: tuple[float, ...] = measure(means)
        except Exception as error:  # noqa: BLE001  a solver that does not take the world says why
            print(f"  {measure.__name__}: {type(error).__name__}: {str(error)[:200]}", file=sys.stderr, flush=True)
            values = (math.nan,) * len(names)
        found += [f"{value:.3g}" if abs(value) < 1e3 else "lost" for value in values]
    return found


def main(arguments: list[str] | None = None) -> int:
    """Run the worlds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--means", nargs="+", choices=list(MEANS), default=list(MEANS))
    parser.add_argument("--write", action="store_true", help="put the table into docs/rigid.md; needs all means")
    args = parser.parse_args(arguments)
    if args.write and len(args.means) < len(MEANS):
        parser.error("--write: the table is of all means; leave out --means")
    known = [value for _, _, values in COLUMNS for value in values]
    rows = [["means", *(name for _, names, _ in COLUMNS for name in names)], ["---"] * (len(known) + 1)]
    rows.append(["known", *("" if value is None else f"{value:.4g}" for value in known)])
    for name in args.means:
        rows.append([name, *cells(MEANS[name])])
        print(f"| {' | '.join(rows[-1])} |", flush=True)
    text = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    if args.write:
        side = DOCUMENT.with_name(DOCUMENT.name + ".part")
        side.write_text(MARKS.sub(lambda _: text, DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
        side.replace(DOCUMENT)
    return 0


if __name__ == "__main__":
    sys.exit(main())
