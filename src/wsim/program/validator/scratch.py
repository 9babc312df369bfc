"""The scene that a program builds, as far as its calls are known: they are made again on a scene kept for that.

What `wsim.scene` refuses there it refuses in the program. A call of which all is known is made as it stands, as long as
all before it was known too. Of any other call each known argument is tried by itself, in a call that is otherwise good.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from wsim.assets import AssetError, get
from wsim.limits import MIN_SIZE
from wsim.program.validator.values import Const, Instance, Items, NotKnownError, Unknown, Value, plain
from wsim.scene import Part, Scene, SceneError
from wsim.scene.mesh_file import APPROXIMATIONS, FORMATS

_MOST_CALLS = 400


def _level(x: float, y: float) -> float:
    """Heights of flat ground."""
    return 0.0 * (x + y)


_SHAPE = {"size": (1.0, 1.0, 1.0)}
_ROUND = {"radius": 0.1, "height": 0.2}
_JOINT: dict[str, Any] = {"parent": None}
_CORD: dict[str, Any] = {"b": None, "anchor_b": (0.0, 0.0, 2.0)}
# What a call needs beside the argument that is tried.
_NEEDS: dict[str, dict[str, Any]] = {
    "ground": {}, "box": _SHAPE, "sphere": {"radius": 0.1}, "cylinder": _ROUND, "capsule": _ROUND,
    "tank": {"inner_size": (1.0, 1.0, 1.0)}, "material": {}, "param": {"default": 1.0}, "simulation": {}, "light": {},
    "contact": {"friction": 0.5, "restitution": 0.5},
    "camera": {"eye": (0.0, -3.0, 1.0), "target": (0.0, 0.0, 0.0)}, "fluid": {}, "asset": {},
    "tap": {"rate": 1.0, "position": (0.0, 0.0, 1.0)}, "drain": {"position": (0.0, 0.0, 0.0)},
    "surface_velocity": {"velocity": (1.0, 0.0, 0.0)},
    "path": {"times": (0.0, 1.0), "positions": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))},
    "track": {"pieces": [("line", 1.0)]}, "compound": {"parts": [Part("sphere", radius=0.1)]},
    "height_field": {"heights": _level, "size": (1.0, 1.0)},  # a function: cells go with no other
    "joint_fixed": _JOINT, "joint_revolute": _JOINT, "joint_prismatic": _JOINT, "joint_spherical": _JOINT,
    "spring": _CORD | {"stiffness": 1.0, "damping": 1.0}, "rope": _CORD, "cable": _CORD,
    # cells as large as it may be: of a size or a cell tried alone there are not too many
    "terrain": {"size": (0.2, 0.2), "cell": 1000.0, "layers": [_level]}, "scatter": {"count": 1},
    "gear": {"ratio": 1.0}, "robot": {"file_or_id": "desk_arm"}, "vehicle": {},
    "policy": {}, "schedule": {}, "sensor_imu": {}, "sensor_joints": {}, "sensor_range": {"body": None},
    "sensor_contact": {}, "sensor_camera": {"body": None},
}  # fmt: skip
MANY = ("cable", "robot", "vehicle", "scatter")  # whose bodies and joints have names of their own
BODIES = ("box", "sphere", "cylinder", "capsule", "mesh", "compound", "asset")
JOINTS = ("joint_fixed", "joint_revolute", "joint_prismatic", "joint_spherical")
SENSORS = ("sensor_imu", "sensor_joints", "sensor_range", "sensor_contact", "sensor_camera")
ABOUT = ("surface_velocity", "path")  # what says more of a body that is there
CORDS = ("spring", "rope", "cable")
OPENINGS = ("tap", "drain")
OBJECTS = (*BODIES, "robot", "vehicle", "ground", "track", "height_field", "terrain", "scatter", "tank", "fluid")
# Arguments whose rightness hangs on what else is in the scene.
_TIED = ("name", "parent", "child", "fills", "container", "material", "level", "volume", "spacing", "file", "low",
         "high", "a", "b", "anchor_a", "anchor_b", "rest_length", "length", "around", "through", "loose", "links",
         "body", "joints", "times", "positions", "rotations_deg", "joint_a", "joint_b", "points",
         "layers", "areas", "on", "count", "clear", "follows", "turns",
         "what", "quantity", "values", "linear", "point", "after", "start", "stop")  # fmt: skip
# Arguments that say nothing when they are tried alone, and are kept as they are when all are tried together.
_TOGETHER = ("mass", "density", "static", "kinematic", "velocity", "angular_velocity_deg", "low", "high", "default",
             "eye", "target")  # fmt: skip
_VECTORS = ("size", "inner_size", "position", "rotation_deg", "velocity", "angular_velocity_deg", "eye", "target",
            "anchor", "color", "direction", "gravity")  # fmt: skip


class World:
    """What is known of the prims of a program's scene.

    Attributes:
        names: Prims under /World that are made for sure: the name, and the call that makes it.
        others: Names that may be made besides: in a branch, by USD itself.
        looks: Names of materials and parameters, which do not stand under /World itself.
        looks_open: Materials of unknown names may be made.
        open: Prims of unknown names may be made besides.
        trusted: The scene here is the program's own, prim for prim.
    """

    def __init__(self) -> None:
        self._scene, self._probe = Scene(), Scene()
        self._numbers = itertools.count()
        self._tried: dict[tuple[str, str, str], str] = {}
        self._calls = 0
        self.names: dict[str, str] = {}
        self.others: set[str] = set()
        self.raw: dict[str, Any] = {}  # of bodies that USD itself makes under /World: the name, and where that is said
        self.places: dict[str, Any] = {}  # the nodes of the calls that make `names`
        self.looks: set[str] = set()
        self.open = self.looks_open = False
        self.trusted = True

    def touched(self) -> None:
        """The program reaches for the stage itself: from here on it may hold more."""
        self.trusted = False

    def call(self, method: str, arguments: Mapping[str, Value], *, certain: bool) -> tuple[Value | None, str, str]:
        """Make a call that a program makes.

        Args:
            method: Of `Scene`.
            arguments: By parameter.
            certain: Whether the program makes it for sure, and once.

        Returns:
            What it returns, if that is known; what is refused, if something is, and the argument that it is about.
        """
        name = _known(arguments.get("name"))
        self._calls += 1
        if self._calls > _MOST_CALLS:
            certain, self.trusted = False, False
        whole = self._whole(arguments) if certain and self.trusted else None
        if whole is not None and method in _NEEDS:
            try:
                made = getattr(self._scene, method)(**whole)
            except Exception as error:  # noqa: BLE001 - what it cannot take at all is told by its type
                self.trusted = False
                self.note(method, name, certain=certain)
                return (None, *self._blame(method, arguments, _refusal(error)))
            self.note(method, name, certain=certain)
            self.open = self.open or method in ("robot", "vehicle")
            for each in made if method in ("cable", "scatter") else ():
                self.note("capsule" if method == "cable" else "mesh", each.name, certain=certain)
            return Const(made), "", ""
        self.open = self.open or method in MANY
        if certain and method in (
            *OBJECTS,
            *JOINTS,
            *CORDS,
            *SENSORS,
            *OPENINGS,
            "gear",
            "policy",
            "schedule",
            "camera",
            "light",
            "material",
            "param",
        ):
            self.trusted = False
        self.note(method, name, certain=certain)
        field, refusal = self._try(method, arguments)
        return None, refusal, field

    def note(self, method: str, name: object, *, certain: bool) -> None:
        """Remember the prim that a call makes."""
        if method in ("simulation", "save", "contact", "scatter", *ABOUT):
            return
        if not isinstance(name, str):
            self.open = self.open or method not in ("material", "param")
            self.looks_open = self.looks_open or method != "param"
            return
        if method in ("material", "param"):
            self.looks.add(f"{method} {name}")
        elif certain:
            self.names.setdefault(name, method)
        else:
            self.others.add(name)

    def taken(self, method: str, name: str) -> bool:
        """Whether a name is taken for sure by an earlier call."""
        if method in ("material", "param"):
            return False  # an object's own look may have taken it, or not; the scene itself tells
        return name in self.names

    def _whole(self, arguments: Mapping[str, Value]) -> dict[str, Any] | None:
        try:
            return {name: plain(value) for name, value in arguments.items()}
        except NotKnownError:
            return None

    def _blame(self, method: str, arguments: Mapping[str, Value], refusal: str) -> tuple[str, str]:
        """The refusal, and the argument that it names."""
        text = refusal.partition(": ")[2]
        field = next((name for name in arguments if text.startswith((f"{name} ", f"{name}[", f"{name}."))), "")
        return refusal, field or next((name for name in arguments if f"{name} = " in text), "")

    def _try(self, method: str, arguments: Mapping[str, Value]) -> tuple[str, str]:
        """Try each known argument by itself, then all together; the one that is refused, and why."""
        kind = "box" if method == "mesh" else method
        if kind not in _NEEDS or kind == "policy":  # of which no robot that is at hand is sure to have the joints
            return "", ""
        if kind == "asset":
            return "id", _no_asset(_known(arguments.get("id")))
        if method == "mesh" and (refusal := _mesh(arguments)):
            return refusal.partition(": ")[2].partition(" = ")[0], refusal
        name = _known(arguments.get("name"))
        if isinstance(name, str) and (refusal := self._refuses(kind, {"name": name}, once=True)):
            return "name", refusal
        if method == "fluid" and (refusal := self._refuses_set(arguments)):
            return "", refusal
        for field, value in arguments.items():
            if field in _TIED or (method == "mesh" and field in ("scale", "up_axis", "collision")):
                continue
            for known in _parts(field, value):
                refusal = self._refuses(kind, {field: known})
                if refusal:
                    return field, refusal
        if method == "mesh":
            return "", ""
        together = {f: v for f in _TOGETHER if f in arguments and (v := _known(arguments[f])) is not None}
        if len(together) == len([f for f in _TOGETHER if f in arguments]) and len(together) > 1:
            return "", self._refuses(kind, together)
        return "", ""

    def _refuses(self, method: str, given: dict[str, Any], *, once: bool = False) -> str:
        """What the scene says to these arguments in a call that is otherwise good; `once`: on a scene of its own."""
        key = (method, repr(sorted(given)), repr(given))
        if key not in self._tried:
            self._tried[key] = self._attempt(method, given, alone=once)
        return self._tried[key]

    def _refuses_set(self, arguments: Mapping[str, Value]) -> str:
        """What the scene says to a fluid with these of its arguments, whatever their values."""
        scene = Scene()
        good: dict[str, Any] = {
            "fills": scene.tank("tank", inner_size=(1.0, 1.0, 1.0)), "level": 0.5, "volume": 0.5,
            "size": (0.5, 0.5, 0.5), "position": (0.0, 0.0, 0.5), "container": None,
        }  # fmt: skip
        none = [f for f in good if f in arguments and _is_none(arguments[f])]
        given = {f: value for f, value in good.items() if f in arguments and f not in none}
        if "container" in given:
            given["container"] = good["fills"]
        if _may_be_none(arguments, given):
            return ""
        try:
            scene.fluid("fluid", spacing=0.1, **given)
        except Exception as error:  # noqa: BLE001 - what it cannot take at all is told by its type
            return _refusal(error)
        return ""

    def _attempt(self, method: str, given: dict[str, Any], *, alone: bool) -> str:
        number = next(self._numbers)
        needs: dict[str, Any] = dict(_NEEDS[method])
        if method not in ("simulation", "contact", *ABOUT):
            needs["name"] = f"probe_{number}"
        if method == "fluid":
            edges = given.get("size", (1.0, 1.0, 1.0))
            place = given.get("position", (0.0, 0.0, -5000.0 + 3.0 * number))
            try:
                spacing = min(abs(float(edge)) for edge in edges) / 4 or 0.1
            except (TypeError, ValueError):
                spacing = 0.1
            needs |= {"size": edges, "position": place, "spacing": spacing}
        if method == "camera" and ("eye" in given) != ("target" in given):
            other = "target" if "eye" in given else "eye"
            needs[other] = (-123.4, 56.7, 8.9)
        scene = Scene() if alone or method in ("fluid", *OPENINGS) else self._probe
        needs |= _tied(scene, method, number)
        if method in OPENINGS and not given.keys() & {"radius", "size"}:
            needs["radius"] = 1.0
        try:
            getattr(scene, method)(**(needs | given))
        except Exception as error:  # noqa: BLE001 - what it cannot take at all is told by its type
            return _refusal(error)
        return ""


def _tied(scene: Scene, method: str, number: int) -> dict[str, Any]:
    """What a call ties together, made for it."""

    def body(end: str, kinematic: bool = False) -> Any:
        return scene.box(f"probe_body_{number}{end}", size=(1.0, 1.0, 1.0), kinematic=kinematic)

    if method in ABOUT:
        return {"body": body("a", kinematic=True)}
    if method == "contact":
        return {end: body(end) for end in ("a", "b")}
    if method == "scatter":
        return {"on": scene.terrain(f"probe_land_{number}", size=(100.0, 100.0), cell=100.0, layers=[_level])}
    if method in CORDS:
        return {"a": body("a")}
    if method in OPENINGS:  # particles so small that they go through any mouth that there may be
        size, place = (0.01, 0.01, 0.01), (0.0, 0.0, 0.0)
        return {"fluid": scene.fluid(f"probe_fluid_{number}", size=size, position=place, spacing=MIN_SIZE)}
    if method.startswith("joint_"):
        return {"child": body("a")}
    if method in ("sensor_imu", "sensor_contact"):
        return {"body": body("a")}
    if method == "sensor_joints":
        return {"joints": scene.joint_revolute(f"probe_joint_{number}", None, body("a"))}
    if method == "gear":
        ends = {"joint_a": "a", "joint_b": "b"}
        return {key: scene.joint_revolute(f"probe_joint_{number}{e}", None, body(e)) for key, e in ends.items()}
    return {"a": body("a"), "b": body("b")} if method == "contact" else {}


def _no_asset(identifier: object) -> str:
    """What the catalogue says to an id that it does not have."""
    try:
        get(identifier) if isinstance(identifier, str) else None
    except AssetError as error:
        return f"asset: {error}"
    return ""


def _mesh(arguments: Mapping[str, Value]) -> str:
    """What is wrong with how a mesh is read and collides. Its file is not opened: it need not be there yet."""
    file, up = _known(arguments.get("file")), _known(arguments.get("up_axis"))
    if isinstance(file, str) and PurePath(file).suffix.lower() not in FORMATS:
        return f'mesh: file = "{file}" must end in one of {", ".join(FORMATS)}'
    if isinstance(up, str) and up.upper() not in ("Y", "Z"):
        return f'mesh: up_axis = "{up}" must be "Z" or "Y"'
    collision, static = _known(arguments.get("collision")), _known(arguments.get("static", Const(False)))
    if isinstance(collision, str) and collision not in APPROXIMATIONS:
        return f'mesh: collision = "{collision}" must be one of {", ".join(APPROXIMATIONS)}'
    if collision == "none" and static is False:
        return 'mesh: collision = "none" needs static=True'
    return ""


def _refusal(error: Exception) -> str:
    return str(error) if isinstance(error, SceneError) else ""


def _is_none(value: Value) -> bool:
    return isinstance(value, Const) and value.value is None


def _may_be_none(arguments: Mapping[str, Value], given: Mapping[str, Any]) -> bool:
    """Whether an argument is not known at all: it may be None, and then counts as not given."""
    return any(isinstance(arguments[field], Unknown) for field in given)


def _known(value: Value | None) -> Any:
    if value is None:
        return None
    try:
        return plain(value)
    except NotKnownError:
        return None


def _parts(field: str, value: Value) -> list[Any]:
    """A value, or, of a vector that is known in part, one with good numbers in the other places."""
    try:
        return [plain(value)]
    except NotKnownError:
        pass
    if field not in _VECTORS or not isinstance(value, Items) or not value.exact:
        return []
    if isinstance(value, Instance):
        return []
    return [tuple(0.5 if (known := _known(item)) is None else known for item in value.items)]
