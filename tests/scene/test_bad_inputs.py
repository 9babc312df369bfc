"""Whatever is wrong with an argument of a scene's call, one line names the call, the argument and the way out.

The table says of each argument of each public call what kind of thing it takes; a call or an argument without a line in
it fails the first test.
"""

from __future__ import annotations

import inspect
import math
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.assets import policies
from wsim.assets.folders import VARIABLE
from wsim.scene import Area, Drive, Event, Noise, Part, Road, Scene, SceneError, VehicleSpec
from wsim.scene.authoring import Handle

NAN, INF, HUGE = math.nan, math.inf, 1e300
HERE = (0.0, 0.0, 0.0)
GONE = Handle("gone", "/World/gone", "body")

# What no argument of a kind may be. None is among them where the call needs the argument.
NUMBER: tuple[object, ...] = ("wide", "1", True, NAN, INF, -INF, HUGE, 10**400, [1.0], np.ones(2), object(), 1j, {})
NOT_NEGATIVE = (*NUMBER, -1.0, -1e-3)
POSITIVE = (*NOT_NEGATIVE, 0.0)
THREE: tuple[object, ...] = (
    "wide", 1.0, True, NAN, (), (1.0, 2.0), (1.0, 2.0, 3.0, 4.0), (NAN, 0.0, 0.0), (0.0, INF, 0.0), (0.0, 0.0, 1e300),
    ("1", 0.0, 0.0), (0.0, None, 0.0), (0.0, (1.0, 2.0), 0.0), {0.0, 1.0, 2.0}, {0: 1, 1: 2, 2: 3}, np.ones((3, 3)),
    np.float64(1.0), np.array(1.0),
)  # fmt: skip
OBJECT: tuple[object, ...] = ("nobody", "", 7, NAN, True, [], ("ball",), GONE, object(), "/World", "/", "cam", "wood")
KINDS: dict[str, tuple[object, ...]] = {
    "new name": (7, None, "", "a b", "2fast", "../x", "Looks", "ball", "n" * 129, [], GONE),
    "new parameter": (7, None, "", "a b", "2fast", "../x", "Looks", "n" * 129, [], GONE),
    "number": NUMBER,
    "any number": tuple(value for value in NUMBER if value is not HUGE),
    "number >= 0": NOT_NEGATIVE,
    "number > 0": POSITIVE,
    "coefficient": (*NOT_NEGATIVE, 11.0),
    "share": (*NOT_NEGATIVE, 1.1),
    "whole number": (*POSITIVE, 2.5),
    "seed": (*NOT_NEGATIVE, 2.5),
    "three numbers": THREE,
    "sizes": (*THREE, HERE, (1.0, -1.0, 1.0)),
    "colour": (*THREE, (255, 0, 0), (-0.1, 0.0, 0.0), "red"),
    "direction": (*THREE, HERE),
    "axis": (*THREE, HERE, "W", "XY", ""),
    "letter": ("W", "XY", "", 7, NAN, None, (0.0, 0.0, 1.0)),
    "word": ("laser", "", 7, NAN, True, [], {}, np.ones(2), object()),
    "text": (7, NAN, None, [], object()),
    "flag": ("no", "", 0, 1, None, NAN, [], np.ones(2), object()),
    "flag, if at all": ("no", "", 0, 1, NAN, [], np.ones(2), object()),
    "object": (*OBJECT, None),
    "object or the world": OBJECT,
    "joint": (*OBJECT, None, "ball", "weld"),
    "joints": (*OBJECT, None, "ball", "weld", ["hinge", "weld"], ["hinge", "hinge"], {"hinge"}),
    "body that moves": (*OBJECT, None, "wheel", "hinge"),
    "body that moves, or the world": (*OBJECT, "wheel", "hinge"),
    "span": ("wide", 1.0, None, (1.0,), (-1.0, 0.0, 1.0), (NAN, 1.0), (-1.0, INF), (1.0, -1.0), {-1, 1}, (-1, "1")),
    "material": ("wod", "ball", "", 7, NAN, True, [], GONE, object()),
    "tank": (*OBJECT, "ball"),
    "fluid": (*OBJECT, None, "ball", "tank"),
    "two lengths": ("wide", 1.0, (1.0,), (1.0, 1.0, 1.0), (NAN, 1.0), (1.0, 0.0), (-1.0, 1.0), {1.0, 2.0}, (1.0, "1")),
    "range": (
        (0.0, 0.0),
        "wide", 1.0, (1.0,), (-1.0, 0.0, 1.0), (NAN, 1.0), (-1.0, INF), (1.0, -1.0), (0.5, 1.0), {-1, 1}, (-1, "1"),
    ),
    "drive": (
        "fast", 1.0, True, {"velocity": 1.0}, Drive(), Drive(stiffness=-1.0), Drive(damping=NAN), Drive(position=1.0),
        Drive(velocity=1.0), Drive(stiffness=INF), Drive(damping=1.0, max_force=0.0),
        Drive(damping=1.0, max_force=-1.0), Drive(damping=1.0, saturates=True), Drive(damping=1.0, saturates="no"),
        Drive(damping="big"), Drive(stiffness=1.0, position="up"), Drive(damping=1.0, velocity=1e300),
        # type: ignore[arg-type]
    ),
    "never": (0.0, 1.0, -1.0, NAN, "strong"),
    "parts": (
        None, "ball", 1.0, [], [1.0], ["sphere"], Part("sphere", radius=1.0),
        [Part("cone", radius=1.0)], [Part("sphere")],
        [Part("box", size=(1.0, 1.0))], [Part("sphere", radius=NAN)], [Part("sphere", radius=1.0, friction=-1.0)],
        [Part("sphere", radius=1.0, mass=-1.0)], [Part("sphere", radius=1.0, density=INF)],
        [Part("sphere", radius=1.0, mass=1.0, density=1.0)], [Part("sphere", radius=1.0, position=(0.0, NAN, 0.0))],
        [Part("sphere", radius=1.0, rotation_deg="up")], [Part("sphere", radius=1.0, material="wod")],
        [Part("sphere", radius=1.0, color=(2.0, 0.0, 0.0))], [Part("cylinder", radius=1.0, height=1.0, axis="W")],
        [Part("sphere", radius=1.0, restitution=2.0)], [Part(7, radius=1.0)], {1: Part("sphere", radius=1.0)},
        # type: ignore[arg-type]
        {Part("sphere", radius=1.0), Part("sphere", radius=2.0)},
    ),
    "points": (
        "wide", 1.0, True, [1.0], [(0.0, 0.0)], [(NAN, 0.0, 0.0)], ["abc"], {0: HERE}, [HERE, None], [{0.0, 1.0, 2.0}],
        {(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)}, object(),
    ),
    "times": (
        "wide", "12", 1.0, None, [], [0.0], [0.0, NAN], [0.0, -1.0], [1.0, 1.0], [1.0, 0.5], [0.0, "1"], {0.0, 1.0},
        {0: 0, 1: 1},
    ),
    "times of keys": (
        "wide", "12", 1.0, None, [], [0.0, NAN], [0.0, -1.0], [1.0, 1.0], [1.0, 0.5], [0.0, "1"], {0.0, 1.0},
        {0: 0, 1: 1},
    ),
    "values of keys": (
        "wide", 1.0, None, [], [HERE], [HERE, (NAN, 0.0, 0.0)], [HERE, None], [HERE, (1.0,)],
        [HERE, (1e300, 0.0, 0.0)], {HERE, (1.0, 0.0, 0.0)}, {0: HERE, 1: HERE},
    ),
    "event": (
        "now", 1.0, Event(), Event(touch=("ball",)), Event(touch=("ball", "nobody")), Event(body="ball"),
        Event(body="ball", axis="W", above=1.0), Event(joint="ball", above=1.0), Event(start="nobody"),
        Event(touch=("ball", "lid"), delay=-1.0), Event(joint="hinge", above=NAN),
    ),
    "keys": (
        "wide", 1.0, [], [HERE], [(0.0, 0.0, 0.0),
        (NAN, 0.0, 0.0)], [HERE, None], [HERE, (1.0,)], [HERE, (1e300, 0.0, 0.0)],
        {HERE, (1.0, 0.0, 0.0)}, {0: HERE, 1: HERE},
    ),
    "pieces": (
        "line", 1.0, [], [()], ["line"], [("line",)], [("line", NAN)], [("line", -1.0)], [("line", "1")], [("bend",
        1.0)],
        [("up", 1.0)], [("up", 1.0, 0.0)], [("up", -1.0, 30.0)], [("loop", 1.0)], [(7, 1.0)], [(["line"], 1.0)],
        {("line", 1.0)},
        {0: ("line", 1.0)},
    ),
    "heights": (
        None, "flat", 1.0, [], [[0.0]], [0.0, 1.0], [[0.0, 1.0], [0.0]], [[0.0, NAN], [0.0, 0.0]], [[0.0, 1e300],
        [0.0, 0.0]],
        [["a", "b"], ["c", "d"]], lambda x, y: "high", lambda x, y: NAN, lambda x: 0.0, lambda x, y: 1.0 / 0.0,
        object(),
        [["1", "2"], ["3", "4"]], {}, np.ones((2, 2, 2)), [[True, False], [True, True]],
    ),
    "layers": (
        None, "flat", 1.0, [], [1.0], ["flat"], [None], [Noise], [Noise(NAN, 1.0)], [Noise(1.0, 0.0)],
        [lambda x, y: "high"], [lambda x, y: NAN], [lambda x: 0.0], [lambda x, y: 1.0 / 0.0], [[[0.0, 1.0], [0.0]]],
        [[[0.0, NAN], [0.0, 0.0]]], [np.ones((2, 2, 2))], [[["1", "2"], ["3", "4"]]], {Noise(0.1, 1.0)}, object(),
        [Road([(0.0, 0.0)])], [Road([(0.0, 0.0), (1.0, 0.0)], width=NAN)], [lambda x, y: 1e6],
    ),
    "areas": (
        "ice", 1.0, ["ice"], [Area("ice")], [Area("ice", outline=[HERE])], [Area("ice", road=7)], [Area],
        [Area("ice", outline=[(0.4, 0.4), (0.4001, 0.4), (0.4, 0.4001)])], object(), {1: 2},
        [Area("ice", outline=[(-9, -9), (9, -9), (9, 9), (-9, 9)], friction=NAN)],
        [Area("i c e", outline=[(-9, -9), (9, -9), (9, 9), (-9, 9)])],
        [Area("ice", outline=[(-9, -9), (9, -9), (9, 9), (-9, 9)], material="wod")],
        [Area("ice", outline=[(-9, -9), (9, -9), (9, 9), (-9, 9)], color=(2.0, 0.0, 0.0))],
    ),
    "terrain": (None, "land", 1.0, GONE, object(), []),
    "what": ("unicorn", "", 7, None, [], ["rocks"], [7], ["conifer", "unicorn"], NAN, object(), "door"),
    "lengths": ("wide", 1.0, None, (1.0,), (1.0, 2.0, 3.0), (0.0, 1.0), (1.0, 0.5), (NAN, 1.0), {0.1, 0.2}, ("1", 1)),
    "clear": ("road", 1.0, [1.0], [(HERE, 1.0)], [((0.0, 0.0),)], [((0.0, 0.0), -1.0)], [((0.0, NAN), 1.0)],
              [("road", 1.0)], [((0.0, 0.0), 100.0)], [(Road([(0.0, 0.0)]), 1.0)], object()),
    "edges": ("wide", 1.0, None, (1.0,), (1.0, 2.0, 3.0), (0.0, 1.0), (1.0, -1.0), (NAN, 1.0), ("1", 1.0), {1.0, 2.0}),
    "cells": ("wide", 5, (1,), (0, 5), (2.5, 5), (5, -1), (5, 10**6), (NAN, 5), ("5", 5), {5, 6}),
    "around": (
        None, "ball", 1.0, ["nobody"], [7], [None], ["ball"], [("wheel", "beside")], [("wheel", HERE)], [("wheel",
        NAN)],
        [("wheel", (0.0, 1.0, 0.0))], [("wheel",)], ["wheel", "wheel"], [("wheel", "over", 1)], {"wheel": "over"},
        [GONE],
        [[]], [("wheel", None)],
    ),
    "file": (None, 7, "", "gone.obj", "model.docx", ".", b"a.obj", [], "/dev/null"),
    "scale": (*POSITIVE[:8], -1.0, 0.0, (1.0, 1.0), (1.0, 0.0, 1.0), (1.0, NAN, 1.0), None, {1.0, 2.0, 3.0}),
    "channels": ("color", 1.0, None, [], ["normals"], [None], {"color"}, [["color"]], NAN),
    "vehicle": (None, 1.0, "hmwv", "", True, VehicleSpec(mass=-1.0), VehicleSpec(wheelbase=0.1), ["car"]),
    "robot": ("unicorn", "", 7, None, NAN, [], object(), "gone.urdf"),
    "robot's pose": ("nobody", "", 7, NAN, [], object()),
    "robot's joints": (
        "wide", 7, ["elbow"], {"nobody": 1.0}, {"elbow": NAN}, {"elbow": "1"}, {"elbow": 1e300}, {7: 1.0},
    ),
    "robot there": ("nobody", "ball", "", 7, None, NAN, [], object()),
    "policy": ("unicorn", "", 7, NAN, [], object()),
    "command": (
        "ahead", 1.0, None, (1.0,), (1.0, 0.0), (NAN, 0.0, 0.0), (1e300, 0.0, 0.0), ("1", 0.0, 0.0), {1.0, 2.0, 3.0},
    ),
    "command times": (
        "now", 1.0, [], [0.0], [1.0, 2.0], [0.0, 0.0], [0.0, -1.0], [0.0, NAN], [0.0, "1"], [0.0, 1.0, 2.0], {0.0, 1.0},
    ),
    "commands": (
        "ahead", 1.0, [], [HERE], [HERE, (1.0,)], [HERE, (NAN, 0.0, 0.0)], [HERE, None], [HERE, (1e300, 0.0, 0.0)],
        {HERE, (1.0, 0.0, 0.0)},
    ),
    "route": (
        "ahead", 1.0, [], [1.0], [(1.0,)], [HERE, (1.0, 2.0, 3.0, 4.0)], [(NAN, 0.0)], [(0.0, 0.0, NAN)], [None],
        [(1e300, 0.0)], [("1", 0.0)], {HERE, (1.0, 0.0)}, [{1.0, 2.0}],
    ),
    "flag or none": ("no", "", 0, 1, NAN, [], np.ones(2), object()),
    "asset": ("unicorn", "", 7, None, NAN, [], object()),
    "overrides": ("wide", 7, [], ["p"], {"p": NAN}, {"p": "1"}, {"p": None}, {"p"}, True),
    "USD file": ("world.txt", "world", None, 7, "", [], "/dev/null/x.usda"),
}  # fmt: skip

