"""Which joints of a stage make trees, which way round, and which are left to close loops.

A solver in joint coordinates takes trees of joints: what closes a loop becomes a constraint instead, and so does what
may break. A constraint has no coordinate of its own, so a slider, and what is driven, limited, rubbed or geared, is in
the tree (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, section 8.1: which joints make the tree is free).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pxr import Sdf

WORLD_END = Sdf.Path.absoluteRootPath


@dataclass(frozen=True)
class Link:
    """A joint as an edge between two bodies."""

    joint: Sdf.Path
    parent: Sdf.Path
    child: Sdf.Path
    needs_coordinate: bool = False
    may_break: bool = False


@dataclass(frozen=True)
class Tree:
    """What `span` chose."""

    reversed: list[Sdf.Path]  # joints whose child is nearer to the root than their parent
    closing: list[Sdf.Path]  # joints that are constraints
    roots: list[Sdf.Path]  # of each tree: the joint to the world, or the topmost body
    stuck: list[Sdf.Path]  # joints of a first loop in which each needs a coordinate; empty if there is none


def span(links: Sequence[Link], ground: Iterable[Sdf.Path], tops: Sequence[Sdf.Path] = ()) -> Tree:
    """Choose the trees (Kruskal 1956), the joints that need a coordinate first, else in their order.

    Args:
        links: The joints.
        ground: What goes its own way: the world, and kinematic bodies. A tree hangs on one of them at most.
        tops: At which trees that hang on none of them are to begin; else where their joints say.
    """
    grounded = set(ground) | {WORLD_END}
    groups = _Groups(grounded)
    held = [link for link in links if not link.may_break]
    chosen: list[Link] = []
    stuck: list[Sdf.Path] = []
    for link in sorted(held, key=lambda link: not link.needs_coordinate):
        if groups.join(link.parent, link.child):
            chosen.append(link)
        elif link.needs_coordinate and not stuck:
            stuck = [*_between(chosen, link, grounded), link.joint]
    chosen.sort(key=links.index)
    turned, roots = _orient(chosen, [*(path for path in _ends(links) if path in grounded), *tops])
    inside = {link.joint for link in chosen}
    return Tree(turned, [link.joint for link in links if link.joint not in inside], roots, stuck)


def _ends(links: Sequence[Link]) -> list[Sdf.Path]:
    return list(dict.fromkeys(path for link in links for path in (link.parent, link.child)))


def _orient(links: list[Link], first: list[Sdf.Path]) -> tuple[list[Sdf.Path], list[Sdf.Path]]:
    """The joints that point towards their root, and the roots: what comes first in each tree."""
    children = {link.child for link in links}
    tops = [path for path in _ends(links) if path not in children]
    seen: set[Sdf.Path] = set()
    turned: list[Sdf.Path] = []
    roots: list[Sdf.Path] = []
    # What is nobody's child is the top of its tree, as its joints say; one whose joints say nothing begins anywhere.
    for top in [*first, *tops, *_ends(links)]:
        if top in seen:
            continue
        seen.add(top)
        waiting = [top]
        while waiting:
            here = waiting.pop(0)
            for link in links:
                if here not in (link.parent, link.child):
                    continue
                there = link.child if link.parent == here else link.parent
                if there in seen:
                    continue
                seen.add(there)
                waiting.append(there)
                if link.child == here:
                    turned.append(link.joint)
                if here == WORLD_END:
                    roots.append(link.joint)
                elif here == top:
                    roots.append(top)
    return turned, list(dict.fromkeys(roots))


def _between(links: list[Link], closing: Link, ground: set[Sdf.Path]) -> list[Sdf.Path]:
    """The joints on the way from one end of a joint to the other."""

    def node(path: Sdf.Path) -> Sdf.Path:
        return WORLD_END if path in ground else path

    start, end = node(closing.parent), node(closing.child)
    came: dict[Sdf.Path, Link | None] = {start: None}
    waiting = [start]
    while waiting and end not in came:
        here = waiting.pop(0)
        for link in links:
            first, second = node(link.parent), node(link.child)
            there = {first: second, second: first}.get(here)
            if there is not None and there not in came:
                came[there] = link
                waiting.append(there)
    found: list[Sdf.Path] = []
    here = end
    while (back := came.get(here)) is not None:
        found.append(back.joint)
        first, second = node(back.parent), node(back.child)
        here = first if here == second else second
    return found[::-1]


class _Groups:
    """Bodies that joints hold together."""

    def __init__(self, together: Iterable[Sdf.Path]) -> None:
        self._of = dict.fromkeys(together, WORLD_END)

    def join(self, a: Sdf.Path, b: Sdf.Path) -> bool:
        """Join two; False if they were together."""
        first, second = self._of.setdefault(a, a), self._of.setdefault(b, b)
        if first == second:
            return False
        self._of = {path: first if group == second else group for path, group in self._of.items()}
        return True
