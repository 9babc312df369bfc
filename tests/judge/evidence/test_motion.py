"""Objectives of what moves: theory is accepted; each planted fault is rejected by the finding that is there for it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wsim.judge import judge
from wsim.recording.recording import FluidTrack, Recording
from wsim.rules.planner import plan as make_plan
from wsim.scene.world import Body, Container, Fluid, Shape, Static, World

G, RATE = 9.81, 24.0
IDENTITY = (0.0, 0.0, 0.0, 1.0)


def quaternion(rotation_deg):
    """Of a pitch alone."""
    half = math.radians(rotation_deg[1]) / 2
    return (0.0, math.sin(half), 0.0, math.cos(half))


def shape_of(item, placed=False):
    pose = {"position": item.pose.position, "rotation": quaternion(item.pose.rotation_deg)} if placed else {}
    friction = item.material.friction if item.material else 0.5
    return Shape(prim=f"/World/{item.name}/geometry", kind=item.primitive, size=item.size, friction=friction, **pose)


def body_of(item):
    if item.primitive == "sphere":
        volume, share = 4 / 3 * math.pi * item.size[0] ** 3, [0.4 * item.size[0] ** 2] * 3
    elif item.primitive == "cylinder":
        r, h = item.size
        volume, share = math.pi * r * r * h, [(3 * r * r + h * h) / 12] * 2 + [r * r / 2]
    else:
        x, y, z = item.size
        volume, share = x * y * z, [(y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12]
    mass = item.registration.mass or item.material.density * volume
    return Body(
        prim=f"/World/{item.name}", mass=mass, volume=volume, inertia=tuple((np.diag(share) * mass).ravel()),
        position=item.pose.position, rotation=quaternion(item.pose.rotation_deg), velocity=item.velocity,
        shapes=[shape_of(item)],
    )  # fmt: skip


def times_of(plan):
    return np.arange(round(plan.simulation.duration * RATE) + 1) / RATE


def recorded(plan, q, qd, force=None):
    """A recording of a plan's world in which the bodies move as given, (T, B, 7) and (T, B, 6)."""
    bodies = [body_of(item) for item in plan.objects if item.state == "dynamic"]
    statics = [
        Static(prim=f"/World/{o.name}", shapes=[shape_of(o, placed=True)])
        for o in plan.objects
        if o.state == "static" and o.primitive == "box"
    ]
    ground = Static(prim="/World/ground", shapes=[Shape(prim="/World/ground/g", kind="plane", size=(), friction=0.7)])
    world = World(duration=plan.simulation.duration, frame_rate=RATE, bodies=bodies, statics=[ground, *statics])
    time = times_of(plan)
    force = np.zeros((*q.shape[:2], 3), dtype=np.float32) if force is None else force
    return Recording(Path("x.rrd"), world, {}, time, q.astype(np.float32), qd.astype(np.float32), force, {}, {}, [], {})


def still(plan):
    items = [item for item in plan.objects if item.state == "dynamic"]
    count = len(times_of(plan))
    q = np.array([[*item.pose.position, *quaternion(item.pose.rotation_deg)] for item in items])
    return np.tile(q, (count, 1, 1)), np.zeros((count, len(items), 6))


def findings(plan, recording, kind):
    return [f for f in judge(recording, plan).findings if f.check == kind]


# ---- a ramp
def down_a_ramp(prompt, pull, rolling, start=0.0):
    """What goes down a ramp from rest at a constant acceleration, turning as it rolls or not at all."""
    plan = make_plan(prompt)
    time = np.maximum(times_of(plan) - start, 0.0)
    ramp = next(o for o in plan.objects if o.role == "terrain" and o.primitive == "box")
    angle = math.radians(ramp.pose.rotation_deg[1])
    along = np.array([math.cos(angle), 0.0, -math.sin(angle)])
    q, qd = still(plan)
    q[:, 0, :3] += along * (pull(angle) * time**2 / 2)[:, None]
    qd[:, 0, :3] = along * (pull(angle) * time)[:, None]
    if rolling:
        qd[:, 0, 4] = pull(angle) * time / plan.objects[-1].size[0]
    return plan, recorded(plan, q, qd)