POSE = {"position": "three numbers", "rotation_deg": "three numbers"}
RATE = {"rate": "number > 0"}
START = {"velocity": "three numbers", "angular_velocity_deg": "three numbers"}
SURFACE = {"material": "material", "friction": "coefficient", "restitution": "share", "color": "colour"}
MASS = {"density": "number > 0", "mass": "number > 0"}
MOVES = {"static": "flag", "kinematic": "flag"}
SOLID = {"name": "new name", **POSE, **MASS, **START, **MOVES, **SURFACE, "rolling_friction": "share"}
ROUND = {"radius": "number > 0", "height": "number > 0", "axis": "letter", "rolling": "flag"}
TIED = {"name": "new name", "parent": "object or the world", "child": "object", "anchor": "three numbers"}
STRENGTH = {"break_force": "number > 0", "break_torque": "number > 0"}
ENDS = {"name": "new name", "a": "object or the world", "b": "object or the world",
        "anchor_a": "three numbers", "anchor_b": "three numbers", "color": "colour"}  # fmt: skip
LAND = Scene().terrain("land", size=(9.0, 9.0), layers=[lambda x, y: 0.0])
BETWEEN = {"name": "new", "a": "ball", "b": "lid"}

# Of each call: arguments that it takes together, and what each argument is.
TABLE: dict[str, tuple[dict[str, Any], dict[str, str]]] = {
    "Scene": ({}, {"params": "overrides", "seed": "seed"}),
    "ground": ({"name": "new"}, {"name": "new name", "height": "number", **SURFACE, "rolling_friction": "share"}),
    "box": ({"name": "new", "size": (1.0, 1.0, 1.0)}, {**SOLID, "size": "sizes"}),
    "sphere": ({"name": "new", "radius": 1.0}, {**SOLID, "radius": "number > 0", "rolling": "flag"}),
    "cylinder": ({"name": "new", "radius": 1.0, "height": 1.0}, {**SOLID, **ROUND}),
    "capsule": ({"name": "new", "radius": 1.0, "height": 1.0}, {**SOLID, **ROUND}),
    "mesh": (
        {"name": "new", "file": "cube.obj", "static": True},
        {**SOLID, "file": "file", "scale": "scale", "up_axis": "letter", "collision": "word",
        "smooth_deg": "number >= 0"},
    ),
    "compound": (
        {"name": "new", "parts": [Part("sphere", radius=1.0)]},
        {"name": "new name", "parts": "parts", **POSE, "mass": "number > 0", **START, **MOVES},
    ),
    "asset": (
        {"name": "new", "id": "barrel"}, {"name": "new name", "id": "asset", **POSE, **START, "static": "flag"},
    ),
    "robot": (
        {"name": "new", "file_or_id": "desk_arm"},
        {"name": "new name", "file_or_id": "robot", "position": "three numbers", "yaw_deg": "number",
         "pose": "robot's pose", "joints": "robot's joints", "fixed": "flag or none", "origin": "flag"},
    ),
    "policy": (
        {"name": "new", "robot": "arm", "policy": "steer", "times": (0.0, 1.0), "commands": (HERE, (1.0, 0.0, 0.0))},
        {"name": "new name", "robot": "robot there", "policy": "policy", "command": "command",
         "times": "command times", "commands": "commands", "route": "route", "speed": "number > 0"},
    ),
    "sensor_imu": (
        {"name": "new", "body": "ball"},
        {"name": "new name", "body": "body that moves", **POSE, **RATE, "accelerometer_noise": "number >= 0",
         "gyroscope_noise": "number >= 0", "accelerometer_bias": "three numbers", "gyroscope_bias": "three numbers",
         "seed": "seed"},
    ),
    "sensor_joints": (
        {"name": "new", "joints": ["hinge", "slide"]}, {"name": "new name", "joints": "joints", **RATE},
    ),
    "sensor_contact": (
        {"name": "new", "body": "ball"},
        {"name": "new name", "body": "body that moves", "rotation_deg": "three numbers", "threshold": "number >= 0",
         **RATE},
    ),
    "sensor_range": (
        {"name": "new", "body": "ball"},
        {"name": "new name", "body": "body that moves, or the world", **POSE, **RATE, "rays": "whole number",
         "fan_deg": "span", "layers": "whole number", "tilt_deg": "span", "nearest": "number >= 0",
         "farthest": "number > 0", "noise": "number >= 0", "seed": "seed"},
    ),
    "sensor_camera": (
        {"name": "new", "body": "ball"},
        {"name": "new name", "body": "body that moves, or the world", **POSE, **RATE, "width": "whole number",
         "height": "whole number", "fov": "number > 0", "farthest": "number > 0", "channels": "channels"},
    ),
    "vehicle": (
        {"name": "new"},
        {"name": "new name", "spec": "vehicle", "position": "three numbers", "yaw_deg": "number",
         "pitch_deg": "number", "roll_deg": "number", "speed": "number"},
    ),
    "tank": (
        {"name": "new", "inner_size": (1.0, 1.0, 1.0)},
        {"name": "new name", "inner_size": "sizes", "position": "three numbers", "wall": "number > 0", **SURFACE},
    ),
    "track": (
        {"name": "new", "pieces": [("line", 1.0)]},
        {
            "name": "new name", "pieces": "pieces", "points": "points", "start": "three numbers",
            "heading_deg": "number", "slope_deg": "number", "profile": "word", "width": "number > 0",
            "wall": "number >= 0", "thickness": "number > 0", **SURFACE,
        },
    ),
    "height_field": (
        {"name": "new", "heights": lambda x, y: 0.0, "size": (1.0, 1.0)},
        {
            "name": "new name", "heights": "heights", "size": "edges", "cells": "cells", "position": "three numbers",
            "thickness": "number > 0", "smooth_deg": "number >= 0", **SURFACE,
        },
    ),
    "terrain": (
        {"name": "new", "size": (2.0, 2.0), "layers": [lambda x, y: 0.0]},
        {
            "name": "new name", "size": "edges", "layers": "layers", "cell": "number > 0", "areas": "areas",
            "position": "three numbers", "thickness": "number > 0", "smooth_deg": "number >= 0", **SURFACE,
            "rolling_friction": "share",
        },
    ),
    "scatter": (
        {"name": "new", "on": LAND, "count": 1},
        {
            "name": "new name", "what": "what", "on": "terrain", "count": "whole number", "size": "lengths",
            "clear": "clear", "seed": "seed", "material": "material", "friction": "coefficient", "color": "colour",
        },
    ),
    "fluid": (
        {"name": "new", "spacing": 0.1, "size": (0.4, 0.4, 0.4), "position": (0.0, 0.0, 9.0)},
        {
            "name": "new name", "spacing": "number > 0", "fills": "tank", "level": "number >= 0",
            "volume": "number > 0", "size": "sizes", "position": "three numbers", "container": "tank",
            "velocity": "three numbers", "density": "number > 0", "viscosity": "number >= 0",
            "yield_stress": "number >= 0", "flow_index": "number > 0",
            "speed_of_sound": "number >= 0", "color": "colour", "attenuation_length": "number >= 0",
        },
    ),
    "tap": (
        {"name": "new", "fluid": "water", "rate": 0.001, "position": (0.0, 0.0, 9.0), "radius": 0.2},
        {
            "name": "new name", "fluid": "fluid", "rate": "number > 0", "position": "three numbers",
            "direction": "direction", "radius": "number > 0", "size": "two lengths", "start": "number >= 0",
            "stop": "number > 0", "speed": "number >= 0",
        },
    ),
    "drain": (
        {"name": "new", "fluid": "water", "position": (0.0, 0.0, 9.0), "radius": 0.4},
        {
            "name": "new name", "fluid": "fluid", "position": "three numbers", "direction": "direction",
            "radius": "number > 0", "size": "two lengths", "falls": "flag",
        },
    ),
    "material": (
        {"name": "new"},
        {
            "name": "new name", "density": "number > 0", "friction": "coefficient", "restitution": "share",
            "rolling": "share", "color": "colour", "opacity": "share",
        },
    ),
    "contact": (
        {"a": "ball", "b": "lid", "friction": 0.1},
        {"a": "object", "b": "object", "friction": "coefficient", "restitution": "share", "rolling": "share"},
    ),
    "schedule": (
        {"name": "new", "what": "ball", "quantity": "force", "times": (0.0, 1.0), "values": (HERE, (1.0, 0.0, 0.0))},
        {
            "name": "new parameter", "what": "object", "quantity": "word", "times": "times of keys",
            "values": "values of keys", "linear": "flag, if at all", "point": "three numbers", "after": "event",
        },
    ),
    "joint_fixed": ({"name": "new", "parent": None, "child": "ball"}, {**TIED, **STRENGTH}),
    "joint_spherical": (
        {"name": "new", "parent": None, "child": "ball"}, {**TIED, "break_force": "number > 0",
        "break_torque": "never"},
    ),
    "joint_revolute": (
        {"name": "new", "parent": None, "child": "ball"},
        {**TIED, **STRENGTH, "axis": "axis", "limits_deg": "range", "limits": "never", "drive": "drive",
         "friction": "number >= 0"},
    ),
    "joint_prismatic": (
        {"name": "new", "parent": None, "child": "ball"},
        {
            **TIED, "axis": "axis", "limits": "range", "limits_deg": "never", "drive": "drive",
            "friction": "number >= 0", "break_force": "never", "break_torque": "never",
        },
    ),
    "gear": (
        {"name": "new", "joint_a": "hinge", "joint_b": "slide", "ratio": 1.0},
        {"name": "new name", "joint_a": "joint", "joint_b": "joint", "ratio": "number"},
    ),
    "spring": (
        {**BETWEEN, "stiffness": 1.0},
        {
            **ENDS, "stiffness": "number >= 0", "damping": "number >= 0", "rest_length": "number >= 0",
            "radius": "number > 0",
        },
    ),
    "rope": (BETWEEN, {**ENDS, "around": "around", "length": "number > 0", "radius": "number > 0"}),
    "cable": (
        BETWEEN,
        {
            **ENDS, "length": "number > 0", "through": "points", "loose": "flag", "links": "whole number",
            "radius": "number > 0", "mass_per_length": "number > 0", "material": "material",
            "friction": "coefficient",
        },
    ),
    "surface_velocity": (
        {"body": "ball", "velocity": (1.0, 0.0, 0.0)}, {"body": "object", "velocity": "three numbers"},
    ),
    "path": (
        {"body": "lift", "times": [0.0, 1.0], "positions": [(0.0, 9.0, 0.0), (0.0, 9.0, 1.0)]},
        {"body": "object", "times": "times", "positions": "keys", "rotations_deg": "keys", "repeat": "flag"},
    ),
    "camera": (
        {"name": "new", "eye": (0.0, -3.0, 1.0), "target": HERE},
        {
            "name": "new name", "eye": "three numbers", "target": "three numbers", "fov": "number > 0",
            "width": "whole number", "height": "whole number",
            "follows": "body that moves, or the world", "turns": "flag", "fixed": "flag",
        },
    ),
    "light": (
        {"name": "new"},
        {
            "name": "new name", "kind": "word", "intensity": "number >= 0", "color": "colour", "direction": "direction",
            "position": "three numbers", "radius": "number > 0",
        },
    ),
    "param": (
        {"name": "new", "default": 1.0},
        {"name": "new parameter", "default": "any number", "low": "any number", "high": "any number", "unit": "text"},
    ),
    "simulation": (
        {"duration": 1.0},
        {
            "duration": "number > 0", "frame_rate": "number > 0", "time_step": "number >= 0", "seed": "seed",
            "gravity": "three numbers",
        },
    ),
    "save": ({"path": "world.usda"}, {"path": "USD file"}),
}  # fmt: skip
NOT_CALLS = {"random", "stage"}
FIELDS = {  # of what a call takes whole: each has a bad value in its kind
    Drive: {"position", "velocity", "stiffness", "damping", "max_force", "saturates"},
    Part: {
        "shape", "size", "radius", "height", "axis", "position", "rotation_deg", "density", "mass", "material",
        "friction", "restitution", "color",
    },
}  # fmt: skip


