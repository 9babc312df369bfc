"""Sliding test: one block for each material on a tilted plate."""
from enum import Enum, auto
from typing import NamedTuple

from wsim.scene import Material, Scene


class Surface(Enum):
    ICE = auto()
    WOOD = auto()
    RUBBER = auto()


class Properties(NamedTuple):
    density: float
    friction: float
    restitution: float = 0.0
    color: tuple[float, float, float] = (0.5, 0.5, 0.5)


TABLE: dict[Surface, Properties] = {
    Surface.ICE: Properties(917.0, 0.03, color=(0.8, 0.9, 1.0)),
    Surface.WOOD: Properties(600.0, 0.4, 0.1, (0.45, 0.25, 0.1)),
    Surface.RUBBER: Properties(density=1100.0, friction=1.0, restitution=0.5),
}


def make(scene: Scene, surface: Surface) -> Material:
    props = TABLE[surface]
    return scene.material(surface.name.lower(), **props._asdict())


def build(scene: Scene) -> None:
    scene.simulation(duration=3.0)
    scene.ground()
    scene.box("ramp", size=(2.0, 1.2, 0.05), position=(0, 0, 0.6), rotation_deg=(0, 25, 0), static=True, friction=0.5)
    for i, surface in enumerate(Surface):
        material = make(scene, surface)
        match surface:
            case Surface.ICE:
                mass_hint = "slides"
            case Surface.RUBBER | Surface.WOOD:
                mass_hint = "may stick"
            case _:
                raise AssertionError(surface)
        scene.box(f"slider_{material.name}", size=(0.15, 0.15, 0.1), position=(-0.6, (i - 1) * 0.35, 0.99), rotation_deg=(0, 25, 0), material=material)
        print(f"{material.name:>8s}: mu = {material.friction:.2f}, {mass_hint}, {material.density!r} kg/m^3")
    scene.camera("side", eye=(0.2, -3.5, 1.3), target=(0, 0, 0.4))
