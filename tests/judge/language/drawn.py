"""Motions of which mechanics knows everything, drawn by chance.

Each draws its numbers and says how bodies go, as functions of time, and what is true of them.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from tests.judge.language.truths import NONE, Motion, about, between, least, most, still, turn
from tests.judge.theory import RADIUS, G, ball, box, ground, record, slab
from wsim.recording.recording import FluidTrack, Recording
from wsim.scene.world import Container, Fluid

X = np.eye(3)[0]


# ---- in the air
def bounce(draw: np.random.Generator) -> Motion:
    """A ball let go over the ground: it comes up to e^2, e^4, ... of its height."""
    e, height, aside = draw.uniform(0.5, 0.9), draw.uniform(0.6, 1.5), draw.uniform(0.0, 1.5)
    fall, impact = math.sqrt(2.0 * height / G), math.sqrt(2.0 * G * height)
    hits = fall + np.concatenate([[0.0], np.cumsum(2.0 * impact / G * e ** np.arange(1, 4))])
    ups = impact * e ** np.arange(1, 5)

    def at(t):
        place, v, q, w = still(t, NONE)
        k = np.searchsorted(hits, t) - 1
        start, up = np.where(k < 0, 0.0, hits[k]), np.where(k < 0, 0.0, ups[k])
        since = t - start
        place[:, 0, 2] = RADIUS + np.where(k < 0, height, 0.0) + up * since - G * since**2 / 2
        v[:, 0, 2] = up - G * since
        place[:, 0, 0], v[:, 0, 0] = aside * t, aside
        return place, v, q, w

    seconds = draw.uniform(hits[1] + 0.1, hits[3] - 0.01)
    middle = f"({aside * 0.6 * fall}, 0, {RADIUS + height * (1 - 0.36)})"
    off = 0.04
    near = f"({aside * 0.6 * fall}, {off}, {RADIUS + height * (1 - 0.36)})"
    fast = math.hypot(impact, aside)
    claims = [
        *about("bounces_to(ball, ground, {}, within {within})", e**2 * height, "m"),
        *least("climbs_to(ball, {})", e**2),
        *most("dies_down(ball, z, {})", e**2),
        *about("collides_with(ball, ground, restitution {}, within {within})", e, by=0.05),
        *least("flies(ball, {})", fall, "s"),
        *most("speed_between(ball, 0 m/s, {})", fast, "m/s"),
        *most(f"reaches(ball, {near}, within {{}})", off, "m"),
        (f"reaches(ball, {middle}, within 5 mm)", True),
        (f"crosses(ball, z, at {RADIUS + 0.02 * height})", True),
        (f"crosses(ball, z, at {RADIUS - 0.02 * height})", False),
        ("touches(ball, ground)", True), ("never_touches(ball, ground)", False), ("pushes(ball, ground)", False),
        ("falls_freely(ball)", True), ("collides_with(ball, ground)", True),
        (f"touches(ball, ground) then[{0.97 * (hits[1] - hits[0]) - 0.04}, {1.03 * (hits[1] - hits[0]) + 0.04}] "
         "touches(ball, ground)", True),
    ]  # fmt: skip
    body = ball(velocity=(aside, 0.0, 0.0))
    return Motion([body], at, seconds, claims, blows=[(hit, 0, 1, 4.0 * impact) for hit in hits])


def throw(draw: np.random.Generator) -> Motion:
    """A ball thrown up and along: a parabola, cut before it lands."""
    up, along, high = draw.uniform(3.0, 6.0), draw.uniform(1.0, 4.0), draw.uniform(0.5, 1.0)
    top, when = high + up**2 / (2 * G), up / G
    seconds = draw.uniform(1.3, 1.9) * when

    def at(t):
        place, v, q, w = still(t, NONE)
        place[:, 0, 0], v[:, 0, 0] = along * t, along
        place[:, 0, 2], v[:, 0, 2] = RADIUS + high + up * t - G * t**2 / 2, up - G * t
        return place, v, q, w

    apex = f"({along * when}, 0, {RADIUS + top})"
    claims = [
        *least("eventually(gone_between(ball, z, {}, 99 m))", top - high, "m"),
        *most("always(gone_between(ball, z, -99 m, {}))", top - high, "m"),
        (f"crosses(ball, z, at {RADIUS + top - 2e-4})", True), (f"crosses(ball, z, at {RADIUS + top + 2e-4})", False),
        (f"reaches(ball, {apex}, within 1 cm)", True), (f"reaches(ball, ({along * when}, 0.02, {RADIUS + top}), within "
                                                       "1.9 cm)", False),
        *most("eventually(speed_between(ball, 0 m/s, {}))", along, "m/s"),
        ("falls_freely(ball)", True), ("never_touches(ball, ground)", True), ("touches(ball, ground)", False),
        ("rolls(ball)", False), ("conserves(energy, ball)", True),
    ]  # fmt: skip
    return Motion([ball(velocity=(along, 0.0, up))], at, seconds, claims)


def graze(draw: np.random.Generator) -> Motion:
    """Without gravity a ball goes past another's side, as near as that."""
    speed, past, gap = draw.uniform(1.0, 8.0), draw.uniform(0.0, math.pi), draw.uniform(0.02, 0.06)
    side = np.array([0.0, math.cos(past), math.sin(past)]) * (2 * RADIUS + gap)
    seconds = draw.uniform(1.7, 2.3) / speed

    def at(t):
        place, v, q, w = still(t, side, NONE)
        place[:, 0, 0], v[:, 0, 0] = speed * t - 1.0, speed
        return place, v, q, w

    claims = [
        *least("never_touches(ball, other, {})", gap, "m"), *most("touches(ball, other, {})", gap, "m"),
        *most("reaches(ball, other, {})", gap, "m"), ("collides_with(ball, other)", False),
        ("pushes(ball, other)", False), ("touches(ball, other)", False),
        *between("spin_between(ball, z, {})", 0.0, "deg/s", size=1.0),
    ]  # fmt: skip
    return Motion([ball(velocity=(speed, 0.0, 0.0)), ball("other")], at, seconds, claims, gravity=False, statics=[])