def test_a_ball_rolls_down_as_its_inertia_has_it():
    plan, recording = down_a_ramp("A steel ball rolls down a ramp", lambda a: 5 / 7 * G * math.sin(a), rolling=True)
    way, turning, pull = findings(plan, recording, "ObjectiveRollsDown")
    assert way.passed and turning.passed and pull.passed
    assert turning.value == pytest.approx(1.0, abs=1e-6)
    assert pull.value == pytest.approx(pull.expected, rel=1e-3) and pull.expected == pytest.approx(
        5 / 7 * G * math.sin(math.radians(20))
    )


def test_what_a_ball_meets_after_the_ramp_says_nothing_of_how_it_rolled():
    plan, recording = down_a_ramp("A steel ball rolls down a ramp", lambda a: 5 / 7 * G * math.sin(a), rolling=True)
    q, qd = recording.body_q.copy(), recording.body_qd.copy()
    after = len(q) * 3 // 4
    q[after:, 0, :3] = q[after, 0, :3] + (0.3, 0.0, 0.5)
    qd[after:] = 0.0
    pull = findings(plan, replace(recording, body_q=q, body_qd=qd), "ObjectiveRollsDown")[2]
    assert pull.passed and pull.value == pytest.approx(pull.expected, rel=1e-3)
    qd[:after, 0, :3] *= 0.7  # on the ramp it still counts
    assert not findings(plan, replace(recording, body_q=q, body_qd=qd), "ObjectiveRollsDown")[2].passed


def test_a_ball_that_slips_down_or_is_too_slow_is_rejected():
    plan, slips = down_a_ramp("A steel ball rolls down a ramp", lambda a: G * math.sin(a), rolling=False)
    _, turning, pull = findings(plan, slips, "ObjectiveRollsDown")
    assert not turning.passed and turning.value == 0.0 and turning.margin == -0.5
    assert not pull.passed and pull.value > pull.limit > pull.expected
    plan, slow = down_a_ramp("A steel ball rolls down a ramp", lambda a: 4 / 7 * G * math.sin(a), rolling=True)
    assert [f.passed for f in findings(plan, slow, "ObjectiveRollsDown")][2:] in ([False], [])
    plan, stays = down_a_ramp("A steel ball rolls down a ramp", lambda a: 0.0, rolling=True)
    assert not findings(plan, stays, "ObjectiveRollsDown")[0].passed


def test_a_box_slides_down_and_one_that_tumbles_does_not():
    prompt = "An oak cube slides down a 35 degree ramp"
    plan, slides = down_a_ramp(prompt, lambda a: G * (math.sin(a) - 0.4 * math.cos(a)), rolling=False)
    way, turning = findings(plan, slides, "ObjectiveSlides")
    assert way.passed and turning.passed and turning.value == 0.0 and way.unit == "m"
    tumbling = slides.body_qd.copy()
    tumbling[:, 0, 4] = 15.0 * np.linalg.norm(tumbling[:, 0, :3], axis=1)
    assert not findings(plan, replace(slides, body_qd=tumbling), "ObjectiveSlides")[1].passed
    plan, sticks = down_a_ramp(prompt, lambda a: 0.05, rolling=False)
    way = findings(plan, sticks, "ObjectiveSlides")[0]
    assert not way.passed and way.value < way.limit == pytest.approx(0.9)


# ---- a push, a throw
def test_a_push_has_a_direction():
    plan = make_plan("A box is pushed to the left at 2 m/s")
    stop = 2.0 / (0.7 * G)
    time = np.minimum(times_of(plan), stop)
    q, qd = still(plan)
    q[:, 0, 1] += 2.0 * time - 0.7 * G * time**2 / 2
    recording = recorded(plan, q, qd)
    (finding,) = findings(plan, recording, "ObjectiveMoves")
    assert finding.passed and finding.value == pytest.approx(4.0 / (2 * 0.7 * G), rel=1e-4)
    q[:, 0, 1] *= -1
    (finding,) = findings(plan, recorded(plan, q, qd), "ObjectiveMoves")
    assert not finding.passed and finding.margin < 0


