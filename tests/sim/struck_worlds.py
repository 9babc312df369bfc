"""Mechanisms that balls hit, and the books of their steps: energy and both momenta, from the bodies alone."""

import math

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.scene import Scene
from wsim.sim import Simulation

LINK, WIDE, MASS = 0.2, 0.03, 0.2  # of a link [m, m, kg]
JOINTS = ("joint_revolute", "joint_spherical", "joint_prismatic", "joint_fixed")


class Books:
    """A stage, stepped: what it holds after each step, from its start on."""

    def __init__(self, folder, build, seconds, worlds=1, time_step=None, device="cpu"):
        scene = Scene()
        build(scene)
        self.simulation = Simulation(scene.save(folder / "stage.usda"), device, worlds, time_step)
        built = self.simulation.built
        self.names = [body.prim.rsplit("/", 1)[1] for body in self.simulation.world.bodies]
        self._mass, self._inertia, self._com = (
            getattr(built.model, f"body_{part}").numpy()[built.bodies].astype(float)
            for part in ("mass", "inertia", "com")
        )
        self._gravity = np.array(self.simulation.world.gravity)
        self.kinetic, self.energy, self.momentum, self.spin, self.v, self.center = [], [], [], [], [], []
        self._note()
        while self.simulation.time < seconds - 1e-9:
            self.simulation.step()
            self._note()
        assert self.simulation.problems() == []
        parts = ("kinetic", "energy", "momentum", "spin", "v", "center")
        for part in parts:
            setattr(self, part, np.array(getattr(self, part)))

    def _note(self):
        state, rows = self.simulation.state, self.simulation.built.bodies
        pose, twist = (array.numpy()[rows].astype(float) for array in (state.body_q, state.body_qd))
        mass, v, w = self._mass[:, None], twist[:, :3], twist[:, 3:]
        center = pose[:, :3] + rotate(pose[:, 3:], self._com)
        own = rotate(pose[:, 3:] * (-1, -1, -1, 1), w)
        turning = np.einsum("nij,nj->ni", self._inertia, own)
        kinetic = 0.5 * (mass * v * v).sum() + 0.5 * (own * turning).sum()
        self.kinetic.append(kinetic)
        self.energy.append(kinetic - (mass * center @ self._gravity).sum())
        self.momentum.append((mass * v).sum(axis=0))
        self.spin.append((np.cross(center, mass * v) + rotate(pose[:, 3:], turning)).sum(axis=0))
        self.v.append(v)
        self.center.append(center)

    @property
    def gain(self):
        """The most that any step adds, and all steps from the first to any, over the largest kinetic energy."""
        steps = np.diff(self.energy)
        return steps.max() / self.kinetic.max(), (self.energy - self.energy[0]).max() / self.kinetic.max()

    @property
    def drift(self):
        """What momentum and angular momentum are off the start by, over what the fastest step has of each."""
        pairs = ((self.momentum, self._mass.sum() ** 0.5), (self.spin, LINK * self._mass.sum() ** 0.5))
        return [np.abs(each - each[0]).max() / (size * math.sqrt(2.0 * self.kinetic.max())) for each, size in pairs]


def chain(scene, kind="joint_spherical", links=5, hung=True, at=3, off=0.02, e=0.5, mu=0.4, speed=6.0, mass=0.5,
          gravity=True):  # fmt: skip
    """Links in a row, hung up or adrift, and a ball that comes at one of them."""
    scene.simulation(gravity=(0, 0, -9.81 if gravity else 0))
    surface = {"friction": mu, "restitution": e}
    parent = None
    for k in range(links):
        z = 2.0 - (k + 0.5) * LINK
        link = scene.box(f"link_{k}", size=(WIDE, WIDE, 0.9 * LINK), mass=MASS, position=(0, 0, z), **surface)
        if parent is not None or hung:
            extra = {"axis": "Y"} if kind in ("joint_revolute", "joint_prismatic") else {}
            getattr(scene, kind)(f"joint_{k}", parent, link, anchor=(0, 0, 2.0 - k * LINK), **extra)
        parent = link
    height = 2.0 - (at + 0.5) * LINK + 0.03
    scene.sphere("ball", radius=0.05, mass=mass, position=(-0.5 * WIDE - 0.05 - 0.02, off, height),
                 velocity=(speed, 0, 0), **surface)  # fmt: skip


