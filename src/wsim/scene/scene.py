"""`Scene`: what a program builds a world with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, UsdPhysics

from wsim.defaults import DURATION, FRAME_RATE, GRAVITY
from wsim.limits import MAX_DURATION, MAX_FRAME_RATE, MAX_TIME_STEP, bad_time_step
from wsim.scene import schema
from wsim.scene.articulation import joints_of, mark_articulations
from wsim.scene.authoring import PARAMETERS, PHYSICS_SCENE, calling_line, note_line
from wsim.scene.cables import Cables
from wsim.scene.check_joints import joint_problems
from wsim.scene.contacts import Contacts
from wsim.scene.errors import SceneError
from wsim.scene.motions import Motions
from wsim.scene.openings import Openings
from wsim.scene.policies import Policies
from wsim.scene.robots import Robots
from wsim.scene.scattered import Scattered
from wsim.scene.schedules import Schedules
from wsim.scene.sensors import Sensors
from wsim.scene.specs import define
from wsim.scene.validate import Call, shown, suggestion
from wsim.scene.vehicles import Vehicles
from wsim.scene.views import Views

_MAX_SEED = 2**31 - 1


class Scene(Scattered, Cables, Vehicles, Contacts, Motions, Views, Robots, Policies, Sensors, Schedules, Openings):
    """A world to be: an OpenUSD stage and the calls that author it.

    SI units, Z up, +X forward, +Y left. Every call checks what it is given and raises `SceneError`, naming the call,
    the value and the way out. What a call makes is a prim of its name under /World.

    Args:
        params: Values that override the defaults of `param`, by name.
        seed: Seed of `random` and of the simulation.
    """

    def __init__(self, params: Mapping[str, float] | None = None, seed: int = 0) -> None:
        super().__init__()
        call = Call("Scene")
        if params is not None and not isinstance(params, Mapping):
            call.fail(f'params = {shown(params)} must be values by name, such as {{"density": 600.0}}')
        self._overrides = {name: call.number(f"params[{shown(name)}]", v) for name, v in (params or {}).items()}
        self._parameters: list[str] = []
        seed = call.integer("seed", seed, 0, _MAX_SEED)
        self._random = np.random.default_rng(seed)
        self._duration, self._frame_rate = DURATION, FRAME_RATE
        physics = UsdPhysics.Scene.Define(self._stage, PHYSICS_SCENE)
        self._set_gravity((0.0, 0.0, -GRAVITY))
        schema.apply(physics.GetPrim(), schema.SCENE, {})
        self._author_run(0.0, seed)

    @property
    def random(self) -> np.random.Generator:
        """Random numbers that are the same in every build with the same seed."""
        return self._random

    def param(
        self,
        name: str,
        default: float,
        *,
        low: float | None = None,
        high: float | None = None,
        unit: str = "",
    ) -> float:
        """Name a number that a sweep may change, and get its value.

        Args:
            name: Name of the parameter.
            default: Its value where nothing overrides it.
            low: Least value of a sweep; an override may lie below.
            high: Greatest value of a sweep.
            unit: For people, e.g. "kg/m^3".

        Returns:
            The override given to `Scene`, or the default.

        Raises:
            SceneError: If the name is taken, a number is not finite, or the default lies outside low..high.
        """
        call = Call("param", name)
        path = self._path(call, PARAMETERS)
        standard = call.number("default", default, unit)
        least = None if low is None else call.number("low", low, unit)
        most = None if high is None else call.number("high", high, unit)
        if least is not None and most is not None and least > most:
            call.fail(f"low = {least:g} is above high = {most:g}")
        if (least is not None and standard < least) or (most is not None and standard > most):
            call.fail(f"default = {standard:g} lies outside low = {least}, high = {most}")
        if not isinstance(unit, str):
            call.fail(f'unit = {shown(unit)} must be words such as "kg/m^3"')
        value = self._overrides.get(name, standard)
        double = Sdf.ValueTypeNames.Double
        values: dict[str, tuple[Sdf.ValueTypeName, object]] = {
            "value": (double, value),
            "default": (double, standard),
            "unit": (Sdf.ValueTypeNames.String, unit),
        }
        values |= {key: (double, bound) for key, bound in (("low", least), ("high", most)) if bound is not None}
        layer = self._stage.GetEditTarget().GetLayer()
        with Sdf.ChangeBlock():
            define(layer, PARAMETERS, "Scope")
            made = define(layer, path, "Scope")
            made.customData = {"wsim": {"line": calling_line()}}
            schema.state(made, schema.PARAMETER, values)
        self._parameters.append(name)
        return value

    def simulation(
        self,
        *,
        duration: float | None = None,
        frame_rate: float | None = None,
        time_step: float | None = None,
        seed: int | None = None,
        gravity: Sequence[float] | None = None,
    ) -> None:
        """Say how the world is run; what is not given stays as it is.

        Args:
            duration: Simulated time [s]; 5 if never given.
            frame_rate: Recorded frames a second; 30.
            time_step: Upper bound [s], 1e-5 or longer; the simulator takes a shorter one where the world needs it. 0:
                none.
            seed: 0.
            gravity: (x, y, z) [m/s^2]; (0, 0, -9.81).

        Raises:
            SceneError: If a number is out of range.
        """
        call = Call("simulation")
        if duration is not None:
            self._duration = call.positive("duration", duration, MAX_DURATION, "s")
        if frame_rate is not None:
            self._frame_rate = call.positive("frame_rate", frame_rate, MAX_FRAME_RATE, "Hz")
        step = None if time_step is None else call.within("time_step", time_step, 0.0, MAX_TIME_STEP, "s")
        if step is not None and (wrong := bad_time_step(step)):
            call.fail(f"time_step = {wrong}")
        number = None if seed is None else call.integer("seed", seed, 0, _MAX_SEED)
        if gravity is not None:
            self._set_gravity(call.vector("gravity", gravity, 1e3, "m/s^2"))
        self._author_run(step, number)
        note_line(self._stage.GetPrimAtPath(PHYSICS_SCENE))

    def save(self, path: str | Path) -> Path:
        """Write the stage, whole or not at all.

        Args:
            path: A .usda, .usdc or .usd file.

        Raises:
            SceneError: If an override names no parameter of the program, or the file is no USD file.
        """
        call = Call("save", path)
        if not isinstance(path, (str, Path)):
            call.fail(f"path = {shown(path)} must be the path of a .usda, .usdc or .usd file")
        unknown = [name for name in self._overrides if name not in self._parameters]
        if unknown:
            raise SceneError(
                f"Scene(params=...): {shown(unknown[0])} is no parameter of this program; "
                f"{suggestion(str(unknown[0]), self._parameters)}"
            )
        target = Path(path)
        if target.suffix not in (".usda", ".usdc", ".usd"):
            call.fail(f"path = {shown(target.name)} must end in .usda, .usdc or .usd")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            call.fail(f"path = {shown(str(target))}: its folder cannot be made, {error.strerror}; take another")
        side = target.with_name(f".{target.stem}.part{target.suffix}")
        if any(joints_of(self._stage)):
            if any(joint_problems(self._stage)):
                mark_articulations(self._stage)  # joints that the program made through USD alone
            self._root_well()
        self._bake_paths(self._duration, self._frame_rate)
        self._stage.GetRootLayer().Export(str(side))
        side.replace(target)
        # USD hands out a layer that is still open under a path as it was, whatever the file says by now.
        opened = Sdf.Layer.Find(str(target)) or Sdf.Layer.Find(str(target.absolute()))
        if opened:
            opened.Reload(True)
        return target

    def _root_well(self) -> None:
        """Begin trees of joints that hang on nothing where single precision can factor their mass matrix."""
        from wsim.scene.rooting import better_roots  # brings pydantic, as masses do

        if tops := better_roots(self._stage):
            mark_articulations(self._stage, tops)

    def _author_run(self, step: float | None, seed: int | None) -> None:
        double = Sdf.ValueTypeNames.Double
        values: dict[str, tuple[Sdf.ValueTypeName, object]] = {
            "duration": (double, self._duration),
            "frameRate": (double, self._frame_rate),
        }
        if step is not None:
            values["timeStep"] = (double, step)
        if seed is not None:
            values["seed"] = (Sdf.ValueTypeNames.Int, seed)
        schema.apply(self._stage.GetPrimAtPath(PHYSICS_SCENE), schema.SCENE, values)
        self._stage.SetTimeCodesPerSecond(self._frame_rate)
        self._stage.SetFramesPerSecond(self._frame_rate)
        self._stage.SetStartTimeCode(0.0)
        self._stage.SetEndTimeCode(round(self._duration * self._frame_rate))

    def _set_gravity(self, gravity: tuple[float, float, float]) -> None:
        vector = Gf.Vec3d(*gravity)
        magnitude = vector.GetLength()
        direction = vector / magnitude if magnitude > 0.0 else Gf.Vec3d(0.0, 0.0, -1.0)
        self._turn_up(-direction)
        scene = UsdPhysics.Scene(self._stage.GetPrimAtPath(PHYSICS_SCENE))
        scene.CreateGravityDirectionAttr(Gf.Vec3f(direction))
        scene.CreateGravityMagnitudeAttr(magnitude)
