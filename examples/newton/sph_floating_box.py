"""SolverSPH in Newton, with no USD and nothing else of wsim: a wooden box falls into a tank of water and floats."""

import sys

import newton
import numpy as np
import warp as wp

from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

SPACING, DEPTH, TANK, BOX, G = 0.02, 0.18, (0.36, 0.36, 0.26), (0.16, 0.16, 0.12), 9.81  # [m], [m/s^2]

builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -G))
SolverSPH.register_custom_attributes(builder)
newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
x, y, z = (np.arange(0.5 * SPACING, length, SPACING) for length in (TANK[0], TANK[1], DEPTH))
water = np.stack(np.meshgrid(x - 0.5 * TANK[0], y - 0.5 * TANK[1], z, indexing="ij"), axis=-1).reshape(-1, 3)
pressure = 1000.0 * G * (DEPTH - water[:, 2])  # hydrostatic from the start
at_rest, mass = np.zeros_like(water).tolist(), [1000.0 * SPACING**3] * len(water)
builder.add_particles(water.tolist(), at_rest, mass, custom_attributes={"sph:pressure": pressure.tolist()})
box = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, DEPTH + 0.5 * BOX[2] + 0.01), wp.quat_identity()))
wood = newton.ModelBuilder.ShapeConfig(density=600.0)
builder.add_shape_box(box, hx=0.5 * BOX[0], hy=0.5 * BOX[1], hz=0.5 * BOX[2], cfg=wood)
model = builder.finalize(device=sys.argv[1] if len(sys.argv) > 1 else None)

config = SolverSPH.Config(spacing=SPACING, speed_of_sound=10.0 * (G * DEPTH) ** 0.5)  # ten times the fastest wave's
sph = SolverSPH(model, config, (OpenBox(center=(0.0, 0.0, 0.5 * TANK[2]), size=TANK),))
rigid = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=not model.device.is_cuda)
state, control, drafts = model.state(), model.control(), []
level = DEPTH + BOX[0] * BOX[1] * 0.6 * BOX[2] / (TANK[0] * TANK[1])  # of the water, once the box floats in it
for frame in range(40):
    for _ in range(steps := int(0.05 / config.max_time_step) + 1):
        state.clear_forces()
        sph.step(state, state, control, None, 0.05 / steps)  # adds the water's push to state.body_f
        rigid.step(state, state, control, None, 0.05 / steps)
    spilled = sph.check(state)
    drafts.append(level - state.body_q.numpy()[0, 2] + 0.5 * BOX[2])
    lift = state.body_f.numpy()[0, 2] / (600.0 * np.prod(BOX) * G)
    print(f"t = {0.05 * (frame + 1):.2f} s  draft {1e3 * drafts[-1]:6.1f} mm  lift {lift:.2f} of the weight")
print(f"particles: {sph.fluid_count} of water, {sph.boundary_count} of tank and box; {spilled} spilled")
mean, unrest = 1e3 * np.mean(drafts[20:]), 1e3 * np.std(drafts[20:])
print(f"draft {mean:.1f} +- {unrest:.1f} mm, Archimedes {1e3 * 0.6 * BOX[2]:.1f} mm")