def strike(draw: np.random.Generator) -> Motion:
    """Without gravity a ball strikes another askew: along the line of centres they part at e of the approach."""
    speed, e, share = draw.uniform(1.5, 5.0), draw.uniform(0.3, 1.0), draw.uniform(0.0, 0.7)
    heavy = draw.uniform(0.5, 3.0)
    normal = np.array([math.sqrt(1 - share**2), share, 0.0])  # from the first to the second
    hit = draw.uniform(0.3, 0.4)
    push = (1 + e) * speed * normal[0] / (1 + 1 / heavy)
    after = np.array([speed * X - push * normal, push / heavy * normal])
    seconds = hit + draw.uniform(0.3, 0.4)

    def at(t):
        place, v, q, w = still(t, -2 * RADIUS * normal, NONE)
        late = (t > hit)[:, None, None]
        v[:] = np.where(late, after, np.array([speed * X, NONE]))
        place += v * (t - hit)[:, None, None]
        return place, v, q, w

    bodies = [ball(velocity=(speed, 0.0, 0.0)), ball("other", 4.0 * heavy)]
    pushed = push / heavy
    claims = [
        *about("collides_with(ball, other, restitution {}, within {within})", min(e, 0.95), by=0.05),
        ("pushes(ball, other)", False), ("touches(ball, other)", True), ("never_touches(ball, other)", False),
        ("conserves(momentum, ball, other)", True),
        *most("finally[0.2](speed_between(other, 0 m/s, {}))", pushed, "m/s"),
        *least("finally[0.2](speed_between(other, {}, 99 m/s))", pushed, "m/s"),
        *most("conserves(energy, share {})", 1 - (np.sum(after[0]**2) + heavy * np.sum(after[1]**2)) / speed**2),
        (f"touches(ball, other) then[0, {hit}] speed_between(other, {0.98 * pushed}, {1.02 * pushed})", True),
        (f"speed_between(other, {0.5 * pushed}, 99 m/s) then[0.1, 0.2] touches(ball, other, 1 mm)", False),
    ]  # fmt: skip
    if e > 0.95 or 1 - (np.sum(after[0] ** 2) + heavy * np.sum(after[1] ** 2)) / speed**2 < 1e-3:
        claims = [c for c in claims if "energy" not in c[0] and "restitution" not in c[0]]
    return Motion(bodies, at, seconds, claims, gravity=False, statics=[], blows=[(hit, 0, 1, 4.0 * push)])


