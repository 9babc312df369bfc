"""Many bodies at once: a gas of balls, tall stacks, a row of dominoes, a house of cards."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import STILL, Bench, G, Track, case
from wsim.scene import Scene

Array = np.ndarray


def _gas(bench: Bench, walls: bool) -> Track:
    """A thousand elastic balls of 0.1 m and 1 kg, 0.25 m apart, at speeds of 1.7 m/s to all sides; 0.5 s.

    They meet about twice each. With walls they fill a box of 2.5 m.
    """
    rng = np.random.default_rng(7)

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        for k, cell in enumerate(np.ndindex(10, 10, 10)):
            place, velocity = 0.25 * (np.array(cell) - 4.5), rng.normal(0.0, 1.0, 3)
            scene.sphere(f"b{k}", radius=0.1, mass=1.0, position=tuple(place.tolist()),
                         velocity=tuple(velocity.tolist()), friction=0.0, restitution=1.0)  # fmt: skip
        for axis in range(3) if walls else ():
            for side in (-1, 1):
                size, place = np.full(3, 3.0), np.zeros(3)
                size[axis], place[axis] = 0.4, side * (1.25 + 0.2)
                scene.box(f"wall_{axis}_{side + 1}", size=tuple(size.tolist()), position=tuple(place.tolist()),
                          static=True)  # fmt: skip

    return bench.run(build, 0.5, rate=40.0)


@case("of Σ m |v|", 1e-5, "what is kept is kept to float32")
def gas_momentum(bench: Bench) -> tuple[float, float]:
    """The momentum of 1,000 elastic balls that fly through each other changes by 0 in 0.5 s."""
    track = _gas(bench, walls=False)
    velocity = track.body_qd[:, :, :3]
    change = np.linalg.norm((velocity - velocity[0]).sum(axis=1), axis=1)
    change /= np.linalg.norm(velocity[0], axis=1).sum()
    bench.show("Δ Σ m v / Σ m |v|", track.time, change, 0.0)
    return float(change.max()), 0.0


@case("J")
def gas_energy(bench: Bench) -> tuple[float, float]:
    """The energy of 1,000 elastic balls in a box stays what it started with for 0.5 s."""
    track = _gas(bench, walls=True)
    energy = 0.5 * (track.body_qd[:, :, :3] ** 2).sum(axis=(1, 2))
    bench.show("energy [J]", track.time, energy, energy[0])
    return float(energy[-1]), float(energy[0])


@case("m", 1e-3, STILL)
def stack_of_thirty(bench: Bench) -> tuple[float, float]:
    """Thirty boxes in a stack of 6 m move by 0 in 2 s."""

    def build(scene: Scene) -> None:
        scene.ground()
        for k in range(30):
            scene.box(f"b{k}", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1 + 0.2 * k))

    track = bench.run(build, 2.0)
    bench.show("moved [m]", track.time, track.drift(), 0.0)
    return track.moved(), 0.0


CARD, CARD_THICK, CARD_LEAN = 1.0, 0.04, math.radians(12.0)  # boards: long, thick [m], from the vertical
ROOF, TENT = 1.4, 0.45  # boards that lie, and how far a tent is from the middle [m]
STOREYS = 4  # of four cards that lean and one that lies: 20 cards


def _house(bench: Bench, share: float, seconds: float) -> Track:
    """A house of cards whose friction is a share of the least with which it stands.

    At the bottom a card bears W and a quarter of the 16 above, P = 4 W, which lie on its outer upper edge. Its
    neighbour pushes with H at its inner one, the roof rubs with F up to mu P, its foot holds H + F up to mu (W + P).
    About its foot, over L cos a, that is H + F (1 + tan a t / L) = (W / 2 + P) (tan a - t / L); so
    mu (W + P + P tan a t / L) is at least its right side. Upper storeys bear less and need less. What the two cards of
    a tent share unequally drops out of the sum of the two.

    The two tents of a storey must not meet. Feet that have slid together hold each other, a tent can then fall only by
    dragging its top below the roof, and half as far: (W / 2 + P) (tan a - t / L) > mu (W + P + P), by statics 0.56 of
    the least.
    """
    lean = math.tan(CARD_LEAN)
    friction = share * (0.5 + 4.0) * (lean - CARD_THICK / CARD) / (1.0 + 4.0 + 4.0 * lean * CARD_THICK / CARD)
    sine, cosine = math.sin(CARD_LEAN), math.cos(CARD_LEAN)
    high = CARD * cosine + CARD_THICK * sine  # a storey's cards, to their outer upper edges

    def build(scene: Scene) -> None:
        scene.ground(friction=friction)
        for storey in range(STOREYS):
            floor = storey * (high + CARD_THICK)
            for tent, middle in enumerate((-TENT, TENT)):
                for side in (-1, 1):
                    # Its inner lower edge is L sin a beside the tent's middle, its inner upper edge in the middle.
                    x = middle + side * 0.5 * (CARD * sine + CARD_THICK * cosine)
                    z = floor + 0.5 * high
                    scene.box(f"card_{storey}_{tent}_{side + 1}", size=(CARD_THICK, 0.6 * CARD, CARD), mass=1.0,
                              position=(x, 0, z), rotation_deg=(0, -side * math.degrees(CARD_LEAN), 0),
                              friction=friction)  # fmt: skip
            scene.box(f"roof_{storey}", size=(ROOF, 0.6 * CARD, CARD_THICK), mass=1.0, friction=friction,
                      position=(0, 0, floor + high + 0.5 * CARD_THICK))  # fmt: skip

    return bench.run(build, seconds)


@case("m", 0.01, "1 % of a card's length: its feet slip by less than what the slip is sought to")
def house_of_cards(bench: Bench) -> tuple[float, float]:
    """A house of 20 cards with 1.1 times the least friction moves by 0 in 5 s."""
    track = _house(bench, 1.1, 5.0)
    bench.show("moved [m]", track.time, track.drift(), 0.0)
    return track.moved(), 0.0


@case("", 0.0, "yes or no")
def house_of_cards_falls(bench: Bench) -> tuple[float, float]:
    """With 0.9 times the least friction it lies on the ground after 2 s: 1 for yes."""
    track = _house(bench, 0.9, 2.0)
    top = track.position(f"roof_{STOREYS - 1}")[:, 2]
    bench.show("top [m]", track.time, top, 0.0)
    return float(top[-1] < 0.5 * top[0]), 1.0


HEIGHT, THICK, GAP = 0.2, 0.02, 0.06  # of a domino, and between two [m]
FIRST = 2.0  # [rad/s], of the first domino
INERTIA = (HEIGHT**2 + THICK**2) / 3  # of 1 kg about its lower edge


@case("m/s", 0.02, "a box meets a box where its edge is, to a step")
def dominoes_speed(bench: Bench) -> tuple[float, float]:
    """The front of a row of 24 smooth dominoes that cannot slide goes as fast as they lean on each other, by van
    Leeuwen's theory (American Journal of Physics 78, 2010): between the 8th and the 20th."""

    def build(scene: Scene) -> None:
        for k in range(24):
            x = k * (GAP + THICK)
            motion = {"velocity": (0.5 * HEIGHT * FIRST, 0, 0.5 * THICK * FIRST),
                      "angular_velocity_deg": (0, math.degrees(FIRST), 0)} if k == 0 else {}  # fmt: skip
            scene.box(f"d{k}", size=(THICK, 0.1, HEIGHT), mass=1.0, position=(x - 0.5 * THICK, 0, 0.5 * HEIGHT),
                      friction=0.0, **motion)  # fmt: skip
            scene.joint_revolute(f"j{k}", None, f"d{k}", anchor=(x, 0, 0), axis="Y", limits_deg=(0, 120))

    track = bench.run(build, 1.2, rate=800.0)
    moved = np.array([track.angle(f"d{k}", 1) > 0.02 for k in range(21)])
    found = np.array([track.time[int(row.argmax())] for row in moved])
    known = _front(21, 0.02)
    bench.show("begins to fall [s]", np.arange(21.0), found, known, "domino")
    way = 12 * (GAP + THICK)
    return float(way / (found[20] - found[8])), float(way / (known[20] - known[8]))


