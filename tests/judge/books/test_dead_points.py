"""Four-bar linkages that swing through their dead points, where two links line up and what they bear changes at once.

The crank goes round, by its weight alone, and the loop closes by a constraint of the solver's.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books.arms import changing
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.joint import CheckJoints
from wsim.judge.checks.recorded_ties import CheckRecordedTies
from wsim.recording import Recording, read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation

THICK, DENSITY, G = 0.03, 600.0, 9.81
# Crank, coupler, rocker and base [m], and the crank's angle at the start: Grashof's crank-rockers.
LINKAGES = [(0.0698, 0.3077, 0.2337, 0.2533, 1.11), (0.1027, 0.3034, 0.1889, 0.2552, 0.681)]


def swings(folder: Path, linkage: tuple[float, ...], hidden: float = 0.0) -> Recording:
    """Two seconds of it; a motor at the rocker's pivot may give a torque [N m]."""
    crank, coupler, rocker, base, angle = linkage
    a, d = np.array((0.0, 1.0)), np.array((base, 1.0))
    b = a + crank * np.array((math.cos(angle), math.sin(angle)))
    far = float(np.linalg.norm(d - b))
    along = (d - b) / far
    x = (coupler**2 - rocker**2 + far**2) / (2.0 * far)
    c = b + x * along + math.sqrt(coupler**2 - x**2) * np.array((-along[1], along[0]))
    scene = Scene()
    scene.simulation(duration=2.0, frame_rate=60.0)
    for n, (name, (start, end)) in enumerate((("crank", (a, b)), ("coupler", (b, c)), ("rocker", (c, d)))):
        (x, z), way = (start + end) / 2.0, end - start
        scene.box(
            name, size=(float(np.linalg.norm(way)), THICK, THICK), position=(x, 0.05 * n, z), density=DENSITY,
            rotation_deg=(0.0, -math.degrees(math.atan2(way[1], way[0])), 0.0),
        )  # fmt: skip
    drive = Drive(velocity=1e6, damping=1.0, max_force=hidden) if hidden else None
    pins = (("one", None, "crank", a), ("two", "crank", "coupler", b), ("three", "coupler", "rocker", c))
    for n, (name, parent, child, (x, z)) in enumerate(pins):
        scene.joint_revolute(name, parent, child, anchor=(x, 0.05 * n - 0.025 * (n > 0), z), axis="Y")
    scene.joint_revolute("four", None, "rocker", anchor=(d[0], 0.1, d[1]), axis="Y", drive=drive)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "recording.rrd")
    return read(folder / "recording.rrd")


@pytest.mark.parametrize("linkage", LINKAGES)
def test_what_links_bear_at_a_dead_point_is_explained(tmp_path: Path, linkage: tuple[float, ...]) -> None:
    recording = swings(tmp_path, linkage)
    for check in (CheckForces(), CheckRecordedTies()):
        assert [finding.message for finding in ask(check, recording) if not finding.passed] == []
    assert all(finding.passed for finding in ask(CheckForces(), replace(recording, ties=None)))


@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("share", [0.03, 0.1])
def test_a_hidden_torque_at_a_pivot_is_found(tmp_path: Path, linkage: tuple[float, ...], share: float) -> None:
    """Of the torque by which the rocker's weight drives it: with what joints gave and, but by its motion, without."""
    driven = share * DENSITY * linkage[2] * THICK**2 * G * linkage[2] / 2.0
    recording = swings(tmp_path, linkage, driven)
    joints = [joint.model_copy(update={"drive": None}) for joint in recording.world.joints]
    told = replace(recording, world=recording.world.model_copy(update={"joints": joints}))
    (drive,) = (
        finding for finding in ask(CheckRecordedTies(), told) if "is driven, and has no drive" in finding.message
    )
    assert not drive.passed
    assert not all(finding.passed for finding in ask(CheckForces(), replace(told, ties=None)))


