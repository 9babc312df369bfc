"""wsim's codeless USD schema: `generatedSchema.usda` and `plugInfo.json`, and how to apply it and ask for it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from pxr import Plug, Sdf, Usd

from wsim.scene import specs

SCENE = "WsimSceneAPI"
FLUID = "WsimFluidAPI"
CONTAINER = "WsimContainerAPI"
TAP = "WsimTapAPI"
DRAIN = "WsimDrainAPI"
CAMERA = "WsimCameraAPI"
PARAMETER = "WsimParameterAPI"
HEIGHT_FIELD = "WsimHeightFieldAPI"
SPRING = "WsimSpringAPI"
ROPE = "WsimRopeAPI"
MATERIAL = "WsimMaterialAPI"
CONTACT = "WsimContactAPI"
PATH = "WsimPathAPI"
SURFACE_VELOCITY = "WsimSurfaceVelocityAPI"
GEAR = "WsimGearAPI"
DRIVE = "WsimDriveAPI"
POLICY = "WsimPolicyAPI"
JOINT_PATH = "WsimJointPathAPI"
SCHEDULE = "WsimScheduleAPI"
REACH = "WsimReachAPI"
SENSOR_IMU = "WsimSensorIMUAPI"
SENSOR_JOINTS = "WsimSensorJointsAPI"
SENSOR_RANGE = "WsimSensorRangeAPI"
SENSOR_CONTACT = "WsimSensorContactAPI"
SENSOR_CAMERA = "WsimSensorCameraAPI"


def register() -> None:
    """Tell USD about the schema. Safe to call again."""
    Plug.Registry().RegisterPlugins([Path(__file__).parent.absolute().as_posix()])


def apply(prim: Usd.Prim, name: str, values: dict[str, tuple[Sdf.ValueTypeName, object]]) -> None:
    """Apply the API schema `name` and author its attributes, given as name → (USD type, value).

    USD reads its schema plugins once, when the first stage is made; a stage made before `wsim.scene` was imported
    must not change what is written, so neither the application nor the types are left to the registry.
    """
    with Sdf.ChangeBlock():
        state(specs.spec_of(prim), name, values)


def state(spec: Sdf.PrimSpec, name: str, values: dict[str, tuple[Sdf.ValueTypeName, object]]) -> None:
    """As `apply`, straight into a layer (`wsim.scene.specs`)."""
    specs.apply(spec, name)
    for key, (kind, value) in values.items():
        specs.put(spec, f"wsim:{key}", kind, value, Sdf.VariabilityUniform)


def has(prim: Usd.Prim, name: str) -> bool:
    """Whether the API schema `name` is applied, whether or not USD knows it."""
    return name in applied(prim)


def ours(prims: Iterable[Usd.Prim]) -> list[Usd.Prim]:
    """The prims to which any schema of wsim's is applied: few of most stages."""
    return [prim for prim in prims if any(name.startswith("Wsim") for name in applied(prim))]


def applied(prim: Usd.Prim) -> list[str]:
    """The API schemas that are applied to a prim; `GetAppliedSchemas` leaves out those that USD does not know."""
    found: list[str] = prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    return found
