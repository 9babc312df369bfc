"""What may be changed of a run beside its program: the solver before it starts, its state, what is recorded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from wsim.recording import Frame
from wsim.scene.world import World

ROOT = "/World/"


@dataclass
class Tamper:
    """Changes a run. Subclasses are dataclasses, whose fields say by how much; `repr` names the change."""

    def prepare(self, simulation: Any) -> None:
        """Change the solver before the first step."""

    def stepped(self, simulation: Any) -> None:
        """Change the state after a step."""

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """What is recorded of a frame."""
        return frame


def simulate(stage: Path, recording: Path, tamper: Tamper | None = None, pictures: bool = False) -> None:
    """Simulate a stage on the CPU into a recording, tampered with or not.

    Raises:
        RuntimeError: If the run broke, which no fault here is meant to do, or the tampering had no turn at each of its
            steps and frames.
    """
    from wsim.sim import Simulation

    tamper = tamper or Tamper()
    simulation = Simulation(stage, device="cpu")
    tamper.prepare(simulation)
    with _tampered(simulation, tamper) as turns:
        result = simulation.run(recording, video=recording.with_name("video.mp4") if pictures else None)
    if result.problems:
        raise RuntimeError(f"{recording}: {'; '.join(result.problems)}")
    for name, count in (("stepped", result.steps), ("frame", result.frames)):
        if getattr(type(tamper), name) is not getattr(Tamper, name) and turns[name] != count:
            raise RuntimeError(f"{tamper!r} had {turns[name]} turns of {count} at its {name}: it is no fault")


@contextmanager
def _tampered(simulation: Any, tamper: Tamper) -> Iterator[Counter[str]]:
    """A run that is tampered with: how often its steps and its frames were."""
    from wsim.sim import simulation as module

    measure, turns = module.measure, Counter[str]()

    def advanced() -> None:
        """A frame step by step: what is alone goes a whole frame in C otherwise, where nobody has a turn."""
        for _ in range(simulation.substeps):
            simulation.step()
            tamper.stepped(simulation)
            turns["stepped"] += 1

    def measured(*arguments: Any) -> Frame:
        turns["frame"] += 1
        return tamper.frame(simulation.time, measure(*arguments), simulation.world)

    if type(tamper).stepped is not Tamper.stepped:
        simulation.advance_frame = advanced
    with mock.patch.object(module, "measure", measured):
        yield turns


def row(world: World, name: str) -> int:
    """The row of a body by its name; KeyError."""
    for k, body in enumerate(world.bodies):
        if body.prim == ROOT + name:
            return k
    raise KeyError(f"no body {name!r}; the world has {[body.prim for body in world.bodies]}")


def twist(simulation: Any, name: str) -> tuple[np.ndarray, int]:
    """All bodies' velocities (bodies, 6), and the row of one."""
    return simulation.state.body_qd.numpy(), int(simulation.built.bodies[row(simulation.world, name)])


def set_twist(simulation: Any, twists: np.ndarray) -> None:
    """Give the bodies other velocities (bodies, 6) from nowhere."""
    import newton

    state = simulation.state
    state.body_qd.assign(twists)
    newton.eval_ik(simulation.model, state, state.joint_q, state.joint_qd)
