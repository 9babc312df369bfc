"""What is measured of a state for a recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.recording import FluidFrame, Frame
from wsim.scene.cord_paths import spring_track
from wsim.sim.ledger import Entry, Ledger
from wsim.sim.model import Built
from wsim.sim.openings import opening_scalars
from wsim.sim.rigid import RigidBodies
from wsim.solvers.solver_sph import SolverSPH

Array = np.ndarray


def measure(built: Built, state: Any, rigid: RigidBodies | None, fluid: SolverSPH | None) -> Frame:
    """Poses, velocities, contact forces, fluid, energies and errors of the first world.

    Energies [J] are relative to z = 0. The fluid's density error is relative to its rest density.
    """
    scalars: dict[str, float] = {}
    fluids: dict[str, FluidFrame] = {}
    if fluid:
        fluids, told = measure_fluids(built, state, fluid, [0])[0]
        scalars |= told
    count = len(built.bodies)
    applied: dict[str, Array] = {}
    body_q, body_qd, force = np.zeros((0, 7)), np.zeros((0, 6)), np.zeros((0, 3))
    if count:
        body_q = state.body_q.numpy()[built.bodies]
        body_qd = state.body_qd.numpy()[built.bodies]
        force, deepest = rigid.contacts_of_first_world() if rigid else (np.zeros((count, 3)), 0.0)
        force = force[built.bodies]
        scalars["contact/penetration"] = deepest
        scalars.update(_body_energy(built, body_q, body_qd))
        if rigid:
            scalars.update({name: float(value[0]) for name, value in (rigid.breakage() | rigid.began()).items()})
        if built.world.springs:
            scalars["energy/potential_springs"] = _spring_energy(built, body_q, body_qd)
        if rigid:
            applied["lead"] = rigid.take_lead()[built.bodies].astype(np.float32)
        if rigid and rigid.ledger:
            entry = rigid.ledger.take()
            scalars.update({name: float(value[0]) for name, value in drive_scalars(built, rigid.ledger, entry).items()})
            applied |= {name: value[0] for name, value in applied_of(built, rigid.ledger, entry).items()}
    scalars["energy/kinetic"] = scalars.get("energy/kinetic_bodies", 0.0) + scalars.get("energy/kinetic_fluid", 0.0)
    parts = ("bodies", "fluid", "springs")
    scalars["energy/potential"] = sum(scalars.get(f"energy/potential_{part}", 0.0) for part in parts)
    return Frame(
        body_q=body_q.astype(np.float32),
        body_qd=body_qd.astype(np.float32),
        contact_force=force.astype(np.float32),
        fluids=fluids,
        scalars=scalars,
        wall_impulse=fluid.take_wall_impulse()[0].astype(np.float32) if fluid else None,
        contacts=rigid.take_contacts() if rigid else None,
        ties=rigid.take_ties() if rigid else None,
        **applied,
    )


def drive_scalars(built: Built, ledger: Ledger, entry: Entry) -> dict[str, Array]:
    """The drives' work and how unsure it is [J], and each one's effort [N m or N], of all worlds, (W,) by name."""
    found = {"work/drives": entry.drives, "work/drives_unsure": entry.unsure}
    if ledger.observables is not None:
        labels = [str(label) for label in built.model.joint_label]
        starts = built.model.joint_qd_start.numpy()
        for joint in built.world.joints:
            if joint.drive is not None:
                name = "drive" + joint.prim.removeprefix("/World")
                found[name] = entry.effort[:, starts[labels.index(joint.prim)]]
    return found


def applied_of(built: Built, ledger: Ledger, entry: Entry) -> dict[str, Array]:
    """What was applied to each body of all worlds since the last entry, (W, B, ...) by a frame's field."""
    impulse = entry.impulse[:, built.bodies].astype(np.float32)
    applied = {"applied_impulse": impulse[..., :3], "applied_turn": impulse[..., 3:]}
    applied["applied_work"] = entry.work[:, built.bodies].astype(np.float32)
    if ledger.control is not None:
        applied["control_impulse"] = entry.control[:, built.bodies, :3].astype(np.float32)
    if ledger.scheduled is not None:
        applied["scheduled"] = entry.scheduled[:, built.bodies].astype(np.float32)
    return applied


