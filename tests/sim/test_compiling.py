"""Kernels are compiled side by side as Warp compiles them, and the rehearsal that finds them leaves no trace."""

from pathlib import Path

import numpy as np
import pytest
import warp as wp

from wsim.progress import silent
from wsim.scene import Scene
from wsim.sim import Simulation, start_warp
from wsim.sim.compiling import BODIES, BODIES_OF_WARP, CAMERA, MODEL, compile_all, load_all, modules_named, rehearse


@pytest.fixture
def cache(tmp_path):
    start_warp()
    kept, wp.config.kernel_cache_dir = wp.config.kernel_cache_dir, str(tmp_path)
    yield tmp_path
    wp.config.kernel_cache_dir = kept


def adder(amount: float) -> wp.Kernel:
    @wp.kernel(module="unique")
    def add(x: wp.array(dtype=float)):
        x[wp.tid()] = x[wp.tid()] + wp.static(amount)

    return add


def compiled(cache: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in cache.rglob("*.o")}


def test_what_is_rehearsed_is_compiled_once_and_then_found(cache):
    kernels = [adder(amount) for amount in (1.0, 10.0, 100.0)]
    x, go_on = wp.zeros(3, dtype=float, device="cpu"), wp.ones(1, dtype=int, device="cpu")

    def work():
        wp.launch(kernels[0], dim=3, inputs=[x], device="cpu")
        wp.capture_while(go_on, lambda: wp.launch(kernels[1], dim=3, inputs=[x], device="cpu"))
        wp.launch(kernels[2], dim=3, inputs=[x], device="cpu")
        raise RuntimeError("what nobody has computed")

    needed = rehearse(work)
    assert [module for module, _ in needed] == [kernel.module for kernel in kernels]
    assert not x.numpy().any()
    told = []
    seconds = compile_all([*needed, *needed], "cpu", lambda *row: told.append(row[1:]))
    assert set(seconds) == {kernel.module.name for kernel in kernels}
    assert told[0] == (0, 3) and told[-1] == (3, 3)
    before = compiled(cache)
    assert len(before) == 3
    assert compile_all(needed, "cpu") == {}
    load_all(needed, "cpu")
    assert all(kernel.module.execs for kernel in kernels)
    for kernel in kernels:
        wp.launch(kernel, dim=3, inputs=[x], device="cpu")
    assert x.numpy().tolist() == [111.0] * 3
    assert compiled(cache) == before


def test_what_asks_for_the_size_of_blocks_goes_on_in_a_rehearsal():
    kernels, sizes = [adder(amount) for amount in (2.0, 20.0)], []
    x = wp.zeros(3, dtype=float, device="cpu")

    def work():
        sizes.append(wp.get_suggested_block_size(kernels[0], "cpu"))
        wp.launch(kernels[1], dim=3, inputs=[x], device="cpu")

    assert [module for module, _ in rehearse(work)] == [kernel.module for kernel in kernels]
    assert sizes == [(1, 1)]


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_a_step_is_rehearsed_to_its_end(tmp_path, device):
    """Of bodies that nothing touches as well: what a step of theirs needs at a blow is known before it comes."""
    scene = Scene()
    scene.ground()
    scene.sphere("ball", radius=0.1, position=(0.0, 0.0, 2.0))
    scene.sphere("bob", radius=0.05, mass=1.0, position=(1.0, 0.0, 0.8))
    scene.rope("rope", None, "bob", anchor_a=(1.0, 0.0, 1.0), length=0.5)
    simulation, ended = Simulation(scene.save(tmp_path / "stage.usda"), device, 2), []

    def step():
        simulation._push_and_move()
        ended.append(True)

    assert rehearse(step)
    assert ended == [True]


def test_a_module_that_does_not_compile_says_so_when_it_is_launched(cache):
    @wp.kernel(module="unique")
    def wrong(x: wp.array(dtype=float)):
        x[wp.tid()] = wp.vec3(1.0, 2.0, 3.0)

    x = wp.zeros(1, dtype=float, device="cpu")
    good = adder(3.0)
    needed = rehearse(lambda: [wp.launch(kernel, dim=1, inputs=[x], device="cpu") for kernel in (wrong, good)])
    compile_all(needed, "cpu")
    load_all(needed, "cpu")
    wp.launch(good, dim=1, inputs=[x], device="cpu")
    assert x.numpy().tolist() == [3.0]
    with pytest.raises(Exception, match="wrong"):
        wp.launch(wrong, dim=1, inputs=[x], device="cpu")


def test_the_modules_named_are_there():
    names = {*MODEL, *BODIES, *BODIES_OF_WARP, *CAMERA}
    assert {module.name for module, _ in modules_named(names, "cpu")} == names
    assert all(module.kernels for module, _ in modules_named(names, "cpu"))


class Unrehearsed(Simulation):
    def _launched(self):
        return []


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_rehearsal_leaves_no_trace(tmp_path, worlds):
    """A world that was rehearsed, twice, goes as one that never was: bit for bit."""
    scene = Scene()
    scene.simulation(duration=0.2)
    scene.ground()
    scene.box("low", size=(0.2, 0.2, 0.2), density=600.0, position=(0.0, 0.0, 0.1))
    scene.box("high", size=(0.2, 0.2, 0.2), density=600.0, position=(0.05, 0.0, 0.32), rotation_deg=(5.0, 3.0, 0.0))
    if worlds == 1:
        tank = scene.tank("tank", inner_size=(0.6, 0.4, 0.5), position=(1.0, 0.0, 0.0))
        scene.fluid("water", fills=tank, level=0.5, spacing=0.05)
    stage = scene.save(tmp_path / "stage.usda")
    left, rehearsed = Unrehearsed(stage, "cpu", worlds), Simulation(stage, "cpu", worlds, draws=True)
    rehearsed._warm_up(silent)
    (force, deep), (force_again, deep_again) = left.rigid.contacts(), rehearsed.rigid.contacts()
    assert np.array_equal(force, force_again)
    assert np.array_equal(deep, deep_again)
    for simulation in (left, rehearsed):
        for _ in range(6):
            simulation.advance_frame()
    for name in ("body_q", "body_qd", *(("particle_q", "particle_qd") if worlds == 1 else ())):
        assert np.array_equal(getattr(left.state, name).numpy(), getattr(rehearsed.state, name).numpy()), name