@cache
def calls() -> dict[str, inspect.Signature]:
    public = {name: each for name, each in inspect.getmembers(Scene) if not name.startswith("_")}
    made = {name: inspect.signature(each) for name, each in public.items() if callable(each)}
    return {"Scene": inspect.signature(Scene), **made}


def take(scene: Scene, method: str, arguments: dict[str, Any]) -> None:
    call: Any = Scene if method == "Scene" else getattr(scene, method)
    call(**arguments)


@cache
def values() -> dict[tuple[str, str], list[object]]:
    """What each argument of each call does not take."""
    signatures = calls()
    found: dict[tuple[str, str], list[object]] = {}
    for method, (_, arguments) in TABLE.items():
        for argument, kind in arguments.items():
            bad = found[method, argument] = list(KINDS[kind])
            if (
                argument in signatures[method].parameters
                and needed(method, argument)
                and not any(value is None for value in KINDS[kind])
            ):
                bad.append(None)
    return found


def needed(method: str, argument: str) -> bool:
    """Whether None is no value of it: it says of none that it may be None."""
    return "None" not in str(calls()[method].parameters[argument].annotation)


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Scene:
    monkeypatch.chdir(tmp_path)
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f " + " ".join(map(str, face)) for face in faces]
    (tmp_path / "cube.obj").write_text("\n".join(lines) + "\n")
    scene = Scene()
    scene.material("wood", density=600)
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 5.0))
    scene.box("lid", size=(0.1, 0.1, 0.1), position=(1.0, 0.0, 5.0))
    scene.box("lift", size=(1.0, 1.0, 0.1), position=(0.0, 9.0, 0.0), kinematic=True)
    scene.cylinder("wheel", radius=0.1, height=0.1, axis="Y", position=(0.5, 0.0, 6.0), static=True)
    for k, name in enumerate(("door", "cart", "stuck")):
        scene.box(name, size=(0.1, 0.1, 0.1), position=(3.0 + k, 0.0, 0.0))
    scene.joint_revolute("hinge", None, "door")
    scene.joint_prismatic("slide", None, "cart")
    scene.joint_fixed("weld", None, "stuck")
    scene.tank("tank", inner_size=(1, 1, 1), position=(9.0, 0.0, 0.0))
    scene.fluid("water", fills="tank", level=0.5, spacing=0.1)
    scene.camera("cam", eye=(0, -3, 1), target=(0, 0, 0))
    monkeypatch.setenv(VARIABLE, str(tmp_path / "own"))
    spec = {"joints": ["pan"], "rate": 50.0, "observations": [{"of": "command"}]}
    policies.write(tmp_path / "own", "steer", spec, b"read where it runs")
    scene.robot("arm", "desk_arm", position=(0.0, 20.0, 0.0), fixed=False)
    return scene


