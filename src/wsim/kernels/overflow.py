"""Remembers overflows of fixed-size buffers over a run."""

import warp as wp


@wp.kernel(enable_backward=False)
def accumulate_overflow(
    # Data in:
    overflow: wp.array(dtype=wp.int32),
    # Data out:
    seen: wp.array(dtype=wp.int32),
):
    """Keep every bit that a step has raised, by world."""
    world = wp.tid()
    seen[world] = seen[world] | overflow[world]
