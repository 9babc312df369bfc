"""The normal speeds that contacts are asked for: those that rest, that meet and bounce, and that wait for a blow."""

from __future__ import annotations

import numpy as np

from wsim.solvers.contact_config import ContactConfig

Array = np.ndarray
LATER = 1e3  # [m/s], far below what any contact is asked for: it takes no part


def settling(distance: Array, h: float, config: ContactConfig) -> Array:
    """Speed at which contacts may close, or must open, without a bounce [m/s]."""
    return np.where(distance > 0.0, -distance / h, np.minimum(-distance / config.settle_time, config.settle_speed))


def rebounds(distance: Array, speed: Array, free: Array, restitution: Array, h: float, smooth: Array) -> Array:
    """Speeds right after surfaces meet, for which the energy of the fall comes back e² times [m/s].

    Steps of the first order, v += a h, z += v h, follow the parabola on which the speed is v + a h / 2: they keep
    v² + a h v - 2 a z. Others follow that of v.

    Args:
        distance: Gaps [m].
        speed: Normal speeds before [m/s].
        free: Normal accelerations without constraints [m/s^2].
        restitution: Of each pair.
        h: Time step [s].
        smooth: Whether the bodies fly by steps of a higher order, (contacts,).
    """
    half = np.where(smooth, 0.0, 0.5 * free * h)
    fall = 2.0 * np.maximum(distance, speed * h) * free  # no deeper than this approach has brought it
    squared = restitution**2 * ((speed + half) ** 2 - fall) + fall
    return np.maximum(np.sqrt(np.maximum(squared, 0.0)) - half, 0.0)


def after_blows(
    distance: Array,
    speed: Array,
    free: Array,
    restitution: Array,
    h: float,
    config: ContactConfig,
    smooth: Array | bool = False,
    whole: bool = False,
) -> tuple[Array, Array]:
    """Normal speeds that contacts should have after the blows of an instant [m/s], and which of them meet and bounce,
    (contacts,) each.

    While anything does, what could bounce and does not meet takes no part: what is sent against it meets it in the next
    round. After that all end their approaches as contacts do that do not bounce.

    Args:
        distance: Gaps, negative where shapes overlap [m].
        speed: Normal speeds before, negative where they approach [m/s].
        free: Normal accelerations without constraints [m/s^2].
        restitution: Of each pair.
        h: Time step [s].
        config: How the law is applied.
        smooth: Whether bodies fly by steps of a higher order.
        whole: Whether no blow is shared with the next step (`at_once`).
    """
    bouncy = restitution > 0.0
    meets = bouncy & _meets(distance, speed, h, config)
    goal = targets(distance, speed, restitution, h, config)
    if whole:
        goal = at_once(goal, speed, h, config)
    if not meets.any():
        return goal, meets
    rebound = rebounds(distance, speed, free, restitution, h, np.broadcast_to(smooth, speed.shape))
    return np.where(meets, rebound, np.where(bouncy, -LATER, goal)), meets


def _meets(distance: Array, speed: Array, h: float, config: ContactConfig) -> Array:
    """Whether surfaces meet at this step's start and not at its end: which is nearer, (contacts,)."""
    after = distance + speed * h
    return (speed < -config.threshold * h) & (after < 0.0) & (-after > distance)


def first_meeting(distance: Array, speed: Array, free: Array, least: float) -> float:
    """When the first of surfaces that are apart meet, by their normal accelerations without constraints [s].

    Args:
        distance: Gaps [m].
        speed: Normal speeds, negative where they approach [m/s].
        free: Normal accelerations [m/s^2].
        least: Slower ones do not count [m/s].
    """
    squared = speed**2 - 2.0 * free * distance
    meets = (distance > 0.0) & (speed < -least) & (squared >= 0.0)
    after = 2.0 * distance[meets] / (np.sqrt(squared[meets]) - speed[meets])
    return float(after.min(initial=np.inf))


def targets(distance: Array, speed: Array, restitution: Array, h: float, config: ContactConfig) -> Array:
    """Normal speeds that contacts should end a step of `h` [s] with after its blows [m/s], (contacts,).

    What bounces and comes near lets itself be met nearer to the surface, unless it does meet.

    Args:
        distance: Gaps, negative where shapes overlap [m].
        speed: Normal speeds at the step's start, negative where they approach [m/s].
        restitution: Of each pair.
        h: Time step [s].
        config: How the law is applied.
    """
    goal = settling(distance, h, config)
    waits = (restitution > 0.0) & (distance > 0.0) & (speed < -config.threshold * h)
    waits &= ~_meets(distance, speed, h, config)
    return np.where(waits, np.minimum(goal, 4.0 * speed), goal)


def stopped(goal: Array, speed: Array, h: float, config: ContactConfig) -> Array:
    """Whether a step ends an approach [m/s] that a step of falling does not make, (contacts,)."""
    least = config.threshold * h
    return (speed < -least) & (goal - speed > least)


def at_once(goal: Array, speed: Array, h: float, config: ContactConfig) -> Array:
    """Speeds that end at once all approaches which a step ends, or which it shares with the next [m/s], (n,).

    What does not bounce keeps the speed that closes its gap by the step's end and loses it in the next one. What that
    passes on is a blow and its half, by where the step began; this is the whole.
    """
    least = config.steady * h
    return np.where((speed < -least) & (goal - speed > least), 0.0, goal)


def friction_pays(blow: Array, most: Array, push: Array, rub: Array, before: Array, after: Array) -> Array:
    """Rebound that a blow's friction has used up [m/s], (contacts,).

    A push that turns the slip round gives what slips energy: it is what surfaces stored as they were pressed in, and
    it is missing where they part (Stronge 1990). Newton's e knows nothing of it: with Coulomb's friction a blow could
    end with more energy than it started with (Kane and Levinson 1985). A blow's work is the mean of first and last
    speed times its impulse: the rebound is less by friction's work over half the push, where that is not negative.
    The blow then takes (1 - e) / 2 of push times approach at least, as without friction.

    Args:
        blow: Whether surfaces meet.
        most: What they are asked for without friction [m/s].
        push: Of the normal rows [N].
        rub: Of the rows of friction [N or N m], (contacts, rows).
        before: Their slips at the step's start [m/s or rad/s].
        after: And at its end.
    """
    gained = np.einsum("nr,nr->n", rub, before + after)
    pays = np.divide(gained, push, out=np.zeros(len(push)), where=blow & (push > 0.0))
    return np.clip(pays, 0.0, np.where(blow, most, 0.0))
