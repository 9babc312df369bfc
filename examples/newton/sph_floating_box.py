"""A Newton program that uses wsim's fluid solver and nothing else of wsim: a wooden box falls into a tank and floats.

python examples/newton/sph_floating_box.py [cpu | cuda:0]
"""

import math
import sys

import newton
import numpy as np
import warp as wp

from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

WATER, WOOD, G = 1000.0, 600.0, 9.81  # [kg/m^3], [kg/m^3], [m/s^2]
SPACING, DEPTH = 0.02, 0.18  # of the particles, of the water [m]
TANK, BOX = (0.36, 0.36, 0.26), (0.16, 0.16, 0.12)  # inside of the tank, edges of the box [m]
SECONDS, FRAME = 2.0, 0.05  # [s]


def build_model(device: str | None) -> newton.Model:
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    # Water: a particle in the middle of each cell, with the mass of the cell and the pressure of its depth.
    size = np.array([TANK[0], TANK[1], DEPTH])
    cells = [(np.arange(round(length / SPACING)) + 0.5) * SPACING for length in size]
    water = np.stack(np.meshgrid(*cells, indexing="ij"), axis=-1).reshape(-1, 3) - [0.5 * size[0], 0.5 * size[1], 0.0]
    builder.add_particles(
        pos=water.tolist(),
        vel=np.zeros_like(water).tolist(),
        mass=[WATER * SPACING**3] * len(water),
        custom_attributes={"sph:pressure": (WATER * G * (DEPTH - water[:, 2])).tolist()},
    )
    # An ordinary Newton body, a little above the water. What the box itself may touch are ordinary shapes, too.
    box = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, DEPTH + 0.5 * BOX[2] + 0.01), wp.quat_identity()))
    half, wood = [0.5 * length for length in BOX], newton.ModelBuilder.ShapeConfig(density=WOOD)
    builder.add_shape_box(box, hx=half[0], hy=half[1], hz=half[2], cfg=wood)
    builder.add_ground_plane()
    return builder.finalize(device=device)


def main(device: str | None = None) -> None:
    model = build_model(device)
    # The tank as the water sees it; its walls are sampled outward, as deep as a particle's neighbours reach.
    tank = OpenBox(center=(0.0, 0.0, 0.5 * TANK[2]), size=TANK)
    sound = 10.0 * math.sqrt(G * DEPTH)  # ten times the speed of the fastest wave
    sph = SolverSPH(model, SolverSPH.Config(spacing=SPACING, rest_density=WATER, speed_of_sound=sound), (tank,))
    on_cpu = not model.device.is_cuda
    rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=on_cpu, use_mujoco_contacts=True, nconmax=64, njmax=512)
    state, control = model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)

    steps = math.ceil(FRAME / sph.config.max_time_step)
    archimedes = BOX[2] * WOOD / WATER
    level = DEPTH + BOX[0] * BOX[1] * archimedes / (TANK[0] * TANK[1])  # once the box floats
    weight = float(model.body_mass.numpy()[0]) * G
    drafts = []
    for frame in range(1, round(SECONDS / FRAME) + 1):
        for _ in range(steps):
            state.clear_forces()
            sph.step(state, state, control, None, FRAME / steps)  # adds the water's force to state.body_f
            rigid.step(state, state, control, None, FRAME / steps)
        spilled = sph.check(state)
        drafts.append(level - (float(state.body_q.numpy()[0, 2]) - 0.5 * BOX[2]))
        lift = float(state.body_f.numpy()[0, 2]) / weight
        print(f"t = {frame * FRAME:.2f} s  draft {1e3 * drafts[-1]:6.1f} mm  lift {lift:.2f} of the weight")
    rest = np.array(drafts[len(drafts) // 2 :])
    print(f"particles: {sph.fluid_count} of water, {sph.boundary_count} of tank and box; {spilled} spilled")
    print(f"draft {1e3 * rest.mean():.1f} +- {1e3 * rest.std():.1f} mm, Archimedes {1e3 * archimedes:.1f} mm")


if __name__ == "__main__":
    main(*sys.argv[1:2])
