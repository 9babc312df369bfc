"""Repair targets of the plan's objectives."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.repair.asked import ref_of
from wsim.judge.repair.drive import by_drive
from wsim.judge.repair.place import over, overlapping_start
from wsim.judge.repair.rule import (
    FARTHEST,
    ROOM,
    Rule,
    add_collision,
    collides,
    density,
    finer,
    longer_run,
    planned_density,
    shapes_of,
    shorter_step,
    time_step,
)
from wsim.judge.repair.run import leak, settled
from wsim.judge.verdict import Finding, RepairTarget
from wsim.scene.contact import friction_of, pair_law

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Container, Fluid, Static

NEAR = 0.1  # of a body's smallest extent: a gap below is that of what stands on something
AFLOAT, SUNK = 0.5, 2.0  # of the fluid's density: as light as wood, as heavy as stone, where nothing says more
SAME = 0.01  # share by which two densities differ by rounding alone


def own_density(evidence: Evidence, prim: str, to: float | None, why: str) -> RepairTarget:
    """Another density of a body [kg/m^3]."""
    now = density(evidence, prim)
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="density", direction=_way(now, to), current=now, suggested=to,
        unit="kg/m^3", why=why,
    )  # fmt: skip


def _way(now: float, to: float | None) -> str:
    return "change" if to is None or to == now else "raise" if to > now else "lower"


def _fluid(finding: Finding, evidence: Evidence) -> Fluid | None:
    ref = ref_of(finding, evidence)
    return next((fluid for fluid in evidence.world.fluids if ref in (fluid.prim, fluid.container)), None)


def floats(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Too heavy, or not of the planned density; else the particles are too coarse for its draft."""
    prim, fluid = finding.prim or "", evidence.fluid(ref_of(finding, evidence))
    container = evidence.container_of(fluid)
    if container is not None and finding.expected == 0.0:
        why = f"it starts beside {container.prim}"
        beside = None if _started_in(evidence, prim, container) else over(evidence, prim, container.prim, why)
        return beside or _too_small(evidence, container.prim, finding.value or 0.0)
    now, planned = density(evidence, prim), planned_density(evidence, prim)
    if now >= fluid.density:
        to = planned if planned is not None and planned < fluid.density else AFLOAT * fluid.density
        why = f"what floats is lighter than the fluid's {fluid.density:g} kg/m^3"
        return own_density(evidence, prim, to, why).model_copy(update={"direction": "lower"})
    if planned is not None and abs(planned / now - 1.0) > SAME:
        why = f"the plan's material; it floats as deep as its share of the fluid's {fluid.density:g} kg/m^3"
        return own_density(evidence, prim, planned, why)
    value, limit, expected = finding.value, finding.limit, finding.expected
    if value is None or limit is None or expected is None or value == expected:
        return settled(finding, evidence)
    share = abs(limit - expected) / abs(value - expected)
    why = "its density gives another draft than is seen; the draft's error shrinks with the spacing"
    return finer(evidence, fluid, share, why)


def _too_small(evidence: Evidence, prim: str, beyond: float) -> RepairTarget:
    container = evidence.container(prim)
    more = 2 * beyond * (1.0 + ROOM)
    x, y, z = container.inner_size if container is not None else (0.0, 0.0, 0.0)
    return RepairTarget(
        kind="geometry", prim=prim, parameter="inner_size", direction="raise",
        vector=None if container is None else (x + more, y + more, z), unit="m",
        why="a body gets out of it: room for its way",
    )  # fmt: skip


def _started_in(evidence: Evidence, prim: str, container: Container) -> bool:
    """Whether a body's centre starts over a container's floor."""
    at = evidence.local(container, evidence.body_q[:1, evidence.index(prim), :3])[0]
    return bool(np.all(np.abs(at[:2]) <= np.array(container.inner_size[:2]) / 2))