# ---- on the ground
def slide(draw: np.random.Generator) -> Motion:
    """A box slides to rest before a wall: v^2 / (2 mu g)."""
    mu, speed, left = draw.uniform(0.2, 0.5), draw.uniform(1.0, 2.5), draw.uniform(0.1, 0.3)
    way, stop = speed**2 / (2 * mu * G), speed / (mu * G)
    wall = slab("wall", (0.1, 1.0, 1.0), (way + left + 0.1 + 0.05, 0.0, 0.5))

    def at(t):
        place, v, q, w = still(t, [0.0, 0.0, 0.1])
        s = np.minimum(t, stop)
        place[:, 0, 0], v[:, 0, 0] = speed * s - mu * G * s**2 / 2, speed - mu * G * s
        return place, v, q, w

    claims = [
        *most("stops_before(box, wall, {})", left, "m"), ("stops_before(box, wall)", True),
        *least("moves(box, {}, front)", way, "m"), *least("moves(box, {})", way, "m"),
        *between("gone_between(box, x, {})", way, "m"), *least("never_touches(box, wall, {})", left, "m"),
        ("moves(box, 1 cm, back)", False), ("settles(box)", True), ("stays_on(box, ground)", True),
        (f"always[{0.0}, {0.97 * stop - 0.02}](settles(box))", False),
        (f"eventually[0, {0.9 * stop}](settles(box))", False), ("rolls(box)", False),
        ("collides_with(box, ground)", False),
        ("touches(box, ground)", True), ("upright(box)", True), ("touches(box, wall)", False),
    ]  # fmt: skip
    return Motion(
        [box(velocity=(speed, 0.0, 0.0))], at, stop + draw.uniform(1.1, 1.5), claims, statics=[ground(mu), wall]
    )


def shove(draw: np.random.Generator) -> Motion:
    """A kinematic box pushes another on before it from when they meet; that stands as friction holds it."""
    speed, meets, seconds = draw.uniform(0.3, 1.0), draw.uniform(0.2, 0.5), draw.integers(6, 10) / 6.0
    stays = seconds - meets

    def at(t):
        place, v, q, w = still(t, [0.0, 0.0, 0.1], [speed * meets + 0.2, 0.0, 0.1])
        place[:, 0, 0], v[:, 0, 0] = speed * t, speed
        place[:, 1, 0] += speed * np.maximum(t - meets, 0.0)
        v[:, 1, 0] = np.where(t > meets, speed, 0.0)
        return place, v, q, w

    claims = [
        *least("pushes(pusher, box, {})", stays, "s", by=0.15), ("pushes(box, pusher)", False),
        ("touches(pusher, box)", True), ("pushes(pusher, ground)", False), ("rests_on(box, ground)", False),
        *least("moves(box, {}, front)", speed * stays, "m"),
        *between("gone_between(pusher, x, {}, of box)", speed * meets, "m"),
    ]  # fmt: skip
    return Motion([box("pusher", kinematic=True, velocity=(speed, 0.0, 0.0)), box()], at, seconds, claims)


