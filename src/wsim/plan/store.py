"""Plans on disk: what comes from a file is a plan, laid out, or one clear line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

from pydantic import ValidationError

from wsim.errors import UserError
from wsim.plan.layout import LayoutError, layout
from wsim.plan.layout.land import set_down
from wsim.plan.schema import PLAN_VERSION, Plan, PlanObject, explain
from wsim.plan.schema.objects import SPREAD
from wsim.plan.templates import write_out_blocks, write_out_fluids
from wsim.plan.views import resolve_all

LARGEST = 20_000_000  # bytes of a plan's file: a plan of ten thousand objects has about ten million


def load(path: str | Path) -> Plan:
    """Read and validate a plan; where an object that takes up space lacks its pose, lay the plan out.

    A plan whose objects all have their poses keeps them; its fluids' levels and its cameras' places are worked out.

    Raises:
        UserError: the file cannot be read, is not JSON, is not a plan, or cannot be laid out; one line that names the
            place in the file.
    """
    return _placed(read(path), Path(path))


def made(data: Any, where: Path) -> Plan:
    """A plan of parsed JSON, validated and laid out as `load` does; `where` names it in errors.

    Raises:
        UserError: As `load`.
    """
    return _placed(_validated(data, where), where)


def _placed(plan: Plan, path: Path) -> Plan:
    try:
        plan = write_out_blocks(plan)
        if all(item.pose is not None or _needs_none(item) for item in plan.objects):
            return resolve_all(set_down(write_out_fluids(plan)), keep=True)
        return layout(plan)
    except LayoutError as error:
        raise UserError(f"{path}: {error}") from error
    except ValidationError as error:  # rows of numbers in range can add up to a place that is not
        raise UserError(f"{path}: laid out, it is no plan: {explain(error)}") from error


def _needs_none(item: PlanObject) -> bool:
    """Whether the layout has nothing to place: the ground, what is spread over it, fluids but blocks in a container."""
    if item.primitive != "fluid":
        return item.primitive in ("ground", *SPREAD)
    rows = {row.predicate for row in item.relations}
    return not item.size or "FREE-SURFACE-AT" in rows or "PLACE-IN" not in rows


def read(path: str | Path) -> Plan:
    """Read and validate a plan as it is written, with no places but those in the file.

    Raises:
        UserError: the file cannot be read, is not JSON, or is not a plan.
    """
    return _validated(parsed(path), Path(path))


def parsed(path: str | Path) -> Any:
    """The JSON of a plan's file, whatever it says.

    Raises:
        UserError: the file cannot be read, or is not JSON.
    """
    return _parse(Path(path), _text(Path(path)))


def _validated(data: Any, path: Path) -> Plan:
    version = data.get("version", PLAN_VERSION) if isinstance(data, dict) else PLAN_VERSION
    # Asked before all else: a plan of another version is wrong in every line, and only this one says why.
    if type(version) is int and version != PLAN_VERSION:
        raise UserError(
            f"{path}: version {str(version)[:20]}: this version of wsim reads version {PLAN_VERSION} plans; "
            'make it anew with wsim plan "SENTENCE" -o FILE'
        )
    try:
        return Plan.model_validate(data)
    except ValidationError as error:
        raise UserError(f"{path}: not a plan: {explain(error)}") from error


def _text(path: Path) -> str:
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST + 1)
        if len(raw) > LARGEST:
            raise UserError(f"{path}: larger than {LARGEST / 1e6:g} MB, the most that a plan may have; split the world")
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(
            f"{path}: cannot be read: not UTF-8 text at byte {error.start}; save it with that encoding"
        ) from error
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read: {error}") from error


def _parse(path: Path, text: str) -> Any:
    try:
        return json.loads(text, parse_constant=_no_constant, parse_int=_integer, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise UserError(f"{path}: not JSON: {error.msg} at line {error.lineno}, column {error.colno}") from error
    except RecursionError as error:
        raise UserError(
            f"{path}: lists or objects are nested too deep for a plan; a plan has about ten levels"
        ) from error
    except ValueError as error:  # from the three functions below
        raise UserError(f"{path}: {error}") from error


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of a plan; write a finite one")


def _integer(digits: str) -> int:
    if len(digits) > 400:  # Python refuses beyond 4300 in words of its own; nothing in a plan comes near
        raise ValueError(f"a number of {len(digits)} digits, {digits[:12]}…; no number of a plan is so large")
    return int(digits)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object's fields; JSON would let the last of two win, and what the first said would be lost in silence."""
    fields = dict(pairs)
    if len(fields) < len(pairs):
        seen: set[str] = set()
        for key, _ in pairs:
            if key in seen:
                raise ValueError(f"the field {key[:60]!r} is given twice in one object; remove one of the two")
            seen.add(key)
    return fields


def save(plan: Plan, path: str | Path) -> None:
    """Write a plan as JSON, to a side name first, so that no reader sees half of it."""
    path = Path(path)
    side = path.with_name(path.name + ".part")
    side.write_text(plan.model_dump_json(indent=2) + "\n", encoding="utf-8")
    side.replace(path)
