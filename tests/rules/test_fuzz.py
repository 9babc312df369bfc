"""A small share of `benchmarks/plan_fuzz.py`: malformed plan files are refused in a line."""

from benchmarks.plan_fuzz import EXAMPLES, malformed, run


def test_malformed_plans_neither_trace_back_nor_hang():
    results, faults, _ = run(seed=2026, first=0, count=2000)
    assert not faults, "\n".join(faults[:3])
    assert set(results) == {"refused", "plan"}
    assert results["refused"] > 1500  # the rest of the mutations left a plan whole
    assert results["plan"] > 20


def test_the_same_seed_makes_the_same_files():
    sources = [path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.json"))]
    assert sources
    files = [malformed(sources, 7, number) for number in range(30)]
    assert files == [malformed(sources, 7, number) for number in range(30)]
    assert len({raw for _, raw in files}) > 25
