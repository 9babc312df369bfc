"""Objectives that are worked out on the device come to what the language says, in every world."""

from dataclasses import replace

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.judge.language import Signals, evaluate
from wsim.judge.language import python as say
from wsim.judge.language.objective import conjuncts
from wsim.judge.worlds import verdicts_of
from wsim.plan.schema import Plan
from wsim.plan.schema.formula import Always, Eventually, Finally, Mean, Predicate
from wsim.recording.trajectories import Trajectories
from wsim.scene import Scene
from wsim.scene.world import Body, Shape, Static, World
from wsim.sim import Simulation
from wsim.sim.collect import follow
from wsim.sweep import screen
from wsim.sweep.batch import judged
from wsim.sweep.work import as_varied

WORLDS, FRAMES, RATE = 6, 25, 20.0
COLOR = (0.5, 0.3, 0.1)
WOOD = {"name": "wood", "density": 500.0, "color": COLOR, "friction": 0.3}


def world_of(edge):
    bodies = []
    for name, kind, size in (("box", "box", (edge, 2 * edge, 3 * edge)), ("ball", "sphere", (edge,))):
        shape = Shape.model_validate({"prim": f"/World/{name}/geometry", "kind": kind, "size": size})
        bodies.append(
            Body(
                prim=f"/World/{name}", mass=1.0, volume=1.0, inertia=(1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0),
                position=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0, 1.0), shapes=[shape],
            )
        )  # fmt: skip
    ground = Static(prim="/World/ground", shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=())])
    return World(duration=(FRAMES - 1) / RATE, frame_rate=RATE, bodies=bodies, statics=[ground])


def moving(seed, varied):
    """Worlds whose bodies go, turn and tumble anyhow; with sizes of their own, or all of one."""
    draw = np.random.default_rng(seed)
    shape = WORLDS, FRAMES, 2
    q, qd = np.zeros((*shape, 7), np.float32), draw.normal(size=(*shape, 6)).astype(np.float32)
    q[..., :3] = np.cumsum(draw.normal(scale=0.2, size=(*shape, 3)), axis=1)
    turn = np.array([0.0, 0.0, 0.0, 2.0]) + np.cumsum(draw.normal(scale=0.2, size=(*shape, 4)), axis=1)
    q[..., 3:] = turn / np.linalg.norm(turn, axis=-1, keepdims=True)
    if not varied:  # what one stage states starts in one way
        q[:, 0] = q[0, 0]
    worlds = [world_of(float(edge)) for edge in draw.uniform(0.1, 0.5, size=WORLDS)]
    force = np.zeros((*shape, 3), np.float32)
    return Trajectories(
        worlds[0], np.arange(FRAMES) / RATE, q, qd, force, worlds=worlds if varied else (), metadata={"time_step": 1e-3}
    )


def plan_of(*formulas, seconds=(FRAMES - 1) / RATE, rate=RATE):
    asked = [{"kind": "formula", "object": "box", "formula": each.model_dump(mode="json")} for each in formulas]
    things = [
        {"name": name, "role": "rigid_body", "state": "dynamic", "material": WOOD,
         "construction": {"kind": "proxy", "primitive": kind, "size": size}}
        for name, kind, size in (("box", "box", [0.2] * 3), ("ball", "sphere", [0.1]))
    ]  # fmt: skip
    things.append(
        {"name": "ground", "role": "terrain", "state": "static",
         "construction": {"kind": "proxy", "primitive": "ground"}}
    )  # fmt: skip
    return Plan.model_validate(
        {"title": "any", "prompt": "They go.", "objects": things, "objectives": asked,
         "simulation": {"duration": seconds, "frame_rate": rate}}
    )  # fmt: skip


def told_by(worlds, plan, device="cpu"):
    starts = replace(
        worlds, time=worlds.time[:1], body_q=worlds.body_q[:, :1], body_qd=worlds.body_qd[:, :1],
        contact_force=worlds.contact_force[:, :1],
    )  # fmt: skip
    asked = screen.watched(plan, starts, worlds.time)
    q = wp.array(worlds.body_q, dtype=wp.transform, device=device)
    qd = wp.array(worlds.body_qd, dtype=wp.spatial_vector, device=device)
    return asked, screen.reduce(asked, q, qd, worlds.world) if asked else None


