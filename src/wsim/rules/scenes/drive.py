"""A vehicle drives so far: on level ground, along a road, or over rough ground with hills, rocks and trees."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, get_args

from wsim.assets import get
from wsim.errors import UserError
from wsim.plan.layout.drives import drive_time
from wsim.plan.layout.land import survey
from wsim.plan.schema import Actuation, FromVehicle, Objective, PlanObject, Pose, Registration, Vec3
from wsim.plan.schema.constructions import VehicleKind
from wsim.plan.schema.formula_contact import TouchesOnly
from wsim.plan.schema.formula_motion import Moves
from wsim.plan.schema.formula_place import Reaches, SpeedBetween, Upright
from wsim.plan.schema.nodes import Finally, Then
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.country import Country, Way, hill_on, land, scattered, views
from wsim.rules.scenes.part import Part
from wsim.rules.tokens import NotUnderstood

if TYPE_CHECKING:
    from wsim.scene.vehicle_spec import VehicleSpec

DISTANCE, LEAST_DISTANCE, MOST_DISTANCE = 50.0, 10.0, 200.0  # [m]: usual, and what the prompt may give
LEAST_SPEED, MOST_SPEED = 1.0, 15.0  # [m/s], that the prompt may give
SPEEDS = {"hmmwv": 8.0, "polaris": 7.0, "car": 10.0, "truck": 8.0, "cart": 4.0}  # [m/s], usual
OVER = 1.0  # that it is led farther than it is asked to come, as it stops within so much of its goal [m]
WINDING = (0.0, 0.3, -0.5, 0.0, 0.4, 0.0)  # of a way, aside at evenly spaced points, of a tenth of its length
STRAIGHT = 40.0  # [m]: a shorter way does not wind
STRAIGHT_ON = 2  # points of a way that does not
LEAST_OVER_HILL = 40.0  # [m]
MOST_ASIDE = 4.0  # [m]
NEAR = 1.5  # of a way-point, or the top of a hill [m]
STANDS, STILL = 1.0, 0.1  # for how long it stands at the end [s], and how fast that may be [m/s]
SETTLES = 3.0  # after it has stopped, its springs too [s]
LEAN, LEAN_ROUGH = 15.0, 35.0  # how far it may lean [deg]
ROCKS, TREES = ("nature/stone",), ("nature/tree", "nature/bush", "nature/stump")  # categories of the catalogue
FRAME_RATE = 20.0  # [1/s]


@dataclass
class _Drive:
    """What is asked for: the vehicle, how far and how fast, and over what."""

    thing: Thing
    kind: VehicleKind
    distance: float  # [m]
    speed: float  # [m/s]
    rough: list[Thing] = field(default_factory=list)
    roads: list[Thing] = field(default_factory=list)
    hills: list[Thing] = field(default_factory=list)
    rocks: list[Thing] = field(default_factory=list)
    trees: list[Thing] = field(default_factory=list)

    @property
    def spec(self) -> VehicleSpec:
        """Its numbers."""
        from wsim.scene.vehicle_spec import preset  # with USD, and few prompts speak of vehicles

        return preset(self.kind)

    @property
    def way(self) -> Way:
        """From where it starts: (x, y) [m]."""
        start, length = -0.5 * self.distance, self.distance + OVER
        if self.distance < STRAIGHT:
            return [(round(start, 3), 0.0), (round(start + length, 3), 0.0)]
        aside = min(0.1 * self.distance, MOST_ASIDE / max(map(abs, WINDING)))
        last = len(WINDING) - 1
        return [(round(start + length * k / last, 3), round(aside * y, 3)) for k, y in enumerate(WINDING)]

    @property
    def country(self) -> bool:
        """Whether it is more than level ground."""
        return bool(self.rough or self.roads or self.hills or self.rocks or self.trees)


def build_drive(cast: Cast, taken: set[str]) -> Part:
    """The vehicle on its way, and the country that it drives through.

    Raises:
        NotUnderstood: There is a vehicle that does not drive, or country and no vehicle.
        UserError: More is to be in it than one vehicle and its country, or it is to go too far, too fast or in too
            short a time.
    """
    known = cast.family("vehicle", "land")
    if not known:
        return Part()
    driving = [thing for thing in known if "drive" in thing.does]
    if not driving:
        raise NotUnderstood([known[0].words], "lets a vehicle drive over land, and nothing else with either:")
    asked = _asked(cast, driving[0])
    spec, way = asked.spec, asked.way
    start, yaw = way[0], _heading(way)
    takes = _duration(asked, way)
    if cast.duration is not None and cast.duration < takes:
        raise UserError(
            f"{cast.duration:g} s are too short for {asked.distance:g} m at {asked.speed:g} m/s, with {SETTLES:g} s to "
            f"come to rest; give it {takes:g} s, or no time"
        )
    made = _country(asked, cast) if asked.country else None
    ground = survey(made.land) if made is not None else None

    def on_ground(at: tuple[float, float]) -> Vec3:
        return (at[0], at[1], round(ground.height(*at), 3) + 0.0 if ground is not None else 0.0)

    name = asked.kind
    vehicle = PlanObject(
        name=name, role="vehicle", construction=FromVehicle(vehicle=asked.kind), words=asked.thing.words,
        pose=Pose(position=on_ground(start), rotation_deg=(0.0, 0.0, yaw)),
        registration=Registration(actuation=[Actuation(kind="driver", route=tuple(way[1:]), speed=asked.speed)]),
    )  # fmt: skip
    objects = [made.land, *made.scattered] if made is not None else []
    taken |= {name, *(item.name for item in objects)}
    points = [on_ground(at) for at in way[1:]]
    hill = on_ground(hill_on(way)) if asked.hills else None
    _assume(cast, asked, way)
    names = {id(thing): ["ground"] for thing in (*asked.rough, *asked.roads, *asked.hills)}
    names |= {id(thing): [item.name] for item, thing in zip(objects[1:], (*asked.rocks, *asked.trees), strict=True)}
    return Part(
        posed=[*objects, vehicle], objectives=_objectives(name, asked, points, hill), frame_rate=FRAME_RATE,
        duration=takes, names={**names, id(asked.thing): [name]},
        cameras=views(way, name, on_ground(start), spec.length),
    )  # fmt: skip


def _asked(cast: Cast, thing: Thing) -> _Drive:
    if thing.phrase.adorned or thing.drop_height is not None or thing.count > 1 or cast.wet or cast.pour is not None:
        raise UserError(f"{thing.words!r}: the builtin planner drives one vehicle as it was made; leave the rest out")
    kind = next(each for each in get_args(VehicleKind) if each == thing.noun.key)
    distance = DISTANCE if thing.way is None else thing.way
    if not LEAST_DISTANCE <= distance <= MOST_DISTANCE:
        raise UserError(f"{distance:g} m is outside {LEAST_DISTANCE:g} to {MOST_DISTANCE:g} m, which vehicles drive")
    speed = SPEEDS[kind] if thing.speed is None else thing.speed
    if not LEAST_SPEED <= speed <= MOST_SPEED:
        raise UserError(f"{speed:g} m/s is outside {LEAST_SPEED:g} to {MOST_SPEED:g} m/s, at which vehicles drive")
    asked = _Drive(thing, kind, distance, speed)
    for other in cast.things:
        if other is not thing:
            _sort(asked, other)
    if asked.hills and distance < LEAST_OVER_HILL:
        raise UserError(
            f"{distance:g} m is too short for {asked.hills[0].words!r}, which is 30 m wide; let it drive "
            f"{LEAST_OVER_HILL:g} m or more"
        )
    for several in (asked.roads, asked.hills, asked.rough):
        if len(several) > 1:
            raise UserError(f"{several[1].words!r}: the builtin planner lays one of these; leave it out")
    return asked


def _sort(asked: _Drive, other: Thing) -> None:
    """Take in what else there is, if it is country."""
    category = get(other.noun.asset).category if other.noun.asset is not None else ""
    kinds = {"terrain": asked.rough, "road": asked.roads, "hill": asked.hills}
    kinds |= dict.fromkeys(ROCKS, asked.rocks) | dict.fromkeys(TREES, asked.trees)
    found = kinds.get(category or other.kind)
    phrase = other.phrase
    places = [place for place in phrase.places if place.preposition != "by_way"]
    own = (phrase.material, phrase.color, phrase.scale, phrase.length, phrase.measures, phrase.edges, places)
    moves = {*other.does} - {"rest"} or other.beside or other.support or other.target or other.group
    if found is None or any(own) or moves or (other.noun.family == "land" and other.count > 1):
        raise UserError(
            f"{other.words!r}: the builtin planner lets a vehicle drive on a road, over rough ground or a hill, with "
            "rocks and trees beside its way; leave the rest out"
        )
    found.append(other)


def _country(asked: _Drive, cast: Cast) -> Country:
    """Ground, and what stands on it; how many of what has no number is chosen here."""
    said = {thing.words for thing in (*asked.rocks, *asked.trees)}  # they are beside its way, as many as fit that
    cast.assumptions = [one for one in cast.assumptions if one.subject not in said]
    ground = land(asked.way, rough=bool(asked.rough), hill=bool(asked.hills), road=bool(asked.roads),
                  width=asked.spec.track + asked.spec.wheel_width, length=asked.spec.length,
                  words=", ".join(thing.words for thing in (*asked.rough, *asked.roads, *asked.hills)))  # fmt: skip
    return Country(ground, scattered(asked.way, asked.rocks, asked.trees, asked.spec.width, asked.distance, cast))


def _heading(way: Way) -> float:
    """Of a smooth line through points where it begins [deg]."""
    from wsim.scene import Road  # as above

    (ax, ay), (bx, by) = Road(way).line()[:2]
    return round(math.degrees(math.atan2(by - ay, bx - ax)), 2) + 0.0


def _duration(asked: _Drive, way: Way) -> float:
    """What its driver takes along the way [s], and time to settle."""
    return float(math.ceil(drive_time(asked.kind, way, asked.speed) + SETTLES))


def _assume(cast: Cast, asked: _Drive, way: Way) -> None:
    thing, spec = asked.thing, asked.spec
    kind = f"{asked.kind}: {spec.mass:g} kg, four sprung wheels, {spec.driven} driven"
    cast.assume(thing.words, kind, "the prompt gives no numbers of it")
    if thing.way is None:
        cast.assume(thing.words, f"drives {asked.distance:g} m", "the prompt does not say how far")
    if thing.speed is None:
        cast.assume(thing.words, f"drives at {asked.speed:g} m/s at most", "the prompt gives no speed")
    if "stop" not in thing.does:
        cast.assume(thing.words, "stops at the end of its way", "the prompt does not say what it does there")
    points = f"by {len(way) - 1} way-points" if len(way) > STRAIGHT_ON else "straight on"
    cast.assume(thing.words, f"{points} to the front", "the prompt gives no way")


def _objectives(name: str, asked: _Drive, points: list[Vec3], hill: Vec3 | None) -> list[Objective]:
    """It comes so far, by its way and over the hill, touches the ground alone, stays upright, and stands."""
    visits = tuple(Reaches(object=name, target=point, within=NEAR) for point in points)
    lean = LEAN_ROUGH if asked.rough or asked.hills else LEAN
    rest = Finally(of=SpeedBetween(object=name, low=0.0, high=STILL), seconds=STANDS)
    beside = " and ".join(
        what for what, there in (("rocks", asked.rocks), ("trees", asked.trees)) if there
    )  # fmt: skip
    found = [
        (f"It drives {asked.distance:g} m.", Moves(object=name, least=asked.distance, direction="front")),
        ("It touches the ground alone" + (f", none of the {beside}." if beside else "."),
         TouchesOnly(object=name, objects=("ground",))),
        ("It stays on its wheels.", Upright(object=name, within=lean)),
        ("It stands at the end.", rest),
    ]  # fmt: skip
    if len(visits) > 1:
        text = f"It comes to each of its {len(visits)} way-points, in their order, to {NEAR:g} m."
        found.insert(1, (text, Then(events=visits, windows=(None,) * (len(visits) - 1))))
    if hill is not None:
        found.insert(1, ("It goes over the hill.", Reaches(object=name, target=hill, within=NEAR)))
    return [Objective(kind="formula", object=name, sentence=text, formula=formula) for text, formula in found]