def measure_fluids(
    built: Built, state: Any, solver: SolverSPH, worlds: Sequence[int]
) -> list[tuple[dict[str, FluidFrame], dict[str, float]]]:
    """The particles of some worlds by fluid, and what they come to: energies [J], the largest speed [m/s], the error
    of the density over the one at rest; what came, is held and went, where there are taps or drains."""
    q, qd, p = (array.numpy() for array in (state.particle_q, state.particle_qd, state.sph.pressure))
    mass = built.model.particle_mass.numpy()
    openings = solver.openings
    there = openings.free() if openings else np.ones(len(q), dtype=bool)
    passed = (openings.come(), openings.gone(), openings.take_impulse()) if openings else None
    found = []
    for w in worlds:
        at_rest = solver.at_rest(w)
        density = at_rest + p / built.sph.speed_of_sound**2
        frames = {
            prim: FluidFrame(q[part].copy(), qd[part].copy(), density[part], there[part] if openings else None)
            for prim, part in built.fluids[w].items()
        }
        part = slice(min(s.start for s in built.fluids[w].values()), max(s.stop for s in built.fluids[w].values()))
        own = np.flatnonzero(there[part]) + part.start
        error = np.abs(density[own] / (at_rest if at_rest.ndim == 0 else at_rest[own]) - 1.0)
        speed2 = np.einsum("ij,ij->i", qd[own].astype(np.float64), qd[own].astype(np.float64))
        scalars = {
            "fluid/density_error_mean": float(error.mean()) if len(own) else 0.0,
            "fluid/density_error_max": float(error.max(initial=0.0)),
            "fluid/speed_max": float(np.sqrt(speed2.max(initial=0.0))),
            "energy/kinetic_fluid": float(0.5 * (mass[own] * speed2).sum()),
            "energy/potential_fluid": float(-(mass[own] * (q[own] @ np.array(built.world_of(w).gravity))).sum()),
        }
        if passed:
            come, gone, impulse = (each[w] for each in passed)
            scalars |= opening_scalars(float(come), float(gone), float(mass[own].sum(dtype=np.float64)), impulse)
        found.append((frames, scalars))
    return found


def _spring_energy(built: Built, body_q: Array, body_qd: Array) -> float:
    """Energy that the springs hold [J]."""
    bodies = {body.prim: body for body in built.world.bodies}
    poses, twists = ({prim: row[None] for prim, row in zip(bodies, rows, strict=True)} for rows in (body_q, body_qd))
    return float(sum(spring_track(spring, bodies, poses, twists).energy[0] for spring in built.world.springs))


def _body_energy(built: Built, body_q: Array, body_qd: Array) -> dict[str, float]:
    mass = built.model.body_mass.numpy()[built.bodies].astype(np.float64)
    inertia = built.model.body_inertia.numpy()[built.bodies].astype(np.float64)
    com = built.model.body_com.numpy()[built.bodies].astype(np.float64)
    kinetic, potential = 0.0, 0.0
    for k in range(len(mass)):
        pose, twist = body_q[k].astype(np.float64), body_qd[k].astype(np.float64)
        center = pose[:3] + rotate(pose[3:], com[k])
        spin = rotate(conjugate(pose[3:]), twist[3:])
        kinetic += 0.5 * mass[k] * float(twist[:3] @ twist[:3]) + 0.5 * float(spin @ inertia[k] @ spin)
        potential -= mass[k] * float(center @ np.array(built.world.gravity))
    return {"energy/kinetic_bodies": kinetic, "energy/potential_bodies": potential}
