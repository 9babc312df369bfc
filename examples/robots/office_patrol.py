"""A robot dog patrols an office: past the desks, through the door, round the meeting table, and back."""

from __future__ import annotations

from wsim.scene import Scene

SPEED = 0.8  # [m/s]
HOME = (-2.9, -1.6)
# x, y [m]: along the desks, to the door and through it, round the table, and home as it stood at the start.
ROUTE = (
    (-2.9, 1.0), (-1.2, 1.0), (-1.2, -1.6), (0.9, -1.6), (3.5, -1.6), (3.5, 1.7), (0.9, 1.7), (0.9, -1.6),
    (-1.2, -1.6), (*HOME, 0.0),
)  # fmt: skip
LENGTH, DEPTH, HEIGHT, THICK = 10.0, 6.4, 2.2, 0.1  # of the room within its walls, and of these [m]
PARTITION, DOOR_Y, DOOR_HEIGHT = -0.4, -1.6, 2.0  # x of the wall between, y of the middle of its door [m]
FRAME = 0.06  # [m], the jambs of the door
PLASTER, WOOD, LEAF = (0.72, 0.71, 0.67), (0.24, 0.12, 0.05), (0.5, 0.33, 0.18)

# Asset, x, y and z of the middle of its bottom face [m], yaw [deg]: each faces +X at 0.
FURNITURE = {
    "desk_1": ("desk", -4.55, 1.5, 0.0, 0.0),
    "desk_2": ("desk", -4.55, -0.6, 0.0, 0.0),
    "desk_3": ("desk", -2.3, 2.8, 0.0, -90.0),
    "monitor_1": ("monitor", -4.65, 1.5, 0.74, 0.0),
    "monitor_2": ("monitor", -4.65, -0.6, 0.74, 0.0),
    "monitor_3": ("monitor", -2.3, 2.9, 0.74, -90.0),
    "chair_1": ("chair", -4.0, 1.5, 0.0, 180.0),
    "chair_2": ("chair", -4.0, -0.6, 0.0, 180.0),
    "waste_basket": ("waste_basket", -4.7, 0.45, 0.0, 0.0),
    "shelf_1": ("shelf", -2.4, -3.0, 0.0, 90.0),
    "shelf_2": ("shelf", -3.3, -3.0, 0.0, 90.0),
    "cabinet_1": ("cabinet", -0.72, 2.6, 0.0, 180.0),
    "printer": ("printer", -0.72, 2.6, 0.85, 180.0),
    "plant_1": ("plant", -4.6, -2.8, 0.0, 0.0),
    "table": ("table", 2.2, 0.2, 0.0, 90.0),
    "chair_4": ("chair", 1.85, -0.4, 0.0, 90.0),
    "chair_6": ("chair", 1.85, 0.8, 0.0, -90.0),
    "whiteboard": ("whiteboard", 4.6, 0.2, 0.0, 180.0),
    "sofa": ("sofa", 2.2, 2.7, 0.0, -90.0),
    "cabinet_2": ("cabinet", 2.6, -2.9, 0.0, 90.0),
    "lamp": ("lamp", 2.6, -2.9, 0.85, 0.0),
    "plant_2": ("plant", 4.6, 2.8, 0.0, 0.0),
    "floor_lamp": ("floor_lamp", 0.3, 2.8, 0.0, 0.0),
}
# Beside its way, and held by nothing: what is touched of them moves.
LOOSE = {
    "chair_3": ("chair", -2.3, 2.2, 0.0, 90.0),
    "chair_5": ("chair", 2.55, -0.4, 0.0, 90.0),
    "chair_7": ("chair", 2.55, 0.8, 0.0, -90.0),
}


