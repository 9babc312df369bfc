"""A plan becomes a program: the text of `program.py`, as a person would write it."""

from __future__ import annotations

import keyword
import math
import re
import textwrap
import unicodedata
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from wsim.defaults import FRAME_RATE, GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import CameraPlan, FromAsset, Joint, JointDrive, Material, Plan, PlanObject
from wsim.plan.spacing import spacing_of
from wsim.program.source import WIDTH, call, comment, number, prose, tuple_of

_AXES = "xyz"
_JOINTS = {"fixed": "fixed", "hinge": "revolute", "slider": "prismatic", "ball": "spherical"}
_LIMITS = {"hinge": "limits_deg", "slider": "limits"}
_SOUND_OVER_FALL = 30.0


def compose(plan: Plan) -> str:
    """Write the program that builds a plan.

    The same plan gives the same text. Free text of the plan (title, words, assumptions) appears in the docstring and
    in comments only, where it cannot end them.

    Args:
        plan: A laid-out plan: every solid object has a pose.

    Raises:
        UserError: If an object that takes up space has no pose.
    """
    return _Composer(plan).text()


@dataclass
class _Composer:
    plan: Plan
    names: set[str] = field(
        default_factory=lambda: {"scene", "build", "Scene", "Drive", "run", "i", *_AXES, "position"}
    )
    materials: dict[str, str] = field(default_factory=dict)  # a material as JSON: its variable
    handles: dict[str, str] = field(default_factory=dict)  # an object's name: its variable

    def text(self) -> str:
        """The whole program."""
        body = [
            *self._assumptions(),
            *self._materials(),
            *self._objects(),
            *self._joints(),
            *self._cameras(),
            *self._simulation(),
        ]
        lines = [
            *self._docstring(),
            "",
            f"from wsim.scene import {'Drive, ' if any(joint.drive for joint in self.plan.joints) else ''}Scene",
            "",
            "",
            "def build(scene: Scene) -> None:",
            '    """Author the world."""',
            *body,
            "",
            "",
            'if __name__ == "__main__":',
            "    from wsim import run",
            "",
            "    run(build)",
        ]
        return "\n".join(lines) + "\n"

    def _docstring(self) -> list[str]:
        title = prose(self.plan.title).rstrip(".") or "A world"
        title = title[:1].upper() + title[1:]
        first, *rest = textwrap.wrap(title + ".", WIDTH - 6)
        paragraphs = [rest] if rest else []
        prompt = prose(self.plan.prompt)
        if prompt and prompt.rstrip(".").lower() != title.lower():
            paragraphs.append(textwrap.wrap(f"Asked for: {prompt}", WIDTH))
        sentences = [sentence for sentence in (prose(o.sentence) for o in self.plan.objectives) if sentence]
        if sentences:
            items = [
                line
                for sentence in dict.fromkeys(sentences)
                for line in textwrap.wrap(sentence, WIDTH, initial_indent="- ", subsequent_indent="  ")
            ]
            paragraphs.append(["What must happen:", *items])
        if not paragraphs:
            return [f'"""{first}"""']
        return [f'"""{first}', *(line for lines in paragraphs for line in ("", *lines)), '"""']

    def _assumptions(self) -> list[str]:
        lines = []
        for item in self.plan.assumptions:
            why = prose(item.why)
            text = f"Assumed: {prose(item.subject)}: {prose(item.choice)}" + (f" ({why})" if why else "")
            lines += comment(text)
        return [*lines, ""] if lines else []

    def _materials(self) -> list[str]:
        lines: list[str] = []
        for item in self.plan.objects:
            material = item.material
            if material is None or item.primitive == "fluid" or material.model_dump_json() in self.materials:
                continue
            variable = self._variable(material.name)
            self.materials[material.model_dump_json()] = variable
            moving = any(o.material == material and o.state == "dynamic" for o in self.plan.objects)
            lines += self._material(material, variable, moving=moving)
        return [*lines, ""] if lines else []

    def _material(self, material: Material, variable: str, *, moving: bool) -> list[str]:
        density = number(material.density)
        lines = []
        if moving:
            bounds = [f"low={number(0.5 * material.density)}", f"high={number(1.5 * material.density)}"]
            name = self._variable(f"{variable}_density")
            lines += call(f"{name} = scene.param", [f'"{name}"', density, *bounds, 'unit="kg/m^3"'])
            density = name
        arguments = [f'"{variable}"', *([f"density={density}"] if moving else [])]
        arguments.append(f"friction={number(material.friction)}")
        if material.restitution:
            arguments.append(f"restitution={number(material.restitution)}")
        arguments.append(f"color={tuple_of(material.color)}")
        if material.opacity != 1.0:
            arguments.append(f"opacity={number(material.opacity)}")
        return lines + call(f"{variable} = scene.material", arguments)

    def _objects(self) -> list[str]:
        lines: list[str] = []
        containers = {_container(item) for item in self.plan.objects if item.primitive == "fluid"}
        jointed = {name for joint in self.plan.joints for name in (joint.child, joint.parent)}
        for group in _groups(_ordered(self.plan.objects), jointed):
            if len(group) > 1:
                lines += self._loop(group)
                continue
            item = group[0]
            target = "scene." + item.primitive
            if item.name in containers | jointed:
                self.handles[item.name] = self._variable(item.name)
                target = f"{self.handles[item.name]} = {target}"
            lines += call(target, [f'"{item.name}"', *self._arguments(item)])
        return lines

    def _loop(self, group: Sequence[PlanObject]) -> list[str]:
        """Objects that differ in position and number only."""
        positions = [[number(value) for value in _position(item)] for item in group]
        differing = [axis for axis in range(3) if len({position[axis] for position in positions}) > 1]
        if len(differing) == 1:
            variable = _AXES[differing[0]]
            values = [position[differing[0]] for position in positions]
        else:
            variable = f"({', '.join(_AXES[axis] for axis in differing)})"
            values = [f"({', '.join(position[axis] for axis in differing)})" for position in positions]
        where = [_AXES[axis] if axis in differing else positions[0][axis] for axis in range(3)]
        prefix = group[0].name.rsplit("_", 1)[0]
        first = int(group[0].name.rsplit("_", 1)[1])
        start = ["start=1"] if first == 1 else []
        counted = ", ".join(["(" + ", ".join(values) + ")", *start])
        head = f"for i, {variable} in enumerate({counted}):"
        if len(head) + 4 > WIDTH:
            lines = [f"for i, {variable} in enumerate(", "    ("]
            lines += [*(f"        {value}," for value in values), "    )" + "," * bool(start)]
            lines += [*(f"    {argument}," for argument in start), "):"]
        else:
            lines = [head]
        arguments = self._arguments(group[0], position=f"({', '.join(where)})")
        indented = ["    " + line for line in lines]
        return indented + call(f"scene.{group[0].primitive}", [f'f"{prefix}_{{i}}"', *arguments], depth=2)

    def _arguments(self, item: PlanObject, position: str | None = None) -> list[str]:
        if item.primitive == "fluid":
            return self._fluid(item)
        if item.primitive == "asset":
            return _asset(item)
        arguments = _size(item)
        if item.primitive == "ground":
            if item.pose is not None and item.pose.position[2]:
                arguments.append(f"height={number(item.pose.position[2])}")
        elif item.primitive != "tank" or any(_position(item)):
            arguments.append(f"position={position or tuple_of(_position(item))}")
        if item.pose is not None and any(item.pose.rotation_deg) and item.primitive not in ("ground", "tank"):
            arguments.append(f"rotation_deg={tuple_of(item.pose.rotation_deg)}")
        if any(item.velocity) and item.state == "dynamic":
            arguments.append(f"velocity={tuple_of(item.velocity)}")
        if item.state == "static" and item.primitive not in ("ground", "tank"):
            arguments.append("static=True")
        if item.state == "kinematic":
            arguments.append("kinematic=True")
        if item.state == "dynamic":
            arguments += _weight(item)
        if item.material is not None:
            arguments.append(f"material={self.materials[item.material.model_dump_json()]}")
        return arguments

    def _fluid(self, item: PlanObject) -> list[str]:
        container = _container(item)
        level = item.relation("FREE-SURFACE-AT")
        if container is not None and level is not None and level.value is not None:
            tank = self.plan.object(container)
            volume = (*tank.size[:2], level.value)
            arguments = [f"fills={self.handles[container]}", f"level={number(level.value)}"]
        else:
            volume = item.size
            arguments = [f"size={tuple_of(item.size)}", f"position={tuple_of(_position(item))}"]
        arguments.append(f"spacing={number(spacing_of(self.plan, item, volume))}")
        if item.registration.viscosity is not None:
            arguments.append(f"viscosity={number(item.registration.viscosity)}")
        if any(objective.kind == "fills" and objective.object == item.name for objective in self.plan.objectives):
            arguments.append(f"speed_of_sound={number(_sound(item))}")
        if item.density is not None:
            arguments.append(f"density={number(item.density)}")
        if item.material is not None:
            arguments.append(f"color={tuple_of(item.material.color)}")
        return arguments

    def _joints(self) -> list[str]:
        lines: list[str] = []
        for joint in self.plan.joints:
            parent = "None" if joint.parent is None else self.handles[joint.parent]
            arguments = [f'"{joint.name}"', parent, self.handles[joint.child]]
            child = self.plan.object(joint.child)
            if joint.anchor is not None:
                arguments.append(f"anchor={tuple_of(_anchor(child, joint))}")
            if joint.kind in ("hinge", "slider"):
                arguments.append(f'axis="{joint.axis}"')
            if joint.limits is not None:
                arguments.append(f"{_LIMITS[joint.kind]}={tuple_of(joint.limits)}")
            if joint.drive is not None:
                arguments.append(f"drive={_drive(joint.drive)}")
            lines += call(f"scene.joint_{_JOINTS[joint.kind]}", arguments)
        return lines

    def _cameras(self) -> list[str]:
        def arguments(camera: CameraPlan) -> list[str]:
            if camera.eye is None or camera.target is None:
                raise UserError(f"camera {camera.name} has no eye or no target; lay the plan out before composing it")
            return [f'"{camera.name}"', f"eye={tuple_of(camera.eye)}", f"target={tuple_of(camera.target)}"]

        return [line for camera in self.plan.cameras for line in call("scene.camera", arguments(camera))]

    def _simulation(self) -> list[str]:
        simulation = self.plan.simulation
        arguments = [f"duration={number(simulation.duration)}"]
        if simulation.frame_rate != FRAME_RATE:
            arguments.append(f"frame_rate={number(simulation.frame_rate)}")
        if simulation.time_step:
            arguments.append(f"time_step={number(simulation.time_step)}")
        if simulation.seed:
            arguments.append(f"seed={simulation.seed}")
        return call("scene.simulation", arguments)

    def _variable(self, text: str) -> str:
        """A free variable name like the text."""
        plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
        base = re.sub(r"\W+", "_", plain).strip("_").lower() or "thing"
        if base[0].isdigit() or keyword.iskeyword(base) or keyword.issoftkeyword(base):
            base = f"the_{base}"
        name, count = base, 2
        while name in self.names:
            name, count = f"{base}_{count}", count + 1
        self.names.add(name)
        return name


