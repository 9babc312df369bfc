import warp as wp

import wsim.sim.model  # noqa: F401  # whoever builds a model loads it
from wsim.sim.forward import LARGE


def test_newtons_large_kernels_have_no_adjoints() -> None:
    """Were a module called otherwise, Warp would compile both again, and a first run take twice as long."""
    for name in LARGE:
        module = wp.get_module(name)
        assert module.kernels, name
        assert module.options["enable_backward"] is False