def thrown(drag=0.0):
    plan = make_plan("A ball is thrown at 5 m/s at an angle of 30 degrees")
    start, v = np.array(plan.objects[1].pose.position), np.array(plan.objects[1].velocity)
    time = times_of(plan)[:, None]
    land = (v[2] + math.sqrt(v[2] ** 2 + 2 * G * 1.0)) / G
    t = np.minimum(time, land)
    q, qd = still(plan)
    q[:, 0, :3] = start + v * t * (1 - drag * t) + np.array([0.0, 0.0, -G]) * t**2 / 2
    qd[:, 0, :3] = np.where(time < land, v + np.array([0.0, 0.0, -G]) * t, 0.0)
    force = np.zeros((*q.shape[:2], 3), dtype=np.float32)
    force[time[:, 0] >= land] = (0.0, 0.0, 1.0)
    return plan, recorded(plan, q, qd, force)


def test_a_throw_is_a_parabola():
    plan, recording = thrown()
    flight, off = findings(plan, recording, "ObjectiveFlies")
    assert flight.passed and off.passed and off.value < 1e-5
    assert flight.value == pytest.approx(0.77, abs=1.5 / RATE)
    plan, recording = thrown(drag=0.2)
    _, off = findings(plan, recording, "ObjectiveFlies")
    assert not off.passed and off.value > off.limit


# ---- a collision
def collided(exchange=1.0, apart=0.0):
    """Two equal balls that come at each other and leave with each other's speeds."""
    plan = make_plan("A red ball and a blue ball collide")
    time = times_of(plan)
    q, qd = still(plan)
    meet = (0.8 - apart) / 2
    before = time < meet
    for k, sign in ((0, 1.0), (1, -1.0)):
        v = np.where(before, sign, sign * (1 - 2 * exchange))
        q[:, k, 0] += sign * np.minimum(time, meet) + np.where(before, 0.0, (time - meet) * v)
        qd[:, k, 0] = v
    return plan, recorded(plan, q, qd)


def test_a_collision_touches_and_changes_both():
    plan, recording = collided()
    (blow,) = findings(plan, recording, "ObjectiveCollidesWith")
    assert blow.passed


def test_a_near_miss_and_a_ghost_are_rejected():
    plan, recording = collided(apart=0.5)
    (gap,) = findings(plan, recording, "ObjectiveCollidesWith")
    assert not gap.passed and gap.unit == "m" and gap.value == pytest.approx(0.5, abs=1.5 / RATE)
    plan, recording = collided(exchange=0.0)
    (change,) = findings(plan, recording, "ObjectiveCollidesWith")
    assert not change.passed and change.unit == "m/s"


# ---- on a hinge
def swinging(slow=1.0, gain=0.0):
    """The exact motion of the planned pendulum, integrated in small steps."""
    plan = make_plan("A 0.5 m pendulum swings from 30 degrees")
    rod, bob = (plan.object(name) for name in ("rod", "pendulum"))
    bodies = [body_of(rod), body_of(bob)]
    arms = [rod.size[1] / 2, 0.5]
    inertia = sum(b.inertia[4] + b.mass * a**2 for b, a in zip(bodies, arms, strict=True))
    torque = sum(b.mass * a for b, a in zip(bodies, arms, strict=True)) * G
    time, angle, rate, angles = times_of(plan) / slow, math.radians(30), 0.0, []
    steps = 200
    for _ in time:
        angles.append(angle)
        for _ in range(steps):
            rate -= torque / inertia * math.sin(angle) / (RATE * slow * steps)
            angle += rate / (RATE * slow * steps)
    swung = np.array(angles) * (1 + gain * time)
    height = plan.object("rod").pose.position[2] + arms[0] * math.cos(math.radians(30))
    q, qd = still(plan)
    for k, arm in enumerate(arms):
        q[:, k, 0], q[:, k, 2] = arm * np.sin(swung), height - arm * np.cos(swung)
        q[:, k, 4], q[:, k, 6] = np.sin(-swung / 2), np.cos(-swung / 2)
        turning = np.gradient(swung, times_of(plan))
        qd[:, k, 0], qd[:, k, 2], qd[:, k, 4] = arm * np.cos(swung) * turning, arm * np.sin(swung) * turning, -turning
    return plan, recorded(plan, q, qd)