def _ordered(objects: Sequence[PlanObject]) -> list[PlanObject]:
    """In the plan's order, but a fluid straight after the tank that it fills."""
    filling = [item for item in objects if item.primitive == "fluid" and _container(item) is not None]
    ordered = []
    for item in objects:
        if item not in filling:
            ordered += [item, *(fluid for fluid in filling if _container(fluid) == item.name)]
    return ordered


def _groups(objects: Sequence[PlanObject], apart: Collection[str | None] = ()) -> list[list[PlanObject]]:
    """Runs of three or more neighbours named x_0, x_1, ... or x_1, x_2, ... that are alike in all but position.

    What is `apart` needs a variable of its own, and is never one of them.
    """
    groups: list[list[PlanObject]] = []
    for item in objects:
        if groups and not {item.name, groups[-1][-1].name} & {*apart} and _continues(groups[-1], item):
            groups[-1].append(item)
        else:
            groups.append([item])
    return [part for group in groups for part in ([group] if len(group) != 2 else [[group[0]], [group[1]]])]


def _continues(group: list[PlanObject], item: PlanObject) -> bool:
    first = group[0]
    prefix, _, start = first.name.rpartition("_")
    if (
        start not in ("0", "1")
        or item.name != f"{prefix}_{int(start) + len(group)}"
        or item.primitive in ("tank", "fluid", "ground", "asset")
    ):
        return False
    return _alike(first) == _alike(item) and _position(first) != _position(item)