def roll(draw: np.random.Generator) -> Motion:
    """A ball let go rolls down a slope by 5/7 g sin(a), slipping by a share or not."""
    steep, slips = math.radians(draw.uniform(10.0, 30.0)), draw.choice([0.0, 0.08, 0.3])
    pace = 5.0 / 7.0 * G * math.sin(steep)
    down, up = np.array([math.cos(steep), 0.0, -math.sin(steep)]), np.array([math.sin(steep), 0.0, math.cos(steep)])
    ramp = slab("ramp", (8.0, 1.0, 0.1), (0.0, 0.0, 3.0))
    shape = ramp.shapes[0].model_copy(update={"rotation": tuple(turn(1, np.array(steep)).tolist())})
    ramp = ramp.model_copy(update={"shapes": [shape]})
    seconds = draw.uniform(0.8, 1.2)

    def at(t):
        place, v, q, w = still(t, NONE)
        place[:, 0] = np.array([0.0, 0.0, 3.0]) + (0.05 + RADIUS) * up - 2.0 * down + (pace * t**2 / 2)[:, None] * down
        v[:, 0] = (pace * t)[:, None] * down
        q[:, 0] = turn(1, (1 - slips) * pace * t**2 / 2 / RADIUS)
        w[:, 0, 1] = (1 - slips) * pace * t / RADIUS
        return place, v, q, w

    claims = [
        *least("eventually[0, 0.5](goes_down(ball, ramp, {}))", pace * 0.5**2 / 2, "m"),
        *least("rolls(ball, ramp, {})", 1 - slips), *least("rolls(ball, share {})", 1 - slips),
        ("rolls_freely(ball, ramp, 3 %)", True), ("rolls_without_slip(ball, ramp)", slips == 0.0),
        *least("eventually[0, 0.5](moves(ball, {}, front))", pace * 0.5**2 / 2 * math.cos(steep), "m"),
        ("touches(ball, ramp)", True), ("collides_with(ball, ramp)", False), ("stays_on(ball, ramp)", True),
        ("goes_down(ball, ramp)", True),
    ]  # fmt: skip
    return Motion([ball()], at, seconds, claims, statics=[ground(), ramp])


# ---- what turns
def pendulum(draw: np.random.Generator) -> Motion:
    """A ball on a massless rod of 1 m, let go at an angle."""
    far, arm = math.radians(draw.uniform(10.0, 60.0)), draw.uniform(0.3, 1.0)
    inertia = 0.4 * RADIUS**2 + arm**2
    stiff = G * arm / inertia
    found = solve_ivp(lambda t, y: [y[1], -stiff * math.sin(y[0])], (0, 6.0), [far, 0.0], rtol=1e-11, atol=1e-12,
                      dense_output=True).sol  # fmt: skip
    a, b = 1.0, math.cos(far / 2)
    for _ in range(20):
        a, b = (a + b) / 2, math.sqrt(a * b)
    period = 2 * math.pi / math.sqrt(stiff) / a
    seconds = min(draw.uniform(2.2, 3.0) * period, 6.0)

    def at(t):
        place, v, q, w = still(t, NONE)
        angle, rate = found(t)
        rod = np.stack([-np.sin(angle), 0 * t, -np.cos(angle)], axis=1)
        w[:, 0, 1] = rate
        place[:, 0], v[:, 0] = np.array([0, 0, 3.0]) + arm * rod, np.cross(w[:, 0], arm * rod)
        q[:, 0] = turn(1, angle)
        return place, v, q, w

    degrees, fastest = math.degrees(far), math.degrees(math.sqrt(2 * stiff * (1 - math.cos(far))))
    drop = arm * (1 - math.cos(far))
    claims = [
        ("swings(ball)", True), *least("climbs_to(ball, {})", 1.0, by=0.02), ("conserves(energy, ball)", True),
        ("dies_down(ball, x)", False),
        *most("always(spin_between(ball, y, -999 deg/s, {}))", fastest, "deg/s"),
        *least("eventually(spin_between(ball, y, {}, 999 deg/s))", fastest, "deg/s"),
        *most("speed_between(ball, 0 m/s, {})", arm * math.radians(fastest), "m/s"),
        ("falls_freely(ball)", False),
    ]  # fmt: skip
    for off, holds in ((-0.03, False), (-0.015, True), (0.015, True), (0.03, False)):
        claims.append((f"swings(ball, period {period * (1 + off)} s, share 2 %)", holds))
        asked = f"swings(ball, period {period} s, amplitude {degrees * (1 + off)} deg, share 2 %)"
        claims.append((asked, holds))
    claims += [(f"eventually(gone_between(ball, z, -9 m, {-0.97 * drop} m))", True),
               (f"eventually(gone_between(ball, z, -9 m, {-1.03 * drop} m))", False)]  # fmt: skip
    return Motion([ball()], at, seconds, claims, statics=[])