def _behind(head: float, count: int) -> tuple[Array, Array]:
    """Angles of a head and of `count` - 1 dominoes that lean on it, one on the other, and their rates by the head's."""
    angles, rates = [head], [1.0]
    for _ in range(count - 1):
        lean = angles[-1]
        over = ((GAP + THICK) * math.cos(lean) - THICK) / HEIGHT
        rate = 1.0 - (GAP + THICK) * math.sin(lean) / (HEIGHT * math.sqrt(1.0 - over**2))
        angles.append(lean + math.asin(over))
        rates.append(rates[-1] * rate)
    return np.array(angles), np.array(rates)


def _front(count: int, mark: float) -> Array:
    """When each domino has turned by `mark` [rad], from the energy between blows that nothing rebounds from [s]."""

    def height(angles: Array) -> float:
        return float((0.5 * HEIGHT * np.cos(angles) + 0.5 * THICK * np.sin(angles)).sum())

    grid = np.linspace(0.0, math.asin(GAP / HEIGHT), 400)
    times, now, rate = [], 0.0, FIRST
    for n in range(1, count + 1):
        states = [_behind(angle, n) for angle in grid]
        weights = np.array([(rates**2).sum() for _, rates in states])
        heights = np.array([height(angles) for angles, _ in states])
        energy = 0.5 * INERTIA * weights[0] * rate**2 + G * heights[0]
        speed = np.sqrt(2.0 * (energy - G * heights) / (INERTIA * weights))
        passed = np.concatenate([[0.0], np.cumsum(np.diff(grid) * 0.5 * (1 / speed[1:] + 1 / speed[:-1]))])
        times.append(now + float(np.interp(mark, grid, passed)))
        now += float(passed[-1])
        turn = float(_behind(0.0, 2)[1][1])  # of the old head by the new one's
        rate = float(speed[-1]) * turn * weights[-1] / (1.0 + turn**2 * weights[-1])
    return np.array(times)
