"""What a plan will take, roughly: particles, steps, seconds of one CPU core. For a person who decides, not for a check.

Where the figures come from:

- particles: a fluid's volume over its spacing cubed; two layers of wall behind each wetted face (the kernel's support,
  2.6 spacings, less half a spacing, rounded), up to the container's rim; bodies filled at the same spacing. The demo
  has 6,800 + 6,275 (README, "Measured"), by this count 6,800 + 6,200.
- time step: 0.8 of a smoothing length (1.3 spacings) over the numerical speed of sound, ten times the speed of a
  shallow-water wave or of what falls in (docs/sph.md); never above 1/800 s.
- speed: 1.3 M particle-steps/s on a CPU core (docs/sph.md, "Speed": 1.24 to 1.28 M in a block of fluid, 1.75 M on two
  cores in the demo); 0.4 ms a step for a handful of bodies without fluid, 3.1 ms for a vehicle among rocks on terrain,
  3.7 ms for a robot dog that walks by its policy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from wsim.defaults import GRAVITY
from wsim.plan.drawing.silhouettes import scene_of
from wsim.plan.layout.openings import mouth_of
from wsim.plan.schema import Plan
from wsim.plan.spacing import spacing_of

PARTICLE_STEPS = 1.3e6  # of one CPU core [1/s]
BODY_STEP = 0.4e-3  # wall time of a step of five bodies [s]
LARGEST_STEP = 1.0 / 800.0  # [s]
VEHICLE_STEP = 3.1e-3  # wall time of a step of a vehicle on terrain [s]
ROBOT_STEP = 3.7e-3  # and of a robot of twelve joints and its policy [s]
STEERED_STEP = 0.625e-3  # that the steering of a vehicle leaves [s]
LAYERS = 2  # of wall particles
COURANT = 0.8
SMOOTHING = 1.3  # smoothing length over spacing
SOUND_OVER_SPEED = 10.0


@dataclass(frozen=True)
class Cost:
    """About what a plan takes.

    Attributes:
        fluid: Particles of fluid.
        others: Particles of walls and bodies.
        simulated: [s].
        steps: Time steps.
        wall: Seconds of one CPU core, without compilation, pictures and judging.
    """

    fluid: int
    others: int
    simulated: float
    steps: int
    wall: float

    def sentence(self) -> str:
        """The cost as a person says it."""
        particles = f"about {_round(self.fluid)} particles of fluid and {_round(self.others)} of walls and bodies, "
        return (
            f"{particles if self.fluid else 'no fluid, '}{self.simulated:g} s of simulation in about "
            f"{_round(self.steps)} steps: about {_seconds(self.wall)} on one CPU core, pictures not counted"
        )


def cost_of(plan: Plan) -> Cost:
    """Particles, steps and time of a laid-out plan."""
    boxes = _boxes(plan)
    fluids = [item for item in plan.objects if item.primitive == "fluid" and item.name in boxes]
    wet = [(boxes[item.name], spacing_of(plan, item, boxes[item.name])) for item in fluids]
    spacing = min((apart for _, apart in wet), default=0.0)  # of walls and bodies, and what the step must resolve
    driven = any(item.primitive == "vehicle" for item in plan.objects)
    step = min(plan.simulation.time_step or LARGEST_STEP, STEERED_STEP if driven else LARGEST_STEP)
    if wet:
        speed = max(math.sqrt(GRAVITY * max(max(box[2] for box, _ in wet), spacing)), _fall(plan), _jet(plan))
        step = min(step, COURANT * SMOOTHING * spacing / (SOUND_OVER_SPEED * speed))
    frames = max(1, round(plan.simulation.duration * plan.simulation.frame_rate))
    steps = frames * max(1, math.ceil(1.0 / plan.simulation.frame_rate / step - 1e-9))
    comes = sum(each.poured(plan.simulation.duration) for each in plan.openings)
    fluid = round(sum(math.prod(box) / apart**3 for box, apart in wet) + (comes / spacing**3 if wet else 0.0))
    others = round(_others(plan, boxes, spacing)) if wet else 0
    vehicles = sum(item.primitive == "vehicle" for item in plan.objects)
    robots = sum(item.primitive == "robot" for item in plan.objects)
    bodies = sum(item.state == "dynamic" for item in plan.objects) - vehicles - robots
    rigid = BODY_STEP * max(1.0, bodies / 5) + VEHICLE_STEP * vehicles + ROBOT_STEP * robots
    wall = steps * ((fluid + others) / PARTICLE_STEPS + rigid)
    return Cost(fluid, others, plan.simulation.duration, steps, wall)


def _boxes(plan: Plan) -> dict[str, tuple[float, float, float]]:
    """Edge lengths of the upright box that each thing fills [m]."""
    scene = scene_of(plan)
    heights = {one.name: one.high[1] - one.low[1] for one in scene.views["side"]}
    return {
        one.name: (one.high[0] - one.low[0], one.high[1] - one.low[1], heights[one.name])
        for one in scene.views["above"]
    }


def _others(plan: Plan, boxes: dict[str, tuple[float, float, float]], spacing: float) -> float:
    count = 0.0
    for item in plan.objects:
        if item.primitive == "tank":
            x, y, z = (edge / spacing for edge in item.size)
            count += (x + 2 * LAYERS) * (y + 2 * LAYERS) * (z + LAYERS) - x * y * z
        elif item.role != "fluid" and item.state != "static" and item.name in boxes:
            filled = 0.5 * math.prod(boxes[item.name]) if item.volume is None else item.volume  # an asset: half its box
            count += filled / spacing**3
    return count


def _fall(plan: Plan) -> float:
    """Speed of what falls farthest before it meets the fluid [m/s]."""
    drops = [row.value or 0.0 for item in plan.objects for row in item.relations if row.predicate == "SPAWNED-ABOVE"]
    return math.sqrt(2 * GRAVITY * max(drops, default=0.0))


def _jet(plan: Plan) -> float:
    """Speed of what comes out of a tap, or falls as rain, where it meets the floor [m/s]."""
    taps = [each for each in plan.openings if each.kind == "tap"]
    speeds = [(each.drop_speed or (each.rate or 0.0) / each.area, mouth_of(plan, each)[2]) for each in taps]
    return max((math.sqrt(speed**2 + 2 * GRAVITY * max(high, 0.0)) for speed, high in speeds), default=0.0)


def _round(count: float) -> str:
    """Two digits, with commas."""
    if count < 100:
        return f"{round(count)}"
    digits = 10 ** (int(math.log10(count)) - 1)
    return f"{round(count / digits) * digits:,}"


def _seconds(seconds: float) -> str:
    if seconds < 90:
        return f"{max(1, round(seconds, -1 if seconds >= 20 else 0)):.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.0f} h" if seconds < 48 * 3600 else f"{seconds / 86400:.0f} days"
