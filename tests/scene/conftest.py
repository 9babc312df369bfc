from pathlib import Path

import pytest

from wsim.scene import Drive, Scene


@pytest.fixture
def workshop() -> Scene:
    """A scene that uses every call but mesh."""
    scene = Scene({"wood_density": 650.0}, seed=3)
    scene.simulation(duration=2.0, frame_rate=25.0, time_step=0.001)
    scene.ground(friction=0.7)
    tank = scene.tank("tank", inner_size=(1.0, 0.6, 0.5), position=(0.0, 2.0, 0.0), wall=0.03)
    scene.fluid("water", fills=tank, level=0.3, spacing=0.05)
    density = scene.param("wood_density", 600.0, low=300.0, high=900.0, unit="kg/m^3")
    wood = scene.material("wood", density=density, friction=0.4, restitution=0.2, color=(0.4, 0.2, 0.1), opacity=0.9)
    scene.box(
        "block",
        size=(0.2, 0.3, 0.4),
        position=(0.0, 0.0, 1.0),
        rotation_deg=(10.0, 20.0, 30.0),
        material=wood,
        velocity=(1.0, 2.0, 3.0),
        angular_velocity_deg=(0.0, 0.0, 90.0),
    )
    rod = scene.cylinder("rod", radius=0.05, height=0.6, axis="Y", position=(2.0, 0.0, 2.0), rotation_deg=(0, 0, 40))
    pill = scene.capsule("pill", radius=0.1, height=0.3, axis="X", position=(2.0, 0.0, 1.0), mass=3.0)
    ball = scene.sphere("ball", radius=0.1, position=(3.0, 0.0, 1.0), density=7850.0)
    lid = scene.box("lid", size=(0.5, 0.5, 0.02), position=(4.0, 0.0, 1.0), mass=2.0)
    scene.box("shelf", size=(1.0, 1.0, 0.1), position=(5.0, 5.0, 0.5), static=True)
    scene.box("lift", size=(1.0, 1.0, 0.1), position=(8.0, 0.0, 0.5), kinematic=True, velocity=(0.0, 0.0, 0.1))
    motor = Drive(position=20.0, stiffness=10.0, damping=1.0, max_force=5.0)
    scene.joint_revolute("hinge", None, rod, anchor=(2.0, 0.0, 2.5), axis="Y", limits_deg=(-30.0, 60.0), drive=motor)
    scene.joint_prismatic("slide", rod, pill, axis=(1.0, 1.0, 0.0), limits=(-0.1, 0.2), drive=Drive(0.1, 0.0, 50.0, 5))
    scene.joint_spherical("socket", pill, "ball")
    scene.joint_fixed("weld", ball, lid)
    scene.light("sun", direction=(0.0, 0.6, -0.8))
    scene.light("sky", "dome")
    scene.light("lamp", "sphere", position=(1.0, 2.0, 3.0))
    scene.camera("side", eye=(0.0, -4.0, 1.5), target=(0.0, 0.0, 0.5), fov=60.0, width=320, height=240)
    scene.camera("top", eye=(0.0, 0.0, 5.0), target=(0.0, 0.0, 0.0))
    return scene


@pytest.fixture
def stage_path(workshop: Scene, tmp_path: Path) -> Path:
    return workshop.save(tmp_path / "stage.usda")
