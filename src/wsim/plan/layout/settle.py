"""Places for what the rows leave free: first where it would best be, then, if that is taken, where the solver finds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.plan.layout.equations import Conflict, System, Var
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.free import Search, room_of
from wsim.plan.layout.nearest import place_nearby
from wsim.plan.layout.space import Places, Space

if TYPE_CHECKING:
    from wsim.plan.layout.world import World

Wish = tuple[dict[Var, float], float]  # terms that add up to the number, if nothing else says otherwise


def settle(world: World, system: System, names: list[str], wishes: list[Wish]) -> Places:
    """The centre of each body in the plane [m].

    Args:
        world: Sizes, headings and heights.
        system: What the rows say; must hold.
        names: The bodies.
        wishes: What neighbours would have: to be in line, across the side that a row names.

    Raises:
        LayoutError: bodies are put where nothing carries them, or do not all fit where they must be.
    """
    space = Space(world, system, names)
    space.check_determined()
    best = _best(space, system, wishes)
    if not space.troubled(best, names):
        return best
    in_line = list(wishes)
    while True:
        start = system.copy()
        _wish(start, [({var: 1.0}, value) for var, value in world.settled.items() if var[1] in space.areas])
        _wish(start, in_line)
        found, stuck = _by_levels(space, start, wishes)
        if found is not None:
            return found
        # What finds no place in line with its neighbours goes where there is one; the others stay in line.
        fewer = [wish for wish in in_line if not {name for _, name in wish[0]} & stuck]
        if not in_line:
            return _at_once(space, best)
        in_line = fewer if len(fewer) < len(in_line) else []


def _by_levels(space: Space, start: System, wishes: list[Wish]) -> tuple[Places | None, set[str]]:
    """From the ground up: what stands on the base first, then what stands on that, so that each problem is small.

    Returns:
        The places, if there are any, else the bodies that found none.
    """
    pinned = start.copy()
    level_of = _levels(space, start)
    best = _best(space, pinned, wishes)
    suspects = space.troubled(best, space.names)
    for level in sorted(set(level_of.values())):
        here = [name for name in space.names if level_of[name] == level]
        # Who is in no trouble among all is in none among those below; looking again at each level takes n^2 for n.
        if not suspects.isdisjoint(here):
            among = [name for name in space.names if level_of[name] <= level]
            trouble = space.troubled(best, among)
            for loose in ([name for name in here if name in trouble], here):
                values = _search(space, pinned, best, loose, among) if trouble else None
                if values:
                    _pin(space, pinned, values)
                    best = _best(space, pinned, wishes)
                    trouble = space.troubled(best, among)
            if trouble:
                return None, trouble
            suspects = space.troubled(best, space.names)
        _pin(space, pinned, {(k, name): best[name][k] for name in here for k in (0, 1)}, remember=False)
    return _best(space, pinned, wishes), set()


def _search(space: Space, system: System, best: Places, loose: list[str], among: list[str]) -> dict[Var, float] | None:
    """The nearest free place for one after the other; where that fails, what the solver finds."""
    found = place_nearby(space, system, best, loose, among, room_of(space, best, among))
    return found if found is not None else Search(space, system, best, loose, among).run()


def _at_once(space: Space, best: Places) -> Places:
    """All free bodies in one problem.

    Raises:
        LayoutError: there is no room for them.
    """
    trouble = space.troubled(best, space.names)
    pinned = space.system.copy()
    values = Search(space, pinned, best, space.names, space.names).run()
    if values is None:
        held: dict[str, list[str]] = {}
        for name in space.names:
            if name in trouble:
                area = space.areas[name][0] if space.areas[name] else None
                where = (area.carrier if area else None) or ("the region" if area and area.row else "the base")
                held.setdefault(where, []).append(name)
        said = "; ".join(f"{', '.join(names)} on or in {where}" for where, names in held.items())
        rows = "; ".join(str(row) for name in sorted(trouble) for row in space.world.of[name])[:600]
        raise LayoutError(
            f"no room was found for all of these where their rows want them: {said}; make room, or drop one of: {rows}"
        )
    _pin(space, pinned, values)
    return _best(space, pinned, [])


def _pin(space: Space, system: System, values: dict[Var, float], remember: bool = True) -> None:
    for var, value in values.items():
        try:
            system.add({var: 1.0}, value, None)
        except Conflict:
            continue  # settled by another of the values
        if remember:
            space.world.settled[var] = value


def _levels(space: Space, system: System) -> dict[str, int]:
    """The level of each body: that of the lowest of those that the rows tie it to."""
    lowest: dict[Var, int] = {}
    for name in space.names:
        for k in (0, 1):
            for var in system.value((k, name)).terms:
                lowest[var] = min(lowest.get(var, space.depth[name]), space.depth[name])
    found = {}
    for name in space.names:
        own = [lowest[var] for k in (0, 1) for var in system.value((k, name)).terms]
        found[name] = max(own, default=min(space.depth[name], 0))
    return found


def _wish(system: System, wishes: list[Wish]) -> None:
    """State what may be; what the rest rules out is dropped."""
    for terms, const in wishes:
        try:
            system.add(terms, const, None)
        except Conflict:
            continue


def _best(space: Space, system: System, wishes: list[Wish]) -> Places:
    """Where each body would best be: where it was, in line with its neighbours, in the middle of what carries it."""
    plain = system.copy()
    inside = set(space.names)
    _wish(plain, [({var: 1.0}, value) for var, value in space.world.settled.items() if var[1] in inside])
    _wish(plain, wishes)
    alike: dict[tuple[object, ...], list[str]] = {}
    for name in space.names:
        if space.areas[name]:
            area = space.areas[name][0]
            alike.setdefault((area.carrier, area.kind, area.middle), []).append(name)
    for name in sorted(space.names, key=lambda one: space.depth[one]):
        if space.areas[name]:
            area = space.areas[name][0]
            for axis in (0, 1):
                _center(space, plain, name, axis, alike[(area.carrier, area.kind, area.middle)])
    places = {}
    for name in space.names:
        x, y = plain.value((0, name)), plain.value((1, name))
        places[name] = (x.const, y.const)  # what nothing ties is at the origin
    return places


def _center(space: Space, system: System, name: str, axis: int, mates: list[str]) -> None:
    """Put the middle of all that is tied to a body and stands where it stands to the middle of that."""
    area = space.areas[name][0]
    terms: dict[Var, float] = {(axis, name): 1.0}
    if area.carrier is not None:
        terms[(axis, area.carrier)] = -1.0
    mine = system.value((axis, name))
    if not mine.terms or not system.reduce(terms).terms:
        return
    low = high = 0.0
    for mate in mates:
        other = system.value((axis, mate))
        if other.terms == mine.terms:
            half = space.world.extents(mate)[axis] / 2
            low = min(low, other.const - mine.const - half)
            high = max(high, other.const - mine.const + half)
    _wish(system, [(terms, area.wish[axis] - (low + high) / 2)])