def test_a_pendulum_keeps_its_time():
    plan, recording = swinging()
    period, highest = findings(plan, recording, "ObjectiveSwings")
    assert period.passed and highest.passed
    assert highest.value == pytest.approx(1.0, abs=1e-3)  # as high as at the start
    assert period.value == pytest.approx(period.expected, rel=2e-3)
    assert period.expected == pytest.approx(2 * math.pi * math.sqrt(0.5 / G), rel=0.03)  # 1.7 % more at 30 degrees


def test_a_pendulum_that_is_slow_or_gains_is_rejected():
    plan, recording = swinging(slow=1.1)
    period = findings(plan, recording, "ObjectiveSwings")[0]
    assert not period.passed and period.value > period.limit > period.expected
    plan, recording = swinging(gain=0.1)
    assert not findings(plan, recording, "ObjectiveSwings")[1].passed
    plan, recording = swinging()
    frozen = np.broadcast_to(recording.body_q[:1], recording.body_q.shape)
    found = findings(plan, replace(recording, body_q=frozen, body_qd=0.0 * recording.body_qd), "ObjectiveSwings")[0]
    assert not found.passed


@pytest.mark.parametrize(("turn", "passed"), [(9.0, True), (2.0, False), (-9.0, False)])
def test_a_seesaw_goes_down_where_the_weight_is(turn, passed):
    plan = make_plan("A box falls onto a seesaw")
    q, qd = still(plan)
    half = np.radians(turn) / 2 * np.linspace(0.0, 1.0, len(q))
    q[:, 0, 4], q[:, 0, 6] = np.sin(half), np.cos(half)
    (finding,) = findings(plan, recorded(plan, q, qd), "ObjectiveTilts")
    assert finding.passed is passed and finding.value == pytest.approx(max(turn, 0.0), abs=1e-3)


# ---- poured water
@pytest.mark.parametrize(("spilt", "passed"), [(0, True), (5, True), (20, False)])
def test_poured_water_ends_in_the_vessel(spilt, passed):
    plan = make_plan("Water pours into a bowl")
    size = plan.object("bowl").size
    time = times_of(plan)
    rng = np.random.default_rng(0)
    position = rng.uniform(-0.4, 0.4, (len(time), 100, 3)) * size + (0.0, 0.0, 0.02 + size[2] / 2)
    position[:, :spilt, 0] = 2.0
    zero = np.zeros_like(position)
    track = FluidTrack(time, position, zero, np.full(position.shape[:2], 1000.0))
    fluid = Fluid(
        prim="/World/water", density=1000.0, viscosity=0.001, spacing=0.02, size=(0.1, 0.1, 0.1), center=(0, 0, 0.4)
    )
    bowl = Container(prim="/World/bowl", inner_size=size, inner_center=(0.0, 0.0, 0.02 + size[2] / 2))
    world = World(duration=plan.simulation.duration, frame_rate=RATE, fluids=[fluid], containers=[bowl])
    none = np.zeros((len(time), 0, 7))
    recording = Recording(
        Path("x.rrd"), world, {}, time, none, none[..., :6], none[..., :3], {"/World/water": track}, {}, [], {}
    )
    (finding,) = findings(plan, recording, "ObjectiveFills")
    assert finding.passed is passed and finding.value == pytest.approx(1 - spilt / 100)