def test_what_arms_miss_of_a_force_that_changes() -> None:
    """A force that grows by f a frame, at arms that turn by t: t f / 12 of each interval; a blow is no such change."""
    asked = np.zeros((6, 2, 6))
    asked[:, 0, 2] = [1.0, 1.0, 4.0, 4.0, 90.0, 4.0]
    hit = np.zeros((6, 2), dtype=bool)
    hit[4, 1] = True
    found = changing(asked, np.full((6, 2), 0.2), np.array((1.0, 4.0)), hit, np.array((7, 7)))
    assert found[:, 0] == pytest.approx(0.2 / 12.0 * np.array((0.0, 3.0, 3.0, 0.0, 0.0, 0.0)))
    assert found[:, 1] == pytest.approx(found[:, 0] / 4.0)  # which the heavier one is moved less by
    alone = changing(asked, np.full((6, 2), 0.2), np.array((1.0, 4.0)), hit, np.array((7, 8)))
    assert alone[:, 1] == pytest.approx(0.0)


def parallelogram(recording: Recording, length: float, base: float, angle: float) -> Recording:
    """The exact motion of two cranks of a length and a coupler of the base's that stays level, let go at an angle.

    One angle tells all: (2 m a^2 / 3 + M a^2) q'' = -(m + M) g a cos q, of cranks m and coupler M (Lagrange); by
    Runge and Kutta's fourth order, a hundred steps a frame.
    """
    crank, coupler, _ = (body.mass for body in recording.world.bodies)
    inertia = 2.0 * recording.world.bodies[0].inertia[4] + 2.0 * crank * length**2 / 4.0 + coupler * length**2
    pull = (crank + coupler) * float(np.linalg.norm(recording.world.gravity)) * length

    def rate(state: np.ndarray) -> np.ndarray:
        return np.array((state[1], -pull * np.cos(state[0]) / inertia))

    states, now = [], np.array((angle, 0.0))
    for span in np.diff(recording.time, append=recording.time[-1] + 1e-9):
        states.append(now)
        h = float(span) / 100
        for _ in range(100):
            k1 = rate(now)
            k2 = rate(now + 0.5 * h * k1)
            k3 = rate(now + 0.5 * h * k2)
            now = now + h / 6.0 * (k1 + 2 * k2 + 2 * k3 + rate(now + h * k3))
    q, w = np.array(states).T
    body_q, body_qd = recording.body_q.copy(), recording.body_qd.copy()
    for row, (share, middle) in enumerate(((0.5, 0.0), (1.0, 0.5 * base), (0.5, base))):
        body_q[:, row, 0], body_q[:, row, 2] = middle + share * length * np.cos(q), 1.0 + share * length * np.sin(q)
        body_qd[:, row, 0], body_qd[:, row, 2] = -share * length * np.sin(q) * w, share * length * np.cos(q) * w
        body_q[:, row, 3:] = (0.0, 0.0, 0.0, 1.0)
        body_qd[:, row, 4] = 0.0
        if row != 1:  # the rocker is drawn from its upper end
            turn = 0.5 * (q + np.pi * (row == 2))
            body_q[:, row, 4], body_q[:, row, 6] = -np.sin(turn), np.cos(turn)
            body_qd[:, row, 4] = -w
    scalars = {name: array for name, array in recording.scalars.items() if not name.startswith("energy")}
    return replace(recording, body_q=body_q, body_qd=body_qd, ties=None, scalars=scalars)


def test_a_parallelogram_that_goes_through_its_change_point_is_explained(tmp_path: Path) -> None:
    """As it moves by theory: what is rejected there is an error of who simulated it."""
    linkage = (0.3, 0.6, 0.3, 0.6, 0.6)
    exact = parallelogram(swings(tmp_path, linkage), 0.3, 0.6, 0.6)
    turned = np.unwrap(-2.0 * np.arctan2(exact.body_q[:, 0, 4], exact.body_q[:, 0, 6]))
    assert turned.min() < -np.pi + 0.1 < 0.5 < turned.max()  # it goes through, and to the other side
    for check in (CheckForces(), CheckJoints(), CheckEnergy()):
        assert [finding.message for finding in ask(check, exact) if not finding.passed] == []
