"""Sound worlds that the builtin planner plans and writes."""

from __future__ import annotations

from benchmarks.judge_worlds.asked import fall_in_order, lands_in_time, slides_so_far, stays_upright
from benchmarks.judge_worlds.world import FINE_STEP, SoundWorld, prompted
from wsim.plan.schema import Plan


def coarse(plan: Plan) -> Plan:
    """The plan with its fluid a third coarser: a run of seconds, with some four particles across the bodies."""
    spacing = round(plan.simulation.spacing * 4 / 3, 4)
    return plan.model_copy(update={"simulation": plan.simulation.model_copy(update={"spacing": spacing})})


def fine(plan: Plan) -> Plan:
    """The plan with a time step that is short enough for hard hits."""
    return plan.model_copy(update={"simulation": plan.simulation.model_copy(update={"time_step": FINE_STEP})})


PROMPTED: tuple[SoundWorld, ...] = (
    prompted(
        "rigid bodies",
        "drop",
        "A 20 cm oak cube is dropped from 0.5 m above the ground",
        "A 15 cm steel cube is dropped from 0.3 m above the ground",
        "A 25 cm pine cube is dropped from 1 m above the ground",
        "A 20 cm ice cube is dropped from 0.2 m above the ground",
        change=lands_in_time,
    ),
    prompted(
        "rigid bodies",
        "ball on table",
        "A copper ball falls from 1 m onto a table",
        "A steel ball falls from 0.5 m onto a table",
        "A rubber ball falls from 0.3 m onto a table",
        "A brass ball falls from 0.4 m onto a table",
    ),
    prompted(
        "rigid bodies",
        "slide",
        "A box slides along the floor at 3 m/s",
        "A box slides along the floor at 2 m/s",
        "A steel box slides along the floor at 4 m/s",
        "A 20 cm ice cube slides along the floor at 2 m/s",
        change=slides_so_far,
    ),
    prompted(
        "rigid bodies",
        "push",
        "A box is pushed to the left at 2 m/s",
        "A crate is pushed to the right at 3 m/s",
        "A steel cube is pushed to the left at 2.5 m/s",
        "A steel box is pushed to the right at 2 m/s",
        change=slides_so_far,
    ),
    prompted(
        "rigid bodies",
        "ramp slide",
        "A 2 kg oak cube slides down a 35 degree ramp",
        "A 3 kg steel cube slides down a 40 degree ramp",
        "An ice block slides down an aluminium ramp",
        "An ice block slides down a 30 degree ramp",
    ),
    prompted(
        "rigid bodies",
        "ramp rest",
        "A block rests on a ramp",
        "An iron block rests on a ramp",
        "A block rests on a 10 degree ramp",
        "A steel block rests on a 5 degree ramp",
    ),
    prompted(
        "rigid bodies",
        "ramp roll",
        "A steel ball rolls down a wooden ramp",
        "A ball rolls down a 15 degree ramp",
        "A rubber ball rolls down a 20 degree ramp",
        "A brass ball rolls down a 10 degree ramp",
    ),
    prompted(
        "rigid bodies",
        "throw",
        "A ball is thrown at 5 m/s at an angle of 30 degrees",
        "A ball is thrown at 4 m/s at an angle of 45 degrees",
        "A red ball flies to the left at 6 m/s for 2 seconds",
        "A steel ball is thrown at 6 m/s at an angle of 60 degrees",
    ),
    prompted(
        "rigid bodies",
        "off the table",
        "A ball rolls off a table",
        "A wooden box is pushed off a table",
        "A steel ball rolls off a table",
        "A cube is pushed off a table",
    ),
    prompted(
        "stacks",
        "tower",
        "A tower of three boxes stands on the ground",
        "A pile of four 20 cm oak cubes on a platform",
        "Two boxes are stacked on the ground",
        "A tower of 3 blocks stands on a table",
        change=stays_upright,
    ),
    prompted(
        "stacks",
        "rest",
        "A box weighing 2 kg rests on the floor",
        "A cylinder with a radius of 5 cm stands on the ground",
        "A 0.5 m long plank lies on the ground",
        "A box made of steel on a bench",
        change=stays_upright,
    ),
    prompted(
        "stacks",
        "desk",
        "A laptop on a desk and a mug to the left of the laptop",
        "A mug stands on a table",
        "A lamp stands on a desk",
        "A ball and a cube are on a table",
        change=stays_upright,
    ),
    prompted(
        "pendulums",
        "pendulum",
        "A pendulum swings",
        "A 0.5 m pendulum swings from 30 degrees",
        "A steel ball swings on a 0.8 m rod",
        "A brass ball hangs on a 1 m long rod and swings from 10 degrees",
    ),
    prompted(
        "joints and drives",
        "seesaw",
        "A box falls onto a seesaw",
        "A steel cube falls onto a seesaw",
        "A ball falls onto a seesaw",
        "A box stands on a seesaw",
        change=fine,
    ),
    prompted(
        "collisions",
        "two balls",
        "Two steel balls collide",
        "A red ball and a blue ball hit each other",
        "A red ball collides with a blue ball at 2 m/s",
        "Two rubber balls collide",
    ),
    prompted(
        "collisions",
        "wall",
        "A red ball hits a wall",
        "A steel ball hits a wall at 3 m/s",
        "A rubber ball hits a wall",
        "A blue ball hits a wall at 2 m/s",
    ),
    prompted(
        "collisions",
        "knock over",
        "A steel ball rolls into a stack of four wooden blocks and knocks it over.",
        "A steel ball rolls into a stack of three wooden blocks and knocks it over.",
        "A ball is thrown at a stack of three boxes",
        "A crate is pushed into a barrel",
    ),
    prompted(
        "collisions",
        "dominoes",
        "A steel ball knocks over a row of five dominoes",
        "A steel ball knocks over a row of three dominoes",
        "A steel ball knocks over a row of seven dominoes",
        "A row of four dominoes topples",  # a ball that meets them low carries four of them along, leaning back over it
        change=fall_in_order,
    ),
    prompted(
        "containers",
        "bucket",
        "A ball falls into a bucket",
        "A ball in a bowl",
        "A steel ball falls into a bucket",
        "A cork ball falls into a bowl",
    ),
    prompted(
        "tanks and floating bodies",
        "floating block",
        "A wooden block floats in a tank of water",
        "A pine block floats in a tank of water",
        "An oak block floats in a tank of water",
        change=coarse,
    ),
    prompted(
        "tanks and floating bodies",
        "floating ball",
        "A cork ball floats in a tank of water",
        "A wooden ball floats in a tank of water",
        change=coarse,
    ),
    prompted(
        "tanks and floating bodies",
        "sinking",
        "A steel ball sinks in a tank of water",
        "A small iron cube sinks in a tank of water",
        "A marble ball drops into a tank of water and sinks",
        change=coarse,
    ),
    prompted(
        "tanks and floating bodies",
        "submerged",
        "A concrete cylinder is submerged in the water",
        "A steel ball is submerged in the water",
        change=coarse,
    ),
    prompted(
        "tanks and floating bodies",
        "pour",
        "Water pours into a bowl",
        "Water is poured from 10 cm into a tank",
    ),
)
