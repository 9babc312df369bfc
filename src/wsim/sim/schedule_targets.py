"""What schedules reach of MuJoCo's own: surfaces that run, pairs that rub, joints that let go, what meets what."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.geometry.rotations import conjugate, rotate
from wsim.kernels import schedules as kernels
from wsim.scene.contact import within
from wsim.scene.world import Event, Schedule, World
from wsim.sim.contacts import shape_prims
from wsim.solvers.packed import Packed

Array = np.ndarray


def geoms_of(solver: Any, model: Any, world: World, owner: str) -> Array:
    """MuJoCo's geoms of an object, in every world."""
    prims = shape_prims(model, world)
    shapes = solver.mjc_geom_to_newton_shape.numpy()[0]
    return np.array([g for g, k in enumerate(shapes) if k >= 0 and within(prims[k % len(prims)], owner)], dtype=int)


def _of(world: World, quantity: str) -> list[int]:
    return [k for k, each in enumerate(world.schedules) if each.quantity == quantity]


class Meetings:
    """Notes which pairs of objects have pressed on each other.

    Attributes:
        met: (W, touches), and one more column where there is none.
    """

    def __init__(self, solver: Any, model: Any, world: World, touches: Sequence[Event], worlds: int) -> None:
        self.met = wp.zeros((worlds, max(1, len(touches))), dtype=int)
        if not touches:
            return
        side = np.zeros((len(touches), solver.mj_model.ngeom), dtype=int)
        for e, event in enumerate(touches):
            for bit, owner in ((1, event.first), (2, event.second or "")):
                side[e, geoms_of(solver, model, world, owner)] |= bit
        self._side = side
        if not solver.use_mujoco_cpu:
            self._on_device = wp.array(side, dtype=int)
        solver.tell_contacts(self._note_c if solver.use_mujoco_cpu else self._note_warp)

    def _note_c(self, data: Any) -> None:
        contact, met = data.contact, self.met.numpy()
        rows = np.asarray(contact.efc_address[: data.ncon])
        rows, geoms = rows[rows >= 0], np.asarray(contact.geom[: data.ncon])[rows >= 0]
        one, two = (self._side[:, geoms[data.efc_force[rows] > 0.0, side]] for side in (0, 1))
        met[0] |= (((one & 1) * (two & 2)) | ((one & 2) * (two & 1))).any(axis=1)

    def _note_warp(self, data: Any) -> None:
        contact = data.contact
        wp.launch(
            kernels.note_meetings,
            dim=data.naconmax,
            inputs=[data.nacon, contact.worldid, contact.geom, contact.efc_address, data.efc.force, self._on_device],
            outputs=[self.met],
        )


class Runners:
    """Surfaces of what never moves, that run by schedules."""

    def __init__(self, solver: Any, model: Any, worlds: Sequence[World], count: int) -> None:
        own = _of(worlds[0], "surface_velocity")
        geoms = [geoms_of(solver, model, worlds[0], worlds[0].schedules[k].target) for k in own]
        self._solver, self._geom = solver, np.concatenate([*geoms, np.zeros(0, dtype=int)])
        self._schedule = np.repeat(own, [len(each) for each in geoms]).astype(int)
        if not len(self._geom):
            return
        solver.mj_model.flg_surfacevel = 1
        self._turn = conjugate(solver.mj_model.geom_quat[self._geom][:, [1, 2, 3, 0]])
        self._stated: Any = solver.mj_model.geom_surfacevel.copy()
        if not solver.use_mujoco_cpu:
            self._prepare_warp(worlds, count)

    def _prepare_warp(self, worlds: Sequence[World], count: int) -> None:
        model = self._solver.mjw_model
        rows = model.geom_surfacevel.numpy()
        rows = np.broadcast_to(rows[np.arange(count) % len(rows)], (count, *rows.shape[1:]))
        model.flg_surfacevel = True
        model.geom_surfacevel = wp.array(rows, dtype=wp.spatial_vector)
        self._stated = wp.clone(model.geom_surfacevel)
        quat = model.geom_quat.numpy()[:, self._geom]  # w, x, y, z
        turns = conjugate(quat[..., [1, 2, 3, 0]].reshape(-1, 4)).reshape(quat.shape)
        self._arrays = [
            wp.array(self._schedule, dtype=int), wp.array(self._geom, dtype=int), wp.array(turns, dtype=wp.quat),
        ]  # fmt: skip

    def set(self, packed: Packed, acts: Any, mean: Any) -> None:
        """Set them for a step."""
        if not len(self._geom):
            return
        if self._solver.use_mujoco_cpu:
            on = acts.numpy()[0, self._schedule] != 0
            value = rotate(self._turn[on], mean.numpy()[0, self._schedule[on]])
            self._solver.mj_model.geom_surfacevel[self._geom[on], :3] = value
            return
        packed.launch(
            kernels.run_surfaces, dim=(acts.shape[0], len(self._geom)), inputs=[acts, mean, *self._arrays],
            outputs=[self._solver.mjw_model.geom_surfacevel],
        )  # fmt: skip

    def reset(self) -> None:
        """As stated."""
        if not len(self._geom):
            return
        if self._solver.use_mujoco_cpu:
            self._solver.mj_model.geom_surfacevel[:] = self._stated
        else:
            wp.copy(self._solver.mjw_model.geom_surfacevel, self._stated)