PLACES = st.tuples(*[st.floats(-2.0, 2.0)] * 3).map(lambda p: tuple(round(x, 3) for x in p))
ENDS = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)).map(sorted)
NAMES, AXES = st.sampled_from(["box", "ball"]), st.sampled_from("xyz")
PREDICATES = st.one_of(
    st.builds(say.settles, NAMES, st.none() | st.floats(0.1, 5.0)),
    st.builds(lambda name, ends: say.speed_between(name, *(abs(x) for x in sorted(map(abs, ends)))), NAMES, ENDS),
    st.builds(say.reaches, NAMES, PLACES, st.none() | st.floats(0.1, 2.0)),
    st.builds(say.stays_within, NAMES, st.one_of(PLACES, st.sampled_from(["ground", "ball"])), st.floats(0.1, 5.0)),
    st.builds(say.crosses, NAMES, AXES, st.floats(-2.0, 2.0)),
    st.builds(say.moves, NAMES, st.none() | st.floats(0.1, 2.0), st.none() | st.sampled_from(["front", "left"])),
    st.builds(lambda name, axis, ends: say.gone_between(name, axis, *ends), NAMES, AXES, ENDS),
    st.builds(lambda within: say.upright("box", within), st.none() | st.floats(1.0, 170.0)),
    st.builds(
        lambda axis, ends, of: say.spin_between("box", axis, *(60.0 * x for x in ends), of=of),
        AXES, ENDS, st.sampled_from([None, "ball"]),
    ),
)  # fmt: skip
WINDOWS = st.none() | st.tuples(st.floats(0.0, 0.5), st.floats(0.6, 1.0))


@st.composite
def formulas(draw):
    inner = draw(PREDICATES)
    if draw(st.booleans()):
        inner = ~inner
    kind = draw(st.sampled_from(["alone", "always", "eventually", "finally", "mean"]))
    if kind == "mean":
        over = draw(st.sampled_from([{}, {"seconds": 0.4}, {"window": (0.3, 0.8)}, {"window": (0.5, None)}]))
        found = Mean(of=inner if isinstance(inner, Predicate) else inner.of, **over)
    elif kind == "finally":
        found = Finally(of=inner, seconds=draw(st.none() | st.sampled_from([0.0, 0.3])))
    elif kind == "alone":
        found = inner
    else:
        found = (Always if kind == "always" else Eventually)(of=inner, window=draw(WINDOWS))
    return ~found if draw(st.booleans()) else found


@settings(max_examples=150, deadline=None)
@given(formulas(), st.integers(0, 9), st.booleans())
def test_margins_are_the_languages(formula, seed, varied):
    worlds = moving(seed, varied)
    asked, told = told_by(worlds, plan_of(formula))
    assert len(conjuncts(formula)) == 1
    if not asked:  # between frames the language may find it kept
        denied = screen.in_time(formula, worlds.time).sign < 0.0
        assert any(isinstance(each, screen.LOST_BETWEEN if denied else screen.KEPT_BETWEEN) for each in formula.walk())
        return
    for w in range(WORLDS):
        one = slice(w, w + 1)
        arrays = (each[one] for each in (worlds.body_q, worlds.body_qd, worlds.contact_force))
        outcome = evaluate(formula, Signals(worlds.world_of(w), worlds.time, *arrays))
        if isinstance(asked[0].when.predicate, screen.KEPT_BETWEEN + screen.LOST_BETWEEN):
            assert told.margin[0, w] >= float(outcome.margin[0]) - 1e-6  # what it rejects the language does
            continue
        assert told.margin[0, w] == pytest.approx(float(outcome.robustness[0]), rel=1e-9, abs=1e-6)
        assert worlds.time[told.moment[0, w]] == pytest.approx(float(outcome.moment[0]))
        assert told.margin[0, w] == pytest.approx(float(outcome.margin[0]), rel=1e-9, abs=1e-6)


@pytest.mark.cuda
def test_a_gpu_says_the_same():
    kinds = [
        say.settles("ball"), say.speed_between("box", 0.5, 4.0), ~say.reaches("box", (0.0, 0.0, 0.5), 0.4),
        say.stays_within("box", "ball", 2.0), ~say.crosses("ball", "z", 0.2), say.moves("box", 0.3),
        say.gone_between("ball", "y", -0.5, 0.5), say.upright("box", 20.0), say.spin_between("box", "x", -60.0, 90.0),
    ]  # fmt: skip
    asked = [
        *kinds,
        *(Eventually(of=~kind) for kind in kinds),
        *(Mean(of=kind) for kind in kinds if isinstance(kind, Predicate)),
    ]
    for varied in (False, True):
        here, there = (told_by(moving(3, varied), plan_of(*asked), device)[1] for device in ("cpu", "cuda:0"))
        assert there.margin == pytest.approx(here.margin, rel=1e-9, abs=1e-6)
        assert np.array_equal(there.moment, here.moment)


