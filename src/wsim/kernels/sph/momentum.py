"""Momentum equation, and the step of velocity and position."""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import wrap
from wsim.kernels.sph.neighbors import Neighborhood, Search, pairs_of
from wsim.kernels.sph.pair_sums import OPTIONS, PairSums
from wsim.kernels.sph.records import load_record

# Of h^2: keeps two particles at one place from dividing by zero. Monaghan's 0.01 would weaken viscosity by 1.5 %.
COINCIDENT = wp.constant(1.0e-4)


def make_momentum(search: Search, sums: PairSums) -> wp.Kernel:
    """The kernel that sums forces and moves the fluid."""
    runs, span_of, fluid_span_of, sum_run = search.runs, search.span, search.fluid_span, sums.force

    @wp.kernel(enable_backward=False, module="unique", module_options=OPTIONS)
    def momentum(
        # Data in:
        first: int,
        nb: Neighborhood,
        method: Method,
        rest_density: wp.array(dtype=float),
        viscosity: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        point: wp.array(dtype=wp.vec4),
        motion: wp.array(dtype=wp.vec4),
        fluid_mass: wp.array(dtype=float),
        fixed_count: int,
        dt: float,
        # Data out:
        fluid_position: wp.array(dtype=wp.vec3),
        fluid_velocity: wp.array(dtype=wp.vec3),
        boundary_force: wp.array(dtype=wp.vec3),
    ):
        """Move each fluid particle, and find the fluid's force on each particle of a body, in original order.

        F_i = -V_i sum V_j (p_i + p_j) grad W                                (Colagrossi & Landrini 2003)
            + V_i sum V_j alpha h c rho_0 min(v_ij.x_ij, 0) / r^2 grad W      (Monaghan 1992)
            + V_i sum V_j K mu v_ij.x_ij / r^2 grad W                         (Monaghan & Gingold 1983)

        where r^2 stands for r^2 + 1e-4 h^2. The pressure term is the adjoint of the continuity equation's divergence,
        so that fluid pairs exchange no energy but by the viscous terms. Every pair's force is along x_ij and opposite
        for j: momentum and angular momentum are kept to rounding. K is 2(d + 2) where the sum is an integral (Violeau
        2012); `ConfigSPH.laminar_factor` has it for a sum. Velocity is kicked first, and the new velocity moves the
        particle (symplectic Euler).
        """
        s = first + wp.tid()
        i = nb.order[s]
        if i >= nb.fluid_count and i < nb.fluid_count + fixed_count:
            return
        p = load_record(point, s)
        m = load_record(motion, s)
        fluid = i < nb.fluid_count
        x = wp.vec3(p[0], p[1], p[2])
        v = wp.vec3(m[0], m[1], m[2])
        world = nb.particle_world[i]
        artificial = method.artificial_viscosity * method.h * method.speed_of_sound * rest_density[world]
        laminar = method.laminar_factor * viscosity[world]
        eta2 = COINCIDENT * method.h * method.h
        own = m[3] + 2.0 * method.background_pressure
        pairs = pairs_of(nb, point, motion, method.shape)
        total = wp.vec3(0.0, 0.0, 0.0)
        viscous = wp.vec3(artificial, laminar, eta2)
        solids = wp.where(fluid, 1.0, 0.0)
        for run in range(runs(nb, x)):
            if fluid:
                span = span_of(nb, s, world, x, run)
            else:
                span = fluid_span_of(nb, s, world, x, run)
            total += sum_run(pairs, span[0], span[1], x, v, own, viscous, solids)
        if fluid:
            v = v + dt * (p[3] / fluid_mass[i] * total + gravity[world])
            fluid_velocity[i] = v
            fluid_position[i] = wrap(nb.grid, x + dt * v)
        else:
            boundary_force[i - nb.fluid_count - fixed_count] = -p[3] * total

    return momentum
