"""Red balls pass through blue ones: two collision groups that filter each other."""
from pxr import Sdf, Usd, UsdPhysics

from wsim.scene import Scene

COLORS = {"red": (0.8, 0.05, 0.05), "blue": (0.05, 0.1, 0.8)}


def group(stage: Usd.Stage, name: str, members: list[str]) -> UsdPhysics.CollisionGroup:
    made = UsdPhysics.CollisionGroup.Define(stage, f"/World/group_{name}")
    collection = made.GetCollidersCollectionAPI()
    for path in members:
        collection.GetIncludesRel().AddTarget(path)
    return made


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0)
    scene.ground()
    members = {color: [] for color in COLORS}
    for i in range(6):
        color = "red" if i % 2 == 0 else "blue"
        ball = scene.sphere(f"{color}_{i}", radius=0.1, position=(0.02 * i, 0, 0.2 + 0.25 * i), density=500, color=COLORS[color])
        members[color].append(ball.path)
    groups = {color: group(scene.stage, color, paths) for color, paths in members.items()}
    groups["red"].CreateFilteredGroupsRel().AddTarget(groups["blue"].GetPath())
    groups["blue"].GetFilteredGroupsRel().SetTargets([Sdf.Path("/World/group_red")])
    filtered = UsdPhysics.FilteredPairsAPI.Apply(scene.stage.GetPrimAtPath("/World/red_0"))
    filtered.CreateFilteredPairsRel().SetTargets(["/World/red_2"])
    scene.camera("side", eye=(0, -3, 1), target=(0, 0, 0.6))