def test_the_table_has_every_argument_of_every_call() -> None:
    signatures = calls()
    assert set(signatures) | NOT_CALLS == set(TABLE) | NOT_CALLS
    for method, signature in signatures.items():
        assert set(signature.parameters) - {"self"} == set(TABLE[method][1]), method
    for kind, names in FIELDS.items():
        assert {each.name for each in fields(kind)} == names


@pytest.mark.parametrize("method", TABLE)
def test_a_call_takes_what_the_table_says_is_good(scene: Scene, method: str) -> None:
    take(scene, method, TABLE[method][0])


@pytest.mark.parametrize(("method", "argument"), [(m, a) for m, (_, each) in TABLE.items() for a in each])
def test_a_bad_argument_is_named_in_one_line(scene: Scene, method: str, argument: str) -> None:
    before = {str(prim.GetPath()) for prim in scene.stage.Traverse()}
    missed = []
    for value in values()[method, argument]:
        try:
            take(scene, method, {**TABLE[method][0], argument: value})
        except SceneError as error:
            said = str(error)
            if "\n" in said or argument not in said or not said.startswith(method):
                missed.append(f"{value!r}: {said}")
        except Exception as error:  # noqa: BLE001 - what falls through is what this looks for
            missed.append(f"{value!r}: {type(error).__name__}: {error}")
        else:
            missed.append(f"{value!r}: silence")
            break  # the stage has changed
    assert missed == []
    assert {str(prim.GetPath()) for prim in scene.stage.Traverse()} == before