def cable(scene, e=0.5, mu=0.4, speed=5.0):
    """A ball comes at the middle of a cable that hangs with a load."""
    surface = {"friction": mu, "restitution": e}
    load = scene.sphere("load", radius=0.06, mass=1.0, position=(0, 0, 1.14), **surface)
    scene.cable("c", None, load, anchor_a=(0, 0, 2), anchor_b=(0, 0, 1.2), length=0.8, links=8, mass_per_length=0.5,
                radius=0.015, friction=mu)  # fmt: skip
    scene.sphere("ball", radius=0.05, mass=0.3, position=(-0.09, 0.003, 1.6), velocity=(speed, 0, 0), **surface)


def at_random(scene, seed):
    """Two to six links on random joints, hung or adrift, bent and moving, and a ball or two thrown at them."""
    rng = np.random.default_rng(seed)
    surface = {"friction": float(rng.choice([0.0, rng.uniform(0, 1)])), "restitution": float(rng.choice([0, 0.5, 1]))}
    hung = bool(rng.uniform() < 0.5)
    scene.simulation(gravity=(0, 0, -9.81 if hung else 0))
    links = placed(rng)
    parent = None
    for k, (end, middle, turn, long, wide) in enumerate(links):
        free = {} if hung or k else {"velocity": rng.uniform(-1, 1, 3).tolist()}
        link = scene.capsule(f"link_{k}", radius=0.5 * wide, height=long, mass=float(10 ** rng.uniform(-1.5, 0.5)),
                             position=middle.tolist(), rotation_deg=(0, *turn), **free, **surface)  # fmt: skip
        if parent is not None or hung:
            kind = str(rng.choice(JOINTS, p=[0.45, 0.35, 0.1, 0.1]))
            extra = {} if kind in JOINTS[1::2] else {"axis": rng.normal(size=3).tolist()}
            if kind == "joint_prismatic":
                extra["limits"] = (-0.05, 0.05)
            getattr(scene, kind)(f"joint_{k}", parent, link, anchor=end.tolist(), **extra)
        parent = link
    points = np.concatenate([along(link) for link in links])
    for k in range(int(rng.integers(1, 3))):
        aim = links[int(rng.integers(len(links)))][1] + rng.uniform(-0.02, 0.02, 3)
        clear = False
        while not clear:
            way = rng.normal(size=3)
            way /= np.linalg.norm(way)
            place = aim - (0.3 + 0.2 * k) * way
            clear = np.linalg.norm(points - place, axis=1).min() > 0.12
        speed = float(rng.uniform(1, 8))
        scene.sphere(f"ball_{k}", radius=0.05, mass=float(10 ** rng.uniform(-1, 0.5)), position=place.tolist(),
                     velocity=(speed * way).tolist(), **surface)  # fmt: skip


def placed(rng):
    """Links in a row that do not overlap: where each begins and is [m], its turn [degrees], its size [m]."""
    while True:
        end, links = np.array([0.0, 0.0, 2.0]), []
        for _ in range(int(rng.integers(2, 7))):
            long, wide = float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.02, 0.05))
            turn = float(rng.uniform(20, 160)), float(rng.uniform(-180, 180))
            way = rotated(*turn)
            links.append((end, end + (0.5 * long + wide) * way, turn, long, wide))
            end = end + (long + 2.0 * wide) * way
        points = [along(link) for link in links]
        pairs = [(i, j) for i in range(len(links)) for j in range(i + 2, len(links))]
        pairs += [(i, i + 1) for i in range(len(links) - 1)]
        near = [np.linalg.norm(points[i][:, None] - points[j], axis=2).min() for i, j in pairs]
        if all(gap > 0.06 if j > i + 1 else gap > 0.03 for gap, (i, j) in zip(near, pairs, strict=True)):
            return links


def along(link):
    """Points of a link's middle line, (n, 3) [m]."""
    _, middle, turn, long, _ = link
    return middle + np.linspace(-0.5, 0.5, 31)[:, None] * long * rotated(*turn)


def rotated(pitch, yaw):
    """Where Z points after a turn by `pitch` about Y and then by `yaw` about Z [degrees]."""
    p, y = math.radians(pitch), math.radians(yaw)
    return np.array([math.sin(p) * math.cos(y), math.sin(p) * math.sin(y), math.cos(p)])
