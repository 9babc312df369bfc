"""Boxes of specific density 0.2 to 1.2 let go in a tank: Archimedes.

A box of specific density s and height a floats with a draft of s a; one of 1.2 sinks to the floor. The footprint is
1.6 a wide because a narrower box does not float upright: the metacentre is above the centre of gravity when
GM = s a / 2 + b^2 / (12 s a) - a / 2 > 0, that is (b / a)^2 > 6 s (1 - s), at most 1.5 (s = 1/2): b / a > 1.225. A cube
is unstable between s = 0.21 and 0.79.

The box starts a tenth of its height above its draft, on the water's lattice, with no gap around it, and the water at
hydrostatic pressure. The draft is the level less the height of the box's bottom, averaged over the last half; the level
is what the water's particles (sum of masses over the rest density) and Archimedes' displacement fill. Its error is
given in spacings: 0.2 of them are 2 % of the height at 10 particles a side, and 1 % at 20.

On a GPU the six boxes are square in plan and float in six worlds of one batch; on a CPU they float one after the
other in the plane, one metre deep, where GM is the same.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.bodies import add_body, chunks, make_rigid, outside_box, tilt
from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 1000.0, 9.81
HEIGHT = 0.2  # a
WIDTH = 1.6 * HEIGHT  # b
TANK = 0.64
DEPTH = 0.3  # about, of the water with the box in it
SOUND = 10.0 * math.sqrt(G * DEPTH)
SPECIFIC = (0.2, 0.4, 0.6, 0.8, 0.9, 1.2)
SECONDS = 5.0


def _add_box(builder: newton.ModelBuilder, specific: float, spacing: float, plane: bool) -> None:
    """Water to a level on the lattice, and a box in it that stands a tenth of its height too high."""
    draft = max(0.0, min(specific, 1.0) - 0.1) * HEIGHT
    bottom = DEPTH - draft
    deep = 1.0 if plane else WIDTH
    center = (0.0, 0.0, bottom + 0.5 * HEIGHT)
    cells = lattice((-0.5 * TANK, -0.5 * TANK, 0.0), (0.5 * TANK, 0.5 * TANK, DEPTH), spacing, plane)
    cells = cells[outside_box(cells, center, (0.5 * WIDTH, 0.5 * deep, 0.5 * HEIGHT))]
    volume = spacing**2 if plane else spacing**3
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    body = add_body(builder, center, plane)
    wood = newton.ModelBuilder.ShapeConfig(density=specific * RHO)
    builder.add_shape_box(body, hx=0.5 * WIDTH, hy=0.5 * deep, hz=0.5 * HEIGHT, cfg=wood)
    builder.add_ground_plane()  # what a body that sinks comes to lie on


def _float(device: str, spacing: float, specific: tuple[float, ...], plane: bool, seconds: float) -> tuple:
    """Run some boxes, each in its world. Returns times, heights of the bottoms [m], tilts [deg], water [kg], counts."""
    builder = make_builder((0.0, 0.0, -G))
    for s in specific:
        single = make_builder((0.0, 0.0, -G))
        _add_box(single, s, spacing, plane)
        if len(specific) == 1:
            builder = single
        else:
            builder.add_world(single)
    model = builder.finalize(device=device)
    config = SolverSPH.Config(spacing=spacing, rest_density=RHO, speed_of_sound=SOUND, dimensions=2 if plane else 3)
    height = 0.45
    tank = OpenBox(center=(0.0, 0.0, 0.5 * height), size=(TANK, 1.0 if plane else TANK, height))
    solver, rigid = SolverSPH(model, config, (tank,)), make_rigid(model)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    times, bottoms, tilts = [], [], []

    def observe(t: float) -> None:
        pose = state.body_q.numpy()
        times.append(t)
        bottoms.append(pose[:, 2] - 0.5 * HEIGHT)
        tilts.append(tilt(pose[:, 3:7]))

    simulate(solver, state, seconds, samples=round(40 * seconds), observe=observe, rigid=rigid)
    world = np.maximum(model.particle_world.numpy(), 0)
    water = np.bincount(world, weights=model.particle_mass.numpy().astype(float))
    return np.array(times), np.array(bottoms), np.array(tilts), water, solver.count


def run(device: str, spacing: float, seconds: float = SECONDS, specific: tuple[float, ...] = SPECIFIC) -> Measured:
    """Let the boxes go and measure their drafts."""
    started = time.perf_counter()
    plane = not wp.get_device(device).is_cuda
    area = TANK * (1.0 if plane else TANK)
    foot = WIDTH * (1.0 if plane else WIDTH)
    errors, figures, curves = {"draft": 0.0, "sunk": 0.0, "tilt": 0.0}, {}, {}
    particles = 0
    for some in chunks(specific, 1 if plane else len(specific)):
        t, bottoms, tilts, water, count = _float(device, spacing, some, plane, seconds)
        particles += count
        late = t > 0.5 * seconds
        for k, s in enumerate(some):
            if s >= 1.0:
                errors["sunk"] = max(errors["sunk"], float(bottoms[-1, k]) / spacing)
                figures[f"bottom above floor, s = {s} [spacings]"] = float(bottoms[-1, k]) / spacing
                continue
            level = (water[k] / RHO + foot * s * HEIGHT) / area
            draft = level - bottoms[:, k]
            off = float(draft[late].mean()) - s * HEIGHT
            errors["draft"] = max(errors["draft"], abs(off) / spacing)
            errors["tilt"] = max(errors["tilt"], float(tilts[late, k].max()))
            figures[f"draft off, s = {s} [% of height]"] = 100.0 * off / HEIGHT
            figures[f"still moving, s = {s} [% of height]"] = 100.0 * float(np.ptp(draft[late])) / HEIGHT
            curves[f"s = {s}, {round(HEIGHT / spacing)} a side"] = (t, draft / HEIGHT)
            curves[f"reference s = {s}"] = (t[[0, -1]], np.array([s, s]))
    return Measured(errors, figures, curves, particles, seconds, time.perf_counter() - started)


CASE = Case(
    name="box_draft",
    title="Draft of boxes",
    reference="Archimedes",
    reach={"draft": 0.2, "sunk": 1.0, "tilt": 2.0},
    unit={"draft": "spacings", "sunk": "spacings", "tilt": "deg"},
    coarse=(0.02, 0.01),
    fine=(0.02, 0.01),
    run=run,
    axes=("time [s]", "draft / height"),
)
