"""How far a faulty recording is from the sound one: what makes sure that a planted fault is there."""

from __future__ import annotations

import numpy as np

from benchmarks.judge_worlds.fault import Difference
from benchmarks.judge_worlds.tamper import ROOT
from wsim.recording import Recording
from wsim.scene.world import Shape


def _common(sound: Recording, faulty: Recording) -> int:
    return min(len(sound.time), len(faulty.time))


def _offset(sound: Recording, faulty: Recording, name: str) -> np.ndarray:
    n = _common(sound, faulty)
    offset: np.ndarray = faulty.position(ROOT + name)[:n] - sound.position(ROOT + name)[:n]
    return np.asarray(offset, dtype=np.float64)


def way(name: str) -> Difference:
    """The farthest that a body is from where it should be, at any time [m]."""
    return lambda sound, faulty: float(np.linalg.norm(_offset(sound, faulty, name), axis=1).max())


def end(name: str) -> Difference:
    """How far a body ends from where it should [m]."""
    return lambda sound, faulty: float(np.linalg.norm(_offset(sound, faulty, name)[-1]))


def height(name: str) -> Difference:
    """How much higher or lower a body is than it should be, as a mean over the last second [m]."""

    def measure(sound: Recording, faulty: Recording) -> float:
        here = sound.time[: _common(sound, faulty)] >= sound.time[-1] - 1.0
        return abs(float(_offset(sound, faulty, name)[here, 2].mean()))

    return measure


def turn(name: str) -> Difference:
    """The largest angle between a body's rotation and what it should be, at any time [deg]."""

    def measure(sound: Recording, faulty: Recording) -> float:
        n = _common(sound, faulty)
        a, b = (r.rotation(ROOT + name)[:n].astype(np.float64) for r in (sound, faulty))
        cosine = np.abs(np.einsum("ti,ti->t", a, b)) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        return float(np.degrees(2 * np.arccos(np.clip(cosine, 0.0, 1.0))).max())

    return measure


def speed(name: str) -> Difference:
    """The largest difference of a body's velocity, at any time [m/s]."""

    def measure(sound: Recording, faulty: Recording) -> float:
        n = _common(sound, faulty)
        apart = faulty.velocity(ROOT + name)[:n] - sound.velocity(ROOT + name)[:n]
        return float(np.linalg.norm(apart, axis=1).max())

    return measure


def trembling(name: str) -> Difference:
    """How much a body jumps from frame to frame beyond what it should: half the rms of its second difference [m]."""

    def rms(recording: Recording) -> float:
        bends = np.diff(recording.position(ROOT + name).astype(np.float64), n=2, axis=0)
        return float(np.sqrt((bends**2).sum(axis=1).mean())) / 4

    return lambda sound, faulty: rms(faulty) - rms(sound)


def energy() -> Difference:
    """The largest difference of the mechanical energy, over the greatest kinetic energy of the sound run."""

    def measure(sound: Recording, faulty: Recording) -> float:
        n = _common(sound, faulty)
        total = [r.scalars["energy/kinetic"][:n] + r.scalars["energy/potential"][:n] for r in (sound, faulty)]
        return float(np.abs(total[1] - total[0]).max() / sound.scalars["energy/kinetic"].max())

    return measure


def _ratio(a: float, b: float) -> float:
    return max(a / b, b / a) if a > 0.0 and b > 0.0 else np.inf


def mass(name: str) -> Difference:
    """The ratio of a body's masses, at least 1."""
    return lambda sound, faulty: _ratio(sound.world.body(ROOT + name).mass, faulty.world.body(ROOT + name).mass)


def gravity() -> Difference:
    """The difference of gravity, over the strength that it should have."""

    def measure(sound: Recording, faulty: Recording) -> float:
        right, wrong = np.array(sound.world.gravity), np.array(faulty.world.gravity)
        return float(np.linalg.norm(wrong - right) / np.linalg.norm(right))

    return measure


def _shapes(recording: Recording, name: str) -> list[Shape]:
    world = recording.world
    return [s for thing in (*world.bodies, *world.statics) if thing.prim == ROOT + name for s in thing.shapes]


def extent(name: str) -> Difference:
    """The ratio of an object's sizes, at least 1."""
    return lambda sound, faulty: max(
        _ratio(a, b)
        for one, other in zip(_shapes(sound, name), _shapes(faulty, name), strict=True)
        for a, b in zip(one.size, other.size, strict=True)
    )


