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
    """Speeds after the step in which surfaces meet, for which the energy of the fall comes back e² times [m/s].

    Steps of the first order, v += a h, z += v h, follow the parabola on which the speed is v + a h / 2: they keep
    v² + a h v - 2 a z. Others follow that of v. The step of the blow itself goes on by h times the speed after it.

    Args:
        distance: Gaps [m].
        speed: Normal speeds at the step's start [m/s].
        free: Normal accelerations without constraints [m/s^2].
        restitution: Of each pair.
        h: Time step [s].
        smooth: Whether the bodies fly by steps of a higher order, (contacts,).
    """
    half = np.where(smooth, 0.0, 0.5 * free * h)
    fall = 2.0 * np.maximum(distance, speed * h) * free  # no deeper than this approach has brought it
    own = np.where(smooth, free * h, half)
    squared = restitution**2 * ((speed + half) ** 2 - fall) + fall + np.where(smooth, own**2, 0.0)
    return np.maximum(np.sqrt(np.maximum(squared, 0.0)) + own, 0.0)


def targets(
    distance: Array,
    speed: Array,
    free: Array,
    restitution: Array,
    groups: Array,
    h: float,
    config: ContactConfig,
    smooth: Array | bool = False,
) -> tuple[Array, Array]:
    """Normal speeds that contacts should end a step of `h` [s] with [m/s], and which of them are blows, (contacts,).

    Args:
        distance: Gaps, negative where shapes overlap [m].
        speed: Normal speeds at the step's start, negative where they approach [m/s].
        free: Normal accelerations without constraints [m/s^2].
        restitution: Of each pair.
        groups: Of bodies that joints tie together, (contacts, 2), 0 for the world.
        h: Time step [s].
        config: How the law is applied.
        smooth: Whether bodies fly by steps of a higher order.
    """
    goal = settling(distance, h, config)
    bouncy = restitution > 0.0
    if not bouncy.any():
        return goal, bouncy
    after = distance + speed * h
    fast = bouncy & (speed < -config.threshold * h)
    meets = fast & (after < 0.0) & (-after > distance)
    rebound = rebounds(distance, speed, free, restitution, h, np.broadcast_to(smooth, speed.shape))
    waits = fast & ~meets & (distance > 0.0)
    struck = np.zeros(int(groups.max()) + 1, dtype=bool)
    struck[groups[meets]] = True
    struck[0] = False
    # What overlaps by more than a step of falling brings is held, or a stack that is shaken would sink into itself; but
    # what would be out of it by the step's end is hit anew in the step after, and bounces.
    light = (distance > -config.threshold * h * h) | (after > 0.0)
    later = bouncy & (waits | (~fast & light)) & struck[groups].any(axis=1)
    goal = np.where(waits, np.minimum(goal, 4.0 * speed), goal)
    return np.where(meets, rebound, np.where(later, -LATER, goal)), meets


def stopped(goal: Array, speed: Array, h: float, config: ContactConfig) -> Array:
    """Whether a step ends an approach [m/s] that a step of falling does not make, (contacts,)."""
    least = config.threshold * h
    return (speed < -least) & (goal - speed > least)


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
