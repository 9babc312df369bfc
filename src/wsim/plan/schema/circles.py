"""What needs what: an order in which each thing comes after those it needs, or the circle that rules it out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator


def in_turn(names: Iterable[str], needs: Callable[[str], Iterable[str]]) -> Iterator[str | list[str]]:
    """Each name once, after all that it needs; where some need each other in a circle, the list of them first.

    Without recursion: a chain may be as long as the plan.
    """
    done: set[str] = set()
    for start in names:
        path = {start: iter(needs(start))} if start not in done else {}
        while path:
            name = next(reversed(path))
            after = next((one for one in path[name] if one not in done), None)
            if after is None:
                del path[name]
                done.add(name)
                yield name
            elif after in path:
                around = list(path)
                yield around[around.index(after) :]
            else:
                path[after] = iter(needs(after))


def round_again(circle: list[str]) -> Iterator[tuple[str, str]]:
    """Each name of a circle with the one that it needs."""
    return zip(circle, [*circle[1:], circle[0]], strict=True)