def colour(name: str) -> Difference:
    """The largest difference of a channel of an object's colour, 0..1."""
    return lambda sound, faulty: max(
        abs(a - b) for a, b in zip(_shapes(sound, name)[0].color, _shapes(faulty, name)[0].color, strict=True)
    )


def friction(name: str) -> Difference:
    """The difference of an object's coefficient of friction."""
    return lambda sound, faulty: abs(_shapes(sound, name)[0].friction - _shapes(faulty, name)[0].friction)


def gone(name: str) -> Difference:
    """1 where an object that should be there is not, or the reverse."""

    def there(recording: Recording) -> bool:
        world = recording.world
        return any(item.prim == ROOT + name for item in (*world.bodies, *world.statics, *world.fluids))

    return lambda sound, faulty: float(there(sound) != there(faulty))


def static_way(name: str) -> Difference:
    """How far an object that never moves is from where it should be [m]."""
    return lambda sound, faulty: float(
        np.linalg.norm(np.subtract(_shapes(sound, name)[0].position, _shapes(faulty, name)[0].position))
    )


def view() -> Difference:
    """The angle by which the first camera looks elsewhere [deg]."""

    def measure(sound: Recording, faulty: Recording) -> float:
        looks = [np.subtract(r.world.cameras[0].target, r.world.cameras[0].eye) for r in (sound, faulty)]
        a, b = (look / np.linalg.norm(look) for look in looks)
        return float(np.degrees(np.arccos(np.clip(a @ b, -1.0, 1.0))))

    return measure


def unseen(name: str) -> Difference:
    """The share of an object's pixels, over all pictures, that are no longer there."""

    def shown(recording: Recording) -> float:
        tracks = [track for track in recording.seen.values() if ROOT + name in track.objects]
        return sum(float(track.share[:, track.objects.index(ROOT + name)].mean()) for track in tracks)

    return lambda sound, faulty: 1.0 - shown(faulty) / shown(sound)


def pressed(name: str) -> Difference:
    """The ratio of a body's mean contact forces over the run, at least 1."""
    return lambda sound, faulty: _ratio(
        *(float(np.linalg.norm(r.force(ROOT + name), axis=1).mean()) for r in (sound, faulty))
    )


def lasting() -> Difference:
    """The difference of the times that the recordings cover [s]."""
    return lambda sound, faulty: abs(float(sound.time[-1] - faulty.time[-1]))


def fluid_way(name: str) -> Difference:
    """The farthest that a particle is from where it should be, at any time [m]."""

    def measure(sound: Recording, faulty: Recording) -> float:
        a, b = (r.fluids[ROOT + name].position for r in (sound, faulty))
        n = min(len(a), len(b))
        return float(np.linalg.norm(a[:n] - b[:n], axis=2).max())

    return measure


def fluid_moved(name: str, by: float) -> Difference:
    """The share of a fluid's particles that end farther than `by` [m] from where they should."""

    def measure(sound: Recording, faulty: Recording) -> float:
        apart = faulty.fluids[ROOT + name].position[-1] - sound.fluids[ROOT + name].position[-1]
        return float((np.linalg.norm(apart, axis=1) > by).mean())

    return measure


def fluid_density(name: str) -> Difference:
    """The ratio of a fluid's rest densities, at least 1."""

    def rest(recording: Recording) -> float:
        return next(f.density for f in recording.world.fluids if f.prim == ROOT + name)

    return lambda sound, faulty: _ratio(rest(sound), rest(faulty))


def fluid_level(name: str) -> Difference:
    """The difference of the depths to which a fluid is filled at the start [m]."""

    def depth(recording: Recording) -> float:
        return next(f.size[2] for f in recording.world.fluids if f.prim == ROOT + name)

    return lambda sound, faulty: abs(depth(sound) - depth(faulty))


def compression(name: str) -> Difference:
    """The difference of the mean density errors over the run."""

    def error(recording: Recording) -> float:
        rest = next(f.density for f in recording.world.fluids if f.prim == ROOT + name)
        return float(np.abs(recording.fluids[ROOT + name].density / rest - 1.0).mean())

    return lambda sound, faulty: abs(error(faulty) - error(sound))