def _alike(item: PlanObject) -> object:
    rotation = item.pose.rotation_deg if item.pose is not None else None
    return (item.primitive, item.size, item.material, item.state, item.velocity, rotation, _weight(item))


def _position(item: PlanObject) -> tuple[float, float, float]:
    if item.pose is None:
        raise UserError(f"{item.name} has no pose; lay the plan out before composing its program")
    return item.pose.position


def _weight(item: PlanObject) -> list[str]:
    """A mass or a density of its own, which comes before its material's."""
    registration = item.registration
    if registration.mass is not None:
        return [f"mass={number(registration.mass)}"]
    return [f"density={number(registration.density)}"] if registration.density is not None else []


def _anchor(child: PlanObject, joint: Joint) -> tuple[float, float, float]:
    """Where a joint is in the world [m]: its anchor turned with its child, from the child's centre."""
    x, y, z = joint.anchor or (0.0, 0.0, 0.0)
    roll, pitch, yaw = (math.radians(angle) for angle in (child.pose.rotation_deg if child.pose else (0.0, 0.0, 0.0)))
    y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
    x, z = x * math.cos(pitch) + z * math.sin(pitch), -x * math.sin(pitch) + z * math.cos(pitch)
    x, y = x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)
    at = _position(child)
    return (at[0] + x, at[1] + y, at[2] + z)


