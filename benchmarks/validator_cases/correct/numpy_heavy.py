"""Marbles laid out on a spiral, a grid and a random cloud; colours by interpolation."""
import numpy as np

from wsim.scene import Scene

rng = np.random.default_rng(42)
STOPS = np.array([[0.1, 0.2, 0.7], [0.9, 0.9, 0.2], [0.8, 0.1, 0.1]])


def colormap(values: np.ndarray) -> np.ndarray:
    """(N,) in 0..1 to (N, 3)"""
    t = np.linspace(0, 1, len(STOPS))
    return np.stack([np.interp(values, t, STOPS[:, c]) for c in range(3)], axis=-1)


def spiral(n: int) -> np.ndarray:
    theta = np.sqrt(np.arange(1, n + 1)) * np.pi
    r = 0.05 * theta
    return np.vstack([r * np.cos(theta), r * np.sin(theta), np.full(n, 0.5)]).T


def build(scene: Scene) -> None:
    scene.ground()
    scene.box("tray", size=(2.5, 2.5, 0.02), position=(0, 0, 0.01), static=True, friction=0.6)
    spots = spiral(16)
    grid = np.array(np.meshgrid(np.arange(3), np.arange(3))).reshape(2, -1).T * 0.2 - 0.2
    cloud = rng.normal(scale=(0.3, 0.3, 0.05), size=(8, 3)) + (0.0, 0.0, 1.0)
    everything = np.concatenate((spots, np.hstack((grid, np.full((len(grid), 1), 0.8))), cloud + np.eye(3)[2] * 0.3))
    distance = np.linalg.norm(everything[:, None] - everything[None], axis=-1)
    np.fill_diagonal(distance, np.inf)
    radius = float(np.clip(0.45 * distance.min(), 0.01, 0.05))
    order = np.argsort(everything[:, 2])[::-1]
    weights = np.einsum("ij,ij->i", everything, everything)
    colors = colormap((weights - weights.min()) / np.ptp(weights))
    for rank, index in enumerate(order):
        scene.sphere(f"marble_{rank}", radius=radius, position=everything[index], density=2500, color=colors[index].clip(0, 1))
    mean, std = everything.mean(axis=0), everything.std(ddof=1)
    print(np.round(mean, 3).tolist(), f"{std:.3f}", everything.shape, everything.dtype, np.isfinite(everything).all(), np.median(weights))
    scene.camera("top", eye=(0, -2.0, 3.0), target=(0, 0, 0.3))