def build(scene: Scene) -> None:
    scene.simulation(duration=scene.param("duration", 40.0, low=1.0, high=60.0, unit="s"), frame_rate=25.0)
    scene.ground(friction=0.8, color=(0.16, 0.19, 0.24))
    walls(scene, scene.param("door", 0.9, low=0.2, high=1.1, unit="m"))
    for name, (asset, x, y, z, yaw) in FURNITURE.items():
        scene.asset(name, asset, position=(x, y, z), rotation_deg=(0.0, 0.0, yaw), static=True)
    # Pulled back into the way, chair_3 stands where the dog passes.
    back = scene.param("chair_back", 0.0, low=0.0, high=1.5, unit="m")
    for name, (asset, x, y, z, yaw) in LOOSE.items():
        scene.asset(name, asset, position=(x, y - back * (name == "chair_3"), z), rotation_deg=(0.0, 0.0, yaw))
    dog = scene.robot("go2", position=(*HOME, 0.0))
    if scene.param("walks", 1.0, low=0.0, high=1.0) > 0.5:
        scene.policy("patrol", dog, "go2_walk", route=ROUTE, speed=SPEED)
    scene.light("sun", direction=(-0.3, 0.5, -1.0))
    scene.camera("above", eye=(0.0, -3.4, 10.6), target=(0.0, -0.1, 0.0), fov=56.0, width=800, height=450)
    scene.camera("desks", eye=(-0.7, -2.9, 2.1), target=(-3.2, 0.6, 0.3), fov=75.0)
    scene.camera("meeting", eye=(4.7, -2.9, 2.1), target=(1.3, 0.0, 0.3), fov=75.0)


def walls(scene: Scene, door: float) -> None:
    """Four walls, and one between with a door in a frame, whose leaf stands open."""
    plaster = scene.material("plaster", friction=0.6, color=PLASTER)
    wood = scene.material("wood", density=600.0, friction=0.5, color=WOOD)
    leaf = scene.material("leaf", density=450.0, friction=0.5, color=LEAF)

    def wall(name: str, x: float, y: float, size_x: float, size_y: float) -> None:
        scene.box(name, size=(size_x, size_y, HEIGHT), position=(x, y, HEIGHT / 2), static=True, material=plaster)

    out_x, out_y = (LENGTH + THICK) / 2, (DEPTH + THICK) / 2
    wall("wall_back", -out_x, 0.0, THICK, DEPTH)
    wall("wall_front", out_x, 0.0, THICK, DEPTH)
    wall("wall_left", 0.0, out_y, LENGTH + 2 * THICK, THICK)
    wall("wall_right", 0.0, -out_y, LENGTH + 2 * THICK, THICK)
    low, high = DOOR_Y - door / 2 - FRAME, DOOR_Y + door / 2 + FRAME  # of the hole that the frame stands in
    wall("partition_right", PARTITION, (low - DEPTH / 2) / 2, THICK, low + DEPTH / 2)
    wall("partition_left", PARTITION, (high + DEPTH / 2) / 2, THICK, DEPTH / 2 - high)
    for name, y in (("jamb_right", low + FRAME / 2), ("jamb_left", high - FRAME / 2)):
        position = (PARTITION, y, DOOR_HEIGHT / 2)
        scene.box(name, size=(0.14, FRAME, DOOR_HEIGHT), position=position, static=True, material=wood)
    over = HEIGHT - DOOR_HEIGHT
    scene.box(
        "lintel", size=(0.14, high - low, over), position=(PARTITION, DOOR_Y, DOOR_HEIGHT + over / 2), static=True,
        material=wood,
    )  # fmt: skip
    # On its hinge, which rubs, it stands open, square to the partition.
    hinge = (PARTITION + 0.07 + 0.02, low + FRAME - 0.02, 0.0)
    scene.box(
        "door", size=(door - 0.02, 0.04, DOOR_HEIGHT - 0.03), material=leaf,
        position=(hinge[0] + door / 2, hinge[1], DOOR_HEIGHT / 2 + 0.005),
    )  # fmt: skip
    scene.joint_revolute("hinge", None, "door", anchor=(*hinge[:2], 1.0), axis="Z", friction=1.0)


if __name__ == "__main__":
    from wsim import run

    run(build)
