"""Write crate/asset.usda: an empty wooden crate, nailed of boards.

    python usd_assets/author_crate.py

Run again after a change here; a test holds the file against what this writes.
"""

from __future__ import annotations

from pathlib import Path

from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

EDGE = 0.4  # [m]
BOARD = 0.015  # thickness [m]
WIDTH = 0.08  # of a board [m]
POST = 0.04  # edge of a corner post [m]
BOARDS = 4  # a side
WOOD_DENSITY = 500.0  # pine, air-dry [kg/m^3]
FRICTION, RESTITUTION = 0.4, 0.1

Board = tuple[tuple[float, float, float], tuple[float, float, float]]  # centre and size [m]


def posts() -> list[Board]:
    """The four corner posts."""
    at, tall = EDGE / 2 - BOARD - POST / 2, EDGE - 2 * BOARD
    return [((x * at, y * at, EDGE / 2), (POST, POST, tall)) for x in (-1, 1) for y in (-1, 1)]


def slats() -> list[Board]:
    """The boards of the six sides; none is in another."""
    wall, tall = EDGE / 2 - BOARD / 2, EDGE - 2 * BOARD
    found: list[Board] = []
    for k in range(BOARDS):
        up = BOARD + WIDTH / 2 + k * (tall - WIDTH) / (BOARDS - 1)
        across = -EDGE / 2 + WIDTH / 2 + k * (EDGE - WIDTH) / (BOARDS - 1)
        found += [((0.0, side * wall, up), (EDGE, BOARD, WIDTH)) for side in (-1, 1)]
        found += [((side * wall, 0.0, up), (BOARD, EDGE - 2 * BOARD, WIDTH)) for side in (-1, 1)]
        found += [((0.0, across, z), (EDGE, WIDTH, BOARD)) for z in (BOARD / 2, EDGE - BOARD / 2)]
    return found


def density() -> float:
    """Mass of the boards over the volume of the box that stands for them [kg/m^3]."""
    boards = sum(x * y * z for _, (x, y, z) in posts() + slats())
    return round(WOOD_DENSITY * boards / EDGE**3, 2)


def author(path: Path) -> None:
    """Write the crate; its origin is the centre of its bottom face."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    crate = UsdGeom.Xform.Define(stage, "/crate").GetPrim()
    stage.SetDefaultPrim(crate)
    Usd.ModelAPI(crate).SetKind(Kind.Tokens.component)
    UsdPhysics.RigidBodyAPI.Apply(crate)
    UsdPhysics.MassAPI.Apply(crate).CreateDensityAttr(density())
    UsdGeom.Scope.Define(stage, "/crate/Looks")
    light = _material(stage, "wood", (0.62, 0.42, 0.22))
    dark = _material(stage, "wood_posts", (0.45, 0.28, 0.13))
    UsdGeom.Xform.Define(stage, "/crate/visual")
    _boards(stage, "/crate/visual/slats", slats(), light)
    _boards(stage, "/crate/visual/posts", posts(), dark)
    _collider(stage, light)
    UsdGeom.Xform.Define(stage, "/crate/top").AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, EDGE))
    stage.GetRootLayer().Save()


def _material(stage: Usd.Stage, name: str, color: tuple[float, float, float]) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, f"/crate/Looks/{name}")
    shader = UsdShade.Shader.Define(stage, f"/crate/Looks/{name}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.8)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    physics = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    physics.CreateStaticFrictionAttr(FRICTION)
    physics.CreateDynamicFrictionAttr(FRICTION)
    physics.CreateRestitutionAttr(RESTITUTION)
    return material


def _boards(stage: Usd.Stage, path: str, boards: list[Board], material: UsdShade.Material) -> None:
    """One mesh of many boxes, that does not collide."""
    corners = [(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]
    sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    points, indices = [], []
    for center, size in boards:
        indices += [len(points) + corner for side in sides for corner in side]
        points += [Gf.Vec3f(*(c + s * d for c, s, d in zip(center, size, at, strict=True))) for at in corners]
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray(points))
    mesh.CreateFaceVertexCountsAttr([4] * (len(indices) // 4))
    mesh.CreateFaceVertexIndicesAttr(indices)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def _collider(stage: Usd.Stage, material: UsdShade.Material) -> None:
    """The box that collides and has the mass; no renderer shows it."""
    cube = UsdGeom.Cube.Define(stage, "/crate/collision")
    cube.CreateSizeAttr(EDGE)
    cube.CreateExtentAttr([Gf.Vec3f(-EDGE / 2), Gf.Vec3f(EDGE / 2)])
    cube.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, EDGE / 2))
    cube.CreatePurposeAttr(UsdGeom.Tokens.guide)
    UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
    UsdShade.MaterialBindingAPI.Apply(cube.GetPrim()).Bind(material)


if __name__ == "__main__":
    target = Path(__file__).with_name("crate") / "asset.usda"
    target.unlink(missing_ok=True)
    author(target)
