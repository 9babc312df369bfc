"""Energy that blows with friction give: worlds thrown together at random, and single blows beside Stronge's law.

    python benchmarks/blow_energy.py --worlds 240
    python benchmarks/blow_energy.py --worlds 240 --newton

A world is two to eight boxes, rods, balls and capsules, some hinged in pairs, thrown on a floor and on each other for
1.5 s. The work of a step's constraints is what the bodies gain in it beside that of all other forces, of the solver's
own numbers. `--newton` takes Newton's restitution whatever friction gives, and so does its row of the second table.

The second table is of leaning rods of one contact, in a plane, whose slip is turned round. Stronge (1990) follows the
blow: what the push gives back as the surfaces part is e² of what it took as they came.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers import contact_rows
from wsim.solvers.contact_config import ContactConfig

Array = np.ndarray
SECONDS, BLOWS, PARTS = 1.5, 400, 2000


def throw(scene: Scene, rng: np.random.Generator) -> None:
    """Fill a scene."""

    def several(low: float, high: float, count: int = 3) -> list[float]:
        return [float(value) for value in rng.uniform(low, high, count)]

    def law() -> dict[str, float]:
        mu, e = several(0.0, 1.0, 2)
        return {"friction": mu, "restitution": e if rng.uniform() < 0.7 else 1.0}

    scene.ground(**law())
    most, hangs = law(), ""
    place = [0.0, 0.0, 0.0]
    for k in range(int(rng.integers(2, 9))):
        kind, name = str(rng.choice(["box", "rod", "sphere", "capsule"])), f"b{k}"
        hinged = bool(hangs) and kind != "sphere" and rng.uniform() < 0.25
        if hinged:
            place = [place[0], place[1], place[2] + 0.45]
            motion: dict[str, Any] = {"position": place}
        else:
            place = [*several(-0.5, 0.5, 2), 0.4 + 0.55 * k + float(rng.uniform(0.0, 0.1))]
            motion = {"position": place, "velocity": several(-3, 3), "angular_velocity_deg": several(-600, 600)}
            if kind != "sphere":
                motion["rotation_deg"] = several(-180, 180)
        motion |= {"density": float(10 ** rng.uniform(2.3, 3.7)), **(law() if rng.uniform() < 0.3 else most)}
        if kind == "sphere":
            scene.sphere(name, radius=float(rng.uniform(0.05, 0.18)), **motion)
        elif kind == "capsule":
            scene.capsule(name, radius=float(rng.uniform(0.02, 0.1)), height=0.3, **motion)
        else:
            size = several(0.1, 0.35) if kind == "box" else [*several(0.03, 0.06, 2), 0.4]
            scene.box(name, size=size, **motion)
        if hinged:
            anchor = [place[0], place[1], place[2] - 0.225]
            scene.joint_revolute(f"j{k}", hangs, name, anchor=anchor, axis=str(rng.choice(["X", "Y", "Z"])))
        hangs = "" if hinged else name


def works(seed: int) -> Array:
    """Of a world's steps with blows: work of all constraints, and the kinetic energy before [J], (steps, 2)."""
    scene = Scene()
    scene.simulation(frame_rate=100.0)
    throw(scene, np.random.default_rng(seed))
    with tempfile.TemporaryDirectory() as folder:
        simulation = Simulation(scene.save(Path(folder) / "stage.usda"), "cpu")
    law = simulation.rigid.solver._law_c
    mujoco, model, step, found = law.mujoco, law.model, law.step, []

    def stepped(data: Any) -> None:
        speed = data.qvel.copy()
        step(data)
        h, jump = model.opt.timestep, law.blows.jump
        slower, mass = np.zeros(data.nefc), np.zeros((model.nv, model.nv))
        mujoco.mj_mulJacVec(model, data, slower, jump)
        first = data.contact.efc_address[: data.ncon]
        first = first[first >= 0]
        if np.any((data.efc_force[first] > 0.0) & ((data.efc_vel - slower)[first] < -ContactConfig().threshold * h)):
            mujoco.mj_fullM(model, data, mass)
            flight = h * data.qacc  # after the blows, by all that acts
            gained = (jump + flight) @ mass @ (speed + 0.5 * (jump + flight))
            pushed = h * data.qfrc_smooth @ (speed + jump + 0.5 * flight)
            found.append((gained - pushed, 0.5 * speed @ mass @ speed))

    law.step = stepped
    for _ in range(round(100 * SECONDS)):
        simulation.advance_frame()
    if problems := simulation.problems():
        print(f"  world {seed} is left out: {'; '.join(problems)}")
        return np.zeros((0, 2))
    return np.array(found).reshape(-1, 2)


