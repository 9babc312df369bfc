"""Whether ropes are where the simulator has them."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.geometry.ropes import strayed
from wsim.scene.cord_paths import moving_stops
from wsim.scene.world import World

Array = np.ndarray


def lost_ropes(world: World, bodies: Array, model: Any, body_q: Array) -> list[str]:
    """Ropes that have slipped off what they run round, as what makes a run fail.

    MuJoCo follows a rope round a cylinder as far as its strands do not come together past a half turn.

    Args:
        world: What the stage states.
        bodies: Index of each of its bodies in the model's first world.
        model: The Newton model.
        body_q: Poses of all bodies of all worlds, (bodies, 7).
    """
    ropes = [rope for rope in world.ropes if any(guide.radius > 0.0 for guide in rope.path)]
    if not ropes:
        return []
    worlds = max(1, model.world_count)
    each = body_q.reshape(worlds, -1, 7)
    poses = {body.prim: each[:, index] for body, index in zip(world.bodies, bodies, strict=True)}
    found = []
    for rope in ropes:
        held = {guide.body: poses[guide.body] for guide in rope.path if guide.body is not None}
        for place, angle in strayed(moving_stops(rope.path, held)):
            if angle.any():
                found.append(
                    f"{rope.prim} runs round <{rope.path[place].owner}> by {np.degrees(angle.max()):.0f} degrees, "
                    "where its strands come together: the simulator follows a rope by half a turn; let it end elsewhere"
                )
    return found