def rock(draw: np.random.Generator) -> Motion:
    """A box that rocks about its middle like a spring, far or little, fast or slow."""
    far, period = math.radians(draw.uniform(4.0, 30.0)), draw.uniform(0.5, 1.5)
    phase, axis = draw.uniform(0.2, 1.2), int(draw.integers(2))
    rate = 2 * math.pi / period
    start = far * math.sin(phase)

    def at(t):
        place, v, q, w = still(t, [0.0, 0.0, 1.0])
        angle = far * np.sin(rate * t + phase)
        q[:, 0], w[:, 0, axis] = turn(axis, angle), far * rate * np.cos(rate * t + phase)
        return place, v, q, w

    least_, turned = math.degrees(-far - start), math.degrees(far * math.sin(0.5 * rate + phase) - start)
    towards, sign = ("x", 1.0) if axis == 1 else ("y", -1.0)
    name, degrees = "xyz"[axis], "deg"
    claims = [
        *most("upright(box, {})", -least_, degrees), *least("eventually(not upright(box, {}))", -least_, degrees),
        *between(f"eventually[0.5, 0.5](turned_between(box, {name}, {{}}))", turned, degrees, size=math.degrees(far)),
        *between(f"eventually[0.5, 0.5](tilt_between(box, {towards}, {{}}))", sign * turned, degrees,
                 size=math.degrees(far)),
        *least(f"always(spin_between(box, {name}, {{}}, 9999 deg/s))", -math.degrees(far * rate), "deg/s", by=0.05),
        *most(f"always(own_spin_between(box, {name}, -9999 deg/s, {{}}))", math.degrees(far * rate), "deg/s", by=0.05),
    ]  # fmt: skip
    return Motion([box(size=(0.2, 0.2, 0.4))], at, 0.5 + 2.0 * period, claims, statics=[])


def carousel(draw: np.random.Generator) -> Motion:
    """A wheel spins about its own axle, y, which a frame carries round z; a load goes outwards on the frame."""
    carried, spin, out = draw.uniform(-3.0, 3.0), draw.uniform(-8.0, 8.0), draw.uniform(0.1, 0.4)
    seconds = draw.uniform(0.8, 1.6)

    def at(t):
        place, v, q, w = still(t, NONE, [0.0, 0.0, 1.0], NONE)
        round_ = carried * t
        radial = np.stack([np.cos(round_), np.sin(round_), 0 * t], axis=1)
        across = np.stack([-np.sin(round_), np.cos(round_), 0 * t], axis=1)
        q[:, 0], w[:, 0, 2] = turn(2, round_), carried
        half = spin * t / 2  # z then the wheel's own y
        c, s = np.cos(round_ / 2), np.sin(round_ / 2)
        q[:, 1] = np.stack([-s * np.sin(half), c * np.sin(half), s * np.cos(half), c * np.cos(half)], axis=1)
        w[:, 1] = spin * across + np.array([0, 0, carried])
        place[:, 2] = (0.5 + out * t)[:, None] * radial
        v[:, 2] = out * radial + ((0.5 + out * t) * carried)[:, None] * across
        q[:, 2], w[:, 2, 2] = turn(2, round_), carried
        return place, v, q, w

    end = math.degrees(carried) * 0.5
    at_half = "eventually[0.5, 0.5]"
    claims = [
        *between("own_spin_between(wheel, y, {})", math.degrees(spin), "deg/s", size=300.0),
        *between("spin_between(frame, z, {})", math.degrees(carried), "deg/s", size=100.0),
        *between("spin_between(wheel, z, {}, of frame)", 0.0, "deg/s", size=300.0),
        *between(f"{at_half}(turned_between(frame, z, {{}}))", end, "deg", size=100.0),
        *between(f"{at_half}(turned_between(load, z, {{}}, of frame))", 0.0, "deg", size=100.0),
        *between(f"{at_half}(gone_between(load, x, {{}}, of frame))", out * 0.5, "m"),
        *between(f"{at_half}(gone_between(load, y, {{}}, of frame))", 0.0, "m", size=0.3),
    ]  # fmt: skip
    bodies = [box("frame"), box("wheel"), box("load")]
    return Motion(bodies, at, seconds, claims, statics=[], gravity=False)


