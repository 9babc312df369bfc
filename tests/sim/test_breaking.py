"""What breaks joints by blows: impulse over the time that a blow lasts, whatever the step and where it began."""

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers.contact_config import ContactConfig

GAPS = (0.05, 0.0505, 0.051, 0.0515, 0.052)  # [m]: 2 m/s goes 2.5 mm in the longest step
SPEED, MASS = 2.0, 1.0
LOAD = MASS * SPEED / ContactConfig.blow_time  # [N], of what stops dead on what is held


def dead_ball(scene, name, y, gap, most):
    """A ball that meets what is held."""
    held = scene.box(f"held_{name}", size=(0.2,) * 3, mass=3.0, position=(0, y, 1))
    scene.joint_fixed(f"glue_{name}", None, held, break_force=most)
    at = {"position": (-0.2 - gap, y, 1), "velocity": (SPEED, 0, 0)}
    scene.sphere(f"ball_{name}", radius=0.1, mass=MASS, restitution=0.0, **at)


def slider_at_its_stop(scene, name, y, gap, most):
    """What slides on what is held and comes to the end of its way."""
    held = scene.box(f"held_{name}", size=(0.2,) * 3, mass=3.0, position=(0, y, 1))
    scene.joint_fixed(f"glue_{name}", None, held, break_force=most)
    at = {"position": (0.3, y, 1), "velocity": (SPEED, 0, 0)}
    rider = scene.box(f"rider_{name}", size=(0.1,) * 3, mass=MASS, **at)
    scene.joint_prismatic(f"rail_{name}", held, rider, axis="X", limits=(-1.0, gap))


def rope_drawn_taut(scene, name, y, gap, most):
    """A weight on a slack rope that hangs in what is held."""
    held = scene.box(f"held_{name}", size=(0.2,) * 3, mass=3.0, position=(0, y, 2))
    scene.joint_fixed(f"glue_{name}", None, held, break_force=most)
    start = (0, y, 1 + gap)
    bob = scene.sphere(f"bob_{name}", radius=0.1, mass=MASS, position=start, velocity=(0, 0, -SPEED))
    scene.rope(f"rope_{name}", held, bob, length=0.9, anchor_a=(0, y, 1.9), anchor_b=start)


@pytest.mark.parametrize("worlds", [1, 2], ids=["alone", "batch"])
@pytest.mark.parametrize("step", [1.25e-3, 0.5e-3])
def test_a_blow_breaks_by_its_impulse_whatever_the_step(tmp_path, step, worlds):
    """A dead blow was shared by two steps by where it fell in the first, and judged by impulse over the step."""
    scene, y = Scene(), 0.0
    scene.simulation(frame_rate=100, time_step=step, gravity=(0, 0, 0))
    holds: dict[str, bool] = {}
    for kind in (dead_ball, slider_at_its_stop, rope_drawn_taut):
        for k, gap in enumerate(GAPS):
            for share in (0.99, 1.01):
                name = f"{kind.__name__}_{k}_{'holds' if share > 1.0 else 'breaks'}"
                kind(scene, name, y, gap, share * LOAD)
                holds[f"/glue_{name}"] = share > 1.0
                y += 1.0
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu", worlds)
    for _ in range(8):
        simulation.advance_frame()
    found = simulation.rigid.breakage()
    for name, whole in holds.items():
        assert np.all(found[f"broken{name}"] == (not whole)), name
        assert found[f"force{name}"] == pytest.approx(LOAD, rel=2e-3), name


@pytest.mark.parametrize("worlds", [1, 2], ids=["alone", "batch"])
def test_a_bounce_loads_by_all_of_its_impulse(tmp_path, worlds):
    """What bounces at e = 0.5 bears on what is held by 1.5 m v, in the one step in which it meets it."""
    scene = Scene()
    scene.simulation(frame_rate=100, gravity=(0, 0, 0))
    held = scene.box("held", size=(0.2,) * 3, mass=3.0, position=(0, 0, 1))
    scene.joint_fixed("glue", None, held, break_force=2.0 * LOAD)
    scene.sphere("ball", radius=0.1, mass=MASS, restitution=0.5, position=(-0.251, 0, 1), velocity=(SPEED, 0, 0))
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu", worlds)
    for _ in range(8):
        simulation.advance_frame()
    assert simulation.rigid.breakage()["force/glue"] == pytest.approx(1.5 * LOAD, rel=2e-3)


def test_a_swing_on_a_taut_rope_is_no_blow(tmp_path):
    """What turns the speed of a bob on its rope is finite: m (g + v² / l) breaks what holds it, not more."""
    scene = Scene()
    scene.simulation(frame_rate=100, time_step=0.5e-3)
    held = scene.box("held", size=(0.2,) * 3, mass=3.0, position=(0, 0, 2))
    scene.joint_fixed("glue", None, held, break_force=1e4)
    bob = scene.sphere("bob", radius=0.1, mass=MASS, position=(0, 0, 1), velocity=(SPEED, 0, 0))
    scene.rope("rope", held, bob, length=0.9, anchor_a=(0, 0, 1.9), anchor_b=(0, 0, 1))
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu", 1)
    for _ in range(20):
        simulation.advance_frame()
    most = 3.0 * 9.81 + MASS * (9.81 + SPEED**2 / 0.9)
    assert simulation.rigid.breakage()["force/glue"] == pytest.approx(most, rel=5e-3)
