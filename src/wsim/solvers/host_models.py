"""MuJoCo's model as each world of a batch has it: MuJoCo itself keeps that of the first world alone."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
import warp as wp

Array = np.ndarray
SHORT_CUTS = ("body_sameframe", "geom_sameframe", "site_sameframe", "body_simple", "dof_simplenum")


def host_models(solver: Any, differ: bool) -> Iterator[Any]:
    """MuJoCo's model of all worlds alike, or of one after another, in one object that is filled anew for each.

    Args:
        solver: Newton's MuJoCo solver.
        differ: Whether worlds differ in numbers.
    """
    if not differ:
        yield solver.mj_model
        return
    model, own = copy.copy(solver.mj_model), _of_worlds(solver)
    for short_cut in SHORT_CUTS:  # that hold for the first world's frames
        getattr(model, short_cut)[:] = 0
    targets = [(getattr(model, name), values) for name, values in own.items()]
    targets = [(target, values.reshape(-1, *target.shape)) for target, values in targets]
    for k in range(solver.model.world_count):
        for target, values in targets:
            target[:] = values[k]
        if k == 0:  # what all worlds have alike is there now
            targets = [(target, values) for target, values in targets if (values != values[:1]).any()]
        yield model


def _of_worlds(solver: Any) -> dict[str, Array]:
    """What MuJoCo Warp's model has for each world, by the name that it has in MuJoCo's."""
    worlds, found = solver.model.world_count, {}
    for field in fields(solver.mjw_model):
        ours, values = getattr(solver.mj_model, field.name, None), getattr(solver.mjw_model, field.name)
        if not isinstance(ours, Array) or not isinstance(values, wp.array) or not ours.size:
            continue
        numbers = values.numpy()
        if numbers.shape[:1] == (worlds,) and numbers[0].size == ours.size:
            found[field.name] = numbers
    return found