# ---- fluids
def vessel(draw: np.random.Generator) -> tuple[Recording, list[tuple[str, bool]]]:
    """Water that turns as one about the middle of a tank; a part of it is beside, and balls are in and out of it."""
    rate, beside, tall = draw.uniform(-4.0, 4.0), int(draw.integers(2, 8)), int(draw.integers(4, 8))
    t = np.arange(49) / 24.0
    ticks = (np.arange(20) + 0.5) / 20 - 0.5
    heights = 0.05 * (np.arange(tall) + 0.5)
    points = np.stack(np.meshgrid(ticks, ticks, heights, indexing="ij"), axis=-1).reshape(-1, 3)
    out = np.arange(len(points)) % 10 < beside
    turned = np.repeat(points[None], len(t), axis=0)
    velocity = np.cross([0.0, 0.0, rate], turned)
    moved = turned + np.where(out, 10.0, 0.0)[None, :, None] * np.array([1.0, 0.0, 0.0])
    level, share = 0.05 * tall * (1 - beside / 10), 1 - beside / 10
    water = Fluid(prim="/World/water", density=1000.0, viscosity=0.001, spacing=0.05, size=(1.0, 1.0, 0.05 * tall),
                  center=(0.0, 0.0, 0.025 * tall), container="/World/tank")  # fmt: skip
    tank = Container(prim="/World/tank", inner_size=(1.0, 1.0, 0.6), inner_center=(0.0, 0.0, 0.3))
    inside = int(draw.integers(1, 3))
    names = ["one", "two", "three"]
    places = [[0.25 * k if k < inside else 5.0, 0.0, 0.3] for k in range(3)]
    place, v, _, _ = still(t, *places)
    case = record([ball(name) for name in names], place, v, t)
    tracks = {}
    for name, at in (("whirl", turned), ("water", moved)):
        density = np.full(at.shape[:2], 1000.0, np.float32)
        tracks[f"/World/{name}"] = FluidTrack(t, at.astype(np.float32), velocity.astype(np.float32), density)
    whirl = water.model_copy(update={"prim": "/World/whirl"})
    world = case.world.model_copy(update={"fluids": [water, whirl], "containers": [tank]})
    claims = [
        *between("swirls_between(whirl, z, {})", math.degrees(rate), "deg/s", size=200.0),
        *between("swirls_between(whirl, x, {})", 0.0, "deg/s", size=200.0),
        *least("fills(water, tank, {})", share), *about("level_in(water, tank, {}, within {within})", level, "m"),
        (f"counts(tank, {inside}, one, two, three)", True), (f"counts(tank, {inside + 1}, one, two, three)", False),
        ("contained_in(one, tank)", True), ("contained_in(three, tank)", False),
    ]  # fmt: skip
    return replace(case, world=world, fluids=tracks), claims


MOTIONS = (bounce, throw, graze, strike, slide, shove, roll, pendulum, rock, carousel)