class Pairs:
    """Friction of pairs by schedules."""

    def __init__(self, solver: Any, model: Any, worlds: Sequence[World], count: int) -> None:
        self._solver, pairs, self._schedule = solver, [], []
        contacts = {pair.prim: pair for pair in worlds[0].contacts}
        for k in _of(worlds[0], "friction"):
            pair = contacts[worlds[0].schedules[k].target]
            one, two = (geoms_of(solver, model, worlds[0], owner) for owner in (pair.first, pair.second))
            own = {(a, b) for a in solver.classes_of(one) for b in solver.classes_of(two)}
            pairs += sorted(own)
            self._schedule += [k] * len(own)
        self._classes = np.array(pairs, dtype=int).reshape(-1, 2)
        if not pairs:
            return
        self._law = solver.friction_law(count)
        self._stated = self._law.copy() if solver.use_mujoco_cpu else wp.clone(self._law)
        if not solver.use_mujoco_cpu:
            self._arrays = [wp.array(self._schedule, dtype=int), wp.array(self._classes, dtype=int)]

    def set(self, packed: Packed, acts: Any, mean: Any) -> None:
        """Set it for a step."""
        if not len(self._classes):
            return
        least = self._solver.contact_config.smallest_friction
        if self._solver.use_mujoco_cpu:
            for k, (one, two) in zip(self._schedule, self._classes.tolist(), strict=True):
                if acts.numpy()[0, k]:
                    value = max(float(mean.numpy()[0, k, 0]), least)
                    self._law[one, two, 0] = self._law[two, one, 0] = value
            return
        packed.launch(
            kernels.rub_pairs, dim=(acts.shape[0], len(self._classes)),
            inputs=[acts, mean, *self._arrays, least], outputs=[self._law],
        )  # fmt: skip

    def reset(self) -> None:
        """As stated."""
        if not len(self._classes):
            return
        if self._solver.use_mujoco_cpu:
            self._law[:] = self._stated
        else:
            wp.copy(self._law, self._stated)


class Releases:
    """Joints that let go: they break, whatever they bear."""

    def __init__(self, solver: Any, schedules: Sequence[Schedule], breakable: Sequence[str]) -> None:
        self._solver = solver
        self._own = [(k, list(breakable).index(each.target)) for k, each in enumerate(schedules)
                     if each.quantity == "release"]  # fmt: skip
        if self._own and not solver.use_mujoco_cpu:
            self._arrays = [wp.array([pair[side] for pair in self._own], dtype=int) for side in (0, 1)]

    def let_go(self, packed: Packed, clocks: list[Any]) -> None:
        """Let those go whose time has come as a step begins; `clocks` are its number, its length, keys and starts."""
        if not self._own:
            return
        breaking = self._solver.breaking
        if not self._solver.use_mujoco_cpu:
            packed.launch(
                kernels.release_joints, dim=(clocks[3].shape[0], len(self._own)),
                inputs=[*clocks, *self._arrays, breaking.constraint],
                outputs=[breaking.broken, self._solver.mjw_data.eq_active],
            )  # fmt: skip
            return
        step, h, keys, begin = clocks
        now = float(step.numpy()[0]) * float(h)
        for k, joint in self._own:
            start = float(begin.numpy()[0, k])
            if start >= 0.0 and now >= start + float(keys.times.numpy()[0, k, 0]) - 1e-9:
                breaking.release(self._solver.mj_data, joint)
