"""Prompts with plans that ask for what they say, and with plans that ask for less, or for what no run can show.

A case is a prompt, its objectives as "kind object ref" or as sentences, and its clauses: words, and what shows them.
Things are those of `STOCK` that it names.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from wsim.agents.planner import read_plan
from wsim.agents.shorthand import written_out
from wsim.plan.schema import Plan

WOOD = {"name": "wood", "density": 600}
FIXED = {"role": "background", "state": "static"}


def _thing(primitive: str, size: list[float], position: list[float], **more: Any) -> dict[str, Any]:
    return {"role": "rigid_body", "primitive": primitive, "size": size, "state": "dynamic", "material": WOOD,
            "position": position, **more}  # fmt: skip


def _box(position: list[float], size: tuple[float, ...] = (0.2, 0.2, 0.2), **more: Any) -> dict[str, Any]:
    return _thing("box", list(size), position, **more)


def _ball(position: list[float], **more: Any) -> dict[str, Any]:
    return _thing("sphere", [0.1], position, **more)


STOCK: dict[str, dict[str, Any]] = {
    "ground": {"role": "terrain", "primitive": "ground", "state": "static", "material": WOOD},
    "ball": _ball([0, 0, 1.1], velocity=[3, 0, 0]),
    "ball_one": _ball([0, 4, 0.11], velocity=[2, 0, 0]),
    "ball_two": _ball([1, 4, 0.11]),
    **{f"ball_{k}": _ball([k, -6, 1.1]) for k in (1, 2, 3)},
    "red_ball": _ball([0, 6, 0.11], velocity=[2, 0, 0]),
    "blue_ball": _ball([1, 6, 0.11]),
    "box": _box([1.5, 0, 0.101]),
    "crate": _box([1.5, 1, 0.101], registration={"mass": 4.0}),
    "skittle": _thing("cylinder", [0.05, 0.4], [2.5, 0, 0.202]),
    "cart": _box([-2, 0, 0.101], velocity=[1, 0, 0]),
    "wall": _box([4, 0, 0.5], (0.1, 6, 1), **FIXED),
    "table": _box([0, -3, 0.4], (1, 1, 0.8), **FIXED),
    "ramp": _box([6, 6, 0.5], (2, 1, 0.1), rotation_deg=[0, 20, 0], **FIXED),
    "tower": _box([0, 2, 0.501], (0.2, 0.2, 1)),
    "cup": _thing("tank", [0.2, 0.2, 0.2], [0, -3, 0.802], role="container", state="static"),
    "pearl": _thing("sphere", [0.03], [0, -3, 0.86]),
    "tank": _thing("tank", [1, 1, 1], [8, 0, 0.02], role="container", state="static"),
    "water": {"role": "fluid", "primitive": "fluid", "state": "fluid", "registration": {"spacing": 0.1},
              "material": {"name": "water", "density": 1000},
              "relations": [{"predicate": "PLACE-IN", "ref": "tank"}, {"predicate": "FREE-SURFACE-AT", "value": 0.6}]},
    "cork": _box([8, 0, 0.9], (0.3, 0.3, 0.2)),
    "gate": _box([3, 3, 0.5], (0.1, 1, 1), role="rigid_body", state="kinematic"),
    "post": _box([-4, 0, 0.5], (0.1, 0.1, 1), **FIXED),
    "door": _box([-3.5, 0, 0.55], (0.8, 0.05, 0.9)),
}  # fmt: skip
HINGE = {"name": "hinge", "kind": "hinge", "child": "door", "parent": "post", "anchor": [-0.45, 0, 0], "axis": "Z",
         "limits": [0, 90]}  # fmt: skip
LIFT = {"name": "lift", "of": "gate", "quantity": "velocity", "times": [2, 3], "values": [[0, 0, 1], [0, 0, 0]]}


@dataclass(frozen=True)
class Case:
    """A prompt and a plan for it."""

    prompt: str
    objectives: tuple[str, ...]
    clauses: dict[str, list[int | str]]
    more: dict[str, Any] = field(default_factory=dict)
    duration: float = 5.0

    def plan(self) -> Plan:
        """Validated, laid out, and held against what can come true.

        Raises:
            UserError: It cannot.
        """
        return read_plan(self._answer(), self.prompt)

    def unchecked(self) -> Plan:
        """As it stands, whether it can come true or not."""
        return Plan.model_validate(written_out({"title": "a case", **self._answer()}) | {"prompt": self.prompt})

    def _answer(self) -> dict[str, Any]:
        told = " ".join((*self.objectives, *(str(by) for by in self.clauses.values()), str(self.more)))
        names = [name for name in STOCK if name == "ground" or re.search(rf"\b{name}\b", told)]
        if "water" in names and "tank" not in names:
            names.append("tank")
        if {"door", "hinge"} & set(names):
            names += [name for name in ("post", "door") if name not in names]
        return {
            "objects": [{"name": name, **STOCK[name]} for name in names],
            "objectives": [_objective(text, names) for text in self.objectives],
            "clauses": [{"words": words, "by": by} for words, by in self.clauses.items()],
            "joints": [HINGE] if "door" in names else [],
            "schedules": [LIFT] if "gate" in names else [],
            "simulation": {"duration": self.duration},
            **self.more,
        }


def _objective(text: str, names: list[str]) -> dict[str, Any]:
    words = re.findall(r"\w+", text)
    if "(" in text:
        return {"kind": "formula", "object": next(word for word in words if word in names), "sentence": text}
    return dict(zip(("kind", "object", "ref"), words, strict=False))


HITS = ("collides_with ball box",)
FALLS_FIRST = "not (touches(ball, ground) then never_touches(ball, ground) then touches(ball, ground))"
TWO = "touches(ball, ground) then never_touches(ball, ground) then touches(ball, ground)"
THREE = f"{TWO} then never_touches(ball, ground) then touches(ball, ground)"

SOUND = [
    # who does it to whom
    Case("The ball hits the box.", HITS, {"The ball hits the box": [0]}),
    Case("The box is hit by the ball.", HITS, {"The box is hit by the ball": [0]}),
    Case("A ball flies into a box and hits it.", HITS, {"A ball flies into a box": [0], "hits it": [0]}),
    Case("Roll the ball so that it strikes the box.", HITS, {"Roll the ball": ["ball.velocity"],
                                                              "it strikes the box": [0]}),
    Case("A ball crashes against a wooden box.", HITS, {"A ball crashes against a wooden box": [0]}),
    Case("Thrown at 3 m/s, a ball collides with a box.", HITS, {"Thrown at 3 m/s": ["ball.velocity"],
                                                                "a ball collides with a box": [0]}),
    Case("A sphere hits a block.", HITS, {"A sphere hits a block": [0]}),
    Case("The ball hits the box, which topples.", (*HITS, "topples box"), {"The ball hits the box": [0],
                                                                           "which topples": [1]}),
    Case("The ball hits the box and the box knocks the skittle over.", (*HITS, "topples skittle"),
         {"The ball hits the box": [0], "the box knocks the skittle over": [1]}),
    Case("The ball flies past the box and strikes the skittle.", ("collides_with ball skittle",
         "crosses(ball, x, 2 m)"), {"The ball flies past the box": [1], "strikes the skittle": [0]}),
    Case("A ball falls off the table and hits the floor.", ("collides_with ball ground",),
         {"A ball falls off the table": [0, "table"], "hits the floor": [0]}),
    Case("The red ball hits the blue ball.", ("collides_with red_ball blue_ball",),
         {"The red ball hits the blue ball": [0]}),
    Case("A red ball and a blue ball collide.", ("collides_with red_ball blue_ball",),
         {"A red ball and a blue ball collide": [0]}),
    Case("The cart pushes the box along.", ("pushes(cart, box)",), {"The cart pushes the box along": [0]}),
    Case("A box is pushed by a cart.", ("pushes(cart, box)",), {"A box is pushed by a cart": [0]}),
    Case("The ball bounces off the wall.", ("collides_with ball wall",), {"The ball bounces off the wall": [0]}),
    Case("The ball hits the box beside the crate.", HITS, {"The ball hits the box beside the crate": [0, "crate"]}),
    Case("The ball on the table hits the box.", HITS, {"The ball on the table hits the box": [0, "table"]}),
    Case("After it has hit the box, the ball comes to rest.", (*HITS, "settles ball"),
         {"it has hit the box": [0], "the ball comes to rest": [1]}),
    Case("The ball lands on the ground.", ("rests_on ball ground",), {"The ball lands on the ground": [0]}),
    Case("The ball and the cart hit the box.", (*HITS, "collides_with cart box"),
         {"The ball and the cart hit the box": [0, 1]}),
    Case("The ball hits the box before the cart touches the crate.",
         ("collides_with(ball, box) then touches(cart, crate)",),
         {"The ball hits the box": [0], "the cart touches the crate": [0]}),
    # by when
    Case("The ball hits the ground within a second.", ("eventually[0, 1] (collides_with(ball, ground))",),
         {"The ball hits the ground within a second": [0]}),
    Case("Within 2 seconds the ball hits the box.", ("eventually[0, 2] (collides_with(ball, box))",),
         {"Within 2 seconds the ball hits the box": [0]}),
    Case("In less than two seconds the box topples.", ("eventually[0, 2] (not upright(box, 45 deg))",),
         {"In less than two seconds the box topples": [0]}),
    Case("The cork comes to rest within 4 s.", ("always[4, 5] (settles(cork))", "floats cork water"),
         {"The cork comes to rest within 4 s": [0]}),
    Case("The ball strikes the box no later than half a second after the start.",
         ("eventually[0, 0.5] (collides_with(ball, box))",),
         {"The ball strikes the box no later than half a second after the start": [0]}),
    Case("After one second the gate rises.", ("eventually[1, 4] (gone_between(gate, z, 0.5 m, 2 m))",),
         {"After one second": [0], "the gate rises": [0]}),
    Case("The ball reaches the wall in under a second and a half.", ("eventually[0, 1.5] (touches(ball, wall))",),
         {"The ball reaches the wall in under a second and a half": [0]}),
    Case("For 2 s the tower stands, then it falls.", ("always[0, 2] (upright(tower, 10 deg))", "topples tower"),
         {"For 2 s the tower stands": [0], "it falls": [1]}),
    Case("The ball flies for a second.", ("always[0, 1] (never_touches(ball, ground))",),
         {"The ball flies for a second": [0]}),
    # what does not happen
    Case("The tower does not fall.", ("always (upright(tower, 10 deg))",), {"The tower does not fall": [0]}),
    Case("The ball never touches the wall.", ("always (never_touches(ball, wall))",),
         {"The ball never touches the wall": [0]}),
    Case("The ball hits the box without touching the skittle.", (*HITS, "always (never_touches(ball, skittle))"),
         {"The ball hits the box": [0], "without touching the skittle": [1]}),
    Case("The box doesn't move.", ("always (stays_within(box, (1.5, 0, 0.1), 5 cm))",), {"The box doesn't move": [0]}),
    Case("The tower does not topple when the ball hits it.", ("not (eventually (not upright(tower, 45 deg)))",
         "collides_with ball tower"),
         {"The tower does not topple": [0], "the ball hits it": [1]}),
    Case("No water spills.", ("stays_inside water tank",), {"No water spills": [0]}),
    Case("The pearl stays in the cup and does not roll off.", ("stays_inside pearl cup",),
         {"The pearl stays in the cup": [0], "does not roll off": [0]}),
    Case("The cork doesn't sink.", ("floats cork water",), {"The cork doesn't sink": [0]}),
    Case("The cart stops before it hits the wall.", ("stops_before(cart, wall)",),
         {"The cart stops": [0], "before it hits the wall": [0]}),
    Case("The ball can't hit the crate.", ("always (never_touches(ball, crate))",),
         {"The ball can't hit the crate": [0]}),
    # how often
    Case("The ball hits the ground exactly once.", ("collides_with ball ground", FALLS_FIRST),
         {"The ball hits the ground": [0, 1], "exactly once": [1]}),
    Case("The ball touches the ground twice.", (TWO,), {"The ball touches the ground twice": [0]}),
    Case("The ball bounces three times.", (THREE,), {"The ball bounces three times": [0]}),
    Case("The ball falls and climbs up again.", ("falls_freely(ball)", "climbs_to(ball, 0.5)"),
         {"The ball falls": [0], "climbs up again": [1]}),
    Case("The ball hits the ground, leaves it and hits it again.", (TWO,),
         {"The ball hits the ground": [0], "leaves it": [0], "hits it again": [0]}),
    Case("Only once does the ball touch the ground.", (f"touches(ball, ground) and {FALLS_FIRST}",),
         {"Only once does the ball touch the ground": [0]}),
    # names with numbers
    Case("Ball one hits ball two.", ("collides_with ball_one ball_two",), {"Ball one hits": [0]}),
    Case("The first of two balls, ball one, rolls into ball two.", ("collides_with ball_one ball_two",),
         {"two balls": ["ball_one", "ball_two"], "rolls into": [0]}),
    Case("Box 1 is hit by the ball.", ("collides_with ball box",), {"is hit by the ball": [0]}),
    Case("Cart number two crashes into the wall.", ("collides_with cart wall",), {"crashes into the wall": [0]}),
    Case("A type 3 crate stands still while a model 500 cart drives past.", ("settles crate",
         "crosses(cart, x, 1 m)"), {"crate stands still": [0], "cart drives past": [1]}),
    Case("Ball two waits; ball one rolls at 2 m/s and strikes it.", ("collides_with ball_one ball_two",),
         {"waits": ["ball_two"], "rolls at 2 m/s": ["ball_one.velocity"], "strikes it": [0]}),
    # what can come true
    Case("The door opens by 60 degrees.", ("eventually (turned_between(door, z, 55 deg, 65 deg))",),
         {"opens by 60 degrees": [0]}),
    Case("After 2 s the gate lifts by a metre.", ("eventually[2, 4] (gone_between(gate, z, 0.9 m, 1.1 m))",),
         {"After 2 s the gate lifts by a metre": [0]}),
    Case("The gate waits, and lifts then.", ("always[0, 1.9] (gone_between(gate, z, -1 cm, 1 cm))",
         "crosses(gate, z, 1 m)"), {"The gate waits": [0], "lifts": [1]}),
    Case("The wall stays where it is, and the ball hits it.", ("always (gone_between(wall, x, -1 cm, 1 cm))",
         "collides_with ball wall"), {"The wall stays": [0], "the ball hits it": [1]}),
    Case("The cart crosses the line 1 m ahead.", ("crosses(cart, x, -1 m)",), {"The cart crosses the line 1 m": [0]}),
    Case("The cork floats in the water.", ("floats cork water",), {"The cork floats in the water": [0]}),
    Case("A box of 0.2 x 0.2 x 0.2 m and a crate of 4 kg stand on the ground; a ball hits the crate.",
         ("rests_on box ground", "rests_on crate ground", "collides_with ball crate"),
         {"A box of 0.2 x 0.2 x 0.2 m": ["box.size"], "a crate of 4 kg": ["crate.mass"], "stand on the ground": [0, 1],
          "a ball hits the crate": [2]}),
]  # fmt: skip

# Thought of once all above was told apart: ordinals, relative clauses, pronouns, two of a name.
HARDER = [
    Case(
        "A box that is pushed by the cart hits the wall.",
        ("collides_with box wall", "pushes(cart, box)"),
        {"A box that is pushed by the cart": [1], "hits the wall": [0]},
    ),
    Case(
        "The first ball hits the second ball.",
        ("collides_with ball_one ball_two",),
        {"The first ball hits the second ball": [0, "ball"]},
    ),
    Case(
        "A ball rolls and hits another ball.",
        ("collides_with ball_one ball",),
        {"A ball rolls and hits another ball": [0]},
    ),
    Case("A ball hits a ball.", ("collides_with ball_one ball",), {"A ball hits a ball": [0]}),
    Case(
        "When the ball hits it, the box falls onto the cart.",
        ("collides_with ball box", "touches(box, cart)"),
        {"the ball hits it": [0], "the box falls onto the cart": [1]},
    ),
    Case(
        "The falling box is struck by the ball and hits the ground.",
        ("collides_with ball box", "collides_with box ground"),
        {"The falling box is struck by the ball": [0], "hits the ground": [1]},
    ),
    Case("The ball never stops.", ("moves ball",), {"The ball never stops": [0]}),
    Case(
        "The ball does not reach the wall.",
        ("always (gone_between(ball, x, 0 m, 3.5 m))",),
        {"The ball does not reach the wall": [0]},
    ),
    Case(
        "The ball does not drop below 1 m.", ("not (crosses(ball, z, 1 m))",), {"The ball does not drop below 1 m": [0]}
    ),
    Case("The tower is not hit.", ("always (never_touches(ball, tower))",), {"The tower is not hit": [0]}),
    Case(
        "Without hitting the crate the ball flies on to the wall.",
        ("always (never_touches(ball, crate))", "collides_with ball wall"),
        {"Without hitting the crate": [0], "the ball flies on to the wall": [1]},
    ),
    Case(
        "The cart comes to rest within 2 m.",
        ("always (gone_between(cart, x, 0 m, 2 m))", "settles cart"),
        {"The cart comes to rest within 2 m": [0, 1]},
    ),
    Case(
        "The ball hits the box and then lands on the ground.",
        ("collides_with ball box", "rests_on ball ground"),
        {"The ball hits the box": [0], "lands on the ground": [1]},
    ),
    Case(
        "The ball is thrown against the box, hits it and rolls into the wall.",
        ("collides_with ball box", "touches(ball, wall)"),
        {"thrown against the box": ["ball.velocity"], "hits it": [0], "rolls into the wall": [1]},
    ),
    Case("The ball hits the top of the box.", HITS, {"The ball hits the top of the box": [0]}),
    Case(
        "The box stands beside the crate, and the ball strikes it.",
        ("collides_with ball box", "rests_on crate ground"),
        {"The box stands beside the crate": [1], "the ball strikes it": [0]},
    ),
    Case(
        "A skittle is knocked over by the ball.", ("topples skittle",), {"A skittle is knocked over by the ball": [0]}
    ),
    Case(
        "The box slides down the ramp and bumps into the wall.",
        ("goes_down(box, ramp)", "collides_with box wall"),
        {"The box slides down the ramp": [0], "bumps into the wall": [1]},
    ),
    Case(
        "The ball touches neither the box nor the crate.",
        ("always (never_touches(ball, box))", "always (never_touches(ball, crate))"),
        {"The ball touches neither the box nor the crate": [0, 1]},
    ),
    Case("The ball and the box touch.", ("touches(ball, box)",), {"The ball and the box touch": [0]}),
    Case(
        "Both balls hit the wall.",
        ("collides_with ball_one wall", "collides_with ball_two wall"),
        {"Both balls hit the wall": [0, 1]},
    ),
    Case(
        "The ball passes over the box without touching it.",
        ("crosses(ball, x, 2 m)", "always (never_touches(ball, box))"),
        {"The ball passes over the box": [0], "without touching it": [1]},
    ),
]


def _hits(prompt: str, *objectives: str) -> Case:
    """A plan whose every objective answers for all words."""
    return Case(prompt, objectives, {prompt.rstrip("."): list(range(len(objectives)))})


WEAK = [
    # another pair
    _hits("The ball hits the box.", "collides_with ball ground"),
    Case("The ball hits the box.", ("collides_with ball crate",), {"The ball hits the box": [0, "box"]}),
    Case("The box is hit by the ball.", ("collides_with box ground",), {"The box is hit by the ball": [0, "ball"]}),
    Case("A ball crashes into a box.", ("collides_with cart crate",),
         {"A ball crashes into a box": [0, "ball", "box"]}),
    Case("The ball strikes the skittle and rolls on to the box.", ("collides_with ball box",),
         {"The ball strikes the skittle": [0, "skittle"], "rolls on to the box": [0]}),
    Case("The red ball hits the blue ball.", ("collides_with red_ball ground",),
         {"The red ball hits the blue ball": [0, "blue_ball"]}),
    Case("The red ball hits the blue ball.", ("collides_with blue_ball ball",),
         {"The red ball hits the blue ball": [0, "red_ball"]}),
    Case("The ball hits the box and the box hits the crate.", ("collides_with ball box",),
         {"The ball hits the box": [0], "the box hits the crate": [0, "crate"]}),
    Case("The cart pushes the box.", ("pushes(cart, crate)",), {"The cart pushes the box": [0, "box"]}),
    Case("A box is pushed by a cart.", ("pushes(ball, cart)",), {"A box is pushed by a cart": [0, "box"]}),
    Case("The ball knocks the skittle over.", ("topples tower",), {"The ball knocks the skittle over":
                                                                   [0, "skittle", "ball"]}),
    Case("The ball lands on the table.", ("rests_on ball ground",), {"The ball lands on the table": [0, "table"]}),
    Case("The ball touches the wall.", ("touches(ball, ground)",), {"The ball touches the wall": [0, "wall"]}),
    Case("The cart rams the crate.", ("collides_with crate ground",), {"The cart rams the crate": [0, "cart"]}),
    Case("The ball hits the box, which hits the skittle.", ("collides_with ball box",),
         {"The ball hits the box": [0], "which hits the skittle": [0, "skittle"]}),
    Case("The ball bumps into the tower.", ("collides_with ball box",), {"The ball bumps into the tower":
                                                                         [0, "tower"]}),
    Case("The ball and the cart hit the box.", ("collides_with ball box",),
         {"The ball and the cart hit the box": [0, "cart"]}),
    # by when
    _hits("The ball hits the ground within a second.", "collides_with ball ground"),
    _hits("The ball hits the ground within a second.", "eventually[0, 3] (collides_with(ball, ground))"),
    _hits("Within 2 seconds the ball hits the box.", "collides_with ball box"),
    _hits("In less than two seconds the box topples.", "topples box"),
    _hits("The cork comes to rest within 4 s.", "settles cork", "floats cork water"),
    _hits("The ball strikes the box no later than half a second after the start.", "collides_with ball box"),
    _hits("The ball reaches the wall in under a second and a half.", "touches(ball, wall)"),
    _hits("The ball hits the box within 2 s.", "eventually[2, 4] (collides_with(ball, box))"),
    _hits("The ball flies for a second.", "flies(ball, 0.2 s)"),
    # what does not happen
    _hits("The tower does not fall.", "topples tower"),
    Case("The tower does not fall.", ("collides_with ball ground",), {"The tower does not fall": [0, "tower"]}),
    _hits("The ball never touches the wall.", "touches(ball, wall)"),
    Case("The ball hits the box without touching the skittle.", HITS,
         {"The ball hits the box without touching the skittle": [0, "skittle"]}),
    _hits("The box doesn't move.", "moves box"),
    _hits("The tower does not topple when the ball hits it.", "collides_with ball tower"),
    Case("No water spills.", ("settles ball",), {"No water spills": [0, "water"]}),
    _hits("The cork doesn't sink.", "submerged cork water"),
    _hits("The ball can't hit the crate.", "collides_with ball crate"),
    _hits("The cart stops and does not hit the wall.", "settles cart"),
    # how often
    _hits("The ball hits the ground exactly once.", "collides_with ball ground"),
    _hits("The ball touches the ground twice.", "touches(ball, ground)"),
    _hits("The ball bounces three times.", "collides_with ball ground"),
    _hits("The ball bounces three times.", TWO),
    _hits("The ball hits the ground, leaves it and hits it again.", "collides_with ball ground"),
    _hits("The ball touches the ground only once.", "touches(ball, ground)"),
    _hits("The ball touches the ground just once.", TWO),
    # what cannot come true
    _hits("The wall moves.", "crosses(wall, x, 5 m)"),
    _hits("The wall slides 1 m to the front.", "gone_between(wall, x, 0.9 m, 1.1 m)"),
    _hits("The table goes at 2 m/s.", "speed_between(table, 1.9 m/s, 2.1 m/s)"),
    _hits("The ground floats.", "floats ground water"),
    _hits("The table turns.", "spin_between(table, z, 10 deg/s, 20 deg/s)"),
    _hits("The wall turns by 30 degrees.", "turned_between(wall, z, 25 deg, 35 deg)"),
    _hits("The table tilts by 20 degrees.", "tilt_between(table, x, 15 deg, 25 deg)"),
    _hits("The wall hits the table.", "collides_with wall table"),
    _hits("The wall drops.", "drops(wall)"),
    _hits("The door opens by 120 degrees.", "eventually (turned_between(door, z, 110 deg, 130 deg))"),
    _hits("The door opens by 60 degrees.", "eventually (turned_between(door, z, -65 deg, -55 deg))"),
    _hits("In the first second the gate rises.", "eventually[0, 1] (gone_between(gate, z, 0.5 m, 2 m))"),
    _hits("The gate rises within 1.5 s.", "eventually[0, 1.5] (crosses(gate, z, 1 m))"),
    _hits("The gate moves at once.", "eventually[0, 1] (speed_between(gate, 0.5 m/s, 2 m/s))"),
    # nothing asks for it
    Case("The ball hits the box and stops.", HITS, {"The ball hits the box": [0]}),
    Case("The ball flies at 5 m/s and hits the box.", HITS, {"The ball flies at 5 m/s": [0, "ball.velocity"],
                                                             "hits the box": [0]}),
    Case("The ball hits the box.", ("settles box",), {"The ball hits the box": [0]}),
]  # fmt: skip
