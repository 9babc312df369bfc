"""The short form of a plan, as a model or a person writes it: flat objects, objectives as sentences."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from wsim.errors import UserError
from wsim.judge.language import parse
from wsim.plan.feasible.plan import refuse_impossible
from wsim.plan.schema import Plan
from wsim.plan.schema.clause import OF_JOINTS, OF_OBJECTS
from wsim.plan.store import made, parsed


def load_given(path: Path) -> Plan:
    """Read a plan that a person gives, in the full form or the short one; validated, laid out, and possible.

    Raises:
        UserError: The file cannot be read, is no plan, cannot be laid out, or what it says cannot come true.
    """
    data = parsed(path)
    plan = made(written_out(data, f"{path}: ") if isinstance(data, dict) else data, path)
    refuse_impossible(plan, path)
    return plan


def written_out(answer: dict[str, Any], where: str = "") -> dict[str, Any]:
    """The full form of a plan in either form.

    Args:
        answer: The plan as JSON; it is left as it is.
        where: Put before the path in messages.

    Raises:
        UserError: A sentence is none of the language.
    """
    data = dict(answer)
    if isinstance(data.get("objects"), list):
        data["objects"] = [_object(item) if isinstance(item, dict) else item for item in data["objects"]]
    if isinstance(data.get("objectives"), list):
        data["objectives"] = [
            _objective(item, f"{where}objectives.{number}.sentence") if isinstance(item, dict) else item
            for number, item in enumerate(data["objectives"])
        ]
    if isinstance(data.get("clauses"), list) and isinstance(data.get("joints"), list):
        data["clauses"] = [_clause(clause, data["joints"]) for clause in data["clauses"]]
    return data


def _clause(clause: Any, joints: list[Any]) -> Any:
    """A clause that may name a joint's property by the body that the joint moves: "drum.drive" is its hinge's."""
    if not isinstance(clause, dict) or not isinstance(clause.get("by"), list):
        return clause
    of = {joint.get("child"): joint.get("name") for joint in joints if isinstance(joint, dict)}

    def meant(by: Any) -> Any:
        name, _, field = by.partition(".") if isinstance(by, str) else ("", "", "")
        return f"{of[name]}.{field}" if field in OF_JOINTS and field not in OF_OBJECTS and of.get(name) else by

    return {**clause, "by": [meant(by) for by in clause["by"]]}


def _object(item: dict[str, Any]) -> dict[str, Any]:
    """An object whose `primitive` and `size`, or `asset`, and `relations` may stand at its top."""
    full = dict(item)
    if "construction" not in full:
        if "asset" in full:
            full["construction"] = {"kind": "asset", "asset": full.pop("asset")}
        elif "primitive" in full:
            full["construction"] = {"primitive": full.pop("primitive"), "size": full.pop("size", [])}
    if isinstance(full.get("construction"), dict):
        full["construction"] = {"kind": "proxy", **full["construction"]}
    if "relations" in full and "topology" not in full:
        full["topology"] = {"relation": _rows(full.pop("relations"))}
    if isinstance(full.get("position"), list) and "pose" not in full:
        full["pose"] = {"position": full.pop("position"), "rotation_deg": full.pop("rotation_deg", [0, 0, 0])}
    return full


def _rows(relations: Any) -> Any:
    """A level is of the container that the fluid is in: named once more, it says nothing else."""
    if not isinstance(relations, list) or not all(isinstance(row, dict) for row in relations):
        return relations
    inside = {row.get("ref") for row in relations if row.get("predicate") == "PLACE-IN"}
    return [
        {key: value for key, value in row.items() if key != "ref" or value not in inside}
        if row.get("predicate") == "FREE-SURFACE-AT"
        else row
        for row in relations
    ]


def _objective(item: dict[str, Any], where: str) -> dict[str, Any]:
    """An objective whose formula may be its sentence."""
    if item.get("kind") != "formula" or "formula" in item:
        return item
    try:
        return item | {"formula": parse(str(item.get("sentence", ""))).model_dump(mode="json", exclude_none=True)}
    except ValueError as error:
        raise UserError(f"{where}: {error}") from error