FAULTS = ("none", "hovers", "is not a number", "leaps", "spins")


def planted(tracks, faults):
    """Faults in what the device has kept, one in each world; on a CPU its arrays are NumPy's."""
    q, qd = tracks.bodies.q.numpy(), tracks.bodies.qd.numpy()
    for w, fault in enumerate(faults):
        if fault == "hovers":
            q[w, 8:, 0, 2] += 0.05
        elif fault == "is not a number":
            q[w, 9, 0, 0] = np.nan
        elif fault == "leaps":
            q[w, 5:, 0, 0] += 0.3
        elif fault == "spins":
            qd[w, :, 0, 5] += 3.0


def test_statuses_are_the_full_judges(tmp_path):
    """Boxes that slide to rest, of which some are to go farther than they do, some hold a fault, and some do both."""
    speeds = [speed for speed in (0.8, 1.2, 1.6) for _ in FAULTS]
    stages = []
    for k, speed in enumerate(speeds):
        scene = Scene()
        scene.simulation(duration=0.5, frame_rate=40.0)
        scene.ground(friction=0.3)
        wood = {"density": 500.0, "color": COLOR, "friction": 0.3}
        scene.box("box", size=(0.2,) * 3, position=(0, 0, 0.1), velocity=(speed, 0, 0), **wood)
        scene.sphere("ball", radius=0.1, position=(0, 2, 0.1), **wood)
        stages.append(scene.save(tmp_path / f"{k}.usda"))
    tracks = follow(Simulation(stages, device="cpu"))
    planted(tracks, FAULTS * 3)
    # v^2 / 2 g mu, or what is gone of it in half a second: 0.109, 0.232, 0.432 m
    plan = plan_of(say.gone_between("box", "x", 0.15, 0.3), say.settles("ball"), seconds=0.5, rate=40.0)
    early, full = screen.rejected(tracks, plan), [as_varied(each) for each in verdicts_of(tracks.read(), plan)]
    statuses = judged(tracks, plan, lambda verdict, number: (number, as_varied(verdict).status), range(len(stages)))
    assert statuses == list(enumerate(each.status for each in full))
    assert [finding.message for finding in full[5].failures] == []
    assert {each.status for each in full} == {"accepted", "rejected"}
    assert {0, 10} < set(early)  # too slow, too fast
    assert not {5, *range(2, len(FAULTS) * 3, len(FAULTS))} & set(early)  # all is well, or is not a number
    assert full[5].status == "accepted"
    for w, verdict in early.items():
        assert verdict.status == full[w].status == "rejected"
        same = {finding.objective: finding for finding in full[w].findings if finding.objective}
        for finding in verdict.findings:
            other = same[finding.objective]
            assert finding.passed == other.passed
            assert (finding.margin, finding.value, finding.limit) == pytest.approx(
                (other.margin, other.value, other.limit), rel=1e-9, abs=1e-9
            )


def test_what_the_device_cannot_tell_is_left_to_the_judge():
    worlds = moving(0, varied=False)
    plan = plan_of(
        say.reaches("box", "ball"),  # a gap between surfaces
        Always(of=say.settles("box") | say.settles("ball")),
        say.finally_(say.settles("box"), 5.0),  # a window that is not covered
        say.upright("ball"),
        say.stays_within("ground", (0.0, 0.0, 0.0), 1.0),
        say.settles("box") & say.touches("box", "ball"),
    )
    asked, _ = told_by(worlds, plan)
    assert [one.when.predicate for one in asked] == [say.settles("box")]


def test_most_of_a_world_need_not_be_judged_to_reject_it(tmp_path):
    """What is rejected early is not read: the judge gets the others alone."""
    tracks = followed_ball(tmp_path)
    early = screen.rejected(tracks, plan_of(say.gone_between("ball", "x", 0.3, 2.0)))
    assert sorted(early) == [0, 2]
    assert early[0].summary.endswith("All else was not judged.")
    assert tracks.read([1, 3]).body_q.shape[0] == 2
    assert np.array_equal(tracks.read([3, 1]).body_q, tracks.read().body_q[[3, 1]])


def followed_ball(folder):
    stages = []
    for k, speed in enumerate((1.0, 3.0, 0.0, 4.0)):
        scene = Scene()
        scene.simulation(duration=0.3, frame_rate=20.0)
        scene.sphere("ball", radius=0.1, density=500.0, position=(0, 0, 3), velocity=(speed, 0, 0))
        stages.append(scene.save(folder / f"{k}.usda"))
    return follow(Simulation(stages, device="cpu"))
