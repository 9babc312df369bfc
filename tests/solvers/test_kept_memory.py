"""Memory that is kept for the next array of its size."""

import warp as wp
from hypothesis import given
from hypothesis import strategies as st

from wsim.solvers.kept_memory import KeptMemory

sizes = st.integers(1, 5).map(lambda k: 64 * k)


@given(st.lists(st.one_of(sizes, st.none()), max_size=40))
def test_no_two_arrays_share_a_block_and_no_more_are_made_than_were_ever_used_at_once(calls):
    """Arrays of several sizes, the oldest given back at each None."""
    memory = KeptMemory(wp.get_device("cpu"))
    held, made, most = [], {}, {}
    for size in calls:
        if size is None:
            if held:
                memory.deallocate(*held.pop(0))
            continue
        start = memory.allocate(size)
        assert all(start + size <= other or other + length <= start for other, length in held)
        held.append((start, size))
        made.setdefault(size, set()).add(start)
        most[size] = max(most.get(size, 0), sum(length == size for _, length in held))
    assert {size: len(starts) for size, starts in made.items()} == most