def worlds(count: int) -> None:
    """Print what the blows of worlds give."""
    of_worlds = [works(seed) for seed in range(count)]
    every = np.concatenate(of_worlds)
    share = every[:, 0] / every[:, 1]
    print(f"{count} worlds, {len(every)} steps with blows")
    for least in (0.001, 0.005, 0.02, 0.1):
        worst = sum(bool((each[:, 0] > least * each[:, 1]).any()) for each in of_worlds)
        print(f"  more than {least:g} of the kinetic energy given: {(share > least).sum()} steps, {worst} worlds")
    gained, lost = (np.abs(every[sign * every[:, 0] > 0.0, 0]).sum() for sign in (1, -1))
    print(f"  the most {share.max():.3g}; gains {gained:.4g} J, losses {lost:.4g} J")


def stronge(yields: Array, before: Array, mu: float, e: float) -> tuple[Array, Array]:
    """Speeds across and along the normal after a blow, and its impulse, followed by small parts of the push."""
    now, impulse, work, least = before.copy(), np.zeros(2), 0.0, 0.0
    part = -6.0 * before[1] / yields[1, 1] / PARTS
    sticks = -yields[0, 1] / yields[0, 0]  # of the push: what keeps a point that does not slip from slipping
    while True:
        rub = -mu * np.sign(now[0])
        if now[0] * (now[0] + (yields[0] @ [rub, 1.0]) * part) <= 0.0:
            now[0], rub = 0.0, float(np.clip(sticks, -mu, mu))
        push = np.array([rub, 1.0]) * part
        after = now + yields @ push
        work += 0.5 * (now[1] + after[1]) * part
        now, impulse = after, impulse + push
        if now[1] < 0.0:
            least = work
        elif work >= (1.0 - e * e) * least:
            return now, impulse


def at_once(yields: Array, before: Array, mu: float, parting: float) -> tuple[Array, Array] | None:
    """The same by Coulomb's law for the impulse, where the normal speed after the blow is given."""
    impulse = np.linalg.solve(yields, [-before[0], parting - before[1]])
    if abs(impulse[0]) <= mu * impulse[1]:
        return np.array([0.0, parting]), impulse
    for way in (1.0, -1.0):
        ratio = np.array([-mu * way, 1.0])
        impulse = ratio * (parting - before[1]) / (yields[1] @ ratio)
        after = before + yields @ impulse
        if impulse[1] > 0.0 and way * after[0] >= 0.0:
            return after, impulse
    return None


def paying(yields: Array, before: Array, mu: float, e: float) -> tuple[Array, Array] | None:
    """The same where the rebound is less by what friction gives (`wsim.solvers.targets.friction_pays`)."""
    low, high = 0.0, -e * before[1]
    for _ in range(60):
        middle = 0.5 * (low + high)
        found = at_once(yields, before, mu, middle)
        if found is None:
            return None
        (across, _), (rub, push) = found
        gives = max(rub * (before[0] + across), 0.0) / push
        low, high = (middle, high) if middle < -e * before[1] - gives else (low, middle)
    return at_once(yields, before, mu, high)


def single() -> None:
    """Print how far both laws are from Stronge's in blows whose friction gives energy by the mean of the slips."""
    rng, rows = np.random.default_rng(0), []
    while len(rows) < BLOWS:
        lean, inertia, mu, e = rng.uniform((0.05, 0.03, 0.05, 0.0), (0.5 * np.pi, 0.2, 1.0, 1.0))
        x, z = -0.5 * np.sin(lean), -0.5 * np.cos(lean)
        yields = np.array([[1.0 + z * z / inertia, -x * z / inertia], [-x * z / inertia, 1.0 + x * x / inertia]])
        before = np.array([rng.uniform(-2.0, 2.0), -1.0])
        laws = at_once(yields, before, mu, e), paying(yields, before, mu, e)
        if laws[0] is None or laws[1] is None or laws[0][1][0] * (before[0] + laws[0][0][0]) <= 1e-6:
            continue
        energy = 0.5 * before @ np.linalg.solve(yields, before)
        all_three = (*laws, stronge(yields, before, mu, e))
        rows.append([(after[1], 0.5 * push @ (before + after) / energy) for after, push in all_three])
    found = np.array(rows)
    for k, name in enumerate(("Newton", "friction pays")):
        speed, work = np.sqrt(((found[:, k] - found[:, 2]) ** 2).mean(axis=0))
        gives = (found[:, k, 1] > 1e-6).mean()
        print(f"  {name:14} off Stronge's, rms: parting {speed:.3f} of the approach, work {work:.3f} of the energy; "
              f"{100 * gives:.0f} % give energy")  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    """Run both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, default=240, help="how many are thrown together; some seconds each")
    parser.add_argument("--newton", action="store_true", help="friction pays nothing")
    args = parser.parse_args(arguments)
    if args.newton:
        contact_rows.friction_pays = lambda blow, *_: np.zeros(len(blow))
    worlds(args.worlds)
    print(f"{BLOWS} single blows whose friction gives")
    single()
    return 0


if __name__ == "__main__":
    sys.exit(main())
