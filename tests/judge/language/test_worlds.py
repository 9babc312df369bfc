"""Many worlds at once are judged as each would be alone."""

import numpy as np
import pytest

from tests.judge.language.conftest import about_axis, moving, times
from wsim.judge.language import Signals, evaluate, parse

TIME = times(2.0, 20.0)
RIGID = [
    "reaches(ball, (0.5, 0, 0.5))", "reaches(ball, box)", "stays_within(ball, box, radius 3 m)",
    "rests_on(box, ground)", "supported_by(box, ground)", "contained_in(ball, tank)", "touches(ball, wall)",
    "never_touches(ball, box)", "upright(box, 10 deg)", "speed_between(ball, 0.2 m/s, 2 m/s)",
    "follows_path(ball, [(0, 0, 0.5), (1, 0, 0.5)], 0.2 m)", "crosses(ball, x, at 0.5 m)",
    "ordered(crosses(ball, x, at 0.2 m), crosses(box, y, at 3.1 m))", "swings(box, period 1 s)",
    "rolls_without_slip(ball, ground)", "settles(box)", "conserves(energy)", "conserves(momentum, ball)",
    "collides_with(ball, wall, restitution 0.5)", "stays_inside(box, tank)",
    "touches(ball, wall) then[0.2, 1] settles(ball)", "speed_between(ball, 0, 1) until[0.5, 1.5] touches(ball, box)",
    "always[0, 1](eventually[0, 0.5](upright(box, 10 deg) or crosses(ball, x, at 0.5 m)))",
]  # fmt: skip


@pytest.fixture
def scattered(tank_world) -> Signals:
    """Six worlds of paths, turns, forces and masses by chance."""
    rng = np.random.default_rng(5)
    walk = np.cumsum(rng.normal(scale=0.03, size=(6, len(TIME), 2, 3)), axis=1)
    q = about_axis("y", np.cumsum(rng.normal(scale=0.05, size=(6, len(TIME), 2)), axis=1))
    v, w = rng.normal(size=(2, 6, len(TIME), 2, 3))
    return moving(
        tank_world, TIME, walk[:, :, 0] + [0.5, 0.0, 0.5], walk[:, :, 1] + [0.3, 3.0, 0.2],
        q=q, v=v, w=w, force=rng.normal(scale=20.0, size=v.shape), mass=rng.uniform(0.5, 3.0, size=(6, 2)),
    )  # fmt: skip


@pytest.mark.parametrize("text", RIGID)
def test_a_world_among_others_comes_out_as_it_does_alone(text, scattered):
    together = evaluate(parse(text), scattered)
    for w in range(scattered.count):
        one = slice(w, w + 1)
        alone = evaluate(
            parse(text),
            Signals(scattered.world, TIME, scattered.body_q[one], scattered.body_qd[one], scattered.contact_force[one],
                    mass=scattered.mass[one]),
        )  # fmt: skip
        assert together.margin[w] == pytest.approx(alone.margin[0], rel=1e-9, abs=1e-12)
        assert together.satisfied[w] == alone.satisfied[0] and together.moment[w] == alone.moment[0]
        assert together.units[w] == alone.units[0]


def test_float32_signals_come_out_alike(scattered):
    single = Signals(
        scattered.world, TIME, *(a.astype(np.float32) for a in (scattered.body_q, scattered.body_qd,
                                                                scattered.contact_force)),
        mass=scattered.mass,
    )  # fmt: skip
    for text in RIGID[:8]:
        expected = evaluate(parse(text), scattered).margin
        assert evaluate(parse(text), single).margin == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"body_qd": np.zeros((6, 41, 2, 7))}, r"body_qd has the shape \(6, 41, 2, 7\)"),
        ({"contact_force": np.zeros((6, 40, 2, 3))}, "contact_force has the shape"),
        ({"mass": np.ones((2, 2))}, "mass has the shape"),
        ({"time": np.zeros(41)}, "that increase"),
        ({"time": np.full(41, np.nan)}, "that increase"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(change, why, scattered):
    given = {name: getattr(scattered, name) for name in ("time", "body_q", "body_qd", "contact_force", "mass")}
    with pytest.raises(ValueError, match=why):
        Signals(scattered.world, **{**given, **change})
