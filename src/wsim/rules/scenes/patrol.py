"""A robot patrols an office and comes back to where it began."""

from __future__ import annotations

import math
from itertools import pairwise

from wsim.assets.sources import sources
from wsim.errors import UserError
from wsim.plan.schema import Actuation, FromRobot, Objective, PlanObject, Pose, Registration
from wsim.plan.schema.formula_contact import TouchesOnly
from wsim.plan.schema.formula_place import GoneBetween, Reaches, StaysWithin, Upright
from wsim.plan.schema.nodes import Always, Finally, Then
from wsim.rules.cast import Cast
from wsim.rules.scenes.office import ROUTE, cameras, check_way, office
from wsim.rules.scenes.part import Part
from wsim.rules.tokens import NotUnderstood

SPEED, LEAST_SPEED, MOST_SPEED = 0.8, 0.2, 0.9  # [m/s]: usual, and what the prompt may give
SLOWER, SETTLES, STANDS = 1.15, 5.0, 2.0  # corners take time; to come to stand; and for how long it stands [s]
NEAR, HOME = 0.25, 0.10  # of a way-point, and of the start at the end [m]
UPRIGHT, BOBS = 20.0, 0.08  # how far it may lean [deg], and rise or give on its legs [m]
FRAME_RATE = 25.0  # [1/s]: half as often as a walking policy is asked


def build_patrol(cast: Cast, taken: set[str]) -> Part:
    """The office, and the robot on its way round it.

    Raises:
        NotUnderstood: There is a robot and no office that it patrols, or an office and no robot.
        UserError: More is to be in it than one robot, or the robot goes too fast.
    """
    known = cast.family("robot", "office")
    if not known:
        return Part()
    walking = [thing for thing in known if "patrol" in thing.does]
    if not walking:
        raise NotUnderstood([known[0].words], "lets a robot patrol an office, and nothing else with either:")
    others = [thing.words for thing in cast.things if thing is not walking[0]]
    if others or walking[0].count > 1 or cast.wet or cast.pour is not None:
        what = others[0] if others else walking[0].words
        raise UserError(f"{what!r}: the builtin planner furnishes an office itself, for one robot; leave the rest out")
    thing = walking[0]
    if thing.phrase.adorned or thing.drop_height is not None or thing.support is not None:
        raise UserError(f"{thing.words!r}: a robot is as it was made, and starts on the floor; leave the rest out")
    speed = SPEED if thing.speed is None else thing.speed
    if not LEAST_SPEED <= speed <= MOST_SPEED:
        raise UserError(f"{speed:g} m/s is outside {LEAST_SPEED:g} to {MOST_SPEED:g} m/s, at which the robot walks")
    made, source = office(), sources()[thing.noun.key]
    check_way(made, thing.noun.size[1])
    (start, *way) = ROUTE
    route = (*way[:-1], (*way[-1], 0.0))
    walk = Actuation(kind="policy", policy=next(iter(source.policies)), route=route, speed=speed)
    name = thing.noun.key
    robot = PlanObject(
        name=name, role="robot", construction=FromRobot(robot=name, size=thing.noun.size),
        pose=Pose(position=(*start, 0.0)), registration=Registration(actuation=[walk]), words=thing.words,
    )  # fmt: skip
    taken.add(name)
    length = sum(math.dist(a, b) for a, b in pairwise(ROUTE))
    _assume(cast, thing.words, made.pieces, length, None if thing.speed is not None else speed)
    return Part(
        posed=[*made.objects, robot], joints=made.joints, objectives=_objectives(name, source.height),
        duration=float(math.ceil(SLOWER * length / speed + SETTLES)), names={id(thing): [name]},
        cameras=cameras(), frame_rate=FRAME_RATE,
    )  # fmt: skip


def _assume(cast: Cast, words: str, pieces: int, length: float, speed: float | None) -> None:
    why = "the prompt does not say how it is furnished"
    cast.assume(cast.office or "", f"two rooms with a door between, and {pieces} pieces of furniture", why)
    points = f"{len(ROUTE) - 1} way-points, {length:.0f} m in all: past the desks, through the door, round the table"
    cast.assume(words, points, "the prompt gives no way")
    if speed is not None:
        cast.assume(words, f"walks at {speed:g} m/s", "the prompt gives no speed")


def _objectives(robot: str, height: float) -> list[Objective]:
    """It visits its way-points in order, touches nothing but the floor, stays up, and comes back."""
    points = [(x, y, height) for x, y in ROUTE[1:]]
    visits = tuple(Reaches(object=robot, target=point, within=NEAR) for point in points)
    stands = Always(of=GoneBetween(object=robot, axis="z", low=-BOBS, high=BOBS))
    back = StaysWithin(object=robot, center=points[-1], radius=HOME)
    asked = (
        (f"It comes to each of its {len(points)} way-points, in their order, to {100 * NEAR:g} cm.",
         Then(events=visits, windows=(None,) * (len(visits) - 1))),
        ("It touches nothing but the floor.", TouchesOnly(object=robot, objects=("ground",))),
        ("It stays up.", Upright(object=robot, within=UPRIGHT) & stands),
        (f"It ends where it began, to {100 * HOME:g} cm.", Finally(of=back, seconds=STANDS)),
    )  # fmt: skip
    return [Objective(kind="formula", object=robot, sentence=text, formula=formula) for text, formula in asked]
