"""A hanging chain of capsules on ball joints, hit by a ball."""
from wsim.scene import Scene, SceneError

LINKS = 8


class Chain:
    """Capsules hung below each other."""

    radius = 0.02
    length = 0.15

    def __init__(self, scene: Scene, name: str, top: tuple[float, float, float]):
        self.scene = scene
        self.name = name
        self.top = top
        self.links = []

    @property
    def pitch(self):
        return self.length + 2 * self.radius

    def grow(self, count: int) -> "Chain":
        x, y, z = self.top
        previous = None
        for i in range(count):
            center = z - (i + 0.5) * self.pitch
            link = self.scene.capsule(f"{self.name}_{i}", radius=self.radius, height=self.length,
                                      position=(x, y, center), density=3000.0)
            self.scene.joint_spherical(f"{self.name}_joint_{i}", previous, link,
                                       anchor=(x, y, center + self.pitch / 2))
            self.links.append(link)
            previous = link
        return self

    def __len__(self):
        return len(self.links)


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0, frame_rate=60)
    scene.ground()
    chain = Chain(scene, "chain", (0.0, 0.0, 2.0)).grow(LINKS)
    if len(chain) != LINKS:
        raise SceneError(f"chain has {len(chain)} links")
    scene.sphere("ball", radius=0.1, position=(-1.5, 0, 1.0), velocity=(4, 0, 2), mass=2)
    scene.camera("side", eye=(0, -4, 1.3), target=(0, 0, 1.1))
