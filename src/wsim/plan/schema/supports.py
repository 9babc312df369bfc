"""What carries what: fluids before what refers to them, one support an object, and no object that carries itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.schema.circles import in_turn, round_again

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft
    from wsim.plan.schema.objects import PlanObject
    from wsim.plan.schema.relations import Relation


def support_problems(plan: Draft) -> list[str]:
    """All of them."""
    return [*_surfaces(plan), *_order(plan), *_doubles(plan), *_circles(plan)]


def _surfaces(plan: Draft) -> Iterator[str]:
    """A fluid says how high it stands, and in what."""
    items = {item.name: item for item in plan.objects}
    for i, item in enumerate(plan.objects):
        if item.role != "fluid":
            if item.registration.volume is not None:
                yield f"objects.{i}.registration.volume: {item.name} is no fluid; remove it"
            continue
        yield from _amount(i, item, items)
        filled = any(row.spec.fills for row in item.relations)
        contained = item.relation("PLACE-IN") is not None
        level = item.relation("FREE-SURFACE-AT") is not None
        if not (filled or contained or item.size):
            yield f"objects.{i}: the fluid {item.name} needs PLACE-IN with a container, or a size (x, y, z) in metres"
        elif contained and not (filled or level or item.size or item.registration.volume):
            yield (
                f'objects.{i}.topology.relation: the fluid {item.name} needs FREE-SURFACE-AT with "value", its level '
                f"above the inner floor in metres, or registration.volume in m^3; or fills_container_to_top in place "
                "of PLACE-IN, or a size (x, y, z)"
            )


def _amount(i: int, item: PlanObject, items: dict[str, PlanObject]) -> Iterator[str]:
    """One amount of a fluid; and only a tank holds none at the start."""
    level, held = item.relation("FREE-SURFACE-AT"), item.relation("PLACE-IN")
    vessel = items.get(held.ref or "") if held is not None else None
    if item.registration.volume is not None and (level is not None or item.size or vessel is None):
        yield (
            f"objects.{i}.registration.volume: of a fluid that is PLACE-IN something, in place of its level and size; "
            "keep one"
        )
    if vessel is not None and vessel.primitive == "asset" and level is not None and level.value == 0.0:
        yield f"objects.{i}: {item.name} stands 0 m high in {vessel.name}; only a tank can start empty"


def _order(plan: Draft) -> Iterator[str]:
    """A fluid's surface is settled before anything is placed by it: it comes first in the list."""
    index = {item.name: k for k, item in enumerate(plan.objects)}
    for i, item in enumerate(plan.objects):
        for j, row in enumerate(item.relations):
            for field, name in row.refs():
                k = index.get(name, -1)
                if k > i and plan.objects[k].role == "fluid":
                    yield (
                        f"objects.{i}.topology.relation.{j}.{field}: the fluid {name} comes after {item.name}, which "
                        f"refers to it; move it up: objects.{k} before objects.{i}"
                    )


def _doubles(plan: Draft) -> Iterator[str]:
    for i, item in enumerate(plan.objects):
        first: tuple[int, Relation] | None = None
        for j, row in enumerate(item.relations):
            if not row.spec.carries:
                continue
            if first is None:
                first = (j, row)
            elif not _same_container(first[1], row):
                yield (
                    f"objects.{i}.topology.relation.{j}: {item.name} is {_said(row)}, and {_said(first[1])} by "
                    f"relation.{first[0]}; a thing starts in one place: remove one of the two rows"
                )
                break


def _same_container(a: Relation, b: Relation) -> bool:
    """A fluid in a container, and the template that says how far it fills it, agree."""
    fills = bool(a.spec.fills) != bool(b.spec.fills)
    return fills and "PLACE-IN" in (a.predicate, b.predicate) and a.ref == b.ref


def _said(row: Relation) -> str:
    return f"{row.sentence()} ({row.predicate})"


def _circles(plan: Draft) -> Iterator[str]:
    """Each circle of supports once, named by its rows."""
    items = {item.name: item for item in plan.objects}
    anchors = {row.group: item.name for item in plan.objects for row in item.relations if row.predicate == "GROUP"}
    index = {item.name: i for i, item in enumerate(plan.objects)}
    for found in in_turn(items, lambda name: [ref for _, ref in reversed(_carriers(items[name], items, anchors))]):
        if isinstance(found, list):
            yield _circle(found, items, anchors, index)


def _carriers(item: PlanObject, items: dict[str, PlanObject], anchors: dict[str | None, str]) -> list[tuple[int, str]]:
    """What carries an object, with the number of the row that says so."""
    found = []
    for j, row in enumerate(item.relations):
        if row.spec.carries:
            for _, name in row.refs():
                carrier = name if name in items else anchors.get(name, "")
                if carrier in items and carrier != item.name:
                    found.append((j, carrier))
    return found


def _circle(
    circle: list[str], items: dict[str, PlanObject], anchors: dict[str | None, str], index: dict[str, int]
) -> str:
    rows = []
    for name, carrier in round_again(circle):
        j = next(j for j, ref in _carriers(items[name], items, anchors) if ref == carrier)
        rows.append((f"objects.{index[name]}.topology.relation.{j}", f"{name} {items[name].relations[j].sentence()}"))
    shown = [f"{said} ({where})" for where, said in rows[:6]] + (["…"] if len(rows) > 6 else [])
    return (
        f"{rows[0][0]}.ref: nothing carries these in the end: {', '.join(shown)}; stand one of them on something else"
    )
