"""Turn, scale and centre what was read: Z up, +X forward, metres, the origin at the centre of the bottom face."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wsim.intake.model import Array, Body, IntakeError, Joint, Model

AXES = tuple(sign + axis for axis in "xyz" for sign in "+-")
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
SMALLEST, LARGEST = 1e-3, 100.0  # [m], of the longest edge
THINNEST = 1e-4  # [m], of any edge
_IN_METRES = 10.0  # a file without units whose longest edge is above this is taken to be in millimetres


@dataclass(frozen=True)
class Placing:
    """What the user said of a file's axes and size; None is what the file says, or is usual in its format."""

    up: str | None = None
    forward: str | None = None
    height: float | None = None  # [m]
    unit: str | None = None


def orient(model: Model, placing: Placing) -> Model:
    """The model as assets stand.

    Raises:
        IntakeError: If the axes are not at right angles, or the size is absurd.
    """
    notes = list(model.notes)
    turn = _turn(model, placing, notes)
    points = model.points() @ turn.T
    low, high = points.min(axis=0), points.max(axis=0)
    extent = high - low
    scale = _scale(extent, model.unit, placing, notes)
    _sane(extent * scale, placing)
    shift = -scale * np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    bodies = [_moved(body, turn, scale, shift) for body in model.bodies]
    joints = [_joint(joint, turn, scale, shift) for joint in model.joints]
    return Model(bodies, "z", "+x", 1.0, joints, notes)


def _axis(name: str, field: str) -> Array:
    text = name.lower() if name[:1] in "+-" else f"+{name.lower()}"
    if text not in AXES:
        raise IntakeError(f"{field} = {name} must be one of {', '.join(AXES)}")
    return float(f"{text[0]}1") * np.eye(3)["xyz".index(text[1])]


def _turn(model: Model, placing: Placing, notes: list[str]) -> Array:
    """The rotation (3, 3) from the file's axes to the asset's."""
    up_name = placing.up or model.up
    usual = model.forward if up_name == model.up else {"y": "+z", "z": "+x"}.get(up_name.lstrip("+"), "+x")
    forward_name = placing.forward or usual
    up, forward = _axis(up_name, "up"), _axis(forward_name, "forward")
    if abs(up @ forward) > 0.5:
        raise IntakeError(f"forward = {forward_name} lies along up = {up_name}; take one at right angles to it")
    if placing.up is None or placing.forward is None:
        notes.append(f"taken: {up_name.lstrip('+')} is up and {forward_name} is forward in the file; --up, --forward")
    return np.stack([forward, np.cross(up, forward), up])


def _scale(extent: Array, unit: float | None, placing: Placing, notes: list[str]) -> float:
    """Metres in a unit of the file."""
    if placing.height is not None:
        if not (np.isfinite(placing.height) and placing.height > 0.0):
            raise IntakeError(f"height = {placing.height:g} must be a number above 0 [m]")
        if not extent[2] > 0.0:
            raise IntakeError("height = 0 in the file, which no --height scales; say its unit with --unit")
        return float(placing.height / extent[2])
    if placing.unit is not None:
        if placing.unit not in UNITS:
            raise IntakeError(f"unit = {placing.unit} must be one of {', '.join(UNITS)}")
        return UNITS[placing.unit]
    if unit is not None:
        return unit
    name, scale = ("mm", 0.001) if extent.max() > _IN_METRES else ("m", 1.0)
    size = " x ".join(f"{v:.3g}" for v in extent * scale)
    notes.append(f"taken: the file says no unit; {name}, which makes it {size} m; --unit or --height say otherwise")
    return scale


def _sane(size: Array, placing: Placing) -> None:
    said = " x ".join(f"{v:.3g}" for v in size)
    way = "give another --height" if placing.height is not None else "give --height in metres, or --unit"
    if not SMALLEST <= size.max() <= LARGEST:
        raise IntakeError(f"size = {said} m; its longest edge must be {SMALLEST:g} to {LARGEST:g} m: {way}")
    if size.min() < THINNEST:
        raise IntakeError(
            f"size = {said} m has no thickness: a flat sheet cannot collide or weigh; give it one in the tool that it "
            "is from (solidify, extrude)"
        )


def _moved(body: Body, turn: Array, scale: float, shift: Array) -> Body:
    return replace(
        body,
        meshes=[mesh.moved(scale * turn, shift) for mesh in body.meshes],
        colliders=[collider.moved(turn, shift, scale) for collider in body.colliders],
        com=None if body.com is None else scale * (turn @ body.com) + shift,
        inertia=None if body.inertia is None else scale**2 * (turn @ body.inertia @ turn.T),
        origin=scale * (turn @ body.origin) + shift,
        turn=turn @ body.turn,
    )


def _joint(joint: Joint, turn: Array, scale: float, shift: Array) -> Joint:
    limits = joint.limits
    if limits is not None and joint.kind == "prismatic":
        limits = (limits[0] * scale, limits[1] * scale)
    return replace(joint, at=scale * (turn @ joint.at) + shift, axis=turn @ joint.axis, limits=limits)
