"""What a policy drives: one robot in W worlds, where it is in the model's arrays, and the network that is asked."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.assets.policies import PolicySpec
from wsim.errors import UserError
from wsim.scene.world import Policy, World
from wsim.sim.joint_arrays import in_every_world, joint_indices
from wsim.sim.networks import Network, read_network


@dataclass(frozen=True)
class Walked:
    """One robot in W worlds, and its policy.

    Attributes:
        policies: The policy as each world states it.
        network: Of all of them.
        joints: Where the J joints' coordinates, degrees of freedom and targets are, (W, J) each.
        base: Newton's indices of the bodies whose motion is felt, (W,).
        com: Their centres of mass in their own frames, (W, 3) [m].
    """

    policies: list[Policy]
    network: Network
    joints: tuple[np.ndarray, np.ndarray, np.ndarray]
    base: np.ndarray
    com: NDArray[np.float64]

    @property
    def spec(self) -> PolicySpec:
        """The description of its policy, the same in all worlds."""
        return self.policies[0].spec


def walked(model: Any, worlds: Sequence[World], bodies: np.ndarray, k: int) -> Walked:
    """What the k-th of the worlds' policies drives.

    Args:
        model: The Newton model.
        worlds: What each world states, or the one that all do.
        bodies: Newton's indices of the first world's bodies.
        k: Which of the worlds' policies it is.
    """
    count = max(1, model.world_count)
    stated = [worlds[w if len(worlds) > 1 else 0].policies[k] for w in range(count)]
    row = [body.prim for body in worlds[0].bodies].index(stated[0].base)
    base = in_every_world(bodies[[row]], count, model.body_count)[:, 0]
    com = model.body_com.numpy()[base].astype(np.float64)
    return Walked(stated, load(stated[0]), joint_indices(model, count, stated[0].joints), base, com)


def load(policy: Policy) -> Network:
    """The network of a policy, if its file is the one that the stage was made for.

    Raises:
        UserError: If it is another, or none.
    """
    path = Path(policy.network)
    if not path.is_file():
        raise UserError(f"{policy.prim}: its network {path} is not there; pull or take in the policy again")
    if hashlib.sha256(path.read_bytes()).hexdigest() != policy.sha256:
        raise UserError(f"{policy.prim}: {path} has changed since the stage was made; build it again")
    return read_network(path, policy.spec.size, len(policy.spec.joints))