def _drive(drive: JointDrive) -> str:
    """The `Drive` of a joint, with what it has of its own."""
    given = {name: value for name, value in drive.model_dump().items() if value}
    return f"Drive({', '.join(f'{name}={number(value)}' for name, value in given.items())})"


def _container(item: PlanObject) -> str | None:
    relation = item.relation("PLACE-IN")
    return relation.ref if relation is not None else None


def _asset(item: PlanObject) -> list[str]:
    """Arguments of `scene.asset`; what the asset has of its own cannot be given."""
    weighed = item.registration.mass is not None or item.registration.density is not None
    for what, given in (
        ("velocity", any(item.velocity)),
        ("material", item.material is not None),
        ("registration.mass or .density", weighed),
        ('state "kinematic"', item.state == "kinematic"),
    ):
        if given:
            raise UserError(
                f"{item.name}: an asset of the catalogue keeps its own {what}; remove it, or give the object a "
                'construction of kind "proxy"'
            )
    arguments = [
        f'"{item.built.asset}"' if isinstance(item.built, FromAsset) else "",
        f"position={tuple_of(_position(item))}",
    ]
    if item.pose is not None and any(item.pose.rotation_deg):
        arguments.append(f"rotation_deg={tuple_of(item.pose.rotation_deg)}")
    return [*arguments, *(["static=True"] if item.state == "static" else [])]


def _size(item: PlanObject) -> list[str]:
    size = item.size
    if item.primitive == "box":
        return [f"size={tuple_of(size)}"]
    if item.primitive == "tank":
        return [f"inner_size={tuple_of(size)}"]
    if item.primitive == "sphere":
        return [f"radius={number(size[0])}"]
    if item.primitive in ("cylinder", "capsule"):
        return [f"radius={number(size[0])}", f"height={number(size[1])}"]
    return []


def _sound(poured: PlanObject) -> float:
    """Numerical speed of sound of what is poured [m/s].

    A block that lands flat stops at once; what it is compressed by is its speed over that of sound. The solver's own
    choice, ten times the speed, lets it spring back through the rim.
    """
    top = _position(poured)[2] + (poured.size[2] / 2 if poured.size else 0.0)
    return float(f"{_SOUND_OVER_FALL * math.sqrt(2 * GRAVITY * max(top, 0.01)):.2g}")