def submerged(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Too light to go under, or the fluid too shallow to cover it."""
    prim, fluid = finding.prim or "", evidence.fluid(ref_of(finding, evidence))
    now, planned = density(evidence, prim), planned_density(evidence, prim)
    if now <= fluid.density:
        to = planned if planned is not None and planned > fluid.density else SUNK * fluid.density
        why = f"what sinks is heavier than the fluid's {fluid.density:g} kg/m^3"
        return own_density(evidence, prim, to, why).model_copy(update={"direction": "raise"})
    level = evidence.level(fluid)
    i = evidence.index(prim)
    height = float((evidence.ends(i)[1] - evidence.ends(i)[0])[evidence.window].mean())
    depth = level.height - level.floor
    if height > depth:
        return RepairTarget(
            kind="fluid", prim=fluid.prim, parameter="level", direction="raise", current=depth,
            suggested=depth + (height - depth) + fluid.spacing, unit="m", why="it is taller than the fluid is deep",
        )  # fmt: skip
    return longer_run(evidence, None, "it is heavy enough to sink, and the fluid deep enough: it has not got there yet")


def rests_on(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Above it: too light or not there yet. Below it: nothing stops it. Beside it: put it over it."""
    prim, ref = finding.prim or "", ref_of(finding, evidence)
    if finding.unit == "N":
        return settled(finding, evidence)
    if finding.value is None:
        return beside(evidence, prim, ref)
    if finding.value < 0:
        return fallen_through(finding, evidence, prim, ref)
    fluid = _fluid(finding, evidence)
    if fluid is not None and density(evidence, prim) < fluid.density:
        return submerged(finding, evidence)
    i = evidence.index(prim)
    fall = -float((evidence.body_qd[evidence.window, i, :3] @ evidence.up).mean())
    if fall > 0.0:
        wanted = float(evidence.time[-1]) + finding.value / fall
        return longer_run(evidence, wanted, f"it is still coming down at {fall:.2g} m/s")
    why = f"it hangs {finding.value:.3g} m above {ref}: its collision shape is larger than it looks"
    return RepairTarget(kind="geometry", prim=prim, parameter="collision", direction="change", why=why)


def beside(evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """What comes down beside what is to carry it."""
    why = f"it must come down over {ref}"
    return over(evidence, prim, ref, why) or RepairTarget(
        kind="settlement", prim=prim, parameter="position", direction="change", unit="m", why=why
    )


def fallen_through(finding: Finding, evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """What went through another object: one of the two collides with nothing, or it was too fast for the step."""
    for owner in (ref, prim):
        if not collides(evidence, owner):
            return add_collision(owner)
    return tunnelled(finding, evidence, prim, ref)


def tunnelled(finding: Finding, evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """In a step a body may cross half of the thinnest thing in its way, or it passes between two steps.

    Ericson (2005), Real-Time Collision Detection, section 5.5.
    """
    start = overlapping_start(evidence, prim)
    if start is not None:
        return start
    shapes = [shape for owner in (prim, ref) for shape in shapes_of(evidence, owner)]
    sizes = [kind_of(shape).thinnest for shape in shapes if shape.kind != "plane"]
    speed = float(np.linalg.norm(evidence.body_qd[:, evidence.index(prim), :3], axis=1).max())
    now = time_step(evidence)
    if not sizes or not now or speed <= 0.0 or not math.isfinite(speed):
        return shorter_step(evidence, 0.5, "it passes what should stop it between two steps")
    share = min(0.5, 0.5 * min(sizes) / speed / now)
    return shorter_step(
        evidence, share, f"at {speed:.3g} m/s it may cross half of {min(sizes):.3g} m in a step, or it passes through"
    )


def stays_on(finding: Finding, evidence: Evidence) -> RepairTarget:
    """It slides off: on a slope friction must be more than its tangent. Or it was never on it."""
    prim, ref = finding.prim or "", ref_of(finding, evidence)
    if finding.value is None and finding.time is not None and finding.time <= float(evidence.time[0]):
        return beside(evidence, prim, ref)
    slope = _slope(finding, evidence, evidence.static(ref))
    if slope > 0.01:
        why = f"a body stays on a slope of {math.degrees(slope):.3g} degrees where friction is above its tangent"
        return friction(finding, evidence, "raise", math.tan(slope), why)
    if _slipped(finding, evidence, ref):
        return friction(finding, evidence, "raise", None, "it slides or is carried off: more friction holds it")
    why = f"it comes off {ref} and does not slide: what lifts or throws it must be slower"
    return RepairTarget(kind="settlement", prim=prim, parameter="motion", direction="change", why=why)


def _slipped(finding: Finding, evidence: Evidence, ref: str) -> bool:
    """Whether the finding's body has moved along what it is to stay on, by more than it has moved off it."""
    here = evidence.body_q[:, evidence.index(finding.prim or ""), :3]
    if evidence.static(ref) is None and evidence.container(ref) is None:
        other = evidence.body_q[:, evidence.index(ref)]
        here = rotate(conjugate(other[:, 3:]), here - other[:, :3])  # as seen from what carries it
    along = float(np.linalg.norm(level(here - here[0], evidence.up), axis=1).max())
    return along > max(abs(finding.value or 0.0), NEAR * evidence.solid(evidence.index(finding.prim or "")).smallest)


def _slope(finding: Finding, evidence: Evidence, static: Static | None) -> float:
    """Of the face of a static object that the finding's body is over [rad]; 0 of what is not static."""
    if static is None or not static.shapes:
        return 0.0
    points = evidence.body_q[:, evidence.index(finding.prim or ""), :3]
    return math.acos(min(1.0, abs(float(normal_under(static.shapes, points, evidence.up) @ evidence.up))))


def settles(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What has slid down what it started on came to rest elsewhere, if at all: time does not help; else it may."""
    return slides_off(finding, evidence) or settled(finding, evidence)


def slides_off(finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """The target of what starts on a slope, at rest, that is too steep for the friction there; None for others."""
    body = evidence.body(finding.prim or "")
    if np.linalg.norm(body.velocity) > 0.0 or not body.shapes:
        return None
    reach = NEAR * evidence.solid(evidence.index(body.prim)).smallest
    for static in evidence.world.statics:
        slope = _slope(finding, evidence, static)
        laws = [pair_law(evidence.world, one, other) for one in body.shapes for other in static.shapes]
        held = max((law.friction for law in laws), default=math.inf)
        if slope > 0.01 and math.tan(slope) > held and distance(evidence, body.prim, static.prim)[0] < reach:
            why = f"it slides on a slope of {math.degrees(slope):.3g} degrees, where friction is below the tangent"
            return friction(finding, evidence, "raise", math.tan(slope), why)
    return None


def friction(finding: Finding, evidence: Evidence, way: str, to: float | None, why: str) -> RepairTarget:
    """Another friction of the finding's body, with room to the value at which it just holds, or just lets go."""
    to = None if to is None else to * (1.0 + ROOM if way == "raise" else 1.0 - ROOM)
    body = evidence.body(finding.prim or "")
    shapes = {body.prim: body.shapes[:1]}
    if way == "raise":  # of two surfaces the smoother counts
        under = ref_of(finding, evidence)
        shapes[under] = [shape for shape in shapes_of(evidence, under) if shape.collides][:1]
    known = {prim: friction_of(found[0]) for prim, found in shapes.items() if found}
    prim = min(known, key=lambda each: known[each], default=body.prim)
    now = known.get(prim)
    if to is not None and now is not None and (to > now) != (way == "raise"):
        to = None  # friction is on the right side of it already: it is not what is wrong, or not alone
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="friction", direction=way, current=now, suggested=to, why=why,
    )  # fmt: skip


def stays_inside(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A fluid leaks; a body goes through a wall or over it."""
    if any(fluid.prim == finding.prim for fluid in evidence.world.fluids):
        return leak(finding, evidence)
    prim, ref = finding.prim or "", ref_of(finding, evidence)
    container = evidence.container(ref)
    if container is None:
        return RepairTarget(kind="missing object", prim=ref, direction="add", why="there is nothing to stay inside of")
    frame = evidence.recording.frame_index(finding.time or 0.0)
    p = evidence.local(container, evidence.body_q[frame, evidence.index(prim), :3])
    if not _started_in(evidence, prim, container):
        return beside(evidence, prim, ref)
    if p[2] > container.inner_size[2] / 2:
        return _too_small(evidence, ref, abs(finding.value or 0.0))
    return fallen_through(finding, evidence, prim, ref)


def topples(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A push must bring the energy that lifts the centre over the edge."""
    i = evidence.index(finding.prim or "")
    body = evidence.world.bodies[i]
    low, high = evidence.ends(i)
    height = float(high[0] - low[0])
    lift = 0.5 * (math.hypot(height, evidence.solid(i).smallest) - height)
    work = body.mass * evidence.gravity * lift
    why = f"to tip it over its edge takes {work:.3g} J: a faster or heavier push, or a hit higher up"
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="velocity", direction="raise", unit="m/s", why=why
    )


def swings(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Let go too low, too short a run for a period, a period that the hinge spoils, or energy from the step."""
    if finding.unit == "deg" and finding.expected is None:
        return RepairTarget(
            kind="settlement", prim=finding.prim, parameter="rotation", direction="raise", current=finding.value,
            suggested=finding.limit, unit="deg", why="at rest below its hinge it has nowhere to swing from",
        )  # fmt: skip
    if finding.unit == "deg":
        return shorter_step(
            evidence, 0.5, "it rises above its start: the integration adds energy; half the step is the first to try"
        )
    if finding.value is None and finding.expected is not None and finding.expected > evidence.world.duration:
        return longer_run(evidence, 2 * finding.expected, "a period takes longer than the run")
    why = "its hinge holds it back or drives it: a pendulum's period needs one with no friction, damping or drive"
    return RepairTarget(kind="joint", prim=finding.prim, parameter="damping", direction="lower", why=why)


def tilts(finding: Finding, evidence: Evidence) -> RepairTarget:
    """The lever needs more weight on that side."""
    ref = ref_of(finding, evidence)
    why = "the side goes down whose weight times arm is greater"
    return RepairTarget(
        kind="physical parameter", prim=ref, parameter="density", direction="raise", current=density(evidence, ref),
        unit="kg/m^3", why=why,
    )  # fmt: skip


def moves(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Under friction a way goes as the square of the speed it starts with."""
    body = evidence.body(finding.prim or "")
    speed = float(np.linalg.norm(body.velocity))
    value, limit = finding.value or 0.0, finding.limit or 0.0
    share = (1.0 + ROOM) * limit / value if 0.0 < value < limit else None
    driven = by_drive(evidence, body.prim, share, "its drive gets where it is set to, which is not far enough")
    if driven is not None and not speed:
        return driven
    if any(joint.child == body.prim or joint.parent == body.prim for joint in evidence.world.joints) and not speed:
        why = "a joint holds it, and nothing drives that"
        return RepairTarget(kind="drive", prim=body.prim, parameter="drive", direction="add", why=why)
    going = _gets_there(finding, evidence)
    if going is not None:
        return longer_run(evidence, going, "it is on its way, and fast enough to get there")
    if speed > 0.0:
        to = (1.0 + ROOM / 2) * speed * math.sqrt(limit / value) if 0.0 < value < limit else None
        return RepairTarget(
            kind="physical parameter", prim=body.prim, parameter="velocity", direction="raise", current=speed,
            suggested=to, unit="m/s", why="under friction it gets as far as v^2 / (2 mu g)",
        )  # fmt: skip
    return friction(
        finding, evidence, "lower", _to_get_there(finding, evidence), "it starts at rest: less friction lets it go"
    )


def _gets_there(finding: Finding, evidence: Evidence) -> float | None:
    """When what still moves at the end has gone as far as asked [s], slowed as it is; None if it stops before."""
    missing = (finding.limit or 0.0) - (finding.value or 0.0)
    i, late = evidence.index(finding.prim or ""), evidence.window
    speed = np.linalg.norm(level(evidence.body_qd[late, i, :3].astype(np.float64), evidence.up), axis=1)
    time = evidence.time[late]
    if missing <= 0.0 or len(time) < 2 or speed[-1] <= 0.0:
        return None
    slowed = max(0.0, float((speed[0] - speed[-1]) / (time[-1] - time[0])))
    v, wanted = float(speed[-1]), (1.0 + ROOM) * missing
    if v**2 <= 2.0 * slowed * wanted:
        return None
    left = wanted / v if slowed == 0.0 else (v - math.sqrt(v**2 - 2.0 * slowed * wanted)) / slowed
    end = float(evidence.time[-1])
    return end + left if end + left <= FARTHEST["duration"] * end else None  # what creeps gets nowhere


def _to_get_there(finding: Finding, evidence: Evidence) -> float | None:
    """The friction with which it slides as far as asked, from rest: tan - 2 s / (g cos t^2); None of what is level."""
    tangent = _tangent(finding, evidence)
    if tangent is None:
        return None
    t = float(evidence.time[-1] - evidence.time[0])
    cosine = 1.0 / math.hypot(1.0, tangent)
    most = tangent - 2.0 * (finding.limit or 0.0) / (evidence.gravity * cosine * t**2)
    return max(0.0, most)


def _tangent(finding: Finding, evidence: Evidence) -> float | None:
    """The tangent of the slope that a finding's objective names; None where it names none."""
    slope = _slope(finding, evidence, evidence.static(ref_of(finding, evidence)))
    return math.tan(slope) if slope > 0.01 else None


def slides(finding: Finding, evidence: Evidence) -> RepairTarget:
    """It gets not far enough, or rolls where it is to slide."""
    if finding.unit == "m":
        return moves(finding, evidence)
    return friction(finding, evidence, "lower", None, "friction turns it: with less it slides")


def rolls_down(finding: Finding, evidence: Evidence) -> RepairTarget:
    """A ball rolls without slipping where friction is above 2/7 of the slope's tangent."""
    if finding.unit == "m":
        return moves(finding, evidence)
    tangent = _tangent(finding, evidence)
    slipping = finding.unit == "1" or (finding.value or 0.0) > (finding.expected or 0.0)
    if not slipping:
        return friction(finding, evidence, "lower", None, "something holds a ball back that should roll freely")
    to = 2.0 / 7.0 * tangent if tangent is not None else None
    return friction(
        finding, evidence, "raise", to, "a ball rolls without slipping where friction is above 2/7 tan(slope)"
    )


def flies(finding: Finding, evidence: Evidence) -> RepairTarget:
    """It lands too soon, or something beside gravity acts on it."""
    prim, value, limit = finding.prim or "", finding.value or 0.0, finding.limit or 0.0
    if finding.unit == "s":
        rise = 0.5 * evidence.gravity * limit * (1.0 + ROOM)
        why = f"a flight of {limit:g} s takes {rise:.3g} m/s upwards, or as much height"
        return RepairTarget(
            kind="physical parameter", prim=prim, parameter="velocity.z", direction="raise",
            current=float(np.array(evidence.body(prim).velocity) @ evidence.up), suggested=rise, unit="m/s", why=why,
        )  # fmt: skip
    step, last = time_step(evidence), float(evidence.time[-1])
    if step is not None and 0.0 < limit < value <= evidence.gravity * step * last:
        return shorter_step(evidence, limit / value, "the integration's error, g dt t / 2, is as large as this")
    why = "something beside gravity acts on it: a drive, damping, a joint or a control"
    return RepairTarget(kind="physical parameter", prim=prim, parameter="forces", direction="remove", why=why)


def collides_with(finding: Finding, evidence: Evidence) -> RepairTarget:
    """They miss each other, or pass through each other."""
    prim, ref = finding.prim or "", ref_of(finding, evidence)
    missing = next((owner for owner in (prim, ref) if not collides(evidence, owner)), None)
    if missing is not None:
        return add_collision(missing)
    if finding.unit == "m/s":
        return tunnelled(finding, evidence, prim, ref)
    why = f"it passes {finding.value or 0.0:.3g} m beside {ref}: aim it there"
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="velocity", direction="change", unit="m/s", why=why
    )


def fills(finding: Finding, evidence: Evidence) -> RepairTarget:
    """More than the container holds, or still on its way."""
    fluid, container = evidence.fluid(finding.prim or ""), evidence.container(ref_of(finding, evidence))
    if container is None:
        return RepairTarget(kind="missing object", direction="add", why="there is nothing to fill")
    room, volume = math.prod(container.inner_size), math.prod(fluid.size)
    if volume > room:
        top = volume / math.prod(container.inner_size[:2])
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="inner_size.z", direction="raise",
            current=container.inner_size[2], suggested=top, unit="m", why="there is more fluid than it holds",
        )  # fmt: skip
    return longer_run(evidence, None, "it holds that much: the rest is still on its way, or is poured beside it")


OBJECTIVES: dict[str, Rule] = {
    "ObjectiveFloats": floats,
    "ObjectiveSubmerged": submerged,
    "ObjectiveRestsOn": rests_on,
    "ObjectiveStaysOn": stays_on,
    "ObjectiveStaysInside": stays_inside,
    "ObjectiveTopples": topples,
    "ObjectiveSettles": settles,
    "ObjectiveSwings": swings,
    "ObjectiveTilts": tilts,
    "ObjectiveMoves": moves,
    "ObjectiveSlides": slides,
    "ObjectiveRollsDown": rolls_down,
    "ObjectiveFlies": flies,
    "ObjectiveCollidesWith": collides_with,
    "ObjectiveFills": fills,
}
